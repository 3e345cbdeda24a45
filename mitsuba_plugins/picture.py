"""Rendered images into files, with the colours that the course means."""

from os import PathLike
from pathlib import Path
from typing import Any


def write_image(path: str | PathLike[str], image: Any) -> None:
    """Write an image as `whitted render` does, the same bytes.

    The course's colours are display values. `mitsuba.util.write_bitmap` takes them for linear light, and applies sRGB's
    curve where a format has 8 bits.

    Args:
        path: the file; its ending says what kind of file: .ppm, .png, .exr and others.
        image: what `mitsuba.render` returns, or another (height, width, 3) array of floats, row 0 on top.

    Raises:
        OSError: it cannot be written, or nothing is known of that ending.
        ValueError: it is no such array.

    """
    import numpy as np

    from converter.images.write import write_image as write

    pixels = np.ascontiguousarray(image, dtype=np.float32)
    if pixels.ndim != 3 or pixels.shape[2] != 3:
        raise ValueError(f"expected an image of (height, width, 3) floats, found {pixels.shape}")
    height, width, _ = pixels.shape
    write(Path(path), pixels, width, height)
