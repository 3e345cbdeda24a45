"""How much of a light can come to an object."""

import math

from converter.scene.model import Light, Object, Sphere, Vector
from converter.scene.needs import SceneNeeds

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
    """Bounds of the distance between a point and the points of an object's surface."""
    size = max(map(abs, point))
    if isinstance(o.shape, Sphere):
        apart = math.dist(point, o.shape.center)
        nearest, farthest = abs(apart - o.shape.radius), apart + o.shape.radius
        size += apart
    else:
        excesses = []
        for k in needs.planes[index]:
            a, b, c, d = o.shape.planes[k]
            length = math.hypot(a, b, c)
            excesses.append((a * point[0] + b * point[1] + c * point[2] + d) / length)
            size = max(size, abs(d) / length)
        nearest = abs(max(excesses))
        low, high = needs.boxes[index]
        corner = (max(abs(x - p), abs(y - p)) for p, x, y in zip(point, low, high, strict=True))
        farthest = math.hypot(*corner) if needs.bounded[index] else math.inf
    slack = SLACK * size
    return max(0.0, nearest - slack), farthest + slack
