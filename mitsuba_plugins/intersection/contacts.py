"""Lights and eyes that lie on surfaces.

The distance between such a point and such a surface is 0, but computed along a ray it is a rounding error of either
sign, another one for every ray. So it is settled once, before rays are traced, what lies on what, by the native tracer.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.csg import Csg
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.rays import INVERTED, UPRIGHT, Ray, Real
from mitsuba_plugins.intersection.shapes.kind import Row, ShapeKind, Vector
from mitsuba_plugins.intersection.solids import Single
from mitsuba_plugins.syntax import syntax

if TYPE_CHECKING:
    from collections.abc import Sequence

Numbers = NDArray[np.float64]

INNER_ROOM = 2.0**-16
"""Relative to its radius, how far away from a ball's surface lights are of which that is known without tests."""

LEAST_SLOPE = 2.0**-10
"""Of a ray to a light, relative to a plane that it crosses."""


@dataclass(frozen=True, slots=True)
class Contact:
    """A primitive that a point lies on: its object and shape, the outward unit normal there, and how it is bent, as
    the shapes' `Contact` has it.
    """

    object: int
    shape: int
    primitive: int
    normal: Vector
    curvature: float
    turn: tuple[Vector, Vector, Vector]


class Contacts:
    """Finds the contacts of points with surfaces."""

    def __init__(self, surfaces: "Sequence[Surface]") -> None:
        self._surfaces = surfaces
        self.any_csg = any(isinstance(surface.solid, Csg) for surface in surfaces)
        # By kind, in the order of objects: where each primitive is, and its numbers as given.
        self._primitives: dict[ShapeKind, tuple[list[_Place], list[Sequence[float]]]] = {}
        first = 0
        for index, surface in enumerate(surfaces):
            for which, (kind, shape) in enumerate(surface.shapes):
                places, numbers = self._primitives.setdefault(kind, ([], []))
                places.extend(_Place(index, which, first + k * kind.ROWS) for k in range(len(shape.given)))
                numbers.extend(shape.given)
                first += len(shape.rows)

    def of(self, point: Numbers) -> list[Contact]:
        """The contacts of a point (3,) with primitives, wherever these are on their bodies, in their order.

        Of those that move only at all times: with primitives that slide in themselves.
        """
        found = [
            Contact(place.object, place.shape, place.primitive, at.normal, at.curvature, at.turn)
            for kind, (places, numbers) in self._primitives.items()
            for at in kind.contacts(point, np.array(numbers, dtype=np.float64))
            for place in (places[at.row],)
            if self._keeps(place.object, kind, numbers[at.row])
        ]
        return sorted(found, key=lambda contact: contact.primitive)

    def distances_outside(self, points: Numbers, sizes: Numbers, entered: "Sequence[int]", error: float) -> Numbers:
        """How far each of some points (n, 3), or balls of these sizes (n,), surely lies beyond a plane of each object
        (n, m): 0 where it may lie beyond none. Numbers may be off by `error`, relatively.

        Of polyhedra that stand still, have several planes, for to test one is as fast as to ask, and are among those
        that are `entered`: only within them does anybody ask.
        """
        result = np.zeros((len(points), len(self._surfaces)))
        for index in entered:
            surface = self._surfaces[index]
            is_polyhedron = isinstance(surface.solid, Single) and surface.solid.kind.FACETED
            if is_polyhedron and len(surface.rows) > 1 and not surface.moves:
                rows = np.array(surface.rows)
                reach = np.abs(points).max(axis=1)[:, None] + np.abs(rows[:, 3])
                heights = points @ rows[:, :3].T + rows[:, 3] - error * reach
                result[:, index] = np.maximum(heights.max(axis=1) - sizes, 0)
        return result

    def _keeps(self, index: int, kind: ShapeKind, numbers: "Sequence[float]") -> bool:
        """Whether what lies on an object's primitive, as given, does so at all times."""
        surface = self._surfaces[index]
        return not surface.moves or kind.slides(np.array(surface.move), numbers)

    def on_body(self, point: Numbers, contact: Contact) -> bool:
        """Whether the point is on the contact's shape, and not in a face's plane beside the face.

        Nor is it said of a body that moves: it may be there at some times only.
        """
        return not self._surfaces[contact.object].moves and self.sides(point, contact.object)[contact.shape]

    def sides(self, point: Numbers, index: int) -> list[bool]:
        """In which shapes of an object a point is, or on them."""
        shapes = self._surfaces[index].shapes
        return [kind.contains(point, np.array(shape.given, dtype=np.float64)) for kind, shape in shapes]

    def value(self, index: int, sides: list[Any]) -> Any:
        """Whether what is in these shapes of an object is in that."""
        solid = self._surfaces[index].solid
        return solid.value(sides) if isinstance(solid, Csg) else sides[0]


