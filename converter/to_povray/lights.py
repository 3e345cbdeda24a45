"""Point lights, and how POV-Ray can dim them.

POV-Ray dims a light at distance d by 2 / (1 + (d/D)^P), with `fade_distance` D and `fade_power` P. This expresses
1 / (a + b d + c d^2) where b or c is 0; two lights in one place, one of them negative, express it where the polynomial
has two real roots, since 1 / ((d + q) (d + r)) = (1 / (d + q) - 1 / (d + r)) / (r - q). Else five lights come near it.
"""

import math
from typing import NamedTuple

import numpy as np

from converter.scene.model import Light
from converter.to_povray.text import number, rgb, vector

CLOSEST = 1e-9
"""A light that grows without end is drawn as one that grows up to this distance, in units of the scene's size."""
_TERMS = ((1.0, 0.5), (1.0, 1.0), (2.0, 0.5), (2.0, 1.0), (2.0, 2.0))
"""Powers, and distances in units of sqrt(a/c), with which a polynomial that has no real roots is approached."""


class Fade(NamedTuple):
    """weight * 2 / (1 + (d / distance)^power), or the weight alone where the power is 0."""

    weight: float
    power: float = 0.0
    distance: float = 1.0


def light(source: Light, size: float) -> tuple[str, float]:
    """Light sources that together make a light, and by what share of its colour, at most, they are off.

    Args:
        source: the light.
        size: how far the scene reaches.

    """
    found, error = fades(source.attenuation, size)
    text = ""
    for weight, power, distance in found:
        fading = f" fade_power {power:g} fade_distance {number(distance)}" if power else ""
        color = rgb(weight * channel for channel in source.color)
        text += f"light_source {{ {vector(source.position)} {color}{fading} }}\n"
    return text, error


def fades(attenuation: tuple[float, float, float], size: float) -> tuple[list[Fade], float]:
    """Fades whose sum is 1 / (a + b d + c d^2), and the largest error of that sum at distances up to `size`.

    The error is infinite, and there are none, where nothing comes near it.
    """
    a, b, c = attenuation
    closest = CLOSEST * size
    if max(a, b, c) <= 0:  # what was positive has been rounded to zero in other units
        return [], math.inf
    if a > 0 and b == c == 0:
        return [Fade(1 / a)], 0.0
    if min(a, b, c) >= 0:
        if c == 0:
            return [_pole(a / b, 1 / b, closest)], 0.0
        if b == 0:
            distance = max(math.sqrt(a / c), closest)
            return [Fade(0.5 / c / distance / distance, 2.0, distance)], 0.0
        root = math.sqrt(max(b * b - 4 * a * c, 0))
        if root > b / 64:  # or the two would cancel in single precision, in which POV-Ray computes with colours
            far = (b + root) / (2 * c)
            return [_pole(2 * a / (b + root), 1 / root, closest), _pole(far, -1 / root, closest)], 0.0
    return _approach(a, b, c, size)


def _pole(at: float, residue: float, closest: float) -> Fade:
    """That of residue / (d + at)."""
    distance = max(at, closest)
    return Fade(residue / (2 * distance), 1.0, distance)


def _approach(a: float, b: float, c: float, size: float) -> tuple[list[Fade], float]:
    """The least squares' fades, at distances as many below as above the one where a and c weigh the same."""
    unit = math.sqrt(abs(a / c)) if a and c else size / 8
    d = np.concatenate([np.linspace(0, min(8 * unit, size), 200), np.geomspace(unit / 8, max(size, 8 * unit), 200)])
    divisor = a + b * d + c * d**2
    d, divisor = d[divisor > 0], divisor[divisor > 0]
    if not d.size or not np.isfinite(divisor).all():
        return [], math.inf
    basis = np.stack([2 / (1 + (d / (unit * distance)) ** power) for power, distance in _TERMS], axis=1)
    weights = np.linalg.lstsq(basis, 1 / divisor, rcond=None)[0]
    error = float(np.abs(basis @ weights - 1 / divisor).max())
    return [Fade(float(w), p, unit * d) for w, (p, d) in zip(weights, _TERMS, strict=True)], error
