"""Looks for the deviations that lead from a scene to a picture.

One at a time, then all pairs that can have an effect, then triples that hold one of the best pairs; and once more,
beside those that were found, in the pixels that they leave unexplained. Each set is tried on few pixels first, and the
best on more. A deviation is believed only if it makes many of the differing pixels right.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np

from converter.why.likeness import SQUARE, Likeness, Mask, errors, square_of
from converter.why.picture import Picture
from converter.why.sample import Sample, choose
from converter.why.student import Causes, Deviation, Places, Student, after_tracing, deviations
from converter.why.trials import Trials, compatible

NOTHING: Causes = frozenset()

_ROUNDING = "rounding"
"""The group of deviations that change a level by one: looked for at the end, where all else is explained."""
_RIGHT = 0.02
"""Share of the wrong pixels that a set may leave to be right but for some pixels at edges."""
_SCREEN_SECONDS = 0.25
"""Time for tracing one set in the whole picture; where it would take longer, a random part of it is traced."""
_PAIR_SECONDS = 0.5
"""Time for the first round of all pairs."""
_AS_GOOD = 0.03
"""How much worse, of its loss, a deviation may be that explains as much as another."""
_ROUNDED, _TELLING, _SURE = 4000, 24, 0.9
"""Pixels that are looked at for roundings; channels that have to tell one; share of them that has to agree."""
_PAIR_PIXELS = (10, 32)
"""Pixels, least and most, of that round."""
_EFFECT = 80
"""Pixels in one of which a deviation has to change something to be tried in pairs."""
_MOST_CAUSES = 5
_FEW, _FEW_OF_SMALL = 0.001, 0.05
"""Share of the pixels that may be wrong in a picture that is right, as for `compare`; and in a small one."""
_EQUALS, _EQUAL = 6, 0.01
"""Sets that are told apart by more pixels, at most, and how much their losses may differ."""
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
        without: for each cause how many are wrong with all the others.
        likeness: when pixels count as the same.

    """

    causes: tuple[str, ...]
    alternatives: dict[str, tuple[str, ...]]
    screen: Screen
    before: Mask
    after: Mask
    without: dict[str, int]
    likeness: Likeness

    @property
    def right(self) -> bool:
        """Whether the picture is right as it is, as far as can be told."""
        few = max(min(self.likeness.fewest - 1, _FEW_OF_SMALL * len(self.before)), _FEW * len(self.before))
        return not self.causes and bool(self.before.sum() <= few)


def find_causes(
    student: Student,
    theirs: Picture,
    reference: Picture,
    likeness: Likeness,
    blank: Mask | None = None,
    timed: bool = True,
) -> Found:
    """The deviations that lead from the scene to `theirs`, as far as they can be found.

    Args:
        student: the tracer, of the scene and the picture's size.
        theirs: the picture.
        reference: the right one, of the same size.
        likeness: when pixels count as the same.
        blank: (height,) rows that are not looked at.
        timed: look at fewer pixels where they take long; else the same answer comes out on every machine.

    """
    judged = likeness.judged(student.width, student.height)
    if blank is not None:
        judged[_with_whole_squares(blank) if likeness.lossy else blank] = False
    return _Search(student, theirs, reference, likeness, judged, timed).run()


