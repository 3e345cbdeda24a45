"""The random numbers of distributed ray tracing: points that are a pure function of what they are for.

Sample k of a pixel has a point of the unit square for each use and each ray of its tree, in units of 2^-32:

>>> sample_points(0, [3, 3], 5, [0, 1], 1, LENS).shape
(2, 2)

The first 2^m samples of a pixel lie one in each of 2^m equal boxes, whatever their shape; points of different pixels,
uses and rays are independent. `mitsuba_plugins.sampler` computes the same numbers.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from native_tracer import _core

LENS, TIME, MIRRORED_CONE, REFRACTED_CONE, FIRST_LIGHT = range(5)
"""Uses; light i, from 0, is use FIRST_LIGHT + i."""


def sample_points(
    seed: int,
    column: ArrayLike,
    row: ArrayLike,
    k: ArrayLike,
    path: ArrayLike,
    use: ArrayLike,
    independent: bool = False,
) -> NDArray[np.uint32]:
    """The point, (n, 2), of sample `k` of each pixel, for a `use` and the ray `path` of its tree.

    Args:
        seed: a whole number below 2^32, as are all that follow, each an array (n,) or one number for all.
        column: the pixel's, from the left.
        row: the pixel's, from the top.
        k: which sample of the pixel.
        path: 1 for a tree's primary ray, 2 p for the ray mirrored after path p, 2 p + 1 for the one transmitted there,
            modulo 2^32.
        use: one of the uses above.
        independent: those that measure what stratification is worth: each sample's is independent of all others.

    Raises:
        ValueError: the shapes do not fit.
        OverflowError: a number is negative, or not below 2^32.

    """
    words = np.broadcast_arrays(*(np.atleast_1d(np.asarray(given, np.uint32)) for given in (column, row, k, path, use)))
    at, down, number, of_ray, what = (np.ascontiguousarray(word).data for word in words)
    return np.asarray(_core.sample_points(seed, at, down, number, of_ray, what, independent))


def disc_points(points: ArrayLike) -> NDArray[np.float64]:
    """Shirley and Chiu's concentric map of `points`, (n, 2) in units of 2^-32, to the unit disc, (n, 2)."""
    return np.asarray(_core.disc_points(np.ascontiguousarray(points, np.uint32).data))


def cone_directions(axes: ArrayLike, versines: ArrayLike, points: ArrayLike) -> NDArray[np.float64]:
    """Unit vectors, (n, 3), uniform in solid angle in cones.

    Args:
        axes: (n, 3) unit vectors.
        versines: (n,) numbers, 1 - cos(half-angle).
        points: (n, 2) points in units of 2^-32.

    Raises:
        ValueError: the lengths differ.

    """
    axis, versine = (np.ascontiguousarray(given, np.float64).data for given in (axes, versines))
    return np.asarray(_core.cone_directions(axis, versine, np.ascontiguousarray(points, np.uint32).data))
