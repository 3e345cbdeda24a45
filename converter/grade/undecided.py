"""Pixels that single precision cannot decide: they are held against nobody.

Where the eye stands a millionth of its distance from where it should, a pixel at an edge, or deep in mirrors, has
another colour. A program in single precision errs by less in every number, but not much less after some bounces. So a
pixel is undecided where a picture in single precision, or one from such an eye, differs by more than a level.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from converter.renderers.native import NativeRenderer, Precision
from converter.scene.model import Scene
from converter.scene.settings import Settings
from converter.why.likeness import EXACT, Mask, errors
from converter.why.picture import Picture
from converter.why.student import to_levels

_STEP = 2.0**-20
"""Shift of the eye as a share of its distance to the look-at point: some roundings of single precision, 2^-24 each."""


def undecided(scene: Scene, settings: Settings) -> Mask:
    """(height, width) pixels of a scene that single precision cannot decide."""
    right = draw(scene, settings)
    result = np.zeros(right.shape[:2], np.bool_)
    for other in _others(scene, settings):
        result |= errors(right, other) > EXACT.tolerance
    return result


def draw(scene: Scene, settings: Settings, precision: Precision = "double") -> Picture:
    """The scene by the native tracer, as levels."""
    colors = np.asarray(NativeRenderer(precision).render(scene, settings).pixels)
    return to_levels(colors.reshape(-1, 3)).reshape(colors.shape)


def _others(scene: Scene, settings: Settings) -> Iterator[Picture]:
    yield draw(scene, settings, "float")
    eye, look_at = np.array(scene.camera.eye), np.array(scene.camera.look_at)
    step = _STEP * float(np.linalg.norm(look_at - eye))
    for axis in np.eye(3):
        for sign in (-step, step):
            yield draw(_seen_from(scene, eye + sign * axis), settings)


def _seen_from(scene: Scene, eye: NDArray[np.float64]) -> Scene:
    x, y, z = map(float, eye)
    return replace(scene, camera=replace(scene.camera, eye=(x, y, z)))