class _Place(NamedTuple):
    """Of a primitive."""

    object: int
    shape: int
    primitive: int


class LightContacts:
    """The contacts of lights, for kernels, in which nothing of this appears where no light lies on anything."""

    def __init__(
        self, types: Real, contacts: Contacts, positions: Numbers, radii: Numbers, entered: "Sequence[int]" = ()
    ) -> None:
        """Take the lights' positions (n, 3) and radii (n,), and the objects that rays enter; lights that are no points
        lie on nothing.
        """
        self._types = types
        by_light = [contacts.of(at) if radius == 0 else [] for at, radius in zip(positions, radii, strict=True)]
        found = [contact for of_one in by_light for contact in of_one]
        self.objects = {contact.object for contact in found}
        """The objects that some light lies on."""
        self._any_csg = contacts.any_csg
        self._lights = [(tuple(at), radius) for at, radius in zip(positions.tolist(), radii.tolist(), strict=True)]
        self._end = column(mi.UInt32, np.cumsum([len(of_one) for of_one in by_light], dtype=np.uint32))
        self._primitive = column(mi.UInt32, [contact.primitive for contact in found])
        self._rows = column(types.Float, [x for c in found for x in (*c.normal, c.curvature)] or [0.0] * 4)
        outside = contacts.distances_outside(positions, radii, entered, 64 * dr.epsilon(types.Float))
        self._any_outside = bool((outside > 0).any())
        if self._any_outside:
            self._outside = column(types.Float, outside)
            self._object_count = mi.UInt32(outside.shape[1])
            dr.make_opaque(self._object_count)

    def all_within(self, ball: Row) -> bool:
        """Whether all lights lie inside of a ball, away from its surface."""
        *center, radius = ball
        inner = radius * (1 - INNER_ROOM)
        return all(math.dist(center, at) + size < inner for at, size in self._lights)

    def all_beside(self, plane: Row, inside: bool) -> bool:
        """Whether all lights lie on one side of a plane, its normal of length 1, away from it: where the half-space is
        or beyond.
        """
        *normal, offset = plane
        heights = [
            (sum(a * x for a, x in zip(normal, at, strict=True)) + offset, at, size) for at, size in self._lights
        ]
        return all(
            (-height if inside else height) - size > INNER_ROOM * (max(map(abs, at)) + abs(offset))
            for height, at, size in heights
        )

    def lies_outside(self, light: Any, index: Any, distance: Any, active: Any) -> Any:
        """Whether a light at a `distance` lies outside of an object, a polyhedron, so far that all rays to it from
        within surely cross the object's surface on their way.

        Only where no rounding can matter: some plane is crossed far from the light, and steeply.
        """
        if not self._any_outside:
            return mi.Bool(False)
        height = dr.gather(self._types.Float, self._outside, light * self._object_count + index, active)
        return active & (height > LEAST_SLOPE * distance)

    @syntax
    def lies_at(self, light: Any, crossing: Crossing, d: Any, active: Any) -> Any:
        """Whether rays of direction `d` that lead to a light cross there what the light lies on.

        A plane they do cross there, and nowhere else; of the two crossings of another primitive it is the one where
        they enter if they enter at the light.
        """
        result = mi.Bool(False)
        if dr.hint(bool(self.objects), mode="scalar"):
            result = dr.full(mi.Bool, False, dr.width(crossing.primitive, d, active))
            i, end = self._range(light, active)
            primitive, enters = crossing.primitive, crossing.enters
            if dr.hint(self._any_csg, mode="scalar"):
                enters ^= primitive >= INVERTED
                primitive &= UPRIGHT
            while dr.hint(active & (i < end), exclude=[self, d, active, primitive, enters, end]):
                row = dr.gather(self._types.Vector4, self._rows, i, active)
                there = (row.w == 0) | (enters == (dr.dot(self._types.Vector3(row.xyz), d) < 0))
                result |= there & (primitive == dr.gather(mi.UInt32, self._primitive, i, active))
                i += 1
        return result

    @syntax
    def grazes(self, light: Any, primitive: Any, active: Any) -> Any:
        """Whether a primitive is a plane that a light lies in, and so shines along."""
        result = mi.Bool(False)
        if dr.hint(bool(self.objects), mode="scalar"):
            result = dr.full(mi.Bool, False, dr.width(primitive, active))
            primitive = primitive & UPRIGHT if self._any_csg else primitive
            i, end = self._range(light, active)
            while dr.hint(active & (i < end), exclude=[self, primitive, active, end]):
                curvature = dr.gather(self._types.Float, self._rows, 4 * i + 3, active)
                result |= (curvature == 0) & (primitive == dr.gather(mi.UInt32, self._primitive, i, active))
                i += 1
        return result

    def _range(self, light: Any, active: Any) -> tuple[Any, Any]:
        """The first contact of a light, and the one after its last."""
        before = dr.gather(mi.UInt32, self._end, light - 1, active & (light > 0))
        return before, dr.gather(mi.UInt32, self._end, light, active)


