"""Pictures by closed forms, in long double: rays from a camera, and what a floor or a ball under a light looks like."""

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Camera, Vector
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
