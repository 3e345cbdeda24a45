"""Lights and eyes that lie on surfaces.

The distance between such a point and such a surface is 0, but computed along a ray it is a rounding error of either
sign, another one for every ray. So it is settled once, before rays are traced, what lies on what, by the native tracer.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from mitsuba_plugins.integrators.columns import column
from mitsuba_plugins.integrators.geometry import Surface
from mitsuba_plugins.integrators.rays import Ray, Real
from native_tracer.incidence import surfaces_at, within

if TYPE_CHECKING:
    from collections.abc import Sequence

Numbers = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Contact:
    """A record that a point lies on: its object, the outward unit normal there, and the radius; 0 of a plane."""

    object: int
    record: int
    normal: tuple[float, float, float]
    radius: float


class Contacts:
    """Finds the contacts of points with surfaces."""

    def __init__(self, surfaces: "Sequence[Surface]") -> None:
        self._rows = np.array([row for s in surfaces for row in s.rows], dtype=np.float64).reshape(-1, 4)
        self._object = np.repeat(np.arange(len(surfaces)), [len(s.rows) for s in surfaces])
        self._round = np.array([s.sphere is not None for s in surfaces], dtype=np.bool_)[self._object]

    def of(self, point: Numbers) -> list[Contact]:
        """The contacts of a point (3,), in the order of the records."""
        found = []
        for record in surfaces_at(point, self._rows, self._round):
            row, is_round = self._rows[record], self._round[record]
            normal = point - row[:3] if is_round else row[:3]
            # The square of a length may neither overflow nor vanish.
            normal = normal / np.abs(normal).max()
            x, y, z = (normal / np.linalg.norm(normal)).tolist()
            found.append(Contact(int(self._object[record]), record, (x, y, z), float(row[3]) if is_round else 0.0))
        return found

    def is_on_body(self, point: Numbers, contact: Contact) -> bool:
        """Whether a point is on the body, and not in a face's plane beside the face."""
        return contact.radius > 0 or within(point, self._rows[self._object == contact.object])


class LightContacts:
    """The contacts of lights, for kernels, in which nothing of this appears where no light lies on anything."""

    def __init__(self, types: Real, contacts: Contacts, positions: Numbers) -> None:
        """Take the lights' positions (n, 3)."""
        self._types = types
        by_light = [contacts.of(position) for position in positions]
        found = [contact for of_one in by_light for contact in of_one]
        self.objects = {contact.object for contact in found}
        """The objects that some light lies on."""
        self._end = column(mi.UInt32, np.cumsum([len(of_one) for of_one in by_light], dtype=np.uint32))
        self._record = column(mi.UInt32, [contact.record for contact in found])
        self._rows = column(types.Float, [number for c in found for number in (*c.normal, c.radius)] or [0.0] * 4)

    @dr.syntax
    def lies_at(self, light: Any, record: Any, d: Any, t: Any, distance: Any, active: Any) -> Any:
        """Whether a ray that leads to a light at `distance` and meets a record at `t` meets it where the light is.

        A plane that the light lies on is met there and nowhere else; a sphere is, if not there, then nearer by
        2 r |n . d|, with n its normal at the light.
        """
        result = mi.Bool(False)
        if dr.hint(bool(self.objects), mode="scalar"):
            result = dr.full(mi.Bool, False, dr.width(record, t, active))
            i, end = self._range(light, active)
            while active & (i < end):
                row = dr.gather(self._types.Vector4, self._rows, i, active)
                slack = row.w * dr.abs(dr.dot(self._types.Vector3(row.xyz), d))
                there = (row.w == 0) | (t > distance - slack)
                result |= there & (record == dr.gather(mi.UInt32, self._record, i, active))
                i += 1
        return result

    @dr.syntax
    def grazes(self, light: Any, record: Any, active: Any) -> Any:
        """Whether a record is a plane that a light lies in, and so shines along."""
        result = mi.Bool(False)
        if dr.hint(bool(self.objects), mode="scalar"):
            result = dr.full(mi.Bool, False, dr.width(record, active))
            i, end = self._range(light, active)
            while active & (i < end):
                radius = dr.gather(self._types.Float, self._rows, 4 * i + 3, active)
                result |= (radius == 0) & (record == dr.gather(mi.UInt32, self._record, i, active))
                i += 1
        return result

    def _range(self, light: Any, active: Any) -> tuple[Any, Any]:
        """The first contact of a light, and the one after its last."""
        before = dr.gather(mi.UInt32, self._end, light - 1, active & (light > 0))
        return before, dr.gather(mi.UInt32, self._end, light, active)


class EyeContact:
    """What rays from the eye start on, as rays that leave a surface do. Of several objects it is the first."""

    def __init__(self, types: Real, contacts: Contacts, eye: Numbers) -> None:
        found = [contact for contact in contacts.of(eye) if contacts.is_on_body(eye, contact)]
        self._contacts = [contact for contact in found if contact.object == found[0].object]
        self._normals = [types.Vector3(*contact.normal) for contact in self._contacts]
        self._curvature = types.Float(sum(1 / contact.radius for contact in self._contacts if contact.radius > 0))
        dr.make_opaque(self._normals, self._curvature)

    def start(self, ray: Ray) -> Ray:
        """A ray from the eye, with what it starts on."""
        if not self._contacts:
            return ray
        contact = self._contacts[0]
        leads_inside = mi.Bool(True)
        # Rays along a plane, too, for a body is closed; not those that touch a sphere. Eye and directions may be off.
        bound = ray.spread if contact.radius == 0 else -(ray.spread + ray.t_min * self._curvature)
        for normal in self._normals:
            leads_inside &= dr.dot(normal, ray.d) < bound
        width = dr.width(ray.d)
        index, record = (dr.opaque(mi.UInt32, number, width) for number in (contact.object, contact.record))
        return Ray(ray.o, ray.d, index, record, leads_inside, ray.t_min, ray.spread)
