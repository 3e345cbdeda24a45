"""Lights and cameras on surfaces: of no distance that is computed to them is the sign known.

They lie there by decimal numbers, as in a file: rounded to doubles they may lie on either side.
"""

import math

import numpy as np

from converter.scene.model import Camera, Finish, Polyhedron, Vector
from converter.studies.families.closed_forms import Long, directions, dot, long, two_colors, unit
from converter.studies.families.scenes import (
    ALONG,
    BLACK,
    GLOW,
    MATTE,
    NORMAL,
    WHITE,
    camera,
    light,
    on_slope,
    scene,
    settings,
    slope,
    sphere,
)
from converter.studies.family import Case, Family, Truth

_SETTINGS = settings()
RED = (0.9, 0.2, 0.1)
SIZES = tuple(10.0**power for power in range(-12, 13, 2))
ON_SLOPE: Vector = (2.9, 2.4, 6.0)
"""2 * 2.9 + 3 * 2.4 + 6 * 6.0 = 7 * 7."""
CENTER: Vector = (0.1, 0.1, 0.1)
ON_BALL: Vector = (2.1, 3.1, 6.1)
"""Of a ball of radius 7 the centre, and a point on it."""


def _sized(v: Vector, size: float) -> Vector:
    """A vector of a few digits times a power of ten, as a file's numbers are read."""
    x, y, z = (float(f"{number}e{round(math.log10(size))}") for number in v)
    return x, y, z


def _along(eye: Vector, size: float, up: Vector = NORMAL, fovy: float = 60.0) -> Camera:
    """A camera that looks along slanting planes."""
    return camera(eye, (eye[0] + ALONG[0] * size, eye[1] + ALONG[1] * size, eye[2] + ALONG[2] * size), fovy, up)


def _grey(shade: Long) -> Truth:
    return np.repeat(shade.astype(np.float64)[..., None], 3, axis=2)


def _light_on_floor(size: float) -> Case:
    """A lamp in a slanting floor, under a roof. It lights all of the roof, and shines along the floor."""
    lamp, eye = _sized(ON_SLOPE, size), on_slope(size * 8.0, size * -2.0, size * 0.125)
    # With an alpha of 0, all that is lit shows the whole highlight.
    shiny = Finish(0.2, 0.5, 0.3, 0.0, 0.0, 0.0, 0.0)
    bodies = [Polyhedron((slope(size * 7.0),)), Polyhedron((slope(size * 9.0, -1.0),))]
    view = _along(eye, size, fovy=90.0)
    d, n = directions(view, _SETTINGS), unit(long(NORMAL))
    rise = dot(n, d)
    p = long(eye) + (size / np.abs(rise))[..., None] * d
    lit = shiny.ka + shiny.kd * dot(n, unit(p - long(lamp))) + shiny.ks
    made = scene(view, [(body, WHITE, shiny) for body in bodies], [light(lamp)])
    return Case(made, _SETTINGS, _grey(np.where(rise > 0, lit, shiny.ka)))


def _light_on_ball(size: float) -> Case:
    """A lamp on a ball, before a slanting wall, all of which it lights."""
    lamp, eye = _sized(ON_BALL, size), on_slope(size * 9.0, size * 0.25, 0.0)
    ball, wall = sphere(_sized(CENTER, size), size * 7.0), Polyhedron((slope(size * 10.0, -1.0),))
    view = camera(eye, on_slope(size * 10.0, 0.0, size * 0.01), 60.0)
    d, n = directions(view, _SETTINGS), unit(long(NORMAL))
    p = long(eye) + ((np.longdouble(size) * 10 - dot(n, long(eye))) / dot(n, d))[..., None] * d
    made = scene(view, [(ball, RED, MATTE), (wall, WHITE, MATTE)], [light(lamp)])
    return Case(made, _SETTINGS, _grey(MATTE.ka + MATTE.kd * dot(n, unit(p - long(lamp)))))


def _camera_on_floor(size: float) -> Case:
    """The eye is in a slanting floor, of which it sees nothing, and looks at a ball that is half below."""
    eye, center, radius = _sized(ON_SLOPE, size), on_slope(size * 7.0, size * 2.0, 0.0), size * 2.0
    view = camera(eye, center, 50.0, NORMAL)
    d = directions(view, _SETTINGS)
    f = long(eye) - long(center)
    across = f - dot(f, d)[..., None] * d
    hit = dot(across, across) <= np.longdouble(radius) ** 2
    made = scene(view, [(Polyhedron((slope(size * 7.0),)), WHITE, GLOW), (sphere(center, radius), RED, GLOW)])
    return Case(made, _SETTINGS, two_colors(hit, RED, BLACK))


def _camera_on_ball(size: float) -> Case:
    """The eye is on a ball: of its rays, half lead through it to the far side."""
    eye, center = _sized(ON_BALL, size), _sized(CENTER, size)
    up = (eye[0] - center[0], eye[1] - center[1], eye[2] - center[2])
    view = _along(eye, size, up)
    made = scene(view, [(sphere(center, size * 7.0), WHITE, GLOW)])
    return Case(made, _SETTINGS, two_colors(dot(directions(view, _SETTINGS), long(up)) < 0, WHITE, BLACK))


FAMILIES = (
    Family(
        "light-on-floor",
        "A light in a slanting floor, in scenes of all sizes: it lights the roof above, and nothing of the floor.",
        "size of the scene",
        SIZES,
        _light_on_floor,
        both_ways=True,
    ),
    Family(
        "light-on-ball",
        "A light on a ball, in scenes of all sizes: it lights what is before it, and the ball is not in its way.",
        "size of the scene",
        SIZES,
        _light_on_ball,
        both_ways=True,
    ),
    Family(
        "camera-on-floor",
        "The camera in a slanting floor, in scenes of all sizes: it sees nothing of the floor, and all beyond it.",
        "size of the scene",
        SIZES,
        _camera_on_floor,
        both_ways=True,
    ),
    Family(
        "camera-on-ball",
        "The camera on a ball, in scenes of all sizes: it sees the ball's far side from within, and nothing else.",
        "size of the scene",
        SIZES,
        _camera_on_ball,
        both_ways=True,
    ),
)
