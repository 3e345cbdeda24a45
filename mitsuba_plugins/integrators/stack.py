"""A stack of rays in local memory, for ray trees in one kernel."""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.rays import Ray, Real
from mitsuba_plugins.intersection.rounding import bounds_all


class RayStack:
    """Rays that wait for their turn, with their weights and depths, and in scenes that are sampled with their paths:
    one small buffer for each of their numbers.

    Small, since Dr.Jit 1.5 may crash with buffers of more than 128 bytes: 16 doubles. Fewer wait than the logarithm, to
    base 2, of the rays of a pixel: 15, unless a user asks for a greater depth than the default.
    Indices and masks have full width: an index of width 1 would make all SIMD lanes use one slot.
    """

    def __init__(self, types: Real, size: int, sampled: bool) -> None:
        self._types = types
        self._sampled = sampled
        number, integer = types.Float, mi.UInt32
        self._shifts = bounds_all(number)
        kinds = [number] * 8 + [integer] * 3 + [number, integer] + [integer] * sampled + [number] * self._shifts
        self._buffers = [dr.alloc_local(kind, size, value=kind(0)) for kind in kinds] if size else []

    def write(self, slot: Any, ray: Ray, weight: Any, depth: Any, path: Any, active: Any) -> None:
        """Put a ray at `slot`."""
        inside = dr.select(ray.inside, mi.UInt32(1), 0)
        numbers = [*ray.o, *ray.d, ray.t_min, ray.spread, ray.object, ray.primitive, inside, weight, depth]
        numbers += [path] * self._sampled + [ray.shift] * self._shifts
        for buffer, number in zip(self._buffers, numbers, strict=bool(self._buffers)):
            buffer.write(number, slot, active)

    def read(self, slot: Any, time: Any, active: Any) -> tuple[Ray, Any, Any, Any]:
        """The ray, whose tree has one time, weight, depth and path, if it is kept, at `slot`."""
        ox, oy, oz, dx, dy, dz, t_min, spread, index, primitive, inside, weight, depth, *path = (
            buffer.read(slot, active) for buffer in self._buffers
        )
        shift = path.pop() if self._shifts else None
        o, d = self._types.Point3(ox, oy, oz), self._types.Vector3(dx, dy, dz)
        ray = Ray(o, d, index, primitive, inside == 1, t_min, spread, time, shift)
        return ray, weight, depth, *(path or [mi.UInt32(0)])
