"""Runs methods on families of scenes, and tells up to which value each holds."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from converter.analysis.regions.warnings import method_warnings
from converter.compare.metrics import Difference, Pixels, compare_pixels
from converter.renderers.methods import Method
from converter.scene.geometry import check_geometry
from converter.scene.model import Scene
from converter.scene.settings import Settings
from converter.studies.family import Case, Family, Truth
from converter.studies.worker import CERTIFICATE, DrawingFailed, TookTooLong

LONGEST = 40.0
"""Seconds of CPU time after which a picture is given up, and its method for the harder values of the family."""
LONGEST_TRUTH = 240.0
"""The same of a truth that is drawn."""
LONGEST_CERTIFICATE = 60.0
"""The same of a truth that is proven."""
FEW = 0.01
"""Share of the pixels up to which wrong ones are single ones, at edges: what a method's description tells of."""
PLAIN = 0.2
"""Share of wrong pixels from which on anyone sees that something is wrong."""
TRUTH = "native-long-double"
"""The method that draws the truths for which there is no closed form, where nothing is proven of them."""

Tell = Callable[[str, float], None]
"""Told what is being done, and the finished share of everything (0..1)."""


class Draws(Protocol):
    """A `Worker`, or what stands in for one."""

    def render(self, method: str, variant: str | None, scene: Scene, settings: Settings, seconds: float) -> Pixels:
        """The picture of `scene` by a method, within so many seconds of CPU time."""
        ...


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a method made of a family's scene at a value.

    Attributes:
        value: the stressed number.
        difference: of its picture from the truth; None if there is no picture.
        failure: why there is none.
        allowed: share of the pixels that may differ.
        warned: whether someone who draws the scene by the method is told that it may fail, or the scene is refused.
        pixels, truth: of the first picture that fails plainly, and where none does of the first that fails, else None.

    """

    value: float
    difference: Difference | None
    failure: str | None
    allowed: float
    warned: bool = False
    pixels: Pixels | None = None
    truth: Truth | None = None

    @property
    def share(self) -> float:
        """Of the pixels that differ by more than 1/255; 1 if there is no picture."""
        return 1.0 if self.difference is None else self.difference.disagreeing / self.difference.pixels

    @property
    def holds(self) -> bool:
        """Whether there is a picture, and it is right."""
        return self.difference is not None and self.share <= self.allowed

    @property
    def silent(self) -> bool:
        """Whether more than single pixels are wrong, and nothing tells so."""
        return not self.warned and self.difference is not None and self.share > self.allowed + FEW


@dataclass(frozen=True, slots=True)
class FamilyStudy:
    """All methods on a family: for each, by its name, the outcomes in the order of the family's values.

    Attributes:
        family: the family.
        outcomes: none for a method that is missing on this machine.
        broken: values of which there is no truth, and why.

    """

    family: Family
    outcomes: Mapping[str, Sequence[Outcome]]
    broken: Mapping[float, str]

    def first_failures(self, method: str) -> list[int]:
        """Indices of the outcomes with which a method fails first: one at most, or one on either side."""
        outcomes = self.outcomes[method]
        start = easiest(self.family, [outcome.value for outcome in outcomes])
        ways = [range(start, len(outcomes))]
        if self.family.both_ways:
            ways.append(range(start, -1, -1))
        return sorted({i for way in ways for i in [next((k for k in way if not outcomes[k].holds), -1)] if i >= 0})

    def held(self, method: str) -> tuple[float, float] | None:
        """The first and the last of the values up to which a method holds; None if it fails at the easiest."""
        outcomes = self.outcomes[method]
        start = easiest(self.family, [outcome.value for outcome in outcomes])
        failures = self.first_failures(method)
        if not outcomes or start in failures:
            return None
        first = max((i + 1 for i in failures if i < start), default=0)
        last = min((i - 1 for i in failures if i > start), default=len(outcomes) - 1)
        return outcomes[first].value, outcomes[last].value


def easiest(family: Family, values: Sequence[float]) -> int:
    """Index of the value to start from: the first, or, where both ways lead to trouble, the one nearest 1."""
    if not family.both_ways:
        return 0
    return min(range(len(values)), key=lambda i: abs(math.log10(values[i])), default=0)


def study_family(
    family: Family,
    methods: Sequence[Method],
    worker: Draws,
    variant: str | None = None,
    tell: Tell = lambda what, share: None,
) -> FamilyStudy:
    """Draw the scenes of a family by every method, from easy to hard.

    A method that takes too long with one is not asked for harder ones.

    Raises:
        KeyboardInterrupt: Ctrl-C.

    """
    outcomes: dict[str, dict[int, Outcome]] = {method.name: {} for method in methods}
    broken: dict[float, str] = {}
    given_up: set[tuple[Method, bool]] = set()
    start = easiest(family, family.values)
    order = sorted(range(len(family.values)), key=lambda i: abs(i - start))
    for done, index in enumerate(order):
        value, before = family.values[index], index < start
        case = family.case(value)
        tell(f"{family.name} {value:.3g}", done / len(order))
        refused = bool(check_geometry(case.scene))
        try:
            truth = _truth(case, worker)
        except DrawingFailed as error:
            broken[value] = str(error)
            continue
        for k, method in enumerate(methods):
            tell(f"{family.name} {value:.3g}: {method.name}", (done + k / len(methods)) / len(order))
            # Of POV-Ray nobody is warned.
            known = method.arithmetic is not None
            warned = refused or not known or bool(method_warnings(case.scene, case.settings, method))
            try:
                if (method, before) in given_up:
                    raise DrawingFailed("not asked, for an easier one took too long")
                pixels = _draw(case, method, worker, variant)
            except DrawingFailed as error:
                outcome = Outcome(value, None, str(error), case.allowed, warned)
                if isinstance(error, TookTooLong):
                    given_up.add((method, before))
            else:
                difference = compare_pixels(truth.astype(np.float32), pixels)
                outcome = Outcome(value, difference, None, case.allowed, warned, pixels, truth)
            outcomes[method.name][index] = outcome
    ordered = {name: tuple(found[i] for i in sorted(found)) for name, found in outcomes.items()}
    study = FamilyStudy(family, ordered, broken)
    return FamilyStudy(family, {name: _slim(study, name) for name in ordered}, broken)


def _truth(case: Case, worker: Draws) -> Truth:
    if case.truth is not None:
        return case.truth
    try:
        proven = worker.render(CERTIFICATE, None, case.scene, case.settings, LONGEST_CERTIFICATE)
    except DrawingFailed:  # it is sampled, for one
        return worker.render(TRUTH, None, case.scene, case.settings, LONGEST_TRUTH).astype(np.float64)
    if np.isfinite(proven).all():
        return proven.astype(np.float64)
    drawn = worker.render(TRUTH, None, case.scene, case.settings, LONGEST_TRUTH)
    return np.where(np.isfinite(proven), proven, drawn).astype(np.float64)


def _draw(case: Case, method: Method, worker: Draws, variant: str | None) -> Pixels:
    if reason := method.unfit(case.scene):
        raise DrawingFailed(reason)
    own = variant if method.family == "mitsuba" and "variant" not in method.options else None
    return worker.render(method.name, own, case.scene, case.settings, LONGEST)


def _slim(study: FamilyStudy, method: str) -> tuple[Outcome, ...]:
    """A method's outcomes, of which only the one that shows best how it fails keeps its picture: the first plain one,
    or else the worst.
    """
    outcomes = study.outcomes[method]
    start = easiest(study.family, [outcome.value for outcome in outcomes])
    wrong = [i for i, o in enumerate(outcomes) if o.pixels is not None and not o.holds]
    kept = min(wrong, key=lambda i: (-min(outcomes[i].share, PLAIN), abs(i - start)), default=None)
    return tuple(o if i == kept else replace(o, pixels=None, truth=None) for i, o in enumerate(outcomes))
