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

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.mitsuba_primitives import MitsubaPrimitives
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest, ray_reach
from mitsuba_plugins.intersection.surfaces import ExactSurfaces
from mitsuba_plugins.syntax import syntax

OFFSET = 2.0**-20
"""Start of a ray off its surface, in units of the largest coordinate involved: 16 units in the last place."""
MOST_STEPS = 32


class MeshSurfaces(ExactSurfaces):
    """The shapes of a Mitsuba scene, with the exact surfaces they were made from."""

    finds_ties = False

    def __init__(
        self, types: Real, scene: Any, surfaces: list[Surface], primitives: Primitives, contacts: LightContacts
    ) -> None:
        super().__init__(primitives, contacts)
        self._types = types
        self._scene = scene
        self._found = MitsubaPrimitives(scene, surfaces, primitives)
        self._deviation = column(types.Float, [surface.deviation for surface in surfaces])
        self._extent = column(types.Float, [surface.extent for surface in surfaces])

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """Distance (infinite for none), object (NOTHING for none) and primitive of the first hit. Looks for no ties."""
        return *self._search(ray, self._types.Float(dr.inf), None, active), None

    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """The first object that the ray meets before it comes to a light at `distance`, or NOTHING."""
        # Not Scene.ray_test, which is less careful with distant spheres than ray_intersect_preliminary.
        return self._search(ray, distance, light, active)[1], None

    @syntax
    def _search(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any, Any]:
        """What is met first before `distance`, at which there may be a light."""
        width = dr.width(ray.d)
        reach = largest(ray.o)
        start = self._types.Point3(self._start(ray, active))
        t = dr.full(self._types.Float, dr.inf, width)
        found = dr.full(mi.UInt32, NOTHING, width)
        primitive = dr.zeros(mi.UInt32, width)
        searching = mi.Bool(active)
        steps = dr.zeros(mi.UInt32, width)
        while dr.hint(searching, exclude=[self, ray, distance, light, reach]):
            probe = mi.Ray3f(mi.Point3f(start), mi.Vector3f(ray.d))
            pi = self._scene.ray_intersect_preliminary(probe, coherent=False, active=searching)
            met = searching & pi.is_valid()
            index, index_primitive = self._found.find(pi, met)
            crossing = self.primitives.intersect_one(ray, index, index_primitive, met, reach)
            t_exact = crossing.t
            allowed = t_exact < dr.inf
            accepted = met & allowed & (t_exact < distance)
            if dr.hint(light is not None, mode="scalar"):
                accepted &= ~self.contacts.lies_at(light, crossing, ray.d, accepted)
            t = dr.select(accepted, t_exact, t)
            found = dr.select(accepted, index, found)
            primitive = dr.select(accepted, crossing.primitive, primitive)
            # Step over what may not be met. Steps double, so that they get out of any rounding error in a few; where
            # they start from nothing (at the origin, from the eye) they cannot, and end.
            steps += 1
            searching = met & ~allowed & (steps < MOST_STEPS)
            step = (largest(start) + ray_reach(ray) + self._types.Float(pi.t)) * OFFSET
            step += dr.gather(self._types.Float, self._deviation, index, met)
            step *= self._types.Float(mi.UInt32(1) << steps)
            start = self._types.Point3(start + ray.d * (self._types.Float(pi.t) + step))
        return t, found, primitive

    def _start(self, ray: Ray, active: Any) -> Any:
        """Origin for the single-precision ray, off the surface that `ray` starts on, on the side it travels on."""
        leaves = active & (ray.object != NOTHING)
        n = self.primitives.surface_at(ray, ray.object, ray.primitive, ray.o, leaves, largest(ray.o)).n
        reach = dr.maximum(ray_reach(ray), dr.gather(self._types.Float, self._extent, ray.object, leaves))
        offset = reach * OFFSET + 2 * dr.gather(self._types.Float, self._deviation, ray.object, leaves)
        return dr.select(leaves, ray.o + dr.select(ray.inside, -n, n) * offset, ray.o)
