"""Samples of pixels, drawn launch after launch, and once more where the first kernel leaves a pixel undecided.

Undecided are pixels whose rays come close to a tie that the kernel has no rules for, or that single precision is not
enough for.
"""

from collections.abc import Callable
from contextlib import nullcontext
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.kernel_scene import KernelScene
from mitsuba_plugins.integrators.pace import Pace
from mitsuba_plugins.integrators.pixels import corners, sample_offsets
from mitsuba_plugins.integrators.precisions import Precisions
from mitsuba_plugins.integrators.primary_rays import name_sample, pixel_key, primary_ray
from mitsuba_plugins.integrators.ray_tree import trace
from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.syntax import syntax


class Launches:
    """Draws the samples of pixels that lie in some `cells` of the grid of `spp`, in that order.

    What is drawn of pixels is the sums of their samples' colours (Color3d), and where the depth limit dropped a ray
    (Bool), or False if it is not told.
    """

    def __init__(self, scenes: Precisions, cells: list[int], spp: int, pace: Pace) -> None:
        self._scenes, self._pace = scenes, pace
        offsets = sample_offsets(spp)
        self._tables = column(mi.Float64, [offsets[cell] for cell in cells]), mi.UInt32(cells)
        self._depth_limited = scenes.deciding.parameters.depth_limited
        scenes.deciding.postpone_ties(True)

    def nothing(self, count: int) -> tuple[Any, Any]:
        """What is drawn of so many pixels when none of their samples is."""
        # Opaque, so that the first launch needs no kernel of its own.
        return dr.opaque(mi.Color3d, 0, count), dr.opaque(mi.Bool, False, count) if self._depth_limited else False

    def add(
        self, drawn: tuple[Any, Any], pixel: Any, begin: int, end: int, told: Callable[[int], None]
    ) -> tuple[Any, Any]:
        """Add samples from `begin` to `end` to what is `drawn` of pixels, by their numbers (UInt32), launch after
        launch; after each `told` is called with the end that is reached.
        """
        count = dr.width(pixel)
        done = begin
        while done < end:
            more = min(end - done, self._pace.samples(count))
            with self._pace.launch(count * more):
                drawn = self._launch(drawn, pixel, done, done + more)
            done += more
            told(done)
        return drawn

    def _launch(
        self, drawn: tuple[Any, Any], pixel: Any, begin: int, end: int, is_first: bool = True
    ) -> tuple[Any, Any]:
        """Add some samples: the first time in single precision, if that is worth a try, else in double, there without
        the rules for ties if they are postponed; and once more, in double or by the rules, to the pixels that are left
        undecided.
        """
        deciding = self._scenes.deciding
        tries_single = is_first and self._scenes.tries_single
        with self._scenes.single() if tries_single else nullcontext(deciding) as scene:
            # Copies; of what is not limited False, which no loop carries.
            begun = mi.Color3d(drawn[0]), mi.Bool(drawn[1]) if self._depth_limited else False
            color, too_deep, undecided = _add_samples(scene, *begun, pixel, self._tables, begin, end)
            if is_first:
                self._pace.recorded()
            dr.eval(color, too_deep, undecided)
            dr.sync_thread()
        again = dr.compress(undecided) if tries_single or deciding.postpones_ties else mi.UInt32()
        if tries_single:
            self._scenes.count(dr.width(color), dr.width(again))
        elif dr.width(again) > 0:
            # Where there are ties there may be others: from now on they are decided at once, so that it is this launch
            # alone that is recorded twice.
            deciding.postpone_ties(False)
        if dr.width(again) > 0:
            begun = dr.gather(mi.Color3d, drawn[0], again), dr.gather(mi.Bool, mi.Bool(drawn[1]), again)
            decided = self._launch(begun, dr.gather(mi.UInt32, pixel, again), begin, end, is_first=False)
            dr.scatter(color, decided[0], again)
            if self._depth_limited:
                dr.scatter(too_deep, decided[1], again)
            dr.eval(color, too_deep)
            dr.sync_thread()
        return color, too_deep


@syntax
def _add_samples(
    scene: KernelScene, color: Any, too_deep: Any, pixel: Any, tables: Any, sample: Any, end: Any
) -> tuple[Any, Any, Any]:
    """What `trace` finds for pixels, by their numbers (UInt32), with some more samples added, and which of them are
    undecided.
    """
    width = dr.width(color)
    undecided: Any = dr.zeros(mi.Bool, width) if scene.leaves_undecided else False
    corner = corners(scene.sensor.film(), pixel)
    key = pixel_key(scene, corner)
    offsets, numbers = tables
    if dr.hint(dr.width(offsets) == 2, mode="scalar"):
        # One sample needs no loop.
        position = corner + dr.gather(mi.Point2d, offsets, mi.UInt32(0))
        name = name_sample(scene, key, mi.UInt32(0))
        more, deep, _, unknown = trace(scene, primary_ray(scene, position, name), name, True)
        color += more
        too_deep |= deep
        undecided |= unknown
    else:
        # Opaque, so that all numbers of samples share one kernel.
        sample, end = dr.opaque(mi.UInt32, sample, width), dr.opaque(mi.UInt32, end)
        while dr.hint(sample < end, exclude=[scene, corner, key, offsets, numbers, end]):
            position = corner + dr.gather(mi.Point2d, offsets, sample)
            number = dr.gather(mi.UInt32, numbers, sample) if scene.sampled else mi.UInt32(0)
            name = name_sample(scene, key, number)
            more, deep, _, unknown = trace(scene, primary_ray(scene, position, name), name, True)
            color += more
            too_deep |= deep
            undecided |= unknown
            sample += 1
    return color, too_deep, undecided
