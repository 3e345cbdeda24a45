"""What is proven of a picture's bytes."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.certify.scene import certified_scene
from converter.renderers.base import Progress, RendererUnavailable, Rendering
from converter.scene.model import Scene
from converter.scene.settings import Settings

REASONS = {
    "byte": "its colour lies between two levels",
    "hit": "which body a ray meets, or whether it does",
    "plane": "which surface of a body it meets",
    "tile": "on which tile of a checker it ends",
    "texel": "on which texel of an image it ends",
    "shadow": "whether a light is hidden",
    "facing": "whether a light is before a surface or behind it",
    "reflection": "whether a ray is reflected totally",
    "cutoff": "whether a ray weighs enough to be followed",
    "division": "what is divided by may be 0",
    "range": "a number is beyond those of a double",
    "degenerate": "what is equal, or nearly so, that no number of digits tells",
}
"""Why a pixel may be undecided."""
DETERMINED = ("byte", "range")
"""Of these, what does not say that a scene leaves a decision open: a colour may lie between two levels."""


@dataclass(frozen=True, slots=True, repr=False)
class Certificate:
    """What is proven of a picture.

    Attributes:
        low, high: (height, width, 3) uint8, each certified byte; where a colour lies so near the edge between two
            levels that storing it as a float may take it over, `high` is one more, and either is right.
        colors: (height, width, 3) float64, linear RGB, not clamped: of each certified pixel a colour that lies in the
            interval that encloses the true one; NaN where a pixel is undecided.
        undecided: (height, width) uint8, 0 where a pixel is certified, else the reason's place among `REASONS`, from 1.
        rung: (height, width) uint8, of how many digits were needed, an index of `digits`.
        tied: (height, width) bool, where the format's rule for ties has decided something that is equal to 80 digits.
        digits: binary digits of each rung. seconds: by rung, and for the scene's preparation.

    """

    low: NDArray[np.uint8]
    high: NDArray[np.uint8]
    colors: NDArray[np.float64]
    undecided: NDArray[np.uint8]
    rung: NDArray[np.uint8]
    tied: NDArray[np.bool_]
    digits: tuple[int, ...]
    seconds: dict[str, float]

    def __repr__(self) -> str:
        height, width = self.undecided.shape
        return f"<{width} x {height} pixels, {np.count_nonzero(self.certified)} certified>"

    @property
    def certified(self) -> NDArray[np.bool_]:
        """(height, width), which pixels are."""
        result: NDArray[np.bool_] = self.undecided == 0
        return result

    def counts(self) -> dict[str, int]:
        """Pixels by the reason why they are undecided, without reasons that do not occur."""
        found = np.bincount(self.undecided.ravel(), minlength=len(REASONS) + 1)
        return {name: int(count) for name, count in zip(REASONS, found[1:], strict=True) if count}

    def misses(self, levels: NDArray[np.uint8]) -> NDArray[np.int16]:
        """(height, width), by how many levels bytes are off where they are certified: their largest channel's."""
        low, high, found = (np.asarray(x, np.int16) for x in (self.low, self.high, levels))
        off = np.maximum(low - found, found - high).max(axis=2).clip(0)
        result: NDArray[np.int16] = np.where(self.certified, off, 0)
        return result


def levels(rendering: Rendering) -> NDArray[np.uint8]:
    """(height, width, 3), the bytes that a picture is written with."""
    from native_tracer import quantize

    return np.frombuffer(quantize(rendering.pixels), np.uint8).reshape(rendering.height, rendering.width, 3)


def certify(
    scene: Scene, settings: Settings, ulps: float = 0.0, progress: Progress | None = None, first: int = 0
) -> Certificate:
    """Certify all pixels of `scene`, drawn with `settings`.

    Args:
        scene: the scene; its numbers are the decimal numbers that a file has for them.
        settings: the picture's.
        ulps: every number of the scene that is not whole is known to so many units in the last place of a double only.
        progress: called now and then.
        first: the rung to begin with.

    Raises:
        RendererUnavailable: the module is not built, or the scene is sampled.
        ValueError: a texture cannot be read.

    """
    height, width = settings.height, settings.width
    places = np.argwhere(np.ones((height, width), np.bool_))
    found, seconds = _prove(scene, settings, places, ulps, progress, first)
    found["color"][found["reason"] != 0] = np.nan
    return Certificate(
        found["low"].reshape(height, width, 3),
        found["high"].reshape(height, width, 3),
        found["color"].reshape(height, width, 3),
        found["reason"].reshape(height, width),
        found["rung"].reshape(height, width),
        found["tied"].reshape(height, width).astype(np.bool_),
        tuple(found["digits"].tolist()),
        seconds,
    )


def undetermined(
    scene: Scene,
    settings: Settings,
    ulps: float,
    where: NDArray[np.bool_] | None = None,
    progress: Progress | None = None,
) -> NDArray[np.bool_]:
    """(height, width), pixels that the scene does not determine, if its numbers that are not whole are known to so many
    units in the last place of a double only: where some decision, what a ray meets or which tile, can go either way.
    Exact ties are among them. Only the pixels in `where` are looked at.

    Raises:
        RendererUnavailable: the module is not built, or the scene is sampled.
        ValueError: a texture cannot be read.

    """
    result = np.zeros((settings.height, settings.width), np.bool_)
    places = np.argwhere(~result if where is None else where)
    if len(places):
        found, _ = _prove(scene, settings, places, ulps, progress)
        left_open = np.array([False] + [name not in DETERMINED for name in REASONS])
        result[tuple(places.T)] = left_open[found["reason"]]
    return result


def _prove(
    scene: Scene,
    settings: Settings,
    places: NDArray[np.int64],
    ulps: float,
    progress: Progress | None,
    first: int = 0,
) -> tuple[dict[str, NDArray[Any]], dict[str, float]]:
    """What the tracer of intervals tells of pixels, (n, 2) rows and columns, with reasons as in a `Certificate`; and
    seconds by stage.
    """
    try:
        import certified_tracer
    except ImportError as error:
        raise RendererUnavailable(f"the certifying tracer is not built ({error}); `make` builds it") from None
    from converter.renderers.native import available_cores

    started = time.perf_counter()
    built = certified_scene(scene, settings, ulps)
    seconds = {"build": time.perf_counter() - started}
    pixels = np.ascontiguousarray(places[:, ::-1].astype(np.int32))
    # More digits tell nothing of numbers that are not known.
    last = len(certified_tracer.digits) - 1 if ulps == 0 else 1
    found = certified_tracer.certify(built, pixels, first, last, settings.threads or available_cores(), progress)
    seconds["certify"] = time.perf_counter() - started - seconds["build"]
    order = np.array([0] + [list(REASONS).index(name) + 1 for name in certified_tracer.reasons[1:]], np.uint8)
    return {**found, "reason": order[found["reason"]], "digits": np.array(certified_tracer.digits)}, seconds
