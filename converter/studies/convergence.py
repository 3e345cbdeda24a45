"""How the error of a sampled scene falls with the number of samples, and with the time that they take."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from statistics import median

import numpy as np

from converter.compare.metrics import Pixels, compare_pixels
from converter.renderers.base import Renderer, RendererUnavailable
from converter.renderers.methods import Method, find_method
from converter.renderers.native import NativeRenderer
from converter.scene.model import Scene
from converter.scene.settings import Settings

MOST_SAMPLES = 1024
"""Rays a pixel up to which curves are drawn, where nobody asks for another number."""
STEP = 4
"""From one number of samples to the next; 1 and this are square numbers, and so are all."""
TRUTH = 4
"""How many times as many samples as the longest curve the two pictures have whose mean is the truth."""
SEEDS = (0x5EED0001, 0x5EED0002)
"""Of these two, added to the seed of the curves, which they must not share."""
LONGEST = 20.0
"""Seconds that a picture may take, by estimate; a curve ends before."""
ENOUGH = 1.0
"""Seconds of rendering after which a number of samples was drawn often enough."""
CURVES = ("native", "native:points=independent", "mitsuba")
"""The methods, where nobody says which."""

Tell = Callable[[str, float], None]
"""Told what is being done, and the finished share of everything (0..1)."""


@dataclass(frozen=True, slots=True)
class Truth:
    """What errors are measured against.

    Attributes:
        pixels: the mean of two pictures.
        samples: rays a pixel of each.
        error: RMS of the mean, estimated from how the pictures differ.
        seconds: that they took.

    """

    pixels: Pixels
    samples: int
    error: float
    seconds: float


@dataclass(slots=True)
class Point:
    """A picture: its rays a pixel, its error, and its times.

    Attributes:
        samples: rays a pixel.
        rms: of the channels' differences from the truth, without the truth's own error.
        seconds: of the render stage, of each run.

    """

    samples: int
    rms: float
    seconds: list[float] = field(default_factory=list)

    @property
    def warm(self) -> float:
        """The median time."""
        return median(self.seconds)


@dataclass(slots=True)
class Curve:
    """The pictures of a method, by ascending numbers of samples; or why it has none."""

    method: Method
    skipped: str | None = None
    points: list[Point] = field(default_factory=list)

    @property
    def slope(self) -> float | None:
        """The power of the number of samples with which the error falls: 1/2 for independent points.

        By least squares on logarithms, from `STEP` samples on: one sample has no stratum to be in. None where there are
        fewer than two errors.
        """
        known = [(math.log(p.samples), math.log(p.rms)) for p in self.points if p.samples >= STEP and p.rms > 0]
        if len(known) < 2:
            return None
        x, y = np.array(known).T
        return -float(np.polyfit(x, y, 1)[0])


@dataclass(frozen=True, slots=True)
class ConvergenceStudy:
    """All methods on a sampled scene."""

    file: Path
    settings: Settings
    truth: Truth
    curves: list[Curve]

    @property
    def drawn(self) -> list[Curve]:
        """Those that were not skipped."""
        return [curve for curve in self.curves if curve.skipped is None]


def default_methods() -> list[Method]:
    """What is compared where nobody says."""
    return [find_method(name) for name in CURVES]


def numbers_of_samples(most: int) -> list[int]:
    """1, 4, 16 and so on, up to `most`."""
    return [STEP**power for power in range(round(math.log(most, STEP)) + 1) if STEP**power <= most]


def measure_convergence(
    file: Path,
    scene: Scene,
    settings: Settings,
    methods: Sequence[Method],
    runs: int,
    variant: str | None = None,
    tell: Tell = lambda what, share: None,
) -> ConvergenceStudy:
    """Draw `scene`, read from `file`, by every method with ever more samples, up to `settings.samples`.

    Each picture is drawn up to `runs` times, for its time; what would take longer than `LONGEST` is left out.

    Raises:
        RendererUnavailable: the native tracer, which draws the truth, is not built, or cannot draw the scene.
        ValueError: a texture cannot be read.
        KeyboardInterrupt: Ctrl-C.

    """
    name = file.stem
    counts = numbers_of_samples(settings.samples or MOST_SAMPLES)
    truth = _truth(scene, replace(settings, samples=TRUTH * counts[-1]), lambda share: tell(f"{name}: truth", share))
    curves = []
    for k, method in enumerate(methods):

        def begun(count: int, k: int = k, method: Method = method) -> None:
            share = (k + count / (STEP * counts[-1])) / len(methods)
            tell(f"{name}: {method.name}, {count} samples", 0.5 + 0.5 * share)

        curve = Curve(method, method.missing() or method.unfit(scene))
        if curve.skipped is None:
            _draw(curve, scene, settings, counts, runs, variant, truth, begun)
        curves.append(curve)
    return ConvergenceStudy(file, settings, truth, curves)


def _truth(scene: Scene, settings: Settings, tell: Callable[[float], None]) -> Truth:
    started = time.perf_counter()

    def picture(number: int, seed: int) -> Pixels:
        chosen = replace(settings, seed=(settings.seed + seed) % 2**32)
        drawn = NativeRenderer().render(scene, chosen, lambda share: tell(0.25 * (number + share)))
        return np.asarray(drawn.pixels)

    first, second = (picture(number, seed) for number, seed in enumerate(SEEDS))
    # Half the difference of two independent pictures is as large, in the mean square, as the error of their mean.
    error = compare_pixels(first, second).rms / 2
    mean = ((first + second) / 2).astype(np.float32)
    return Truth(mean, settings.samples or 1, error, time.perf_counter() - started)


def _draw(
    curve: Curve,
    scene: Scene,
    settings: Settings,
    counts: Sequence[int],
    runs: int,
    variant: str | None,
    truth: Truth,
    begun: Callable[[int], None],
) -> None:
    """The curve's points; its first pictures, for which kernels may have to be compiled, are drawn once in vain."""
    renderer = curve.method.renderer(variant)
    try:
        for count in counts:
            begun(count)
            chosen = curve.method.settings(replace(settings, samples=count))
            if count in counts[:2]:
                renderer.render(scene, chosen)
            elif STEP * curve.points[-1].warm > LONGEST:
                break
            curve.points.append(_point(renderer, scene, chosen, runs, truth))
    except (RendererUnavailable, ValueError, MemoryError) as error:
        curve.skipped = str(error) or "not enough memory"


def _point(renderer: Renderer, scene: Scene, settings: Settings, runs: int, truth: Truth) -> Point:
    rendering = renderer.render(scene, settings)
    found = compare_pixels(truth.pixels, np.asarray(rendering.pixels)).rms
    point = Point(settings.samples or 1, math.sqrt(max(0.0, found**2 - truth.error**2)))
    point.seconds.append(rendering.seconds["render"])
    while len(point.seconds) < runs and sum(point.seconds) < ENOUGH:
        point.seconds.append(renderer.render(scene, settings).seconds["render"])
    return point
