"""How near a ray is to meeting something else: to a silhouette, to an edge, to the next tile.

A margin is the length, in scene units, by which the ray or a surface would have to be moved for that. Two planes that a
ray crosses at distances t and u change places, or begin or cease to have a way between them, when both are moved by
|t - u| / (1 / |cosine| + 1 / |other cosine|), cosines being those between the ray and their normals.
"""

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Shape
from converter.shapes.kind import Intersection
from converter.shapes.table import shape_kind

Floats = NDArray[np.float64]


def intersections(shape: Shape, origin: Floats, direction: Floats) -> list[Intersection]:
    """Where a line enters and leaves a shape; of a ball that it misses, where it comes nearest."""
    return shape_kind(shape).intersections(shape, origin, direction)


def silhouette_margin(shape: Shape, origin: Floats, direction: Floats) -> float:
    """From the line of a ray to where it begins, or ceases, to meet a shape."""
    return shape_kind(shape).silhouette_margin(shape, origin, direction)


def edge_margin(shape: Shape, origin: Floats, direction: Floats) -> float:
    """From the line of a ray, where it enters and leaves a shape, to the next face."""
    return shape_kind(shape).edge_margin(shape, origin, direction)


def surface_margin(shape: Shape, p: Floats, on_it: bool) -> float:
    """From a point to the surface of a shape; if it lies on that, to the next face."""
    return shape_kind(shape).surface_margin(shape, p, on_it)
