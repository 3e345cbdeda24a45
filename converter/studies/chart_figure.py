"""Draws the chart: a column a scene; the share of disagreeing pixels, the RMS error, and whole processes, over time."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from converter.files import shown_name
from converter.renderers.methods import Family
from converter.studies.chart_report import about_reference
from converter.studies.figure_png import save_png
from converter.studies.labels import Box, Crowd, leader, place_labels
from converter.studies.machine import machine
from converter.studies.measure import Measured, SceneStudy
from converter.studies.pareto import pareto_front
from converter.studies.reference import SMALLEST

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ENDINGS = (".svg", ".png")
COLUMN, ERROR_ROW, LINE = 7.4, 3.9, 0.145
"""Inches: a panel's width, its height, and the height of a method's line in the lowest one."""
DOTS = 105
"""A PNG's dots an inch."""
NAME = 6.5
"""Size of a method's name, in points."""
MARK = 5.0
"""A mark's width, in points."""
STYLES: dict[Family, dict[str, Any]] = {
    "native": {"marker": "o", "markerfacecolor": "black"},
    "mitsuba": {"marker": "s", "markerfacecolor": "white"},
    "povray": {"marker": "^", "markerfacecolor": "0.6"},
}
"""Each renderer has a shape and a fill of its own, and no colour."""


_FLOOR = "floor: double against long double"
GROUND = {"boxstyle": "square,pad=0.05", "facecolor": "white", "alpha": 0.75, "linewidth": 0}
"""Behind a name, so that lines under it do not strike it out."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A method in a panel: warm seconds (their quartiles, the median in the middle) and its error."""

    name: str
    family: Family
    lower: float
    seconds: float
    upper: float
    error: float


@dataclass(frozen=True, slots=True)
class ErrorScale:
    """A logarithmic axis with a place for 0 below it.

    Attributes:
        low, high: powers of ten that all errors but 0 lie between.
        zero: where 0 is drawn; None where nothing is 0.
        bottom: where the axis ends.

    """

    low: float
    high: float
    zero: float | None
    bottom: float

    def place(self, error: float) -> float:
        """Where an error is drawn."""
        return self.zero if error <= 0 and self.zero is not None else min(max(error, self.low), self.high)


def error_scale(errors: Sequence[float], floors: Sequence[float]) -> ErrorScale:
    """The axis for these errors, and for the floors below which they mean nothing.

    The row of the zeros takes as much room as its marks need for their names: up to a third of the panel.
    """
    positive = [error for error in (*errors, *floors) if 0 < error < math.inf] or [1e-6]
    low = 10.0 ** math.floor(math.log10(min(positive)) - 0.05)
    high = 10.0 ** math.ceil(math.log10(max(positive)) + 0.12)
    zeros = sum(error == 0 for error in errors)
    if zeros == 0 and 0 not in floors:
        return ErrorScale(low, high, None, low)
    decades = math.log10(high / low)
    share = min(0.12 + 0.02 * zeros, 0.4)
    band = decades * share / (1 - share)
    return ErrorScale(low, high, low / 10 ** (band / 2), low / 10**band)


def draw_chart(studies: Sequence[SceneStudy], file: Path) -> None:
    """Draw the chart into `file`, as SVG or PNG by its ending, at once and not atomically.

    Raises:
        OSError: it cannot be written.

    """
    save(lambda: chart(studies), file)


def save(make: Callable[[], "Figure"], file: Path) -> None:
    """Make a figure, and write it as SVG or PNG, by the file's ending."""
    import matplotlib as mpl

    # Text stays text, and the same figures give the same file.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "whitted", "axes.linewidth": 0.6}):
        figure = make()
        if file.suffix.lower() == ".svg":
            figure.savefig(file, format="svg", dpi=DOTS, metadata={"Date": None})
        else:
            save_png(figure, file, DOTS)


def chart(studies: Sequence[SceneStudy]) -> "Figure":
    """The chart as a matplotlib figure."""
    from matplotlib.figure import Figure

    lines = (max(len(study.drawn) for study in studies) + 2) * LINE
    figure = Figure((COLUMN * len(studies), 2 * ERROR_ROW + lines + 0.9), layout="constrained")
    grid = figure.subplots(3, len(studies), squeeze=False, height_ratios=(ERROR_ROW, ERROR_ROW, lines))
    panels = []
    for study, (share, rms, processes) in zip(studies, grid.T, strict=True):
        _draw_processes(processes, study)
        share.set_title(_title(study), fontsize=9)
        panels += [_ErrorPanel.of_shares(share, study), _ErrorPanel.of_rms(rms, study)]
    figure.supxlabel(machine_line(), fontsize=7, color="0.3")
    for panel in panels:
        panel.draw()
    # The layout first: names are placed in dots.
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for panel in panels:
        panel.name_marks()
    return figure


