"""Proves pixels."""

from collections.abc import Callable
from typing import Any

from converter.certify.certificate import Certificate
from converter.certify.certificate import certify as _certify
from converter.scene.model import Scene
from whitted.checking import check_progress, check_scene, checked_settings, not_negative


def certify(
    scene: Scene,
    width: int = 800,
    height: int = 600,
    *,
    ulps: float = 0.0,
    progress: Callable[[float], None] | None = None,
    **settings: Any,
) -> Certificate:
    """Compute the byte of every pixel with intervals that enclose all rounding errors.

    Args:
        scene: from `load_scene` or `load_text`, and not sampled.
        width: columns.
        height: rows.
        ulps: every number of the scene that is not whole is known to so many units in the last place of a double only.
        progress: called now and then, from the calling thread, with the finished share, 0 to 1.
        settings: more of `converter.scene.settings.Settings`, without `crop`: it is of all pixels.

    Raises:
        RendererUnavailable: the module is not built, or the scene is sampled.
        ValueError: a texture cannot be read; a setting makes no sense.
        TypeError: there is no such setting; `scene` is none.

    """
    check_scene(scene)
    check_progress(progress)
    given = checked_settings(width=width, height=height, **settings)
    if given.crop is not None:
        raise ValueError("crop must be None: a certificate is of all pixels")
    return _certify(scene, given, not_negative("ulps", ulps), progress)
