"""Intersections of half-spaces: what a body is like, and the polygons of its faces. Needs no NumPy.

A half-space is (a, b, c, d): a x + b y + c z + d <= 0, with a normal (a, b, c) of any length but zero.
"""

from array import array
from collections.abc import Iterable, Sequence
from itertools import accumulate, chain
from typing import NamedTuple

from native_tracer import _core

Vector = tuple[float, float, float]
HalfSpace = Sequence[float]


class PolyhedronFacts(NamedTuple):
    """What is known of an intersection of half-spaces. Of one that is neither a body nor a plate, `conflict` alone.

    A face narrower than 2^-48 of its distance from the origin counts as none, and a body thinner than that as having
    no volume: the rounding of the coefficients, 2^-53 each, may have made it or unmade it. Planes touch if they differ
    by no more than 2^-50, four times the rounding of a coefficient of 1.
    """

    solid: bool
    """It has a volume."""
    plate: tuple[int, ...]
    """If it has none, but a face: the two planes that touch there, and face away from each other. Otherwise none."""
    bounded: bool
    """It ends within 2^24 times the largest distance of a plane from the origin."""
    kept: tuple[int, ...]
    """Planes that have a face, ascending; of planes that coincide the first."""
    redundant: tuple[int, ...]
    """Planes that have none, ascending: leaving all of them out changes nothing."""
    low: Vector
    high: Vector
    """Corners of the box around the vertices; for a face without vertices, around its point nearest the origin."""
    inside: Vector
    """A point well inside, of a plate well inside its face."""
    conflict: tuple[int, ...]
    """If there is no volume and no plate: two to four planes that leave no volume by themselves, none of which can be
    spared.
    """

    @property
    def drawn(self) -> bool:
        """Whether rays may hit it: it is a body or a plate."""
        return self.solid or bool(self.plate)


class Face(NamedTuple):
    """A convex polygon, counterclockwise as seen from outside; without edges where the plane has no face."""

    neighbors: list[int]
    """The plane on the other side of each edge."""
    points: list[float]
    """x, y, z of the place where each edge begins."""
    area: float


def polyhedron_facts(polyhedra: Iterable[Sequence[HalfSpace]]) -> list[PolyhedronFacts]:
    """Work out the facts of many polyhedra at once.

    Args:
        polyhedra: for each, its half-spaces; none at all is the whole space.

    Raises:
        ValueError: a normal is zero, or a number is not finite.

    """
    bodies = [list(planes) for planes in polyhedra]
    coefficients = array("d", chain.from_iterable(chain.from_iterable(bodies)))
    offsets = array("q", accumulate(map(len, bodies), initial=0))
    return [PolyhedronFacts(*row) for row in _core.halfspace_bodies(coefficients, offsets)]


def polyhedron_faces(planes: Sequence[HalfSpace]) -> list[Face]:
    """The face of each half-space of one polyhedron, of a plate that of its first plane alone; an empty list if it has
    no bounds, or neither a volume nor a face.

    Raises:
        ValueError: a normal is zero, or a number is not finite.

    """
    return [Face(*row) for row in _core.halfspace_faces(array("d", chain.from_iterable(planes)))]
