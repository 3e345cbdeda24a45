"""What anti-aliasing costs and is worth: as many rays in every pixel, or more where pixels are unlike."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any, Literal

import numpy as np

from converter.renderers.adaptive import Adapting
from converter.renderers.base import AdaptiveRenderer, Renderer, Rendering, draws_adaptively
from converter.renderers.methods import Family, Method, find_method
from converter.renderers.povray import PovrayRenderer, Supersampling
from converter.scene.model import Scene
from converter.scene.settings import ADAPTIVE_SAMPLES, Settings
from converter.studies.convergence import Tell, numbers_of_samples

TRUTH = 256
"""Rays a pixel of what errors are measured against."""
MOST_UNIFORM = 64
LIMITS = (64, 32, 16, 8, 4)
"""Of adaptive sampling, in levels of 255."""
THRESHOLDS = (0.3, 0.1, 0.03, 0.01)
"""Of POV-Ray; 0.3 is its own default."""
METHODS = ("native",)
"""Where nobody says which."""


@dataclass(frozen=True, slots=True)
class Point:
    """A picture.

    Attributes:
        name: its setting. rays: from the eye, a pixel. rms: levels of 255. seconds: to render, the median.

    """

    name: str
    rays: float
    rms: float
    seconds: float


@dataclass(slots=True)
class Curve:
    """A way to choose rays, with ever more of them."""

    name: str
    family: Family
    points: list[Point] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class AntialiasingStudy:
    """All ways on one scene; `skipped` says why a method has none."""

    file: Path
    settings: Settings
    curves: list[Curve]
    skipped: list[str]

    @property
    def drawn(self) -> list[Curve]:
        """Those that have points: all."""
        return self.curves


Draw = Callable[[], tuple[Rendering, float]]
"""Draws a picture, and tells the rays from the eye, a pixel."""


def default_methods() -> list[Method]:
    """What is compared where nobody says."""
    return [find_method(name) for name in METHODS]


def measure_antialiasing(
    file: Path,
    scene: Scene,
    settings: Settings,
    methods: Sequence[Method],
    runs: int,
    variant: str | None = None,
    tell: Tell = lambda what, share: None,
) -> AntialiasingStudy:
    """Draw `scene`, read from `file`, by every method and in each of its ways.

    Errors are against the same method's picture of `TRUTH` rays in each pixel, so that nothing else counts.

    Raises:
        RendererUnavailable: a renderer cannot run.
        ValueError: a texture cannot be read.
        KeyboardInterrupt: Ctrl-C.

    """
    curves: list[Curve] = []
    skipped = []
    for k, method in enumerate(methods):
        if reason := method.missing() or method.unfit(scene):
            skipped.append(f"left out: {method.name}: {reason}")
            continue
        renderer, chosen = method.renderer(variant), method.settings(settings)
        tell(f"{file.stem}: {method.name}, truth", k / len(methods))
        truth = _seen(renderer.render(scene, replace(chosen, samples=TRUTH)))
        ways = [*_uniform(renderer, scene, chosen), *_adaptive(renderer, scene, chosen)]
        for done, (way, name, draw) in enumerate(ways):
            tell(f"{file.stem}: {method.name}, {way}, {name}", (k + (1 + done / len(ways)) / 2) / len(methods))
            if not curves or curves[-1].name != f"{method.name}, {way}":
                curves.append(Curve(f"{method.name}, {way}", method.family))
            curves[-1].points.append(_point(name, draw, truth, runs))
    return AntialiasingStudy(file, settings, curves, skipped)


def _uniform(renderer: Renderer, scene: Scene, settings: Settings) -> Iterator[tuple[str, str, Draw]]:
    """The name of a curve, that of a point, and how it is drawn."""
    for count in numbers_of_samples(MOST_UNIFORM):
        yield "in every pixel", str(count), partial(_with, renderer, scene, settings, count)


def _adaptive(renderer: Renderer, scene: Scene, settings: Settings) -> Iterator[tuple[str, str, Draw]]:
    """Likewise, in all ways that a renderer has; none if it has none."""
    if isinstance(renderer, PovrayRenderer):
        methods: tuple[Literal[1, 2], ...] = (1, 2)
        for method in methods:
            for threshold in THRESHOLDS:
                other = PovrayRenderer(Supersampling(method, threshold))
                yield f"+AM{method} +R3", f"+A{threshold:g}", partial(_by_povray, other, scene, settings)
    elif draws_adaptively(renderer) and renderer.unfit_to_adapt() is None:
        for limit in LIMITS:
            yield "--adaptive", str(limit), partial(_adapted, renderer, scene, settings, limit)


def _with(renderer: Renderer, scene: Scene, settings: Settings, count: int) -> tuple[Rendering, float]:
    return renderer.render(scene, replace(settings, samples=count)), count


def _by_povray(renderer: PovrayRenderer, scene: Scene, settings: Settings) -> tuple[Rendering, float]:
    rendering = renderer.render(scene, replace(settings, samples=1))
    return rendering, rendering.statistics["primary"] / (settings.width * settings.height)


def _adapted(renderer: AdaptiveRenderer, scene: Scene, settings: Settings, limit: float) -> tuple[Rendering, float]:
    chosen = Adapting(limit, ADAPTIVE_SAMPLES)
    rendering = renderer.render_adaptively(scene, replace(settings, samples=ADAPTIVE_SAMPLES), chosen)
    return rendering, chosen.statistics()["rays_a_pixel"]


def _point(name: str, draw: Draw, truth: "np.ndarray[Any, Any]", runs: int) -> Point:
    drawn = [draw() for _ in range(runs)]
    rendering, rays = drawn[0]
    rms = 255 * math.sqrt(np.mean((_seen(rendering) - truth) ** 2))
    return Point(name, rays, rms, median(each.seconds["render"] for each, _ in drawn))


def _seen(rendering: Rendering) -> "np.ndarray[Any, Any]":
    return np.clip(np.asarray(rendering.pixels, dtype=np.float64), 0, 1)
