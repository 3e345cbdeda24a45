"""A picture that a browser sends, to be laid over."""

import re
import tempfile
from pathlib import Path

import numpy as np

from converter.why.picture import Theirs, read_theirs

MOST_BYTES = 64 << 20
"""Of a picture's file."""
MOST_PIXELS = 1 << 23
"""Of the picture."""


def read_upload(name: str, data: bytes) -> Theirs:
    """The picture in the bytes of a file of that name, of which only the ending counts.

    Raises:
        TextureError: it is no image, or broken.
        ValueError: it is larger than the page bears.

    """
    from converter.images.texture import TextureError, probe_texture

    ending = Path(name).suffix
    with tempfile.TemporaryDirectory(prefix="whitted-") as folder:
        file = Path(folder, "picture" + (ending if re.fullmatch(r"\.[A-Za-z0-9]{1,8}", ending) else ""))
        file.write_bytes(data)
        try:
            width, height = probe_texture(file)
            if width * height > MOST_PIXELS:
                raise ValueError(f"it has {width} x {height} pixels, and the page bears {MOST_PIXELS:,}")
            theirs = read_theirs(file)
        except TextureError as error:
            raise TextureError(str(error).replace(str(file), "the picture")) from error
    return Theirs(Path(Path(name).name), np.ascontiguousarray(theirs.levels), theirs.lossy)
