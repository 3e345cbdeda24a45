"""The exact surfaces of a scene: what Mitsuba's single-precision shapes were made from, as the integrator needs it.

The description is a JSON object with one entry an object, named as its shape is where there is one, in the order in
which ties go:

    {"object_0": {"material": "name of a BSDF", "sphere": [x, y, z, r]},
     "object_1": {"material": "name of a BSDF", "planes": {"0": [a, b, c, d], ...},
                  "box": [its lower corner, its upper corner] or null where it is unbounded,
                  "triangles": [plane of each triangle of its mesh], if it has one,
                  "deviation": largest distance of a mesh vertex from its planes, likewise},
     "object_2": {"material": "name of a BSDF", "quadric": [A, B, C, D, E, F, G, H, I, J], "box": likewise},
     "object_3": {"material": "name of a BSDF", "csg": {"leaves": [as above, without materials], "program": [0, 1, -2]},
                  "box": likewise}}

An object that moves has its displacement too, "move": [dx, dy, dz]; its shape, box and pigment are those at time 0.
A quadric is where A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J <= 0; it needs no box.
A csg's program is in postfix notation: k from 0 on is leaf k, -1 a union, -2 a difference, -3 an intersection.

JSON writes the shortest digits that read back as the same double, so that nothing is lost in a file.
"""

import json
import math
from dataclasses import dataclass
from typing import Any

from mitsuba_plugins.intersection.csg import Csg, Leaf, leaves_of
from mitsuba_plugins.intersection.csg_search import SearchedCsg
from mitsuba_plugins.intersection.csg_stepped import SteppedCsg
from mitsuba_plugins.intersection.csg_unrolled import UnrolledCsg
from mitsuba_plugins.intersection.shapes.kind import Row, Shape, ShapeKind, Vector
from mitsuba_plugins.intersection.shapes.table import SHAPE_KINDS
from mitsuba_plugins.intersection.solids import Single, Solid

Box = tuple[Vector, Vector]

MOST_STEPPED = 32
"""Leaves up to which they are stepped through: beyond, the code takes seconds to compile."""
MOST_UNROLLED = 8
"""Leaves up to which each has code of its own: faster, but it grows with the square of their number."""


@dataclass(frozen=True, slots=True)
class Surface:
    """An object: its shape, or those that a csg is made of, and what is known of its mesh."""

    name: str
    material: str
    solid: Solid
    shapes: tuple[tuple[ShapeKind, Shape], ...]
    box: Box | None  # around it, with room for rounding; None where that is not finite
    triangles: tuple[int, ...] = ()
    deviation: float = 0.0
    move: Vector = (0.0, 0.0, 0.0)

    @property
    def moves(self) -> bool:
        """Whether it is elsewhere at other times."""
        return any(self.move)

    @property
    def swept(self) -> Box | None:
        """A box around it wherever it is: around both ends of its way, which is straight."""
        if self.box is None or not self.moves:
            return self.box
        (a, b, c), (d, e, f) = self.box
        x, y, z = self.move
        low = a + min(0.0, x), b + min(0.0, y), c + min(0.0, z)
        return _roomy(low, (d + max(0.0, x), e + max(0.0, y), f + max(0.0, z)))

    @property
    def ball(self) -> Row | None:
        """Centre and radius, if it is a ball."""
        return self.shapes[0][1].ball if isinstance(self.solid, Single) else None

    @property
    def surrounding_ball(self) -> Row | None:
        """Centre and radius of a ball around it; None where it has no bounds."""
        if self.box is None or self.ball is not None:
            return self.ball
        low, high = self.box
        x, y, z = ((a + b) / 2 for a, b in zip(low, high, strict=True))
        return x, y, z, math.dist(low, high) / 2

    @property
    def rows(self) -> list[Row]:
        """Of all shapes, one after the other."""
        return [row for _, shape in self.shapes for row in shape.rows]

    @property
    def pieces(self) -> tuple[int | None, ...]:
        """What the scene calls the primitive of each row: a plane's index, None if it has no name."""
        return self.shapes[0][1].pieces if isinstance(self.solid, Single) else (None,) * len(self.rows)

    @property
    def extent(self) -> float:
        """The largest coordinate of what is rounded to single precision for Mitsuba, but a mesh's."""
        return max(shape.extent for _, shape in self.shapes) if isinstance(self.solid, Single) else 0.0

    @property
    def faceted(self) -> bool:
        """Whether Mitsuba has a mesh for it, and the description tells each triangle's plane."""
        return isinstance(self.solid, Single) and self.shapes[0][1].meshed


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
    shapes = [_shape(name, leaf) for leaf in (entry["csg"]["leaves"] if "csg" in entry else [entry])]
    solid: Solid = Single(shapes[0][0])
    box = shapes[0][1].box
    if "csg" in entry:
        program, box = tuple(map(int, entry["csg"]["program"])), entry.get("box")
        solid = _csg(program, leaves_of(shapes))
    room = _roomy(*box) if box is not None else None
    triangles, deviation = tuple(entry.get("triangles", ())), entry.get("deviation", 0.0)
    dx, dy, dz = map(float, entry.get("move", (0, 0, 0)))
    return Surface(name, entry["material"], solid, tuple(shapes), room, triangles, deviation, (dx, dy, dz))


def _csg(program: tuple[int, ...], leaves: tuple[Leaf, ...]) -> Csg:
    if len(leaves) <= MOST_UNROLLED:
        return UnrolledCsg(program, leaves)
    return SteppedCsg(program, leaves) if len(leaves) <= MOST_STEPPED else SearchedCsg(program, leaves)


def _shape(name: str, entry: dict[str, Any]) -> tuple[ShapeKind, Shape]:
    key = next((key for key in SHAPE_KINDS if key in entry), None)
    if key is None:
        raise ValueError(f"whitted: 'geometry' gives {name} none of {', '.join((*SHAPE_KINDS, 'csg'))}")
    return SHAPE_KINDS[key], SHAPE_KINDS[key].read(entry)


def _roomy(low: Vector, high: Vector) -> tuple[Vector, Vector] | None:
    """A box a little larger than the surface, for the roundings here and in the kernel; None if no numbers hold it."""
    room = 1e-9 * max(map(abs, (*low, *high)))
    (a, b, c), (d, e, f) = low, high
    corners = (a - room, b - room, c - room), (d + room, e + room, f + room)
    return corners if all(map(math.isfinite, (*corners[0], *corners[1]))) else None
