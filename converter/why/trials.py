"""Tracers with some deviations, tried on some pixels: how well each draws the picture, and which do it best."""

import time
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from converter.why.likeness import Errors, Likeness, errors
from converter.why.sample import Sample
from converter.why.student import Causes, Student, after_tracing, deviations

Losses = NDArray[np.float64]

_ROUNDS = ((32, 0.1, 20), (64, 0.1, 12), (200, 0.1, 6))
"""Rounds of a race: the pixels that are looked at, and the share and the least number of sets that pass. A last one is
run on all pixels."""
_FAR = 64
"""Levels from which on a pixel is as wrong as can be."""
_NEAR_LOSS = 0.2
"""How much it counts how wrong wrong pixels are: it shows a way where no set is right yet. After compression with
losses, which leaves no pixel right, nothing else counts."""
_TIMED = 500
"""Pixels of which the time is worth anything."""
_PIXEL_SECONDS = 3e-6
"""What a pixel takes where it is not measured."""
_MOST_AT_ONCE = 1 << 20
"""Pixels that are traced in one go: so many colours take 12 MiB."""


@dataclass(slots=True)
class Trials:
    """Tries sets of deviations on a sample.

    Attributes:
        student: the tracer.
        likeness: when pixels are the same.
        timed: whether it is measured how long pixels take; else the same work is done on every machine.
        pixel_seconds: about how long a pixel takes.

    """

    student: Student
    likeness: Likeness
    timed: bool = True
    pixel_seconds: float = field(default=_PIXEL_SECONDS)

    def errors(self, sample: Sample, sets: Sequence[Causes]) -> Errors:
        """(sets, n) by how many levels each set is wrong in each pixel."""
        result = np.empty((len(sets), len(sample)), np.int16)
        step = max(1, _MOST_AT_ONCE // max(len(sample), 1))
        for first in range(0, len(sets), step):
            result[first : first + step] = self._errors(sample, sets[first : first + step])
        return result

    def _errors(self, sample: Sample, sets: Sequence[Causes]) -> Errors:
        """Colours are traced once for all sets that differ only in what becomes of colours."""
        traced: dict[Causes, int] = {}
        by_levels: dict[Causes, list[tuple[int, int]]] = defaultdict(list)
        for i, causes in enumerate(sets):
            after = after_tracing(causes)
            by_levels[after].append((i, traced.setdefault(causes - after, len(traced))))
        started = time.perf_counter()
        colors = self.student.colors(sample.places, list(traced))
        count = len(traced) * len(sample)
        if self.timed and count >= _TIMED:
            self.pixel_seconds = (time.perf_counter() - started) / count
        result = np.empty((len(sets), len(sample)), np.int16)
        for after, pairs in by_levels.items():
            rows, sources = np.array(pairs).T
            levels = self.student.levels(colors[sources].reshape(-1, 3), after)
            result[rows] = errors(levels.reshape(len(rows), -1, 3), sample.theirs)
        return result

    def losses(self, sample: Sample, sets: Sequence[Causes]) -> Losses:
        """How badly each set draws the sample: 0 is right, 2 is wrong throughout."""
        return self.losses_of(self.errors(sample, sets), sample)

    def losses_of(self, wrong: Errors, sample: Sample) -> Losses:
        """The same, of (sets, n) errors: the mean over pixels that differ, and over those that do not."""
        near = 1.0 if self.likeness.lossy else _NEAR_LOSS
        pixel = (wrong > self.likeness.tolerance) * (1 - near) + np.minimum(wrong, _FAR) * (near / _FAR)
        result = np.zeros(len(wrong))
        for kind in (sample.differs, ~sample.differs):
            if kind.any():
                result += pixel[:, kind].mean(axis=1)
        return result

    def race(self, sample: Sample, sets: Sequence[Causes], first: int = _ROUNDS[0][0]) -> list[tuple[float, Causes]]:
        """The best sets with their losses, best first; most are given up after a few pixels, `first` of them."""
        for count, share, least in ((first, *_ROUNDS[0][1:]), *_ROUNDS[1:]):
            kept = max(least, int(share * len(sets)))
            if len(sets) > kept and len(sample) > count:
                losses = self.losses(sample.first(count), sets)
                sets = [sets[i] for i in np.argsort(losses, kind="stable")[:kept]]
        losses = self.losses(sample, sets)
        return sorted(
            zip(losses.tolist(), sets, strict=True), key=lambda pair: (pair[0], len(pair[1]), sorted(pair[1]))
        )


def compatible(causes: Iterable[str]) -> bool:
    """Whether one tracer can have all of these."""
    groups = [deviations()[name].group for name in causes]
    return len(set(groups)) == len(groups)