def _title(study: SceneStudy) -> str:
    settings = study.settings
    runs = max((len(m.runs) for m in study.drawn), default=0)
    size = f"{settings.width} x {settings.height} pixels"
    reference = about_reference(study).partition(";")[0]
    name = shown_name(study.file.name)
    return f"{name}, {size}; medians of up to {runs} runs, bars: quartiles\nerrors against {reference}"


def machine_line() -> str:
    """The machine that figures come from, in a line."""
    told = machine()
    return f"{told['processor']}, {told['cores']} cores" + (f", {told['instructions']}" if told["instructions"] else "")


def percent(share: float) -> str:
    """`0.001 %`, without an exponent."""
    value = 100 * share
    return f"{value:.0f} %" if value >= 1 else f"{value:.{max(0, -math.floor(math.log10(value)))}f} %"


def _power(value: float) -> str:
    return f"$10^{{{round(math.log10(value))}}}$"


@dataclass(slots=True)
class _ErrorPanel:
    """A panel of error over time."""

    axes: "Axes"
    marks: list[Mark]
    floors: dict[str, float]
    scale: ErrorScale
    tick: Callable[[float], str]

    @classmethod
    def of_shares(cls, axes: "Axes", study: SceneStudy) -> "_ErrorPanel":
        errors = [study.share(m) for m in study.drawn]
        if study.certified is not None:
            axes.set_ylabel("certified pixels that are wrong", fontsize=8)
            return cls._of(axes, study, errors, {}, percent)
        axes.set_ylabel("pixels that differ by more than 1/255", fontsize=8)
        floor = study.reference.floor
        return cls._of(axes, study, errors, {_FLOOR: floor.disagreeing / floor.pixels}, percent)

    @classmethod
    def of_rms(cls, axes: "Axes", study: SceneStudy) -> "_ErrorPanel":
        axes.set_ylabel("RMS difference, where white is 1", fontsize=8)
        errors = [m.difference.rms for m in study.drawn if m.difference]
        floors = {_FLOOR: study.reference.floor.rms}
        lost = study.reference.left_out
        if lost is not None and lost.rms > max(SMALLEST, study.reference.floor.rms):
            floors["weight that the reference leaves out"] = lost.rms
        return cls._of(axes, study, errors, floors, _power)

    @classmethod
    def _of(
        cls,
        axes: "Axes",
        study: SceneStudy,
        errors: list[float],
        floors: dict[str, float],
        tick: Callable[[float], str],
    ) -> "_ErrorPanel":
        marks = [
            Mark(m.method.name, m.method.family, *_quartiles(m.seconds), error)
            for m, error in zip(study.drawn, errors, strict=True)
        ]
        return cls(axes, marks, floors, error_scale(errors, list(floors.values())), tick)

    def draw(self) -> None:
        """Everything but the names."""
        axes, scale = self.axes, self.scale
        _scale_seconds(axes, [seconds for m in self.marks for seconds in (m.lower, m.upper)])
        axes.set_xlabel("seconds to render, warm", fontsize=8)
        axes.set_yscale("log")
        axes.set_ylim(scale.bottom, scale.high)
        axes.minorticks_off()
        decades = range(round(math.log10(scale.low)), round(math.log10(scale.high)) + 1)
        ticks = [10.0**power for power in decades]
        labels = [self.tick(value) for value in ticks]
        if scale.zero is not None:
            ticks, labels = [scale.zero, *ticks], ["0", *labels]
            axes.axhline(scale.low, color="0.5", lw=0.6, ls=(0, (6, 3)), zorder=0)
        axes.set_yticks(ticks, labels, fontsize=7)
        self._draw_floors()
        self._draw_front()
        for mark in self.marks:
            y = scale.place(mark.error)
            axes.plot([mark.lower, mark.upper], [y, y], "-", color="black", lw=0.6, zorder=3)
            axes.plot(mark.seconds, y, color="black", ms=MARK, mew=0.7, zorder=4, ls="", **STYLES[mark.family])

    def _draw_floors(self) -> None:
        """What lies below them is shaded: the reference itself is no better."""
        heights = [self.scale.place(floor) for floor in self.floors.values()]
        if not heights:
            return
        self.axes.axhspan(self.scale.bottom, max(heights), color="0.95", lw=0, zorder=-3)
        for y in heights:
            self.axes.axhline(y, color="0.35", lw=0.9, ls=(0, (1, 1.5)), zorder=1)

    def _draw_front(self) -> None:
        corners = self._front()
        self.axes.plot(*zip(*corners, strict=True), "-", color="0.55", lw=1.1, zorder=2)

    def _front(self) -> list[tuple[float, float]]:
        """The corners of the staircase: an error is had from the time of the first method that is as exact."""
        best = [self.marks[i] for i in pareto_front([(m.seconds, m.error) for m in self.marks])]
        corners = [(best[0].seconds, self.scale.high)]
        for mark, after in zip(best, [*best[1:], None], strict=True):
            y = self.scale.place(mark.error)
            corners += [(mark.seconds, y), (after.seconds if after else self.axes.get_xlim()[1], y)]
        return corners

    def name_marks(self) -> None:
        """The names, and a thin line from each that stands apart from its mark."""
        axes = self.axes
        dots = axes.figure.dpi / 72
        to_dots, to_data = axes.transData.transform, axes.transData.inverted().transform
        anchors = np.array([to_dots((m.seconds, self.scale.place(m.error))) for m in self.marks])
        frame = axes.bbox.extents
        lines = [*pairwise(self._front())]
        lines += [((m.lower, y), (m.upper, y)) for m in self.marks for y in [self.scale.place(m.error)]]
        crowd = Crowd(
            anchors,
            MARK / 2 * dots,
            (frame[0] + 2 * dots, frame[1] + 2 * dots, frame[2] - 2 * dots, frame[3] - 2 * dots),
            [self._name_floor(*named) for named in self.floors.items()],
            np.array([[*to_dots(a), *to_dots(b)] for a, b in lines]),
        )
        sizes = np.array([self._size(mark.name) for mark in self.marks])
        for mark, anchor, box in zip(self.marks, anchors, place_labels(crowd, sizes), strict=True):
            x, y = to_data(box[:2])
            axes.text(x, y, mark.name, fontsize=NAME, va="bottom", ha="left", zorder=2.5, bbox=GROUND)
            line = leader(anchor, box)
            if np.hypot(*(line[2:] - line[:2])) > (MARK / 2 + 4) * dots:
                ends = to_data(line.reshape(2, 2))
                axes.plot(ends[:, 0], ends[:, 1], "-", color="0.45", lw=0.4, zorder=1.5)

    def _name_floor(self, text: str, floor: float) -> Box:
        """Says what a floor is, at its right end, and returns the box that this takes."""
        text += ": 0" if floor == 0 else ""
        x, y = self.axes.transData.transform((self.axes.get_xlim()[1], self.scale.place(floor)))
        dots = self.axes.figure.dpi / 72
        width, height = self._size(text)
        box = (x - width - 3 * dots, y + 1 * dots, x - 3 * dots, y + 1 * dots + height)
        left, low = self.axes.transData.inverted().transform(box[:2])
        self.axes.text(left, low, text, fontsize=NAME, style="italic", va="bottom", ha="left", color="0.25", zorder=5)
        return box

    def _size(self, text: str) -> tuple[float, float]:
        """Width and height of a text in dots."""
        artist = self.axes.text(0, 0, text, fontsize=NAME)
        extent = artist.get_window_extent()
        artist.remove()
        return extent.width, extent.height


