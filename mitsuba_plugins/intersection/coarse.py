"""Tests in single precision by which rays pass by what they do not meet: what they let through is exact."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.rays import Ray, Real, largest
from mitsuba_plugins.intersection.rounding import bounds_all
from mitsuba_plugins.intersection.shapes.kind import Row

ROOM = 2.0**-18
"""By how much, relative to all balls and the ray's origin, a ball is larger: more than all roundings here together, of
which there are some twenty, and more than what ties with it."""

_LARGEST_EXPONENT = 1023
"""Of a power of two that is a double."""


@dataclass
class CoarseRay:
    """A ray in single precision, lengths times a scale."""

    o: Any  # Point3f
    d: Any  # Vector3f
    room: Any  # Float, how much larger balls are
    spread: Any  # Float, and the farther away the more


class Balls:
    """Balls around surfaces, of which some have none."""

    def __init__(self, types: Real, balls: Sequence[Row | None]) -> None:
        """Take a centre and a radius of each."""
        scale = unit_scale(abs(x) for ball in balls if ball is not None for x in ball)
        self._scale = types.Float(scale)
        self._balls: list[Any] = [_scaled(ball, scale) if ball is not None else None for ball in balls]
        dr.make_opaque(self._scale, self._balls)

    def bounds(self, k: int) -> bool:
        """Whether there is a ball around surface k."""
        return self._balls[k] is not None

    def ray(self, ray: Ray) -> CoarseRay:
        """A ray as the tests take it."""
        o = mi.Point3f(ray.o * self._scale)
        room = (largest(o) + 1) * ROOM
        if bounds_all(ray.t_min):
            room += (ray.t_min + ray.shift) * self._scale
        return CoarseRay(o, mi.Vector3f(ray.d), room, ray.spread if bounds_all(ray.t_min) else None)

    def may_meet(self, k: int, ray: CoarseRay) -> Any:
        """Whether rays may meet ball k."""
        center, radius = self._balls[k]
        f, radius = mi.Vector3f(center - ray.o), radius + ray.room
        along = dr.dot(f, ray.d)
        if ray.spread is not None:
            radius += 2 * dr.abs(along) * ray.spread
        # Of numbers beyond all measure these are NaN: then the ball counts as met.
        return ~(dr.squared_norm(f - along * ray.d) > dr.square(radius)) & ~(along < -radius)

    def starts_within(self, k: int, ray: CoarseRay) -> Any:
        """Whether rays start inside of ball k, away from its surface."""
        center, radius = self._balls[k]
        radius = radius - 2 * ray.room
        return (dr.squared_norm(center - ray.o) < dr.square(radius)) & (radius > 0)


def unit_scale(numbers: Iterable[float]) -> float:
    """A power of two that makes numbers, and none is negative, so large that single precision holds them."""
    largest = max(numbers, default=0.0)
    return math.ldexp(1.0, min(-math.frexp(largest)[1], _LARGEST_EXPONENT)) if largest > 0 else 1.0


def _scaled(ball: Row, scale: float) -> tuple[Any, Any]:
    x, y, z, radius = (number * scale for number in ball)
    return mi.Point3f(x, y, z), mi.Float(radius)
