"""Rows of a picture in which nothing was drawn: they say nothing of mistakes, but that the program ended too early."""

import numpy as np

from converter.why.likeness import EXACT, Mask, errors
from converter.why.picture import Picture

_LEAST = 0.05
"""Share of the rows that are blank, at least, for it to be told."""


def blank_rows(theirs: Picture, reference: Picture) -> Mask:
    """(height,) rows at the top or the bottom that have one colour all over, where the right picture has more."""
    height = len(theirs)
    result = np.zeros(height, np.bool_)
    for rows in (slice(None), slice(None, None, -1)):
        plain = (errors(theirs[rows], theirs[rows][:1, :1]) == 0).all(axis=1)
        count = height if plain.all() else int(np.argmin(plain))
        part = reference[rows][:count]
        if count and count >= _LEAST * height and (errors(part, part[:1, :1]) > EXACT.tolerance).mean() > _LEAST:
            result[rows][:count] = True
    return result


def told_rows(blank: Mask) -> str:
    """`rows 0 to 9 and 90 to 99`."""
    edges = np.flatnonzero(np.diff(np.concatenate(([0], blank.astype(np.int8), [0]))))
    return "rows " + " and ".join(f"{a} to {b - 1}" for a, b in edges.reshape(-1, 2))
