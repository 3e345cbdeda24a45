"""Intersection of rays with a few spheres and convex polyhedra inside the kernel.

Every surface becomes its own piece of code, so that there is neither a traversal nor a call: fastest for the dozens of
surfaces of a typical course scene, and its kernel grows with their number.
"""

import math
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.contacts import LightContacts
from mitsuba_plugins.integrators.exact import (
    ExactSurfaces,
    Records,
    narrow,
    passage_crossing,
    sphere_distance,
    whole_ray,
)
from mitsuba_plugins.integrators.geometry import Surface
from mitsuba_plugins.integrators.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.integrators.rounding import most_blur


class AnalyticSurfaces(ExactSurfaces):
    """Surfaces whose numbers are kernel arguments: scenes that differ in numbers only share one compiled kernel."""

    def __init__(self, types: Real, surfaces: list[Surface], records: Records, contacts: LightContacts) -> None:
        super().__init__(records, contacts)
        self._types = types
        self._spheres = [self._ball(surface.sphere) for surface in surfaces]
        self._bounds = [self._ball(_bound(surface)) for surface in surfaces]
        self._planes = [
            [(types.Vector3(*plane[:3]), types.Float(plane[3])) for plane in surface.unit_rows if surface.planes]
            for surface in surfaces
        ]
        dr.make_opaque(self._spheres, self._planes, self._bounds)

    def _ball(self, numbers: tuple[float, float, float, float] | None) -> tuple[Any, Any] | None:
        if numbers is None:
            return None
        x, y, z, r = numbers
        return self._types.Point3(x, y, z), self._types.Float(r)

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """Distance (infinite for none), object (NOTHING for none) and record of the first hit, and whether it was close
        to a tie.
        """
        reach = largest(ray.o)
        t_best, t_second = self._types.Float(dr.inf), self._types.Float(dr.inf)
        close = mi.Bool(False)
        object_best = mi.UInt32(NOTHING)
        record_best = mi.UInt32(0)
        for index in range(len(self._spheres)):
            t, record, ties = self._intersect(index, ray, reach)
            close |= ties
            closer = t < t_best
            t_second = dr.select(closer, t_best, dr.select((t > t_best) & (t < t_second), t, t_second))
            t_best = dr.select(closer, t, t_best)
            object_best = dr.select(closer, index, object_best)
            record_best = dr.select(closer, record, record_best)
        near = most_blur(t_best) * (t_best + reach)
        close |= (t_second - t_best <= near) | (t_best < near)
        return t_best, object_best, record_best, close

    @dr.syntax
    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """Some object that the ray meets before it comes to a light at `distance`, or NOTHING, and whether that was
        close to a tie.
        """
        found = dr.full(mi.UInt32, NOTHING, dr.width(ray.d))
        close = dr.full(mi.Bool, False, dr.width(ray.d))
        if active:
            reach = largest(ray.o)
            for index in range(len(self._spheres)):
                t, record, ties = self._intersect(index, ray, reach)
                close |= ties | (t < most_blur(t) * reach)
                blocks = t < distance
                if dr.hint(index in self.contacts.objects, mode="scalar"):
                    blocks &= ~self.contacts.lies_at(light, record, ray.d, t, distance, active)
                found = dr.select(blocks, mi.UInt32(index), found)
        return found, close

    def _intersect(self, index: int, ray: Ray, reach: Any) -> tuple[Any, Any, Any]:
        """Distance to one surface (infinite or NaN for none: compare with <), the record that is met, and whether that
        was close to a tie.
        """
        own = ray.object == index
        sphere = self._spheres[index]
        if sphere is not None:
            t, close = sphere_distance(*sphere, ray, own)
            return t, mi.UInt32(self.records.first[index]), close
        bound = self._bounds[index]
        if bound is not None:
            return self._intersect_bounded(index, bound, ray, own, reach)
        return self._intersect_planes(index, ray, own, reach)

    @dr.syntax
    def _intersect_bounded(
        self, index: int, bound: tuple[Any, Any], ray: Ray, own: Any, reach: Any
    ) -> tuple[Any, Any, Any]:
        """A branch and no mask: most packets of rays pass by most polyhedra and save their planes."""
        t = dr.full(self._types.Float, dr.inf, dr.width(ray.d))
        record = dr.zeros(mi.UInt32, dr.width(ray.d))
        close = dr.full(mi.Bool, False, dr.width(ray.d))
        center, radius = bound
        f = ray.o - center
        b = -dr.dot(f, ray.d)
        if (dr.squared_norm(f + b * ray.d) <= radius * radius) & (b > -radius):
            t, record, close = self._intersect_planes(index, ray, own, reach)
        return t, record, close

    def _intersect_planes(self, index: int, ray: Ray, own: Any, reach: Any) -> tuple[Any, Any, Any]:
        passage = whole_ray(self._types, 1)
        for record, (n, offset) in enumerate(self._planes[index], self.records.first[index]):
            passage = narrow(passage, ray, n, offset, mi.UInt32(record))
        return passage_crossing(passage, ray, own, reach)


def _bound(surface: Surface) -> tuple[float, float, float, float] | None:
    """A sphere around a bounded polyhedron."""
    if surface.box is None or surface.sphere is not None:
        return None
    low, high = surface.box
    x, y, z = ((a + b) / 2 for a, b in zip(low, high, strict=True))
    return x, y, z, math.dist(low, high) / 2
