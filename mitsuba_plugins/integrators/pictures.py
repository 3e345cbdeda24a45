"""How pictures are drawn with an integrator that traces rays: in bands of rows, in passes of samples, or some pixels
more often than others.

The integrator is a `whitted`. It keeps how many `pixels_too_deep` there are, and the `sums` of whole passes.
"""

import math
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins import sampler as samples
from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.pace import Pace
from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.syntax import syntax
from native_tracer.passes import passes

Progress = Callable[[float], None]
"""Called after every launch with the finished share of the picture."""


TILE = 4
"""Rows of pixels that are drawn together: with four columns they are 16, a packet of processors with AVX-512."""


@dataclass(frozen=True)
class PassSums:
    """What is drawn of a picture in whole passes: their number, the sums of the samples' colours (Color3d), and the
    pixels in which the depth limit dropped a ray (Bool).
    """

    passes: int
    colors: Any
    too_deep: Any


def bands(
    integrator: Any, scene: Any, sensor: Any, spp: int = 0, progress: Progress | None = None
) -> Iterator[tuple[int, Any]]:
    """Draw a picture in bands of rows, so that memory does not grow with its size, by launches that take some time
    but not long, so that there are signs of life and no more launches than that.

    Yields:
        The first row of a finished band within the film's crop window, and its pixels' colours, row by row, three
        numbers each (Float). Its pixels are among `pixels_too_deep` by then. After every launch `progress`, if any,
        is called with the finished share of the picture.

    """
    cells = [cell for cells in passes(spp or sensor.sampler().sample_count()) for cell in cells]
    width = sensor.film().crop_size().x
    with integrator.prepared(scene, sensor), dr.suspend_grad():
        integrator.postpone_ties(True)
        pace = Pace(integrator.branching, integrator.max_depth[0])
        integrator.pixels_too_deep = 0
        for first, color, too_deep in _stage(
            integrator, sensor, pace, _tables(cells, len(cells)), 0, len(cells), None, progress
        ):
            if integrator.depth_limited:
                integrator.pixels_too_deep += dr.count(too_deep)[0]
            yield first, _shown(color, len(cells), width)


