"""How near a ray is to meeting something else: to a silhouette, to an edge, to the next tile.

A margin is the length, in scene units, by which the ray or a surface would have to be moved for that. Two planes that a
ray crosses at distances t and u change places, or begin or cease to have a way between them, when both are moved by
|t - u| / (1 / |cosine| + 1 / |other cosine|), cosines being those between the ray and their normals.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Polyhedron, Shape, Sphere
from native_tracer.halfspaces import polyhedron_facts

Floats = NDArray[np.float64]
INFINITE = math.inf


class Crossing(NamedTuple):
    """Where a line crosses a surface: the distance, and the cosine between its direction and the normal there."""

    t: float
    cosine: float


def crossings(shape: Shape, origin: Floats, direction: Floats) -> list[Crossing]:
    """Where a line enters and leaves a shape; of a ball that it misses, where it comes nearest."""
    if isinstance(shape, Sphere):
        along, across = _nearest(shape, origin, direction)
        half = math.sqrt(max(shape.radius**2 - across**2, 0.0))
        return [Crossing(along - half, -half / shape.radius), Crossing(along + half, half / shape.radius)]
    t, cosine, _ = _planes(shape, origin, direction)
    enters, leaves = np.where(cosine < 0, t, -np.inf), np.where(cosine > 0, t, np.inf)
    found = []
    for k in (int(enters.argmax()), int(leaves.argmin())):
        if np.isfinite(t[k]):
            found.append(Crossing(float(t[k]), float(cosine[k])))
    return found


def silhouette_margin(shape: Shape, origin: Floats, direction: Floats) -> float:
    """From the line of a ray to where it begins, or ceases, to meet a shape."""
    if isinstance(shape, Sphere):
        _, across = _nearest(shape, origin, direction)
        return abs(across - shape.radius)
    t, cosine, height = _planes(shape, origin, direction)
    beside = float(np.abs(height[cosine == 0]).min(initial=INFINITE))
    enters, leaves = cosine < 0, cosine > 0
    if not enters.any() or not leaves.any():
        return beside
    slack = 1 / np.abs(cosine[leaves])[None] + 1 / np.abs(cosine[enters])[:, None]
    # The least of them ends the way through the body; where there is none, the least is negative, and begins it.
    return min(beside, abs(float(((t[leaves][None] - t[enters][:, None]) / slack).min())))


def edge_margin(shape: Shape, origin: Floats, direction: Floats) -> float:
    """From the line of a ray, where it enters and leaves a polyhedron, to the next face."""
    if isinstance(shape, Sphere):
        return INFINITE
    t, cosine, _ = _planes(shape, origin, direction)
    result = INFINITE
    for side in (-1, 1):
        among = cosine * side > 0
        if among.sum() > 1:
            way, slack = side * t[among], 1 / np.abs(cosine[among])
            first = int(way.argmin())
            margins = (way - way[first]) / (slack + slack[first])
            result = min(result, float(np.delete(margins, first).min()))
    return result


def surface_margin(shape: Shape, p: Floats, on_it: bool) -> float:
    """From a point to the surface of a shape; if it lies on that, to the next face."""
    if isinstance(shape, Sphere):
        return INFINITE if on_it else abs(math.dist(shape.center, p) - shape.radius)
    _, _, height = _planes(shape, p, np.zeros(3))
    if on_it:
        return float(np.sort(np.abs(height))[1]) if len(height) > 1 else INFINITE
    return abs(float(height.max()))


def tie_margin(a: Crossing, b: Crossing) -> float:
    """From two surfaces that a ray crosses to where it crosses them in the other order."""
    if a.cosine == 0 or b.cosine == 0:
        return 0.0
    return abs(a.t - b.t) / (1 / abs(a.cosine) + 1 / abs(b.cosine))


def _nearest(ball: Sphere, origin: Floats, direction: Floats) -> tuple[float, float]:
    """How far along a line it comes nearest to a ball's centre, and how near."""
    to_center = np.array(ball.center) - origin
    along = float(to_center @ direction)
    return along, float(np.linalg.norm(to_center - along * direction))


def _planes(shape: Shape, origin: Floats, direction: Floats) -> tuple[Floats, Floats, Floats]:
    """For each plane where a line crosses it (infinite or NaN: nowhere), the cosine, and the origin's height above."""
    assert not isinstance(shape, Sphere)
    planes = _unit_planes(shape)
    cosine, height = planes[:, :3] @ direction, planes[:, :3] @ origin + planes[:, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        return -height / cosine, cosine, height


@lru_cache(maxsize=64)
def _unit_planes(polyhedron: Polyhedron) -> Floats:
    """(n, 4), with normals of length 1; of a plate without thickness, whose sides are at one place, the first one."""
    planes = np.array(polyhedron.planes)
    if back := polyhedron_facts([polyhedron.planes])[0].plate[1:]:
        planes = np.delete(planes, back, axis=0)
    unit: Floats = planes / np.linalg.norm(planes[:, :3], axis=1)[:, None]
    return unit
