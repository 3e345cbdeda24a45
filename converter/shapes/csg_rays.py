"""How near a ray is to meeting something else of a csg: by the crossings of its leaves that change what it is in."""

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Csg, Vector
from converter.shapes.csg_program import Program, program_of
from converter.shapes.kind import Intersection, tie_margin
from converter.shapes.primitives import primitive_kind

Floats = NDArray[np.float64]

COINCIDENT = 2.0**-44
"""How much crossings of one surface may differ, in distance and in the cosine."""


class _Crossing(NamedTuple):
    leaf: int
    at: Intersection


def intersections(shape: Csg, origin: Floats, direction: Floats) -> list[Intersection]:
    """Where a line enters and leaves it; where it does neither, where it crosses its leaves, or comes near to that."""
    program = program_of(shape)
    crossings = _crossings(program, origin, direction)
    if not crossings:
        return []
    distances = sorted({crossing.at.t for crossing in crossings})
    step = max(1.0, *map(abs, distances))
    middles = [(a + b) / 2 for a, b in pairwise([distances[0] - step, *distances, distances[-1] + step])]
    values = [program.value(_inside(program, origin + t * direction)) for t in middles]
    changes = {t for t, (before, after) in zip(distances, pairwise(values), strict=True) if before != after}
    return [crossing.at for crossing in crossings if not changes or crossing.at.t in changes]


def silhouette_margin(shape: Csg, origin: Floats, direction: Floats) -> float:
    """By the leaves whose coming or going there matters, and by where two of them meet."""
    program = program_of(shape)
    result = _tie_margin(program, origin, direction)
    for k, leaf in enumerate(program.leaves):
        kind = primitive_kind(leaf)
        found = [at.t for at in kind.intersections(leaf, origin, direction)]
        if not found or any(
            _matters(program, k, _inside(program, origin + t * direction)) for t in [*found, sum(found) / len(found)]
        ):
            result = min(result, kind.silhouette_margin(leaf, origin, direction))
    return result


def edge_margin(shape: Csg, origin: Floats, direction: Floats) -> float:
    """By the faces of each leaf."""
    program = program_of(shape)
    crossings = [crossing for crossing in _crossings(program, origin, direction) if crossing.at.cosine]
    margins = [
        primitive_kind(program.leaves[k]).edge_margin(program.leaves[k], origin, direction)
        for k, at in crossings
        if _matters(program, k, _inside(program, origin + at.t * direction))
    ]
    return min(margins, default=math.inf)


def _tie_margin(program: Program, origin: Floats, direction: Floats) -> float:
    """By pairs of leaves that the line crosses in one order, and nearby in the other."""
    crossings = [crossing for crossing in _crossings(program, origin, direction) if crossing.at.cosine]
    pairs = sorted(
        (tie_margin(a.at, b.at), i, j)
        for (i, a), (j, b) in combinations(enumerate(crossings), 2)
        if a.leaf != b.leaf and not _coincide(a.at, b.at)
    )
    ties = (tie for tie, i, j in pairs if _order_matters(program, crossings[i], crossings[j], origin, direction))
    return next(ties, math.inf)


def _order_matters(program: Program, a: _Crossing, b: _Crossing, origin: Floats, direction: Floats) -> bool:
    """Whether it makes a difference which of two leaves is crossed first."""
    inside = list(_inside(program, origin + (a.at.t + b.at.t) / 2 * direction))
    values = set()
    for first, second in ((a, b), (b, a)):
        inside[first.leaf], inside[second.leaf] = first.at.cosine < 0, second.at.cosine > 0
        values.add(program.value(inside))
    return len(values) == 2


def _coincide(a: Intersection, b: Intersection) -> bool:
    """Whether two surfaces are one where a line crosses them, which never does in another order."""
    same_slope = abs(abs(a.cosine) - abs(b.cosine)) <= COINCIDENT
    return same_slope and abs(a.t - b.t) <= COINCIDENT * max(abs(a.t), abs(b.t))


def surface_margin(shape: Csg, p: Floats, on_it: bool) -> float:
    """By the leaves that matter there; if the point lies on the surface, that is the nearest one's."""
    program = program_of(shape)
    near = _nearest(shape, _point(p))
    if not on_it or not near:
        return near[0][0] if near else math.inf
    (_, own), *others = near
    leaf = program.leaves[own]
    return min([primitive_kind(leaf).surface_margin(leaf, p, True), *(margin for margin, _ in others)])


def radius_of_curvature(shape: Csg, p: Floats) -> float:
    """That of the leaf whose surface is nearest; the smallest one where several are."""
    program = program_of(shape)
    near = _nearest(shape, _point(p))
    closest = [k for margin, k in near if margin <= 2 * near[0][0]]
    leaves = [program.leaves[k] for k in closest]
    return min((primitive_kind(leaf).radius_of_curvature(leaf, p) for leaf in leaves), default=math.inf)


def _crossings(program: Program, origin: Floats, direction: Floats) -> list[_Crossing]:
    return [
        _Crossing(k, at)
        for k, leaf in enumerate(program.leaves)
        for at in primitive_kind(leaf).intersections(leaf, origin, direction)
        if math.isfinite(at.t)
    ]


def _matters(program: Program, leaf: int, inside: Sequence[bool]) -> bool:
    """Whether it changes anything near a point, inside of these leaves, whether it is inside of one of them."""
    return len({program.value([*inside[:leaf], value, *inside[leaf + 1 :]]) for value in (False, True)}) == 2


def _inside(program: Program, p: Floats) -> Sequence[bool]:
    point = _point(p)
    return [primitive_kind(leaf).contains(leaf, point) for leaf in program.leaves]


@lru_cache(maxsize=4096)  # a hit is asked about for each of the rays that leave it
def _nearest(shape: Csg, point: Vector) -> list[tuple[float, int]]:
    """Margins of a point to the surfaces of leaves that matter there, or of all if none does, in ascending order."""
    program, p = program_of(shape), np.array(point)
    inside = _inside(program, p)
    matter = [k for k in range(len(program.leaves)) if _matters(program, k, inside)]
    near = []
    for k in matter or range(len(program.leaves)):
        leaf = program.leaves[k]
        near.append((primitive_kind(leaf).surface_margin(leaf, p, False), k))
    return sorted(near)


def _point(p: Floats) -> Vector:
    x, y, z = map(float, p)
    return x, y, z
