"""Bounds of rounding errors, by which ties are decided, as in the native tracer.

People place eyes, floors, boxes and tiles at round numbers, so that whole rows of rays meet edges exactly. What then
decides are two numbers that are equal but for their rounding errors, and count as equal: each comparison knows a bound
of the errors of its two numbers, and what happens at a tie is a rule of the format. A ray's origin may be off by its
`t_min`, its direction by its `spread`, a surface by its kind's `surface_error`; at distance t a ray is off by
t_min + t spread. The spread grows from bounce to bounce; where it exceeds `most_blur`, nothing is known that a rule
could be applied to.

Kernels in single precision that are recorded while `bounded` know bounds of all errors, without a limit, and some room
beyond first order. They decide no ties: a comparison that its errors might turn is close to one, and its ray undecided.
Here `t_min` is how far the line of a ray may be off sideways, since mirrors keep that as it is, and `shift` how far its
origin may be off along it. All that depends on the precision asks `bounds_all`.

Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition, 2002, section 3.3: running error analysis.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import Any

import drjit as dr
import numpy as np

from mitsuba_plugins.arithmetic import quotient


def decides_ties(number: Any) -> bool:
    """Whether ties are decided in arithmetic like that of `number`: in single precision the bounds would be seen."""
    return bool(dr.type_v(number) == dr.VarType.Float64)


def bounds_all(number: Any) -> bool:
    """Whether the errors of arithmetic like that of `number` are all bounded: of single precision while `bounded`."""
    return _bounded.get() is not None and bool(dr.type_v(number) == dr.VarType.Float32)


def bounded(exact_axes: bool) -> Callable[[], AbstractContextManager[None]]:
    """What lets kernels that are recorded meanwhile bound all errors of single precision; with `exact_axes` that has
    the numbers of all planes along the axes.
    """

    @contextmanager
    def context() -> Iterator[None]:
        token = _bounded.set(exact_axes)
        try:
            yield
        finally:
            _bounded.reset(token)

    return context


_bounded: ContextVar[bool | None] = ContextVar("bounded", default=None)


def epsilon(number: Any) -> float:
    """The unit of the bounds: the distance from 1 to the next number; 0 where nothing is bounded."""
    if bounds_all(number):
        return 2.0**-23
    return 2.0**-52 if decides_ties(number) else 0.0


def least_spread(number: Any) -> float:
    """Some eight roundings, of a unit vector's component and of its products with others."""
    return 4 * epsilon(number)


def most_blur(number: Any) -> float:
    """Relative to distances and coordinates; beyond it the bounds, which grow faster than errors, make ties of none."""
    if bounds_all(number):
        return 2.0**40
    return 2.0**-36 if decides_ties(number) else 0.0


def most_of_radius(number: Any) -> float:
    """Relative to a radius of curvature, of errors that say something of a surface."""
    if bounds_all(number):
        return 2.0**40
    return 2.0**-32 if decides_ties(number) else 0.0


def most_camera_blur(number: Any) -> float:
    """Of directions from an eye far from the origin, whose bounds have not grown: the square root of epsilon."""
    return math.sqrt(epsilon(number))


def input_error(number: float) -> float:
    """Of a number in a file: a whole one is meant as it stands, any other is a decimal that was rounded to a double."""
    return 0.0 if number == math.floor(number) else 2.0**-52 * abs(number)


def camera_errors(types: Any, sensor: Any) -> tuple[Any, Any]:
    """How far the eye of a `pinhole` may be off, and the directions from it besides their roundings (Float)."""
    if not hasattr(sensor, "eye"):
        return types.Float(0), types.Float(0)
    eye, look_at = (np.ravel(point).tolist() for point in (sensor.eye, sensor.look_at))
    error, other = (max(map(input_error, point)) for point in (eye, look_at))
    spread = min((error + other) / math.dist(eye, look_at), most_camera_blur(types.Float))
    return dr.opaque(types.Float, error), dr.opaque(types.Float, spread)


def coordinate_errors(p: Any, n: Any, d: Any, t: Any, off: Any) -> Any:
    """How far each coordinate of a point of a surface may be off: a plane along the axes fixes one.

    Args:
        p: the point (Point3).
        n: the unit normal there (Vector3).
        d: direction of the ray that has met it.
        t: how far that ray came.
        off: how far ray and surface may be off from one another; the point is, the more the ray slants.

    """
    reach = dr.maximum(dr.maximum(dr.abs(p.x), dr.abs(p.y)), dr.abs(p.z))
    along = dr.fmin(quotient(off, dr.abs(dr.dot(n, d))), most_blur(t) * (reach + t))

    def error(coordinate: Any, normal: Any, slope: Any) -> Any:
        rounding = 2 * epsilon(t) * dr.abs(coordinate)
        return rounding + dr.select(dr.abs(normal) < 1, off + dr.abs(slope) * along, 0)

    if not bounds_all(t):
        return type(n)(*map(error, p, n, d))
    # What rounds to 1 is no axis yet.
    tilts = dr.abs(n.x) + dr.abs(n.y) + dr.abs(n.z) != 1
    along *= 1.5
    errors = map(error, p, dr.select(tilts, 0.5, n), d)
    if not _bounded.get():
        return type(n)(*errors)
    return type(n)(*(dr.select(dr.abs(x) == 1, dr.select(tilts, e, 0), e) for x, e in zip(n, errors, strict=True)))
