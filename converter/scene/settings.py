"""How to draw a scene: everything that the command line may change and the scene file does not say."""

from typing import Literal

from converter.frozen import dataclass
from converter.scene.model import Color

PixelSample = Literal["corner", "center"]
Specular = Literal["phong", "blinn"]
Points = Literal["stratified", "independent"]
IorReading = Literal["auto", "ratio", "index"]

Crop = tuple[int, int, int, int]
"""A part of a picture: the column and row of its first pixel, and those behind its last."""

MAX_SIZE = 1_000_000
MAX_SAMPLES = 65536
MAX_SEED = 2**32 - 1
MOST_THREADS = 1024
SAMPLES = 16
"""Rays per pixel of a scene that is sampled, where nobody asks for another number."""
ADAPTIVE_SAMPLES = 196
"""The same where some pixels get more rays than others; a pass has 14 of them."""


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings that every renderer obeys in the same way; the defaults are the format's own.

    Attributes:
        width, height: picture size in pixels.
        pixel: where in a pixel its ray passes, the top-left corner or the centre.
        specular: Phong's max(0, r.v) or Blinn's max(0, n.h), both raised to alpha.
        ior: read a finish's `ior` as n1/n2 up to 1 and as n2/n1 above ("auto"), or always as one of them.
        background: linear RGB for rays that hit nothing; None means the ambient light's colour.
        cutoff: a ray whose weight (the product of kr and kt so far) is below it is not traced.
        max_depth: bounces after the primary ray; None means as many as the cut-off asks for, within limits.
        samples: rays per pixel, a square number n * n laid out as a grid; None means as many as `rays_a_pixel` tells.
        seed: start of the random numbers of scenes that are sampled.
        points: random numbers of a pixel's samples that are stratified, or independent: to see what that is worth.
        threads: worker threads; 0 means one for each core.
        crop: what is drawn of the picture; None is all of it. Its pixels are those of the whole.

    """

    width: int = 800
    height: int = 600
    pixel: PixelSample = "corner"
    specular: Specular = "phong"
    ior: IorReading = "auto"
    background: Color | None = None
    cutoff: float = 1 / 512
    max_depth: int | None = None
    samples: int | None = None
    seed: int = 0
    points: Points = "stratified"
    threads: int = 0
    crop: Crop | None = None

    @property
    def drawn(self) -> Crop:
        """The part of the picture that is drawn, be it all."""
        return self.crop or (0, 0, self.width, self.height)

    @property
    def drawn_size(self) -> tuple[int, int]:
        """Columns and rows that are drawn."""
        left, top, right, bottom = self.drawn
        return right - left, bottom - top

    def rays_a_pixel(self, sampled: bool = False) -> int:
        """How many rays a pixel has, in a scene in which something is random, or not."""
        if self.samples is None:
            return SAMPLES if sampled else 1
        return self.samples
