"""What a region is, and what is found of it in a scene."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from converter.analysis.regions.situation import Floats, Situation
from converter.renderers.methods import Arithmetic
from converter.scene.errors import so_are


@dataclass(frozen=True, slots=True)
class Finding:
    """Something of a scene that is in a region: the line of the file where it stands (0: none), and what it is."""

    line: int
    text: str


@dataclass(frozen=True, slots=True)
class Region:
    """Scenes in which something is too small for the numbers that it is computed from.

    Attributes:
        families: of the stability study that lead into it; its limits lie between the last of their values that holds
            and the first at which more than single pixels are wrong.
        limits: for each arithmetic that fails there the smallest share that it can do with.
        find: what of a scene is smaller than a limit: nothing, or the worst, with a word on how many others are. It
            runs with NumPy's errors ignored, for numbers may be as large as they like.

    """

    families: tuple[str, ...]
    limits: Mapping[Arithmetic, float]
    find: Callable[[Situation, float], Iterator[Finding]]


def worst(shares: Floats, limit: float) -> Iterator[tuple[int, str]]:
    """The index of the smallest share, if that is below a limit, and a word on how many others are."""
    beyond = np.flatnonzero(shares < limit)
    if len(beyond):
        yield int(beyond[np.argmin(shares[beyond])]), so_are(len(beyond) - 1)
