"""The exact surfaces in a kernel: where a ray crosses a sphere or a convex polyhedron, and the surface there."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.columns import column
from mitsuba_plugins.integrators.contacts import LightContacts
from mitsuba_plugins.integrators.geometry import Surface
from mitsuba_plugins.integrators.rays import NOTHING, Hit, Ray, Real, spawn


class Records:
    """One record a sphere, one a polyhedron's plane: (center, radius), or (unit normal, offset)."""

    def __init__(self, types: Real, surfaces: list[Surface]) -> None:
        rows: list[Any] = []
        self.first = []
        for surface in surfaces:
            self.first.append(len(rows))
            rows.extend(surface.unit_rows)
        self._types = types
        self._rows = column(types.Float, rows or [(0.0,) * 4])
        self._is_sphere = column(mi.Bool, [surface.sphere is not None for surface in surfaces])

    def row(self, record: Any, active: Any) -> Any:
        """The four numbers of a record (Vector4)."""
        return dr.gather(self._types.Vector4, self._rows, record, active)

    def surface(self, index: Any, record: Any, active: Any) -> tuple[Any, Any, Any]:
        """Whether object `index` is a sphere, and the numbers of its record as Vector3 and Float."""
        row = self.row(record, active)
        return dr.gather(mi.Bool, self._is_sphere, index, active), self._types.Vector3(row.xyz), row.w

    def surface_point(self, surface: tuple[Any, Any, Any], p: Any, along: Any) -> tuple[Any, Any]:
        """The point of what `surface` returned nearest to `p`, along its normal, and the outward unit normal there.

        That is `along` where `p` is a sphere's centre, or so near that the square of its distance is 0: of a sphere
        that is too small beside its distance from where the ray starts, no more is known of a point on it.
        """
        sphere, v, w = surface
        arm = self._types.Vector3(p) - v
        length = dr.norm(arm)
        n = dr.select(sphere, dr.select(length == 0, along, arm * quotient(1, length)), v)
        on_sphere = self._types.Point3(v) + n * w
        on_plane = p - n * (dr.dot(n, p) + w)
        return self._types.Point3(dr.select(sphere, on_sphere, on_plane)), self._types.Vector3(n)


class ExactSurfaces:
    """What a ray meets, the point and the normal from the exact surfaces; subclasses know how to search them.

    Masks of active rays come from `lanes`.
    """

    def __init__(self, records: Records, contacts: LightContacts) -> None:
        self.records = records
        self.contacts = contacts

    def closest(self, ray: Ray, active: Any) -> Hit:
        """The first surface that a ray meets, the point moved onto it to shed the error along the normal."""
        t, index, record = self.find_closest(ray, active)
        valid = active & (index != NOTHING)
        surface = self.records.surface(index, record, valid)
        _, center, radius = surface
        within = (index == ray.object) | (dr.squared_norm(ray.o - center) < dr.square(radius))
        p, n = self.records.surface_point(surface, ray.o + t * ray.d, dr.select(within, ray.d, -ray.d))
        inside = dr.select(index == ray.object, ray.inside, dr.dot(n, ray.d) > 0)
        return Hit(valid, t, index, record, p, n, inside)

    def spawn(self, hit: Hit, d: Any, inside: Any) -> Ray:
        """The ray that leaves `hit` in direction `d`, on the given side of the object."""
        return spawn(hit, d, inside)

    def blocker(self, hit: Hit, d: Any, distance: Any, light: Any, active: Any) -> Any:
        """Some object between `hit` and a light at `distance` in direction `d`, on the side it was seen from."""
        return self.find_blocker(spawn(hit, d, hit.inside), distance, light, active)

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any]:
        """Distance (infinite for none), object (NOTHING for none) and record of the first hit."""
        raise NotImplementedError

    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> Any:
        """Some object that the ray meets before it comes to a light at `distance`, or NOTHING."""
        raise NotImplementedError


# ---- Sphere ----------------------------------------------------------------------------------------------------------


def sphere_distance(center: Any, radius: Any, ray: Ray, own: Any) -> Any:
    """Distance to a sphere, infinite or NaN for none (compare with <); `own` where the ray starts on it.

    Haines, Gunther and Akenine-Moller, Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems ch. 7.
    """
    f = ray.o - center
    b = -dr.dot(f, ray.d)
    discriminant = radius * radius - dr.squared_norm(f + b * ray.d)
    root = dr.sqrt(discriminant)  # NaN where the ray misses: no comparison with it holds
    q = b + dr.copysign(root, b)
    other = quotient(dr.squared_norm(f) - radius * radius, q)
    near, far = dr.minimum(q, other), dr.maximum(q, other)
    t_other = dr.select(near > ray.t_min, near, dr.select(far > ray.t_min, far, dr.inf))
    # A ray that starts on this sphere leaves it for good, or crosses it to the far root.
    t_own = dr.select(ray.inside & (far > 0), far, dr.inf)
    return dr.select(own, t_own, t_other)


# ---- Convex polyhedron -----------------------------------------------------------------------------------------------


@dataclass
class Passage:
    """The part of a ray that lies inside the half-spaces seen so far."""

    enter: Any  # Float, as is `leave`
    leave: Any
    enter_record: Any  # UInt32, as is `leave_record`
    leave_record: Any
    outside: Any  # Bool, whether the ray runs along a plane, outside of it


def whole_ray(types: Real, width: int) -> Passage:
    """The passage before any half-space."""
    return Passage(
        enter=dr.full(types.Float, -dr.inf, width),
        leave=dr.full(types.Float, dr.inf, width),
        enter_record=dr.zeros(mi.UInt32, width),
        leave_record=dr.zeros(mi.UInt32, width),
        outside=dr.full(mi.Bool, False, width),
    )


def narrow(passage: Passage, ray: Ray, n: Any, offset: Any, record: Any) -> Passage:
    """The passage through one more half-space, n . p + offset <= 0; where planes tie, the first counts.

    Haines, Fast Ray-Convex Polyhedron Intersection, Graphics Gems II, 1991.
    """
    cosine = dr.dot(n, ray.d)
    height = dr.dot(n, ray.o) + offset
    t = -quotient(height, cosine)
    other = ray.record != record
    enters = (cosine < 0) & (t > passage.enter) & other
    leaves = (cosine > 0) & (t < passage.leave) & other
    return Passage(
        enter=dr.select(enters, t, passage.enter),
        leave=dr.select(leaves, t, passage.leave),
        enter_record=dr.select(enters, record, passage.enter_record),
        leave_record=dr.select(leaves, record, passage.leave_record),
        outside=passage.outside | ((cosine == 0) & (height > 0)),
    )


def passage_distance(passage: Passage, ray: Ray, own: Any) -> tuple[Any, Any]:
    """Distance to the polyhedron, infinite for none, and the record of its plane; `own` where the ray starts on it."""
    front = passage.enter > ray.t_min
    t = dr.select(front, passage.enter, passage.leave)
    t = dr.select(~passage.outside & (passage.enter <= passage.leave) & (t > ray.t_min), t, dr.inf)
    # A ray that starts on this body leaves it for good, or crosses it to the exit, at an edge at once.
    t_own = dr.select(ray.inside, dr.maximum(passage.leave, 0), dr.inf)
    return dr.select(own, t_own, t), dr.select(own | ~front, passage.leave_record, passage.enter_record)
