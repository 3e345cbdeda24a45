"""Draws the stability study: a panel a family, the share of wrong pixels over the stressed number, a line a method."""

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from io import StringIO
from itertools import accumulate, cycle
from pathlib import Path
from statistics import mean
from typing import TYPE_CHECKING, Any

from converter.studies.chart_figure import DOTS, ErrorScale, error_scale, percent
from converter.studies.stability import FamilyStudy
from converter.studies.stability_report import number
from converter.studies.svg import compact

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS = 3
PANEL, NAMES, ROW, MARGINS = 3.1, 1.75, 2.5, 1.15
"""Inches: a panel's width, the room for names to its right, a row's height, and what of it is above and below."""
NAME = 6.5
"""Size of a method's name, in points."""
SOLID, DASHED, DOTTED, BOTH = "-", (0, (5, 2)), (0, (1, 1.2)), (0, (6, 1.5, 1, 1.5))
STYLES: tuple[dict[str, Any], ...] = (
    {"color": "#0072b2", "ls": SOLID, "lw": 1.8},
    {"color": "#56b4e9", "ls": DASHED, "lw": 1.2},
    {"color": "#d55e00", "ls": SOLID, "lw": 1.8},
    {"color": "#e69f00", "ls": DASHED, "lw": 1.2},
    {"color": "#8c3b1a", "ls": DOTTED, "lw": 1.4},
    {"color": "#009e73", "ls": SOLID, "lw": 1.8},
    {"color": "#cc79a7", "ls": BOTH, "lw": 1.2},
    {"color": "#6a3d9a", "ls": DASHED, "lw": 1.2},
    {"color": "#555555", "ls": BOTH, "lw": 1.2},
    {"color": "#000000", "ls": DOTTED, "lw": 1.4},
)
"""The methods' lines, in their order, the same in every panel: colours that are told apart without red or green, too
(most of them Okabe and Ito's), and dashes where colours are close."""
CROSS: dict[str, Any] = {"marker": "x", "ls": "", "color": "black", "ms": 7, "mew": 1.2}
"""Where a method fails first."""
ENTRY = 0.155
"""Height of a line of the legend, in inches."""


@dataclass(frozen=True, slots=True)
class Line:
    """Methods that do the same throughout: their shares of wrong pixels by value, and where they fail first."""

    names: tuple[str, ...]
    values: tuple[float, ...]
    shares: tuple[float, ...]
    first_failures: tuple[int, ...]


def lines(study: FamilyStudy) -> list[Line]:
    """The lines of a family's panel; methods whose lines would lie on each other share one."""
    groups: dict[tuple[tuple[float, ...], tuple[float, ...], tuple[int, ...]], list[str]] = {}
    for method, outcomes in study.outcomes.items():
        if outcomes:
            values, shares = tuple(o.value for o in outcomes), tuple(o.share for o in outcomes)
            groups.setdefault((values, shares, tuple(study.first_failures(method))), []).append(method)
    return [Line(tuple(names), *key) for key, names in groups.items()]


def draw_stability(studies: Sequence[FamilyStudy], file: Path) -> None:
    """Draw the study into `file`, as SVG or PNG by its ending, at once and not atomically.

    Raises:
        OSError: it cannot be written.

    """
    import matplotlib as mpl

    # Text stays text, and the same figures give the same file.
    text_and_frames: dict[Any, Any] = {"font.sans-serif": ["DejaVu Sans"], "axes.linewidth": 0.6}
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "whitted", **text_and_frames}):
        figure = stability_figure(studies)
        if file.suffix.lower() == ".svg":
            text = StringIO()
            figure.savefig(text, format="svg", metadata={"Date": None})
            file.write_text(compact(text.getvalue()), encoding="utf-8")
        else:
            figure.savefig(file, format="png", dpi=DOTS)


def stability_figure(studies: Sequence[FamilyStudy]) -> "Figure":
    """The study as a matplotlib figure."""
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(studies))
    rows = math.ceil(len(studies) / columns)
    width, head = columns * (PANEL + NAMES), _legend_height(studies, columns)
    height = rows * ROW + head
    figure = Figure((width, height))
    styles = _styles(studies)
    _draw_legend(figure, styles, columns)
    shares = [share for study in studies for line in lines(study) for share in line.shares]
    scale = replace(error_scale(shares, [0.0]), high=1.4)
    for k, study in enumerate(studies):
        row, column = divmod(k, columns)
        left = column * (PANEL + NAMES) + 0.68
        bottom = (rows - row - 1) * ROW + 0.45
        axes = figure.add_axes((left / width, bottom / height, (PANEL - 0.73) / width, (ROW - MARGINS) / height))
        _draw_panel(axes, study, scale, styles)
    return figure


def _styles(studies: Sequence[FamilyStudy]) -> dict[str, dict[str, Any]]:
    """Each method's line, by its name."""
    names = dict.fromkeys(name for study in studies for name, outcomes in study.outcomes.items() if outcomes)
    return dict(zip(names, cycle(STYLES), strict=False))


def _entries(columns: int) -> int:
    """How many entries of the legend stand side by side."""
    return 2 * columns


def _legend_height(studies: Sequence[FamilyStudy], columns: int) -> float:
    """Inches that the legend takes, and the room about it."""
    return math.ceil((len(_styles(studies)) + 1) / _entries(columns)) * ENTRY + 0.3


def _draw_legend(figure: "Figure", styles: dict[str, dict[str, Any]], columns: int) -> None:
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], label=name, **style) for name, style in styles.items()]
    handles.append(Line2D([], [], label="fails here first", **CROSS))
    width, height = figure.get_size_inches()
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.5 / width, 1 - 0.05 / height),
        borderaxespad=0,
        ncols=_entries(columns),
        fontsize=NAME + 0.5,
        handlelength=4,
        columnspacing=2,
        frameon=False,
    )


