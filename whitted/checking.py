"""What callers give, checked before anything is drawn."""

import math
from collections.abc import Callable
from operator import index
from typing import Any, get_args

from converter.scene.depth import MAX_DEPTH
from converter.scene.errors import did_you_mean
from converter.scene.model import Scene
from converter.scene.settings import (
    MAX_SAMPLES,
    MAX_SEED,
    MAX_SIZE,
    MOST_THREADS,
    IorReading,
    PixelSample,
    Points,
    Settings,
    Specular,
)

_WHOLE = {
    "width": (1, MAX_SIZE),
    "height": (1, MAX_SIZE),
    "max_depth": (0, MAX_DEPTH),
    "samples": (1, MAX_SAMPLES),
    "seed": (0, MAX_SEED),
    "threads": (0, MOST_THREADS),
}
"""Settings that are whole numbers, with the least and the largest."""
_WORDS = {"pixel": PixelSample, "specular": Specular, "ior": IorReading, "points": Points}
_MAY_BE_NONE = ("max_depth", "samples", "background", "crop")


def checked_settings(**given: Any) -> Settings:
    """Settings that make sense.

    Raises:
        TypeError: there is no such setting.
        ValueError: a value is none; the message says what was expected.

    """
    known = Settings.__match_args__
    for name in given:
        if name not in known:
            raise TypeError(f"there is no setting {name!r}{did_you_mean(name, known)}: {', '.join(known)} are")
    settings = Settings(**{name: _checked(name, value) for name, value in given.items()})
    left, top, right, bottom = settings.drawn
    if not (0 <= left < right <= settings.width and 0 <= top < bottom <= settings.height):
        size = f"{settings.width} x {settings.height}"
        raise ValueError(f"crop must be a part of a picture of {size} pixels, found {settings.crop}")
    return settings


def check_scene(scene: Any) -> None:
    """See that it is a scene.

    Raises:
        TypeError: it is something else.

    """
    if not isinstance(scene, Scene):
        raise TypeError(f"a scene is expected, from load_scene or load_text, found {type(scene).__name__}")


def check_progress(progress: Callable[[float], None] | None) -> None:
    """See that it can be called.

    Raises:
        TypeError: it cannot.

    """
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be a function of a number, found {type(progress).__name__}")


def not_negative(name: str, value: Any) -> float:
    """The value as a number that is finite and not negative.

    Raises:
        ValueError: it is none.

    """
    try:
        found = math.nan if isinstance(value, str) else float(value)
    except (TypeError, ValueError, OverflowError):
        found = math.nan
    if not 0 <= found < math.inf:
        raise ValueError(f"{name} must be a finite number that is not negative, found {value!r}")
    return found


def _checked(name: str, value: Any) -> Any:
    if value is None and name in _MAY_BE_NONE:
        return None
    if name in _WORDS:
        words = get_args(_WORDS[name])
        if value not in words:
            raise ValueError(f"{name} must be {' or '.join(map(repr, words))}, found {value!r}")
        return value
    if name == "cutoff":
        return not_negative(name, value)
    if name == "background":
        return _color(name, value)
    if name == "crop":
        return _numbers(name, value)
    found, (least, most) = _whole(value), _WHOLE[name]
    if found is None or not least <= found <= most:
        raise ValueError(f"{name} must be a whole number from {least} to {most}, found {value!r}")
    if name == "samples" and math.isqrt(found) ** 2 != found:
        raise ValueError(f"samples must be a square number such as 4 or 16, found {value!r}")
    return found


def _whole(value: Any) -> int | None:
    try:
        return None if isinstance(value, bool) else index(value)
    except TypeError:
        return None


def _numbers(name: str, value: Any) -> tuple[int, ...]:
    found = tuple(map(_whole, value)) if isinstance(value, tuple | list) else ()
    numbers = tuple(number for number in found if number is not None)
    if len(found) != 4 or len(numbers) != 4:
        raise ValueError(f"{name} must be four whole numbers: left, top, right, bottom; found {value!r}")
    return numbers


def _color(name: str, value: Any) -> tuple[float, ...]:
    try:
        found = tuple(map(float, value))
    except (TypeError, ValueError, OverflowError):
        found = ()
    if len(found) != 3 or not all(map(math.isfinite, found)):
        raise ValueError(f"{name} must be three finite numbers: red, green, blue; found {value!r}")
    return found
