"""Points that lie on surfaces: the eye on a floor, a lamp on a ceiling."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from native_tracer import _core


def surfaces_at(point: ArrayLike, rows: ArrayLike, round: ArrayLike) -> list[int]:
    """Which surfaces a point lies on for some numbers that round to these doubles, as the decimals of a file do.

    Args:
        point: (3,) numbers.
        rows: (n, 4) numbers: a sphere's centre and radius, or the a, b, c, d of a plane a x + b y + c z + d = 0, its
            normal of any length.
        round: (n,) booleans, whether a row is a sphere's.

    Raises:
        ValueError: there is not a boolean for every row.
        TypeError: the shapes are wrong.

    """
    flags = np.ascontiguousarray(round, dtype=np.bool_).view(np.uint8)
    return list(_core.surfaces_at(_triple(point), _rows(rows).data, flags.data))


def within(point: ArrayLike, planes: ArrayLike) -> bool:
    """Whether a point lies in all half-spaces a x + b y + c z + d <= 0 or on their borders.

    Args:
        point: (3,) numbers.
        planes: (n, 4) numbers, normals of any length.

    Raises:
        TypeError: the shapes are wrong.

    """
    return _core.within(_triple(point), _rows(planes).data)


def _triple(point: ArrayLike) -> tuple[float, float, float]:
    x, y, z = np.asarray(point, dtype=np.float64).tolist()
    return x, y, z


def _rows(rows: ArrayLike) -> NDArray[np.float64]:
    return np.ascontiguousarray(rows, dtype=np.float64)
