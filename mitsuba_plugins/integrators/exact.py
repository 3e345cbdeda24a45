"""The exact surfaces in a kernel: where a ray crosses a sphere or a convex polyhedron, and the surface there."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.columns import column
from mitsuba_plugins.integrators.contacts import LightContacts
from mitsuba_plugins.integrators.geometry import Surface
from mitsuba_plugins.integrators.rays import NOTHING, Hit, Ray, Real, largest, origin_error, shadow_spread, spawn
from mitsuba_plugins.integrators.rounding import most_blur, surface_error


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
        self._first = column(mi.UInt32, self.first)
        self._count = column(mi.UInt32, [len(surface.rows) for surface in surfaces])
        self.surface_count = mi.UInt32(len(surfaces))
        dr.make_opaque(self.surface_count)

    def row(self, record: Any, active: Any) -> Any:
        """The four numbers of a record (Vector4)."""
        return dr.gather(self._types.Vector4, self._rows, record, active)

    def range(self, index: Any, active: Any) -> tuple[Any, Any]:
        """The first record of object `index`, and the one after its last."""
        first = dr.gather(mi.UInt32, self._first, index, active)
        return first, first + dr.gather(mi.UInt32, self._count, index, active)

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
        t, index, record, close = self.find_closest(ray, active)
        if close is not None:
            t, index, record = self._settled(ray, t, index, record, active & close)
        valid = active & (index != NOTHING)
        surface = self.records.surface(index, record, valid)
        sphere, center, radius = surface
        within = (index == ray.object) | (dr.squared_norm(ray.o - center) < dr.square(radius))
        p, n = self.records.surface_point(surface, ray.o + t * ray.d, dr.select(within, ray.d, -ray.d))
        inside = dr.select(index == ray.object, ray.inside, dr.dot(n, ray.d) > 0)
        lean = dr.select(sphere, quotient(origin_error(p, t), radius), 0)
        return Hit(valid, t, index, record, p, n, inside, lean)

    def spawn(self, hit: Hit, d: Any, inside: Any, spread: Any) -> Ray:
        """The ray that leaves `hit` in direction `d`, on the given side of the object."""
        return spawn(hit, d, inside, spread)

    def blocker(self, hit: Hit, d: Any, distance: Any, light: Any, active: Any) -> Any:
        """Some object between `hit` and a light at `distance` in direction `d`, on the side it was seen from."""
        ray = spawn(hit, d, hit.inside, shadow_spread(hit, distance))
        found, close = self.find_blocker(ray, distance, light, active)
        return found if close is None else self._settled_blocker(ray, distance, light, found, active & close)

    def error(self, ray: Ray, hit: Hit) -> Any:
        """How far a ray and the surface that it has met may be off from one another."""
        surface = self.records.surface(hit.object, hit.record, hit.valid)
        return _off(ray, *surface, largest(ray.o)) + hit.t * ray.spread

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """Distance (infinite for none), object (NOTHING for none) and record of the first hit, and whether it was close
        to a tie.
        """
        raise NotImplementedError

    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """Some object that the ray meets before it comes to a light at `distance`, or NOTHING, and whether that was
        close to a tie.
        """
        raise NotImplementedError

    # ---- Ties: the same searches by the format's rules, for the rays that are close to some ----

    @dr.syntax
    def _settled(self, ray: Ray, t: Any, index: Any, record: Any, close: Any) -> tuple[Any, Any, Any]:
        if close:
            width = dr.width(close)
            blur = most_blur(t)
            reach = largest(ray.o)
            # The first object of those that tie with the nearest: also where one ties with two that do not tie with one
            # another, the order in which they are visited does not matter.
            nearest = dr.full(type(t), dr.inf, width)
            error = dr.zeros(type(t), width)
            tested = dr.zeros(mi.UInt32, width)
            while close & (tested < self.records.surface_count):
                met, met_error, _ = self._meet(ray, tested, close)
                met_error = dr.minimum(met_error, blur * (met + reach))
                error = dr.select((met < nearest) | ((met == nearest) & (met_error > error)), met_error, error)
                nearest = dr.minimum(met, nearest)
                tested += 1
            t = dr.full(type(t), dr.inf, width)
            index = dr.full(mi.UInt32, NOTHING, width)
            record = dr.zeros(mi.UInt32, width)
            tested = dr.zeros(mi.UInt32, width)
            while close & (tested < self.records.surface_count) & (index == NOTHING):
                met, met_error, met_record = self._meet(ray, tested, close)
                met_error = dr.minimum(met_error, blur * (met + reach))
                ties = (met < dr.inf) & (met - nearest <= error + met_error)
                t = dr.select(ties, met, t)
                index = dr.select(ties, tested, index)
                record = dr.select(ties, met_record, record)
                tested += 1
        return t, index, record

    @dr.syntax
    def _settled_blocker(self, ray: Ray, distance: Any, light: Any, found: Any, close: Any) -> Any:
        if close:
            found = dr.full(mi.UInt32, NOTHING, dr.width(close))
            tested = dr.zeros(mi.UInt32, dr.width(close))
            while close & (tested < self.records.surface_count) & (found == NOTHING):
                met, _, record = self._meet(ray, tested, close)
                blocks = (met < distance) & ~self.contacts.lies_at(light, record, ray.d, met, distance, close)
                found = dr.select(blocks, tested, found)
                tested += 1
        return found

    @dr.syntax
    def _meet(self, ray: Ray, index: Any, active: Any) -> tuple[Any, Any, Any]:
        """Where a ray meets object `index`, by the rules: distance (infinite for none), its error, record.

        A ray along a plane neither enters nor leaves there, and is inside or outside by its height; one that meets an
        edge hits; one that touches a sphere passes by; where planes tie, the first counts.
        """
        width = dr.width(ray.d, index)
        reach = largest(ray.o)
        own = ray.object == index
        first, end = self.records.range(index, active)
        sphere, v, w = self.records.surface(index, first, active)

        error = _off(ray, sphere, v, w, reach)
        t_sphere, _ = sphere_distance(v, w, ray, own, error)
        # A ray that starts on a sphere by the roundings of its origin, and not by knowledge, does not meet it there.
        starts = ~own & (dr.abs(dr.norm(ray.o - v) - w) <= error) & (error <= most_blur(w) * w)
        through = -2 * dr.dot(ray.o - v, ray.d)
        t_through = dr.select((t_sphere < dr.inf) & (through > ray.t_min), through, dr.inf)
        t_sphere = dr.select(starts, t_through, t_sphere)
        arm = ray.o + t_sphere * ray.d - v
        t_sphere_error = quotient((error + t_sphere * ray.spread) * w, dr.abs(dr.dot(arm, ray.d)))

        enter, leave = dr.full(type(w), -dr.inf, width), dr.full(type(w), dr.inf, width)
        enter_error, leave_error = dr.zeros(type(w), width), dr.zeros(type(w), width)
        enter_record, leave_record = dr.zeros(mi.UInt32, width), dr.zeros(mi.UInt32, width)
        outside = dr.full(mi.Bool, False, width)
        record = mi.UInt32(first) + dr.zeros(mi.UInt32, width)
        while active & ~sphere & (record < end):
            row = self.records.row(record, active)
            n = type(ray.d)(row.xyz)
            error = _off(ray, mi.Bool(False), n, row.w, reach)
            slope = dr.dot(n, ray.d)
            height = dr.dot(n, ray.o) + row.w
            t = dr.select(dr.abs(height) <= error, 0, -quotient(height, slope))
            t_error = quotient(error + dr.abs(t) * ray.spread, dr.abs(slope))
            left = own & (ray.record == record)
            enters = (slope < -ray.spread) & (t - enter > t_error + enter_error) & ~left
            leaves = (slope > ray.spread) & (leave - t > t_error + leave_error) & ~left
            outside |= (dr.abs(slope) <= ray.spread) & (height > error)
            enter = dr.select(enters, t, enter)
            leave = dr.select(leaves, t, leave)
            enter_error = dr.select(enters, t_error, enter_error)
            leave_error = dr.select(leaves, t_error, leave_error)
            enter_record = dr.select(enters, record, enter_record)
            leave_record = dr.select(leaves, record, leave_record)
            record += 1
        apart = outside | (enter - leave > enter_error + leave_error)
        passage = Passage(enter, leave, enter_record, leave_record)
        t, record, front = passage_distance(passage, ray, own, apart)
        t_error = dr.select(front, enter_error, leave_error)
        t = dr.select(sphere, t_sphere, t)
        hit = t < dr.inf
        return (
            dr.select(hit, t, dr.inf),
            dr.select(hit, dr.select(sphere, t_sphere_error, t_error), 0),
            dr.select(sphere, first, record),
        )


def _off(ray: Ray, sphere: Any, v: Any, w: Any, reach: Any) -> Any:
    """How far a ray's origin and a surface may be off from one another, where ties are decided."""
    return ray.t_min + surface_error(sphere, v, w, reach)


