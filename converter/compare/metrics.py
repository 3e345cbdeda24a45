"""How much two pictures differ, in numbers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Color

Pixels = NDArray[np.float32]
"""(height, width, 3) linear RGB, row 0 on top."""

LIMIT = 1 / 255 + 2**-24
"""A pixel disagrees when a channel differs by more: one level of 8 bits, and what float32 loses of such a level."""


class SizeMismatch(ValueError):  # noqa: N818 - what it says
    """Two pictures of different sizes cannot be compared."""


@dataclass(frozen=True, slots=True)
class Largest:
    """Where two pictures differ most, in which channel (0 is red), and what they are there.

    `difference` is infinite where one of them is not finite.
    """

    x: int
    y: int
    channel: int
    difference: float
    reference: Color
    test: Color


@dataclass(frozen=True, slots=True)
class Difference:
    """What tells one picture from another.

    Attributes:
        width, height: their size in pixels.
        disagreeing: pixels with a channel that differs by more than `LIMIT`, or is not finite in either picture.
        not_finite: those of them that are not finite.
        mean, rms, largest: of the differences by pixel and channel; the first two over the finite ones.

    """

    width: int
    height: int
    disagreeing: int
    not_finite: int
    mean: float
    rms: float
    largest: Largest

    @property
    def pixels(self) -> int:
        """How many there are."""
        return self.width * self.height

    @property
    def disagreeing_percent(self) -> float:
        """Share of the pixels that disagree."""
        return 100 * self.disagreeing / self.pixels


def compare_pixels(reference: Pixels, test: Pixels) -> Difference:
    """Compare two pictures as they are, neither clamped nor quantised.

    Raises:
        SizeMismatch: their sizes differ.

    """
    check_sizes(reference, test)
    height, width, channels = reference.shape
    difference = absolute_difference(reference, test)
    finite = np.isfinite(difference)
    # Not `difference > LIMIT`, which is false for NaN.
    disagrees = ~(difference <= LIMIT).all(axis=2)
    known = difference[finite]
    mean, square = (float(known.mean()), float(np.square(known).mean())) if known.size else (0.0, 0.0)
    difference[~finite] = np.inf
    y, x, channel = np.unravel_index(int(difference.argmax()), (height, width, channels))
    return Difference(
        width=width,
        height=height,
        disagreeing=int(disagrees.sum()),
        not_finite=int((~finite).any(axis=2).sum()),
        mean=mean,
        rms=square**0.5,
        largest=Largest(
            int(x), int(y), int(channel), float(difference[y, x, channel]), _color(reference[y, x]), _color(test[y, x])
        ),
    )


def count_shifted(reference: Pixels, test: Pixels) -> int:
    """Of the pixels that disagree those in which `test` may be `reference` shifted by less than a pixel.

    Their colours lie, in every channel, between the least and the largest of the pixel and its eight neighbours.

    Raises:
        SizeMismatch: their sizes differ.

    """
    disagrees = ~(absolute_difference(reference, test) <= LIMIT).all(axis=2)
    height, width, _ = reference.shape
    padded = np.pad(reference, ((1, 1), (1, 1), (0, 0)), mode="edge")
    around = [padded[y : y + height, x : x + width] for y in range(3) for x in range(3)]
    least, largest = np.fmin.reduce(around), np.fmax.reduce(around)
    between = ((least - LIMIT <= test) & (test <= largest + LIMIT)).all(axis=2)
    return int((disagrees & between).sum())


def check_sizes(reference: Pixels, test: Pixels) -> None:
    """Raise `SizeMismatch` if two pictures cannot be laid on each other."""
    if reference.shape != test.shape:
        (h, w), (k, v) = reference.shape[:2], test.shape[:2]
        raise SizeMismatch(f"the sizes differ: {w} x {h} and {v} x {k} pixels")


def absolute_difference(reference: Pixels, test: Pixels) -> NDArray[np.float64]:
    """(height, width, 3) differences without sign; NaN where a value, or both, are NaN or infinite."""
    with np.errstate(invalid="ignore"):
        difference = np.abs(reference.astype(np.float64) - test.astype(np.float64))
    difference[np.isinf(difference)] = np.nan
    return difference


def clamped(pixels: Pixels) -> Pixels:
    """What an image file shows of a picture: 0..1; NaN stays."""
    result: Pixels = np.clip(pixels, 0, 1)
    return result


def _color(pixel: Pixels) -> Color:
    red, green, blue = map(float, pixel)
    return (red, green, blue)
