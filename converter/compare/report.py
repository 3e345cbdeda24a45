"""A comparison as rows of a table and as JSON."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.compare.classes import Explanation
from converter.compare.flip import flip_map, has_flip
from converter.compare.metrics import Difference, Pixels, clamped, compare_pixels, count_shifted
from converter.scene.model import Color


@dataclass(slots=True)
class Timing:
    """Wall-clock seconds of a renderer's runs: the first, with everything still to be loaded and compiled, and more."""

    cold: float
    warm: list[float] = field(default_factory=list)
    stages: Mapping[str, float] = field(default_factory=dict)

    @property
    def warm_median(self) -> float | None:
        """Median of the runs after the first."""
        return median(self.warm) if self.warm else None


@dataclass(slots=True)
class Pictures:
    """Two pictures with their names, the first the one to be trusted, and how long they took, where they were drawn."""

    reference: str
    test: str
    reference_pixels: Pixels
    test_pixels: Pixels
    timings: dict[str, Timing] = field(default_factory=dict)


@dataclass(slots=True)
class Report:
    """What a comparison found.

    Attributes:
        pictures: what was compared.
        difference: between them as they are.
        clamped: between them as image files show them, clamped to 0..1.
        shifted: pixels that disagree, but may be the reference's, shifted by less than a pixel: at edges.
        flip: FLIP error of each pixel; None where its package is not installed.
        limit_percent: share of disagreeing pixels up to which they agree.
        explanation: why pixels disagree, where it was looked for.
        undetermined: how many of the disagreeing pixels the scene's decimals do not determine, where that was asked.

    """

    pictures: Pictures
    difference: Difference
    clamped: Difference
    shifted: int
    flip: NDArray[np.float32] | None
    limit_percent: float
    explanation: Explanation | None = None
    undetermined: int | None = None

    @property
    def agrees(self) -> bool:
        """Whether few enough pixels disagree."""
        return self.difference.disagreeing_percent <= self.limit_percent

    @property
    def flip_mean(self) -> float | None:
        """Mean FLIP error."""
        return None if self.flip is None else float(self.flip.mean(dtype=np.float64))


def make_report(pictures: Pictures, limit_percent: float) -> Report:
    """Compare two pictures.

    Raises:
        SizeMismatch: their sizes differ.

    """
    reference, test = pictures.reference_pixels, pictures.test_pixels
    return Report(
        pictures=pictures,
        difference=compare_pixels(reference, test),
        clamped=compare_pixels(clamped(reference), clamped(test)),
        shifted=count_shifted(reference, test),
        flip=flip_map(reference, test) if has_flip() else None,
        limit_percent=limit_percent,
    )


def verdict(report: Report) -> str:
    """The result in a line."""
    share = f"{_percent(report.difference.disagreeing_percent)} of the pixels disagree"
    allowed = f"up to {report.limit_percent:g} % may"
    return f"{'agreement' if report.agrees else 'NO AGREEMENT'}: {share}, {allowed}"


def difference_rows(report: Report) -> list[tuple[str, str]]:
    """What is compared and what came out, for a table; the clamped figures only where they say something else."""
    found = report.difference
    rows = [("pixels that disagree", _disagreeing(found))]
    if found.disagreeing and report.explanation is None:
        rows.append(("  off by less than a pixel", f"{report.shifted} of {found.disagreeing}"))
    if report.undetermined is not None:
        rows.append(("  not determined by the scene", f"{report.undetermined} of {found.disagreeing}"))
    if found.not_finite:
        rows.append(("pixels not finite", str(found.not_finite)))
    if report.clamped.disagreeing != found.disagreeing:
        rows.append(("  clamped to 0..1", _disagreeing(report.clamped)))
    rows += [("mean difference", f"{found.mean:.3g}"), ("RMS difference", f"{found.rms:.3g}")]
    rows += _largest_rows("largest difference", report, found)
    if found.disagreeing and report.clamped.largest != found.largest:
        rows += _largest_rows("  clamped to 0..1", report, report.clamped)
    told = "not measured: pip install flip-evaluator" if report.flip_mean is None else f"{report.flip_mean:.3g}"
    rows.append(("FLIP, mean", told))
    return rows


def class_rows(explanation: Explanation) -> list[tuple[str, str]]:
    """Why pixels disagree, for a table."""
    return [(kind, str(count)) for kind, count in explanation.counts().items()]


def timing_rows(timings: Mapping[str, Timing]) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a table of seconds."""
    repeats = max(len(timing.warm) for timing in timings.values())
    header = ["", "first run"] + ([f"warm (median of {repeats})"] if repeats else []) + ["stages of the first run"]
    rows = []
    for name, timing in timings.items():
        row = [name, f"{timing.cold:.3f} s"]
        if timing.warm_median is not None:
            row.append(f"{timing.warm_median:.3f} s")
        rows.append([*row, ", ".join(f"{stage} {spent:.3f}" for stage, spent in timing.stages.items())])
    return header, rows


def to_json(report: Report) -> dict[str, Any]:
    """Every figure, by name."""
    return {
        "reference": report.pictures.reference,
        "test": report.pictures.test,
        **_difference_json(report.difference),
        "flip_mean": report.flip_mean,
        "limit_percent": report.limit_percent,
        "agrees": report.agrees,
        "clamped": _difference_json(report.clamped),
        "shifted": report.shifted,
        "classes": _classes_json(report.explanation),
        "undetermined": report.undetermined,
        "seconds": {
            name: {"cold": t.cold, "warm_median": t.warm_median, "warm": t.warm, "stages": dict(t.stages)}
            for name, t in report.pictures.timings.items()
        },
    }


def _difference_json(found: Difference) -> dict[str, Any]:
    return {**asdict(found), "pixels": found.pixels, "disagreeing_percent": found.disagreeing_percent}


def _classes_json(explanation: Explanation | None) -> dict[str, Any] | None:
    if explanation is None:
        return None
    pixels = [asdict(pixel) for pixel in explanation.pixels]
    return {"traced": len(pixels), "counts": explanation.counts(), "pixels": pixels}


def _largest_rows(name: str, report: Report, found: Difference) -> list[tuple[str, str]]:
    largest = found.largest
    if largest.difference == 0:
        return [(name, "0")]
    amount = f"{largest.difference:.3g}" if math.isfinite(largest.difference) else "not finite"
    channel = ("red", "green", "blue")[largest.channel]
    return [
        (name, f"{amount} in {channel} at ({largest.x}, {largest.y})"),
        ("", f"reference  {_shown(largest.reference)}"),
        ("", f"candidate  {_shown(largest.test)}"),
    ]


def _disagreeing(found: Difference) -> str:
    return f"{found.disagreeing} of {found.pixels}, {_percent(found.disagreeing_percent)}"


def _percent(value: float) -> str:
    return f"{value:.3g} %" if value < 100 else "100 %"


def _shown(color: Color) -> str:
    return " ".join(f"{channel:.6f}" for channel in color)
