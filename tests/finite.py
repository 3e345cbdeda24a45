"""When every pixel of a picture has to be a number."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from converter.analysis.cutoff import cutoff_bound
from converter.scene.model import Checker, Finish, Light, Scene, Solid
from converter.scene.settings import Settings


def assert_finite(pixels: Any, scene: Scene, settings: Settings) -> None:
    """A pixel may be no number only where colours, single or summed up as their bound has it, exceed single precision.

    That is for rays in double precision. In single precision any number of the scene may be too large to be one.
    """
    if max(cutoff_bound(scene, settings).brightest, *_colors_of(scene)) < float(np.finfo(np.float32).max):
        assert np.isfinite(np.asarray(pixels)).all()


def _colors_of(scene: Scene) -> Iterator[float]:
    """Whatever colours are made of."""
    yield from map(abs, scene.ambient)
    for element in (*scene.lights, *scene.pigments, *scene.finishes):
        match element:
            case Light(_, color) | Solid(color):
                yield from map(abs, color)
            case Checker(first, second):
                yield from map(abs, (*first, *second))
            case Finish(ka, kd, ks, _, kr, kt):
                yield from (ka, kd, ks, kr, kt)
