"""Things that touch or nearly do: shadows that must begin where a body ends, and no shadow of a surface on itself.

They slant, so that no coordinate of a point on them is exact by chance.
"""

import math

import numpy as np

from converter.scene.model import Camera, Plane, Polyhedron, Vector
from converter.studies.families.closed_forms import directions, dot, long
from converter.studies.families.scenes import (
    ALONG,
    ASIDE,
    MATTE,
    NORMAL,
    WHITE,
    Body,
    camera,
    light,
    on_slope,
    scene,
    settings,
    slope,
    sphere,
)
from converter.studies.family import Case, Family

_SETTINGS = settings()
_RED = (0.8, 0.3, 0.2)
_FLOOR = Polyhedron((slope(),))
_HEIGHTS = tuple(7 * 2.0**-power for power in range(3, 52, 3))
"""A decade apart, about."""


def _resting(width: float) -> Case:
    """A ball of radius 7, from the side of its shadow's edge."""
    made: list[Body] = [(_FLOOR, WHITE, MATTE), (sphere(on_slope(14.0), 7.0), _RED, MATTE)]
    view = _close_up(on_slope(21.0, 4.0, 1.0), on_slope(), 7 * width)
    return Case(scene(view, made, [light(on_slope(21.0, 6.0, -1.0))]), _SETTINGS, None)


def _touching(width: float) -> Case:
    """Two balls of radius 7 that touch where the camera looks."""
    made = [(sphere(on_slope(0.0), 7.0), WHITE, MATTE), (sphere(on_slope(14.0), 7.0), _RED, MATTE)]
    view = _close_up(on_slope(8.0, 6.0, 0.25), on_slope(), 7 * width)
    return Case(scene(view, made, [light(on_slope(14.0, 6.0, -1.0))]), _SETTINGS, None)


def _close_up(eye: Vector, place: Vector, width: float) -> Camera:
    return camera(eye, place, math.degrees(2 * math.atan(0.5 * width / math.dist(eye, place))), NORMAL)


def _gap(height: float) -> Case:
    """The eye is in the gap, in whose floor and roof no light falls.

    The roof has no upper end: a light above it is inside, and reaches neither its lower face nor the floor.
    """
    eye = on_slope(7 + height / 2)
    view = camera(eye, (eye[0] + ALONG[0], eye[1] + ALONG[1], eye[2] + ALONG[2]), 90.0, NORMAL)
    roof = Polyhedron((slope(7 + height, -1.0),))
    made = scene(view, [(_FLOOR, WHITE, MATTE), (roof, WHITE, MATTE)], [light(on_slope(14.0, 1.0, 0.25))])
    return Case(made, _SETTINGS, np.full((_SETTINGS.height, _SETTINGS.width, 3), MATTE.ka))


def _plate(thickness: float) -> Case:
    def side(normal: Vector, reach: float) -> Plane:
        return (*normal, -reach * sum(n * n for n in normal))

    back_along, back_aside = (-ALONG[0], -ALONG[1], -ALONG[2]), (-ASIDE[0], -ASIDE[1], -ASIDE[2])
    sides = (side(ALONG, 1.0), side(back_along, 1.0), side(ASIDE, 0.25), side(back_aside, 0.25))
    plate = Polyhedron((slope(9.0 + thickness), slope(9.0, -1.0), *sides))
    view = camera(on_slope(16.0, 4.0, 0.5), on_slope(), 50.0, NORMAL)
    made = scene(view, [(_FLOOR, WHITE, MATTE), (plate, _RED, MATTE)], [light(on_slope(14.0, 0.125, 0.0))])
    return Case(made, _SETTINGS, None)


def _low_light(height: float) -> Case:
    """As bright as makes up for its height: kd cos / height = kd / distance."""
    eye, lamp = on_slope(14.0, 1.0, 0.25), on_slope(7 + height, -1.0, 0.0)
    view = camera(eye, on_slope(), 40.0, NORMAL)
    d = directions(view, _SETTINGS)
    n = long(NORMAL)
    p = long(eye) - d * ((dot(n, long(eye)) - 49) / dot(n, d))[..., None]
    arm = long(lamp) - p
    shade = (MATTE.ka + MATTE.kd / np.sqrt(dot(arm, arm))).astype(np.float64)
    made = scene(view, [(_FLOOR, WHITE, MATTE)], [light(lamp, (1 / height, 1 / height, 1 / height))])
    return Case(made, _SETTINGS, np.repeat(shade[..., None], 3, axis=2))


FAMILIES = (
    Family(
        "resting",
        "A ball rests on a floor: a closer and closer look at the place where it touches, and at its shadow there.",
        "height of the picture in radii",
        tuple(10.0**-power for power in range(13)),
        _resting,
    ),
    Family(
        "touching",
        "Two balls touch: a closer and closer look at that place, where one throws its shadow on the other.",
        "height of the picture in radii",
        tuple(10.0**-power for power in range(13)),
        _touching,
    ),
    Family(
        "gap",
        "The eye between a floor and a roof that come nearer and nearer each other: no light falls in.",
        "height of the gap, 7 from the origin",
        _HEIGHTS,
        _gap,
    ),
    Family(
        "plate",
        "A plate, thinner and thinner, between a light and a floor: its shadow stays.",
        "thickness of the plate, 9 from the origin",
        _HEIGHTS[:-3],  # thinner ones are nothing to a scene's reader
        _plate,
    ),
    Family(
        "low-light",
        "A light nearer and nearer a floor, and as much brighter: the floor does not shade itself.",
        "height of the light, 7 from the origin",
        _HEIGHTS,
        _low_light,
    ),
)
