"""Runs methods on a scene, in turns, and measures the error and the time of each."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from converter.certify.certificate import Certificate, certify, levels
from converter.compare.metrics import Difference, compare_pixels
from converter.renderers.base import Renderer, RendererUnavailable
from converter.renderers.methods import Method
from converter.scene.model import Scene
from converter.scene.settings import Settings
from converter.studies.processes import Process, ProcessFailed, render_in_a_process
from converter.studies.reference import Reference, draw_reference

LONGEST = 20.0
"""Seconds after which a method's first picture is given up."""
ENOUGH = 2.0
"""Seconds of rendering, after the first picture, after which a method has run often enough."""

Tell = Callable[[str, float], None]
"""Told what is being done, and the finished share of everything (0..1)."""
InAProcess = Callable[..., Process]
"""`render_in_a_process`, or what stands in for it."""


@dataclass(slots=True)
class Measured:
    """What a method did on a scene.

    Attributes:
        method: the method.
        skipped: why it has no figures; None if it has.
        difference: its picture against the reference.
        first: seconds by stage of the first picture in the process that ran all methods.
        runs: the same of the pictures after it.
        cold: a process of its own, which finds its kernels compiled on disk, if it has any.
        bare: a process of its own, which has to compile its kernels; None for a method without.
        statistics: the renderer's counters.
        missed: how many certified pixels it gets wrong, where that is asked.

    """

    method: Method
    skipped: str | None = None
    difference: Difference | None = None
    first: Mapping[str, float] = field(default_factory=dict)
    runs: list[Mapping[str, float]] = field(default_factory=list)
    cold: Process | None = None
    bare: Process | None = None
    statistics: Mapping[str, Any] = field(default_factory=dict)
    missed: int | None = None

    @property
    def seconds(self) -> list[float]:
        """Of the render stage of every run but the first."""
        return [run["render"] for run in self.runs]

    @property
    def warm(self) -> float:
        """Their median."""
        return median(self.seconds)

    @property
    def stages(self) -> dict[str, float]:
        """How `cold` splits: start (the interpreter, imports, the end), build (reading the scene too), compile (what
        its rendering takes longer than a warm one: nothing but that is compiled, or fetched), render, write.
        """
        if self.cold is None:
            return {}
        told = self.cold.stages
        build = told.get("read", 0.0) + told.get("build", 0.0)
        write, render = told.get("write", 0.0), told["render"]
        compiling = max(0.0, render - self.warm) if self.bare is not None else 0.0
        start = max(0.0, self.cold.whole - build - render - write)
        return {"start": start, "build": build, "compile": compiling, "render": render - compiling, "write": write}


@dataclass(frozen=True, slots=True)
class SceneStudy:
    """All methods on a scene; `certified` is how many of its pixels are, where errors are told by those."""

    file: Path
    settings: Settings
    reference: Reference
    measured: list[Measured]
    certified: int | None = None

    @property
    def drawn(self) -> list[Measured]:
        """Those that were not skipped."""
        return [m for m in self.measured if m.skipped is None]

    def share(self, m: Measured) -> float:
        """Of all pixels those in which a method's picture differs from the reference by more than 1/255, or of the
        certified ones those that it gets wrong.
        """
        if self.certified is not None and m.missed is not None:
            return m.missed / max(self.certified, 1)
        assert m.difference is not None
        return m.difference.disagreeing / m.difference.pixels


class _TooSlow(Exception):  # noqa: N818 - what it says
    pass


def measure_scene(
    file: Path,
    scene: Scene,
    settings: Settings,
    methods: Sequence[Method],
    runs: int,
    variant: str | None = None,
    tell: Tell = lambda what, share: None,
    in_a_process: InAProcess = render_in_a_process,
    certified: bool = False,
) -> SceneStudy:
    """Draw `scene`, read from `file`, by every method: once to warm up, then `runs` times in turns, fewer of slow ones,
    so that a machine whose speed drifts is fair to all; then in processes of their own. With `certified` errors are
    also told by the pixels whose bytes are proven.

    Raises:
        RendererUnavailable: the native tracer, which draws the reference, is not built.
        ValueError: a texture cannot be read.
        KeyboardInterrupt: Ctrl-C.

    """
    name = file.stem
    reference = draw_reference(scene, settings, lambda share: tell(f"{name}: the reference", 0.1 * share))
    certificate = certify(scene, settings) if certified else None
    measured = [Measured(method, method.missing() or method.unfit(scene)) for method in methods]
    renderers = {m.method: m.method.renderer(variant) for m in measured if m.skipped is None}
    for k, m in enumerate(measured):
        tell(f"{name}: {m.method.name}, first picture", 0.1 + 0.25 * k / len(measured))
        if m.skipped is None:
            _first(m, renderers[m.method], scene, settings, reference, certificate)
    drawn = [m for m in measured if m.skipped is None]
    for turn in range(runs):
        for k, m in enumerate(drawn):
            tell(f"{name}: {m.method.name}, run {turn + 1}", 0.35 + 0.25 * (turn + k / len(drawn)) / runs)
            if sum(m.seconds) < ENOUGH:
                m.runs.append(renderers[m.method].render(scene, m.method.settings(settings)).seconds)
    for k, m in enumerate(drawn):
        tell(f"{name}: {m.method.name}, a process of its own", 0.6 + 0.4 * k / len(drawn))
        try:
            m.cold = in_a_process(m.method.name, file, settings, _variant_of(m.method, variant))
            if m.method.family == "mitsuba":
                m.bare = in_a_process(m.method.name, file, settings, _variant_of(m.method, variant), empty_cache=True)
        except ProcessFailed as failure:
            m.skipped = f"in a process of its own: {failure}"
    count = None if certificate is None else int(certificate.certified.sum())
    return SceneStudy(file, settings, reference, measured, count)


def _variant_of(method: Method, variant: str | None) -> str | None:
    return variant if method.family == "mitsuba" and "variant" not in method.options else None


def _first(
    m: Measured,
    renderer: Renderer,
    scene: Scene,
    settings: Settings,
    reference: Reference,
    certificate: Certificate | None,
) -> None:
    """The first picture, from which the error is told; a method that cannot draw it is skipped."""
    started = time.perf_counter()

    def watch(share: float) -> None:
        if time.perf_counter() - started > LONGEST:
            raise _TooSlow

    try:
        rendering = renderer.render(scene, m.method.settings(settings), watch)
    except (RendererUnavailable, ValueError, MemoryError) as error:
        m.skipped = str(error) or "not enough memory"
    except _TooSlow:
        m.skipped = f"takes longer than {LONGEST:g} s"
    else:
        m.first, m.statistics = rendering.seconds, rendering.statistics
        m.difference = compare_pixels(reference.pixels, np.asarray(rendering.pixels))
        if certificate is not None:
            m.missed = int((certificate.misses(levels(rendering)) > 0).sum())
