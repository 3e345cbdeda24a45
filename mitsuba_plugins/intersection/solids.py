"""What an object is in a kernel: one primitive or convex polyhedron, or a Boolean expression over several (csg)."""

from dataclasses import dataclass
from typing import Any, Protocol

from mitsuba_plugins.intersection.passages import Crossing, first_crossing
from mitsuba_plugins.intersection.rays import Ray
from mitsuba_plugins.intersection.shapes.kind import Rows, ShapeKind, passage_of


class Solid(Protocol):
    """The structure of an object, without its numbers: objects that are equal in it share their code."""

    @property
    def convex(self) -> bool:
        """Whether a ray that leaves it never meets it again."""
        ...

    def deciding_ties(self) -> "Solid":
        """The same with the code by which ties are decided."""
        ...

    def intersect(self, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """Where rays first cross it; `by_rules` of ties, or else saying whether that is close to one.

        `own` where a ray starts on it, `reach` the largest coordinate of its origin; planes may tie where it does not
        matter `which_piece` is met.
        """
        ...


@dataclass(frozen=True)
class Single:
    """One shape."""

    kind: ShapeKind

    @property
    def convex(self) -> bool:
        """As its kind."""
        return self.kind.CONVEX

    def deciding_ties(self) -> Solid:
        """Its own."""
        return self

    def intersect(self, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """At the crossing of its passage that counts."""
        return first_crossing(passage_of(self.kind, rows, ray, own, reach, by_rules), ray, own, reach, which_piece)
