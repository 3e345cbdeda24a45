"""PNG files that are written without OpenImageIO hold what they should, and say it as OpenImageIO does."""

import io
import random

import pytest
from PIL import Image

from converter.images.png import ROWS, png


@pytest.mark.parametrize(("width", "height"), [(1, 1), (3, 2), (5, ROWS), (2, ROWS + 1), (40, 3 * ROWS + 7)])
def test_pixels_come_back(width: int, height: int) -> None:
    levels = random.Random(width).randbytes(3 * width * height)
    file = b"".join(png(levels, width, height))
    with Image.open(io.BytesIO(file)) as image:
        image.load()
        assert (image.mode, image.size, image.tobytes()) == ("RGB", (width, height), levels)
        assert image.info["srgb"] == 3
        assert image.info["gamma"] == pytest.approx(1 / 2.2, abs=1e-5)
        assert image.info["chromaticity"] == (0.3127, 0.329, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06)


def test_what_grows_from_row_to_row_takes_next_to_nothing() -> None:
    first = random.Random(0).randbytes(3 * 200)
    rows = b"".join(bytes((level + k) % 256 for level in first) for k in range(200))
    assert len(b"".join(png(rows, 200, 200))) < len(rows) / 50
