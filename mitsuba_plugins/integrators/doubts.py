"""By how much the colour of a ray may be off, its doubt, where single precision is tried first.

Bounds of all errors are computed along with the numbers (see :mod:`mitsuba_plugins.intersection.rounding`). Doubts
follow from these: what is not known of a ray counts as the brightest colour that a ray can bring. A pixel whose doubts
add up to `MOST_DOUBT` is undecided, and drawn once more in double.

Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition, 2002, section 3.3: running error analysis.
"""

from typing import Any

import drjit as dr

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.tables import Finish
from mitsuba_plugins.intersection.rays import Hit, Ray, power
from mitsuba_plugins.intersection.rounding import epsilon, least_spread

MOST_DOUBT = 0.5 / 255
"""By how much a colour that is drawn in single precision alone may be off: half a level of 255."""
MOST_TURN = 0.25
"""Errors of directions beyond which bounds to first order, with some room, do not hold."""
WEIGHT_ERROR = 2.0**-12
"""Relative, of a weight, after some hundred products."""


def light_doubt(
    ray: Ray,
    hit: Hit,
    finish: Finish,
    color: Any,
    color_doubt: Any,
    cosine: Any,
    distance: Any,
    error: Any,
    emission: Any,
    attenuation: Any,
    highlight: tuple[Any, Any] | None,
) -> tuple[Any, Any]:
    """By how much what a light adds at a hit may be off (Float), and how much that may be at most.

    The ray has hit a surface with a finish and a `color` (Color3), a channel of which may be off by `color_doubt`. The
    way to the light, of length `distance`, has this cosine to the normal, and its two ends may be off by `error`. The
    light has its `emission` (Color3) and the coefficients (Vector3) of its attenuation. `highlight` is the cosine whose
    power that is, and by how much more than others its angle may be off; or None.
    """
    turn = quotient(error, distance) + least_spread(distance)
    known = turn < MOST_TURN
    a, b, c = (dr.abs(number) for number in attenuation)
    divisor = dr.abs(attenuation.x + distance * (attenuation.y + distance * attenuation.z))
    off = error * (b + c * (2 * distance + error)) + 4 * epsilon(a) * (a + distance * (b + distance * c))
    known &= off < 0.5 * divisor
    intensity = dr.abs(emission) * quotient(1, divisor - off)
    relative = quotient(2 * off, divisor)

    lean = hit.lean + turn
    cosine = dr.maximum(cosine, 0)
    most_cosine = dr.minimum(cosine + lean, 1)
    diffuse = finish.kd * intensity
    doubt = diffuse * (dr.abs(color) * (lean + cosine * relative) + most_cosine * color_doubt)
    most = diffuse * most_cosine * (dr.abs(color) + color_doubt)
    if highlight is not None:
        middle, blur = highlight
        turned = (ray.spread + 2 * hit.lean + turn + least_spread(turn)) * blur
        known &= turned < MOST_TURN
        around = turned * (dr.safe_sqrt(1 - dr.square(middle)) + turned) + least_spread(turned)
        low, high = (power(dr.minimum(dr.maximum(x, 0), 1), finish.alpha) for x in (middle - around, middle + around))
        specular = finish.ks * intensity
        doubt += specular * ((high - low) + high * relative)
        most += specular * high
    return dr.select(known, dr.max(doubt), dr.inf), dr.select(known, dr.max(most), dr.inf)


def cutoff_doubt(weight: Any, finish: Finish, cutoff: Any, brightest: Any) -> Any:
    """What the rays that follow may bring that weigh as much as the cut-off, but for roundings."""

    def lost(share: Any) -> Any:
        near = dr.abs(weight * share - cutoff) <= cutoff * WEIGHT_ERROR
        return dr.select((share > 0) & near, weight * share * brightest, 0)

    return lost(finish.kr) + lost(finish.kt)
