"""Pictures by closed forms, in long double: rays from a camera, a convex body under a light, checkers."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Camera, Checker, Plane, Vector
from converter.scene.settings import Settings
from converter.studies.family import Truth

Long = NDArray[np.longdouble]


def long(vector: Vector) -> Long:
    """A vector, (3,)."""
    return np.array(vector, dtype=np.longdouble)


def dot(a: Long, b: Long) -> Long:
    """Along the last axis."""
    return np.asarray((a * b).sum(axis=-1))


def unit(a: Long) -> Long:
    """Along the last axis."""
    return np.asarray(a / np.sqrt(dot(a, a))[..., None])


def window(settings: Settings) -> tuple[Long, Long]:
    """(height, width) x and y of the pixels' centres in the window, where y = 1 is its upper edge."""
    rows, columns = np.mgrid[: settings.height, : settings.width].astype(np.longdouble)
    half = np.longdouble(0.5)
    x = (2 * (columns + half) / settings.width - 1) * settings.width / settings.height
    return x, 1 - 2 * (rows + half) / settings.height


def directions(camera: Camera, settings: Settings) -> Long:
    """(height, width, 3) unit directions of the rays through the pixels' centres."""
    forward = unit(long(camera.look_at) - long(camera.eye))
    right = unit(np.cross(forward, long(camera.up)))
    tangent = np.tan(np.longdouble(camera.fovy) * (4 * np.arctan(np.longdouble(1))) / 360)
    x, y = window(settings)
    return unit(forward + tangent * (x[..., None] * right + y[..., None] * np.cross(right, forward)))


def two_colors(mask: NDArray[np.bool_], there: Vector, elsewhere: Vector) -> Truth:
    """(height, width, 3), one colour where the mask holds and another elsewhere."""
    return np.where(mask[..., None], np.array(there), np.array(elsewhere))


def first_hit(planes: Sequence[Plane], eye: Vector, d: Long) -> tuple[Long, Long]:
    """Where rays from an eye outside of it enter an intersection of half-spaces, all of which are tried.

    Returns:
        (...) distances, infinite for none, and (..., 3) outward unit normals there.

    """
    shape = d.shape[:-1]
    enter = np.full(shape, -np.inf, dtype=np.longdouble)
    leave = np.full(shape, np.inf, dtype=np.longdouble)
    normal = np.zeros(d.shape, dtype=np.longdouble)
    for plane in planes:
        n = long(plane[:3])
        length = np.sqrt(dot(n, n))
        n, offset = n / length, np.longdouble(plane[3]) / length
        slope, height = dot(d, n), dot(n, long(eye)) + offset
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -height / slope
        enters = (slope < 0) & (t > enter)
        enter = np.where(enters, t, enter)
        normal = np.where(enters[..., None], n, normal)
        leave = np.where((slope > 0) & (t < leave), t, leave)
        leave = np.where((slope == 0) & (height > 0), -np.inf, leave)
    hit = (enter > 0) & (enter <= leave)
    return np.where(hit, enter, np.inf), normal


def lit(planes: Sequence[Plane], eye: Vector, d: Long, light: Vector, ka: float, kd: float) -> Truth:
    """The picture of a white convex body before black, under a white ambient light and an undimmed white light."""
    t, normal = first_hit(planes, eye, d)
    hit = np.isfinite(t)
    to_light = long(light) - (long(eye) + np.where(hit, t, 0)[..., None] * d)
    cosine = dot(normal, unit(to_light))
    # A convex body shades no side of itself but those that the light is behind.
    value = np.where(hit, ka + kd * np.maximum(cosine, 0), 0).astype(np.float64)
    return np.repeat(value[..., None], 3, axis=-1)


def checkered(pigment: Checker, p: Long) -> Truth:
    """(..., 3) colours of a checkerboard at points."""
    odd = np.floor(p / np.longdouble(pigment.size)).sum(axis=-1) % 2 != 0
    return np.where(odd[..., None], np.array(pigment.second), np.array(pigment.first))