def _draw_processes(axes: "Axes", study: SceneStudy) -> None:
    """A line a method, the fastest on top: warm, a whole process, and one that has to compile its kernels."""
    drawn = sorted(study.drawn, key=lambda m: m.warm)
    for y, m in enumerate(drawn):
        whole = [process.whole for process in (m.cold, m.bare) if process is not None]
        axes.plot([m.warm, *whole], [y] * (1 + len(whole)), "-", color="0.6", lw=0.6, zorder=1)
        axes.plot(m.warm, y, color="black", ms=MARK - 0.5, mew=0.7, ls="", zorder=3, **STYLES[m.method.family])
        for seconds, marker in zip(whole, ("|", "x"), strict=False):
            axes.plot(seconds, y, marker, color="black", ms=MARK - 0.5, mew=0.9, zorder=3)
    axes.set_yticks(range(len(drawn)), [m.method.name for m in drawn], fontsize=NAME)
    axes.set_ylim(len(drawn) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.set_title("mark: warm;   | a whole process;   x one that has to compile its kernels first", fontsize=8)
    _scale_seconds(axes, [seconds for m in drawn for seconds in _all_seconds(m)])


def _quartiles(seconds: Sequence[float]) -> tuple[float, float, float]:
    lower, middle, upper = np.quantile(seconds, (0.25, 0.5, 0.75))
    return float(lower), float(middle), float(upper)


def _all_seconds(m: Measured) -> list[float]:
    return [m.warm, *(process.whole for process in (m.cold, m.bare) if process is not None)]


def _scale_seconds(axes: "Axes", seconds: Sequence[float]) -> None:
    """A logarithmic axis of time that holds them all, its numbers written out."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    low, high = (min(seconds), max(seconds)) if seconds else (0.1, 1.0)
    room = (high / low) ** 0.06 * 1.06
    axes.set_xscale("log")
    axes.set_xlim(low / room, high * room)
    axes.xaxis.set_major_locator(LogLocator(10, (1.0, 2.0, 5.0), numticks=100))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.tick_params(axis="x", labelsize=7)
    axes.set_xlabel("seconds", fontsize=8)
    axes.grid(True, color="0.92", lw=0.4, zorder=-2)
    axes.set_axisbelow(True)
