"""What `whitted inspect` tells of csgs: their trees, leaves and boxes, and what of them changes nothing."""

from collections.abc import Iterator
from typing import Any

from converter.scene.model import Csg, Polyhedron, Quadric, Scene, Shape, Sphere
from converter.scene.needs import SceneNeeds
from converter.shapes.csg_program import Path, idle_operands, program_of, written_leaves
from converter.shapes.quadric import classified
from converter.shapes.table import shape_kind


def csg_trees(scene: Scene, drawn: Scene, needs: SceneNeeds) -> list[dict[str, Any]]:
    """Each csg of a scene, with the shape that it is drawn as."""
    return [
        {
            "object": i,
            "line": o.line,
            "drawn_as": shape_kind(simple.shape).NAME,
            "leaves": sum(1 for _ in written_leaves(o.shape)),
            "different_leaves": len(program_of(o.shape).leaves),
            "levels": _levels(o.shape),
            "bounded": needs.bounded[i],
            "box": needs.boxes[i],
            "operands": _operands(o.shape, ()),
            "changing_nothing": sorted(idle_operands(o.shape)),
        }
        for i, (o, simple) in enumerate(zip(scene.objects, drawn.objects, strict=True))
        if isinstance(o.shape, Csg)
    ]


def _levels(shape: Shape) -> int:
    return 1 + max(_levels(operand.shape) for operand in shape.operands) if isinstance(shape, Csg) else 0


def _operands(shape: Csg, path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = []
    for k, operand in enumerate(shape.operands):
        inner, here = operand.shape, (*path, k)
        told: dict[str, Any] = {"operation": operand.operation, "kind": shape_kind(inner).NAME, "path": here}
        if isinstance(inner, Csg):
            told["operands"] = _operands(inner, here)
        else:
            told["told"] = _told(inner)
        found.append(told)
    return found


def _told(shape: Shape) -> str:
    match shape:
        case Sphere(center, radius):
            return " ".join(f"{x:g}" for x in (*center, radius))
        case Polyhedron(planes):
            return " ".join(f"{x:g}" for x in planes[0]) if len(planes) == 1 else f"of {len(planes)} planes"
        case Quadric():
            return classified(shape)
    return ""


def csg_lines(csg: dict[str, Any]) -> Iterator[str]:
    """A csg as lines of text, each operand indented as deep as it is."""
    line = f" (line {csg['line']})" if csg["line"] else ""
    low, high = (" ".join(f"{x:g}" for x in corner) for corner in csg["box"])
    reach = f"from {low} to {high}" if csg["bounded"] else "without bounds"
    as_what = "" if csg["drawn_as"] == "csg" else f", drawn as a {csg['drawn_as']}"
    leaves, different = csg["leaves"], csg["different_leaves"]
    told = (
        f"{leaves} {'leaf' if leaves == 1 else 'leaves'}, {different} that matter" if different else f"{leaves} leaves"
    )
    levels = f"{csg['levels']} level{'' if csg['levels'] == 1 else 's'}"
    yield f"object {csg['object']}{line} is a csg of {told}, {levels}, {reach}{as_what}"
    yield from _tree(csg["operands"], {tuple(path) for path in csg["changing_nothing"]}, "  ")


def _tree(operands: list[dict[str, Any]], idle: set[Path], indent: str) -> Iterator[str]:
    for operand in operands:
        note = "   (changes nothing)" if tuple(operand["path"]) in idle else ""
        told = f" {operand['told']}" if "told" in operand else ""
        yield f"{indent}{operand['operation']} {operand['kind']}{told}{note}"
        yield from _tree(operand.get("operands", []), idle, indent + "  ")
