"""The native tracer, seen as one of the renderers: builds its scene from ours, and only what can be seen."""

import os
import time
from collections.abc import Sequence
from functools import partial
from types import ModuleType
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from converter.analysis.coplanar import with_planes_shared
from converter.frozen import dataclass
from converter.pigments.table import pigment_kind
from converter.renderers.base import (
    Interrupted,
    Passes,
    Progress,
    Refinement,
    RendererUnavailable,
    Rendering,
    part_of,
    refuse_effects,
    share_of_first,
)
from converter.scene.effects import Effect
from converter.scene.geometry import simplified
from converter.scene.model import Scene
from converter.scene.needs import SceneNeeds, scene_needs
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind

if TYPE_CHECKING:
    from converter.renderers.records import PixelRecord, RayRecord

Precision = Literal["float", "double", "long double"]
Search = Literal["auto", "brute", "bvh"]
_RAYS = ("primary", "reflected", "transmitted", "shadow")
"""Names of the tracer's counters of rays."""
EFFECTS: tuple[Effect, ...] = ("soft shadows", "glossy rays", "depth of field", "motion")
"""What of distributed ray tracing it draws."""


@dataclass(frozen=True, slots=True)
class NativeRenderer:
    """Draws with `native_tracer`.

    Attributes:
        precision: "double" is the reference, "long double" checks it.
        search: how the objects that a ray hits are found: one by one, by a tree over their boxes (a bounding volume
            hierarchy), or by whichever is faster for their number. The picture is the same, byte for byte.

    """

    in_passes: ClassVar[bool] = True

    precision: Precision = "double"
    search: Search = "auto"

    def render(
        self, scene: Scene, settings: Settings, progress: Progress | None = None, start: Passes | None = None
    ) -> Rendering:
        """Draw `scene`, from the passes `start` on.

        Raises:
            RendererUnavailable: the native module is not built, or cannot draw an effect that the scene has.
            ValueError: a texture cannot be read, or `settings` make no sense.
            Interrupted: Ctrl-C while it was drawing.

        """
        tracer = native_module()
        started = time.perf_counter()
        scene = simplified(scene)
        needs = scene_needs(scene, settings)
        native_scene = build_scene(scene, needs)
        image = tracer.Image(*settings.drawn_size)
        passes = _passes(needs.samples)
        sums = _pass_sums(tracer, settings, start) if len(passes) > 1 else None
        built = time.perf_counter()

        def rendering() -> Rendering:
            seconds = {"build": built - started, "render": time.perf_counter() - built}
            statistics = image.statistics
            rays = sum(statistics[kind] for kind in _RAYS)
            whole = None
            if sums is not None and sums.passes > 0:
                whole = Passes(sums.passes, len(passes), sums.colors, sums.too_deep, {"counts": sums.counts})
            return Rendering(image.pixels, *settings.drawn_size, seconds, {"rays": rays, **statistics}, whole)

        threads = settings.threads or available_cores()
        try:
            options = self._options(settings, needs) | _part(settings)
            if sums is not None:
                options |= {"passes": passes, "sums": sums}
            tracer.render(native_scene, image, threads=threads, progress=progress, **options)
        except KeyboardInterrupt:
            raise Interrupted(rendering()) from None
        return rendering()

    def unfit_to_adapt(self) -> str | None:
        """Why it cannot draw adaptively, as `AdaptiveRenderer` has it."""
        return None

    def render_adaptively(
        self, scene: Scene, settings: Settings, refinement: Refinement, progress: Progress | None = None
    ) -> Rendering:
        """Draw adaptively, as `AdaptiveRenderer` has it."""
        import numpy as np

        tracer = native_module()
        started = time.perf_counter()
        scene = simplified(scene)
        needs = scene_needs(scene, settings)
        native_scene = build_scene(scene, needs)
        image = tracer.Image(settings.width, settings.height)
        options = self._options(settings, needs) | {"threads": settings.threads or available_cores()}
        draw = partial(tracer.render, native_scene, image, **options)
        built = time.perf_counter()
        statistics: list[dict[str, Any]] = []

        def rendering() -> Rendering:
            seconds = {"build": built - started, "render": time.perf_counter() - built}
            every = [*statistics, image.statistics]
            found = dict(image.statistics) | {kind: sum(each[kind] for each in every) for kind in _RAYS}
            found |= {name: max(each[name] for each in every) for name in ("deepest", "pixels_too_deep")}
            rays = {"rays": sum(found[kind] for kind in _RAYS)}
            return Rendering(image.pixels, image.width, image.height, seconds, rays | found)

        try:
            if needs.sampled:
                sums = tracer.PassSums(settings.width, settings.height)
                all_passes = _passes(needs.samples, 1)
                mask = np.ones((settings.height, settings.width), np.bool_)
                for done, cells in enumerate(all_passes):
                    told = part_of(progress, 0, (done + 1) / len(all_passes))
                    draw(passes=all_passes[: done + 1], sums=sums, mask=mask.view(np.uint8), progress=told)
                    mask = refinement.unsure(np.asarray(sums.colors), len(cells), mask)
                    if not mask.any():
                        break
            else:
                signatures = np.zeros((settings.height, settings.width), np.uint32)
                parts = _halves(needs.samples)
                first = share_of_first(sum(map(len, parts)))
                signing = {"signatures": signatures, "least_weight": refinement.least_weight}
                draw(samples=1, progress=part_of(progress, 0, first), **signing)
                statistics.append(image.statistics)
                wanted = refinement.halves(signatures, np.asarray(image.pixels))
                sums = tracer.PassSums(settings.width, settings.height)
                for done in range(1, len(parts) + 1):
                    mask = (wanted >= done).view(np.uint8)
                    told = part_of(progress, first, first + (1 - first) * done / len(parts))
                    draw(passes=parts[:done], sums=sums, mask=mask, progress=told)
        except KeyboardInterrupt:
            raise Interrupted(rendering()) from None
        return rendering()

    def trace_pixel(self, scene: Scene, settings: Settings, x: int, y: int) -> "PixelRecord":
        """Trace one pixel, as `RayTeller` has it; its colour is what `render` leaves there."""
        return self.trace_pixels(scene, settings, [(x, y)])[0]

    def trace_pixels(self, scene: Scene, settings: Settings, pixels: Sequence[tuple[int, int]]) -> "list[PixelRecord]":
        """Trace pixels, as `RayTeller` has it."""
        from converter.renderers.records import pixel_record  # late: a picture needs none

        scene = simplified(scene)
        needs = scene_needs(scene, settings)
        native_scene = build_scene(scene, needs)
        options = self._options(settings, needs)
        size = settings.width, settings.height
        trace = native_module().trace_pixel
        results = [pixel_record(trace(native_scene, *size, x, y, **options)) for x, y in pixels]
        for result in results:
            _restore_planes(result.rays, needs)
        return results

    def _options(self, settings: Settings, needs: SceneNeeds) -> dict[str, Any]:
        return {
            "samples": needs.samples,
            "seed": settings.seed,
            "independent": settings.points == "independent",
            "corner": settings.pixel == "corner",
            "blinn": settings.specular == "blinn",
            "cutoff": settings.cutoff,
            "max_depth": needs.max_depth,
            "precision": self.precision,
            "search": self.search,
        }


