"""Surfaces of a csg's leaves that are nearly one: what is left between them is a thin wall, or a lid, or nothing."""

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from converter.scene.model import Csg, Polyhedron, Primitive, Quadric, Sphere, Vector
from converter.shapes.csg_program import written_leaves
from converter.shapes.kind import Facts
from converter.shapes.primitives import primitive_kind
from converter.shapes.same_surfaces import same_ball, same_quadric

ALIKE = 0.01
"""Bodies whose boxes differ by more than this, next to their size, have no surfaces that are nearly one."""
ROOM = 1e-6
"""Boxes that are no farther apart, next to their size, may touch."""
_THIRD = 1 / 3
_PROBES = tuple((2 * x * _THIRD, y * _THIRD, 2 * z * _THIRD) for x in (1, -1) for y in (1, -1) for z in (1, -1))
"""Directions in which two bodies are compared, of length 1."""


class Gap(NamedTuple):
    """How far two leaves' surfaces are apart, over the largest of their coordinates, and the leaves' numbers in the
    file, from 0 on.
    """

    share: float
    first: int
    second: int


def smallest_gap(shape: Csg, reach: float) -> Gap | None:
    """Of two planes that both have faces, or of two curved surfaces as a whole; None where no two are alike.

    Surfaces that are one have no gap.

    Args:
        shape: the csg.
        reach: the largest coordinate of where it is looked at from.

    """
    leaves = tuple(written_leaves(shape))
    facts = [primitive_kind(leaf).facts([leaf])[0] for leaf in leaves]
    found = [
        Gap(share, i, j)
        for i, j in combinations(range(len(leaves)), 2)
        for share in _gaps(leaves[i], leaves[j], facts[i], facts[j], reach)
        if share > 0
    ]
    return min(found, default=None)


def _gaps(one: Primitive, other: Primitive, facts: Facts, others: Facts, reach: float) -> Iterator[float]:
    if not facts.drawn or not others.drawn or not _near(facts, others):
        return
    match one, other:
        case Polyhedron(), Polyhedron():
            yield from _between_planes(one, other, facts, others, reach)
        case (Polyhedron(), _) | (_, Polyhedron()):
            return
        case Sphere(), Sphere() if same_ball(one, other):
            return
        case Quadric(), Quadric() if same_quadric(one, other):
            return
        case _ if _alike(facts, others):
            yield _between_curves(one, other, facts.inside, reach)


def _near(facts: Facts, others: Facts) -> bool:
    """Whether the boxes of both touch, as far as they have any."""
    if not (facts.bounded and others.bounded):
        return True
    room = ROOM * max(map(abs, (*facts.low, *facts.high)))
    sides = zip(facts.low, facts.high, others.low, others.high, strict=True)
    return all(low <= other_high + room and other_low <= high + room for low, high, other_low, other_high in sides)


def _alike(facts: Facts, others: Facts) -> bool:
    if facts.bounded != others.bounded:
        return False
    corners, other_corners = (*facts.low, *facts.high), (*others.low, *others.high)
    size = math.dist(facts.low, facts.high)
    return not facts.bounded or max(abs(x - y) for x, y in zip(corners, other_corners, strict=True)) <= ALIKE * size


def _between_planes(one: Polyhedron, other: Polyhedron, facts: Facts, others: Facts, reach: float) -> Iterator[float]:
    """By their offsets and normals, whichever way they face."""
    second = [_unit(other.planes[k]) for k in others.planes]
    for k in facts.planes:
        a = _unit(one.planes[k])
        for b in second:
            sign = 1.0 if sum(x * y for x, y in zip(a[:3], b[:3], strict=True)) > 0 else -1.0
            turn = max(abs(x - sign * y) for x, y in zip(a[:3], b[:3], strict=True))
            largest = max(abs(a[3]), abs(b[3]), reach)
            if turn <= ALIKE and largest > 0:
                yield abs(a[3] - sign * b[3]) / largest + turn


def _unit(plane: Sequence[float]) -> tuple[float, float, float, float]:
    length = math.hypot(*plane[:3])
    a, b, c, d = (x / length for x in plane)
    return a, b, c, d


def _between_curves(one: Primitive, other: Primitive, inside: Vector, reach: float) -> float:
    """The largest distance of the second from points of the first, all around."""
    import numpy as np

    origin = np.array(inside)
    largest = 0.0
    for probe in _PROBES:
        direction = np.array(probe)
        for met in primitive_kind(one).intersections(one, origin, direction):
            p = origin + met.t * direction
            apart = primitive_kind(other).surface_margin(other, p, False)
            share = apart / max(float(np.abs(p).max()), reach)
            largest = max(largest, share) if math.isfinite(share) else math.inf
    return largest
