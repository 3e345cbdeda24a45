"""A picture that can be looked at, saved and computed with."""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from converter.images.texture import read_texture
from converter.images.write import write_image


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A picture; Jupyter shows it, and `numpy.asarray` takes it for its pixels.

    Attributes:
        pixels: (height, width, 3) float32, linear RGB, row 0 on top, not clamped.
        name: what drew it, or the file it comes from.
        seconds: wall-clock seconds by stage, where it was drawn: {"build": 0.01, "render": 0.04}.
        statistics: the renderer's own counters, e.g. {"rays": 1862000}.

    """

    pixels: NDArray[np.float32]
    name: str = "picture"
    seconds: Mapping[str, float] = field(default_factory=dict)
    statistics: Mapping[str, Any] = field(default_factory=dict)

    @property
    def width(self) -> int:
        """Columns."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Rows."""
        return int(self.pixels.shape[0])

    def save(self, path: str | PathLike[str]) -> None:
        """Write it; the ending says what kind of file: the bytes of `whitted render`.

        Raises:
            OSError: it cannot be written, or nothing is known of that ending.

        """
        write_image(Path(path), np.ascontiguousarray(self.pixels), self.width, self.height)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.pixels, dtype=dtype, copy=copy)

    def __repr__(self) -> str:
        return f"<{self.width} x {self.height} pixels, {self.name}>"

    def _repr_png_(self) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "picture.png"
            self.save(file)
            return file.read_bytes()


def load_picture(path: str | PathLike[str]) -> Picture:
    """The picture in an image file, its levels divided by the largest.

    Raises:
        ValueError: it cannot be read (`converter.images.texture.TextureError`).

    """
    pixels = np.asarray(read_texture(Path(path)).texels, dtype=np.float32)
    return Picture(pixels, str(path))
