"""Mitsuba 3 with our plugins, seen as one of the renderers."""

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, ClassVar

from converter.renderers.base import (
    Interrupted,
    Passes,
    Progress,
    Refinement,
    RendererUnavailable,
    Rendering,
    ResumeError,
    part_of,
    share_of_first,
)
from converter.renderers.native import available_cores
from converter.renderers.records import PixelRecord
from converter.scene.model import Scene
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.to_mitsuba.fineness import USUAL, Fineness
from converter.to_mitsuba.integrator import Intersections, RayPrecision

LEAST_ROOM = 1 << 30
"""Bytes of address space: a scene of a few balls took 850 MiB on two cores."""


@dataclass(frozen=True)
class MitsubaRenderer:
    """Draws through a scene description, a Mitsuba scene in memory, and the `whitted` integrator.

    Attributes:
        variant: "llvm_ad_rgb", "cuda_ad_rgb", or "auto": CUDA where a device passes its trial, else LLVM.
        intersections, precision: how the integrator finds what a ray hits, see its documentation.
        fineness: what meshes may be off by; only with "offset" and "ulp" can spheres be meshes.

    """

    in_passes: ClassVar[bool] = True

    variant: str = "auto"
    intersections: Intersections = "auto"
    precision: RayPrecision = "double"
    fineness: Fineness = USUAL

    def render(
        self, scene: Scene, settings: Settings, progress: Progress | None = None, start: Passes | None = None
    ) -> Rendering:
        """Draw `scene`, from the passes `start` on.

        Raises:
            RendererUnavailable: no variant runs here, or an effect that the scene has cannot be drawn.
            ResumeError: `start` was drawn in another variant.
            ValueError: a texture cannot be read, or a polyhedron cannot be made into a mesh.
            Interrupted: Ctrl-C while it was drawing.

        """
        import numpy as np

        from native_tracer.passes import passes

        started = time.perf_counter()
        variant = self._start()
        ready = time.perf_counter()
        if start is not None and start.notes["variant"] != variant:
            raise ResumeError(f"it was begun in {start.notes['variant']}, and this is {variant}: --variant chooses one")
        mitsuba_scene = self._load(scene, settings)
        built = time.perf_counter()

        width, height = settings.drawn_size
        pixels = np.zeros((height, width, 3), dtype=np.float32)
        from mitsuba_plugins.integrators.pictures import Picture  # when a variant is set

        integrator, sensor = mitsuba_scene.integrator(), mitsuba_scene.sensors()[0]
        picture = Picture(integrator, mitsuba_scene, sensor)
        all_passes = passes(sensor.sampler().sample_count())

        def rendering() -> Rendering:
            seconds = {"start": ready - started, "build": built - ready, "render": time.perf_counter() - built}
            statistics = _statistics(variant, integrator, picture, picture.pixels_too_deep)
            whole = _whole_passes(picture.sums, pixels.shape, all_passes, variant)
            return Rendering(pixels, width, height, seconds, statistics, whole)

        try:
            with _threads(settings.threads):
                if len(all_passes) == 1:
                    bands = picture.bands(progress=progress)
                else:
                    sums = _sums_to_go_on_from(start, pixels)
                    bands = picture.bands_by_passes(sums, progress)
                for first, color in bands:
                    rows = np.asarray(color).reshape(-1, width, 3)
                    if len(rows) == height:
                        pixels = rows  # to copy a large picture takes as long as a GPU draws it
                    else:
                        pixels[first : first + len(rows)] = rows
        except KeyboardInterrupt:
            raise Interrupted(rendering()) from None
        except RuntimeError as error:
            if _comes_from_interrupt(error):
                raise Interrupted(rendering()) from None
            raise
        return rendering()

    def unfit_to_adapt(self) -> str | None:
        """Why it cannot draw adaptively, as `AdaptiveRenderer` has it."""
        if self.intersections in ("auto", "analytic", "bvh"):
            return None
        return "what Embree or OptiX says of a hit is not enough to compare pixels by"

    def render_adaptively(
        self, scene: Scene, settings: Settings, refinement: Refinement, progress: Progress | None = None
    ) -> Rendering:
        """Draw adaptively, as `AdaptiveRenderer` has it."""
        import numpy as np

        from native_tracer.passes import halves, passes

        started = time.perf_counter()
        variant = self._start()
        ready = time.perf_counter()
        mitsuba_scene = self._load(scene, settings)
        built = time.perf_counter()

        width, height = settings.width, settings.height
        pixels = np.zeros((height, width, 3), dtype=np.float32)
        from mitsuba_plugins.integrators.pictures import Picture  # when a variant is set

        integrator, sensor = mitsuba_scene.integrator(), mitsuba_scene.sensors()[0]
        picture = Picture(integrator, mitsuba_scene, sensor)
        samples = sensor.sampler().sample_count()
        too_deep = [0]

        def rendering() -> Rendering:
            seconds = {"start": ready - started, "build": built - ready, "render": time.perf_counter() - built}
            statistics = _statistics(variant, integrator, picture, max(*too_deep, picture.pixels_too_deep))
            return Rendering(pixels, width, height, seconds, statistics)

        def add(sums: Any, mask: Any, cells: list[int], count: int, told: Progress | None) -> None:
            """Add the samples of these cells to the sums of pixels, and show the mean, of `count`."""
            numbers = np.flatnonzero(mask).astype(np.uint32)
            for at, color in picture.chosen_pixels(numbers, cells, told):
                chosen = numbers[at : at + color.shape[1]]
                sums.reshape(-1, 3)[chosen] += np.asarray(color).T
                pixels.reshape(-1, 3)[chosen] = sums.reshape(-1, 3)[chosen] / count
            too_deep.append(picture.pixels_too_deep)

        try:
            with _threads(settings.threads):
                sums = np.zeros((height, width, 3))
                if scene_needs(scene, settings).sampled:
                    all_passes, done = passes(samples, 1), 0
                    mask = np.ones((height, width), np.bool_)
                    for cells in all_passes:
                        told = part_of(progress, done / samples, (done + len(cells)) / samples)
                        done += len(cells)
                        add(sums, mask, cells, done, told)
                        mask = refinement.unsure(sums, len(cells), mask)
                        if not mask.any():
                            break
                else:
                    signatures = np.zeros((height, width), dtype=np.uint32)
                    parts = halves(samples)
                    first, count = share_of_first(sum(map(len, parts))), 0
                    told = part_of(progress, 0, first)
                    for row, color, words in picture.signed_bands(refinement.least_weight, told):
                        rows = np.asarray(color).reshape(-1, width, 3)
                        pixels[row : row + len(rows)] = rows
                        signatures[row : row + len(rows)] = np.asarray(words).reshape(-1, width)
                    too_deep.append(picture.pixels_too_deep)
                    wanted = refinement.halves(signatures, pixels)
                    for done, cells in enumerate(parts):
                        count += len(cells)
                        ends = (first + (1 - first) * (done + k) / len(parts) for k in (0, 1))
                        add(sums, wanted > done, cells, count, part_of(progress, *ends))
        except KeyboardInterrupt:
            raise Interrupted(rendering()) from None
        except RuntimeError as error:
            if _comes_from_interrupt(error):
                raise Interrupted(rendering()) from None
            raise
        return rendering()

    def trace_pixel(self, scene: Scene, settings: Settings, x: int, y: int) -> PixelRecord:
        """Trace one pixel, as `RayTeller` has it."""
        return self.trace_pixels(scene, settings, [(x, y)])[0]

    def trace_pixels(self, scene: Scene, settings: Settings, pixels: Sequence[tuple[int, int]]) -> list[PixelRecord]:
        """Trace pixels, as `RayTeller` has it; faster together."""
        self._start()
        from converter.renderers.mitsuba_pixel import trace_pixels

        return trace_pixels(self._load(scene, settings), pixels)

    def _start(self) -> str:
        """Load Mitsuba, and return the variant."""
        _check_room()
        from mitsuba_plugins import BackendError, set_variant

        try:
            return set_variant(self.variant)
        except (BackendError, ImportError) as error:
            raise RendererUnavailable(str(error)) from error

    def _load(self, scene: Scene, settings: Settings) -> Any:
        from converter.to_mitsuba.load import load_description
        from converter.to_mitsuba.scene import scene_description

        shapes = self.intersections in ("mesh", "offset", "ulp")
        return load_description(
            scene_description(scene, settings, self.intersections, self.precision, self.fineness, shapes)
        )


