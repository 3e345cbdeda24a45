"""A ball."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from converter.scene.errors import shown
from converter.scene.fields import Numbers
from converter.scene.model import Plane, Sphere, Vector
from converter.scene.numerals import numerals
from converter.shapes.kind import Distances, Facts, Horizon, Intersection
from converter.to_povray.text import number, vector

if TYPE_CHECKING:
    from converter.scene.reader import Reader
    from converter.shapes.kind import Floats
    from converter.to_mitsuba.meshing import Meshing

NAME, PLURAL = "sphere", "spheres"
NUMBERS = Numbers("sphere", "its centre and radius", ("x", "y", "z", "radius"))


# ---- Scene files -----------------------------------------------------------------------------------------------------


def read(reader: "Reader", at: int) -> tuple[Sphere, int]:
    """`sphere x y z radius`, the radius above 0."""
    x, y, z, radius = reader.numbers(at + 1, NUMBERS, at)
    if radius <= 0:
        reader.complain(at + 4, f"the radius must be above 0, found {shown(reader.text[at + 4])}")
    return Sphere((x, y, z), radius), at + 5


READERS = {"sphere": read}


def write(shape: Sphere) -> list[str]:
    """The line that is read."""
    return [f"sphere {numerals(*shape.center, shape.radius)}"]


# ---- What it is made of ----------------------------------------------------------------------------------------------


def count(shape: Sphere) -> int:
    """One sphere."""
    return 1


def extent(shape: Sphere) -> float:
    """The largest coordinate of its box."""
    return max(map(abs, shape.center)) + shape.radius


def ball(shape: Sphere) -> tuple[Vector, float] | None:
    """It is one."""
    return shape.center, shape.radius


def planes(shape: Sphere) -> tuple[Plane, ...]:
    """None."""
    return ()


def with_planes(shape: Sphere, planes: Sequence[Plane]) -> Sphere:
    """There are none."""
    return shape


def scaled(shape: Sphere, factor: float) -> Sphere:
    """Moved away from the origin, and larger."""
    x, y, z = shape.center
    return Sphere((factor * x, factor * y, factor * z), factor * shape.radius)


def simplified(shape: Sphere) -> Sphere:
    """Itself."""
    return shape


# ---- Where it is -----------------------------------------------------------------------------------------------------


def facts(shapes: Sequence[Sphere]) -> list[Facts]:
    """A box from the radius."""
    return [
        Facts((x - r, y - r, z - r), (x + r, y + r, z + r), shape.center)
        for shape in shapes
        for (x, y, z), r in ((shape.center, shape.radius),)
    ]


def why_nothing(shape: Sphere, facts: Facts) -> str:
    """It is always something."""
    return ""


def oddity(shape: Sphere, facts: Facts) -> str:
    """Nothing is odd."""
    return ""


def contains(shape: Sphere, point: Vector) -> bool:
    """By the distance from the centre."""
    return math.dist(point, shape.center) < shape.radius


def lies_on(shape: Sphere, point: Vector) -> bool:
    """See `native_tracer.incidence`."""
    from native_tracer.incidence import surfaces_at

    return bool(surfaces_at(point, [(*shape.center, shape.radius)], [True]))


def distances(shape: Sphere, facts: Facts, point: Vector) -> Distances:
    """At least | |p - c| - r |, and at most |p - c| + r."""
    apart = math.dist(point, shape.center)
    return Distances(abs(apart - shape.radius), apart + shape.radius, max(map(abs, point)) + apart)


def reaches(shape: Sphere, half_spaces: Sequence[Plane]) -> bool:
    """Whether its centre is no farther than its radius from each of them."""
    x, y, z = shape.center
    return all(a * x + b * y + c * z + d <= shape.radius + 1e-9 * abs(d) for a, b, c, d in half_spaces)


def horizon(shape: Sphere, facts: Facts, eye: Vector) -> Horizon:
    """It is wanted as a whole."""
    farthest = math.dist(eye, shape.center) + shape.radius
    return Horizon(farthest, 0.0, farthest)


# ---- Margins ---------------------------------------------------------------------------------------------------------


def intersections(shape: Sphere, origin: "Floats", direction: "Floats") -> list[Intersection]:
    """Where a line enters and leaves; where it misses the ball, where it comes nearest, twice."""
    along, across = _nearest(shape, origin, direction)
    half = math.sqrt(max(shape.radius**2 - across**2, 0.0))
    return [Intersection(along - half, -half / shape.radius), Intersection(along + half, half / shape.radius)]


def silhouette_margin(shape: Sphere, origin: "Floats", direction: "Floats") -> float:
    """By the line's distance from the centre."""
    _, across = _nearest(shape, origin, direction)
    return abs(across - shape.radius)


def edge_margin(shape: Sphere, origin: "Floats", direction: "Floats") -> float:
    """It has one face."""
    return math.inf


def surface_margin(shape: Sphere, p: "Floats", on_it: bool) -> float:
    """By the distance from the centre."""
    return math.inf if on_it else abs(math.dist(shape.center, p) - shape.radius)


def radius_of_curvature(shape: Sphere, p: "Floats") -> float:
    """The same everywhere."""
    return shape.radius


def _nearest(shape: Sphere, origin: "Floats", direction: "Floats") -> tuple[float, float]:
    """How far along a line it comes nearest to the centre, and how near."""
    import numpy as np

    to_center = np.array(shape.center) - origin
    along = float(to_center @ direction)
    return along, float(np.linalg.norm(to_center - along * direction))


# ---- Renderers -------------------------------------------------------------------------------------------------------


def add_to(native: Any, shape: Sphere, facts: Facts, pigment: int, finish: int) -> None:
    """A sphere."""
    native.add_sphere(pigment, finish, shape.center, shape.radius)


def geometry(shape: Sphere, facts: Facts) -> dict[str, Any]:
    """Its four numbers."""
    return {"sphere": [*shape.center, shape.radius]}


def mitsuba_shape(shape: Sphere, meshing: "Meshing", name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Mitsuba's `sphere`, or a mesh where a tolerance asks for one."""
    if meshing.unit_ball is not None:
        return {"type": "mesh", "mesh": meshing.unit_ball.placed(shape)}, {}
    return {"type": "sphere", "center": list(shape.center), "radius": shape.radius}, {}


def povray(shape: Sphere, facts: Facts) -> str:
    """POV-Ray's `sphere`."""
    return f"sphere {{ {vector(shape.center)}, {number(shape.radius)} }}"
