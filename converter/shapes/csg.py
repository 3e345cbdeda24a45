"""Constructive solid geometry: unions, differences and intersections of shapes."""

import math
from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, assert_never, cast

from converter.scene.errors import shown
from converter.scene.fields import MOVE, Lost
from converter.scene.model import Csg, Operand, Plane, Polyhedron, Primitive, Quadric, Shape, Sphere, Vector
from converter.scene.tokens import found, whole
from converter.shapes.csg_places import box_of, inside_point, values_around
from converter.shapes.csg_program import (
    DIFFERENCE,
    INTERSECTION,
    OPERATIONS,
    UNION,
    combined_bits,
    fold,
    program_of,
    with_leaves,
    written_leaves,
)
from converter.shapes.csg_regions import region_of
from converter.shapes.kind import Distances, Facts, Horizon, Intersection
from converter.shapes.primitives import primitive_kind
from converter.shapes.quadric import classified

if TYPE_CHECKING:
    from converter.scene.reader import Reader
    from converter.shapes.kind import Floats
    from converter.to_mitsuba.meshing import Meshing

NAME, PLURAL = "csg", "csgs"
MOST_LEAVES, MOST_LEVELS = 64, 32
"""Primitives of one csg, and csgs in one another, at most."""
SIGNS = "'+', '-' or '&'"
POVRAY = {UNION: "merge", DIFFERENCE: "difference", INTERSECTION: "intersection"}
"""POV-Ray's `union` has its operands' surfaces inside, too."""


# ---- Scene files -----------------------------------------------------------------------------------------------------


def read(reader: "Reader", at: int) -> tuple[Csg, int]:
    """`csg COUNT`, and so many operands, each a sign and a whole object, whose pigment and finish mean nothing."""
    return _read(reader, at, 1, 0)


def _read(reader: "Reader", at: int, level: int, leaves: int) -> tuple[Csg, int]:
    """A csg that is the `level`-th in one another, and has so many leaves before it."""
    from converter.scene.entries import body  # late: it reads all kinds of shapes, of which this is one
    from converter.shapes.readers import SHAPE_READERS

    if level > MOST_LEVELS:
        raise Lost(at, f"more than {MOST_LEVELS} csgs are in one another")
    head = at + 1
    word = reader.word(head, "the csg's number of operands")
    count = whole(word)
    if not count:
        raise Lost(head, f"the csg's number of operands must be a whole number from 1 on, found {shown(word)}")
    at += 2
    operands: list[Operand] = []
    while len(operands) < count:
        sign = _sign(reader, at, head, len(operands))
        operand, end = body(reader, at + 1, {**SHAPE_READERS, "csg": partial(_read, level=level + 1, leaves=leaves)})
        leaves += sum(1 for _ in written_leaves(operand.shape)) if isinstance(operand.shape, Csg) else 1
        if leaves > MOST_LEAVES:
            raise Lost(at + 3, f"a csg may have {MOST_LEAVES} spheres, polyhedra and quadrics at most, found more")
        operands.append(Operand(sign, operand.shape))
        at = end
        if len(operands) < count and reader.has(at) and reader.text[at] == MOVE:
            raise Lost(at, "an operand does not move by itself: 'move' stands behind the last one, for the whole csg")
    if level == 1 and reader.has(at) and reader.text[at] in OPERATIONS:
        raise Lost(head, f"{_announced(word)}, but another one follows")
    return Csg(tuple(operands)), at


def _sign(reader: "Reader", at: int, head: int, before: int) -> Literal["+", "-", "&"]:
    """The sign at a word, before which there are so many operands."""
    sign = reader.text[at] if reader.has(at) else ""
    if sign not in OPERATIONS:
        if reader.begins_entry(at):
            raise Lost(head, f"{_announced(reader.text[head])}, found {before} before {reader.ending(at)}")
        raise Lost(at, f"expected {SIGNS} before an operand of the csg, {found(sign)}")
    if not before and sign != "+":
        reader.complain(at, f"the first operand of a csg must have '+', found {shown(sign)}")
    return cast(Literal["+", "-", "&"], sign)


def _announced(word: str) -> str:
    return f"{shown(word)[1:-1]} {'operand is' if whole(word) == 1 else 'operands are'} announced"


READERS = {"csg": read}


def write(shape: Csg) -> list[str]:
    """A line for the number of operands, and those that are read, with the first pigment and the first finish."""
    lines = [f"csg {len(shape.operands)}"]
    for operand in shape.operands:
        inner = operand.shape
        first, *others = write(inner) if isinstance(inner, Csg) else primitive_kind(inner).write(inner)
        lines += [f"{operand.operation} 0 0 {first}", *others]
    return lines


