"""Compares pictures."""

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from converter.compare.metrics import Difference
from converter.compare.report import Pictures, Report, difference_rows, make_report, verdict
from whitted.checking import not_negative
from whitted.picture import Picture


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """How much one picture, the candidate, differs from another that is trusted; Jupyter shows both side by side.

    Attributes:
        report: every figure that `whitted compare` tells.

    """

    report: Report

    @property
    def agrees(self) -> bool:
        """Whether few enough pixels disagree."""
        return self.report.agrees

    @property
    def difference(self) -> Difference:
        """How many pixels disagree, where most, and by how much."""
        return self.report.difference

    def __str__(self) -> str:
        rows = difference_rows(self.report)
        width = max(len(name) for name, _ in rows)
        return "\n".join([*(f"{name:{width}}  {value}" for name, value in rows), verdict(self.report)])

    def __repr__(self) -> str:
        return f"<{self.report.pictures.test} against {self.report.pictures.reference}: {verdict(self.report)}>"

    def _repr_png_(self) -> bytes:
        from converter.compare.figure import draw_figure

        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "difference.png"
            draw_figure(self.report, file, 10)
            return file.read_bytes()


def compare(reference: Picture, candidate: Picture, limit_percent: float = 0.1) -> Comparison:
    """Compare two pictures; a pixel disagrees when a channel differs by more than 1/255.

    Args:
        reference: the one that is trusted.
        candidate: the other, as large.
        limit_percent: share of disagreeing pixels up to which they agree.

    Raises:
        converter.compare.metrics.SizeMismatch: their sizes differ; a ValueError.
        TypeError: one is no picture.

    """
    for picture in (reference, candidate):
        if not isinstance(picture, Picture):
            raise TypeError(f"a picture is expected, from render or load_picture, found {type(picture).__name__}")
    limit_percent = not_negative("limit_percent", limit_percent)
    pixels = np.asarray(reference), np.asarray(candidate)
    return Comparison(make_report(Pictures(reference.name, candidate.name, *pixels), limit_percent))
