"""What is on one side of a surface of second degree: bounded or not, and perhaps the complement of something."""

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from converter.scene.fields import Numbers
from converter.scene.model import Plane, Quadric, Shape, Vector
from converter.scene.numerals import numerals
from converter.shapes.kind import Distances, Facts, Horizon, Intersection
from converter.shapes.quadric_form import binary_form, decimal_form, kind_of, simplest, surface_box
from converter.to_povray.text import number, vector

if TYPE_CHECKING:
    from converter.scene.reader import Reader
    from converter.shapes.kind import Floats
    from converter.to_mitsuba.meshing import Meshing

NAME, PLURAL = "quadric", "quadrics"
LETTERS = ("A", "B", "C", "D", "E", "F", "G", "H", "I", "J")
NUMBERS = Numbers("a quadric", "A to J", LETTERS)


# ---- Scene files -----------------------------------------------------------------------------------------------------


def read(reader: "Reader", at: int) -> tuple[Quadric, int]:
    """`quadric A B C D E F G H I J`, which has a surface with a volume on one side."""
    a, b, c, d, e, f, g, h, i, j = numbers = reader.numbers(at + 1, NUMBERS, at)
    shape = Quadric((a, b, c, d, e, f, g, h, i, j))
    if all(map(math.isfinite, numbers)) and (flaw := kind_of(shape).flaw):
        reader.complain(at, f"this quadric has no surface: {flaw} (inside is A x^2 + ... + J <= 0)")
    return shape, at + 1 + len(numbers)


READERS = {"quadric": read}


def write(shape: Quadric) -> list[str]:
    """The line that is read."""
    return [f"quadric {numerals(*shape.coefficients)}"]


# ---- What it is made of ----------------------------------------------------------------------------------------------


def count(shape: Quadric) -> int:
    """One surface."""
    return 1


def extent(shape: Quadric) -> float:
    """The largest coordinate of its box, or of one around its middle."""
    return max(abs(x) for corner in _box(shape) for x in corner)


def ball(shape: Quadric) -> tuple[Vector, float] | None:
    """One that is a ball is simplified to it."""
    return None


def planes(shape: Quadric) -> tuple[Plane, ...]:
    """Those that are planes and nothing else are simplified to polyhedra."""
    return ()


def with_planes(shape: Quadric, planes: Sequence[Plane]) -> Quadric:
    """There are none."""
    return shape


def scaled(shape: Quadric, factor: float) -> Quadric:
    """All numbers times the factor squared, which are then those of lengths that are divided by it."""
    a, b, c, d, e, f, g, h, i, j = shape.coefficients
    return Quadric((a, b, c, d, e, f, factor * g, factor * h, factor * i, factor * factor * j))


def simplified(shape: Quadric) -> Shape:
    """A ball or a polyhedron where it is one."""
    return simplest(shape)


def classified(shape: Quadric) -> str:
    """E.g. "elliptic paraboloid" or "complement of a cone"."""
    return kind_of(shape).name


# ---- Where it is -----------------------------------------------------------------------------------------------------


def facts(shapes: Sequence[Quadric]) -> list[Facts]:
    """The exact box of an ellipsoid; of others one around the middle."""
    return [_facts(shape) for shape in shapes]


def _facts(shape: Quadric) -> Facts:
    kind = kind_of(shape)
    if kind.flaw:
        nowhere = (0.0, 0.0, 0.0)
        return Facts(nowhere, nowhere, nowhere, bounded=False, drawn=False)
    from converter.shapes.quadric_frame import frame_of

    bounded = kind.name == "ellipsoid" and surface_box(shape) is not None
    return Facts(*_box(shape), frame_of(shape).inside, bounded)


def _box(shape: Quadric) -> tuple[Vector, Vector]:
    from converter.shapes.quadric_frame import frame_of

    return surface_box(shape) or frame_of(shape).around_middle


def why_nothing(shape: Quadric, facts: Facts) -> str:
    """E.g. "no point is inside"."""
    return f"its quadric has no surface: {kind_of(shape).flaw}"


def oddity(shape: Quadric, facts: Facts) -> str:
    """Nothing is odd."""
    return ""


def contains(shape: Quadric, point: Vector) -> bool:
    """By the sign of what the decimals give."""
    return _finite(point) and decimal_form(shape).at([Fraction(repr(float(x))) for x in point]) < 0


