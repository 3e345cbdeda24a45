"""A csg: a Boolean expression over shapes, whose surface is where its value changes along a ray.

What is crossed at one distance is crossed together. Roth, Ray Casting for Modeling Solids, Computer Graphics and Image
Processing 18(2), 1982, without his lists of intervals.
"""

import abc
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import drjit as dr

from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.rays import INVERTED, Ray
from mitsuba_plugins.intersection.shapes.kind import Row, Rows, Shape, ShapeKind

UNION, DIFFERENCE, INTERSECTION = -1, -2, -3
"""In a program, which is in postfix notation; numbers from 0 on are leaves."""


@dataclass(frozen=True)
class Leaf:
    """A shape of an expression.

    Attributes:
        kind: its kind.
        first: its first row among the expression's.
        sheets: for each of its primitives the first row of the first primitive of the expression that is the same set
            of points. So that coincident faces are crossed together, and left together.
        turned: whether the inside of that is this one's outside.

    """

    kind: ShapeKind
    first: int
    sheets: tuple[int, ...]
    turned: tuple[bool, ...]


@dataclass(frozen=True)
class Csg(abc.ABC):
    """An expression; subclasses know how to go through the crossings with its leaves.

    Attributes:
        program: the expression.

    """

    program: tuple[int, ...]

    convex = False

    def deciding_ties(self) -> "Csg":
        """As `Solid` has it."""
        return self

    @abc.abstractmethod
    def intersect(self, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """Where the value first changes, as `Solid` has it."""

    def value(self, inside: list[Any]) -> Any:
        """The expression, of which leaves a point is in."""
        stack: list[Any] = []
        for code in self.program:
            if code >= 0:
                stack.append(inside[code])
                continue
            right, left = stack.pop(), stack.pop()
            both = left & right
            stack.append(left | right if code == UNION else both if code == INTERSECTION else left ^ both)
        return stack.pop()


def side_of_sheet(if_inside: Any, if_outside: Any, ray: Ray) -> tuple[Any, Any]:
    """On which side of the sheet that it starts on a ray travels, and whether it starts inside the csg.

    The leaves that it starts on share a sheet. The side follows from that of the csg: it is the one on which, all other
    leaves as they are, the value is that. Where the value is that on both, the mark of the primitive tells the side.
    """
    marked_side = ray.inside ^ (ray.primitive >= INVERTED)
    inside_sheet = dr.select(if_inside != if_outside, ray.inside == if_inside, marked_side)
    return inside_sheet, dr.select(inside_sheet, if_inside, if_outside)


def crossed_at_start(found: Crossing, lost: Any, nearest: Any, ray: Ray) -> Crossing:
    """What is found, but where a ray is `lost`, on the other side of the csg than the one it is known to be on.

    There it crosses another leaf at once: the primitive that is `nearest` to where it starts.
    """
    return Crossing(
        t=dr.select(lost, 0, found.t),
        enters=dr.select(lost, ~ray.inside, found.enters),
        primitive=dr.select(lost, nearest, found.primitive),
        error=found.error,
        close=found.close,
    )


# ---- Before tracing --------------------------------------------------------------------------------------------------


def leaves_of(shapes: Iterable[tuple[ShapeKind, Shape]]) -> tuple[Leaf, ...]:
    """The leaves of an expression, with the sheets that they share."""
    sheets: dict[tuple[int, tuple[Row, ...] | None], tuple[int, bool]] = {}
    leaves, first = [], 0
    for kind, shape in shapes:
        found = []
        for k in range(0, len(shape.rows), kind.ROWS):
            rows = tuple(shape.rows[k : k + kind.ROWS])
            for turned, same in ((False, rows), (True, kind.turned(rows))):
                sheets.setdefault((id(kind), same), (first + k, turned))
            found.append(sheets[id(kind), rows])
        leaves.append(Leaf(kind, first, tuple(sheet for sheet, _ in found), tuple(turned for _, turned in found)))
        first += len(shape.rows)
    return tuple(leaves)
