"""Quadrics that rays graze, that are needles, and that are nearly of another kind."""

import math

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Quadric
from converter.studies.families.closed_forms import Long, directions, dot, long, two_colors, unit
from converter.studies.families.scenes import BLACK, GLOW, MATTE, WHITE, camera, light, scene, settings
from converter.studies.family import Case, Family, Truth

_SETTINGS = settings()
DECADES = tuple(10.0**-power for power in range(15))
"""1 to 1e-14."""


def _edge(off: float) -> Case:
    """Of an oblique ellipsoid, which touches the plane y = 1 in (0, 1, 0); the eye is in that plane.

    With y = 1 + u it is A x^2 + B u^2 + C z^2 + D x u + E x z + F u z + 2 B u. Along a ray from (0, 0, 4), in these
    coordinates, all terms of b^2 - a c with z^2 cancel, and what is left is small of the order of u and x^2.
    """
    a, b, c, d, e, f, distance = 2.0, 1.0, 3.0, 1.0, -1.0, 0.5, 4.0
    body = Quadric((a, b, c, d, e, f, -d, 0.0, -f, -b))
    view = camera((0.0, 1.0, distance), (0.0, 1.0, 0.0), math.degrees(2 * math.atan(off / distance)))
    x, u, z = np.moveaxis(directions(view, _SETTINGS), -1, 0)
    slope = 2 * b * u + distance * (e * x + f * u)
    across = slope * slope / 4 - c * distance**2 * (a * x * x + b * u * u + d * x * u)
    hit = 2 * b * c * distance * u * z + across > 0
    made = scene(view, [(body, WHITE, GLOW)])
    return Case(made, _SETTINGS, two_colors(hit, WHITE, BLACK))


def _needle(width: float) -> Case:
    """A cone about the z-axis, x^2 + y^2 = width^2 z^2, from the side, with the light at the eye.

    Across the axis all lengths are of the order of `width`: as a sum of squares of moments, by Lagrange's identity, the
    discriminant keeps its digits.
    """
    eye = (4.0, 1.0, 2.0)
    view = camera(eye, (0.0, 0.0, 0.75), math.degrees(2 * math.atan(0.25 * width)), (0.0, 0.0, 1.0))
    d, o, w2 = directions(view, _SETTINGS), long(eye), np.longdouble(width) ** 2
    bends = np.stack([o[0] ** 0, o[0] ** 0, -w2])
    moment = np.cross(o, d)
    rest = w2 * (moment[..., 0] ** 2 + moment[..., 1] ** 2) - moment[..., 2] ** 2
    b = dot(bends * o, d)
    t = dot(bends * o, o) / (np.sqrt(np.maximum(rest, 0)) - b)
    n = unit(bends * (o + t[..., None] * d))
    cone = Quadric((1.0, 1.0, -float(w2), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    made = scene(view, [(cone, WHITE, MATTE)], [light(eye)])
    return Case(made, _SETTINGS, _headlit((rest > 0) & (t > 0), n, d))


def _nearly_parabolic(bend: float) -> Case:
    """x^2 + z^2 + y about x = -1.25 with `bend` y^2 more, and about x = 1.25 with as much less."""
    eye = (0.75, 2.0, 6.0)
    view = camera(eye, (0.0, -0.75, 0.0), 40.0)
    d = directions(view, _SETTINGS)
    bodies = [Quadric((1.0, side * bend, 1.0, 0.0, 0.0, 0.0, side * 2.5, 1.0, 0.0, 1.5625)) for side in (1.0, -1.0)]
    nearest = np.full(d.shape[:2], np.inf, dtype=np.longdouble)
    normal = np.zeros_like(d)
    for body in bodies:
        t, n = _quadric_hit(body, long(eye), d)
        normal = np.where((t < nearest)[..., None], n, normal)
        nearest = np.minimum(nearest, t)
    made = scene(view, [(body, WHITE, MATTE) for body in bodies], [light(eye)])
    return Case(made, _SETTINGS, _headlit(np.isfinite(nearest), normal, d))


def _quadric_hit(body: Quadric, o: Long, d: Long) -> tuple[Long, Long]:
    """(...) distances of the first hits ahead of a point that is outside, infinite for none, and (..., 3) normals."""
    bends, linear = long(body.coefficients[:3]), long(body.coefficients[6:9])
    a = dot(bends * d, d)
    b = dot(bends * o + linear / 2, d)
    c = dot(bends * o + linear, o) + np.longdouble(body.coefficients[9])
    with np.errstate(all="ignore"):
        root = np.sqrt(b * b - a * c)
        q = -(b + np.where(b < 0, -root, root))
        roots = np.stack([q / a, c / q])
    t = np.where(roots > 0, roots, np.inf).min(axis=0)
    p = o + np.where(np.isfinite(t), t, 0)[..., None] * d
    return t, unit(bends * p + linear / 2)


def _headlit(hit: NDArray[np.bool_], normal: Long, d: Long) -> Truth:
    """The picture of white matte things before black, lit from the eye, so that there is no shadow."""
    value = np.where(hit, MATTE.ka + MATTE.kd * np.abs(dot(normal, d)), 0).astype(np.float64)
    return np.repeat(value[..., None], 3, axis=-1)


FAMILIES: tuple[Family, ...] = (
    Family(
        "quadric-edge",
        "Rays that pass the edge of an oblique ellipsoid at less and less distance on either side: half of them hit.",
        "distance of the outermost rays from the edge",
        tuple(10.0**-power for power in (1, 2, 3, 4, 6, 8, 10, 12, 13, 14)),
        _edge,
    ),
    Family(
        "needles",
        "A cone is made ever sharper, and seen through an ever longer lens.",
        "tangent of the angle between axis and side",
        DECADES,
        _needle,
    ),
    Family(
        "nearly-parabolic",
        "An ellipsoid is made ever longer, and a hyperboloid ever flatter, until both are nearly paraboloids.",
        "bend along the axis over the bend across",
        DECADES,
        _nearly_parabolic,
    ),
)
