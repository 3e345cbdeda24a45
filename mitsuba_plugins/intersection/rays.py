"""Rays and hits, and the rules that keep a ray from hitting the surface it starts on.

The rules are the native tracer's. A ray knows the object and the primitive that it starts on and whether it travels
inside that object, so that where it starts is excluded by knowledge and not by a distance. Other surfaces count from
`t_min` on, a bound on the rounding error of the origin (Pharr, Jakob and Humphreys, Physically Based Rendering, 4th
edition, section 6.8, gives the reasoning).

Everything here works in single and in double precision, whichever its arguments have.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.rounding import bounds_all, epsilon, least_spread, most_blur

NOTHING = 0xFFFFFFFF
"""Object index of a ray that starts on no surface, and of a hit that is none."""

INVERTED = 0x80000000
"""Bit of a primitive's index: it is the surface of an object, a csg, by its other side."""
UPRIGHT = INVERTED - 1
"""The other bits."""

ERROR_BOUND = 64
"""Roundings, generously, between a ray's numbers and the point on it: `t_min` in units of half an ulp of 1."""


@dataclass
class Real:
    """The types of one precision."""

    Float: Any
    Point3: Any
    Vector3: Any
    Vector4: Any
    Color3: Any


def real(precision: str) -> Real:
    """The types of "double" or of single precision, "float"."""
    if precision == "double":
        return Real(mi.Float64, mi.Point3d, mi.Vector3d, mi.Vector4d, mi.Color3d)
    return Real(mi.Float, mi.Point3f, mi.Vector3f, mi.Vector4f, mi.Color3f)


@dataclass
class Ray:
    """A ray: origin, unit direction, and what it starts on."""

    o: Any  # Point3
    d: Any  # Vector3
    object: Any  # UInt32, NOTHING for a primary ray, as is `primitive`
    primitive: Any  # UInt32, the sphere or plane that o lies on, see `primitives`
    inside: Any  # Bool, whether the ray travels inside `object`
    t_min: Any  # Float, how far o may be off; a hit on anything but `object` is farther
    spread: Any  # Float, how far d may be off, see `rounding`
    time: Any = None  # Float from 0 to 1, where something moves
    shift: Any = None  # Float, how far o may be off along the ray, and `t_min` is across it, where all is bounded


@dataclass
class Hit:
    """What a ray met: distance, object, primitive, the point on that, and its unit normal, which points out."""

    valid: Any  # Bool
    t: Any  # Float
    object: Any  # UInt32
    primitive: Any  # UInt32, see `primitives`
    p: Any  # Point3
    n: Any  # Vector3, outward
    inside: Any  # Bool, whether the ray came from inside the object
    off: Any  # Float, how far ray and surface may be off from one another there
    error: Any  # Float, how far p may be off
    lean: Any  # Float, how far n may be off
    undecided: Any = False  # Bool, whether the ray came close to a tie that nobody has decided
    place: Any = None  # Point3, where p is on the object at time 0, where something moves
    time: Any = None  # Float, the ray's

    @property
    def p_at_rest(self) -> Any:
        """Where p is on the object at time 0, as its pigment is told."""
        return self.p if self.place is None else self.place


def ray_reach(ray: Ray) -> Any:
    """The largest coordinate or distance that went into the origin of a ray, 0 for a primary one."""
    return quotient(ray.t_min, ERROR_BOUND * dr.epsilon(ray.t_min))


def start_ray(types: Real, o: Any, d: Any, error: Any = 0, spread: Any = 0) -> Ray:
    """A ray that starts on no surface, at full width, as Dr.Jit's loops and local buffers want it.

    Its origin may be off by `error`, and its direction by `spread` besides its roundings.
    """
    width = dr.width(d)
    return Ray(
        o=types.Point3(o) + dr.zeros(types.Point3, width),
        d=types.Vector3(d),
        object=dr.full(mi.UInt32, NOTHING, width),
        primitive=dr.full(mi.UInt32, NOTHING, width),
        inside=dr.full(mi.Bool, False, width),
        t_min=dr.zeros(types.Float, width) + error,
        spread=dr.full(types.Float, _start_spread(types.Float), width) + spread,
        shift=dr.zeros(types.Float, width) + error if bounds_all(types.Float) else None,
    )


def _start_spread(number: Any) -> float:
    """Of a direction that is rounded once where everything is bounded, and of its products with others."""
    return 2 * epsilon(number) if bounds_all(number) else least_spread(number)


