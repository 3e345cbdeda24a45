"""Draws how errors of sampled scenes fall: a column a scene; over time, and over the number of samples."""

from collections.abc import Callable, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from converter.files import shown_name
from converter.studies.chart_figure import MARK, NAME, STYLES, machine_line, save
from converter.studies.convergence import ConvergenceStudy, Curve, Point

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN, ROW = 5.0, 3.4
"""Inches: a panel's width and height."""
LINES = ("-", "--", ":", "-.")
"""Curves of one renderer differ by their lines."""
SLOPES = (0.5, 0.75)
"""Powers of the number of samples that are drawn to compare with."""


def draw_convergence(studies: Sequence[ConvergenceStudy], file: Path) -> None:
    """Draw the chart into `file`, as SVG or PNG by its ending, at once and not atomically.

    Raises:
        OSError: it cannot be written.

    """
    save(lambda: convergence_chart(studies), file)


def convergence_chart(studies: Sequence[ConvergenceStudy]) -> "Figure":
    """The chart as a matplotlib figure."""
    from matplotlib.figure import Figure

    figure = Figure((COLUMN * len(studies), 2 * ROW + 0.9), layout="constrained")
    grid = figure.subplots(2, len(studies), squeeze=False)
    for study, (over_time, over_samples) in zip(studies, grid.T, strict=True):
        over_time.set_title(_title(study), fontsize=8)
        _draw_curves(over_time, study, lambda point: point.warm)
        over_time.set_xlabel("seconds", fontsize=8)
        _draw_slopes(over_samples, study)
        _draw_curves(over_samples, study, lambda point: point.samples)
        over_samples.set_xlabel("samples a pixel", fontsize=8)
    figure.supxlabel(machine_line(), fontsize=7, color="0.3")
    return figure


def _title(study: ConvergenceStudy) -> str:
    size = f"{study.settings.width} x {study.settings.height} pixels"
    truth = f"two pictures of {study.truth.samples} samples, other seeds"
    return f"{shown_name(study.file.name)}, {size}\nerrors against native, the mean of {truth}"


def _draw_curves(axes: "Axes", study: ConvergenceStudy, place: Callable[[Point], float]) -> None:
    """A curve a method, named at its end, and the truth's own error."""
    from matplotlib.ticker import FuncFormatter, NullFormatter, NullLocator

    lines = {family: cycle(LINES) for family in STYLES}
    errors = [point.rms for curve in study.drawn for point in curve.points if point.rms > 0]
    for curve in study.drawn:
        known = [point for point in curve.points if point.rms > 0]
        x, y = [place(point) for point in known], [point.rms for point in known]
        style = {**STYLES[curve.method.family], "linestyle": next(lines[curve.method.family])}
        axes.plot(x, y, color="black", ms=MARK, mew=0.7, lw=0.9, zorder=3, label=_name(curve), **style)
    axes.axhline(study.truth.error, color="0.5", lw=0.7, ls=":", zorder=1)
    axes.annotate(
        "error of the truth, taken off",
        (0.005, study.truth.error),
        xycoords=("axes fraction", "data"),
        xytext=(0, 2),
        textcoords="offset points",
        fontsize=NAME,
        style="italic",
        color="0.25",
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    if errors:
        axes.set_ylim(min(*errors, study.truth.error) / 1.6, max(errors) * 6)  # with room for the names
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    if place(Point(7, 1.0, [0.0])) == 7:
        axes.set_xticks(sorted({point.samples for curve in study.drawn for point in curve.points}))
        axes.xaxis.set_minor_locator(NullLocator())
    axes.tick_params(labelsize=7)
    axes.set_ylabel("RMS error", fontsize=8)
    axes.grid(True, color="0.92", lw=0.4, zorder=-2)
    axes.set_axisbelow(True)
    axes.legend(fontsize=NAME + 0.5, frameon=False, loc="upper right", handlelength=3.5)


def _draw_slopes(axes: "Axes", study: ConvergenceStudy) -> None:
    """Lines that fall with powers of the number of samples, from the largest error of one sample on."""
    firsts = [curve.points[0] for curve in study.drawn if curve.points]
    if not firsts:
        return
    most = max(point.samples for curve in study.drawn for point in curve.points)
    samples = np.array([1.0, most**0.8, most])
    for slope, side in zip(SLOPES, ("bottom", "top"), strict=True):
        error = max(point.rms for point in firsts) * samples**-slope
        axes.plot(samples, error, "-", color="0.8", lw=2.5, zorder=0.5)
        away = 1.12 if side == "bottom" else 1 / 1.12
        axes.text(samples[1], away * error[1], f"$n^{{-{slope:g}}}$", fontsize=8, color="0.45", va=side, ha="center")


def _name(curve: Curve) -> str:
    return curve.method.name if curve.slope is None else f"{curve.method.name}: falls with $n^{{-{curve.slope:.2f}}}$"
