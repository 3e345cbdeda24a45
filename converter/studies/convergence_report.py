"""A convergence study's figures as rows of a table, as CSV and as JSON."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from converter.files import shown_name
from converter.studies.chart_report import figure
from converter.studies.convergence import ConvergenceStudy, Curve, Point
from converter.studies.machine import machine, versions

HEADER = ("", "samples", "RMS", "warm", "falls with")
ALIGN = "lrrrr"
LEGEND = (
    "RMS: of the channels' differences from the truth, where white is 1, its own error taken off\n"
    "warm: seconds to render, once all is loaded and compiled, the median\n"
    "falls with: the power of the number of samples n, from 4 on; n^-0.5 for independent points"
)


def about_truth(study: ConvergenceStudy) -> str:
    """What the errors are measured against, in a sentence."""
    pictures = f"two pictures of {study.truth.samples} samples with other seeds"
    return f"native, the mean of {pictures}; its RMS error is {figure(study.truth.error)}"


def rows(study: ConvergenceStudy) -> list[tuple[str, ...]]:
    """A row for every picture, under `HEADER`; each method's name and slope in its first."""
    return [_row(curve, point, first=point is curve.points[0]) for curve in study.drawn for point in curve.points]


def _row(curve: Curve, point: Point, first: bool) -> tuple[str, ...]:
    slope = f"n^-{curve.slope:.2f}" if first and curve.slope is not None else ""
    return (curve.method.name if first else "", str(point.samples), figure(point.rms), f"{point.warm:.3f}", slope)


def left_out_methods(study: ConvergenceStudy) -> list[str]:
    """A line for every method that has no figures, and why."""
    return [f"left out: {curve.method.name}: {curve.skipped}" for curve in study.curves if curve.skipped is not None]


def to_csv(studies: Sequence[ConvergenceStudy]) -> str:
    """A line for every picture of every method on every scene."""
    text = io.StringIO()
    writer = csv.DictWriter(text, FIELDS, lineterminator="\n")
    writer.writeheader()
    for study in studies:
        for curve in study.curves:
            writer.writerows(_records(study, curve))
    return text.getvalue()


FIELDS = ("scene", "width", "height", "method", "skipped", "slope", "samples", "rms", "runs", "warm", "truth_error")


def _records(study: ConvergenceStudy, curve: Curve) -> list[dict[str, Any]]:
    shared = {
        "scene": shown_name(study.file),
        "width": study.settings.width,
        "height": study.settings.height,
        "method": curve.method.name,
        "skipped": curve.skipped,
        "slope": curve.slope,
        "truth_error": study.truth.error,
    }
    if curve.skipped is not None:
        return [shared]
    return [
        {**shared, "samples": point.samples, "rms": point.rms, "runs": len(point.seconds), "warm": point.warm}
        for point in curve.points
    ]


def to_json(studies: Sequence[ConvergenceStudy]) -> dict[str, Any]:
    """Every figure, every run, and what they come from."""
    return {
        "machine": machine(),
        "versions": versions(),
        "scenes": [
            {
                "scene": shown_name(study.file),
                "settings": asdict(study.settings),
                "truth": {name: getattr(study.truth, name) for name in ("samples", "error", "seconds")},
                "methods": [
                    {
                        "method": curve.method.name,
                        "use": curve.method.use,
                        "skipped": curve.skipped,
                        "slope": curve.slope,
                        "points": [asdict(point) for point in curve.points],
                    }
                    for curve in study.curves
                ],
            }
            for study in studies
        ],
    }