class EyeContact:
    """What rays from the eye start on, as rays that leave a surface do. Of several objects it is the first."""

    def __init__(self, types: Real, contacts: Contacts, eye: Numbers) -> None:
        found = [contact for contact in contacts.of(eye) if contacts.on_body(eye, contact)]
        self._all = contacts
        self._contacts = [contact for contact in found if contact.object == found[0].object]
        self._sides = contacts.sides(eye, found[0].object) if found else []
        self._bends = [
            (
                types.Vector3(*contact.normal),
                types.Float(contact.curvature),
                [types.Vector3(*row) for row in contact.turn],
            )
            for contact in self._contacts
        ]
        dr.make_opaque(self._bends)

    @property
    def exists(self) -> bool:
        """Whether the eye is on anything."""
        return bool(self._contacts)

    def start(self, ray: Ray) -> Ray:
        """A ray from the eye, with what it starts on: of several leaves of a csg, which touch there, it is the first
        that is curved, for with planes distances can be compared.
        """
        if not self._contacts:
            return ray
        sides: list[Any] = [mi.Bool(side) for side in self._sides]
        for contact, bend in zip(self._contacts, self._bends, strict=True):
            sides[contact.shape] &= _leads_inside(ray, *bend)
        first = min(self._contacts, key=lambda contact: contact.curvature == 0)
        inside = self._all.value(first.object, sides)
        width = dr.width(ray.d)
        index, primitive = (dr.opaque(mi.UInt32, number, width) for number in (first.object, first.primitive))
        primitive ^= dr.select(sides[first.shape] != inside, mi.UInt32(INVERTED), 0)
        return Ray(ray.o, ray.d, index, primitive, inside, ray.t_min, ray.spread)


def _leads_inside(ray: Ray, normal: Any, curvature: Any, turn: Any) -> Any:
    """Whether a ray from a surface leads inside of it.

    So do those along a plane, or along a straight line in a quadric, for a body is closed, and those that touch from
    within what is hollow; not those that touch a sphere. Eye and directions may be off.
    """
    bound = ray.spread + ray.t_min * curvature
    bend = sum(d * dr.dot(row, ray.d) for d, row in zip(ray.d, turn, strict=True))
    return dr.dot(normal, ray.d) < dr.select(bend > 4 * curvature * ray.spread, -bound, bound)
