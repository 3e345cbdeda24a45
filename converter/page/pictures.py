"""Pictures as the page gets them: what a picture is, then a byte a channel."""

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.compare.metrics import LIMIT, Pixels, absolute_difference, compare_pixels
from native_tracer import quantize

FAINT, STRONG = 64, 4
"""The least level that a pixel which disagrees has in the picture of a difference, and by how much that is brighter."""


def frame(about: dict[str, Any], levels: bytes) -> bytes:
    """A message to a browser: the length of what is told `about` the picture (4 bytes, the least first), that, and
    the `levels` of red, green and blue, pixel by pixel.
    """
    told = json.dumps(about).encode()
    return struct.pack("<I", len(told)) + told + levels


def levels_of(pixels: Any) -> bytes:
    """The levels of a buffer of floats, as image files have them."""
    return quantize(pixels)


def as_array(pixels: Any, width: int, height: int) -> Pixels:
    """A rendering's pixels."""
    return np.asarray(pixels, dtype=np.float32).reshape(height, width, 3)


def difference(reference: Pixels, test: Pixels) -> tuple[NDArray[np.uint8], str]:
    """Where two pictures disagree, as levels on black, and that in a sentence."""
    apart = absolute_difference(reference, test)
    disagrees = ~(apart <= LIMIT)
    bright = np.nan_to_num(apart, nan=1.0) * 255 * STRONG
    levels = np.where(disagrees.any(axis=2, keepdims=True), np.clip(bright, FAINT, 255), 0).astype(np.uint8)
    found = compare_pixels(reference, test)
    told = f"{found.disagreeing:,} of {found.pixels:,} pixels differ by more than 1/255"
    if found.disagreeing:
        told += f", most at ({found.largest.x}, {found.largest.y})"
    return levels, told