def lanes(width: int) -> Any:
    """Mask of the rays that exist, which the masks of all searches and loops come from.

    The last SIMD packet of a wavefront is filled up with lanes that hold garbage. They answer comparisons, but no ray
    is traced for them, so that a loop that waits until each has found something may wait for ever.
    """
    # Opaque, so that wavefronts of different widths share one kernel.
    return dr.arange(mi.UInt32, width) < dr.opaque(mi.UInt32, width)


def spawn(hit: Hit, d: Any, inside: Any, spread: Any) -> Ray:
    """The ray that leaves `hit` in direction `d`, which may be off by `spread`, on the given side of the object."""
    return Ray(hit.p, d, hit.object, hit.primitive, inside, hit.error, spread, hit.time)


def origin_error(p: Any, t: Any) -> Any:
    """A bound of the rounding error of a point that was found at distance `t` of its ray."""
    reach = largest(p) + t
    if bounds_all(reach):
        return reach * (3 * epsilon(reach))
    return reach * (ERROR_BOUND * dr.epsilon(reach))


def largest(p: Any) -> Any:
    """The largest coordinate of a point, without its sign."""
    return dr.maximum(dr.maximum(dr.abs(p.x), dr.abs(p.y)), dr.abs(p.z))


def unit(v: Any) -> Any:
    """`v` times the reciprocal of its length, as in the native tracer; dr.normalize's reciprocal root loses a digit."""
    return v * quotient(1, dr.norm(v))


def reflect(d: Any, n: Any) -> Any:
    """Mirror direction of `d` at a surface of unit normal `n`, either side."""
    return unit(d - n * (2 * dr.dot(d, n)))


def shadow_spread(error: Any, distance: Any) -> Any:
    """How far the direction to a light may be off, whose ends may together be off by `error`."""
    turn = quotient(error, distance)
    return dr.minimum(least_spread(distance) + turn, most_blur(distance))


def mirrored_spread(ray: Ray, hit: Hit) -> Any:
    """How far the direction of a mirrored ray may be off."""
    return dr.minimum(ray.spread + 2 * hit.lean + least_spread(ray.spread), most_blur(ray.spread))


def refract(d: Any, n: Any, eta: Any, error: Any = 0, lean: Any = 0) -> tuple[Any, Any, Any]:
    """Snell's law: direction behind a surface whose unit normal `n` is against `d`, whether reflection is total, and
    how far the direction may be off where it is not.

    `eta` is the index on d's side over the index behind; direction and normal together may be off by `error`, of
    which the normal by `lean`. Past the critical angle the direction is the mirrored one; at that angle the ray is
    refracted along the surface.
    """
    cosine = -dr.dot(d, n)
    # 1 - eta^2 (1 - cosine^2), without the difference of nearly equal numbers where eta is nearly 1.
    cosine2 = (1 - eta) * (1 + eta) + dr.square(eta * cosine)
    rounding = 4 * epsilon(cosine)
    critical = eta * eta * (2 * cosine * error + rounding) + rounding
    cosine2 = dr.select(dr.abs(cosine2) <= critical, 0, cosine2)
    through = d * eta + n * (eta * cosine - dr.sqrt(dr.maximum(cosine2, 0)))
    length = dr.norm(through)
    total = ~((cosine2 >= 0) & (length > 0))  # of a ratio beyond all measure these may be no numbers, or 0
    # In the plane of incidence it is more near the critical angle; across it, it is not.
    spread = dr.minimum(2 * error * (1 + eta) + least_spread(cosine), most_blur(cosine))
    if bounds_all(cosine):
        # In the plane of incidence, where it is the most; at the critical angle infinite, so nothing is known beyond.
        behind, least = dr.sqrt(dr.abs(cosine2)), dr.sqrt(dr.maximum(cosine2 - critical, 0))
        turned = dr.abs(eta * cosine - behind) + (behind - least)
        spread = quotient(eta * (error - lean) + turned * lean + least_spread(cosine) * (1 + eta), least)
        spread = dr.select(least == 0, dr.inf, spread)
    return dr.select(total, reflect(d, n), through * quotient(1, length)), total, spread


def power(base: Any, exponent: Any) -> Any:
    """Base ** exponent for 0 <= base <= 1 and exponent >= 0, with 0 ** 0 = 1 as in C.

    Not dr.power: of Dr.Jit 1.5's exp2 in double precision the results between 2^-1022 and 2^-1024 are infinite.
    """
    least = -1000 if dr.type_v(base) == dr.VarType.Float64 else -125
    return dr.select(exponent == 0, 1, dr.exp2(dr.maximum(exponent * dr.log2(base), least)))
