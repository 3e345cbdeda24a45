"""FLIP: how much a viewer who flips between two pictures sees change (Andersson et al., HPG 2020)."""

from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from converter.compare.metrics import Pixels, check_sizes


def has_flip() -> bool:
    """Whether FLIP's package is installed: there is none for some platforms."""
    return find_spec("flip_evaluator") is not None


def flip_map(reference: Pixels, test: Pixels) -> NDArray[np.float32]:
    """(height, width) error in 0..1, of the pictures clamped to 0..1 and taken as linear RGB; 1 where a value is NaN.

    Raises:
        SizeMismatch: their sizes differ.

    """
    import flip_evaluator

    check_sizes(reference, test)
    unknown = np.isnan(reference).any(axis=2) | np.isnan(test).any(axis=2)
    images = [
        np.ascontiguousarray(np.clip(np.nan_to_num(p, nan=0.0), 0, 1), dtype=np.float32) for p in (reference, test)
    ]
    error, _, _ = flip_evaluator.evaluate(*images, "LDR", inputsRGB=False, applyMagma=False, computeMeanError=False)
    result: NDArray[np.float32] = np.array(error, dtype=np.float32).reshape(unknown.shape)
    result[unknown] = 1
    return result
