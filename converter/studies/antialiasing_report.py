"""What anti-aliasing costs as rows of a table, as CSV and as JSON."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from converter.files import shown_name
from converter.studies.antialiasing import TRUTH, AntialiasingStudy
from converter.studies.chart_report import figure
from converter.studies.machine import machine, versions

HEADER = ("", "", "rays", "RMS", "seconds")
ALIGN = "llrrr"
LEGEND = (
    f"RMS: of the channels' differences, in levels of 255, from the same renderer's {TRUTH} rays a pixel\n"
    "rays: from the eye, a pixel; a way is named by how many that are, its limit in levels or its threshold\n"
    "seconds: to render, the median"
)
FIELDS = ("scene", "width", "height", "way", "name", "rays", "rms", "seconds")


def rows(study: AntialiasingStudy) -> list[tuple[str, ...]]:
    """A row for every picture, under `HEADER`."""
    return [
        (
            curve.name if point is curve.points[0] else "",
            point.name,
            f"{point.rays:.2f}",
            figure(point.rms),
            f"{point.seconds:.3f}",
        )
        for curve in study.curves
        for point in curve.points
    ]


def to_csv(studies: Sequence[AntialiasingStudy]) -> str:
    """A line for every picture on every scene."""
    text = io.StringIO()
    writer = csv.DictWriter(text, FIELDS, lineterminator="\n")
    writer.writeheader()
    for study in studies:
        size = {"width": study.settings.width, "height": study.settings.height}
        for curve in study.curves:
            shared = {"scene": shown_name(study.file), **size, "way": curve.name}
            writer.writerows({**shared, **asdict(point)} for point in curve.points)
    return text.getvalue()


def to_json(studies: Sequence[AntialiasingStudy]) -> dict[str, Any]:
    """Every figure, and what they come from."""
    return {
        "machine": machine(),
        "versions": versions(),
        "scenes": [
            {
                "scene": shown_name(study.file),
                "settings": asdict(study.settings),
                "truth": TRUTH,
                "skipped": study.skipped,
                "ways": [asdict(curve) for curve in study.curves],
            }
            for study in studies
        ],
    }


def left_out_methods(study: AntialiasingStudy) -> list[str]:
    """A line for every method that has no figures, and why."""
    return study.skipped
