"""Which pixels are drawn with more samples: those that are unlike one of their neighbours.

Kirk and Arvo, Unbiased Sampling Techniques for Image Synthesis, SIGGRAPH 1991, on why the first samples are not reused.
"""

from typing import TYPE_CHECKING

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
    for one, other in (
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
    ):
        unlike = (signatures[one] != signatures[other]) | (np.abs(levels[one] - levels[other]).max(axis=-1) > limit)
        result[one] |= unlike
        result[other] |= unlike
    return result
