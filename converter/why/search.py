"""Looks for the deviations that lead from a scene to a picture.

One at a time, then all pairs that can have an effect, then triples that hold one of the best pairs; and once more,
beside those that were found, in the pixels that they leave unexplained. Each set is tried on few pixels first, and the
best on more. A deviation is believed only if it makes many of the differing pixels right.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from converter.why.likeness import Likeness, Mask, errors
from converter.why.picture import Picture
from converter.why.sample import Sample, choose
from converter.why.student import Causes, Deviation, Places, Student, deviations
from converter.why.trials import Trials, compatible

NOTHING: Causes = frozenset()

_ROUNDING = "rounding"
"""The group of deviations that change a level by one: looked for at the end, where all else is explained."""
_RIGHT = 0.005
"""Loss of a set that is right but for some pixels at edges."""
_GAIN = 0.3
"""Share of the pixels unexplained so far that a deviation has to explain to be believed."""
_COMPRESSED_GAIN = 0.5
"""The same in a picture that was compressed with losses."""
_FEWEST = 6
"""Pixels that it has to explain at least."""
_SCREEN_SECONDS = 0.6
"""Time for tracing one set in the whole picture; where it would take longer, a random part of it is traced."""
_PAIR_SECONDS = 1.0
"""Time for the first round of all pairs."""
_MOST_CAUSES = 5
_BEAM = 8
"""Pairs of which triples are made."""


@dataclass(frozen=True, slots=True, eq=False)
class Screen:
    """The pixels that are counted: all that can be judged, or a random part of them.

    Attributes:
        places: (n, 2) their columns and rows.
        whole: whether they are all that can be judged.

    """

    places: Places
    whole: bool


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What leads from the scene to the picture.

    Attributes:
        causes: the deviations, those that explain most first.
        alternatives: for each of them others that would explain as much.
        screen: the pixels that were counted.
        before, after: (n,) which of them are wrong without and with the causes.
        likeness: when pixels count as the same.

    """

    causes: tuple[str, ...]
    alternatives: dict[str, tuple[str, ...]]
    screen: Screen
    before: Mask
    after: Mask
    likeness: Likeness

    @property
    def right(self) -> bool:
        """Whether the picture is right as it is."""
        return not self.causes and not self.before.any()


def find_causes(student: Student, theirs: Picture, reference: Picture, likeness: Likeness) -> Found:
    """The deviations that lead from the scene to `theirs`, as far as they can be found.

    Args:
        student: the tracer, of the scene and the picture's size.
        theirs: the picture.
        reference: the right one, of the same size.
        likeness: when pixels count as the same.

    """
    return _Search(student, theirs, reference, likeness).run()


