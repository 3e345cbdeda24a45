"""A pixel's rays as text: a line a ray, and below it what lights it and what becomes of it."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from converter.compare.rays import Pair, walk
from converter.renderers.records import LightRecord, RayRecord
from converter.scene.model import Scene
from converter.shapes.table import shape_kind

WIDTH = 120
"""Columns that the text is made for."""
DEEPEST_INDENT = 5
"""Depth up to which rays are indented; deeper ones have it behind their name."""
HEADER = ("ray", "throughput", "hit (line)", "t", "point", "normal", "side", "local colour")

Side = Literal["both", "reference", "test"]


@dataclass(frozen=True, slots=True)
class Line:
    """A line of the listing, of which renderer's ray it tells, and whether it belongs to the first difference."""

    text: str
    side: Side
    first: bool = False


def object_name(scene: Scene, index: int, plane: int | None = None) -> str:
    """`#11 plane 2 (27)`: an object by its index, a plane of it, and the line of the file it starts on."""
    o = scene.objects[index]
    shape = shape_kind(o.shape).NAME if plane is None else f"plane {plane}"
    return f"#{index} {shape}" + (f" ({o.line})" if o.line else "")


def list_rays(pairs: Sequence[Pair], scene: Scene, letters: tuple[str, str], first: Pair | None) -> list[Line]:
    """The lines for a pixel's rays.

    Args:
        pairs: its primary rays in both trees.
        scene: what they were traced in.
        letters: for the reference and for the test, a letter that marks lines on which they differ.
        first: the pair to be marked as the first difference.

    """
    entries: list[tuple[Side, bool, tuple[str, ...], list[str]]] = []
    for pair in walk(pairs):
        sides: Iterable[tuple[Side, RayRecord | None]] = [("both", pair.either)]
        if pair.unequal:
            sides = [("reference", pair.reference), ("test", pair.test)]
        for side, ray in sides:
            if ray is not None:
                entries.append((side, pair is first, _row(ray, scene), _remarks(ray, scene)))
    widths = [max(map(len, column)) for column in zip(HEADER, *(row for _, _, row, _ in entries), strict=True)]
    marks = {"both": " ", "reference": letters[0], "test": letters[1]}
    result = [Line(f"   {_aligned(HEADER, widths)}", "both")]
    for side, is_first, row, remarks in entries:
        mark = f"{'>' if is_first else ' '}{marks[side]} "
        result.append(Line(mark + _aligned(row, widths), side, is_first))
        indent = mark + " " * (widths[0] + 2)
        result += [Line(indent + line, side, is_first) for line in _filled(remarks, WIDTH - len(indent))]
    return result


def shown(value: Any) -> str:
    """A value of a ray tree with all of its digits that matter."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.10g}"
    if isinstance(value, list | tuple):
        return " ".join(shown(item) for item in value)
    return "-" if value is None else str(value)


def _aligned(cells: Sequence[str], widths: Sequence[int]) -> str:
    return "  ".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True)).rstrip()


def _row(ray: RayRecord, scene: Scene) -> tuple[str, ...]:
    depth = ray.depth
    kind = " " * min(depth, DEEPEST_INDENT) + ray.kind + (f" {depth}" if depth > DEEPEST_INDENT else "")
    throughput = f"{ray.throughput:.3g}"
    local = _numbers(ray.local, ".3f")
    hit = ray.hit
    if hit is None:
        return (kind, throughput, "nothing", "", "", "", "", local)
    return (
        kind,
        throughput,
        object_name(scene, hit.object, hit.plane),
        f"{hit.t:.5g}",
        _point(hit.point),
        _numbers(hit.normal, ".2f"),
        "out" if hit.entering else "in",
        local,
    )


def _filled(remarks: Sequence[str], width: int) -> list[str]:
    """Lines with as many whole remarks as fit."""
    lines: list[str] = []
    for remark in remarks:
        if lines and len(lines[-1]) + 2 + len(remark) <= width:
            lines[-1] += f"; {remark}"
        else:
            lines.append(remark)
    return lines


def _remarks(ray: RayRecord, scene: Scene) -> list[str]:
    """What a line of the table has no room for."""
    hit = ray.hit
    result = [f"time {ray.time:.4f}"] if ray.time is not None and ray.kind == "primary" else []
    if hit is not None:
        result += [_light(light, scene) for light in hit.lights]
    if hit is not None and hit.total_reflection:
        result.append("total internal reflection: the transmitted ray follows the mirror direction")
    if ray.dropped:
        reasons = {"cutoff": "below the cut-off", "depth": "at the depth limit"}
        dropped = (f"{kind} ({reasons.get(why, why)})" for kind, why in ray.dropped.items())
        result.append(f"dropped: {', '.join(dropped)}")
    return result


def _light(light: LightRecord, scene: Scene) -> str:
    name = f"light {light.light + 1}"  # the file's first is the ambient light
    if light.cosine <= 0:
        return f"{name} behind"
    if light.shadowed_by is not None:
        return f"{name} shadowed by {object_name(scene, light.shadowed_by)}"
    adds = [a + b for a, b in zip(light.diffuse, light.specular, strict=True)]
    return f"{name} adds {_numbers(adds, '.3f')} at n.l {light.cosine:.3f}"


def _point(point: Sequence[float]) -> str:
    """Four digits of the largest coordinate, and as many decimals of the others: they are all equally certain."""
    largest = max(map(abs, point))
    if not 1e-4 < largest < 1e4:  # NaN too
        return _numbers(point, ".4g")
    return _numbers(point, f".{max(0, 3 - math.floor(math.log10(largest)))}f")


def _numbers(values: Sequence[float], form: str) -> str:
    return " ".join(format(value + 0.0, form) for value in values)
