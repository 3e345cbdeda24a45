"""A picture to be judged, as bytes."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from converter.why.student import to_levels

Picture = NDArray[np.uint8]
"""(height, width, 3) levels of 0..255, row 0 on top."""


@dataclass(frozen=True, slots=True, eq=False)
class Theirs:
    """The picture, and whether its format keeps colours only roughly."""

    file: Path
    levels: Picture
    lossy: bool


def read_theirs(file: Path) -> Theirs:
    """The picture in a file of any format that textures may have; floats become the nearest levels.

    Raises:
        TextureError: it is missing, no image, or broken.

    """
    from converter.images.texture import read_texture

    pixels = np.asarray(read_texture(file).texels)
    levels = to_levels(pixels.reshape(-1, 3)).reshape(pixels.shape)
    return Theirs(file, levels, is_lossy(file))


def is_lossy(file: Path) -> bool:
    """Whether a file is JPEG, lossy WebP or a GIF of 256 colours, by how it begins."""
    with file.open("rb") as opened:
        start = opened.read(16)
    webp = start[:4] == b"RIFF" and start[8:12] == b"WEBP"
    return start[:2] == b"\xff\xd8" or start[:4] == b"GIF8" or (webp and start[12:16] == b"VP8 ")
