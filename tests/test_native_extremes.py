"""Numbers near the ends of a double's range, where squares overflow or vanish."""

from dataclasses import replace

import numpy as np
import pytest

from converter.renderers.native import NativeRenderer
from converter.scene.settings import Settings

SETTINGS = Settings(width=24, height=18)


@pytest.mark.parametrize("precision", ["float", "double", "long double"])
@pytest.mark.parametrize("scale", [1e-300, 1e-30, 1e30, 1e300])
def test_up_may_have_any_length(small_scene, precision, scale):
    camera = replace(small_scene.camera, up=tuple(scale * x for x in small_scene.camera.up))
    renderer = NativeRenderer(precision)
    plain = np.asarray(renderer.render(small_scene, SETTINGS).pixels)
    assert np.array_equal(renderer.render(replace(small_scene, camera=camera), SETTINGS).pixels, plain)


def test_look_at_may_be_anywhere(small_scene):
    eye = small_scene.camera.eye
    pictures = [
        NativeRenderer().render(
            replace(small_scene, camera=replace(small_scene.camera, look_at=(eye[0], eye[1], distance))), SETTINGS
        )
        for distance in (1e10, 1e200, 1e308)
    ]
    assert np.array_equal(pictures[0].pixels, pictures[1].pixels)
    assert np.array_equal(pictures[0].pixels, pictures[2].pixels)
