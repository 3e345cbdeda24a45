"""Convex sets that a csg is in: they give its box, and tell where it is nothing.

A leaf is looked at with the half-spaces of all that it is intersected with, so that a cylinder between two planes has
bounds. A quadric is bounded in the coordinates along its axes, by what its polynomial leaves of the intervals there.
"""

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import NamedTuple

from converter.scene.model import Csg, Plane, Polyhedron, Primitive, Quadric, Vector
from converter.shapes.csg_program import DIFFERENCE, UNION, Program, fold, program_of
from converter.shapes.kind import Facts

ROOM = 1e-9
"""By what share of their size intervals are wider than computed."""


class Region(NamedTuple):
    """A convex set that holds something: what half-spaces and a box have in common, whose corners may be infinite."""

    planes: tuple[Plane, ...]
    low: Vector = (-math.inf,) * 3
    high: Vector = (math.inf,) * 3

    @property
    def bounded(self) -> bool:
        """Whether the box is finite."""
        return all(map(math.isfinite, (*self.low, *self.high)))

    @property
    def sides(self) -> tuple[Plane, ...]:
        """All half-spaces, those of the box among them."""
        return tuple(dict.fromkeys((*self.planes, *box_planes(self.low, self.high))))


def box_planes(low: Vector, high: Vector) -> Iterator[Plane]:
    """The sides of a box that are somewhere."""
    for axis in range(3):
        for corner, sign in ((low, -1.0), (high, 1.0)):
            if math.isfinite(corner[axis]):
                a, b, c = (sign * float(k == axis) for k in range(3))
                yield (a, b, c, -sign * corner[axis])


@lru_cache(maxsize=4096)
def region_of(shape: Csg) -> Region | None:
    """What a csg is in; None if it is known to be nothing."""
    program = program_of(shape)
    if not program.code:
        return Region(()) if program.everything else None
    return _region(program, fold(program.code, _Leaf, _Node), ())


class _Leaf(NamedTuple):
    leaf: int


class _Node(NamedTuple):
    operation: int
    a: "_Leaf | _Node"
    b: "_Leaf | _Node"


def _region(program: Program, node: _Leaf | _Node, around: tuple[Plane, ...]) -> Region | None:
    """What an expression is in where it is in some half-spaces."""
    if isinstance(node, _Leaf):
        return _leaf_region(program.leaves[node.leaf], program.facts[node.leaf], around)
    if node.operation == UNION:
        found = [_region(program, operand, around) for operand in (node.a, node.b)]
        a, b = found
        return _hull(a, b) if a and b else a or b
    if node.operation == DIFFERENCE:
        outside = _outside(program, node.b)
        a = _region(program, node.a, (*around, *outside))
        return a and _common(a, Region(outside), around)
    second = _region(program, node.b, around)
    first = second and _region(program, node.a, (*around, *second.sides))
    if first and isinstance(node.b, _Leaf):  # another look, which costs nothing
        second = _region(program, node.b, (*around, *first.sides))
    return _common(first, second, around) if first and second else None


def _outside(program: Program, node: _Leaf | _Node) -> tuple[Plane, ...]:
    """What is outside of a half-space."""
    leaf = program.leaves[node.leaf] if isinstance(node, _Leaf) else None
    if isinstance(leaf, Polyhedron) and len(leaf.planes) == 1:
        a, b, c, d = (0.0 - number for number in leaf.planes[0])
        return ((a, b, c, d),)
    return ()


def _hull(a: Region, b: Region) -> Region:
    low, high = tuple(map(min, a.low, b.low)), tuple(map(max, a.high, b.high))
    return Region(tuple(plane for plane in a.planes if plane in b.planes), low, high)  # type: ignore[arg-type]


def _leaf_region(leaf: Primitive, facts: Facts, around: tuple[Plane, ...]) -> Region | None:
    box = (facts.low, facts.high) if facts.bounded else ()
    if isinstance(leaf, Polyhedron):
        return _common(Region(leaf.planes, *box), Region(()), around)
    limits = Region(tuple(_limits(leaf, around))) if isinstance(leaf, Quadric) and not box else Region(())
    return _common(Region((), *box), limits, around)


