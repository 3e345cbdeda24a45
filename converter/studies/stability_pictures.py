"""What failures look like: for every family the truth beside the picture of a method that fails, on one sheet."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from converter.compare.metrics import Pixels, clamped
from converter.studies.family import Truth
from converter.studies.figure_png import save_png
from converter.studies.stability import FamilyStudy, Outcome
from converter.studies.stability_report import number

COLUMNS = 3
WIDTH, GAP, TITLE, MARGIN = 144, 6, 22, 16
"""Dots: a picture's width, what is between the two of a pair, the room for their title, and between pairs."""
DPI = 100

SEEN: Mapping[str, tuple[str, str]] = {
    "size": ("mitsuba-offset", "shadows and mirror images are gone where the offset of rays is as large as the balls"),
    "position": ("native-float", "mirrors and glass show the sky where coordinates have no digits left for the scene"),
    "huge": ("mitsuba-offset", "the large ball shades itself, for its surface is rounded by more than the offset"),
    "distance": ("mitsuba-ulp", "the ball's rim is dark, for the hits of a far eye lie below its surface"),
    "grazing": ("native-float", "the ball ends where rounding puts its edge, for all rays of a row alike"),
    "resting": ("mitsuba-ulp", "dots on the floor are dark, for their shadow rays start inside the ball or the floor"),
    "touching": ("mitsuba-offset", "single pixels at the edge of the shadow"),
    "gap": ("mitsuba-offset", "light falls into a closed gap, for shadow rays start beyond its roof"),
    "plate": ("mitsuba-ulp", "the floor shades itself in dots, for its hits lie below it by more than the offset"),
    "low-light": ("native-float", "the floor is grainy: of how high the light is above it no digits are left"),
    "coplanar": ("povray", "of two faces in one plane, rounding chooses one for every ray"),
    "nearly-coplanar": ("native-float", "of two floors, rounding chooses one for every ray"),
    "checker-boundary": ("mitsuba-offset", "cells of the layer below appear, for hits have fallen beneath the floor"),
    "texmap-seam": ("mitsuba-offset", "the columns of texels lie elsewhere, where hits have been rounded to"),
    "slivers": ("native-float", "the wedge goes on beyond its edge: its two sides are parallel in single precision"),
    "threads": ("native-float", "the prism is as thick as rounded planes make it"),
    "horizon": ("mitsuba-mesh", "what lies beyond the box that ends all meshes is missing"),
    "empty": ("native-float", "a face shows where two planes exclude each other by less than a rounding"),
    "quadric-edge": ("native-float", "the ellipsoid ends where rounding puts its edge, beyond all rays or before them"),
    "needles": ("native-float", "the needle's sides are flat, for places across it have no digits left"),
    "nearly-parabolic": ("mitsuba-mesh", "a mesh of something so large has no triangles to spare for what is near"),
    "bowls": ("native-float", "the bowl is gone: its two surfaces are one in single precision"),
    "glass-shells": ("native-float", "the inner surface is passed over: a ball of glass is left"),
    "flush": ("native-float", "the lid is gone, and the cave below it open"),
    "crescents": ("native-float", "nothing is left: the two balls are one in single precision"),
    "onions": ("mitsuba-offset", "single pixels where shadow rays start beyond a wall, or a mesh ends beside its ball"),
    "facing-mirrors": ("native-float", "tiles of far images are mixed up, since each bounce has added to the error"),
    "mirror-box": ("mitsuba-offset", "tiles of far images are mixed up, since each bounce has moved the ray a little"),
    "mirror-corner": (
        "native-float",
        "colours appear where mirrors meet: within a rounding rays get out between them",
    ),
    "trapped-ray": ("native-float", "after so many bounces chance decides which tiles a ray meets"),
    "critical-angle": (
        "native-float",
        "light ends at another angle, comes back beyond, and the tiles near it are stretched",
    ),
    "grazing-glass": ("native-float", "rays near the edge of the ball are bent by another angle"),
    "grazing-rarer": ("native-float", "nothing is reflected: the two indices are one in single precision"),
    "index-near-1": ("mitsuba-offset", "the tiles behind the glass are shifted by as much as rays are"),
    "nested-glass": ("native-float", "the inner ball is passed over, so that its far side is met from nowhere"),
    "bubble": ("native-float", "the bubble is passed over: a ball of glass is left"),
    "inside-glass": ("native-float", "the eye is taken to be outside, and sees the room without the glass"),
    "overlapping-glass": ("native-float", "the lens is gone, and what is behind it larger"),
    "highlight": ("native-float", "the highlight is too dim or too bright, in rings of a rounded cosine"),
    "light-distance": ("native-float", "the spot is bent, since the way to the light is a difference of large numbers"),
    "camera-height": ("native-float", "the floor is gone: the eye has been rounded into it"),
    "fovy": ("native-float", "the tiles lie elsewhere: directions differ by less than a rounding"),
    "view-up": (
        "native-float",
        "the picture is turned, and its size another: little is left of the up vector",
    ),
    "light-radius": (
        "mitsuba-offset",
        "single pixels where a shadow ray, moved a little, passes the ball on the other side",
    ),
    "cone": ("mitsuba-offset", "single pixels in which a ray, moved a little, meets another tile"),
    "cone-glance": ("mitsuba-offset", "rays that are moved off the floor meet other tiles"),
    "aperture": ("native-float", "the tiles are blurred: places on the wall are differences of far larger numbers"),
    "defocus": ("mitsuba-ulp", "the ball shades itself, for the hits of rays from far away lie below its surface"),
    "light-on-floor": ("mitsuba-mesh", "no light arrives where numbers are too large for Embree"),
    "light-on-ball": ("mitsuba-mesh", "neither light nor wall is left where numbers are too large for Embree"),
    "camera-on-floor": ("mitsuba-offset", "the floor hides what is below it: to Embree the eye is above"),
    "camera-on-ball": ("mitsuba-offset", "rounding decides for every ray whether it starts within the ball"),
    "tie-tile": ("native-float", "tiles run together: coordinates have no digits left for them"),
    "tie-texel": ("native-float", "texels are as wide as roundings make them"),
    "tie-along": ("native-float", "the walls are gone, for coordinates have no digits left for them"),
    "tie-in-plane": ("native-float", "the boxes are gone, for coordinates have no digits left for them"),
    "tie-edge": ("native-float", "the box is gone, for coordinates have no digits left for it"),
    "tie-bodies": ("native-float", "the edge between two bodies is jagged"),
    "tie-shadow": ("native-float", "light falls in steps, and the shadow is gone"),
    "tie-tangent": ("native-float", "the eye has been rounded into the ball"),
    "tie-critical": ("native-float", "nothing is seen from within the glass"),
    "tie-mirrored": ("native-float", "tiles are mixed up, since many rays meet their edges"),
}
"""For each family a method that fails in it, and what is to be seen then."""


