"""The order in which pixels are drawn, where their samples lie, and how a film takes up their colours."""

import math
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient

TILE = 4
"""Rows of pixels that are drawn together: with four columns they are 16, a packet of processors with AVX-512."""


def sample_offsets(spp: int) -> list[tuple[float, float]]:
    """Positions of a pixel's samples, in pixels from its top left corner.

    Raises:
        ValueError: `spp` is no square number.

    """
    n = math.isqrt(spp)
    if n * n != spp:
        raise ValueError(f"whitted: samples per pixel are laid out as a grid, and {spp} is no square number")
    return [((cell % n + 0.5) / n, (cell // n + 0.5) / n) for cell in range(spp)]


def corners(film: Any, pixel: Any) -> Any:
    """Top left corners (Point2d) of pixels, by their numbers in the film's crop window, row by row."""
    columns = dr.opaque(mi.UInt32, film.crop_size().x)  # opaque, so that pictures of all sizes share one kernel
    left, top = (dr.opaque(mi.Float64, at) for at in film.crop_offset())  # and all parts of them
    row = divided(pixel, columns)
    return mi.Point2d(pixel - row * columns, row) + mi.Point2d(left, top)


def in_rows(width: int, first: int, rows: int) -> Any:
    """The numbers (UInt32) of the pixels of some rows of a picture, row by row."""
    return dr.arange(mi.UInt32, rows * width) + dr.opaque(mi.UInt32, first * width)


def in_tiles(width: int, first: int, rows: int) -> Any:
    """The numbers (UInt32) of the pixels of some rows of a picture, in strips of `TILE` rows, column by column.

    So those of a packet form a square: their rays take the same way more often than those of a row.
    """
    columns, rows_there = dr.opaque(mi.UInt32, width), dr.opaque(mi.UInt32, rows)
    number = dr.arange(mi.UInt32, width * rows)
    strip = divided(number, columns * TILE)
    height = dr.minimum(rows_there - strip * TILE, TILE)
    rest = number - strip * columns * TILE
    column = divided(rest, height)
    return (dr.opaque(mi.UInt32, first) + strip * TILE + rest - column * height) * columns + column


def place_in_tiles(width: int, rows: int) -> Any:
    """Where each pixel of some rows, row by row, stands in the order of `in_tiles` (UInt32)."""
    columns, rows_there = dr.opaque(mi.UInt32, width), dr.opaque(mi.UInt32, rows)
    number = dr.arange(mi.UInt32, width * rows)
    row = divided(number, columns)
    strip = row // TILE
    height = dr.minimum(rows_there - strip * TILE, TILE)
    return strip * columns * TILE + (number - row * columns) * height + row - strip * TILE


def divided(a: Any, b: Any) -> Any:
    """Whole numbers (UInt32), divided and rounded down. Processors divide no vectors of them, but doubles, exactly."""
    return mi.UInt32(quotient(mi.Float64(a), mi.Float64(b)))


def mean_colors(sums: Any, samples: int, width: int) -> Any:
    """Colours, row by row, three numbers each (Float), of the sums of pixels (Color3d) in the order of `in_tiles`."""
    count = dr.width(sums)
    result = dr.empty(mi.Float, 3 * count)
    dr.scatter(result, mi.Color3f(quotient(sums, samples)), in_tiles(width, 0, count // width))
    return result


def block(bands: Any, film: Any) -> Any:
    """Bands of a picture, colours as `mean_colors` has them, as a film takes them up: cheaper than to splat them, and
    the same for a box filter.
    """
    width, height = film.crop_size()
    # After red, green and blue come alpha, where the film has it, and the sum of the filter's weights: all 1.
    count = film.base_channels_count() + 1
    ones = dr.full(mi.Float, 1, width * height)
    pixels = dr.empty(mi.Float, width * height * count)
    index = dr.arange(mi.UInt32, width * height)
    color = dr.gather(mi.Color3f, dr.concat(bands), index)
    for k, channel in enumerate([*color] + [ones] * (count - 3)):
        dr.scatter(pixels, channel, index * count + k)
    return mi.ImageBlock(mi.TensorXf(pixels, (height, width, count)), film.crop_offset(), film.rfilter(), border=False)
