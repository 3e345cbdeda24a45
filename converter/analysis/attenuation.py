"""How much of a light can come to an object."""

import math

from converter.scene.model import Light, Object, Vector
from converter.scene.needs import SceneNeeds
from converter.shapes.table import shape_kind

SLACK = 2.0**-40
"""Part of a distance that its rounding, and a hit point's, may amount to."""


def least_divisor(light: Light, o: Object, needs: SceneNeeds, index: int) -> float:
    """The smallest |a + b d + c d^2| at the distances that an object's surface has from a light; 0 if one is a root."""
    a, b, c = light.attenuation
    if b == c == 0:
        return abs(a)
    nearest, farthest = _distances(light.position, o, needs, index)
    values = [a + nearest * (b + nearest * c)]
    if math.isfinite(farthest):
        values.append(a + farthest * (b + farthest * c))
    else:
        values.append(math.copysign(math.inf, c or b))
    if c and nearest < -b / (2 * c) < farthest:
        values.append(a - b * b / (4 * c))
    if all(value > 0 for value in values) or all(value < 0 for value in values):
        return min(map(abs, values))
    return 0.0


def _distances(point: Vector, o: Object, needs: SceneNeeds, index: int) -> tuple[float, float]:
    """Bounds of the distance between a point and the points of an object's surface, wherever that is."""
    found = shape_kind(o.shape).distances(o.shape, needs.facts[index], point)
    way = math.hypot(*o.move)
    slack = SLACK * (found.largest + way) + way
    return max(0.0, found.nearest - slack), found.farthest + slack