def _passes(samples: int, in_one: int | None = None) -> list[list[int]]:
    from native_tracer.passes import passes  # late: it may not be built

    return passes(samples) if in_one is None else passes(samples, in_one)


def _halves(samples: int) -> list[list[int]]:
    from native_tracer.passes import halves  # late: it may not be built

    return halves(samples)


def _part(settings: Settings) -> dict[str, Any]:
    return {"picture": (settings.width, settings.height), "first": settings.drawn[:2]}


def _pass_sums(tracer: ModuleType, settings: Settings, start: Passes | None) -> Any:
    """The tracer's sums of passes: none yet, or those to start from."""
    sums = tracer.PassSums(*settings.drawn_size)
    if start is not None:
        sums.passes = start.done
        for target, source in ((sums.colors, start.colors), (sums.too_deep, start.too_deep)):
            target.cast("B")[:] = memoryview(source).cast("B")
        sums.counts = start.notes["counts"]
    return sums


def native_module() -> ModuleType:
    """The native tracer, or `RendererUnavailable`."""
    try:
        import native_tracer
    except ImportError as error:
        raise RendererUnavailable(
            f"the native tracer is not built ({error}); `make` or `pip install .` builds it"
        ) from None
    return native_tracer


def available_cores() -> int:
    """Processor cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


# ---- From our scene to the tracer's ----------------------------------------------------------------------------------


def build_scene(scene: Scene, needs: SceneNeeds) -> Any:
    """The tracer's scene. Pigments and finishes that no object uses are left out, so no texture is read in vain.

    Raises:
        EffectUnavailable: the tracer cannot draw it.

    """
    refuse_effects(needs, "the native tracer", EFFECTS)
    native = native_module().Scene()
    camera = scene.camera
    lens = (camera.aperture, camera.focal) if camera.aperture else ()
    native.set_camera(camera.eye, camera.look_at, camera.up, camera.fovy, *lens)
    native.set_ambient(scene.ambient)
    native.set_background(needs.background)
    if needs.lit:
        for light in scene.lights:
            native.add_light(light.position, light.color, light.attenuation, light.radius)
    pigments = {i: pigment_kind(p).add_to(native, p) for i in needs.pigments for p in (scene.pigments[i],)}
    finishes = {}
    for i in needs.finishes:
        f = scene.finishes[i]
        finishes[i] = native.add_finish(f.ka, f.kd, f.ks, f.alpha, f.kr, f.kt, needs.etas[i], f.cone)
    for i, (o, facts) in enumerate(zip(with_planes_shared(scene).objects, needs.facts, strict=True)):
        shape_kind(o.shape).add_to(native, o.shape, facts, pigments[o.pigment], finishes[o.finish])
        if any(o.move):
            native.move_object(i, o.move)
    return native


def _restore_planes(rays: "list[RayRecord]", needs: SceneNeeds) -> None:
    """Turn the tracer's plane numbers, which skip the planes that have no face, into the scene's; a csg has none."""
    pending = list(rays)
    while pending:
        ray = pending.pop()
        pending.extend(ray.children)
        if ray.hit is not None and ray.hit.plane is not None:
            planes = needs.planes[ray.hit.object]
            ray.hit.plane = planes[ray.hit.plane] if planes else None