@dataclass(frozen=True, slots=True)
class Failure:
    """A picture that shows how a method fails in a family."""

    family: str
    method: str
    outcome: Outcome
    seen: str

    @property
    def at(self) -> str:
        """The stressed number."""
        return number(self.outcome.value)


def failures_to_show(studies: Sequence[FamilyStudy]) -> Iterator[Failure]:
    """In the order of the families; where the method of the table was not tried or does not fail, there is none."""
    for study in studies:
        method, seen = SEEN.get(study.family.name, ("", ""))
        kept = [outcome for outcome in study.outcomes.get(method, ()) if outcome.pixels is not None]
        yield from (Failure(study.family.name, method, outcome, seen) for outcome in kept[:1])


def draw_failures(failures: Sequence[Failure], file: Path) -> None:
    """Draw the sheet into a PNG file, at once and not atomically: left the truth, right the method.

    Raises:
        OSError: it cannot be written.

    """
    from matplotlib.figure import Figure

    height = max(_height(failure) for failure in failures)
    cell = 2 * WIDTH + GAP + MARGIN, height + TITLE + MARGIN
    columns = min(COLUMNS, len(failures))
    rows = math.ceil(len(failures) / columns)
    width, total = columns * cell[0] + MARGIN, rows * cell[1] + MARGIN
    figure = Figure((width / DPI, total / DPI), dpi=DPI)
    for k, failure in enumerate(failures):
        row, column = divmod(k, columns)
        left, top = MARGIN + column * cell[0], MARGIN + row * cell[1]
        figure.text(left / width, 1 - (top + 0.5 * TITLE) / total, failure.family, size=8, weight="bold", va="center")
        told = f"at {failure.at}, {failure.method}"
        right = (left + 2 * WIDTH + GAP) / width
        figure.text(right, 1 - (top + 0.5 * TITLE) / total, told, size=7, va="center", ha="right", color="0.3")
        for side, picture in enumerate((failure.outcome.truth, failure.outcome.pixels)):
            assert picture is not None
            place = left + side * (WIDTH + GAP), total - top - TITLE - _height(failure)
            axes = figure.add_axes((place[0] / width, place[1] / total, WIDTH / width, _height(failure) / total))
            axes.imshow(_shown(picture), interpolation="nearest", aspect="auto")
            axes.set_xticks([])
            axes.set_yticks([])
            axes.spines[:].set(color="0.6", linewidth=0.5)
    save_png(figure, file, DPI)


def _height(failure: Failure) -> int:
    assert failure.outcome.truth is not None
    height, width = failure.outcome.truth.shape[:2]
    return int(WIDTH * height / width)


def _shown(picture: Pixels | Truth) -> Pixels:
    """Colours as a screen has them; what is no number is magenta."""
    known = np.isfinite(picture).all(axis=2, keepdims=True)
    return np.where(known, clamped(picture.astype(np.float32)), np.array((1.0, 0.0, 1.0), np.float32))
