"""The exact surfaces of a scene: what Mitsuba's single-precision shapes were made from, as the integrator needs it.

The description is a JSON object with one entry an object, named as its shape is where there is one, in the order in
which ties go:

    {"object_0": {"material": "name of a BSDF", "sphere": [x, y, z, r]},
     "object_1": {"material": "name of a BSDF", "planes": {"0": [a, b, c, d], ...},
                  "box": [its lower corner, its upper corner] or null where it is unbounded,
                  "triangles": [plane of each triangle of its mesh], if it has one,
                  "deviation": largest distance of a mesh vertex from its planes, likewise}}

JSON writes the shortest digits that read back as the same double, so that nothing is lost in a file.
"""

import json
import math
from dataclasses import dataclass, field
from typing import Any

Vector = tuple[float, float, float]
Plane = tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Surface:
    """A sphere (center, radius) or a convex polyhedron (planes, by their index in the scene)."""

    name: str
    material: str
    sphere: Plane | None = None
    planes: dict[int, Plane] = field(default_factory=dict)
    box: tuple[Vector, Vector] | None = None  # around it, with room for rounding; None where that is not finite
    triangles: tuple[int, ...] = ()
    deviation: float = 0.0

    @property
    def rows(self) -> list[Plane]:
        """The sphere, or the planes, with normals of any length."""
        return [self.sphere] if self.sphere is not None else list(self.planes.values())

    @property
    def unit_rows(self) -> list[Plane]:
        """The sphere, or the planes with unit normals."""
        return [self.sphere] if self.sphere is not None else list(map(_normalised, self.planes.values()))


class Geometry:
    """The surfaces of a scene.

    An object of a class that Dr.Jit does not know, since it looks for arrays in all lists, dictionaries and data
    classes that a plugin holds, again for every loop and branch that it records.
    """

    def __init__(self, surfaces: list[Surface]) -> None:
        self.surfaces = surfaces


def parse_geometry(text: str) -> Geometry:
    """Read a description.

    Raises:
        ValueError: it is not one.

    """
    try:
        return Geometry([_surface(name, entry) for name, entry in json.loads(text).items()])
    except (KeyError, TypeError, AttributeError, json.JSONDecodeError) as error:
        raise ValueError(f"whitted: 'geometry' does not describe surfaces: {error}") from error


def _surface(name: str, entry: dict[str, Any]) -> Surface:
    material = entry["material"]
    if "sphere" in entry:
        x, y, z, r = entry["sphere"]
        return Surface(name, material, (x, y, z, r), box=_roomy((x - r, y - r, z - r), (x + r, y + r, z + r)))
    planes = {int(index): _plane(*plane) for index, plane in entry["planes"].items()}
    box = _roomy(*entry["box"]) if entry["box"] is not None else None
    return Surface(name, material, None, planes, box, tuple(entry.get("triangles", ())), entry.get("deviation", 0.0))


def _roomy(low: Vector, high: Vector) -> tuple[Vector, Vector] | None:
    """A box a little larger than the surface, for the roundings here and in the kernel; None if no numbers hold it."""
    room = 1e-9 * max(map(abs, (*low, *high)))
    (a, b, c), (d, e, f) = low, high
    corners = (a - room, b - room, c - room), (d + room, e + room, f + room)
    return corners if all(map(math.isfinite, (*corners[0], *corners[1]))) else None


def _plane(a: float, b: float, c: float, d: float) -> Plane:
    return a, b, c, d


def _normalised(plane: Plane) -> Plane:
    a, b, c, d = plane
    length = math.hypot(a, b, c)
    return a / length, b / length, c / length, d / length
