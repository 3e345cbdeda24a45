"""A pixel's rays as lines in the picture."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from converter.renderers.records import RayKind, RayRecord
from converter.scene.model import Camera

MOST_LINES = 1000
"""Of a pixel: a tree may have many more rays, and these are those nearest to the eye."""
NEAR = 1e-3
"""Share of the distance from the eye to the look-at point, before which nothing is drawn."""
FAR = 1e4
"""Distances from the eye to the look-at point that a ray is drawn for which hits nothing."""

Place = tuple[float, float, float]
"""Right, down and forward of the eye: the first two at distance 1, in half picture heights."""


@dataclass(frozen=True, slots=True)
class Line:
    """A ray in the picture: its kind and bounces before it, and its ends in pixels from the picture's top left."""

    kind: RayKind
    depth: int
    x0: float
    y0: float
    x1: float
    y1: float


def ray_lines(rays: Sequence[RayRecord], camera: Camera, width: int, height: int) -> list[Line]:
    """The secondary rays of a pixel, those with fewer bounces first. A primary ray would be a point."""
    place, unit = _view(camera)
    lines: list[Line] = []
    level = list(rays)
    while level and len(lines) < MOST_LINES:
        for ray in level:
            if ray.depth and (line := _line(ray, place, unit, width, height)):
                lines.append(line)
        level = [child for ray in level for child in ray.children]
    return lines[:MOST_LINES]


def _line(
    ray: RayRecord, place: Callable[[Sequence[float]], Place], unit: float, width: int, height: int
) -> Line | None:
    if ray.hit is not None:
        end: Sequence[float] = ray.hit.point
    else:
        end = [o + FAR * unit * d for o, d in zip(ray.origin, ray.direction, strict=True)]
    ends = _before_the_eye(place(ray.origin), place(end), NEAR * unit)
    if ends is None:
        return None
    points = [(width / 2 + x / z * height / 2, height / 2 + y / z * height / 2) for x, y, z in ends]
    if not all(math.isfinite(c) for point in points for c in point):
        return None
    (x0, y0), (x1, y1) = points
    return Line(ray.kind, ray.depth, x0, y0, x1, y1)


def _before_the_eye(a: Place, b: Place, near: float) -> tuple[Place, Place] | None:
    """The part of a line that is at least so far before the eye; None if there is none."""
    if a[2] < near and b[2] < near:
        return None
    if a[2] < near:
        return _cut(a, b, near), b
    return (a, _cut(b, a, near)) if b[2] < near else (a, b)


def _cut(behind: Place, before: Place, near: float) -> Place:
    share = (near - behind[2]) / (before[2] - behind[2])
    x, y = (p + share * (q - p) for p, q in zip(behind[:2], before[:2], strict=True))
    return (x, y, near)


def _view(camera: Camera) -> tuple[Callable[[Sequence[float]], Place], float]:
    """Gives a point's place, and the distance from the eye to the look-at point."""
    forward = [a - e for a, e in zip(camera.look_at, camera.eye, strict=True)]
    unit = math.hypot(*forward)
    forward = [c / unit for c in forward]
    right = _normalised(_cross(forward, camera.up))
    down = _cross(forward, right)
    scale = 1 / math.tan(math.radians(camera.fovy) / 2)

    def place(point: Sequence[float]) -> Place:
        offset = [p - e for p, e in zip(point, camera.eye, strict=True)]
        x, y, z = (sum(a * b for a, b in zip(axis, offset, strict=True)) for axis in (right, down, forward))
        return (scale * x, scale * y, z)

    return place, unit


def _cross(a: Sequence[float], b: Sequence[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _normalised(v: Sequence[float]) -> list[float]:
    length = math.hypot(*v)
    return [c / length for c in v]
