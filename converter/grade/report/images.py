"""Pictures within a page, as data: URLs."""

import base64
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from converter.images.write import write_image
from converter.why.likeness import EXACT, errors
from converter.why.picture import Picture

THUMBNAIL = 128
"""Columns of a small picture."""
_AMPLIFIED = 4
_RED = (230, 0, 30)
_TYPES = {".png": "image/png", ".jpg": "image/jpeg"}


def whole(levels: Picture) -> str:
    """A picture without losses."""
    return _url(levels, ".png")


def small(levels: Picture) -> str:
    """A small picture of a picture: means of blocks, compressed with losses."""
    factor = max(1, -(-levels.shape[1] // THUMBNAIL))
    height, width = (size // factor * factor for size in levels.shape[:2])
    if not height or not width:
        return _url(np.ascontiguousarray(levels[:THUMBNAIL, :THUMBNAIL]), ".png")
    blocks = levels[:height, :width].reshape(height // factor, factor, width // factor, factor, 3)
    return _url(np.round(blocks.mean(axis=(1, 3))).astype(np.uint8), ".jpg")


def difference(theirs: Picture, right: Picture, lossy: bool) -> Picture:
    """Where a picture is wrong: red over the right one in pale grey; by how much where losses hide it."""
    if lossy:
        apart = np.abs(theirs.astype(np.int16) - right) * _AMPLIFIED
        result: Picture = np.minimum(apart, 255).astype(np.uint8)
        return result
    grey = np.round(160 + 0.35 * right.mean(axis=2)).astype(np.uint8)
    result = np.repeat(grey[:, :, np.newaxis], 3, axis=2)
    result[errors(theirs, right) > EXACT.tolerance] = _RED
    return result


def _url(levels: Picture, ending: str) -> str:
    height, width, _ = levels.shape
    with TemporaryDirectory() as folder:
        file = Path(folder) / f"picture{ending}"
        write_image(file, np.divide(levels, 255, dtype=np.float32), width, height)
        return f"data:{_TYPES[ending]};base64,{base64.b64encode(file.read_bytes()).decode()}"
