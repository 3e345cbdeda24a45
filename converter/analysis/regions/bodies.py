"""Bodies that are small: next to their coordinates, their distance, or what they rest on; and those that are thin."""

from collections.abc import Iterator

import numpy as np

from converter.analysis.regions.region import Finding, Region, worst
from converter.analysis.regions.situation import Floats, Situation
from converter.shapes.table import shape_kind

MOST_PLANES = 256
"""Of a body that is looked into for how thin it is."""


def _object(s: Situation, index: int, text: str) -> Finding:
    return Finding(s.scene.objects[index].line, f"object {index} {text}")


def _far_from_origin(s: Situation, limit: float) -> Iterator[Finding]:
    shares = s.bodies.radius / np.abs(s.bodies.center).max(axis=1, initial=0.0)
    for k, more in worst(shares, limit):
        text = f"is {1 / shares[k]:.2g} of its radii from the origin (more than {1 / limit:.2g}{more})"
        yield _object(s, s.bodies.object[k], text)


def _far_from_camera(s: Situation, limit: float) -> Iterator[Finding]:
    shares = s.bodies.radius / np.linalg.norm(s.bodies.center - s.eye, axis=1)
    for k, more in worst(shares, limit):
        text = f"is {1 / shares[k]:.2g} of its radii from the camera (more than {1 / limit:.2g}{more})"
        yield _object(s, s.bodies.object[k], text)


def _beside_smaller(s: Situation, limit: float) -> Iterator[Finding]:
    """Balls next to the smallest one. One that holds it, a sky, touches nothing."""
    balls = np.flatnonzero(s.bodies.is_ball)
    if not len(balls):
        return
    center, radius, index = s.bodies.center[balls], s.bodies.radius[balls], s.bodies.object[balls]
    small = int(radius.argmin())
    apart = np.linalg.norm(center - center[small], axis=1) >= radius
    for k, more in worst(np.where(apart, radius[small] / radius, np.inf), limit):
        text = f"has {radius[k] / radius[small]:.2g} times the radius of object {index[small]}"
        yield _object(s, index[k], f"{text} (more than {1 / limit:.2g}{more})")


def _large(s: Situation, limit: float) -> Iterator[Finding]:
    bodies = np.abs(s.bodies.center).max(axis=1, initial=0.0) + s.bodies.radius
    far = np.zeros(len(s.scene.objects))
    np.maximum.at(far, s.bodies.object, bodies)
    np.maximum.at(far, s.planes.object, np.abs(s.planes.offset))
    shares = 1 / far
    for i, more in worst(shares, limit):
        yield _object(s, i, f"is {far[i]:.2g} from the origin (more than {1 / limit:.2g}{more})")


def _small(s: Situation, limit: float) -> Iterator[Finding]:
    for k, more in worst(s.bodies.radius, limit):
        text = f"has a radius of {s.bodies.radius[k]:.2g} (less than {limit:.2g}{more})"
        yield _object(s, s.bodies.object[k], text)


def _thin_glass(s: Situation, limit: float) -> Iterator[Finding]:
    shares = np.full(len(s.scene.objects), np.inf)
    for i in range(len(s.scene.objects)):
        looked_into = 0 < len(s.needs.planes[i]) <= MOST_PLANES
        if s.finish(i).kt > 0 and s.needs.bounded[i] and not s.needs.plates[i] and looked_into:
            shares[i] = _thickness(s, i)
    for i, more in worst(shares, limit):
        text = f"is transparent and {shares[i]:.2g} thick, next to its coordinates and the camera's"
        yield _object(s, i, f"{text} (less than {limit:.2g}{more})")


def _clear_plates(s: Situation, _: float) -> Iterator[Finding]:
    """Glass without thickness: rays that start off its surface start beyond its other side, too."""
    for i, plate in enumerate(s.needs.plates):
        if plate and s.finish(i).kt > 0 and s.needs.refracts:
            yield _object(s, i, "is transparent and has no thickness")


def _thickness(s: Situation, index: int) -> float:
    """Of a polyhedron between the planes where it is least, over the largest coordinate of its corners and the eye."""
    from native_tracer.halfspaces import polyhedron_faces

    shape = s.scene.objects[index].shape
    planes = shape_kind(shape).planes(shape)
    points = [p for face in polyhedron_faces([planes[k] for k in s.needs.planes[index]]) for p in face.points]
    if not points:
        return np.inf
    corners: Floats = np.array(points).reshape(-1, 3)
    needed = s.planes_of(index)
    depths = (corners @ needed.normal.T + needed.offset).min(axis=0)
    return float(-depths.max() / max(np.abs(corners).max(), s.reach))


REGIONS = (
    Region(
        ("position",),
        {"double": 3e-12, "float": 2e-4, "mesh": 2e-4, "offset": 0.2, "ulp": 0.2},
        _far_from_origin,
    ),
    Region(("distance",), {"float": 1e-5, "offset": 1e-3, "ulp": 1e-2}, _far_from_camera),
    Region(("huge",), {"float": 1e-5, "mesh": 1e-3, "offset": 1e-3, "ulp": 1.0}, _beside_smaller),
    Region(
        ("size", "light-on-floor", "light-on-ball"),
        {"double": 1e-151, "float": 1e-18, "mesh": 5e-10, "offset": 1e-5, "ulp": 1e-5},
        _large,
    ),
    Region(("size",), {"float": 1e-17, "mesh": 1e-13}, _small),
    Region(("slivers",), {"double": 1e-11, "float": 2e-6, "mesh": 2e-5}, _thin_glass),
    Region(("slivers",), dict.fromkeys(("mesh", "offset", "ulp"), 0.0), _clear_plates),
)
