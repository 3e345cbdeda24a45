"""Highlights, lights near and far and inside bodies; the camera near a surface, wide or narrow, looking straight up."""

import math

import numpy as np

from converter.scene.model import Checker, Finish, Polyhedron, Vector
from converter.studies.families.closed_forms import directions, dot, long, two_colors, unit, window
from converter.studies.families.scenes import (
    ALONG,
    BLACK,
    GLOW,
    MATTE,
    NORMAL,
    WHITE,
    Body,
    box,
    camera,
    floor,
    light,
    on_slope,
    scene,
    settings,
    slope,
    sphere,
)
from converter.studies.family import Case, Family

_SETTINGS = settings()
RED, BLUE = (0.9, 0.2, 0.1), (0.1, 0.2, 0.9)


def _highlight(alpha: float) -> Case:
    """The highlight, as wide as 1 / sqrt(alpha), fills the picture."""
    shiny = Finish(0.1, 0.3, 0.6, alpha, 0.0, 0.0, 0.0)
    view = camera((0.0, 0.0, 4.0), (0.0, 0.0, 1.0), math.degrees(2 * math.atan(0.3 / math.sqrt(alpha))))
    made = scene(view, [(sphere((0.0, 0.0, 0.0), 1.0), WHITE, shiny)], [light((0.0, 0.0, 5.0))])
    return Case(made, _SETTINGS, None)


def _dull(alpha: float) -> Case:
    """A highlight as wide as the ball's lit side, but for where no light is mirrored toward the viewer."""
    dull = Finish(0.1, 0.3, 0.6, alpha, 0.0, 0.0, 0.0)
    eye, lamp = (0.0, 0.0, 4.0), (6.0, 4.0, -1.0)
    view = camera(eye, (0.0, 0.0, 0.0), 34.0)
    d = directions(view, _SETTINGS)
    closest = -dot(long(eye), d)
    across = long(eye) + closest[..., None] * d
    inside = 1 - dot(across, across)
    n = across - np.sqrt(np.maximum(inside, 0))[..., None] * d
    to_light = unit(long(lamp) - n)
    cosine = dot(n, to_light)
    mirrored = dot(2 * cosine[..., None] * n - to_light, -d)
    highlight = np.maximum(mirrored, 0) ** np.longdouble(alpha)  # 0 ** 0 = 1
    shade = dull.ka + np.where(cosine > 0, dull.kd * cosine + dull.ks * highlight, 0)
    made = scene(view, [(sphere((0.0, 0.0, 0.0), 1.0), WHITE, dull)], [light(lamp)])
    truth = np.where(inside >= 0, shade, 0).astype(np.float64)
    return Case(made, _SETTINGS, np.repeat(truth[..., None], 3, axis=2))


def _light_distance(distance: float) -> Case:
    """Light through the ball's top, of three colours, dimmed each in its way and as bright as makes up for it."""
    lamp = (0.0, 0.0, 1.0 + distance)
    d = lamp[2] - 1.0
    lights = [
        light(lamp, (0.9, 0.0, 0.0), (1.0, 0.0, 0.0)),
        light(lamp, (0.0, 0.9 * d, 0.0), (0.0, 1.0, 0.0)),
        light(lamp, (0.0, 0.0, 0.9 * d * d), (0.0, 0.0, 1.0)),
    ]
    eye, place = (2.0, 1.0, 3.0), (0.0, 0.0, 1.0)
    view = camera(eye, place, math.degrees(2 * math.atan(min(distance, 1.0) / math.dist(eye, place))))
    return Case(scene(view, [(sphere((0.0, 0.0, 0.0), 1.0), WHITE, MATTE)], lights), _SETTINGS, None)


