"""Large and small numbers: scenes of any size, far from the origin, and with large and small things side by side."""

from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import assert_never

import numpy as np

from converter.renderers.native import NativeRenderer
from converter.scene.model import Checker, Csg, Finish, Object, Plane, Polyhedron, Quadric, Scene, Shape, Sphere, Vector
from converter.shapes import quadric_form
from converter.studies.families.scenes import (
    GLASS,
    MATTE,
    MIRROR,
    Body,
    box,
    camera,
    floor,
    light,
    scaled,
    scene,
    settings,
)
from converter.studies.family import Case, Family, Truth

GLOSSY = Finish(0.1, 0.6, 0.4, 30.0, 0.25, 0.0, 0.0)


@cache
def still_life() -> Scene:
    """Two balls and a box that stand on a checkered floor, one ball of glass, under two lights.

    Every coordinate is a multiple of 1/256, and the floor's cells are 1 wide.
    """
    view = camera((0.375, 2.5, 7.25), (0.0, 0.75, 0.0))
    bodies: list[Body] = [
        (floor(0.0), Checker((0.9, 0.9, 0.8), (0.2, 0.35, 0.3), 1.0), MATTE),
        (Sphere((-1.25, 1.0, 0.0), 1.0), (0.8, 0.3, 0.2), GLOSSY),
        (Sphere((1.0, 0.75, 1.25), 0.75), (0.0, 0.0, 0.0), replace(GLASS, kr=0.0)),
        (box((0.25, 0.0, -2.5), (2.0, 1.5, -1.0)), (0.3, 0.4, 0.9), MATTE),
        (Sphere((-0.25, 0.375, 1.75), 0.375), (0.0, 0.0, 0.0), MIRROR),
    ]
    lights = [light((-4.0, 6.0, 5.0), (0.8, 0.8, 0.8)), light((5.0, 4.0, 3.0), (4.0, 4.0, 4.0), (0.0, 0.25, 0.125))]
    return scene(view, bodies, lights, (0.5, 0.6, 0.7))


_SETTINGS = settings(background=(0.5, 0.6, 0.7), max_depth=6)


@cache
def still_picture() -> Truth:
    """What `still_life` looks like, wherever and however large it is."""
    return np.asarray(NativeRenderer("long double").render(still_life(), _SETTINGS).pixels, dtype=np.float64)


_EDGES = 0.0025
"""Share of the pixels, 4 of them, through which an edge or a shadow's runs so near the middle that single precision
cannot tell the sides, at whatever size."""


_BEYOND = (14, 16, 18, 20, 30, 50, 100, 150, 152)
"""Where squares, in single and in double precision, leave the range of numbers."""


def _size(factor: float) -> Case:
    return Case(scaled(still_life(), factor), _SETTINGS, still_picture(), _EDGES)


def _position(distance: float) -> Case:
    # Whole cells, an even number of them, so that the checker's colours stay.
    return Case(moved(still_life(), (distance, 2 * distance, -distance)), _SETTINGS, still_picture(), _EDGES)


def moved(whole: Scene, way: Vector) -> Scene:
    """`whole` with its bodies, lights and camera moved; its pigments stay."""

    def vector(v: Vector) -> Vector:
        return (v[0] + way[0], v[1] + way[1], v[2] + way[2])

    def plane(p: Plane) -> Plane:
        a, b, c, d = p
        return (a, b, c, d - (a * way[0] + b * way[1] + c * way[2]))

    def shape(s: Shape) -> Shape:
        match s:
            case Sphere(center, radius):
                return Sphere(vector(center), radius)
            case Polyhedron(planes):
                return Polyhedron(tuple(map(plane, planes)))
            case Quadric():
                return quadric_form.moved(s, [Fraction(x) for x in way])
            case Csg(operands):
                return Csg(tuple(replace(operand, shape=shape(operand.shape)) for operand in operands))
        assert_never(s)

    view = whole.camera
    return replace(
        whole,
        camera=replace(view, eye=vector(view.eye), look_at=vector(view.look_at)),
        lights=tuple(replace(source, position=vector(source.position)) for source in whole.lights),
        objects=tuple(Object(o.pigment, o.finish, shape(o.shape)) for o in whole.objects),
    )


def _huge(ratio: float) -> Case:
    view = camera((0.5, 3.0, 6.0), (0.0, 0.75, 0.0))
    bodies = [
        (Sphere((0.0, -ratio, 0.0), ratio), (0.4, 0.7, 0.4), MATTE),
        (Sphere((0.0, 1.0, 0.0), 1.0), (0.8, 0.3, 0.2), GLOSSY),
    ]
    return Case(scene(view, bodies, [light((-4.0, 6.0, 3.0))]), settings(background=(0.5, 0.6, 0.7), max_depth=4), None)


FAMILIES = (
    Family(
        "size",
        "A still life of balls, glass and a box on a checkered floor, all of it times a number: the picture stays.",
        "size of the scene",
        tuple(10.0**power for power in (*(-p for p in reversed(_BEYOND)), *range(-12, 13, 2), *_BEYOND)),
        _size,
        both_ways=True,
    ),
    Family(
        "position",
        "The same still life, moved away from the origin with its camera and lights by numbers that doubles hold: "
        "the picture stays.",
        "distance from the origin, where the scene is about 8 wide",
        tuple(10.0**power for power in range(14)),
        _position,
    ),
    Family(
        "huge",
        "A ball of radius 1 rests on a ball a number of times as large, and throws its shadow on it.",
        "radius of the larger ball over the smaller one's",
        tuple(10.0**power for power in range(13)),
        _huge,
    ),
)