def lies_on(shape: Quadric, point: Vector) -> bool:
    """Whether it does for some numbers that round to these doubles, as in `native_tracer.incidence`.

    Each is a 2^53th off at most, and each term of f has up to three.
    """
    if not _finite(point):
        return False
    form, p = binary_form(shape), [Fraction(x) for x in point]
    size = [abs(x) for x in p]
    quadratic = sum(abs(form.matrix[i][j]) * size[i] * size[j] for i in range(3) for j in range(3))
    linear = sum(2 * abs(h) * x for h, x in zip(form.half_slope, size, strict=True))
    return abs(form.at(p)) * 2**53 <= (3 * quadratic + 2 * linear + abs(form.constant)) * Fraction(257, 256)


def _finite(point: Vector) -> bool:
    return all(map(math.isfinite, point))


def distances(shape: Quadric, facts: Facts, point: Vector) -> Distances:
    """At least what f asks for, which cannot change faster than its gradient; at most that of the box's far corner."""
    from converter.shapes.quadric_frame import nearest_bound

    box = surface_box(shape)
    farthest = math.inf if box is None else math.hypot(*map(_farther, point, *box))
    largest = max(map(abs, (*point, *facts.low, *facts.high)))
    return Distances(nearest_bound(shape, point), farthest, largest)


def _farther(x: float, low: float, high: float) -> float:
    return max(abs(x - low), abs(x - high))


def reaches(shape: Quadric, half_spaces: Sequence[Plane]) -> bool:
    """Of an ellipsoid, whether it reaches into each of them; of others nothing is known."""
    from converter.shapes import quadric_frame

    return not _facts(shape).bounded or quadric_frame.reaches(shape, half_spaces)


def horizon(shape: Quadric, facts: Facts, eye: Vector) -> Horizon:
    """A bounded surface is wanted as a whole; others nestle to planes through their middle, or are as far from such."""
    middle = max(math.hypot(*map(_farther, eye, facts.low, facts.high)), 0.0)
    return Horizon(middle, 0.0, middle) if surface_box(shape) else Horizon(middle, middle, math.inf)


# ---- Margins ---------------------------------------------------------------------------------------------------------


def intersections(shape: Quadric, origin: "Floats", direction: "Floats") -> list[Intersection]:
    """The roots of a polynomial of second degree."""
    from converter.shapes import quadric_frame

    return quadric_frame.intersections(shape, origin, direction)


def silhouette_margin(shape: Quadric, origin: "Floats", direction: "Floats") -> float:
    """From where along the line it is nearest to touching the surface."""
    from converter.shapes import quadric_frame

    return quadric_frame.silhouette_margin(shape, origin, direction)


def edge_margin(shape: Quadric, origin: "Floats", direction: "Floats") -> float:
    """It has one face."""
    return math.inf


def surface_margin(shape: Quadric, p: "Floats", on_it: bool) -> float:
    """Along the gradient."""
    from converter.shapes import quadric_frame

    return quadric_frame.surface_margin(shape, p, on_it)


def radius_of_curvature(shape: Quadric, p: "Floats") -> float:
    """By the gradient there."""
    from converter.shapes import quadric_frame

    return quadric_frame.radius_of_curvature(shape, p)


# ---- Renderers -------------------------------------------------------------------------------------------------------


def add_to(native: Any, shape: Quadric, facts: Facts, pigment: int, finish: int) -> None:
    """Its ten numbers."""
    native.add_quadric(pigment, finish, shape.coefficients)


def geometry(shape: Quadric, facts: Facts) -> dict[str, Any]:
    """Its ten numbers, and the box around the surface."""
    return {"quadric": list(shape.coefficients), "box": surface_box(shape)}


def mitsuba_shape(shape: Quadric, meshing: "Meshing", name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """A `mesh` with a normal for each vertex."""
    from converter.to_mitsuba.meshes.quadrics import quadric_mesh

    mesh = quadric_mesh(shape, meshing.bounds, meshing.view, name)
    return {"type": "mesh", "mesh": mesh}, {"deviation": mesh.deviation}


def povray(shape: Quadric, facts: Facts) -> str:
    """POV-Ray's `quadric`, with numbers of a middling size."""
    numbers = shape.coefficients
    _, exponent = math.frexp(max(map(abs, numbers[:6])) or max(map(abs, numbers[6:9])))
    numbers = tuple(math.ldexp(x, 1 - exponent) if math.isfinite(x) else x for x in numbers)  # type: ignore[assignment]
    a, b, c = (vector(numbers[k : k + 3]) for k in (0, 3, 6))
    return f"quadric {{ {a}, {b}, {c}, {number(numbers[9])} }}"
