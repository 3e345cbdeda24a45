"""Where a csg is: the box around it, points inside and on its surface."""

import math
from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import islice, product
from typing import NamedTuple

from converter.scene.model import Csg, Plane, Polyhedron, Primitive, Quadric, Sphere, Vector
from converter.shapes.csg_program import DIFFERENCE, UNION, Program, fold, program_of
from converter.shapes.kind import Facts
from converter.shapes.primitives import primitive_kind

MOST_SIDES = 10
"""Surfaces through one point of which all combinations of sides are gone through."""
TRIES, ENOUGH = 64, 4
"""Points of a box of which some may be inside, and how many of these are compared."""
_EVERYWHERE = (-math.inf,) * 3, (math.inf,) * 3


class Region(NamedTuple):
    """A convex set that holds something: the intersection of half-spaces and of a box, whose corners may be infinite.

    Attributes:
        planes: the half-spaces.
        low, high: the corners.
        exact: whether it is that something, and the box adds nothing.

    """

    planes: tuple[Plane, ...]
    low: Vector
    high: Vector
    exact: bool

    @property
    def bounded(self) -> bool:
        """Whether the box is finite."""
        return all(map(math.isfinite, (*self.low, *self.high)))


@lru_cache(maxsize=4096)
def region_of(shape: Csg) -> Region | None:
    """What a csg is in; None if it is known to be nothing."""
    program = program_of(shape)
    if not program.code:
        return Region((), *_EVERYWHERE, True) if program.everything else None
    return fold(program.code, lambda k: _leaf_region(program.leaves[k], program.facts[k]), _combined)


def _leaf_region(leaf: Primitive, facts: Facts) -> Region | None:
    box = (facts.low, facts.high) if facts.bounded else _EVERYWHERE
    return Region(primitive_kind(leaf).planes(leaf), *box, isinstance(leaf, Polyhedron))


def _combined(operation: int, a: Region | None, b: Region | None) -> Region | None:
    if operation == UNION:
        return _union(a, b) if a and b else a or b
    if operation == DIFFERENCE:
        if a and b and b.exact and len(b.planes) == 1:
            x, y, z, w = (0.0 - number for number in b.planes[0])
            return _intersection(a, Region(((x, y, z, w),), *_EVERYWHERE, True))
        return a and a._replace(exact=a.exact and b is None)
    return _intersection(a, b) if a and b else None


def _union(a: Region, b: Region) -> Region:
    low, high = tuple(map(min, a.low, b.low)), tuple(map(max, a.high, b.high))
    return Region(tuple(plane for plane in a.planes if plane in b.planes), low, high, False)  # type: ignore[arg-type]


def _intersection(a: Region, b: Region) -> Region | None:
    """None where the half-spaces have no volume in common, or none in the box.

    A box of balls and quadrics is rounded: what only touches it may be something.
    """
    from native_tracer.halfspaces import polyhedron_facts

    planes = tuple(dict.fromkeys(a.planes + b.planes))
    low, high = tuple(map(max, a.low, b.low)), tuple(map(min, a.high, b.high))
    if any(x > y for x, y in zip(low, high, strict=True)):
        return None
    if planes:
        alone, boxed = polyhedron_facts([planes, (*planes, *box_planes(low, high))])  # type: ignore[arg-type]
        if not alone.solid or not boxed.drawn:
            return None
        if boxed.solid and boxed.bounded:
            low, high = tuple(map(max, low, boxed.low)), tuple(map(min, high, boxed.high))
    return Region(planes, low, high, a.exact and b.exact)  # type: ignore[arg-type]


def box_planes(low: Vector, high: Vector) -> Iterator[Plane]:
    """The sides of a box that are somewhere."""
    for axis in range(3):
        for corner, sign in ((low, -1.0), (high, 1.0)):
            if math.isfinite(corner[axis]):
                a, b, c = (sign * float(k == axis) for k in range(3))
                yield (a, b, c, -sign * corner[axis])


# ---- Points ----------------------------------------------------------------------------------------------------------


def values_around(program: Program, point: Vector) -> set[bool]:
    """Whether there is inside or outside, or both, as near to a point as one likes.

    Of the surfaces that it is on, each side is tried. Where many meet there may be no points on some sides, and the
    point counts as being on the surface although it is not.
    """
    conditions = [list(_conditions(leaf, point)) for leaf in program.leaves]
    surfaces = {c.surface: False for own in conditions for c in own if isinstance(c, _Side)}
    if len(surfaces) > MOST_SIDES:
        return {False, True}
    found = set()
    for chosen in product((False, True), repeat=len(surfaces)):
        surfaces = dict(zip(surfaces, chosen, strict=True))
        inside = [all(surfaces[c.surface] == c.inner if isinstance(c, _Side) else c for c in own) for own in conditions]
        found.add(program.value(inside))
    return found


class _Side(NamedTuple):
    """A side of a surface, `inner` or not, whose numbers have signs that do not depend on what is inside."""

    surface: object
    inner: bool


def _conditions(leaf: Primitive, point: Vector) -> Iterator[_Side | bool]:
    """What all has to hold for points near one to be inside of a leaf: it is known, or they are on one side of a
    surface.
    """
    kind = primitive_kind(leaf)
    if not kind.lies_on(leaf, point):
        yield kind.contains(leaf, point)
        return
    match leaf:
        case Sphere():
            yield _Side(leaf, True)
        case Quadric(coefficients):
            yield _side(coefficients)
        case Polyhedron(planes):
            for plane in planes:
                half_space = Polyhedron((plane,))
                yield _side(plane) if kind.lies_on(half_space, point) else kind.contains(half_space, point)


def _side(numbers: Sequence[float]) -> _Side:
    first = next(x for x in numbers if x)
    return _Side(tuple(math.copysign(1, first) * x for x in numbers), first > 0)


def inside_point(shape: Csg) -> Vector | None:
    """A point well inside, as far as one is found."""
    program, region = program_of(shape), region_of(shape)
    if region is None or not program.code:
        return None
    inside = ((d, p) for p in _tries(program, region) if (d := depth(program, p)) > 0)
    _, deepest = max(islice(inside, ENOUGH), default=(0.0, None))
    return deepest


def depth(program: Program, point: Vector) -> float:
    """A length that the surface is away at least if a point is inside; 0 where it is not."""
    if not program.value([primitive_kind(leaf).contains(leaf, point) for leaf in program.leaves]):
        return 0.0
    leaves = zip(program.leaves, program.facts, strict=True)
    return min(primitive_kind(leaf).distances(leaf, facts, point).nearest for leaf, facts in leaves)


def _tries(program: Program, region: Region) -> Iterator[Vector]:
    """Points inside of leaves, and of the box, or of one around the leaves: Halton's sequence."""
    yield from (facts.inside for facts in program.facts)
    low, high = box_of(program, region)
    for n in range(1, TRIES + 1):
        x, y, z = (p + (q - p) * _halton(n, base) for p, q, base in zip(low, high, (2, 3, 5), strict=True))
        yield (x, y, z)


def box_of(program: Program, region: Region) -> tuple[Vector, Vector]:
    """The box around something, of what has no bounds around those of its leaves."""
    if region.bounded:
        return region.low, region.high
    a, b, c = (min(facts.low[k] for facts in program.facts) for k in range(3))
    d, e, f = (max(facts.high[k] for facts in program.facts) for k in range(3))
    return (a, b, c), (d, e, f)


def _halton(n: int, base: int) -> float:
    value, share = 0.0, 1.0
    while n:
        share /= base
        n, digit = divmod(n, base)
        value += digit * share
    return value
