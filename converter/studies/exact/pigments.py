"""Colours of points."""

from collections.abc import Callable
from typing import assert_never

import numpy as np

from converter.images.texture import read_texture
from converter.scene.model import Checker, Color, Pigment, Solid, Texmap
from converter.studies.exact.ties import Decisions
from converter.studies.exact.vectors import Vec, dot

ColorAt = Callable[[Vec], Color]


def color_function(pigment: Pigment, decide: Decisions) -> ColorAt:
    """The pigment's colour at a point."""
    match pigment:
        case Solid(color):
            return lambda _: color
        case Checker():
            return _tiles(pigment, decide)
        case Texmap():
            return _texels(pigment, decide)
    assert_never(pigment)


def _tiles(pigment: Checker, decide: Decisions) -> ColorAt:
    size = decide.number(pigment.size)

    def tile(point: Vec) -> Color:
        odd = sum(decide.whole(x / size, "tile", toward_zero=False) for x in point) % 2
        return pigment.second if odd else pigment.first

    return tile


def _texels(pigment: Texmap, decide: Decisions) -> ColorAt:
    texels = np.asarray(read_texture(pigment.file).texels)
    p0, p1 = ([decide.number(x) for x in p] for p in (pigment.p0, pigment.p1))
    height, width = texels.shape[:2]

    def texel(point: Vec) -> Color:
        column, row = (
            decide.whole((dot(p[:3], point) + p[3]) * count, "texel", toward_zero=True) % count
            for p, count in ((p0, width), (p1, height))
        )
        r, g, b = texels[row, column].tolist()
        return (r, g, b)

    return texel
