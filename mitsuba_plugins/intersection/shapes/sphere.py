"""A sphere: its centre and radius."""

import math
from typing import Any

import drjit as dr
import numpy as np

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.passages import Passage
from mitsuba_plugins.intersection.rays import Ray, largest
from mitsuba_plugins.intersection.rounding import bounds_all, epsilon, most_of_radius
from mitsuba_plugins.intersection.shapes.kind import Contact, Row, Rows, Shape, SurfacePoint
from native_tracer.incidence import surfaces_at

ROWS = 1
FACETED = False
CONVEX = True


def read(entry: dict[str, Any]) -> Shape:
    """`"sphere": [x, y, z, r]`."""
    x, y, z, r = entry["sphere"]
    rows = [(x, y, z, r)]
    box = (x - r, y - r, z - r), (x + r, y + r, z + r)
    return Shape(rows, rows, (None,), box, max(map(abs, (x, y, z))) + r, rows[0])


def contacts(point: Any, rows: Any) -> list[Contact]:
    """With the radius from the centre as the normal."""
    found = []
    for row in surfaces_at(point, rows, np.ones(len(rows), dtype=np.bool_)):
        arm = point - rows[row, :3]
        # The square of a length may neither overflow nor vanish.
        arm = arm / np.abs(arm).max()
        x, y, z = (arm / np.linalg.norm(arm)).tolist()
        bend = 1 / float(rows[row, 3])
        found.append(Contact(row, (x, y, z), bend, ((bend, 0.0, 0.0), (0.0, bend, 0.0), (0.0, 0.0, bend))))
    return found


def turned(rows: tuple[Row, ...]) -> tuple[Row, ...] | None:
    """There are none that are hollow."""
    return None


def contains(point: Any, rows: Any) -> bool:
    """By the distance from the centre, or on it."""
    ((x, y, z, radius),) = rows
    return math.dist(point, (x, y, z)) <= radius or bool(contacts(point, rows))


def slides(move: Any, row: Any) -> bool:
    """None does."""
    return False


def passage(rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
    """Both roots, from the centre; those that nearly touch are close to a tie."""
    row = rows.row()
    f, b, discriminant = _from_center(row, ray)
    if bounds_all(discriminant):
        return _doubtful_passage(rows, row, ray, own, f, b, discriminant)
    close = dr.abs(discriminant) <= most_of_radius(row.w) * dr.square(row.w)
    near, far = _roots(row, f, b, discriminant)
    return Passage(near, far, rows.primitive(), rows.primitive(), close=close & ~own)


def _doubtful_passage(rows: Rows, row: Any, ray: Ray, own: Any, f: Any, b: Any, discriminant: Any) -> Passage:
    """The same with bounds: a tie is what is within these."""
    radius = row.w
    error = ray.t_min + surface_error(row) + 2 * epsilon(b) * dr.abs(b)
    off = error + dr.abs(b) * ray.spread
    touching = off * (4 * radius + off)
    near, far = _roots(row, f, b, discriminant)
    # A little more than to first order, as the discriminant is far from 0.
    steep = quotient(1.25 * radius, dr.sqrt(discriminant))

    def distance_error(_: Any, t: Any) -> Any:
        return (error + dr.abs(t) * ray.spread) * steep

    close = ~(dr.abs(discriminant) > touching) & (~own | ray.inside)
    # Of two crossings behind it does not matter where they are.
    close &= ~(b + radius < -off - ray.shift)
    return Passage(near, far, rows.primitive(), rows.primitive(), close=close, error=distance_error)


def passage_by_rules(rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
    """A ray that only touches the sphere passes by."""
    row = rows.row()
    radius = row.w
    error = ray.t_min + surface_error(row)
    f, b, discriminant = _from_center(row, ray)
    touching = radius * dr.minimum(2 * (error + dr.abs(b) * ray.spread), most_of_radius(radius) * radius)
    near, far = _roots(row, f, b, dr.select(discriminant > touching, discriminant, dr.nan))
    # A ray that starts on the sphere by its origin's roundings, and not by knowledge, does not meet it there. That
    # crossing lies behind, and so do both where it leads away from the other.
    starts = ~own & (dr.abs(dr.norm(f) - radius) <= error) & (error <= most_of_radius(radius) * radius)
    near = dr.select(starts, -dr.inf, near)
    far = dr.select(starts, dr.select(far > ray.t_min, -2 * dr.dot(f, ray.d), -dr.inf), far)

    def distance_error(_: Any, t: Any) -> Any:
        arm = f + t * ray.d
        return quotient((error + t * ray.spread) * radius, dr.abs(dr.dot(arm, ray.d)))

    return Passage(near, far, rows.primitive(), rows.primitive(), error=distance_error)


def surface_at(rows: Rows, p: Any, ray: Ray, own: Any, reach: Any) -> SurfacePoint:
    """Along the radius.

    Where the point is the centre, or so near that the square of its distance is 0, the normal is along the ray: if a
    sphere is too small beside its distance from where the ray starts, no more is known of a point on it.
    """
    row = rows.row()
    center, radius = type(ray.o)(row.xyz), row.w
    within = own | (dr.squared_norm(ray.o - center) < dr.square(radius))
    arm = p - center
    length = dr.norm(arm)
    n = type(ray.d)(dr.select(length == 0, dr.select(within, ray.d, -ray.d), arm * quotient(1, length)))
    return SurfacePoint(type(p)(center + n * radius), n, surface_error(row), radius)


def surface_error(row: Any) -> Any:
    """How far a sphere may be off: its numbers are whole and meant as they stand, or decimals that were rounded."""
    center, radius = row.xyz, row.w
    if bounds_all(radius):
        return epsilon(radius) * (radius + largest(center))
    meant = (radius == dr.floor(radius)) & dr.all(center == dr.floor(center))
    return dr.select(meant, 0, epsilon(radius) * (radius + largest(center)))


def _from_center(row: Any, ray: Ray) -> tuple[Any, Any, Any]:
    """The origin seen from the centre, how far from there the ray comes nearest to it, and the discriminant.

    Haines, Gunther and Akenine-Moller, Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems ch. 7.
    """
    f = ray.o - type(ray.o)(row.xyz)
    b = -dr.dot(f, ray.d)
    return f, b, row.w * row.w - dr.squared_norm(f + b * ray.d)


def _roots(row: Any, f: Any, b: Any, discriminant: Any) -> tuple[Any, Any]:
    root = dr.sqrt(discriminant)  # NaN where the ray misses: no comparison with it holds
    q = b + dr.copysign(root, b)
    other = quotient(dr.squared_norm(f) - row.w * row.w, q)
    return dr.minimum(q, other), dr.maximum(q, other)
