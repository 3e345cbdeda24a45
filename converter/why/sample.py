"""Some pixels of a picture, on which tracers are tried: where it differs, and fewer where it does not."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from converter.why.likeness import Mask
from converter.why.picture import Picture
from converter.why.student import Levels, Places

DIFFERING, SAME = 1000, 500
"""Pixels that are looked at most of either kind."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Pixels in a random order.

    Attributes:
        places: (n, 2) their columns and rows.
        theirs: (n, 3) their levels in the picture that is judged.
        differs: (n,) whether they are of those that differ.

    """

    places: Places
    theirs: Levels
    differs: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.places)

    def first(self, count: int) -> "Sample":
        """Its first pixels."""
        return Sample(self.places[:count], self.theirs[:count], self.differs[:count])

    def with_others(self, other: "Sample") -> "Sample":
        """Both, one behind the other."""
        return Sample(
            np.concatenate((self.places, other.places)),
            np.concatenate((self.theirs, other.theirs)),
            np.concatenate((self.differs, other.differs)),
        )


def choose(theirs: Picture, differs: Mask, same: Mask, seed: int = 0) -> Sample:
    """Random pixels of those that differ and of those that do not, mixed.

    Args:
        theirs: the picture.
        differs: (height, width) pixels that differ from what is expected so far.
        same: those that do not; pixels in neither are not looked at.
        seed: of the choice.

    """
    random = np.random.default_rng(seed)
    one, other = _some(differs, DIFFERING, random), _some(same, SAME, random)
    ys, xs = np.divmod(np.concatenate((one, other)), theirs.shape[1])
    kinds = np.arange(len(one) + len(other)) < len(one)
    # Those that differ come as often as those that do not among the first of them, too.
    order = np.argsort(np.concatenate((_spread(len(one)), _spread(len(other)))), kind="stable")
    return Sample(np.stack((xs, ys), axis=1).astype(np.int32)[order], theirs[ys, xs][order], kinds[order])


def _some(mask: Mask, most: int, random: np.random.Generator) -> NDArray[np.int64]:
    indices = np.flatnonzero(mask)
    return random.permutation(indices)[:most] if len(indices) <= most else random.choice(indices, most, replace=False)


def _spread(count: int) -> NDArray[np.float64]:
    return (np.arange(count) + 0.5) / max(count, 1)
