"""Distributed ray tracing: lamps of any size, cones up to half of all directions, lenses, bodies that move.

Samples are the same numbers in every method, so that noise is no difference: the native tracer in long double with the
same samples is the truth of most.
"""

import math
from dataclasses import replace

import numpy as np

from converter.scene.model import Checker, Finish, Light, Polyhedron, Scene
from converter.studies.families.closed_forms import window
from converter.studies.families.scenes import GLOW, MATTE, WHITE, Body, camera, floor, light, scene, settings, sphere
from converter.studies.family import Case, Family

_SETTINGS = replace(settings(), samples=4)
RED, BLUE = (0.9, 0.2, 0.1), (0.1, 0.2, 0.9)
_BALL = sphere((0.3, 1.2, 0.1), 0.9)


def _room(lamp: Light) -> Scene:
    """A ball over a floor."""
    view = camera((1.0, 3.0, 6.0), (0.0, 0.6, 0.0))
    return scene(view, [(floor(), WHITE, MATTE), (_BALL, WHITE, MATTE)], [lamp])


def _radius(ratio: float) -> Case:
    """A lamp of that radius, four units away: of a huge one half of what is sampled lies below the floor."""
    return Case(_room(replace(light((1.0, 4.0, 1.5)), radius=4.5 * ratio)), _SETTINGS, None)


def _cut_lamp(height: float) -> Case:
    """The floor cuts the lamp."""
    return Case(_room(replace(light((2.5, 0.8 * height, 1.5)), radius=0.8)), _SETTINGS, None)


def _mirrored_wall(view_height: float, cone: float) -> Scene:
    """A wall seen in a floor, at a glance or from above."""
    finish = Finish(0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, cone=cone)
    eye = (0.2, view_height, 3.0)
    view = camera(eye, (0.1, 0.0, 0.3), 30.0 if view_height > 0.5 else 2 * math.degrees(math.atan(view_height / 6)))
    wall = Polyhedron(((0.0, 0.0, 1.0, 4.0),))
    return scene(view, [(floor(), WHITE, finish), (wall, Checker(RED, BLUE, 1.7), GLOW)])


def _cone(degrees: float) -> Case:
    return Case(_mirrored_wall(2.0, degrees), _SETTINGS, None)


def _glance(height: float) -> Case:
    """Nearly half of the cone lies below the floor, and is mirrored in it."""
    return Case(_mirrored_wall(height, 20.0), _SETTINGS, None)


def _aperture(ratio: float) -> Case:
    """What is in focus is as sharp as through a pinhole."""
    x, y = window(_SETTINGS)
    n = math.isqrt(_SETTINGS.samples or 1)
    tangent, size = math.tan(math.radians(20)), 0.93
    view = replace(camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), aperture=5 * ratio, focal=5.0)
    wall = Polyhedron(((0.0, 0.0, 1.0, 5.0),))
    made = scene(view, [(wall, Checker(RED, BLUE, size), GLOW)])
    shares = np.zeros(x.shape)
    for i in range(n):
        for j in range(n):
            along = (x + 2 * ((i + 0.5) / n - 0.5) / _SETTINGS.height) * 5 * tangent
            up = (y - 2 * ((j + 0.5) / n - 0.5) / _SETTINGS.height) * 5 * tangent
            shares += (np.floor(along / size) + np.floor(up / size) + np.floor(-5 / size)) % 2 / n**2
    truth = (1 - shares[..., None]) * np.array(RED) + shares[..., None] * np.array(BLUE)
    return Case(made, _SETTINGS, truth)


def _defocus(ratio: float) -> Case:
    """A lens as large as that, whatever is seen through it: a ball of a tenth, with its shadow."""
    made = _room(light((1.0, 4.0, 1.5)))
    return Case(replace(made, camera=replace(made.camera, aperture=6 * ratio, focal=6.0)), _SETTINGS, None)


def _flight(length: float) -> Case:
    """A ball that flies through the camera, and is seen from inside as long as it is there."""
    way = (0.6 * length, 0.2 * length, length)
    start = (-way[0] / 2, -way[1] / 2, -way[2] / 2)
    view = camera((0.02, 0.05, 0.1), (0.0, 0.0, -1.0), 60.0)
    bodies: list[Body] = [
        (sphere(start, 1.0), Checker(RED, BLUE, 0.61), GLOW),
        (Polyhedron(((0.0, 0.0, 1.0, 9.0),)), WHITE, MATTE),
    ]
    made = scene(view, bodies, [light((1.0, 4.0, 1.5))])
    objects = (replace(made.objects[0], move=way), *made.objects[1:])
    return Case(replace(made, objects=objects), _SETTINGS, None)


def _seed(seed: float) -> Case:
    lamp = replace(light((1.0, 4.0, 1.5)), radius=1.0)
    return Case(_room(lamp), replace(_SETTINGS, seed=int(seed)), None)


FAMILIES = (
    Family(
        "light-radius",
        "A lamp over a ball and a floor that is nearly a point, or far larger than what it lights.",
        "radius over distance",
        tuple(10.0**power for power in range(-6, 7, 2)),
        _radius,
        both_ways=True,
    ),
    Family(
        "light-cut",
        "A lamp whose centre comes down to the floor that it lights and that cuts it.",
        "height of the centre in radii",
        (*(2.0**-power for power in range(0, 52, 8)), 0.0),
        _cut_lamp,
    ),
    Family(
        "cone",
        "A wall seen in a mirror whose rays are spread in a cone: nearly not, or over half of all directions.",
        "half-angle in degrees",
        (*(10.0**power for power in range(-9, 2, 2)), 30.0, 60.0, 90.0),
        _cone,
    ),
    Family(
        "cone-glance",
        "A wall seen in a dull mirror at a glancing angle, so that nearly half of the cone would lie below it.",
        "height of the camera, 3 away",
        tuple(10.0**-power for power in range(7)),
        _glance,
    ),
    Family(
        "aperture",
        "A checkered wall in focus: it is as sharp as through a pinhole, however large the lens.",
        "aperture over distance",
        tuple(10.0**power for power in range(-8, 9, 2)),
        _aperture,
        both_ways=True,
    ),
    Family(
        "defocus",
        "A ball and its shadow through a lens that is nearly a pinhole, or larger than all that is seen.",
        "aperture over distance",
        tuple(10.0**power for power in range(-8, 9, 2)),
        _defocus,
        both_ways=True,
    ),
    Family(
        "flight",
        "A checkered ball that flies through the camera while the shutter is open, slowly or fast.",
        "displacement in radii",
        tuple(10.0**power for power in range(-6, 7, 2)),
        _flight,
        both_ways=True,
    ),
    Family(
        "seed",
        "A soft shadow with one seed after the other.",
        "seed",
        (1.0, 255.0, 65536.0, 2.0**31 - 1, 2.0**31, 2.0**32 - 1),
        _seed,
    ),
)