def _draw_panel(axes: "Axes", study: FamilyStudy, scale: ErrorScale, styles: dict[str, dict[str, Any]]) -> None:
    family, drawn = study.family, lines(study)
    axes.set_title(family.name, fontsize=8, fontweight="bold", loc="left", pad=25)
    about = textwrap.fill(family.about, 64)
    axes.text(0, 1.03, about, fontsize=5.5, transform=axes.transAxes, va="bottom", color="0.2")
    places = _places(family.values)
    _scale_axes(axes, study, scale, places)
    # Dashes over lines without, so that both are seen where they run together.
    for line in sorted(drawn, key=lambda line: styles[line.names[0]]["ls"] != SOLID):
        x = [places[value] for value in line.values]
        y = [scale.place(share) for share in line.shares]
        axes.plot(x, y, zorder=3, clip_on=False, **styles[line.names[0]])
        failing = list(line.first_failures)
        marked = [x[i] for i in failing], [y[i] for i in failing]
        axes.plot(*marked, zorder=4, clip_on=False, **CROSS)
    _name_lines(axes, drawn, scale, styles)


def _places(values: Sequence[float]) -> dict[float, float]:
    """Where values are drawn on a logarithmic axis: 0 a decade below the others."""
    least = min((value for value in values if value > 0), default=1.0)
    return {value: value or least / 10 for value in values}


def _scale_axes(axes: "Axes", study: FamilyStudy, scale: ErrorScale, places: dict[float, float]) -> None:
    values = list(places.values())
    axes.set_xscale("log")
    axes.set_yscale("log")
    room = (max(values) / min(values)) ** 0.03
    axes.set_xlim(values[0] / room, values[-1] * room)
    if values[0] > values[-1]:
        axes.set_xlim(values[0] * room, values[-1] / room)
    axes.set_ylim(scale.bottom, scale.high)
    axes.minorticks_off()
    ticks = [10.0**power for power in range(round(math.log10(scale.low)), 1)]
    axes.set_yticks([scale.place(0), *ticks], ["0", *map(percent, ticks)], fontsize=6)
    axes.axhline(scale.low, color="0.5", lw=0.6, ls=(0, (6, 3)), zorder=0)
    shown = [values[0]]
    for value in values:
        if abs(math.log(value / shown[-1])) > abs(math.log(values[-1] / values[0])) / 7.5:
            shown.append(value)
    if 0 in places and shown[-1] != places[0]:
        shown[-1] = places[0]
    told = {place: number(value) for value, place in places.items()}
    axes.set_xticks(shown, [told[place] for place in shown], fontsize=6)
    axes.set_xlabel(study.family.stress, fontsize=6.5, labelpad=1.5)
    axes.set_ylabel("wrong pixels", fontsize=6.5, labelpad=4)


def _name_lines(axes: "Axes", drawn: Sequence[Line], scale: ErrorScale, styles: dict[str, dict[str, Any]]) -> None:
    """Each name to the right of its line's end, in its colour, and a thin line from there where others push it away."""
    texts = [textwrap.fill(", ".join(line.names), 27, break_on_hyphens=False) for line in drawn]
    height = (ROW - MARGINS) * 72
    ends = [_height_of(scale, line.shares[-1]) * height for line in drawn]
    sizes = [(text.count("\n") + 1) * (NAME + 1.2) + 1.5 for text in texts]
    places = spread(ends, sizes, height + NAME)
    for line, text, end, place in zip(drawn, texts, ends, places, strict=True):
        color = styles[line.names[0]]["color"]
        axes.annotate(
            text,
            (1.01, end / height),
            (1.06, place / height),
            xycoords=axes.transAxes,
            textcoords=axes.transAxes,
            annotation_clip=False,
            fontsize=NAME,
            color=color,
            va="center",
            ha="left",
            linespacing=1.05,
            arrowprops={"arrowstyle": "-", "lw": 0.5, "color": color, "shrinkA": 1, "shrinkB": 0, "relpos": (0, 0.5)},
        )


def _height_of(scale: ErrorScale, share: float) -> float:
    """Where a share is drawn: 0 is the axis's lower end, 1 its upper."""
    return math.log(scale.place(share) / scale.bottom) / math.log(scale.high / scale.bottom)


def spread(places: Sequence[float], sizes: Sequence[float], ceiling: float) -> list[float]:
    """Centres for things of these sizes, in the order of the places they would like, near those, none on another.

    Neighbours that overlap become one block, around the mean of what its members would like, until none do. None rises
    above the ceiling.
    """

    def bottom(block: Sequence[int]) -> float:
        # Where the first would have to begin for each to be where it likes, on average.
        before = accumulate((sizes[i] for i in block), initial=0.0)
        liked = mean(places[i] - sizes[i] / 2 - below for i, below in zip(block, before, strict=False))
        return min(liked, ceiling - sum(sizes[i] for i in block))

    blocks: list[list[int]] = []
    for i in sorted(range(len(places)), key=lambda i: places[i]):
        blocks.append([i])
        while len(blocks) > 1 and bottom(blocks[-2]) + sum(sizes[k] for k in blocks[-2]) > bottom(blocks[-1]):
            last = blocks.pop()
            blocks[-1] += last
    result = [0.0] * len(places)
    for block in blocks:
        low = bottom(block)
        for i in block:
            result[i] = low + sizes[i] / 2
            low += sizes[i]
    return result
