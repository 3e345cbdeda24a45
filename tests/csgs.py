"""Csgs to look at: by hand, at random, and what they are by the definition."""

import sys
from pathlib import Path

from converter.scene.model import Csg, Operand, Polyhedron, Quadric, Sphere
from converter.scene.parser import parse_scene
from converter.shapes.primitives import primitive_kind

sys.path.append(str(Path(__file__).parents[1] / "scenes"))
from random_csg import random_csg_scene

BALL = Sphere((0.0, 0.0, 0.0), 1.0)
FAR = Sphere((5.0, 5.0, 5.0), 1.0)
RIGHT = Sphere((0.75, 0.25, 0.0), 0.75)
CYLINDER = Quadric((1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.25))


def half_space(*plane: float) -> Polyhedron:
    """Of four numbers."""
    a, b, c, d = map(float, plane)
    return Polyhedron(((a, b, c, d),))


def box(low, high) -> Polyhedron:
    """A box along the axes."""
    planes = []
    for axis in range(3):
        a, b, c = (float(k == axis) for k in range(3))
        planes += [(-a, -b, -c, float(low[axis])), (a, b, c, -float(high[axis]))]
    return Polyhedron(tuple(planes))


CUBE = box((-1, -1, -1), (1, 1, 1))


def csg(*steps) -> Csg:
    """Of signs and shapes, one after the other: `csg("+", BALL, "-", CUBE)`."""
    return Csg(tuple(Operand(sign, shape) for sign, shape in zip(steps[::2], steps[1::2], strict=True)))


def random_csg(seed: int) -> Csg:
    """That of `scenes/random_csg.py`."""
    shape = parse_scene(str(random_csg_scene(seed))).objects[1].shape
    assert isinstance(shape, Csg)
    return shape


def is_inside(shape, point) -> bool:
    """By the definition, step after step, of a point that is on no leaf's surface."""
    if not isinstance(shape, Csg):
        return primitive_kind(shape).contains(shape, point)
    whole = False
    for operand in shape.operands:
        inside = is_inside(operand.shape, point)
        whole = {"+": whole or inside, "-": whole and not inside, "&": whole and inside}[operand.operation]
    return whole