def _common(a: Region, b: Region, around: tuple[Plane, ...]) -> Region | None:
    """None where the half-spaces have no volume in common, or none in the box.

    A box of balls and quadrics is rounded: what only touches it may be something.
    """
    from native_tracer.halfspaces import polyhedron_facts

    planes = tuple(dict.fromkeys(a.planes + b.planes))
    low, high = tuple(map(max, a.low, b.low)), tuple(map(min, a.high, b.high))
    if any(x > y for x, y in zip(low, high, strict=True)):
        return None
    if planes or around:
        known = tuple(dict.fromkeys(planes + around))
        alone, boxed = polyhedron_facts([known, (*known, *box_planes(low, high))])  # type: ignore[arg-type]
        if not alone.solid or not boxed.drawn:
            return None
        if boxed.solid and boxed.bounded:
            low, high = tuple(map(max, low, boxed.low)), tuple(map(min, high, boxed.high))
    return Region(planes, low, high)  # type: ignore[arg-type]


# ---- Quadrics --------------------------------------------------------------------------------------------------------


def _limits(quadric: Quadric, around: Sequence[Plane]) -> Iterator[Plane]:
    """Planes across its axes that a quadric is between where it is in some half-spaces."""
    import numpy as np

    from converter.shapes.quadric_frame import frame_of

    frame = frame_of(quadric)
    bounds = [[-math.inf, math.inf] for _ in range(3)]
    for a, b, c, d in around:
        length = math.hypot(a, b, c)
        normal = np.array((a / length, b / length, c / length))
        across = frame.axes.T @ normal
        k = int(np.abs(across).argmax())
        if abs(across[k]) > 1 - 1e-15:  # but for roundings, an axis
            offset = -(d / length + float(normal @ frame.origin))
            bounds[k] = (
                [bounds[k][0], min(bounds[k][1], offset)]
                if across[k] > 0
                else [max(bounds[k][0], -offset), bounds[k][1]]
            )
    for k, (low, high) in enumerate(_left(frame.values.tolist(), frame.slope, frame.constant, bounds)):
        axis, middle = frame.axes[:, k], float(frame.axes[:, k] @ frame.origin)
        room = ROOM * max((abs(x) for x in (low, high, middle) if math.isfinite(x)), default=0.0)
        for sign, end in ((1.0, high + room), (-1.0, -(low - room))):
            a, b, c = (sign * axis).tolist()
            plane = (a, b, c, -(end + sign * middle))
            if all(map(math.isfinite, plane)):
                yield plane


def _left(
    values: Sequence[float], slope: float, constant: float, bounds: list[list[float]]
) -> Iterator[tuple[float, float]]:
    """What sum(values y^2) + 2 slope y_3 + constant <= 0 leaves of three intervals."""
    for _ in range(3):
        least = [_least(value, *bound) for value, bound in zip(values, bounds, strict=True)]
        if slope:
            least[2] = 2 * slope * bounds[2][1]  # the slope is negative
        for k in range(3):
            rest = -(constant + sum(least[j] for j in range(3) if j != k))
            if values[k] > 0 and math.isfinite(rest):
                reach = math.sqrt(max(rest, 0.0) / values[k])
                bounds[k] = [max(bounds[k][0], -reach), min(bounds[k][1], reach)]
        if slope:
            rest = -(constant + least[0] + least[1])
            bounds[2][0] = max(bounds[2][0], rest / (2 * slope)) if math.isfinite(rest) else bounds[2][0]
    return ((low, high) for low, high in bounds)


def _least(value: float, low: float, high: float) -> float:
    """The least value of value y^2."""
    if value == 0:
        return 0.0
    if value < 0:
        return value * max(abs(low), abs(high)) ** 2
    return value * max(low, -high, 0.0) ** 2
