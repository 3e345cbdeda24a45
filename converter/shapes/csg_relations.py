"""How primitives lie to each other, as far as that is certain: it decides what of a csg matters."""

import math
from collections.abc import Iterator, Sequence
from enum import Enum
from fractions import Fraction
from itertools import combinations
from operator import lt

from converter.scene.model import Plane, Polyhedron, Primitive, Quadric, Sphere, Vector
from converter.shapes.kind import Facts
from converter.shapes.polyhedron import signed_distances

SLACK = 1e-12
"""By what share of the numbers that it is made of a distance has to be larger than asked for."""
MOST_PLANES = 256
"""Of two polyhedra together that are compared."""


Planes = tuple[Plane, ...]


class Relation(Enum):
    """What no point is inside of."""

    APART = "both"
    INSIDE = "the first without the second"
    AROUND = "the second without the first"
    COVERING = "neither"


def relations(leaves: Sequence[Primitive], facts: Sequence[Facts]) -> list[tuple[int, int, Relation]]:
    """All that are certain, of all pairs."""
    from native_tracer.halfspaces import polyhedron_facts

    found: list[tuple[int, int, Relation]] = []
    asked: list[tuple[int, int, Relation, list[Planes]]] = []
    for i, j in combinations(range(len(leaves)), 2):
        first, second = leaves[i], leaves[j]
        if _boxes_apart(facts[i], facts[j]):
            found.append((i, j, Relation.APART))
        elif isinstance(first, Polyhedron) and isinstance(second, Polyhedron):
            asked += [(i, j, *question) for question in _questions(first, second)]
        else:
            found += [(i, j, relation) for relation in _relations(first, second)]
    answers = iter(polyhedron_facts([planes for *_, sets in asked for planes in sets]))
    for i, j, relation, sets in asked:
        if not any([next(answers).solid for _ in sets]):
            found.append((i, j, relation))
    return found


def _boxes_apart(facts: Facts, other: Facts) -> bool:
    apart = any(map(lt, facts.high, other.low)) or any(map(lt, other.high, facts.low))
    return facts.bounded and other.bounded and apart


def _relations(first: Primitive, second: Primitive) -> Iterator[Relation]:
    match first, second:
        case Sphere(), Sphere():
            yield from _balls(first, second)
        case Sphere(), Polyhedron():
            yield from _ball_and_polyhedron(first, second)
        case Polyhedron(), Sphere():
            yield from map(_turned, _ball_and_polyhedron(second, first))
        case Quadric(), Quadric() if second.coefficients == tuple(0.0 - x for x in first.coefficients):
            yield Relation.APART
            yield Relation.COVERING


def _turned(relation: Relation) -> Relation:
    """Of the same two the other way round."""
    return {Relation.INSIDE: Relation.AROUND, Relation.AROUND: Relation.INSIDE}.get(relation, relation)


def _balls(first: Sphere, second: Sphere) -> Iterator[Relation]:
    r, s = Fraction(first.radius), Fraction(second.radius)
    square = sum((Fraction(x) - Fraction(y)) ** 2 for x, y in zip(first.center, second.center, strict=True))
    if square >= (r + s) ** 2:
        yield Relation.APART
    elif square <= (r - s) ** 2:
        yield Relation.INSIDE if r <= s else Relation.AROUND


def _ball_and_polyhedron(ball: Sphere, polyhedron: Polyhedron) -> Iterator[Relation]:
    distances = signed_distances(polyhedron, ball.center)
    slack = SLACK * (ball.radius + max(map(abs, (*ball.center, *distances))))
    if max(distances) >= ball.radius + slack:
        yield Relation.APART
    elif max(distances) <= -ball.radius - slack:
        yield Relation.INSIDE
    elif max((math.dist(p, ball.center) for p in _corners(polyhedron)), default=math.inf) <= ball.radius - slack:
        yield Relation.AROUND


def _corners(polyhedron: Polyhedron) -> list[Vector]:
    """None where it has no bounds."""
    from native_tracer.halfspaces import polyhedron_faces

    faces = [face.points for face in polyhedron_faces(polyhedron.planes)]
    return [(p[k], p[k + 1], p[k + 2]) for p in faces for k in range(0, len(p), 3)]


def _questions(first: Polyhedron, second: Polyhedron) -> Iterator[tuple[Relation, list[Planes]]]:
    """What is so if none of some intersections of half-spaces has a volume."""
    p, q = first.planes, second.planes
    if len(p) + len(q) > MOST_PLANES:
        return
    yield Relation.APART, [p + q]
    yield Relation.INSIDE, [(*p, _turned_plane(plane)) for plane in q]
    yield Relation.AROUND, [(*q, _turned_plane(plane)) for plane in p]
    if len(p) == len(q) == 1:
        yield Relation.COVERING, [(_turned_plane(p[0]), _turned_plane(q[0]))]


def _turned_plane(plane: Plane) -> Plane:
    a, b, c, d = (0.0 - x for x in plane)
    return (a, b, c, d)
