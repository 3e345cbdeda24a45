"""A picture of a comparison: both pictures, their difference and the FLIP map, side by side and labelled."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from converter.compare.metrics import Pixels, absolute_difference
from converter.compare.report import Report
from converter.files import shown_name
from converter.images.write import write_image

SMALLEST_PANEL = 280
"""Columns that a panel has at least, so that its label fits: smaller pictures are enlarged, a whole number of times."""
TEXT_SIZE = 16
LETTER = 9
"""Columns that a letter of that size takes, about."""
GAP = 8
BAR = 28
"""Rows above the panels, for the labels."""
GROUND = 0.13
NOT_FINITE = (1.0, 0.0, 1.0)
"""Colour, in the difference, of pixels that are NaN or infinite."""


@dataclass(frozen=True, slots=True)
class Panel:
    """A picture with its label."""

    label: str
    pixels: Pixels


def draw_figure(report: Report, file: Path, amplification: float, ending: str | None = None) -> None:
    """Draw both pictures, their difference times `amplification`, and the FLIP map, side by side into an image file.

    `ending` chooses the image's format, if `file` does not.

    Raises:
        OSError: it cannot be written.

    """
    pictures = report.pictures
    difference = (absolute_difference(pictures.reference_pixels, pictures.test_pixels) * amplification).astype(
        np.float32
    )
    difference[np.isnan(difference).any(axis=2)] = NOT_FINITE
    panels = [
        Panel(f"reference: {shown_name(pictures.reference)}", pictures.reference_pixels),
        Panel(f"candidate: {shown_name(pictures.test)}", pictures.test_pixels),
        Panel(f"difference x {amplification:g}", difference),
    ]
    if report.flip is not None:
        panels.append(Panel(f"FLIP, mean {report.flip_mean:.3g}", _magma(report.flip)))
    sheet = side_by_side(panels)
    write_image(file, sheet, sheet.shape[1], sheet.shape[0], ending)


def side_by_side(panels: Sequence[Panel]) -> Pixels:
    """One picture of several of the same size, each under its label."""
    height, width, _ = panels[0].pixels.shape
    scale = -(-SMALLEST_PANEL // width)
    height, width = height * scale, width * scale
    sheet = np.full((BAR + height, len(panels) * (width + GAP) - GAP, 3), GROUND, dtype=np.float32)
    for k, panel in enumerate(panels):
        left = k * (width + GAP)
        pixels = np.nan_to_num(np.clip(panel.pixels, 0, 1), nan=0.0)
        sheet[BAR:, left : left + width] = pixels.repeat(scale, axis=0).repeat(scale, axis=1)
        sheet[:BAR, left : left + width] = _label(panel.label, width)
    return sheet


def _label(text: str, width: int) -> Pixels:
    """A strip with a text, its end if it is long; empty where OpenImageIO cannot draw any."""
    import OpenImageIO as oiio  # noqa: N813 - its own documentation's name

    room = (width - 12) // LETTER
    if len(text) > room:
        text = f"...{text[3 - room :]}"
    strip = oiio.ImageBuf(oiio.ImageSpec(width, BAR, 3, oiio.FLOAT))
    oiio.ImageBufAlgo.fill(strip, (GROUND,) * 3)
    # The fonts come with OpenImageIO's wheel; a label is not worth failing for where it was built without.
    if not oiio.ImageBufAlgo.render_text(strip, 6, BAR - 9, text, TEXT_SIZE, "DroidSans", (0.95, 0.95, 0.95)):
        oiio.geterror()
    result: Pixels = np.asarray(strip.get_pixels(oiio.FLOAT)).reshape(BAR, width, 3)
    return result


def _magma(values: NDArray[np.float32]) -> Pixels:
    """FLIP's own colours for 0..1: black, violet, orange, pale yellow."""
    import OpenImageIO as oiio  # noqa: N813

    colored = oiio.ImageBufAlgo.color_map(oiio.ImageBuf(np.ascontiguousarray(values[:, :, np.newaxis])), 0, "magma")
    result: Pixels = np.asarray(colored.get_pixels(oiio.FLOAT)).reshape(*values.shape, 3)
    return result