# ---- What it is made of ----------------------------------------------------------------------------------------------


def count(shape: Csg) -> int:
    """The primitives of its leaves."""
    return sum(primitive_kind(leaf).count(leaf) for leaf in program_of(shape).leaves)


def extent(shape: Csg) -> float:
    """The largest of its leaves'."""
    return max((primitive_kind(leaf).extent(leaf) for leaf in program_of(shape).leaves), default=0.0)


def ball(shape: Csg) -> tuple[Vector, float] | None:
    """One that is a ball is simplified to it."""
    return None


def planes(shape: Csg) -> tuple[Plane, ...]:
    """Those of its leaves, as they are written."""
    return tuple(plane for leaf in written_leaves(shape) for plane in primitive_kind(leaf).planes(leaf))


def with_planes(shape: Csg, planes: Sequence[Plane]) -> Csg:
    """Leaves with other planes."""
    rest = iter(planes)

    def replaced() -> Any:
        for leaf in written_leaves(shape):
            kind = primitive_kind(leaf)
            yield kind.with_planes(leaf, [next(rest) for _ in kind.planes(leaf)])

    return with_leaves(shape, replaced())


def scaled(shape: Csg, factor: float) -> Csg:
    """Of scaled leaves."""
    return with_leaves(shape, (primitive_kind(leaf).scaled(leaf, factor) for leaf in written_leaves(shape)))


def simplified(shape: Csg) -> Shape:
    """A primitive where one is left of it."""
    program = program_of(shape)
    return program.leaves[0] if len(program.code) == 1 else shape


# ---- Where it is -----------------------------------------------------------------------------------------------------


def facts(shapes: Sequence[Csg]) -> list[Facts]:
    """By its leaves' boxes."""
    return [_facts(shape) for shape in shapes]


def _facts(shape: Csg) -> Facts:
    program, region = program_of(shape), region_of(shape)
    if region is None or not program.code:
        nowhere = (0.0, 0.0, 0.0)
        return Facts(nowhere, nowhere, nowhere, bounded=False, drawn=False)
    low, high = box_of(program, region)
    x, y, z = ((p + q) / 2 for p, q in zip(low, high, strict=True))
    return Facts(low, high, inside_point(shape) or (x, y, z), region.bounded)


def why_nothing(shape: Csg, facts: Facts) -> str:
    """What is known of it."""
    if program_of(shape).everything:
        return "every point is inside of its csg, which has no surface"
    return "no point is inside of its csg"


def oddity(shape: Csg, facts: Facts) -> str:
    """Nothing is odd."""
    return ""


def contains(shape: Csg, point: Vector) -> bool:
    """By the expression; whether it is also where leaves meet and their surfaces are none of the whole."""
    return values_around(program_of(shape), point) == {True}


def lies_on(shape: Csg, point: Vector) -> bool:
    """On a surface of a leaf, where that has inside of the whole on one side, and outside on the other."""
    return len(values_around(program_of(shape), point)) == 2


def distances(shape: Csg, facts: Facts, point: Vector) -> Distances:
    """At least that of the nearest surface of a leaf; at most that of the box's farthest corner."""
    program = program_of(shape)
    found = [
        primitive_kind(leaf).distances(leaf, known, point)
        for leaf, known in zip(program.leaves, program.facts, strict=True)
    ]
    farthest = max((each.farthest for each in found), default=0.0)
    if facts.bounded:
        farthest = min(farthest, _farthest_corner(facts, point))
    nearest = min((each.nearest for each in found), default=0.0)
    return Distances(nearest, max(nearest, farthest), max((each.largest for each in found), default=0.0))


def _farthest_corner(facts: Facts, point: Vector) -> float:
    sides = zip(point, facts.low, facts.high, strict=True)
    return math.hypot(*(max(abs(x - p), abs(y - p)) for p, x, y in sides))


def reaches(shape: Csg, half_spaces: Sequence[Plane]) -> bool:
    """By its leaves, and the convex set around it."""
    from native_tracer.halfspaces import polyhedron_facts

    program, region = program_of(shape), region_of(shape)
    if region is None:
        return False
    if region.sides and not polyhedron_facts([[*region.sides, *half_spaces]])[0].drawn:
        return False
    leaves = [int(primitive_kind(leaf).reaches(leaf, half_spaces)) for leaf in program.leaves]

    def combined(operation: int, a: int, b: int) -> int:
        # What is subtracted, reaching there or not, leaves what reaches there.
        return a if operation == DIFFERENCE else combined_bits(operation, a, b)

    return bool(fold(program.code, lambda k: leaves[k], combined))