# ---- Sphere ----------------------------------------------------------------------------------------------------------


def sphere_distance(center: Any, radius: Any, ray: Ray, own: Any, error: Any = None) -> tuple[Any, Any]:
    """Distance to a sphere, infinite or NaN for none (compare with <), and whether the ray may only touch it.

    `own` where the ray starts on it. Given the `error` of both, rays that only touch it pass by.

    Haines, Gunther and Akenine-Moller, Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems ch. 7.
    """
    f = ray.o - center
    b = -dr.dot(f, ray.d)
    discriminant = radius * radius - dr.squared_norm(f + b * ray.d)
    close = dr.abs(discriminant) <= most_blur(radius) * dr.square(radius)
    if error is not None:
        touching = radius * dr.minimum(2 * (error + dr.abs(b) * ray.spread), most_blur(radius) * radius)
        discriminant = dr.select(discriminant > touching, discriminant, dr.nan)
    root = dr.sqrt(discriminant)  # NaN where the ray misses: no comparison with it holds
    q = b + dr.copysign(root, b)
    other = quotient(dr.squared_norm(f) - radius * radius, q)
    near, far = dr.minimum(q, other), dr.maximum(q, other)
    t_other = dr.select(near > ray.t_min, near, dr.select(far > ray.t_min, far, dr.inf))
    # A ray that starts on this sphere leaves it for good, or crosses it to the far root.
    t_own = dr.select(ray.inside & (far > 0), far, dr.inf)
    return dr.select(own, t_own, t_other), close & ~own


