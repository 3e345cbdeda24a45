"""What each kind of shape has to answer.

A shape is made of primitives, the smooth pieces of its surface: a sphere, a quadric, or a polyhedron's planes. Each is
a row of four numbers, or several, and its index that of the first in the table of all rows of a scene.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

from mitsuba_plugins.intersection.passages import Passage
from mitsuba_plugins.intersection.rays import Ray

Vector = tuple[float, float, float]
Row = tuple[float, float, float, float]


class Shape(NamedTuple):
    """A shape that has been read."""

    given: Sequence[Sequence[float]]
    """Its primitives as the description has them, each with as many numbers as any."""
    rows: list[Row]
    """The same as kernels read them, each with as many rows as any."""
    pieces: tuple[int | None, ...]
    """What the scene calls the primitive of each row: a plane's index, None if there is one primitive only."""
    box: tuple[Vector, Vector] | None
    """Around it; None where there is none."""
    extent: float = 0.0
    """The largest coordinate of what is rounded to single precision for Mitsuba, but a mesh's."""
    ball: Row | None = None
    """Centre and radius, if it is a ball."""
    meshed: bool = False
    """Whether Mitsuba has a mesh for it, of which the description tells."""


class Rows(Protocol):
    """The rows of a shape or a primitive, or of one for each ray, in a kernel."""

    width: int
    """Of arrays that differ from row to row."""

    def primitive(self, k: int = 0) -> Any:
        """The index of the row k after the first, if a primitive begins there (UInt32)."""
        ...

    def row(self, k: int = 0) -> Any:
        """The row k after the first (Vector4)."""
        ...

    def fold(self, step: Callable[[Any, Any, Any], Any], state: Any) -> Any:
        """`state` after `state = step(state, primitive, row)` for all rows, one after the other."""
        ...


class Contact(NamedTuple):
    """A primitive that a point lies on."""

    row: int
    """Which of those that were asked for."""
    normal: Vector
    """The outward unit normal there."""
    curvature: float
    """How much the normal turns along a unit of length, at most; 0 of a plane."""
    turn: tuple[Vector, Vector, Vector]
    """By rows, the matrix that takes a way to what the normal turns by along it, but for what is along the normal."""


@dataclass
class SurfacePoint:
    """A point of a primitive."""

    p: Any  # Point3
    n: Any  # Vector3, the outward unit normal
    error: Any  # Float, how far the primitive may be off where ties are decided
    radius: Any  # Float, of curvature, infinite where it is flat


class ShapeKind(Protocol):
    """A module for one kind of shapes."""

    ROWS: int
    """Of each primitive."""
    FACETED: bool
    """Whether a shape has several primitives, planes, and a point of one may lie beside the shape."""
    CONVEX: bool
    """Whether a ray that leaves a shape never meets it again."""

    def read(self, entry: dict[str, Any]) -> Shape:
        """A shape of a description.

        Raises:
            KeyError, TypeError, ValueError: the entry does not describe one.
        """
        ...

    def turned(self, rows: tuple[Row, ...]) -> tuple[Row, ...] | None:
        """The rows of a primitive whose inside is another's outside, if there are such."""
        ...

    def contacts(self, point: Any, rows: Any) -> list[Contact]:
        """Which of some primitives, (n, m) as given, a point (3,) lies on, in their order."""
        ...

    def contains(self, point: Any, rows: Any) -> bool:
        """Whether a shape, its primitives as given, contains a point, as far as decimals can say."""
        ...

    def slides(self, move: Any, row: Any) -> bool:
        """Whether a primitive as given, moved by a displacement (3,), lies in itself, as far as decimals can say: then
        what lies on it does so while it moves.
        """
        ...

    # ---- In a kernel: `own` where the ray starts on the shape, `reach` the largest coordinate of its origin

    def passage(self, rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
        """Where rays that are far from ties cross a shape, and which are not far."""
        ...

    def passage_by_rules(self, rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
        """Where rays cross a shape by the format's rules for ties."""
        ...

    def surface_at(self, rows: Rows, p: Any, ray: Ray, own: Any, reach: Any) -> SurfacePoint:
        """The point of a primitive nearest to a point near it (Point3) that a ray has met."""
        ...


def passage_of(kind: ShapeKind, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool) -> Passage:
    """Where rays cross a shape: by the rules for ties, or saying which are close to one."""
    return (kind.passage_by_rules if by_rules else kind.passage)(rows, ray, own, reach)