def horizon(shape: Csg, facts: Facts, eye: Vector) -> Horizon:
    """It is wanted as a whole, or, of what has no bounds, as far as its leaves are."""
    if facts.bounded:
        farthest = _farthest_corner(facts, eye)
        return Horizon(farthest, 0.0, farthest)
    program = program_of(shape)
    found = [
        primitive_kind(leaf).horizon(leaf, known, eye)
        for leaf, known in zip(program.leaves, program.facts, strict=True)
    ]
    return Horizon(max(each.needed for each in found), max(each.height for each in found), math.inf)


# ---- Margins ---------------------------------------------------------------------------------------------------------


def intersections(shape: Csg, origin: "Floats", direction: "Floats") -> list[Intersection]:
    """Crossings of its leaves at which a line comes to be inside, or outside."""
    from converter.shapes import csg_rays

    return csg_rays.intersections(shape, origin, direction)


def silhouette_margin(shape: Csg, origin: "Floats", direction: "Floats") -> float:
    """By its leaves, and by where two of them meet."""
    from converter.shapes import csg_rays

    return csg_rays.silhouette_margin(shape, origin, direction)


def edge_margin(shape: Csg, origin: "Floats", direction: "Floats") -> float:
    """By the faces of its leaves."""
    from converter.shapes import csg_rays

    return csg_rays.edge_margin(shape, origin, direction)


def surface_margin(shape: Csg, p: "Floats", on_it: bool) -> float:
    """By its leaves."""
    from converter.shapes import csg_rays

    return csg_rays.surface_margin(shape, p, on_it)


def radius_of_curvature(shape: Csg, p: "Floats") -> float:
    """That of a leaf."""
    from converter.shapes import csg_rays

    return csg_rays.radius_of_curvature(shape, p)


# ---- Renderers -------------------------------------------------------------------------------------------------------


def add_to(native: Any, shape: Csg, facts: Facts, pigment: int, finish: int) -> None:
    """Its leaves, and its expression."""
    program = program_of(shape)
    native.add_csg(pigment, finish, [_native_leaf(leaf) for leaf in program.leaves], list(program.code))


def _native_leaf(leaf: Primitive) -> tuple[str, Any]:
    match leaf:
        case Sphere(center, radius):
            return "sphere", (*center, radius)
        case Polyhedron(planes):
            return "polyhedron", list(planes)
        case Quadric(coefficients):
            return "quadric", coefficients
    assert_never(leaf)


def geometry(shape: Csg, facts: Facts) -> dict[str, Any]:
    """Its leaves, and its expression."""
    program = program_of(shape)
    leaves = [
        primitive_kind(leaf).geometry(leaf, known) for leaf, known in zip(program.leaves, program.facts, strict=True)
    ]
    return {
        "csg": {"leaves": leaves, "program": list(program.code)},
        "box": (facts.low, facts.high) if facts.bounded else None,
    }


def mitsuba_shape(shape: Csg, meshing: "Meshing", name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """A `mesh` with a normal for each corner."""
    from converter.to_mitsuba.meshes.csg import csg_mesh

    region = region_of(shape)
    bounds = meshing.bounds if region is None else meshing.bounds.narrowed(region.low, region.high)
    mesh = csg_mesh(program_of(shape), bounds, meshing.view, name)
    return {"type": "mesh", "mesh": mesh}, {"deviation": mesh.deviation}


def povray(shape: Csg, facts: Facts) -> str:
    """POV-Ray's own csg."""
    program = program_of(shape)

    def leaf(k: int) -> str:
        return _povray_leaf(program.leaves[k], program.facts[k])

    def combined(operation: int, a: str, b: str) -> str:
        inner = f"{a}\n{b}".replace("\n", "\n  ")
        return f"{POVRAY[operation]} {{\n  {inner}\n}}"

    return fold(program.code, leaf, combined)


def _povray_leaf(leaf: Primitive, facts: Facts) -> str:
    """POV-Ray takes the complement of an ellipsoid for as small as that, unless it is told of the ellipsoid."""
    kind = primitive_kind(leaf)
    if isinstance(leaf, Quadric) and classified(leaf).startswith("complement"):
        a, b, c, d, e, f, g, h, i, j = (0.0 - x for x in leaf.coefficients)
        block = kind.povray(Quadric((a, b, c, d, e, f, g, h, i, j)), facts)
        return f"{block.removesuffix('}')}inverse }}"
    return kind.povray(leaf, facts)
