"""Surfaces of a csg's leaves that are nearly one: what is left between them is a thin wall, or a lid, or nothing."""

import math
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Csg, Polyhedron, Primitive, Quadric, Sphere, Vector
from converter.shapes.csg_program import written_leaves
from converter.shapes.kind import Facts
from converter.shapes.primitives import primitive_kind
from converter.shapes.same_surfaces import same_ball, same_quadric

Floats = NDArray[np.float64]

MOST_COMPARED = 1 << 18
"""Pairs of planes of two leaves that are compared."""
ALIKE = 0.01
"""Bodies whose boxes differ by more than this, next to their size, have no surfaces that are nearly one, nor planes of
whose normals' angle the cosine differs from 1 by more."""
ROOM = 1e-6
"""Boxes that are no farther apart, next to their size, may touch."""
_PROBES = tuple((2 * x / 3, y / 3, 2 * z / 3) for x in (1, -1) for y in (1, -1) for z in (1, -1))
"""Directions in which two bodies are compared, of length 1."""


class Gap(NamedTuple):
    """How far two leaves' surfaces are apart, over the largest of their coordinates, and the leaves' numbers in the
    file, from 0 on.
    """

    share: float
    first: int
    second: int


@np.errstate(all="ignore")  # numbers may be as large as they like
def smallest_gap(shape: Csg, reach: float) -> Gap | None:
    """Of two planes that both have faces, or of two curved surfaces as a whole; None where no two are alike.

    Surfaces that are one have no gap.

    Args:
        shape: the csg.
        reach: the largest coordinate of where it is looked at from.

    """
    leaves = tuple(written_leaves(shape))
    facts = [primitive_kind(leaf).facts([leaf])[0] for leaf in leaves]
    best: Gap | None = None
    for i, j in combinations(range(len(leaves)), 2):
        most = math.inf if best is None else best.share
        share = _gap(leaves[i], leaves[j], facts[i], facts[j], reach, most)
        if 0 < share < most:
            best = Gap(share, i, j)
    return best


def _gap(one: Primitive, other: Primitive, facts: Facts, others: Facts, reach: float, most: float) -> float:
    """Of two leaves; infinite where they are not alike. What is larger than `most` need not be the whole of it."""
    if not facts.drawn or not others.drawn or not _near(facts, others):
        return math.inf
    match one, other:
        case Polyhedron(), Polyhedron():
            return _between_planes(one, other, facts, others, reach)
        case (Polyhedron(), _) | (_, Polyhedron()):
            return math.inf
        case Sphere(), Sphere() if same_ball(one, other):
            return 0.0
        case Quadric(), Quadric() if same_quadric(one, other):
            return 0.0
    return _between_curves(one, other, facts.inside, reach, most) if _alike(facts, others) else math.inf


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


def _between_planes(one: Polyhedron, other: Polyhedron, facts: Facts, others: Facts, reach: float) -> float:
    """By the normals and offsets of two planes, whichever way they face."""
    if not facts.planes or not others.planes or len(facts.planes) * len(others.planes) > MOST_COMPARED:
        return math.inf
    a, b = _units(one, facts), _units(other, others)
    cosine = a[:, :3] @ b[:, :3].T
    first, second = np.nonzero(np.abs(cosine) > 1 - ALIKE)
    a, b = a[first], b[second] * np.sign(cosine[first, second])[:, None]
    largest = np.maximum(np.maximum(np.abs(a[:, 3]), np.abs(b[:, 3])), reach)
    shares = np.abs(a[:, :3] - b[:, :3]).max(axis=1, initial=0.0) + np.abs(a[:, 3] - b[:, 3]) / largest
    return float(shares[shares > 0].min(initial=math.inf))


def _units(polyhedron: Polyhedron, facts: Facts) -> Floats:
    """(n, 4) its planes that have a face, with normals of length 1."""
    rows = np.array([polyhedron.planes[k] for k in facts.planes])
    return np.asarray(rows / np.linalg.norm(rows[:, :3], axis=1, keepdims=True))


def _between_curves(one: Primitive, other: Primitive, inside: Vector, reach: float, most: float) -> float:
    """The largest distance of the second from points of the first, all around."""
    origin = np.array(inside)
    largest = 0.0
    for probe in _PROBES:
        direction = np.array(probe)
        for met in primitive_kind(one).intersections(one, origin, direction):
            p = origin + met.t * direction
            share = primitive_kind(other).surface_margin(other, p, False) / max(float(np.abs(p).max()), reach)
            largest = max(largest, share) if math.isfinite(share) else math.inf
        if largest > most:
            break
    return largest
