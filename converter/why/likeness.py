"""When a picture counts as the same: pixel by pixel, or, where it was compressed with losses, square by square.

JPEG changes single pixels by dozens of levels at edges, but keeps the mean of a square that it compresses but for the
rounding of one number. So in such pictures a square is wrong, with all of its pixels, if its mean is.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from converter.why.student import Levels, Places

Mask = NDArray[np.bool_]
Errors = NDArray[np.int16]

SQUARE = 16
"""Edge of the squares, on whose grid JPEG works: it may keep colours at half the resolution of squares of 8."""


@dataclass(frozen=True, slots=True)
class Likeness:
    """How alike pixels have to be.

    Attributes:
        tolerance: levels of 255 by which a channel may differ: what roundings or losses of compression do.
        lossy: the picture was compressed with losses, and means of squares are compared.
        fewest: pixels that have to be wrong, or made right by a deviation, for it to mean anything.
        gain: share of the pixels unexplained so far that a deviation has to explain to be believed.

    """

    tolerance: int
    lossy: bool
    fewest: int
    gain: float

    def judged(self, width: int, height: int) -> Mask:
        """(height, width) pixels that can be judged: all, or those in whole squares."""
        result = np.ones((height, width), np.bool_)
        if self.lossy:
            result[height // SQUARE * SQUARE :] = False
            result[:, width // SQUARE * SQUARE :] = False
        return result

    def wrong(self, expected: Levels, theirs: Levels, places: Places) -> Mask:
        """(n,) pixels of `theirs` that are not as `expected`; the places hold whole squares where those count."""
        if not self.lossy:
            return errors(expected, theirs) > self.tolerance
        means, number = mean_errors(expected, theirs, places)
        result: Mask = (means > self.tolerance)[number]
        return result


EXACT = Likeness(1, lossy=False, fewest=6, gain=0.3)
COMPRESSED = Likeness(4, lossy=True, fewest=4 * SQUARE * SQUARE, gain=0.5)


def errors(one: NDArray[np.uint8], other: NDArray[np.uint8]) -> Errors:
    """Largest difference of a channel, pixel by pixel, of (..., 3) levels."""
    difference: Errors = np.abs(one.astype(np.int16) - other.astype(np.int16)).max(axis=-1)
    return difference


def mean_errors(expected: Levels, theirs: Levels, places: Places) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """(m,) how far the mean of each square is off in its worst channel, and (n,) the number of each pixel's square."""
    _, number, counts = np.unique(square_of(places), return_inverse=True, return_counts=True)
    difference = theirs.astype(np.float64) - expected
    sums = np.stack([np.bincount(number, channel, len(counts)) for channel in difference.T], axis=1)
    return np.abs(sums / counts[:, np.newaxis]).max(axis=1), number


def square_of(places: Places) -> NDArray[np.int64]:
    """(n,) numbers of the squares in which pixels lie."""
    xs, ys = places.T.astype(np.int64) // SQUARE
    result: NDArray[np.int64] = ys * (1 << 20) + xs
    return result
