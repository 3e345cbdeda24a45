"""Intersection through Mitsuba's own acceleration structure: it says WHICH surface a ray meets, the exact surface
says where.

Embree and OptiX work in single precision on triangles whose corners were rounded to it. The ray that they see therefore
starts a little off the surface that it leaves (Waechter and Binder, A Fast and Robust Method for Avoiding
Self-Intersection, Ray Tracing Gems ch. 6, give the reasoning), by an amount that grows with the coordinates and with
the mesh's measured distance from its planes. Distances count from the true origin, so that this offset moves nothing:
it only hides surfaces nearer than itself. A surface met again against the rules of `rays` is stepped over.
"""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.geometry import Surface
from mitsuba_plugins.integrators.rays import NOTHING, Ray, lanes, ray_reach
from mitsuba_plugins.integrators.tables import Records

OFFSET = 2.0**-20
"""Start of a ray off its surface, in units of the largest coordinate involved: 16 units in the last place."""
MOST_STEPS = 32


class MeshSurfaces:
    """The shapes of a Mitsuba scene, with the exact surfaces they were made from."""

    def __init__(self, scene: Any, surfaces: list[Surface], records: Records) -> None:
        self._scene = scene
        self._records = records
        by_name = {surface.name: index for index, surface in enumerate(surfaces)}
        shapes = scene.shapes()
        # Dr.Jit numbers shapes by a registry of the whole process, in which this scene's shapes may lie anywhere.
        registry = dr.reinterpret_array(mi.UInt32, scene.shapes_dr()).numpy()
        size = int(registry.max()) + 1 if len(registry) else 1
        object_of, first_triangle = [0] * size, [0] * size
        record_of_triangle: list[int] = []
        for shape, identifier in zip(shapes, registry, strict=True):
            surface = surfaces[by_name[shape.id()]]
            object_of[identifier] = by_name[shape.id()]
            first_triangle[identifier] = len(record_of_triangle)
            if surface.sphere is None and shape.primitive_count() != len(surface.triangles):
                raise ValueError(f"whitted: mesh {surface.name} has not the triangles that 'geometry' gives planes for")
            row = {plane: row for row, plane in enumerate(surface.planes)}
            first = records.first[by_name[surface.name]]
            record_of_triangle.extend(first + row.get(plane, 0) for plane in surface.triangles or (0,))
        self._object = mi.UInt32(object_of)
        self._first_triangle = mi.UInt32(first_triangle)
        self._record = mi.UInt32(record_of_triangle or [0])
        self._deviation = mi.Float64([surface.deviation for surface in surfaces] or [0.0])
        self._extent = mi.Float64([_extent(surface) for surface in surfaces] or [0.0])
        dr.make_opaque(self._object, self._first_triangle, self._record, self._deviation, self._extent)

    def closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any]:
        """Distance (infinite for none), object (NOTHING for none) and record of the first hit."""
        return self._find(ray, mi.Float64(dr.inf), active)

    def blocker(self, ray: Ray, distance: Any, active: Any) -> Any:
        """The first object that the ray meets before `distance`, or NOTHING."""
        # Not Scene.ray_test, which is less careful with distant spheres than ray_intersect_preliminary.
        return self._find(ray, distance, active)[1]

    @dr.syntax
    def _find(self, ray: Ray, distance: Any, active: Any) -> tuple[Any, Any, Any]:
        width = dr.width(ray.d)
        start = mi.Point3d(self._start(ray, active))
        t = dr.full(mi.Float64, dr.inf, width)
        found = dr.full(mi.UInt32, NOTHING, width)
        record = dr.zeros(mi.UInt32, width)
        searching = active & lanes(width)
        steps = dr.zeros(mi.UInt32, width)
        while searching:
            probe = mi.Ray3f(mi.Point3f(start), mi.Vector3f(ray.d))
            pi = self._scene.ray_intersect_preliminary(probe, coherent=False, active=searching)
            met = searching & pi.is_valid()
            shape = dr.reinterpret_array(mi.UInt32, pi.shape)
            index = dr.gather(mi.UInt32, self._object, shape, met)
            triangle = dr.gather(mi.UInt32, self._first_triangle, shape, met) + pi.prim_index
            index_record = dr.gather(mi.UInt32, self._record, triangle, met)
            t_exact = self._records.intersect(index, index_record, ray, met)
            allowed = t_exact < dr.inf
            accepted = met & allowed & (t_exact < distance)
            t = dr.select(accepted, t_exact, t)
            found = dr.select(accepted, index, found)
            record = dr.select(accepted, index_record, record)
            # Step over what may not be met. Steps double, so that they get out of any rounding error in a few; where
            # they start from nothing (at the origin, from the eye) they cannot, and end.
            steps += 1
            searching = met & ~allowed & (steps < MOST_STEPS)
            step = (_reach(start) + ray_reach(ray) + mi.Float64(pi.t)) * OFFSET
            step += dr.gather(mi.Float64, self._deviation, index, met)
            start = mi.Point3d(start + ray.d * (mi.Float64(pi.t) + step * mi.Float64(mi.UInt32(1) << steps)))
        return t, found, record

    def _start(self, ray: Ray, active: Any) -> Any:
        """Origin for the single-precision ray, off the surface that `ray` starts on, on the side it travels on."""
        leaves = active & (ray.object != NOTHING)
        _, n = self._records.surface_point(ray.object, ray.record, ray.o, leaves)
        reach = dr.maximum(ray_reach(ray), dr.gather(mi.Float64, self._extent, ray.object, leaves))
        offset = reach * OFFSET + 2 * dr.gather(mi.Float64, self._deviation, ray.object, leaves)
        return dr.select(leaves, ray.o + dr.select(ray.inside, -n, n) * offset, ray.o)


def _reach(p: Any) -> Any:
    return dr.maximum(dr.maximum(dr.abs(p.x), dr.abs(p.y)), dr.abs(p.z))


def _extent(surface: Surface) -> float:
    """Largest coordinate of a sphere, whose rounding moves its surface; a mesh's is in its deviation."""
    return max(map(abs, surface.sphere[:3])) + surface.sphere[3] if surface.sphere is not None else 0.0
