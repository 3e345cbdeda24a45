"""Draws scenes."""

from collections.abc import Callable
from typing import Any

import numpy as np

from converter.renderers.base import Interrupted, Rendering
from converter.renderers.methods import METHODS, find_method
from converter.scene.model import Scene
from whitted.checking import check_progress, check_scene, checked_settings
from whitted.picture import Picture


class Stopped(KeyboardInterrupt):
    """Ctrl-C, or a notebook's Stop, while a picture was drawn; `partial` is what there is of it, black elsewhere."""

    def __init__(self, partial: Picture) -> None:
        super().__init__("stopped")
        self.partial = partial


def render(
    scene: Scene,
    width: int = 800,
    height: int = 600,
    *,
    method: str = "native",
    variant: str | None = None,
    progress: Callable[[float], None] | None = None,
    **settings: Any,
) -> Picture:
    """Draw a scene.

    Args:
        scene: from `load_scene` or `load_text`.
        width: columns.
        height: rows.
        method: a name of `methods()`, also with a setting, as in "native:max_depth=4".
        variant: what Mitsuba runs on, "llvm_ad_rgb" or "cuda_ad_rgb"; by itself a GPU if there is one.
        progress: called now and then, from the calling thread, with the finished share, 0 to 1. What it raises stops
            the drawing, and goes on to the caller; so does Ctrl-C, or a notebook's Stop.
        settings: more of `converter.scene.settings.Settings`: samples=16, cutoff=1/4096, background=(0, 0, 0), ...

    Raises:
        RendererUnavailable: the method does not run here, or cannot draw an effect that the scene has.
        Stopped: Ctrl-C while it was drawing.
        ValueError: there is no such method; a texture cannot be read; a setting makes no sense.
        TypeError: there is no such setting; `scene` is none.

    """
    check_scene(scene)
    check_progress(progress)
    if not isinstance(method, str):
        raise TypeError(f"method must be a name of methods(), found {method!r}")
    chosen = find_method(method)
    given = chosen.settings(checked_settings(width=width, height=height, **settings))
    try:
        return _picture(chosen.renderer(variant).render(scene, given, progress), chosen.name)
    except Interrupted as stop:
        raise Stopped(_picture(stop.partial, chosen.name)) from None


def methods() -> dict[str, str]:
    """Every method's name, with when to use it, or why it does not run here."""
    return {name: method.missing() or method.use for name, method in METHODS.items()}


def _picture(rendering: Rendering, name: str) -> Picture:
    return Picture(np.asarray(rendering.pixels), name, rendering.seconds, rendering.statistics)
