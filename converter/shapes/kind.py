"""What each kind of shape has to answer."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeVar

from converter.scene.model import Plane, Shape, Vector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from converter.scene.reader import Reader
    from converter.to_mitsuba.meshing import Meshing

    Floats = NDArray[np.float64]

S = TypeVar("S")


class Facts(NamedTuple):
    """What is known of a shape once it has been looked into."""

    low: Vector
    high: Vector
    """Corners of the box around it; of one without bounds around its vertices, or, where a face has none, around its
    point nearest the origin."""
    inside: Vector
    """A point well inside; of a plate well inside its face."""
    bounded: bool = True
    """Whether it is, as far as is known."""
    drawn: bool = True
    """Whether a ray may hit it. Of what is nothing the others say little."""
    planes: tuple[int, ...] = ()
    """Which of its planes have a face, ascending; all of them where it is nothing, and none of a csg's."""
    plate: tuple[int, ...] = ()
    """The two planes between which it is a plate without thickness; for others none."""
    conflict: tuple[int, ...] = ()
    """If it is nothing: the planes that leave nothing."""


class Distances(NamedTuple):
    """Bounds of how far a surface's points are from some point, and the largest number that these were made of."""

    nearest: float
    farthest: float
    largest: float


class Intersection(NamedTuple):
    """Where a line crosses a surface: the distance, and the cosine between its direction and the normal there."""

    t: float
    cosine: float


def tie_margin(a: Intersection, b: Intersection) -> float:
    """From two surfaces that a ray crosses to where it crosses them in the other order."""
    if a.cosine == 0 or b.cosine == 0:
        return 0.0
    return abs(a.t - b.t) / (1 / abs(a.cosine) + 1 / abs(b.cosine))


class Horizon(NamedTuple):
    """How much of a shape a picture may show from an eye.

    Attributes:
        needed: how far from the eye it is wanted in any case: all of a ball, since it throws shadows.
        height: the eye's largest distance from a plane that goes on up to `farthest`.
        farthest: how far from the eye it ends.
    """

    needed: float
    height: float
    farthest: float


class ShapeKind(Protocol[S]):
    """A module for the shapes of class `S`, of `scene.model`.

    Importing it loads neither NumPy nor a renderer: what needs one imports it when it is called.
    """

    @property
    def NAME(self) -> str:  # noqa: N802 - a module's constant
        """What listings call it."""
        ...

    @property
    def PLURAL(self) -> str:  # noqa: N802
        """Its name, several times."""
        ...

    @property
    def READERS(self) -> Mapping[str, Callable[["Reader", int], tuple[S, int]]]:  # noqa: N802
        """By each keyword of scene files the function that reads what it begins.

        That takes the index of the keyword, gives the shape and the index after its last word, complains to the reader
        of numbers that it may not have, and raises `Lost` where words are missing, or stand where they cannot.
        """
        ...

    def write(self, shape: S) -> list[str]:
        """The lines of an object in a scene file, the first without the pigment's and the finish's index.

        Raises:
            ValueError: a number is not finite.
        """
        ...

    # ---- What it is made of

    def count(self, shape: S) -> int:
        """How many primitives, spheres and planes, it is made of."""
        ...

    def extent(self, shape: S) -> float:
        """The largest number that it is made of, a length."""
        ...

    def ball(self, shape: S) -> tuple[Vector, float] | None:
        """Its centre and radius, if it is a ball."""
        ...

    def planes(self, shape: S) -> tuple[Plane, ...]:
        """The planes that it is made of, which other bodies may share."""
        ...

    def with_planes(self, shape: S, planes: Sequence[Plane]) -> S:
        """The shape with others in their places."""
        ...

    def scaled(self, shape: S, factor: float) -> S:
        """What it is in a scene whose lengths are `factor` times as large; its numbers may be infinite there."""
        ...

    def simplified(self, shape: S) -> Shape:
        """The simplest shape that is the same: itself, unless that is less to model."""
        ...

    # ---- Where it is

    def facts(self, shapes: Sequence[S]) -> list[Facts]:
        """Look into many at once."""
        ...

    def why_nothing(self, shape: S, facts: Facts) -> str:
        """Why no ray hits it, as the end of a sentence "object 1 is nothing: ..."."""
        ...

    def oddity(self, shape: S, facts: Facts) -> str:
        """What is surely not meant about it, as the end of a sentence "object 1 ..."; empty if nothing is."""
        ...

    def contains(self, shape: S, point: Vector) -> bool:
        """Whether a point is inside, and not on the surface."""
        ...

    def lies_on(self, shape: S, point: Vector) -> bool:
        """Whether a point lies on one of its surfaces, as far as decimals of a file can say."""
        ...

    def distances(self, shape: S, facts: Facts, point: Vector) -> Distances:
        """How far its surface is from a point."""
        ...

    def reaches(self, shape: S, half_spaces: Sequence[Plane]) -> bool:
        """Whether it may reach into the intersection of half-spaces, whose normals have length 1."""
        ...

    def horizon(self, shape: S, facts: Facts, eye: Vector) -> Horizon:
        """How much of it may be seen from an eye."""
        ...

    # ---- How near a ray is to meeting something else, see `compare.margins`; points and directions are (3,)

    def intersections(self, shape: S, origin: "Floats", direction: "Floats") -> list[Intersection]:
        """Where a line enters and leaves it; where it misses it, perhaps where it comes nearest."""
        ...

    def silhouette_margin(self, shape: S, origin: "Floats", direction: "Floats") -> float:
        """From the line of a ray to where it begins, or ceases, to meet it."""
        ...

    def edge_margin(self, shape: S, origin: "Floats", direction: "Floats") -> float:
        """From the line of a ray, where it enters and leaves, to the next face; infinite if there is one face only."""
        ...

    def surface_margin(self, shape: S, p: "Floats", on_it: bool) -> float:
        """From a point to its surface; if it lies on that, to the next face."""
        ...

    def radius_of_curvature(self, shape: S, p: "Floats") -> float:
        """One that its surface has at a point of it, or a smaller one, a length; infinite if it is flat."""
        ...

    # ---- Renderers

    def add_to(self, native: Any, shape: S, facts: Facts, pigment: int, finish: int) -> None:
        """Add it to a `native_tracer.Scene`, of its planes those that have a face."""
        ...

    def geometry(self, shape: S, facts: Facts) -> dict[str, Any]:
        """The exact surface for Mitsuba's integrator, as `mitsuba_plugins.intersection.geometry` reads it."""
        ...

    def mitsuba_shape(self, shape: S, meshing: "Meshing", name: str) -> tuple[dict[str, Any], dict[str, Any]]:
        """Mitsuba's dictionary for it, without its material, and what `geometry` has to tell of its mesh besides.

        Args:
            shape: the shape.
            meshing: how fine meshes have to be, and where those of what has no bounds end.
            name: what messages call it.

        Raises:
            MeshError, ValueError: it cannot be made a mesh.
        """
        ...

    def povray(self, shape: S, facts: Facts) -> str:
        """A block of POV-Ray's language.

        Raises:
            ExportError: POV-Ray's numbers do not hold it.
        """
        ...
