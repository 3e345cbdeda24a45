"""Draws what anti-aliasing costs: a column a scene; error over rays, and over time."""

from collections.abc import Callable, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

from converter.files import shown_name
from converter.studies.antialiasing import TRUTH, AntialiasingStudy, Point
from converter.studies.chart_figure import GROUND, MARK, NAME, STYLES, machine_line, save

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN, ROW = 5.0, 3.2
"""Inches: a panel's width and height."""
LINES = ("-", "--", ":", "-.")
"""Curves of one renderer differ by their lines."""


def draw_antialiasing(studies: Sequence[AntialiasingStudy], file: Path) -> None:
    """Draw the chart into `file`, as SVG or PNG by its ending, at once and not atomically.

    Raises:
        OSError: it cannot be written.

    """
    save(lambda: antialiasing_chart(studies), file)


def antialiasing_chart(studies: Sequence[AntialiasingStudy]) -> "Figure":
    """The chart as a matplotlib figure."""
    from matplotlib.figure import Figure

    figure = Figure((COLUMN * len(studies), 2 * ROW + 0.5), layout="constrained")
    grid = figure.subplots(2, len(studies), squeeze=False)
    for study, (over_rays, over_time) in zip(studies, grid.T, strict=True):
        size = f"{study.settings.width} x {study.settings.height} pixels"
        about = f"errors against each renderer's own {TRUTH} rays a pixel"
        over_rays.set_title(f"{shown_name(study.file.name)}, {size}\n{about}", fontsize=8)
        _draw(over_rays, study, lambda point: point.rays, "rays from the eye, a pixel")
        _draw(over_time, study, lambda point: point.seconds, "seconds")
    figure.supxlabel(machine_line(), fontsize=7, color="0.3")
    return figure


def _draw(axes: "Axes", study: AntialiasingStudy, place: Callable[[Point], float], label: str) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    lines = {family: cycle(LINES) for family in STYLES}
    for curve in study.curves:
        style = {**STYLES[curve.family], "linestyle": next(lines[curve.family])}
        x, y = [place(point) for point in curve.points], [point.rms for point in curve.points]
        axes.plot(x, y, color="black", ms=MARK, mew=0.7, lw=0.9, label=curve.name, **style)
        for k, offset, side in ((0, -5, "right"), (-1, 5, "left")):  # away from the curve
            axes.annotate(
                curve.points[k].name,
                (x[k], y[k]),
                xytext=(offset, 0),
                textcoords="offset points",
                ha=side,
                va="center",
                fontsize=NAME,
                bbox=GROUND,
            )
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
    axes.tick_params(labelsize=7)
    axes.set_xlabel(label, fontsize=8)
    axes.set_ylabel("RMS error, levels of 255", fontsize=8)
    axes.grid(True, which="both", color="0.92", lw=0.4, zorder=-2)
    axes.set_axisbelow(True)
    axes.legend(fontsize=NAME + 0.5, frameon=False, handlelength=3.5)
