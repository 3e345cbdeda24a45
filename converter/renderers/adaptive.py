"""Which pixels are drawn with more samples: those that are unlike a neighbour, or whose mean is not sure yet."""

from typing import TYPE_CHECKING, Any

import numpy as np

from native_tracer import quantize
from native_tracer.passes import halves

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Adapting:
    """A `Refinement` of one picture, which keeps how many samples each pixel has got.

    What a ray changes in a colour that weighs less than the limit is below the limit, too, or nearly.

    Args:
        limit: in levels of 255.
        samples: rays a pixel, at most.

    Attributes:
        most: samples that a pixel may have.
        samples: (height, width) uint32, how many it has, with a first one that is drawn anew.

    """

    def __init__(self, limit: float, samples: int) -> None:
        self.least_weight = min(limit / 255, 1.0)
        self.most = self._asked = samples
        self.samples: Any = None
        self._limit = limit
        self._spread: Spread | None = None

    def halves(self, signatures: "NDArray[np.uint32]", colors: "NDArray[np.float32]") -> "NDArray[np.uint8]":
        """How many halves of a pass each pixel needs, as `Refinement` has it."""
        result = halves_needed(signatures, colors, self._limit)
        parts = [len(part) for part in halves(self._asked)]
        of_parts = np.cumsum([1, *parts], dtype=np.uint32)
        self.most = int(of_parts[-1])
        self.samples = of_parts[np.minimum(result, len(parts))]
        return result

    def unsure(self, sums: "NDArray[np.float64]", size: int, drawn: "NDArray[np.bool_]") -> "NDArray[np.bool_]":
        """The pixels that need another pass, as `Refinement` has it."""
        self._spread = self._spread or Spread(self._limit)
        result = self._spread.unsure(sums, size, drawn)
        self.samples = self._spread.samples
        return result

    def statistics(self) -> dict[str, Any]:
        """How many pixels got as many samples as any may, and how many rays from the eye a pixel has in the mean."""
        refined = self.samples >= self.most
        return {
            "refined_pixels": int(refined.sum()),
            "refined_share": round(float(refined.mean()), 4),
            "rays_a_pixel": round(float(self.samples.mean()), 4),
        }


def halves_needed(signatures: "NDArray[np.uint32]", colors: "NDArray[np.float32]", limit: float) -> "NDArray[np.uint8]":
    """How many halves of a pass pixels need: both where a pixel's colour, as an 8-bit picture has it, is more than
    `limit` levels in some channel from that of one of its four neighbours; one where only its signature is not theirs.

    Args:
        signatures: (height, width), a word for what is decided along the rays of each pixel.
        colors: (height, width, 3), linear RGB.
        limit: in levels of 255.

    Returns:
        (height, width), 0 to 2.

    """
    levels = np.frombuffer(quantize(colors.data), np.uint8).reshape(colors.shape).astype(np.int16)
    result = np.zeros(signatures.shape, np.uint8)
    for one, other in _NEIGHBORS:
        far = np.abs(levels[one] - levels[other]).max(axis=-1) > limit
        needed = np.where(far, 2, signatures[one] != signatures[other]).astype(np.uint8)
        np.maximum(result[one], needed, out=result[one])
        np.maximum(result[other], needed, out=result[other])
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
