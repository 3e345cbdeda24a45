"""One of many pictures: what is to be drawn as plain data, which travels, and drawing it.

What pictures share is a `Job`; a process keeps the renderer that the last one had, with its kernels.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from converter.films.script import Changes, frame_scene
from converter.renderers.base import Progress, Renderer, Rendering
from converter.scene.model import Scene
from converter.scene.settings import Crop, Settings


@dataclass(frozen=True, slots=True)
class Job:
    """A scene and how it is drawn: the method by its name, the pictures' format by its ending."""

    scene: Scene
    settings: Settings
    method: str
    variant: str | None
    ending: str


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of a job: of its scene with some changes, all or a part of it."""

    changes: Changes = ()
    crop: Crop | None = None


@dataclass(frozen=True, slots=True)
class Drawn:
    """A picture that is drawn.

    Attributes:
        data: of a whole picture the bytes of its file, of a part its pixels: height x width x 3 float32.
        seconds: by stage. statistics: the renderer's.
    """

    data: bytes
    seconds: dict[str, float]
    statistics: dict[str, Any]


def draw_picture(job: Job, picture: Picture, progress: Progress | None = None) -> Drawn:
    """Draw it.

    Raises:
        SceneError: with these changes it is no scene.
        Interrupted, RendererUnavailable, ValueError, OSError: as the renderer has it.

    """
    started = time.perf_counter()
    scene = frame_scene(job.scene, picture.changes) if picture.changes else job.scene
    settings = job.settings if picture.crop is None else replace(job.settings, crop=picture.crop)
    read = time.perf_counter() - started
    rendering = _renderer(job.method, job.variant).render(scene, settings, progress)
    begun = time.perf_counter()
    whole = picture.crop is None
    data = encoded(rendering, job.ending) if whole else bytes(memoryview(rendering.pixels).cast("B"))
    seconds = {"read": read, **rendering.seconds, "write": time.perf_counter() - begun}
    return Drawn(data, seconds, dict(rendering.statistics))


def encoded(rendering: Rendering, ending: str) -> bytes:
    """The bytes of a picture's file."""
    from converter.images.write import write_image

    with TemporaryDirectory() as folder:
        file = Path(folder, f"picture{ending}")
        write_image(file, rendering.pixels, rendering.width, rendering.height)
        return file.read_bytes()


@lru_cache(maxsize=4)
def _renderer(method: str, variant: str | None) -> Renderer:
    from converter.renderers.methods import find_method

    return find_method(method).renderer(variant)


# --------------------------------------------------------------------------------------------------------------- tiles

TILE_RAYS = 1 << 21
"""Rays from the eye of a tile: some seconds, so that what is lost with a worker is little."""


def tiles_of(settings: Settings, samples: int, least: int = 1) -> list[Crop]:
    """Bands of rows into which what is drawn is cut, `least` of them where there are so many rows; one is all of it."""
    left, top, right, _ = settings.drawn
    width, height = settings.drawn_size
    count = min(height, max(least, -(-width * height * samples // TILE_RAYS)))
    edges = [top + height * k // count for k in range(count + 1)]
    return [(left, first, right, end) for first, end in pairwise(edges)]


def assembled(tiles: Sequence[Drawn], settings: Settings) -> Rendering:
    """The picture that the bands make, from the top."""
    width, height = settings.drawn_size
    seconds: dict[str, float] = {}
    statistics = dict(tiles[0].statistics)
    for tile in tiles:
        for stage, spent in tile.seconds.items():
            seconds[stage] = seconds.get(stage, 0.0) + spent
    for name in ("rays", "primary", "reflected", "transmitted", "shadow", "pixels_too_deep"):
        if name in statistics:
            statistics[name] = sum(tile.statistics[name] for tile in tiles)
    if "deepest" in statistics:
        statistics["deepest"] = max(tile.statistics["deepest"] for tile in tiles)
    pixels = memoryview(b"".join(tile.data for tile in tiles)).cast("f", (height, width, 3))
    return Rendering(pixels, width, height, seconds, statistics)
