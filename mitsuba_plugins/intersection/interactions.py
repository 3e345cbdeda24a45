"""Intersection as Mitsuba's own integrators do it, in single precision throughout: Embree or OptiX says where, too.

New rays start off the surface by an offset, which has to hide the rounding errors of the intersection, and hides what
is truly that near as well: Mitsuba's own, which grows with the largest coordinate, or Waechter and Binder's, a number
of units in the last place of each coordinate. Here to be compared with the methods that know better.
"""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.mitsuba_primitives import MitsubaPrimitives
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Hit, Ray


class MitsubaSurfaces:
    """The shapes of a Mitsuba scene, taken at their word; meshes may stand for spheres."""

    finds_ties = False
    postpones_ties = False

    def __init__(self, scene: Any, surfaces: list[Surface], primitives: Primitives, offset: str) -> None:
        self._scene = scene
        self._primitives = MitsubaPrimitives(scene, surfaces, primitives)
        self._offset = _mitsuba_offset if offset == "offset" else _ulp_offset

    def closest(self, ray: Ray, active: Any) -> Hit:
        """The first surface that a ray meets."""
        probe = mi.Ray3f(ray.o, ray.d)
        found = self._scene.ray_intersect_preliminary(probe, coherent=False, active=active)
        valid = active & found.is_valid()
        index, primitive = self._primitives.find(found, valid)
        flags = mi.RayFlags.Minimal | mi.RayFlags.ShadingFrame
        si = found.compute_surface_interaction(probe, +flags, valid)
        n = mi.Vector3f(si.sh_frame.n)
        index, inside = dr.select(valid, index, NOTHING), dr.dot(n, ray.d) > 0
        return Hit(valid, si.t, index, primitive, si.p, n, inside, mi.Float(0), mi.Float(0), mi.Float(0))

    def spawn(self, hit: Hit, d: Any, inside: Any, spread: Any) -> Ray:
        """The ray that leaves `hit` in direction `d`."""
        return Ray(self._offset(hit, d), d, hit.object, hit.primitive, inside, mi.Float(0), spread)

    def blocker(self, hit: Hit, d: Any, distance: Any, error: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """The first object between `hit` and a light at `distance` in direction `d`, or NOTHING; ties are not seen."""
        origin = self._offset(hit, d)
        to_target = hit.p + d * distance - origin
        length = dr.norm(to_target)
        # Short of the target, as Mitsuba's own shadow rays end.
        probe = mi.Ray3f(origin, quotient(to_target, length), length * (1 - mi.math.ShadowEpsilon), 0.0, [])
        found = self._scene.ray_intersect_preliminary(probe, coherent=False, active=active)
        blocked = active & found.is_valid()
        return dr.select(blocked, self._primitives.find(found, blocked)[0], NOTHING), False


def _mitsuba_offset(hit: Hit, d: Any) -> Any:
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(d))
    si.p, si.n = hit.p, mi.Normal3f(hit.n)
    return si.spawn_ray(d).o


def _ulp_offset(hit: Hit, d: Any) -> Any:
    """Waechter and Binder, A Fast and Robust Method for Avoiding Self-Intersection, Ray Tracing Gems, 2019, ch. 6."""
    n = dr.select(dr.dot(hit.n, d) < 0, -hit.n, hit.n)
    return mi.Point3f([_ulps_off(p, n) for p, n in zip(hit.p, n, strict=True)])


def _ulps_off(p: Any, n: Any) -> Any:
    ulps = mi.Int32(n * 256)
    moved = dr.reinterpret_array(mi.Float, dr.reinterpret_array(mi.Int32, p) + dr.select(p < 0, -ulps, ulps))
    return dr.select(dr.abs(p) < 2.0**-5, p + n * 2.0**-16, moved)
