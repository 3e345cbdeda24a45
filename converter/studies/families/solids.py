"""Pictures of csgs by a closed form, in long double: where a ray crosses convex bodies, and what it is inside between.

Bodies are few and convex, so that each is a stretch of the ray.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Finish, Plane, Polyhedron, Sphere, Vector
from converter.studies.families.closed_forms import Long, dot, long, unit
from converter.studies.family import Truth

Masks = NDArray[np.bool_]
Inside = Callable[[Sequence[Masks]], Masks]
"""Of a csg, from of which bodies points are inside."""
START = 1e-12
"""Up to this distance a ray has not left the surface that it starts on."""


class Passage(NamedTuple):
    """Of rays through a convex body: (...) where they enter and leave it, infinite if they miss it, and (..., 3) the
    body's outward unit normals there.
    """

    enter: Long
    leave: Long
    entered: Long
    left: Long


def passage(body: Sphere | Polyhedron, origin: Long, d: Long) -> Passage:
    """Through a ball or a polyhedron, of rays from (..., 3) origins along (..., 3) unit directions."""
    if isinstance(body, Sphere):
        return _through_ball(body, origin, d)
    return _through_planes(body.planes, origin, d)


def _through_ball(ball: Sphere, origin: Long, d: Long) -> Passage:
    center, radius = long(ball.center), np.longdouble(ball.radius)
    f = origin - center
    across = np.cross(f, d)
    b, rest = dot(f, d), radius * radius - dot(across, across)
    root = np.sqrt(np.maximum(rest, 0))
    enter, leave = (np.where(rest > 0, -b + side * root, np.inf) for side in (-1, 1))
    entered, left = ((f + np.where(rest > 0, t, 0)[..., None] * d) / radius for t in (enter, leave))
    return Passage(enter, leave, entered, left)


def _through_planes(planes: Sequence[Plane], origin: Long, d: Long) -> Passage:
    shape = d.shape[:-1]
    enter = np.full(shape, -np.inf, dtype=np.longdouble)
    leave = np.full(shape, np.inf, dtype=np.longdouble)
    entered, left = np.zeros_like(d), np.zeros_like(d)
    for plane in planes:
        n = long(plane[:3])
        length = np.sqrt(dot(n, n))
        slope, height = dot(d, n), dot(origin, n) + np.longdouble(plane[3])
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -height / slope
        later, sooner = (slope < 0) & (t > enter), (slope > 0) & (t < leave)
        enter, leave = np.where(later, t, enter), np.where(sooner, t, leave)
        entered = np.where(later[..., None], n / length, entered)
        left = np.where(sooner[..., None], n / length, left)
    misses = enter >= leave
    return Passage(np.where(misses, np.inf, enter), np.where(misses, np.inf, leave), entered, left)


@np.errstate(invalid="ignore")  # distances are infinite where there is nothing
def first_surface(passages: Sequence[Passage], inside: Inside, start: float = 0.0) -> tuple[Long, Long]:
    """Where rays first come to be inside of a csg, or outside: (...) distances above `start`, infinite for none, and
    (..., 3) unit normals of the surface there, of either sign.
    """
    distances = np.stack([t for p in passages for t in (p.enter, p.leave)])
    normals = np.stack([n for p in passages for n in (p.entered, p.left)])
    distances = np.where(distances > start, distances, np.inf)
    order = np.argsort(distances, axis=0)
    sorted_ = np.take_along_axis(distances, order, axis=0)
    before = np.broadcast_to(np.longdouble(start), sorted_[0].shape)
    found = np.full(before.shape, np.inf, dtype=np.longdouble)
    which = np.zeros(before.shape, dtype=np.intp)
    first = np.where(np.isfinite(sorted_[0]), sorted_[0], before + 1)
    was = _inside_at(passages, inside, (before + first) / 2)
    for k, t in enumerate(sorted_):
        beyond = sorted_[k + 1] if k + 1 < len(sorted_) else np.full_like(t, np.inf)
        is_ = _inside_at(passages, inside, np.where(np.isfinite(beyond), t + (beyond - t) / 2, t + 1))
        changes = np.isfinite(t) & (beyond > t) & (is_ != was) & np.isinf(found)
        found, which = np.where(changes, t, found), np.where(changes, order[k], which)
    normal = np.take_along_axis(normals, which[None, ..., None], axis=0)[0]
    return found, normal


def _inside_at(passages: Sequence[Passage], inside: Inside, t: Long) -> Masks:
    return inside([(p.enter < t) & (t < p.leave) for p in passages])


def lit_solid(
    bodies: Sequence[Sphere | Polyhedron], inside: Inside, eye: Vector, d: Long, light: Vector, finish: Finish
) -> Truth:
    """The picture of a white csg before black, seen from outside, under a white ambient light and an undimmed white
    light; it shades itself.
    """
    origin, lamp = np.broadcast_to(long(eye), d.shape), long(light)
    t, normal = first_surface([passage(body, origin, d) for body in bodies], inside)
    hit = np.isfinite(t)
    p = origin + np.where(hit, t, 0)[..., None] * d
    normal = np.where((dot(normal, d) > 0)[..., None], -normal, normal)
    arm = lamp - p
    to_light = unit(arm)
    cosine = np.maximum(dot(normal, to_light), 0)
    blocked, _ = first_surface([passage(body, p, to_light) for body in bodies], inside, START)
    shaded = blocked < np.sqrt(dot(arm, arm))
    value = np.where(hit, finish.ka + np.where(shaded, 0, finish.kd * cosine), 0).astype(np.float64)
    return np.repeat(value[..., None], 3, axis=-1)