def _light_inside(depth: float) -> Case:
    """A light just below a ball's surface: none of it comes out."""
    view = camera((3.0, 4.0, 5.0), (0.0, 1.0, 0.0))
    bodies: list[Body] = [(sphere((0.0, 1.0, 0.0), 1.0), WHITE, MATTE), (floor(-0.5), WHITE, MATTE)]
    made = scene(view, bodies, [light((0.0, 2.0 - depth, 0.0))])
    ground = directions(view, _SETTINGS)[..., 1] < 0
    return Case(made, _SETTINGS, two_colors(ground, (MATTE.ka,) * 3, BLACK))


def _camera_height(height: float) -> Case:
    """Below the horizon is the floor, above it is not."""
    eye = on_slope(7 + height)
    view = camera(eye, (eye[0] + ALONG[0], eye[1] + ALONG[1], eye[2] + ALONG[2]), 60.0, NORMAL)
    _, y = window(_SETTINGS)
    made = scene(view, [(Polyhedron((slope(),)), WHITE, GLOW)])
    return Case(made, _SETTINGS, two_colors(y < 0, WHITE, BLACK))


def _fovy(degrees: float) -> Case:
    """A wall whose checker's cells grow with the field of view. The wall is a half-space, whose side is seen."""
    tangent = math.tan(math.radians(degrees) / 2)
    x, y = window(_SETTINGS)
    size = 0.37 * tangent
    wall = Polyhedron(((0.0, 0.0, 1.0, 1.0),))
    exact = np.tan(np.longdouble(degrees) * (4 * np.arctan(np.longdouble(1))) / 360) / np.longdouble(size)
    # z = -1 lies in the cell floor(-1 / size).
    odd = (np.floor(x * exact) + np.floor(y * exact) + np.floor(-1 / np.longdouble(size))) % 2 != 0
    view = camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), degrees)
    return Case(scene(view, [(wall, Checker(RED, BLUE, size), GLOW)]), _SETTINGS, two_colors(odd, BLUE, RED))


def _view_up(angle: float) -> Case:
    """The up vector is a little off the view; what is off decides how the picture is turned."""
    eye: Vector = (3.0, 4.0, 5.0)
    up = (-3.0 + angle * 0.5, -4.0 + angle * 1.5, -5.0 - angle)
    view = camera(eye, (0.0, 0.0, 0.0), 40.0, up)
    bodies = [(box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)), Checker(RED, BLUE, 0.75), GLOW)]
    return Case(scene(view, bodies), _SETTINGS, None)


FAMILIES = (
    Family(
        "highlight",
        "A highlight that gets sharper, through a lens that keeps it as large in the picture.",
        "alpha",
        tuple(10.0**power for power in range(13)),
        _highlight,
    ),
    Family(
        "dull",
        "A highlight that gets so dull that it covers all that is lit: alpha becomes 0, and 0 to the power of 0 is 1.",
        "alpha",
        (*(10.0**-power for power in range(13)), 0.0),
        _dull,
    ),
    Family(
        "light-distance",
        "A light near a ball or far from it, dimmed in each of the three ways, and as bright as makes up for that.",
        "distance of the light in radii",
        tuple(10.0**power for power in range(-9, 10)),
        _light_distance,
        both_ways=True,
    ),
    Family(
        "light-inside",
        "A light inside a ball, less and less deep below its surface: nothing outside is lit.",
        "depth in radii",
        tuple(2.0**-power for power in range(1, 52, 3)),
        _light_inside,
    ),
    Family(
        "camera-height",
        "The camera less and less above a slanting floor: it is seen up to the horizon.",
        "height of the camera, 7 from the origin",
        tuple(7 * 2.0**-power for power in range(0, 52, 3)),
        _camera_height,
    ),
    Family(
        "fovy",
        "A camera with a narrow or a wide view of a checkered wall, whose cells grow with it: the picture stays.",
        "fovy in degrees",
        (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0, 90.0, 170.0, 179.0, 179.9, 179.99, 179.9999),
        _fovy,
        both_ways=True,
    ),
    Family(
        "view-up",
        "An up vector nearer and nearer the direction of view: what little it differs decides how the picture turns.",
        "angle, about, in radians",
        tuple(10.0**-power for power in range(14)),
        _view_up,
    ),
)
