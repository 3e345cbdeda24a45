"""Things that touch or nearly do: shadows that must begin where a body ends, and no shadow of a surface on itself."""

import math

import numpy as np

from converter.scene.model import Polyhedron
from converter.studies.families.closed_forms import directions, dot, long, two_colors
from converter.studies.families.scenes import (
    MATTE,
    WHITE,
    box,
    camera,
    floor,
    light,
    scene,
    settings,
    sphere,
)
from converter.studies.family import Case, Family

_SETTINGS = settings()
AMBIENT = (MATTE.ka, MATTE.ka, MATTE.ka)


def _resting(width: float) -> Case:
    """A look at the place where the ball touches, `width` wide."""
    eye, place = (1.0, 2.0, 4.0), (0.0, 1.0, 0.0)
    view = camera(eye, place, math.degrees(2 * math.atan(0.5 * width / math.dist(eye, place))))
    bodies = [(floor(1.0), WHITE, MATTE), (sphere((0.0, 2.0, 0.0), 1.0), (0.8, 0.3, 0.2), MATTE)]
    return Case(scene(view, bodies, [light((3.0, 3.0, 1.0))]), _SETTINGS, None)


def _touching(width: float) -> Case:
    eye, place = (0.5, 1.0, 4.0), (1.0, 0.0, 0.0)
    view = camera(eye, place, math.degrees(2 * math.atan(0.5 * width / math.dist(eye, place))))
    bodies = [(sphere((0.0, 0.0, 0.0), 1.0), WHITE, MATTE), (sphere((2.0, 0.0, 0.0), 1.0), (0.8, 0.3, 0.2), MATTE)]
    return Case(scene(view, bodies, [light((4.0, 3.0, 1.0))]), _SETTINGS, None)


def _gap(height: float) -> Case:
    """The eye is in the gap, in whose floor and roof no light falls."""
    view = camera((0.0, 1.0 + height / 2, 0.0), (0.0, 1.0 + height / 2, -1.0), 90.0)
    bodies = [(floor(1.0), WHITE, MATTE), (Polyhedron(((0.0, -1.0, 0.0, 1.0 + height),)), WHITE, MATTE)]
    # The roof has no upper end that the light could be above, and is lit from within as little as the floor.
    lamp = light((0.5, 3.0, 0.5))
    return Case(scene(view, bodies, [lamp]), _SETTINGS, np.full((_SETTINGS.height, _SETTINGS.width, 3), MATTE.ka))


def _plate(thickness: float) -> Case:
    """Seen from below: the plate's shadow on the floor is the square between the light and it."""
    view = camera((0.25, 3.5, 6.0), (0.0, 0.0, 0.0), 60.0)
    plate = box((-1.0, 1.0, -1.0), (1.0, 1.0 + thickness, 1.0))
    lamp = (0.0, 3.0, 0.0)
    bodies = [(floor(0.0), WHITE, MATTE), (plate, WHITE, MATTE)]
    return Case(scene(view, bodies, [light(lamp)]), _SETTINGS, None)


def _low_light(height: float) -> Case:
    """The nearer the light is to the floor, the brighter it is: kd cos / height = kd / distance."""
    eye, lamp = (0.0, 3.5, 2.0), (0.0, 1.0 + height, -3.0)
    view = camera(eye, (0.0, 1.0, 0.0), 40.0)
    d = directions(view, _SETTINGS)
    p = long(eye) + d * ((1 - eye[1]) / d[..., 1])[..., None]
    arm = long(lamp) - p
    shade = MATTE.ka + MATTE.kd / np.sqrt(dot(arm, arm))
    bright = (1 / height, 1 / height, 1 / height)
    made = scene(view, [(floor(1.0), WHITE, MATTE)], [light(lamp, bright)])
    return Case(made, _SETTINGS, np.repeat(shade[..., None].astype(np.float64), 3, axis=2))


FAMILIES = (
    Family(
        "resting",
        "A ball rests on a floor; a closer and closer look at the place where it touches, in and beside its shadow.",
        "height of the picture, in radii",
        tuple(10.0**-power for power in range(13)),
        _resting,
    ),
    Family(
        "touching",
        "Two balls touch; a closer and closer look at that place, where one throws its shadow on the other.",
        "height of the picture, in radii",
        tuple(10.0**-power for power in range(13)),
        _touching,
    ),
    Family(
        "gap",
        "The eye between a floor and a roof, one unit from the origin, that come nearer and nearer each other: "
        "no light falls in.",
        "height of the gap",
        tuple(2.0**-power for power in range(3, 52, 3)),
        _gap,
    ),
    Family(
        "plate",
        "A plate, thinner and thinner, between a light and a floor: its shadow stays.",
        "thickness of the plate",
        tuple(2.0**-power for power in range(3, 52, 3)),
        _plate,
    ),
    Family(
        "low-light",
        "A light nearer and nearer a floor, and as much brighter: the floor does not shade itself.",
        "height of the light",
        tuple(2.0**-power for power in range(3, 52, 3)),
        _low_light,
    ),
)
