"""What a polyhedron's module answers by arrays of planes."""

import math
from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Plane, Polyhedron, Vector
from converter.shapes.kind import Intersection
from native_tracer.halfspaces import polyhedron_facts

Floats = NDArray[np.float64]


def farthest_plane(planes: Sequence[Plane], point: Vector) -> float:
    """The largest distance of a point from a plane, whichever side it is on; 0 where there is none."""
    rows = np.reshape(planes, (-1, 4))
    rows = rows / np.abs(rows[:, :3]).max(axis=1, keepdims=True)  # normals may have any length
    return float(np.abs(rows @ [*point, 1] / np.linalg.norm(rows[:, :3], axis=1)).max(initial=0))


def intersections(shape: Polyhedron, origin: Floats, direction: Floats) -> list[Intersection]:
    """Where a line enters and leaves, as far as it does."""
    t, cosine, _ = _meet(shape, origin, direction)
    enters, leaves = np.where(cosine < 0, t, -np.inf), np.where(cosine > 0, t, np.inf)
    found = []
    for k in (int(enters.argmax()), int(leaves.argmin())):
        if np.isfinite(t[k]):
            found.append(Intersection(float(t[k]), float(cosine[k])))
    return found


def silhouette_margin(shape: Polyhedron, origin: Floats, direction: Floats) -> float:
    """From the line of a ray to where it begins, or ceases, to have a way through."""
    t, cosine, distance = _meet(shape, origin, direction)
    beside = float(np.abs(distance[cosine == 0]).min(initial=math.inf))
    enters, leaves = cosine < 0, cosine > 0
    if not enters.any() or not leaves.any():
        return beside
    slack = 1 / np.abs(cosine[leaves])[None] + 1 / np.abs(cosine[enters])[:, None]
    # The least of them ends the way through the body; where there is none, the least is negative, and begins it.
    return min(beside, abs(float(((t[leaves][None] - t[enters][:, None]) / slack).min())))


def edge_margin(shape: Polyhedron, origin: Floats, direction: Floats) -> float:
    """From the line of a ray, where it enters and leaves, to the next face."""
    t, cosine, _ = _meet(shape, origin, direction)
    result = math.inf
    for side in (-1, 1):
        among = cosine * side > 0
        if among.sum() > 1:
            way, slack = side * t[among], 1 / np.abs(cosine[among])
            first = int(way.argmin())
            margins = (way - way[first]) / (slack + slack[first])
            result = min(result, float(np.delete(margins, first).min()))
    return result


def surface_margin(shape: Polyhedron, p: Floats, on_it: bool) -> float:
    """From a point to the surface; if it lies on that, to the next face."""
    _, _, distance = _meet(shape, p, np.zeros(3))
    if on_it:
        return float(np.sort(np.abs(distance))[1]) if len(distance) > 1 else math.inf
    return abs(float(distance.max()))


def _meet(shape: Polyhedron, origin: Floats, direction: Floats) -> tuple[Floats, Floats, Floats]:
    """For each plane where a line meets it (infinite or NaN: nowhere), the cosine, and the origin's signed distance."""
    planes = _unit_planes(shape)
    cosine, distance = planes[:, :3] @ direction, planes[:, :3] @ origin + planes[:, 3]
    with np.errstate(divide="ignore", invalid="ignore"):
        return -distance / cosine, cosine, distance


@lru_cache(maxsize=64)
def _unit_planes(polyhedron: Polyhedron) -> Floats:
    """(n, 4), with normals of length 1; of a plate without thickness, whose sides are at one place, the first one."""
    planes = np.array(polyhedron.planes)
    if back := polyhedron_facts([polyhedron.planes])[0].plate[1:]:
        planes = np.delete(planes, back, axis=0)
    unit: Floats = planes / np.linalg.norm(planes[:, :3], axis=1)[:, None]
    return unit