def _with_whole_squares(rows: Mask) -> Mask:
    """The rows, and those that share squares with them."""
    squares = np.flatnonzero(rows) // SQUARE
    result: Mask = np.isin(np.arange(len(rows)) // SQUARE, squares)
    return result


class _Search:
    def __init__(
        self, student: Student, theirs: Picture, reference: Picture, likeness: Likeness, judged: Mask, timed: bool
    ) -> None:
        self.student, self.theirs, self.likeness = student, theirs, likeness
        self.trials = Trials(student, likeness, timed)
        self.judged = judged
        places = _places(self.judged)
        xs, ys = places.T
        self.wrong = np.zeros_like(self.judged)
        self.wrong[ys, xs] = likeness.wrong(reference[ys, xs], theirs[ys, xs], places)
        self.candidates: list[Deviation] = [d for d in student.candidates() if d.group != _ROUNDING]
        self._counted: dict[Causes, Mask] = {}
        self.screen = Screen(places, True)  # until it is known how long a pixel takes

    def run(self) -> Found:
        best, alternatives = NOTHING, {}
        if self.wrong.sum() >= self.likeness.fewest:
            sample = choose(self.theirs, self.wrong, self.judged & ~self.wrong)
            self.trials.errors(sample, [NOTHING])
            self.screen = self._screen()
            best, sample = self._grown(self._best_of_few(sample), sample)
            best = self._pruned(best)
            if not self._explains_enough(best):
                best = NOTHING
            alternatives = {cause: self._alternatives(best, cause, sample) for cause in best}
        return self._found(best | self._rounding(best), alternatives)

    # ---- One at a time, pairs, triples ------------------------------------------------------------------------------

    def _best_of_few(self, sample: Sample) -> Causes:
        singles = self.trials.race(sample, [NOTHING, *(frozenset((d.name,)) for d in self.candidates)])
        singles = self._with_best_first(singles)
        if self._is_right(singles[0][1]):
            return singles[0][1]
        few = sample.first(_EFFECT)
        alone = self.trials.errors(few, [NOTHING, *(frozenset((d.name,)) for d in self.candidates)])
        effective = [d.name for d, wrong in zip(self.candidates, alone[1:], strict=True) if (wrong != alone[0]).any()]
        pairs = [frozenset(pair) for pair in combinations(effective, 2) if compatible(pair)]
        first = int(np.clip(_PAIR_SECONDS / self.trials.pixel_seconds / max(len(pairs), 1), *_PAIR_PIXELS))
        best_pairs = self._with_best_first(self.trials.race(sample, pairs, first)) if pairs else []
        best = min(singles[0], *best_pairs[:1], key=lambda pair: pair[0] + 0.01 * len(pair[1]))
        if self._is_right(best[1]):
            return best[1]
        seeds = [causes for _, causes in (*best_pairs[:_BEAM], *singles[:3]) if causes]
        triples = {seed | {d.name} for seed in seeds for d in self.candidates if d.name not in seed}
        ordered = sorted((t for t in triples if compatible(t)), key=sorted)
        best_triples = self.trials.race(sample, ordered, _PAIR_PIXELS[1]) if ordered else []
        return min(best, *best_triples[:1], key=lambda pair: pair[0] + 0.01 * len(pair[1]))[1]

    def _with_best_first(self, ranked: list[tuple[float, Causes]]) -> list[tuple[float, Causes]]:
        """Sets, best first, of which those that the sample cannot tell apart are told apart by the whole screen.

        Few of the pixels that are right are in the sample, so that a set may spoil others unseen.
        """
        equal = [pair for pair in ranked[:_EQUALS] if pair[0] <= ranked[0][0] + _EQUAL]
        if len(equal) > 1:
            equal.sort(key=lambda pair: (len(pair[1]), int(self._wrong(pair[1]).sum())))
        return equal + ranked[len(equal) :]

    # ---- Among the pixels that are left -----------------------------------------------------------------------------

    def _grown(self, causes: Causes, sample: Sample) -> tuple[Causes, Sample]:
        """`causes` with more beside them, or some of them exchanged, that explain what they leave."""
        for turn in range(1, _MOST_CAUSES):
            left = self._wrong(causes)
            if left.sum() < self.likeness.fewest:
                break
            wrong, same = np.zeros_like(self.judged), np.zeros_like(self.judged)
            xs, ys = self.screen.places.T
            wrong[ys, xs], same[ys, xs] = left, ~left
            closer = choose(self.theirs, wrong, same, seed=turn)
            sets = {causes, *(causes | {d.name} for d in self.candidates)}
            sets |= {causes - {c} | {d.name} for c in causes for d in self.candidates}
            best = self.trials.race(closer, sorted((s for s in sets if compatible(s)), key=sorted))
            sample = sample.with_others(closer)
            grown = next((s for _, s in best if s != causes), causes)
            if not self._gains(left, self._wrong(grown)):
                break
            causes = grown
        return causes, sample

    def _gains(self, before: Mask, after: Mask) -> bool:
        gained = int(before.sum()) - int(after.sum())
        return gained >= self.likeness.fewest and gained >= self.likeness.gain * before.sum()

    def _is_right(self, causes: Causes) -> bool:
        return bool(self._wrong(causes).sum() <= _RIGHT * self._wrong(NOTHING).sum())

    def _pruned(self, causes: Causes) -> Causes:
        """`causes` without those that explain next to nothing."""
        for name in sorted(causes):
            fewer = causes - {name}
            if not self._gains(self._wrong(fewer), self._wrong(causes)):
                causes = fewer
        return causes

    def _explains_enough(self, causes: Causes) -> bool:
        return bool(causes) and self._gains(self._wrong(NOTHING), self._wrong(causes))

    def _alternatives(self, causes: Causes, name: str, sample: Sample) -> tuple[str, ...]:
        """Other deviations that explain as much as `name` does among `causes`."""
        others = [d.name for d in self.candidates if d.name not in causes and compatible(causes - {name} | {d.name})]
        for part in (sample.first(160), sample):
            sets = [causes, *(causes - {name} | {other} for other in others)]
            losses = self.trials.losses(part, sets)
            as_good = losses[1:] <= losses[0] * (1 + _AS_GOOD) + _AS_GOOD / 10
            others = [other for other, good in zip(others, as_good, strict=True) if good]
        most = (1 + _AS_GOOD) * int(self._wrong(causes).sum()) + _AS_GOOD * int(self._wrong(NOTHING).sum())
        return tuple(other for other in others if self._wrong(causes - {name} | {other}).sum() <= most)

    # ---- Roundings of colours ---------------------------------------------------------------------------------------

    def _rounding(self, causes: Causes) -> Causes:
        """How colours become levels, where that can be told: by the levels in which the ways differ."""
        ways = [d for d in deviations().values() if d.group == _ROUNDING]
        if self.likeness.lossy or not ways:
            return NOTHING
        chosen = np.random.default_rng(1).permutation(len(self.screen.places))[:_ROUNDED]
        places = self.screen.places[chosen]
        xs, ys = places.T
        theirs = self.theirs[ys, xs]
        after = after_tracing(causes)
        colors = self.student.colors(places, [causes - after])[0]
        nearest = self.student.levels(colors, after)
        near = errors(nearest, theirs) <= self.likeness.tolerance
        best, best_share = NOTHING, 0.0
        for way in ways:
            levels = self.student.levels(colors, after | {way.name})
            tells = (levels != nearest) & near[:, np.newaxis]
            if tells.sum() >= _TELLING and (levels == theirs)[tells].mean() >= _SURE:
                exact = float((levels == theirs)[near].mean())
                if exact > best_share:
                    best, best_share = frozenset((way.name,)), exact
        return best

    # ---- Counting ---------------------------------------------------------------------------------------------------

    def _screen(self) -> Screen:
        places = _places(self.judged)
        most = max(20000, int(_SCREEN_SECONDS / self.trials.pixel_seconds))
        if len(places) <= most:
            return Screen(places, True)
        random = np.random.default_rng(2)
        if not self.likeness.lossy:
            return Screen(places[np.sort(random.choice(len(places), most, replace=False))], False)
        number = square_of(places)
        squares = np.unique(number)
        chosen = random.permutation(squares)[: most * len(squares) // len(places)]
        return Screen(places[np.isin(number, chosen)], False)

    def _wrong(self, causes: Causes) -> Mask:
        """(n,) which pixels of the screen are wrong with these causes."""
        xs, ys = self.screen.places.T
        if not causes:
            base: Mask = self.wrong[ys, xs]
            return base
        if causes not in self._counted:
            levels = self.student.drawn(self.screen.places, causes)
            self._counted[causes] = self.likeness.wrong(levels, self.theirs[ys, xs], self.screen.places)
        return self._counted[causes]

    def _found(self, causes: Causes, alternatives: dict[str, tuple[str, ...]]) -> Found:
        before, after = self._wrong(NOTHING), self._wrong(causes)

        without = {cause: int(self._wrong(causes - {cause}).sum()) for cause in causes}
        ordered = tuple(sorted(causes, key=lambda cause: (-without[cause], cause)))
        return Found(ordered, alternatives, self.screen, before, after, without, self.likeness)


def _places(mask: Mask) -> Places:
    ys, xs = np.nonzero(mask)
    return np.stack((xs, ys), axis=1).astype(np.int32)
