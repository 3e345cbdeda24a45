"""Which pixels are drawn with more samples: those that are unlike a neighbour, or whose mean is not sure yet."""

from typing import TYPE_CHECKING, Any

import numpy as np

from native_tracer import quantize

if TYPE_CHECKING:
    from numpy.typing import NDArray


def unlike_neighbors(
    signatures: "NDArray[np.uint32]", colors: "NDArray[np.float32]", limit: float
) -> "NDArray[np.bool_]":
    """Where a pixel's signature is not that of each of its four neighbours, or its colour, as an 8-bit picture has it,
    is more than `limit` levels from one of theirs in some channel.

    Args:
        signatures: (height, width), a word for what is decided along the rays of each pixel.
        colors: (height, width, 3), linear RGB.
        limit: in levels of 255.

    Returns:
        (height, width).

    """
    levels = np.frombuffer(quantize(colors.data), np.uint8).reshape(colors.shape).astype(np.int16)
    result = np.zeros(signatures.shape, np.bool_)
    for one, other in _NEIGHBORS:
        unlike = (signatures[one] != signatures[other]) | (np.abs(levels[one] - levels[other]).max(axis=-1) > limit)
        result[one] |= unlike
        result[other] |= unlike
    return result


class Spread:
    """How far the means of pixels may be off, by how far the means of passes differ.

    Passes complete one another, so that their mean is better than that of independent ones, which differ as much. But
    with few samples a pass all of them may miss what is small.

    Attributes:
        samples: (height, width), how many a pixel has.

    """

    def __init__(self, limit: float) -> None:
        self._limit = limit / 255
        self._passes = 0
        self.samples: Any = 0

    def unsure(self, sums: "NDArray[np.float64]", size: int, drawn: "NDArray[np.bool_]") -> "NDArray[np.bool_]":
        """The pixels among those `drawn`, in another pass of `size` samples, whose standard error, or that of one of
        their four neighbours, is above the limit in some channel; all after the first pass.

        Args:
            sums: (height, width, 3), of the samples' colours.
            size: samples a pixel.
            drawn: (height, width).

        """
        if self._passes == 0:
            self._before, self._squares = np.zeros_like(sums), np.zeros_like(sums)
        self._passes += 1
        self.samples = self.samples + size * drawn.astype(np.uint32)
        now = sums[drawn]
        self._squares[drawn] += (now - self._before[drawn]) ** 2
        self._before[drawn] = now
        if self._passes == 1:
            return drawn.copy()
        count = self._passes
        variance = np.maximum(self._squares[drawn] - now**2 / count, 0) / (count - 1)
        over = np.zeros(drawn.shape, np.bool_)
        over[drawn] = ~(np.sqrt(variance / count).max(axis=-1) / size <= self._limit)
        result = over.copy()
        for one, other in _NEIGHBORS:
            result[one] |= over[other]
            result[other] |= over[one]
        return result & drawn


_NEIGHBORS = (
    ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
    ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
)
"""Slices of pixels, and of those above and to the left of them."""
