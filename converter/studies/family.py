"""A family of scenes: one number pushed toward trouble, with the true picture for each of its values."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Scene
from converter.scene.settings import Settings

Truth = NDArray[np.float64]
"""(height, width, 3) linear RGB, row 0 on top."""


@dataclass(frozen=True, slots=True)
class Case:
    """A family's scene at one value, and what its picture has to be.

    Attributes:
        scene: the scene. All scenes of a family have the same structure and differ in numbers only, so that Mitsuba
            compiles one kernel for them.
        settings: of a small picture, large enough to see the failure.
        truth: the picture by a closed form; None: what `certify` proves with the same settings, and where it does not,
            or the scene is sampled, what the native tracer draws in long double.
        allowed: share of the pixels that may differ by more than 1/255 for reasons that no method can help, such as a
            step of the truth between what a pixel's coordinates round to.

    """

    scene: Scene
    settings: Settings
    truth: Truth | None
    allowed: float = 0.0


@dataclass(frozen=True, slots=True)
class Family:
    """Scenes that differ in one number.

    Attributes:
        name: short, in lower case, e.g. "size".
        about: a sentence that explains it.
        stress: what the number is, with its unit, e.g. "distance over radius".
        values: of the number, from easy to hard, usually a decade apart.
        case: the scene for a value.
        both_ways: the easy value lies inside the values, which ascend: a method may fail on either side of it.

    """

    name: str
    about: str
    stress: str
    values: tuple[float, ...]
    case: Callable[[float], Case]
    both_ways: bool = False
