"""The exact surfaces of a scene: what Mitsuba's single-precision shapes were made from, as the integrator needs it.

The description is a JSON object with one entry an object, named as its shape is where there is one, in the order in
which ties go:

    {"object_0": {"material": "name of a BSDF", "sphere": [x, y, z, r]},
     "object_1": {"material": "name of a BSDF", "planes": {"0": [a, b, c, d], ...},
                  "box": [its lower corner, its upper corner] or null where it is unbounded,
                  "triangles": [plane of each triangle of its mesh], if it has one,
                  "deviation": largest distance of a mesh vertex from its planes, likewise},
     "object_2": {"material": "name of a BSDF", "quadric": [A, B, C, D, E, F, G, H, I, J], "box": likewise}}

A quadric is where A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J <= 0; it needs no box.

JSON writes the shortest digits that read back as the same double, so that nothing is lost in a file.
"""

import json
import math
from dataclasses import dataclass
from typing import Any

from mitsuba_plugins.intersection.shapes.kind import Shape, ShapeKind, Vector
from mitsuba_plugins.intersection.shapes.table import SHAPE_KINDS


@dataclass(frozen=True, slots=True)
class Surface:
    """An object: its shape, and what is known of its mesh."""

    name: str
    material: str
    kind: ShapeKind
    shape: Shape
    box: tuple[Vector, Vector] | None  # around it, with room for rounding; None where that is not finite
    triangles: tuple[int, ...] = ()
    deviation: float = 0.0


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
    key = next((key for key in SHAPE_KINDS if key in entry), None)
    if key is None:
        raise ValueError(f"whitted: 'geometry' gives {name} none of {', '.join(SHAPE_KINDS)}")
    kind = SHAPE_KINDS[key]
    shape = kind.read(entry)
    box = _roomy(*shape.box) if shape.box is not None else None
    triangles, deviation = tuple(entry.get("triangles", ())), entry.get("deviation", 0.0)
    return Surface(name, entry["material"], kind, shape, box, triangles, deviation)


def _roomy(low: Vector, high: Vector) -> tuple[Vector, Vector] | None:
    """A box a little larger than the surface, for the roundings here and in the kernel; None if no numbers hold it."""
    room = 1e-9 * max(map(abs, (*low, *high)))
    (a, b, c), (d, e, f) = low, high
    corners = (a - room, b - room, c - room), (d + room, e + room, f + room)
    return corners if all(map(math.isfinite, (*corners[0], *corners[1]))) else None
