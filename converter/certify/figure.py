"""A certificate as a picture."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from converter.certify.certificate import REASONS, Certificate
from converter.images.write import write_image

_GAP = 4
_COLORS = np.array(
    [
        (0.10, 0.10, 0.10),  # certified
        (0.60, 0.60, 0.60),  # byte
        (0.90, 0.25, 0.20),  # hit
        (0.95, 0.60, 0.15),  # plane
        (0.95, 0.90, 0.25),  # tile
        (0.55, 0.85, 0.30),  # texel
        (0.25, 0.45, 0.95),  # shadow
        (0.25, 0.80, 0.85),  # facing
        (0.75, 0.35, 0.90),  # reflection
        (0.95, 0.55, 0.80),  # cutoff
        (1.00, 1.00, 1.00),  # division
        (0.80, 0.75, 0.55),  # range
        (0.45, 0.30, 0.15),  # degenerate
    ],
    np.float32,
)
"""Of a certified pixel, and of each reason."""
_WRONG = np.array((1, 0.15, 0.1), np.float32)
assert len(_COLORS) == len(REASONS) + 1


def draw_certificate(
    certificate: Certificate, misses: Sequence[NDArray[np.int16]], file: Path, ending: str | None = None
) -> None:
    """The certified picture, the undecided pixels in a colour for each reason, and those that any method gets wrong, in
    red, side by side.
    """
    certified = certificate.certified[..., None]
    picture = np.where(certified, certificate.low / np.float32(255), _COLORS[certificate.undecided]).astype(np.float32)
    wrong = np.zeros(certificate.undecided.shape, np.bool_)
    for miss in misses:
        wrong |= miss > 0
    judged = np.where(wrong[..., None], _WRONG, np.float32(0.25) * picture)
    height = len(picture)
    gap = np.ones((height, _GAP, 3), np.float32)
    whole = np.concatenate([picture, gap, _COLORS[certificate.undecided], gap, judged], axis=1).astype(np.float32)
    write_image(file, np.ascontiguousarray(whole), whole.shape[1], height, ending)
