"""How a picture is drawn: in bands of rows, in passes of samples, or some pixels more often than others."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.launches import Launches
from mitsuba_plugins.integrators.pace import Pace
from mitsuba_plugins.integrators.pixels import corners, in_rows, in_tiles, mean_colors, place_in_tiles
from mitsuba_plugins.integrators.precisions import Precisions
from mitsuba_plugins.integrators.primary_rays import name_sample, primary_ray
from mitsuba_plugins.integrators.ray_tree import trace
from mitsuba_plugins.intersection.columns import column
from native_tracer.passes import passes

Progress = Callable[[float], None]
"""Called after every launch with the finished share of the picture."""


@dataclass(frozen=True)
class PassSums:
    """What is drawn of a picture in whole passes: their number, the sums of the samples' colours (Color3d), and the
    pixels in which the depth limit dropped a ray (Bool).
    """

    passes: int
    colors: Any
    too_deep: Any


class Picture:
    """A picture that an integrator, a `whitted`, draws of a scene. Each method draws it, part after part.

    Attributes:
        pixels_too_deep: how many pixels of the parts there are the depth limit dropped a ray in, if it is limited.
        sums: what is drawn in whole passes (PassSums), if it is drawn in passes.

    """

    def __init__(self, integrator: Any, scene: Any, sensor: Any) -> None:
        self._integrator, self._scene, self._sensor = integrator, scene, sensor
        self._parameters = integrator.parameters
        self._depth_limited = self._parameters.depth_limited
        self._width, self._height = sensor.film().crop_size()
        self._precisions: Precisions | None = None
        self.pixels_too_deep = 0
        self.sums: PassSums | None = None

    @property
    def share_in_double(self) -> float:
        """Of the pixels drawn last, those drawn in double."""
        return 1.0 if self._precisions is None else self._precisions.share_in_double

    def bands(self, spp: int = 0, progress: Progress | None = None) -> Iterator[tuple[int, Any]]:
        """Draw it in bands of rows, so that memory does not grow with its size, by launches that take some time but
        not long, so that there are signs of life and no more launches than that.

        Yields:
            The first row of a finished band within the film's crop window, and its pixels' colours, row by row, three
            numbers each (Float). Its pixels are among `pixels_too_deep` by then. After every launch `progress`, if
            any, is called with the finished share of the picture.

        """
        cells = [cell for cells in passes(spp or self._samples) for cell in cells]
        count = len(cells)
        with dr.suspend_grad():
            pace = self._pace()
            launches = Launches(self._prepared(), cells, count, pace)
            for first, color, too_deep in self._stage(launches, pace, 0, count, count, None, progress):
                self._count_too_deep(too_deep)
                yield first, mean_colors(color, count, self._width)

    def bands_by_passes(
        self, start: PassSums | None = None, progress: Progress | None = None
    ) -> Iterator[tuple[int, Any]]:
        """Draw it in passes of samples, see :mod:`native_tracer.passes`, and each in bands: pictures that take long,
        for all of it has some samples soon. Short passes are drawn together.

        Yields:
            The first row of a band within the film's crop window, and its pixels' colours, as `bands` has them, with
            what is drawn so far. What is left in ``sums`` has whole passes only, beginning with those of `start`.

        """
        all_passes = passes(self._samples)
        cells = [cell for cells in all_passes for cell in cells]
        size, pixels = len(all_passes[0]), self._width * self._height
        with dr.suspend_grad():
            pace = self._pace()
            launches = Launches(self._prepared(), cells, len(cells), pace)
            sums = self.sums = start or PassSums(0, dr.zeros(mi.Color3d, pixels), dr.zeros(mi.Bool, pixels))
            while sums.passes < len(all_passes):
                more = min(pace.passes(pixels * size), len(all_passes) - sums.passes)
                begin, end = sums.passes * size, (sums.passes + more) * size
                bands = []
                for first, color, too_deep in self._stage(
                    launches, pace, begin, end, len(cells), sums if begin else None, progress
                ):
                    place = place_in_tiles(self._width, dr.width(color) // self._width)
                    deep = too_deep if self._depth_limited else dr.zeros(mi.Bool, dr.width(color))
                    bands.append((*dr.gather(mi.Color3d, color, place), dr.gather(mi.Bool, deep, place)))
                    yield first, mean_colors(color, end, self._width)
                red, green, blue, too_deep = (dr.concat(parts) for parts in zip(*bands, strict=True))
                colors = mi.Color3d(red, green, blue)
                dr.eval(colors, too_deep)
                sums = self.sums = PassSums(sums.passes + more, colors, too_deep)
                self.pixels_too_deep = dr.count(too_deep)[0]

    def signed_bands(self, least_weight: float, progress: Progress | None = None) -> Iterator[tuple[int, Any, Any]]:
        """Draw it with one sample a pixel in bands of rows, with signatures of rays that weigh at least
        `least_weight`, see :mod:`.signature`.

        Yields:
            The first row of a band within the film's crop window, and its pixels' colours, as `bands` has them, and
            signatures (UInt32).

        """
        with dr.suspend_grad():
            scene, pace = self._prepared(least_weight).deciding, self._pace()
            sample = name_sample(scene, mi.UInt32(0), mi.UInt32(0))
            first = 0
            while first < self._height:
                rows = min(self._height - first, pace.rows(self._width))
                with pace.launch(rows * self._width):
                    position = corners(self._sensor.film(), in_rows(self._width, first, rows)) + mi.Point2d(0.5)
                    ray = primary_ray(scene, position, sample)
                    color, too_deep, signature, _ = trace(scene, ray, sample, True)
                    pace.recorded()
                    dr.eval(color, too_deep, signature)
                    dr.sync_thread()
                self._count_too_deep(too_deep)
                yield first, dr.ravel(mi.Color3f(color)), signature
                first += rows
                if progress is not None:
                    progress(first / self._height)

    def chosen_pixels(
        self, numbers: Any, cells: list[int], progress: Progress | None = None
    ) -> Iterator[tuple[int, Any]]:
        """Draw some pixels, with the samples in some cells of the grid. The `numbers` of the pixels (NumPy, uint32)
        count row by row within the film's crop window.

        Yields:
            The index of a pixel among them, and the sums of the samples' colours (Color3d) from it on, for as many as
            are drawn at once.

        """
        with dr.suspend_grad():
            pace = self._pace()
            launches = Launches(self._prepared(), cells, self._samples, pace)
            first = 0
            while first < len(numbers):
                pixel = column(mi.UInt32, numbers[first : first + pace.rows(1)])
                count = dr.width(pixel)

                def told(done: int, begin: int = first, count: int = count) -> None:
                    if progress is not None:
                        progress((begin + count * done / len(cells)) / len(numbers))

                color, too_deep = launches.add(launches.nothing(count), pixel, 0, len(cells), told)
                self._count_too_deep(too_deep)
                yield first, color
                first += count

    def _stage(
        self,
        launches: Launches,
        pace: Pace,
        begin: int,
        end: int,
        count: int,
        sums: PassSums | None,
        progress: Progress | None,
    ) -> Iterator[tuple[int, Any, Any]]:
        """Draw samples from `begin` to `end`, of `count`, of all pixels, in bands of rows, and add them to what is in
        `sums`, if given.

        Yields:
            The first row of a finished band, the sums of its pixels' colours (Color3d), and where the depth limit
            dropped a ray (Bool), if it is limited: both in the order of `in_tiles`.

        """
        first = 0
        while first < self._height:
            rows = min(self._height - first, pace.rows(self._width))
            pixel = in_tiles(self._width, first, rows)
            drawn = launches.nothing(rows * self._width)
            if sums is not None:
                too_deep = dr.gather(mi.Bool, sums.too_deep, pixel) if self._depth_limited else False
                drawn = dr.gather(mi.Color3d, sums.colors, pixel), too_deep
                dr.eval(drawn)

            def told(done: int, first: int = first, rows: int = rows) -> None:
                if progress is not None:
                    progress((begin + ((end - begin) * first + rows * (done - begin)) / self._height) / count)

            yield first, *launches.add(drawn, pixel, begin, end, told)
            first += rows

    @property
    def _samples(self) -> int:
        """Of a pixel, as the sensor's sampler has it."""
        count: int = self._sensor.sampler().sample_count()
        return count

    def _pace(self) -> Pace:
        return Pace(self._parameters.branching, self._parameters.max_depth[0])

    def _prepared(self, least_weight: float | None = None) -> Precisions:
        """The scene as kernels read it; nothing is drawn yet."""
        self.pixels_too_deep = 0
        self._precisions = self._integrator.prepared(self._scene, self._sensor, least_weight)
        return self._precisions

    def _count_too_deep(self, too_deep: Any) -> None:
        if self._depth_limited:
            self.pixels_too_deep += dr.count(too_deep)[0]