# ---- Convex polyhedron -----------------------------------------------------------------------------------------------


@dataclass
class Passage:
    """The part of a ray that lies inside the half-spaces seen so far."""

    enter: Any  # Float, as is `leave`
    leave: Any
    enter_record: Any  # UInt32, as is `leave_record`
    leave_record: Any
    along: Any = False  # Bool, whether the ray runs along a plane
    between: Any = dr.inf  # Float, from where it crosses one plane to where it crosses the next


def whole_ray(types: Real, width: int) -> Passage:
    """The passage before any half-space."""
    return Passage(
        enter=dr.full(types.Float, -dr.inf, width),
        leave=dr.full(types.Float, dr.inf, width),
        enter_record=dr.zeros(mi.UInt32, width),
        leave_record=dr.zeros(mi.UInt32, width),
        along=dr.full(mi.Bool, False, width),
        between=dr.full(types.Float, dr.inf, width),
    )


def narrow(passage: Passage, ray: Ray, n: Any, offset: Any, record: Any) -> Passage:
    """The passage through one more half-space, n . p + offset <= 0, of rays that are far from ties.

    Haines, Fast Ray-Convex Polyhedron Intersection, Graphics Gems II, 1991.
    """
    cosine = dr.dot(n, ray.d)
    height = dr.dot(n, ray.o) + offset
    t = -quotient(height, cosine)
    other = ray.record != record
    entering, leaving = cosine < -ray.spread, cosine > ray.spread
    enters = entering & (t > passage.enter) & other
    leaves = leaving & (t < passage.leave) & other
    between = dr.abs(t - dr.select(entering, passage.enter, passage.leave))
    return Passage(
        enter=dr.select(enters, t, passage.enter),
        leave=dr.select(leaves, t, passage.leave),
        enter_record=dr.select(enters, record, passage.enter_record),
        leave_record=dr.select(leaves, record, passage.leave_record),
        along=passage.along | ~(entering | leaving),
        between=dr.select(between < passage.between, between, passage.between),
    )


def passage_distance(passage: Passage, ray: Ray, own: Any, misses: Any) -> tuple[Any, Any, Any]:
    """Distance to the polyhedron, infinite for none, the record of its plane, and whether the ray enters there.

    `own` where the ray starts on it, else it `misses` the polyhedron or not.
    """
    front = ~own & (passage.enter > ray.t_min)
    t = dr.select(front, passage.enter, passage.leave)
    t = dr.select(~misses & (t > ray.t_min), t, dr.inf)
    # A ray that starts on this body leaves it for good, or crosses it to the exit, at an edge at once.
    t_own = dr.select(ray.inside, dr.maximum(passage.leave, 0), dr.inf)
    return dr.select(own, t_own, t), dr.select(front, passage.enter_record, passage.leave_record), front


def passage_crossing(passage: Passage, ray: Ray, own: Any, reach: Any) -> tuple[Any, Any, Any]:
    """Distance to the polyhedron, infinite for none, the record of its plane, and whether that was close to a tie.

    `reach` is the origin's largest coordinate.
    """
    t, record, _ = passage_distance(passage, ray, own, passage.enter > passage.leave)
    gap = passage.enter - passage.leave
    at_edge = (gap > 0) & (gap <= most_blur(gap) * (reach + passage.enter))
    between_planes = (t < dr.inf) & (passage.between < most_blur(gap) * (reach + t))
    return t, record, (passage.along | at_edge | between_planes) & (~own | ray.inside)
