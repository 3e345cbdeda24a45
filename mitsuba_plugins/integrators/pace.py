"""How much of a picture is drawn by one launch of the kernel.

A launch has a fixed cost, some milliseconds in which Python records the kernel, or some hundredths of a second where a
csg is large, and cannot be stopped. So it should take a good part of a second, and how many rays that are is found out
while a picture is drawn.
"""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from mitsuba_plugins.backend import on_gpu

SECONDS = 0.5
"""What a launch should take, or as long as recording it did, if that is more."""
GROWTH = 8
"""A launch has no more rays than this times the one before, for the top of a picture may be nothing but sky."""
LEAST = 1 << 16
"""Primary rays of a launch, however long they take. Fewer take hardly less time, ..."""
LEAST_BRANCHING = {False: 1 << 10, True: 1 << 18}
"""... but where rays branch, for a tree may have 2^16 of them. On a CPU, and on a GPU, which has so many at once."""
FIRST = {False: 1 << 19, True: 1 << 23}
"""Primary rays of the first launch, likewise, a picture of 3840 x 2160; where rays branch it has the least."""
SHALLOW = 64
"""Bounces. Where every ray may take more, the least and the first launch have fewer rays in proportion."""
MOST_PIXELS = {False: 1 << 20, True: 1 << 25}
"""Of a band, likewise: memory grows with them and not with the number of samples."""
STAGE = 4
"""Launches that passes over the whole picture take together, at least: fewer would leave little for each band."""
MOST = 1 << 28
"""Primary rays of a launch."""


class Pace:
    """Sizes of bands and launches that follow how fast the picture is drawn."""

    def __init__(self, branching: bool, max_depth: int) -> None:
        share = min(1.0, SHALLOW / max(max_depth, 1))
        self._least = LEAST_BRANCHING[on_gpu()] if branching else int(share * LEAST)
        self._rays = self._least if branching else int(share * FIRST[on_gpu()])
        self._most_pixels = MOST_PIXELS[on_gpu()]
        self._recorded = 0.0
        self._measured = False

    def rows(self, width: int) -> int:
        """Rows of the next band, of a picture of that width. They do not depend on the number of samples."""
        return max(1, min(self._rays, self._most_pixels) // width)

    def samples(self, pixels: int) -> int:
        """Samples of each pixel that the next launch draws."""
        return max(1, self._rays // pixels)

    def passes(self, rays: int) -> int:
        """Passes, of so many primary rays each, that are drawn together next."""
        return max(1, STAGE * self._rays // rays) if self._measured else 1

    @contextmanager
    def launch(self, rays: int) -> Iterator[None]:
        """Measure a launch of so many primary rays, within which `recorded` is called before it is run."""
        started = time.perf_counter()
        yield
        recording, running = self._recorded - started, time.perf_counter() - self._recorded
        fitting = rays * max(SECONDS, recording) / max(running, 1e-3)
        self._measured = True
        self._rays = int(min(max(min(fitting, self._rays * GROWTH), self._least), MOST))

    def recorded(self) -> None:
        """Note that from now on the launch runs."""
        self._recorded = time.perf_counter()
