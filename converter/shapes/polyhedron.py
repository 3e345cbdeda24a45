"""An intersection of half-spaces."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from converter.scene.errors import shown
from converter.scene.fields import Lost, Numbers
from converter.scene.model import Plane, Polyhedron, Vector
from converter.scene.numerals import numerals
from converter.shapes.kind import Distances, Facts, Horizon, Intersection
from converter.to_povray.text import number, vector

if TYPE_CHECKING:
    from converter.scene.reader import Reader
    from converter.shapes.kind import Floats
    from converter.to_mitsuba.meshing import Meshing
    from native_tracer.halfspaces import PolyhedronFacts

NAME, PLURAL = "polyhedron", "polyhedra"
PLANE = Numbers("a plane", "a, b, c and d", ("a", "b", "c", "d"))
MOST_READ = 1024
"""Planes that are read at once."""
MOST_TURNED = 64
"""Planes that are turned one by one, to see whether that bounds a body."""


# ---- Scene files -----------------------------------------------------------------------------------------------------


def read(reader: "Reader", at: int) -> tuple[Polyhedron, int]:
    """`polyhedron COUNT`, and four numbers for each plane."""
    from converter.scene.tokens import whole

    word = reader.word(at + 1, "the polyhedron's number of planes")
    count = whole(word)
    if not count:
        raise Lost(at + 1, f"the polyhedron's number of planes must be a whole number from 1 on, found {shown(word)}")
    head = at + 1
    at += 2
    planes: list[Plane] = []
    while len(planes) < count:
        size = min(count - len(planes), MOST_READ)
        if values := reader.good_numbers(at, 4 * size):
            several = list(zip(values[::4], values[1::4], values[2::4], values[3::4], strict=True))
            if not any(a == b == c == 0 for a, b, c, _ in several):
                planes += several
                at += 4 * size
                continue
        for _ in range(size):
            if reader.begins_entry(at):
                raise Lost(head, f"{announced(word)}, found {len(planes)} before {reader.ending(at)}")
            planes.append(_read_plane(reader, at))
            at += 4
    return Polyhedron(tuple(planes)), at


def read_half_space(reader: "Reader", at: int) -> tuple[Polyhedron, int]:
    """`plane a b c d`, as some other programs of the course have it."""
    plane = _read_plane(reader, at + 1)
    reader.plane_lines.append(reader.text.line(at))
    return Polyhedron((plane,)), at + 5


def _read_plane(reader: "Reader", at: int) -> Plane:
    a, b, c, d = reader.numbers(at, PLANE, at)
    if a == b == c == 0:
        reader.complain(at, "a plane's normal (its first three numbers) must not be zero")
    return a, b, c, d


def announced(word: str) -> str:
    """`5 planes are announced`, for the word that says so."""
    from converter.scene.tokens import whole

    return f"{shown(word)[1:-1]} {'plane is' if whole(word) == 1 else 'planes are'} announced"


READERS = {"polyhedron": read, "plane": read_half_space}  # the second is found in real files


def write(shape: Polyhedron) -> list[str]:
    """A line for the number of planes, and one for each."""
    return [f"polyhedron {len(shape.planes)}", *(numerals(*plane) for plane in shape.planes)]


# ---- What it is made of ----------------------------------------------------------------------------------------------


def count(shape: Polyhedron) -> int:
    """Its planes."""
    return len(shape.planes)


def extent(shape: Polyhedron) -> float:
    """The largest distance of a plane from the origin."""
    return max(abs(plane[3]) / math.hypot(*plane[:3]) for plane in shape.planes)


def ball(shape: Polyhedron) -> tuple[Vector, float] | None:
    """It is none."""
    return None


def planes(shape: Polyhedron) -> tuple[Plane, ...]:
    """Its half-spaces."""
    return shape.planes


def with_planes(shape: Polyhedron, planes: Sequence[Plane]) -> Polyhedron:
    """Other half-spaces."""
    return Polyhedron(tuple(planes))


def scaled(shape: Polyhedron, factor: float) -> Polyhedron:
    """Planes farther away."""
    return Polyhedron(tuple((a, b, c, factor * d) for a, b, c, d in shape.planes))


def simplified(shape: Polyhedron) -> Polyhedron:
    """Itself; planes that have no face are left out by whoever draws it."""
    return shape


# ---- Where it is -----------------------------------------------------------------------------------------------------


def facts(shapes: Sequence[Polyhedron]) -> list[Facts]:
    """What `native_tracer.halfspaces` finds out."""
    from native_tracer.halfspaces import polyhedron_facts

    found = polyhedron_facts(shape.planes for shape in shapes)
    return [_facts(shape, each) for shape, each in zip(shapes, found, strict=True)]


def _facts(shape: Polyhedron, found: "PolyhedronFacts") -> Facts:
    # No scene file may hold what is neither a body nor a plate, but a program's scene may.
    kept = found.kept if found.drawn else tuple(range(len(shape.planes)))
    bounded = found.drawn and found.bounded
    return Facts(found.low, found.high, found.inside, bounded, found.drawn, kept, found.plate, found.conflict)


def why_nothing(shape: Polyhedron, facts: Facts) -> str:
    """E.g. "its planes 2 (0 1 0 -1) and 5 (0 -1 0 3) exclude each other", planes counted from 0."""
    planes, conflict = shape.planes, facts.conflict
    named = [f"{k} ({' '.join(f'{x:.12g}' for x in planes[k])})" for k in conflict]
    listed = " and ".join([", ".join(named[:-1]), named[-1]])
    if len(conflict) > 2:
        return f"its planes {listed} have no volume in common"
    # Two planes without a volume between them are parallel, and face away from each other.
    distances = [planes[k][3] / math.hypot(*planes[k][:3]) for k in conflict]
    apart = sum(distances) > 1e-12 * max(map(abs, distances))
    if apart:
        return f"its planes {listed} exclude each other: inside is a x + b y + c z + d <= 0, so turn the signs of both"
    return f"its planes {listed} touch, and leave neither a volume nor a face"


def oddity(shape: Polyhedron, facts: Facts) -> str:
    """Without bounds, and bounded with one of its planes turned, and with no other.

    A column, which some scenes stand on, is not, whatever is turned.
    """
    from native_tracer.halfspaces import polyhedron_facts

    planes = shape.planes
    if facts.bounded or not 4 <= len(planes) <= MOST_TURNED:
        return ""
    found = polyhedron_facts([[_turned(p) if j == k else p for j, p in enumerate(planes)] for k in facts.planes])
    bounding = [k for k, fact in zip(facts.planes, found, strict=True) if fact.solid and fact.bounded]
    if len(bounding) != 1:
        return ""
    k = bounding[0]
    turned = " ".join(f"{x:.12g}" for x in _turned(planes[k]))
    return f"goes on without end, and would not if the signs of its plane {k} were turned, to {turned}"


def _turned(plane: Plane) -> Plane:
    a, b, c, d = (0.0 - x for x in plane)  # 0, and not -0
    return (a, b, c, d)


def contains(shape: Polyhedron, point: Vector) -> bool:
    """Below all planes."""
    x, y, z = point
    return all(a * x + b * y + c * z + d < 0 for a, b, c, d in shape.planes)


def lies_on(shape: Polyhedron, point: Vector) -> bool:
    """On one of its planes, wherever its faces are; see `native_tracer.incidence`."""
    from native_tracer.incidence import surfaces_at

    return bool(surfaces_at(point, list(shape.planes), [False] * len(shape.planes)))


def signed_distances(shape: Polyhedron, point: Vector, which: Sequence[int] | None = None) -> list[float]:
    """Of a point from each plane, or from some, by their indices; negative inside."""
    x, y, z = point
    planes = shape.planes if which is None else [shape.planes[k] for k in which]
    return [(a * x + b * y + c * z + d) / math.hypot(a, b, c) for a, b, c, d in planes]


def distances(shape: Polyhedron, facts: Facts, point: Vector) -> Distances:
    """At least that of the nearest plane if the point is inside, and of the plane that it is farthest above if not."""
    farthest = math.inf
    if facts.bounded:
        corners = zip(point, facts.low, facts.high, strict=True)
        farthest = math.hypot(*(max(abs(x - p), abs(y - p)) for p, x, y in corners))
    numbers = (abs(shape.planes[k][3]) / math.hypot(*shape.planes[k][:3]) for k in facts.planes)
    return Distances(
        abs(max(signed_distances(shape, point, facts.planes))), farthest, max([*map(abs, point), *numbers])
    )


def reaches(shape: Polyhedron, half_spaces: Sequence[Plane]) -> bool:
    """Whether something is left if all are intersected."""
    from native_tracer.halfspaces import polyhedron_facts

    return polyhedron_facts([[*shape.planes, *half_spaces]])[0].drawn


def horizon(shape: Polyhedron, facts: Facts, eye: Vector) -> Horizon:
    """Planes are seen as far as the eye is high above them."""
    from converter.shapes.half_space_arrays import farthest_plane

    corners = zip(eye, facts.low, facts.high, strict=True)
    farthest = math.hypot(*(max(p - x, y - p) for p, x, y in corners)) if facts.bounded else math.inf
    return Horizon(0.0, farthest_plane([shape.planes[k] for k in facts.planes], eye), farthest)


# ---- Margins ---------------------------------------------------------------------------------------------------------


def intersections(shape: Polyhedron, origin: "Floats", direction: "Floats") -> list[Intersection]:
    """Where a line enters the last half-space that it enters, and leaves the first."""
    from converter.shapes import half_space_arrays

    return half_space_arrays.intersections(shape, origin, direction)


def silhouette_margin(shape: Polyhedron, origin: "Floats", direction: "Floats") -> float:
    """By all pairs of planes, of which a line enters one and leaves the other."""
    from converter.shapes import half_space_arrays

    return half_space_arrays.silhouette_margin(shape, origin, direction)


def edge_margin(shape: Polyhedron, origin: "Floats", direction: "Floats") -> float:
    """By the two planes that are entered last, and the two that are left first."""
    from converter.shapes import half_space_arrays

    return half_space_arrays.edge_margin(shape, origin, direction)


def surface_margin(shape: Polyhedron, p: "Floats", on_it: bool) -> float:
    """By the signed distances from the planes."""
    from converter.shapes import half_space_arrays

    return half_space_arrays.surface_margin(shape, p, on_it)


def radius_of_curvature(shape: Polyhedron, p: "Floats") -> float:
    """Faces are flat."""
    return math.inf


# ---- Renderers -------------------------------------------------------------------------------------------------------


def add_to(native: Any, shape: Polyhedron, facts: Facts, pigment: int, finish: int) -> None:
    """Its planes that have a face."""
    native.add_polyhedron(pigment, finish, [shape.planes[k] for k in facts.planes])


def geometry(shape: Polyhedron, facts: Facts) -> dict[str, Any]:
    """Its planes that have a face, by their indices, and its box."""
    planes = {str(k): list(shape.planes[k]) for k in facts.planes}
    return {"planes": planes, "box": (facts.low, facts.high) if facts.bounded else None}


def mitsuba_shape(shape: Polyhedron, meshing: "Meshing", name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """A `mesh` that holds a `PolyhedronMesh` of ours."""
    from converter.to_mitsuba.meshes import polyhedron_mesh

    mesh = polyhedron_mesh(shape.planes, meshing.bounds, name)
    return {"type": "mesh", "mesh": mesh}, {"triangles": mesh.planes.tolist(), "deviation": mesh.deviation}


def povray(shape: Polyhedron, facts: Facts) -> str:
    """An `intersection` of planes, or a plane that is clipped by others for a plate."""
    if plate := facts.plate:
        sides = "".join(f"\n    {_povray_plane(shape.planes[k])}" for k in facts.planes if k not in plate)
        clipped = f"\n  clipped_by {{{sides}\n  }}" if sides else ""
        return f"plane {{ {_normal_and_distance(shape.planes[plate[0]])}{clipped}\n}}"
    planes = [shape.planes[k] for k in facts.planes]
    if len(planes) == 1:
        return _povray_plane(planes[0])
    # POV-Ray sees by itself how far a body reaches only where its planes are at right angles to the axes.
    bounds = f"\n  bounded_by {{ box {{ {_povray_box(facts.low, facts.high)} }} }}" if facts.bounded else ""
    inner = "".join(f"\n  {_povray_plane(plane)}" for plane in planes)
    return f"intersection {{{inner}{bounds}\n}}"


def _povray_plane(plane: Plane) -> str:
    return f"plane {{ {_normal_and_distance(plane)} }}"


def _normal_and_distance(plane: Plane) -> str:
    """A plane's unit normal, and its distance from the origin along it."""
    a, b, c, d = plane
    length = math.hypot(a, b, c)
    return f"{vector((a / length, b / length, c / length))}, {number(-d / length)}"


def _povray_box(low: Vector, high: Vector) -> str:
    """A box a little larger than the body, so that no rounding cuts that."""
    room = 1e-6 * max(map(abs, (*low, *high)))
    return f"{vector(v - room for v in low)}, {vector(v + room for v in high)}"
