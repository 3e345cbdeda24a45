"""Where a csg is: the box around it, points inside and on its surface."""

from collections.abc import Iterator, Sequence
from itertools import islice, product
from typing import NamedTuple

from converter.scene.model import Csg, Polyhedron, Primitive, Quadric, Sphere, Vector
from converter.shapes.csg_program import Program, program_of
from converter.shapes.csg_regions import Region, region_of
from converter.shapes.primitives import primitive_kind
from converter.shapes.same_surfaces import sign_of

MOST_SIDES = 10
"""Surfaces through one point of which all combinations of sides are gone through."""
TRIES, ENOUGH = 64, 4
"""Points of a box of which some may be inside, and how many of these are compared."""


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
    sign = sign_of(numbers)
    return _Side(tuple(sign * x for x in numbers), sign > 0)


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