def bands_by_passes(
    integrator: Any, scene: Any, sensor: Any, start: PassSums | None = None, progress: Progress | None = None
) -> Iterator[tuple[int, Any]]:
    """Draw a picture in passes of samples, see :mod:`native_tracer.passes`, and each in bands: pictures that take
    long, for all of it has some samples soon. Short passes are drawn together.

    Yields:
        The first row of a band within the film's crop window, and its pixels' colours, as `bands` has them, with what
        is drawn so far. What is left in ``sums`` (PassSums) has whole passes only, beginning with those of `start`.

    """
    all_passes = passes(sensor.sampler().sample_count())
    cells = [cell for cells in all_passes for cell in cells]
    width, height = sensor.film().crop_size()
    with integrator.prepared(scene, sensor), dr.suspend_grad():
        integrator.postpone_ties(True)
        pace = Pace(integrator.branching, integrator.max_depth[0])
        tables = _tables(cells, len(cells))
        integrator.sums = start or PassSums(0, dr.zeros(mi.Color3d, width * height), dr.zeros(mi.Bool, width * height))
        while integrator.sums.passes < len(all_passes):
            size = len(all_passes[0])
            more = min(pace.passes(width * height * size), len(all_passes) - integrator.sums.passes)
            begin, end = integrator.sums.passes * size, (integrator.sums.passes + more) * size
            bands = []
            sums = integrator.sums if begin else None
            for first, color, too_deep in _stage(integrator, sensor, pace, tables, begin, end, sums, progress):
                place = _place_in_tiles(width, dr.width(color) // width)
                deep = too_deep if integrator.depth_limited else dr.zeros(mi.Bool, dr.width(color))
                bands.append((*dr.gather(mi.Color3d, color, place), dr.gather(mi.Bool, deep, place)))
                yield first, _shown(color, end, width)
            red, green, blue, too_deep = (dr.concat(parts) for parts in zip(*bands, strict=True))
            colors = mi.Color3d(red, green, blue)
            dr.eval(colors, too_deep)
            integrator.sums = PassSums(integrator.sums.passes + more, colors, too_deep)
            integrator.pixels_too_deep = dr.count(too_deep)[0]


def signed_bands(
    integrator: Any, scene: Any, sensor: Any, least_weight: float, progress: Progress | None = None
) -> Iterator[tuple[int, Any, Any]]:
    """Draw a picture of one sample a pixel in bands of rows, with signatures of rays that weigh at least
    `least_weight`, see :mod:`.signature`.

    Yields:
        The first row of a band within the film's crop window, and its pixels' colours, as `bands` has them, and
        signatures (UInt32).

    """
    width, height = sensor.film().crop_size()
    with integrator.prepared(scene, sensor, least_weight), dr.suspend_grad():
        pace = Pace(integrator.branching, integrator.max_depth[0])
        integrator.pixels_too_deep = 0
        offset = column(mi.Float64, sample_offsets(1))
        first = 0
        while first < height:
            rows = min(height - first, pace.rows(width))
            with pace.launch(rows * width):
                corner = _corners(sensor.film(), _rows(sensor.film(), first, rows * width))
                position = corner + dr.gather(mi.Point2d, offset, mi.UInt32(0))
                number = samples.Sample(mi.UInt32(0), mi.UInt32(0))
                ray = integrator.primary_ray(sensor, position, number)
                color, too_deep, signature, _ = integrator.trace(ray, number, True)
                pace.recorded()
                dr.eval(color, too_deep, signature)
                dr.sync_thread()
            if integrator.depth_limited:
                integrator.pixels_too_deep += dr.count(too_deep)[0]
            yield first, dr.ravel(mi.Color3f(color)), signature
            first += rows
            if progress is not None:
                progress(first / height)


def chosen_pixels(
    integrator: Any, scene: Any, sensor: Any, numbers: Any, cells: list[int], progress: Progress | None = None
) -> Iterator[tuple[int, Any]]:
    """Draw some pixels, with the samples in some cells of the grid. The `numbers` of the pixels (NumPy, uint32)
    count row by row within the film's crop window.

    Yields:
        The index of a pixel among them, and the sums of the samples' colours (Color3d) from it on, for as many as
        are drawn at once.

    """
    with integrator.prepared(scene, sensor), dr.suspend_grad():
        integrator.postpone_ties(True)
        pace = Pace(integrator.branching, integrator.max_depth[0])
        tables = _tables(cells, sensor.sampler().sample_count())
        integrator.pixels_too_deep = 0
        first = 0
        while first < len(numbers):
            pixel = column(mi.UInt32, numbers[first : first + pace.rows(1)])
            count = dr.width(pixel)

            def told(done: int, begin: int = first, count: int = count) -> None:
                if progress is not None:
                    progress((begin + count * done / len(cells)) / len(numbers))

            drawn = _nothing(integrator, count)
            color, too_deep = _launched(integrator, sensor, pace, drawn, pixel, tables, 0, len(cells), told)
            if integrator.depth_limited:
                integrator.pixels_too_deep += dr.count(too_deep)[0]
            yield first, color
            first += count


def _tables(cells: list[int], spp: int) -> tuple[Any, Any]:
    """Where some of `spp` samples of a pixel lie, in the order in which they are drawn, and their numbers."""
    offsets = sample_offsets(spp)
    return column(mi.Float64, [offsets[cell] for cell in cells]), mi.UInt32(cells)


def _stage(
    integrator: Any,
    sensor: Any,
    pace: Pace,
    tables: Any,
    begin: int,
    end: int,
    sums: PassSums | None,
    progress: Progress | None,
) -> Iterator[tuple[int, Any, Any]]:
    """Draw samples from `begin` to `end` of all pixels, in bands of rows, and add them to what is in `sums`
    (PassSums), if given.

    Yields:
        The first row of a finished band, the sums of its pixels' colours (Color3d), and where the depth limit
        dropped a ray (Bool), if it is limited: both in the order of `_in_tiles`.

    """
    width, height = sensor.film().crop_size()
    count = dr.width(tables[1])
    first = 0
    while first < height:
        rows = min(height - first, pace.rows(width))
        pixel = _in_tiles(width, first, rows)
        drawn = _nothing(integrator, rows * width)
        if sums is not None:
            too_deep = dr.gather(mi.Bool, sums.too_deep, pixel) if integrator.depth_limited else False
            drawn = dr.gather(mi.Color3d, sums.colors, pixel), too_deep
            dr.eval(drawn)

        def told(done: int, first: int = first, rows: int = rows) -> None:
            if progress is not None:
                progress((begin + ((end - begin) * first + rows * (done - begin)) / height) / count)

        color, too_deep = _launched(integrator, sensor, pace, drawn, pixel, tables, begin, end, told)
        yield first, color, too_deep
        first += rows


def _nothing(integrator: Any, count: int) -> tuple[Any, Any]:
    """Of so many pixels no samples: the sums of their colours, and where rays were dropped, if that is limited."""
    # Opaque, so that the first launch needs no kernel of its own.
    return dr.opaque(mi.Color3d, 0, count), dr.opaque(mi.Bool, False, count) if integrator.depth_limited else False


def _launched(
    integrator: Any,
    sensor: Any,
    pace: Pace,
    drawn: Any,
    pixel: Any,
    tables: Any,
    begin: int,
    end: int,
    told: Callable[[int], None],
) -> tuple[Any, Any]:
    """Add samples from `begin` to `end` to what is `drawn` of pixels, as `_nothing` has it, launch after launch; after
    each `told` is called with the end that is reached.
    """
    color, too_deep = drawn
    count = dr.width(color)
    done = begin
    while done < end:
        more = min(end - done, pace.samples(count))
        with pace.launch(count * more):
            some = tables, done, done + more
            single = integrator.precisions is not None and integrator.precisions.tries_single
            color, too_deep = _launch(integrator, sensor, (color, too_deep), pixel, some, single, pace.recorded)
        done += more
        told(done)
    return color, too_deep


def _launch(
    integrator: Any,
    sensor: Any,
    drawn: tuple[Any, Any],
    pixel: Any,
    some: Any,
    single: bool,
    recorded: Callable[[], None] = lambda: None,
) -> tuple[Any, Any]:
    """Add `some` samples to what is `drawn` of pixels, in single precision or in double, there without the rules for
    ties if they are postponed; and once more, in double or by the rules, to the pixels that are left undecided.
    """
    with integrator.precisions.single() if single else nullcontext():
        # Copies; of what is not limited False, which no loop carries.
        begun = mi.Color3d(drawn[0]), mi.Bool(drawn[1]) if integrator.depth_limited else False
        color, too_deep, undecided = _add_samples(integrator, sensor, *begun, pixel, *some)
        recorded()
        dr.eval(color, too_deep, undecided)
        dr.sync_thread()
    again = dr.compress(undecided) if single or integrator.postpones_ties else mi.UInt32()
    if single:
        integrator.precisions.count(dr.width(color), dr.width(again))
    elif dr.width(again) > 0:
        # Where there are ties there may be others: from now on they are decided at once, so that it is this launch
        # alone that is recorded twice.
        integrator.postpone_ties(False)
    if dr.width(again) > 0:
        begun = dr.gather(mi.Color3d, drawn[0], again), dr.gather(mi.Bool, mi.Bool(drawn[1]), again)
        decided = _launch(integrator, sensor, begun, dr.gather(mi.UInt32, pixel, again), some, False)
        dr.scatter(color, decided[0], again)
        if integrator.depth_limited:
            dr.scatter(too_deep, decided[1], again)
        dr.eval(color, too_deep)
        dr.sync_thread()
    return color, too_deep


@syntax
def _add_samples(
    integrator: Any, sensor: Any, color: Any, too_deep: Any, pixel: Any, tables: Any, sample: Any, end: Any
) -> tuple[Any, Any, Any]:
    """What `trace` finds for pixels, by their numbers (UInt32), with some more samples added, and which of them are
    undecided.
    """
    width = dr.width(color)
    undecided = dr.zeros(mi.Bool, width) if integrator.leaves_undecided else False
    corner = _corners(sensor.film(), pixel)
    key = integrator.pixel_key(corner)
    offsets, numbers = tables
    if dr.hint(dr.width(offsets) == 2, mode="scalar"):
        # One sample needs no loop.
        position = corner + dr.gather(mi.Point2d, offsets, mi.UInt32(0))
        number = integrator.name_sample(key, mi.UInt32(0))
        more, deep, _, unknown = integrator.trace(integrator.primary_ray(sensor, position, number), number, True)
        color += more
        too_deep |= deep
        undecided |= unknown
    else:
        # Opaque, so that all numbers of samples share one kernel.
        sample, end = dr.opaque(mi.UInt32, sample, width), dr.opaque(mi.UInt32, end)
        while dr.hint(sample < end, exclude=[integrator, sensor, corner, key, offsets, numbers, end]):
            position = corner + dr.gather(mi.Point2d, offsets, sample)
            number = integrator.name_sample(
                key, dr.gather(mi.UInt32, numbers, sample) if integrator.sampled else mi.UInt32(0)
            )
            more, deep, _, unknown = integrator.trace(integrator.primary_ray(sensor, position, number), number, True)
            color += more
            too_deep |= deep
            undecided |= unknown
            sample += 1
    return color, too_deep, undecided


def sample_offsets(spp: int) -> list[tuple[float, float]]:
    """Positions of a pixel's samples, in pixels from its top left corner.

    Raises:
        ValueError: `spp` is no square number.

    """
    n = math.isqrt(spp)
    if n * n != spp:
        raise ValueError(f"whitted: samples per pixel are laid out as a grid, and {spp} is no square number")
    return [((cell % n + 0.5) / n, (cell // n + 0.5) / n) for cell in range(spp)]


def _rows(film: Any, first: int, count: int) -> Any:
    """The numbers (UInt32) of `count` pixels from row `first` of the film's crop window on."""
    return dr.arange(mi.UInt32, count) + dr.opaque(mi.UInt32, first * film.crop_size().x)


def _in_tiles(width: int, first: int, rows: int) -> Any:
    """The numbers (UInt32) of the pixels of some rows of a picture, in strips of `TILE` rows, column by column.

    So those of a packet form a square: their rays take the same way more often than those of a row.
    """
    columns, rows_there = dr.opaque(mi.UInt32, width), dr.opaque(mi.UInt32, rows)
    number = dr.arange(mi.UInt32, width * rows)
    strip = _divided(number, columns * TILE)
    height = dr.minimum(rows_there - strip * TILE, TILE)
    rest = number - strip * columns * TILE
    column = _divided(rest, height)
    return (dr.opaque(mi.UInt32, first) + strip * TILE + rest - column * height) * columns + column


def _place_in_tiles(width: int, rows: int) -> Any:
    """Where each pixel of some rows, row by row, stands in the order of `_in_tiles` (UInt32)."""
    columns, rows_there = dr.opaque(mi.UInt32, width), dr.opaque(mi.UInt32, rows)
    number = dr.arange(mi.UInt32, width * rows)
    row = _divided(number, columns)
    strip = row // TILE
    height = dr.minimum(rows_there - strip * TILE, TILE)
    return strip * columns * TILE + (number - row * columns) * height + row - strip * TILE


def _shown(sums: Any, samples: int, width: int) -> Any:
    """Colours, row by row, three numbers each (Float), of the sums of pixels (Color3d) in the order of `_in_tiles`."""
    count = dr.width(sums)
    result = dr.empty(mi.Float, 3 * count)
    dr.scatter(result, mi.Color3f(quotient(sums, samples)), _in_tiles(width, 0, count // width))
    return result


def _divided(a: Any, b: Any) -> Any:
    """Whole numbers (UInt32), divided and rounded down. Processors divide no vectors of them, but doubles, exactly."""
    return mi.UInt32(quotient(mi.Float64(a), mi.Float64(b)))


def _corners(film: Any, pixel: Any) -> Any:
    """Top left corners (Point2d) of pixels, by their numbers in the film's crop window, row by row."""
    columns = dr.opaque(mi.UInt32, film.crop_size().x)  # opaque, so that pictures of all sizes share one kernel
    left, top = (dr.opaque(mi.Float64, at) for at in film.crop_offset())  # and all parts of them
    row = _divided(pixel, columns)
    return mi.Point2d(pixel - row * columns, row) + mi.Point2d(left, top)


def block(bands: Any, film: Any) -> Any:
    """Bands of a picture, as `bands` has them, as a film takes them up: cheaper than to splat them, and the same for a
    box filter.
    """
    width, height = film.crop_size()
    # After red, green and blue come alpha, where the film has it, and the sum of the filter's weights: all 1.
    count = film.base_channels_count() + 1
    ones = dr.full(mi.Float, 1, width * height)
    pixels = dr.empty(mi.Float, width * height * count)
    index = dr.arange(mi.UInt32, width * height)
    color = dr.gather(mi.Color3f, dr.concat(bands), index)
    for k, channel in enumerate([*color] + [ones] * (count - 3)):
        dr.scatter(pixels, channel, index * count + k)
    return mi.ImageBlock(mi.TensorXf(pixels, (height, width, count)), film.crop_offset(), film.rfilter(), border=False)
