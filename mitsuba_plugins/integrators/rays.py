"""Rays and hits in double precision, and the rules that keep a ray from hitting the surface it starts on.

The rules are the native tracer's. A ray knows the object and the plane that it starts on and whether it travels inside
that object, so that its own convex surface is excluded by knowledge and not by a distance. Other surfaces count from
`t_min` on, a bound on the rounding error of the origin (Pharr, Jakob and Humphreys, Physically Based Rendering, 4th
edition, section 6.8, gives the reasoning).
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

NOTHING = 0xFFFFFFFF
"""Object index of a ray that starts on no surface, and of a hit that is none."""

EPSILON = 2.0**-52
ERROR_BOUND = 32
"""Roundings, generously, between a ray's numbers and the point on it: `t_min` in units of EPSILON."""


@dataclass
class Ray:
    """A ray: Point3d origin, unit Vector3d direction, and what it starts on."""

    o: Any
    d: Any
    object: Any  # UInt32, NOTHING for a primary ray, as is `record`
    record: Any  # UInt32, the record of the sphere or plane that o lies on, see `tables`
    inside: Any  # Bool, whether the ray travels inside `object`
    t_min: Any  # Float64


@dataclass
class Hit:
    """What a ray met: distance, object and record, the point on that surface, and its unit normal, which points out."""

    valid: Any  # Bool
    t: Any  # Float64
    object: Any  # UInt32
    record: Any  # UInt32, see `tables`
    p: Any  # Point3d
    n: Any  # Normal3d, outward
    inside: Any  # Bool, whether the ray came from inside the object


def ray_reach(ray: Ray) -> Any:
    """The largest coordinate or distance that went into the origin of a ray, 0 for a primary one."""
    return ray.t_min / (ERROR_BOUND * EPSILON)


def start_ray(o: Any, d: Any) -> Ray:
    """A ray that starts on no surface, at full width, as Dr.Jit's loops and local buffers want it."""
    width = dr.width(d)
    return Ray(
        o=mi.Point3d(o) + dr.zeros(mi.Point3d, width),
        d=mi.Vector3d(d),
        object=dr.full(mi.UInt32, NOTHING, width),
        record=dr.full(mi.UInt32, NOTHING, width),
        inside=dr.full(mi.Bool, False, width),
        t_min=dr.zeros(mi.Float64, width),
    )


def lanes(width: int) -> Any:
    """Mask of the rays that exist.

    The last SIMD packet of a wavefront is filled up with lanes that hold garbage. They answer comparisons, but no ray
    is traced for them, so that a loop that waits until each has found something may wait for ever.
    """
    return dr.arange(mi.UInt32, width) < width


def spawn(hit: Hit, d: Any, inside: Any) -> Ray:
    """The ray that leaves `hit` in direction `d`, on the given side of the object."""
    reach = dr.maximum(dr.maximum(dr.abs(hit.p.x), dr.abs(hit.p.y)), dr.abs(hit.p.z)) + hit.t
    return Ray(mi.Point3d(hit.p), mi.Vector3d(d), hit.object, hit.record, inside, reach * (ERROR_BOUND * EPSILON))


def sphere_distance(center: Any, radius: Any, ray: Ray, own: Any) -> Any:
    """Distance to a sphere, infinite or NaN for none (compare with <); `own` where the ray starts on it.

    Haines, Gunther and Akenine-Moller, Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems ch. 7.
    """
    f = ray.o - center
    b = -dr.dot(f, ray.d)
    discriminant = radius * radius - dr.squared_norm(f + b * ray.d)
    root = dr.sqrt(discriminant)  # NaN where the ray misses: no comparison with it holds
    q = b + dr.copysign(root, b)
    other = (dr.squared_norm(f) - radius * radius) / q
    near, far = dr.minimum(q, other), dr.maximum(q, other)
    t_other = dr.select(near > ray.t_min, near, dr.select(far > ray.t_min, far, dr.inf))
    # A ray that starts on this sphere leaves it for good, or crosses it to the far root.
    t_own = dr.select(ray.inside & (far > 0), far, dr.inf)
    return dr.select(own, t_own, t_other)


def unit(v: Any) -> Any:
    """`v` over its length; dr.normalize multiplies by a reciprocal root instead and loses a digit."""
    return v / dr.norm(v)


def reflect(d: Any, n: Any) -> Any:
    """Mirror direction of `d` at a surface of unit normal `n`, either side."""
    return unit(d - n * (2 * dr.dot(d, n)))


def refract(d: Any, n: Any, eta: Any) -> tuple[Any, Any]:
    """Snell's law: direction behind a surface whose unit normal `n` is against `d`, and whether reflection is total.

    `eta` is the index on d's side over the index behind. Past the critical angle the direction is the mirrored one.
    """
    cosine = -dr.dot(d, n)
    cosine2 = 1 - eta * eta * (1 - cosine * cosine)
    total = cosine2 < 0
    through = unit(d * eta + n * (eta * cosine - dr.sqrt(dr.maximum(cosine2, 0))))
    return dr.select(total, reflect(d, n), through), total


def power(base: Any, exponent: Any) -> Any:
    """Base ** exponent for 0 <= base <= 1 and exponent >= 0, with 0 ** 0 = 1 as in C.

    Not dr.power: of Dr.Jit 1.5's exp2 in double precision the results between 2^-1022 and 2^-1024 are infinite.
    """
    return dr.select(exponent == 0, 1, dr.exp2(dr.maximum(exponent * dr.log2(base), -1000)))
