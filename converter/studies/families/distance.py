"""Things far away: balls that are small for their distance, and rays that graze them."""

import math

import numpy as np

from converter.studies.families.closed_forms import directions, dot, long, two_colors, unit
from converter.studies.families.scenes import BLACK, GLOW, MATTE, WHITE, camera, light, scene, settings, sphere
from converter.studies.family import Case, Family

_SETTINGS = settings()


def _distance(distance: float) -> Case:
    """Seen through a lens that makes it fill the picture. The light is as far away as the ball."""
    eye, lamp = (0.0, 0.0, distance), (distance, distance, distance)
    view = camera(eye, (0.0, 0.0, 0.0), math.degrees(2 * math.atan(1.25 / distance)))
    d = directions(view, _SETTINGS)
    closest = -dot(long(eye), d)
    across = long(eye) + closest[..., None] * d
    inside = 1 - dot(across, across)
    root = np.sqrt(np.maximum(inside, 0))
    n = unit(across - root[..., None] * d)
    cosine = np.maximum(dot(n, unit(long(lamp) - n)), 0)
    color = np.where(inside >= 0, MATTE.ka + MATTE.kd * cosine, 0).astype(np.float64)
    made = scene(view, [(sphere((0.0, 0.0, 0.0), 1.0), WHITE, MATTE)], [light(lamp)])
    return Case(made, _SETTINGS, np.repeat(color[..., None], 3, axis=2))


def _grazing(off: float) -> Case:
    """The window's lower half is on the ball, the upper half is not; rays in a row are off by up to that row's y."""
    distance = 4.0
    view = camera((0.0, 1.0, distance), (0.0, 1.0, 0.0), math.degrees(2 * math.atan(off / distance)))
    d = directions(view, _SETTINGS)
    # |eye + t d|^2 = 1 with eye = (0, 1, 4), without the 1 that cancels.
    b = d[..., 1] + distance * d[..., 2]
    hit = b * b - distance * distance >= 0
    made = scene(view, [(sphere((0.0, 0.0, 0.0), 1.0), WHITE, GLOW)])
    return Case(made, _SETTINGS, two_colors(hit, WHITE, BLACK))


FAMILIES = (
    Family(
        "distance",
        "A ball farther and farther away, through a lens that keeps it as large in the picture.",
        "distance over radius",
        tuple(10.0**power for power in range(1, 13)),
        _distance,
    ),
    Family(
        "grazing",
        "Rays that pass a ball's edge at less and less distance on either side: the half of them that is inside hits.",
        "distance of the outermost rays from the edge, in radii",
        tuple(10.0**-power for power in range(1, 15)),
        _grazing,
    ),
)
