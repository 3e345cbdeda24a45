"""Transparent bodies: where the law of refraction is steep, and where surfaces are nearly one."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from converter.scene.model import Camera, Checker, Finish, Pigment, Polyhedron, Shape, Vector
from converter.scene.settings import Settings
from converter.studies.families.closed_forms import checkered, directions
from converter.studies.families.scenes import GLOW, camera, floor, scene, settings, sphere
from converter.studies.family import Case, Family

DECADES = tuple(10.0**-k for k in range(1, 16))
"""1e-1 to 1e-15."""
DENSER, RARER = 2 / 3, 1.5
"""n1/n2, outside over inside, of glass in air and of air in glass."""


def _settings(max_depth: int) -> Settings:
    """Every `ior` is n1/n2, so that it may be above 1."""
    return replace(settings(max_depth=max_depth), ior="ratio")


def _clear(ratio: float) -> Finish:
    """Lets nearly all through; its own light, with tiles on it, shows where it is."""
    return Finish(0.125, 0.0, 0.0, 1.0, 0.0, 0.875, ratio)


def _tiles(size: float) -> Checker:
    return Checker((0.9, 0.8, 0.7), (0.2, 0.3, 0.4), size)


def _about(size: float, at: float) -> float:
    """About that size of tiles, such that a wall at a coordinate goes through the middle of them."""
    return at / (round(at / size) + 0.5)


def _glasses(view: Camera, bodies: Sequence[tuple[Shape, Finish]], behind: Shape, cell: float = 1.0) -> Case:
    """Transparent bodies before a wall of tiles."""
    things: list[tuple[Shape, Pigment, Finish]] = [(shape, _tiles(0.7), finish) for shape, finish in bodies]
    return Case(scene(view, [*things, (behind, _tiles(cell), GLOW)]), _settings(8), None)


# ---- The critical angle, and grazing ---------------------------------------------------------------------------------


def _critical(window: float) -> Case:
    """From under the surface of a glass of index 2, in a window about the critical angle, 30 degrees.

    Rays that get out skim the surface, and meet a wall at a height that shrinks with the root of the window, as the
    wall's tiles do. The others are reflected into the dark.
    """
    cell = _about(4 * math.sqrt(window), 16.0)
    view = camera((0.0, 0.0, 0.0), (0.5, math.cos(math.radians(30)), 0.0), math.degrees(window), (0.0, 0.0, 1.0))
    drawn, pattern = _settings(1), _tiles(cell)
    glass = (Polyhedron(((0.0, 1.0, 0.0, -1.0),)), pattern, Finish(0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.5))
    wall = (Polyhedron(((-1.0, 0.0, 0.0, 16.0), (0.0, -1.0, 0.0, 0.0))), pattern, GLOW)
    d = directions(view, drawn)
    squared = 1 - 4 * (1 - d[..., 1] ** 2)
    out = squared > 0
    p = d / d[..., 1:2]
    t = (np.longdouble(16.0) - p[..., 0]) / (2 * d[..., 0])
    p = p + t[..., None] * np.stack([2 * d[..., 0], np.sqrt(np.where(out, squared, 0)), 2 * d[..., 2]], axis=-1)
    p[..., 0] = np.longdouble(16.0)
    truth = np.where(out[..., None], checkered(pattern, p), 0.0)
    return Case(scene(view, [glass, wall]), drawn, truth)


def _rarer(step: float) -> Case:
    """Along the surface of something hardly rarer: below a grazing angle of about sqrt(2 step) all is reflected."""
    lens = math.sqrt(step)
    view = camera((0.0, 0.0, 0.0), (1.0, -1.5 * lens, 0.0), math.degrees(3 * lens))
    drawn, cell = _settings(1), _about(4 * lens, 16.0)
    surface = -lens  # so that rays meet it a few units away
    body = (Polyhedron(((0.0, 1.0, 0.0, -surface),)), _tiles(cell), Finish(0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1 + step))
    wall = (Polyhedron(((-1.0, 0.0, 0.0, 16.0),)), _tiles(cell), GLOW)
    return Case(scene(view, [body, wall]), drawn, None)


def _grazing(window: float) -> Case:
    """The edge of a glass ball through an ever longer lens: rays that just meet it turn by nearly a right angle."""
    angle = math.asin(0.25)
    view = camera((0.0, 0.0, 4.0), (math.tan(angle), 0.0, 3.0), math.degrees(window))
    wall = Polyhedron(((1.0, 0.0, 0.0, 8.0),))
    return _glasses(view, [(sphere((0.0, 0.0, 0.0), 1.0), _clear(DENSER))], wall, _about(math.sqrt(window), 8.0))


# ---- Surfaces that are hardly there, or hardly apart -----------------------------------------------------------------

EYE: Vector = (1.0, 2.0, 5.0)
MIDDLE: Vector = (0.0, 0.0, 0.0)


def _index(step: float) -> Case:
    """A ball and a prism that bend light ever less."""
    prism = Polyhedron(
        (
            (0.6, 0.0, 0.8, -0.5),
            (-0.8, 0.0, 0.6, -1.5),
            (0.2, 0.0, -1.0, -0.3),
            (0.0, 1.0, 0.0, -1.25),
            (0.0, -1.0, 0.0, -0.75),
        )
    )
    bodies: list[tuple[Shape, Finish]] = [(sphere((0.75, 0.0, -0.5), 1.0), _clear(1 - step)), (prism, _clear(1 + step))]
    return _glasses(camera(EYE, MIDDLE), bodies, floor(-1.75))


def _shells(gap: float, ratio: float) -> Case:
    bodies = [(sphere(MIDDLE, 1.0), _clear(DENSER)), (sphere(MIDDLE, 1.0 - gap), _clear(ratio))]
    return _glasses(camera(EYE, MIDDLE, 30.0), bodies, floor(-1.75))


def _nested(gap: float) -> Case:
    return _shells(gap, DENSER)


def _bubble(gap: float) -> Case:
    return _shells(gap, RARER)


def _inside(depth: float) -> Case:
    """From just under the surface of a glass ball, along it."""
    view = camera((0.0, 1.0 - depth, 0.0), (0.25, 1.25 - depth, -1.0), 90.0)
    return _glasses(view, [(sphere(MIDDLE, 1.0), _clear(DENSER))], sphere(MIDDLE, 16.0), 4.0)


def _overlap(depth: float) -> Case:
    """Two balls that share a lens, ever thinner, which fills the picture."""
    lens = math.sqrt(depth)
    view = camera((0.0, 0.0, 4.0), (lens / 7, lens / 15, 0.0), math.degrees(lens / 4))
    bodies = [
        (sphere((0.0, 0.0, 1.0 - depth), 1.0), _clear(DENSER)),
        (sphere((0.0, 0.0, depth - 1.0), 1.0), _clear(DENSER)),
    ]
    return _glasses(view, bodies, Polyhedron(((0.0, 0.0, 1.0, 4.0),)), _about(lens / 4, 4.0))


FAMILIES: tuple[Family, ...] = (
    Family(
        "critical-angle",
        "From inside glass, at an ever narrower window about the angle past which all is reflected.",
        "width of the window, in radians",
        DECADES,
        _critical,
    ),
    Family(
        "grazing-glass",
        "The edge of a glass ball through an ever longer lens, where rays enter and leave it at nearly right angles.",
        "width of the window, in radians",
        DECADES,
        _grazing,
    ),
    Family(
        "grazing-rarer",
        "Along the surface of a body hardly rarer than its surroundings, about the angle at which reflection ends.",
        "n1/n2 - 1",
        DECADES,
        _rarer,
    ),
    Family("index-near-1", "Transparent bodies bend light ever less.", "difference of n1/n2 from 1", DECADES, _index),
    Family(
        "nested-glass",
        "A glass ball fills another, ever more closely.",
        "gap over the radius",
        DECADES,
        _nested,
    ),
    Family(
        "bubble",
        "An air bubble fills a ball of glass, and leaves an ever thinner wall.",
        "thickness of the wall over the radius",
        DECADES,
        _bubble,
    ),
    Family(
        "inside-glass",
        "The eye is inside a glass ball, ever closer under its surface.",
        "depth of the eye over the radius",
        DECADES,
        _inside,
    ),
    Family(
        "overlapping-glass",
        "Two glass balls overlap in an ever thinner lens, which fills the picture.",
        "half the lens's thickness over the radius",
        DECADES,
        _overlap,
    ),
)
