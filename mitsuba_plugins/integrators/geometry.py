"""The exact surfaces of a scene: what Mitsuba's single-precision shapes were made from, as the integrator needs it.

The description is a JSON object with one entry a shape, named by the shape's id, in the order in which ties go:

    {"object_0": {"sphere": [x, y, z, r]},
     "object_1": {"planes": {"0": [a, b, c, d], ...}, "triangles": [plane of each triangle of the mesh],
                  "box": [its lower corner, its upper corner] or null where it is unbounded,
                  "deviation": largest distance of a mesh vertex from its planes}}

JSON writes the shortest digits that read back as the same double, so that nothing is lost in a file.
"""

import json
import math
from dataclasses import dataclass, field
from typing import Any

Plane = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Surface:
    """A sphere (center, radius) or a convex polyhedron (planes with unit normals, by their index in the scene)."""

    name: str
    sphere: Plane | None = None
    planes: dict[int, Plane] = field(default_factory=dict)
    bound: Plane | None = None  # a sphere around a bounded polyhedron
    triangles: tuple[int, ...] = ()
    deviation: float = 0.0


def parse_geometry(text: str) -> list[Surface]:
    """Read a description.

    Raises:
        ValueError: it is not one.

    """
    try:
        return [_surface(name, entry) for name, entry in json.loads(text).items()]
    except (KeyError, TypeError, AttributeError, json.JSONDecodeError) as error:
        raise ValueError(f"whitted: 'geometry' does not describe surfaces: {error}") from error


def _surface(name: str, entry: dict[str, Any]) -> Surface:
    if "sphere" in entry:
        x, y, z, r = entry["sphere"]
        return Surface(name, sphere=(x, y, z, r))
    planes = {int(index): _normalised(plane) for index, plane in entry["planes"].items()}
    box = entry["box"]
    bound = _sphere_around(*box) if box is not None else None
    return Surface(name, None, planes, bound, tuple(entry["triangles"]), entry["deviation"])


def _sphere_around(low: list[float], high: list[float]) -> Plane:
    x, y, z = ((a + b) / 2 for a, b in zip(low, high, strict=True))
    # A little larger than the box, for the roundings here and in the kernel.
    reach = max(map(abs, [*low, *high]))
    return x, y, z, math.dist(low, high) / 2 + 1e-9 * reach


def _normalised(plane: list[float]) -> Plane:
    a, b, c, d = plane
    length = math.hypot(a, b, c)
    return a / length, b / length, c / length, d / length