def _sums_to_go_on_from(start: Passes | None, pixels: Any) -> Any:
    """The integrator's sums of what is drawn already, if anything is; its mean is put into `pixels`."""
    if start is None:
        return None
    import mitsuba as mi
    import numpy as np

    from mitsuba_plugins.integrators.pictures import PassSums
    from mitsuba_plugins.intersection.columns import column

    colors = np.frombuffer(start.colors, np.float64).reshape(-1, 3)
    np.divide(colors.reshape(pixels.shape), start.notes["samples"], out=pixels, casting="same_kind")
    too_deep = column(mi.Bool, np.frombuffer(start.too_deep, np.bool_))
    return PassSums(start.done, mi.Color3d(np.ascontiguousarray(colors.T)), too_deep)


def _whole_passes(sums: Any, shape: tuple[int, ...], passes: list[list[int]], variant: str) -> Passes | None:
    """What is drawn in whole passes, if any are."""
    if sums is None or sums.passes == 0:
        return None
    import numpy as np

    colors = np.ascontiguousarray(np.asarray(sums.colors).T).reshape(shape)
    too_deep = np.asarray(sums.too_deep).astype(np.uint8)
    samples = sum(map(len, passes[: sums.passes]))
    return Passes(sums.passes, len(passes), colors, too_deep, {"variant": variant, "samples": samples})


def _statistics(variant: str, integrator: Any, picture: Any, pixels_too_deep: int) -> dict[str, Any]:
    """What is told of a picture; in mixed precision also the share of what is drawn that is drawn in double."""
    way, precision = integrator.parameters.intersections, integrator.parameters.precision
    told = {"variant": variant, "intersections": way, "precision": precision, "pixels_too_deep": pixels_too_deep}
    return {**told, "drawn_in_double": picture.share_in_double} if precision == "mixed" else told


def _comes_from_interrupt(error: BaseException | None) -> bool:
    """Whether Ctrl-C is behind an error: Dr.Jit makes another of it while it records a loop."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            return True
        error = error.__cause__ or error.__context__
    return False


def _check_room() -> None:
    """See that LLVM finds room: where it does not, it ends the process.

    Raises:
        MemoryError: the process may have less.

    """
    import resource

    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit != resource.RLIM_INFINITY and limit < LEAST_ROOM:
        allowed = f"{LEAST_ROOM >> 20} MiB of address space, and {limit >> 20} are allowed (ulimit -v)"
        raise MemoryError(f"Mitsuba needs {allowed}; --method native needs less")


@contextmanager
def _threads(count: int) -> Iterator[None]:
    """Let Dr.Jit use `count` threads for a while; 0 is all cores."""
    import drjit as dr

    before = dr.thread_count()
    dr.set_thread_count(count or available_cores())
    try:
        yield
    finally:
        dr.set_thread_count(before)
