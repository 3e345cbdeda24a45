"""When two pixels count as the same, and which pixels can be judged at all."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from converter.why.picture import Picture

Mask = NDArray[np.bool_]
Errors = NDArray[np.int16]

_HALF_BLOCK = 3
"""Pixels about one that have to be alike for compression with losses to leave it as it was."""
_FLAT = 8
"""Levels between them at most: JPEG of ordinary quality adds fewer where nothing happens, and more at edges."""


@dataclass(frozen=True, slots=True)
class Likeness:
    """How alike pixels have to be.

    Attributes:
        tolerance: levels of 255 by which a channel may differ: the roundings of two programs, or losses of compression.
        lossy: the picture was compressed with losses, and only its even parts are judged.

    """

    tolerance: int
    lossy: bool

    def judged(self, theirs: Picture) -> Mask:
        """(height, width) pixels that can be judged: all, or those in even parts of a compressed picture."""
        height, width, _ = theirs.shape
        if not self.lossy:
            return np.ones((height, width), np.bool_)
        spread = _around(theirs, np.maximum) - _around(theirs, np.minimum).astype(np.int16)
        return (spread <= _FLAT).all(axis=2)


EXACT = Likeness(1, False)
COMPRESSED = Likeness(6, True)


def errors(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> Errors:
    """Largest difference of a channel, pixel by pixel, of (..., 3) levels."""
    difference: Errors = np.abs(one.astype(np.int16) - other.astype(np.int16)).max(axis=-1)
    return difference


def _around(picture: Picture, reduce: np.ufunc) -> Picture:
    """Each pixel's least or largest channels with its neighbours."""
    result = picture
    for axis in (0, 1):
        reduced = result.copy()
        for shift in range(1, _HALF_BLOCK + 1):
            ahead, behind = [slice(None)] * 3, [slice(None)] * 3
            ahead[axis], behind[axis] = slice(shift, None), slice(None, -shift)
            a, b = tuple(ahead), tuple(behind)
            reduce(reduced[b], result[a], out=reduced[b])
            reduce(reduced[a], result[b], out=reduced[a])
        result = reduced
    return result
