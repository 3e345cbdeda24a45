"""Pixels that single precision, or the scene itself, cannot decide: they are held against nobody.

Where the eye stands a millionth of its distance from where it should, a pixel at an edge, or deep in mirrors, has
another colour. A program in single precision errs by less in every number, but not much less after some bounces. So a
pixel is undecided where a picture in single precision, or one from such an eye, differs by more than a level; and where
the scene's decimals, known to a unit in the last place of a double, leave open what a ray meets, which only intervals
tell of every ray. That is looked for where rays are few enough for it to take a second or two.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from converter.certify.certificate import undetermined
from converter.images.texture import TextureError
from converter.renderers.base import RendererUnavailable
from converter.renderers.native import NativeRenderer, Precision
from converter.scene.model import Scene
from converter.scene.settings import Settings
from converter.why.likeness import EXACT, Mask, errors
from converter.why.picture import Picture
from converter.why.student import to_levels

_STEP = 2.0**-20
"""Shift of the eye as a share of its distance to the look-at point: some roundings of single precision, 2^-24 each."""
MOST_RAYS = 1_500_000
"""Of a picture, up to which it is computed with intervals."""


def undecided(scene: Scene, settings: Settings) -> Mask:
    """(height, width) pixels of a scene that single precision, or the scene itself, cannot decide."""
    rendering = NativeRenderer().render(scene, settings)
    right = _levels(np.asarray(rendering.pixels))
    result = np.zeros(right.shape[:2], np.bool_)
    for other in _others(scene, settings):
        result |= errors(right, other) > EXACT.tolerance
    if rendering.statistics["rays"] <= MOST_RAYS:
        with suppress(RendererUnavailable, TextureError):  # it is sampled, or has images that are not of levels
            result |= undetermined(scene, settings, ulps=1.0)
    return result


def draw(scene: Scene, settings: Settings, precision: Precision = "double") -> Picture:
    """The scene by the native tracer, as levels."""
    return _levels(np.asarray(NativeRenderer(precision).render(scene, settings).pixels))


def _levels(colors: NDArray[np.float32]) -> Picture:
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
