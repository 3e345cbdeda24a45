"""What the page has done by its helper."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from converter.compare.metrics import Pixels
from converter.renderers.records import PixelRecord
from converter.scene.model import Scene
from converter.scene.settings import Settings


def draw_by_mitsuba(scene: Scene, settings: Settings) -> Pixels:
    """Mitsuba's picture.

    Raises:
        RendererUnavailable: it does not run here.
        ValueError: the scene cannot be drawn.

    """
    from converter.renderers.mitsuba import MitsubaRenderer

    return np.array(MitsubaRenderer().render(scene, settings).pixels, dtype=np.float32)


def trace_by_mitsuba(scene: Scene, settings: Settings, x: int, y: int) -> PixelRecord:
    """A pixel's rays in Mitsuba; fails as `draw_by_mitsuba` does."""
    from converter.renderers.mitsuba import MitsubaRenderer

    return MitsubaRenderer().trace_pixel(scene, settings, x, y)


def tell_why(scene: Scene, settings: Settings, name: str, levels: NDArray[np.uint8], lossy: bool) -> str:
    """What `whitted why` says of a picture, in a sentence or two.

    Raises:
        UnknownToStudent: the scene has more than that knows.

    """
    from converter.why.judge import judge
    from converter.why.left import places_left
    from converter.why.picture import Theirs
    from converter.why.report import left_sentence, verdict

    judged = judge(scene, Theirs(Path(name), levels, lossy), replace(settings, max_depth=None))
    return " ".join(filter(None, (verdict(judged), left_sentence(places_left(judged), judged))))
