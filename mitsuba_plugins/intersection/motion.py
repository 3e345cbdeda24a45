"""Objects that move: at the time of a ray, from 0 to 1, each stands at its place plus that part of its displacement.

Whether a ray meets one is asked where it stands still. The ray is brought there instead, and the answer holds where the
ray is, for distances and directions are the same; so does what is known of where the ray starts.
"""

from dataclasses import replace
from typing import Any

import drjit as dr

from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.rays import Hit, Ray, largest
from mitsuba_plugins.intersection.rounding import epsilon, input_error
from mitsuba_plugins.intersection.shapes.kind import Row

ROUNDINGS = 4
"""Of a sum or a difference of a point and a way, generously, in units of half an ulp of 1."""


def motion_row(surface: Surface) -> Row:
    """The displacement of an object, and how far it may be off, as kernels read it."""
    x, y, z = surface.move
    return x, y, z, max(map(input_error, surface.move))


def bring_back(ray: Ray, motion: Any) -> Ray:
    """A ray as it meets an object where that stands still, given the object's motion (Vector4, see `motion_row`)."""
    way = _way(ray, motion)
    return replace(ray, o=type(ray.o)(ray.o - way), t_min=ray.t_min + _error(ray.o, way, motion))


def take_along(hit: Hit, ray: Ray, motion: Any) -> Hit:
    """A hit on an object that stands still where that is at the time of the ray."""
    way = _way(ray, motion)
    p, error = type(hit.p)(hit.p + way), hit.error + _error(hit.p, way, motion)
    return replace(hit, p=p, error=error, place=hit.p, time=ray.time)


def _way(ray: Ray, motion: Any) -> Any:
    return ray.time * type(ray.d)(motion.xyz)


def _error(p: Any, way: Any, motion: Any) -> Any:
    """How far a sum or a difference may be off; nothing where an object stands still."""
    reach = largest(p) + largest(way)
    rounding = reach * (ROUNDINGS * dr.epsilon(reach))
    off = motion.w if epsilon(reach) > 0 else 0
    return dr.select(largest(motion) > 0, rounding + off, 0)
