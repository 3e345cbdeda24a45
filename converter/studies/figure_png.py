"""Figures of matplotlib as small PNG files."""

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def save_png(figure: "Figure", file: Path, dots: int) -> None:
    """Write a figure with so many dots an inch and a byte a dot: less than half as large as colours, and not seen.

    Raises:
        OSError: it cannot be written.

    """
    from PIL import Image  # matplotlib brings it

    drawn = BytesIO()
    figure.savefig(drawn, format="png", dpi=dots)
    Image.open(drawn).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(file, "PNG", optimize=True)