class _Search:
    def __init__(self, student: Student, theirs: Picture, reference: Picture, likeness: Likeness) -> None:
        self.student, self.theirs, self.likeness = student, theirs, likeness
        self.trials = Trials(student, likeness)
        self.judged = likeness.judged(theirs)
        self.wrong = (errors(theirs, reference) > likeness.tolerance) & self.judged
        self.candidates: list[Deviation] = [d for d in student.candidates() if d.group != _ROUNDING]
        self._counted: dict[Causes, Mask] = {}
        self.gain = _COMPRESSED_GAIN if likeness.lossy else _GAIN

    def run(self) -> Found:
        sample = choose(self.theirs, self.wrong, self.judged & ~self.wrong)
        if self.wrong.sum() < _FEWEST:
            return self._found(NOTHING, self._screen(), {})
        best = self._best_of_few(sample)
        screen = self._screen()
        best, samples = self._grown(best, screen, sample)
        best = self._pruned(best, screen)
        if not self._explains_enough(best, screen):
            best = NOTHING
        rounding = self._rounding(best, screen)
        best |= rounding
        return self._found(best, screen, {c: self._alternatives(best, c, samples) for c in best - rounding})

    # ---- One at a time, pairs, triples --------------------------------------------------------------------------------

    def _best_of_few(self, sample: Sample) -> Causes:
        singles = self.trials.race(sample, [NOTHING, *(frozenset((d.name,)) for d in self.candidates)])
        if singles[0][0] <= _RIGHT:
            return singles[0][1]
        few = sample.first(160)
        alone = self.trials.errors(few, [NOTHING, *(frozenset((d.name,)) for d in self.candidates)])
        effective = [d.name for d, wrong in zip(self.candidates, alone[1:], strict=True) if (wrong != alone[0]).any()]
        pairs = [frozenset(pair) for pair in combinations(effective, 2) if compatible(pair)]
        first = int(np.clip(_PAIR_SECONDS / self.trials.pixel_seconds / max(len(pairs), 1), 16, 48))
        best_pairs = self.trials.race(sample, pairs, first) if pairs else []
        best = min(singles[0], *best_pairs[:1], key=lambda pair: pair[0] + 0.01 * len(pair[1]))
        if best[0] <= _RIGHT:
            return best[1]
        seeds = [causes for _, causes in (*best_pairs[:_BEAM], *singles[:3]) if causes]
        triples = {seed | {d.name} for seed in seeds for d in self.candidates if d.name not in seed}
        ordered = sorted((t for t in triples if compatible(t)), key=sorted)
        best_triples = self.trials.race(sample, ordered, 32) if ordered else []
        return min(best, *best_triples[:1], key=lambda pair: pair[0] + 0.01 * len(pair[1]))[1]

    # ---- Among the pixels that are left ---------------------------------------------------------------------------------

    def _grown(self, causes: Causes, screen: Screen, sample: Sample) -> tuple[Causes, Sample]:
        """`causes` with more beside them, or some of them exchanged, that explain what they leave."""
        for turn in range(1, _MOST_CAUSES):
            left = self._wrong(causes, screen)
            if left.sum() < _FEWEST:
                break
            wrong, same = np.zeros_like(self.judged), np.zeros_like(self.judged)
            xs, ys = screen.places.T
            wrong[ys, xs], same[ys, xs] = left, ~left
            closer = choose(self.theirs, wrong, same, seed=turn)
            sets = {causes, *(causes | {d.name} for d in self.candidates)}
            sets |= {causes - {c} | {d.name} for c in causes for d in self.candidates}
            best = self.trials.race(closer, sorted((s for s in sets if compatible(s)), key=sorted))
            sample = sample.with_others(closer)
            grown = next((s for _, s in best if s != causes), causes)
            if not self._gains(left, self._wrong(grown, screen)):
                break
            causes = grown
        return causes, sample

    def _gains(self, before: Mask, after: Mask) -> bool:
        gained = int(before.sum()) - int(after.sum())
        return gained >= _FEWEST and gained >= self.gain * before.sum()

    def _pruned(self, causes: Causes, screen: Screen) -> Causes:
        """`causes` without those that explain next to nothing."""
        for name in sorted(causes):
            fewer = causes - {name}
            if not self._gains(self._wrong(fewer, screen), self._wrong(causes, screen)):
                causes = fewer
        return causes

    def _explains_enough(self, causes: Causes, screen: Screen) -> bool:
        return bool(causes) and self._gains(self._wrong(NOTHING, screen), self._wrong(causes, screen))

    def _alternatives(self, causes: Causes, name: str, sample: Sample) -> tuple[str, ...]:
        """Other deviations that explain as much as `name` does among `causes`."""
        others = [d.name for d in self.candidates if d.name not in causes and compatible(causes - {name} | {d.name})]
        sets = [causes, *(causes - {name} | {other} for other in others)]
        wrong = self.trials.errors(sample.first(160), sets) > self.likeness.tolerance
        close = [i for i in range(1, len(sets)) if (wrong[i] == wrong[0]).mean() > 0.98]
        if not close:
            return ()
        wrong = self.trials.errors(sample, [causes, *(sets[i] for i in close)]) > self.likeness.tolerance
        allowed = wrong[0].sum() + 0.002 * len(sample)
        return tuple(others[i - 1] for i, row in zip(close, wrong[1:], strict=True) if row.sum() <= allowed)

    # ---- Roundings of colours -------------------------------------------------------------------------------------------

    def _rounding(self, causes: Causes, screen: Screen) -> Causes:
        """How colours become levels, where that can be told: by the levels in which the ways differ."""
        ways = [d for d in deviations().values() if d.group == _ROUNDING]
        if self.likeness.lossy or not ways:
            return NOTHING
        few = np.random.default_rng(1).permutation(len(screen.places))[:4000]
        places = screen.places[few]
        xs, ys = places.T
        theirs = self.theirs[ys, xs]
        after = frozenset(c for c in causes if deviations()[c].part == "levels")
        colors = self.student.colors(places, [causes - after])[0]
        nearest = self.student.levels(colors, after)
        near = errors(nearest, theirs) <= self.likeness.tolerance
        best, best_share = NOTHING, 0.0
        for way in ways:
            levels = self.student.levels(colors, after | {way.name})
            tells = (levels != nearest) & near[:, np.newaxis]
            if tells.sum() >= 24:
                share = float((levels == theirs)[tells].mean())
                exact = float((levels == theirs)[near].mean())
                if share >= 0.9 and exact > best_share:
                    best, best_share = frozenset((way.name,)), exact
        return best

    # ---- Counting -------------------------------------------------------------------------------------------------------

    def _screen(self) -> Screen:
        ys, xs = np.nonzero(self.judged)
        places = np.stack((xs, ys), axis=1).astype(np.int32)
        most = max(20000, int(_SCREEN_SECONDS / self.trials.pixel_seconds))
        if len(places) <= most:
            return Screen(places, True)
        chosen = np.sort(np.random.default_rng(2).choice(len(places), most, replace=False))
        return Screen(places[chosen], False)

    def _wrong(self, causes: Causes, screen: Screen) -> Mask:
        xs, ys = screen.places.T
        if not causes:
            return self.wrong[ys, xs]
        if causes not in self._counted:
            whole = Sample(screen.places, self.theirs[ys, xs], self.wrong[ys, xs])
            self._counted[causes] = self.trials.errors(whole, [causes])[0] > self.likeness.tolerance
        return self._counted[causes]

    def _found(self, causes: Causes, screen: Screen, alternatives: dict[str, tuple[str, ...]]) -> Found:
        before, after = self._wrong(NOTHING, screen), self._wrong(causes, screen)

        def left_without(name: str) -> tuple[int, str]:
            return -int(self._wrong(causes - {name}, screen).sum()), name

        ordered = tuple(sorted(causes, key=left_without)) if len(causes) > 1 else tuple(causes)
        return Found(ordered, alternatives, screen, before, after, self.likeness)
