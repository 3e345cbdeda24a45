"""Intersection of rays with a few spheres and convex polyhedra inside the kernel, in double precision.

Every surface becomes its own piece of code, so that there is neither a traversal nor a call: fastest for the dozens of
surfaces of a typical course scene, and its kernel grows with their number.
"""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.geometry import Surface
from mitsuba_plugins.integrators.rays import NOTHING, Ray, sphere_distance


class AnalyticSurfaces:
    """Surfaces whose numbers are kernel arguments: scenes that differ in numbers only share one compiled kernel.

    Args:
        surfaces: the objects.
        first: the record of each one's sphere or first plane.

    """

    def __init__(self, surfaces: list[Surface], first: list[int]) -> None:
        self._first = first
        self._spheres: list[Any] = []
        self._planes: list[Any] = []
        self._bounds: list[Any] = []
        for surface in surfaces:
            if surface.sphere is not None:
                x, y, z, r = (mi.Float64(number) for number in surface.sphere)
                self._spheres.append((mi.Point3d(x, y, z), r))
            else:
                self._spheres.append(None)
            x, y, z, r = (mi.Float64(number) for number in surface.bound or (0.0,) * 4)
            self._bounds.append((mi.Point3d(x, y, z), r) if surface.bound else None)
            self._planes.append([(mi.Normal3d(*p[:3]), mi.Float64(p[3])) for p in surface.planes.values()])
        dr.make_opaque(self._spheres, self._planes, self._bounds)

    def closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any]:
        """Distance (infinite for none), object (NOTHING for none) and record of the first hit."""
        t_best = mi.Float64(dr.inf)
        object_best = mi.UInt32(NOTHING)
        record_best = mi.UInt32(0)
        for index in range(len(self._first)):
            t, record = self._intersect(index, ray)
            closer = t < t_best
            t_best = dr.select(closer, t, t_best)
            object_best = dr.select(closer, index, object_best)
            record_best = dr.select(closer, record, record_best)
        return t_best, object_best, record_best

    @dr.syntax
    def blocker(self, ray: Ray, distance: Any, active: Any) -> Any:
        """Some object that the ray meets before `distance`, or NOTHING."""
        found = dr.full(mi.UInt32, NOTHING, dr.width(ray.d))
        if active:
            for index in range(len(self._first)):
                t, _ = self._intersect(index, ray)
                found = dr.select(t < distance, mi.UInt32(index), found)
        return found

    def _intersect(self, index: int, ray: Ray) -> tuple[Any, Any]:
        """Distance to one surface (infinite or NaN for none: compare with <) and the record that is met."""
        own = ray.object == index
        if self._spheres[index] is not None:
            center, radius = self._spheres[index]
            return sphere_distance(center, radius, ray, own), mi.UInt32(self._first[index])
        if self._bounds[index] is not None:
            return self._intersect_bounded(index, ray, own)
        return self._intersect_planes(index, ray, own)

    @dr.syntax
    def _intersect_bounded(self, index: int, ray: Ray, own: Any) -> tuple[Any, Any]:
        """A branch and no mask: most packets of rays pass by most polyhedra and save their planes."""
        t = dr.full(mi.Float64, dr.inf, dr.width(ray.d))
        record = dr.zeros(mi.UInt32, dr.width(ray.d))
        center, radius = self._bounds[index]
        f = ray.o - center
        b = -dr.dot(f, ray.d)
        if (dr.squared_norm(f + b * ray.d) <= radius * radius) & (b > -radius):
            t, record = self._intersect_planes(index, ray, own)
        return t, record

    def _intersect_planes(self, index: int, ray: Ray, own: Any) -> tuple[Any, Any]:
        """Haines, Fast Ray-Convex Polyhedron Intersection, Graphics Gems II, 1991."""
        t_enter, t_leave = mi.Float64(-dr.inf), mi.Float64(dr.inf)
        record_enter, record_leave = mi.UInt32(0), mi.UInt32(0)
        outside = mi.Bool(False)
        for record, (n, d) in enumerate(self._planes[index], self._first[index]):
            cosine = dr.dot(n, ray.d)
            distance = dr.dot(n, ray.o) + d
            t = -distance / cosine
            other = ray.record != record
            enters = (cosine < 0) & (t > t_enter) & other
            leaves = (cosine > 0) & (t < t_leave) & other
            outside |= (cosine == 0) & (distance > 0)
            t_enter, record_enter = dr.select(enters, t, t_enter), dr.select(enters, record, record_enter)
            t_leave, record_leave = dr.select(leaves, t, t_leave), dr.select(leaves, record, record_leave)
        front = t_enter > ray.t_min
        t = dr.select(front, t_enter, t_leave)
        t = dr.select(~outside & (t_enter <= t_leave) & (t > ray.t_min), t, dr.inf)
        # A ray that starts on this body leaves it for good, or crosses it to the exit, at an edge at once.
        t_own = dr.select(ray.inside, dr.maximum(t_leave, 0), dr.inf)
        return dr.select(own, t_own, t), dr.select(own | ~front, record_leave, record_enter)
