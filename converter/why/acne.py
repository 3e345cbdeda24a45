"""Tells acne: speckles where rays meet the surface that they start on, for no distance is kept from it.

Roundings decide which pixels have it, so that no two programs have it in the same ones. But they have it in the same
places, as much of it, and as finely strewn.
"""

import numpy as np
from numpy.typing import NDArray

from converter.why.likeness import SQUARE, Likeness, Mask, errors
from converter.why.picture import Picture
from converter.why.student import Causes, Student

ACNE = "epsilon_none"
"""The deviation."""

_MOST = 400
"""Squares that are looked at."""
_LEAST = 0.003
"""Share of the pixels that are speckled, at least."""
_ALIKE = 0.88
"""Correlation of how many pixels are wrong in each square."""
_AS_MUCH, _AS_FINE = 1.8, 1.3
"""Factors by which the number of wrong pixels, and of borders between wrong and right ones, may differ."""


def has_acne(student: Student, theirs: Picture, causes: Causes, likeness: Likeness) -> bool:
    """Whether the pixels that `causes` leave wrong are those of acne."""
    if any(name.startswith("epsilon") for name in causes):
        return False
    places = _squares(student.width, student.height)
    if not len(places):
        return False
    xs, ys = places.reshape(-1, 2).T
    expected = student.drawn(places.reshape(-1, 2), causes)
    wrong = _as_squares(errors(theirs[ys, xs], expected) > likeness.tolerance)
    if wrong.mean() < _LEAST:
        return False
    with_it = student.drawn(places.reshape(-1, 2), causes | {ACNE})
    acne = _as_squares(errors(with_it, expected) > likeness.tolerance)
    if acne.mean() < _LEAST or not _near(wrong.mean(), acne.mean(), _AS_MUCH):
        return False
    counts = wrong.sum(axis=(1, 2)), acne.sum(axis=(1, 2))
    if min(np.ptp(count) for count in counts) == 0:
        return False
    return bool(np.corrcoef(*counts)[0, 1] >= _ALIKE and _near(_fineness(wrong), _fineness(acne), _AS_FINE))


def _squares(width: int, height: int) -> NDArray[np.int32]:
    """(squares, SQUARE * SQUARE, 2) columns and rows of pixels of random squares."""
    columns, rows = width // SQUARE, height // SQUARE
    chosen = np.random.default_rng(4).permutation(columns * rows)[:_MOST]
    corners = SQUARE * np.stack((chosen % max(columns, 1), chosen // max(columns, 1)), axis=1)
    inside = np.array([(x, y) for y in range(SQUARE) for x in range(SQUARE)])
    places: NDArray[np.int32] = (corners[:, np.newaxis] + inside).astype(np.int32)
    return places


def _as_squares(mask: Mask) -> Mask:
    return mask.reshape(-1, SQUARE, SQUARE)


def _fineness(wrong: Mask) -> float:
    """Share of the wrong pixels whose left neighbour is right."""
    beside, here = wrong[:, :, :-1], wrong[:, :, 1:]
    return float((here & ~beside).sum() / max(here.sum(), 1))


def _near(one: float, other: float, factor: float) -> bool:
    return one <= factor * other and other <= factor * one
