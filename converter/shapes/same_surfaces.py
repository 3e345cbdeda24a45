"""Surfaces that are one surface, written differently: their numbers differ by a factor, and by roundings."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import copysign, hypot

from converter.scene.model import Plane, Quadric, Sphere

_EPSILON = 2.0**-52
_SAME = 4 * _EPSILON
"""How much numbers of one surface may differ, relative to a plane's normal or its offset, or to themselves: some
roundings."""
_PROBE = (0.5377, 0.7393, 0.4057, 0.3119)
"""Planes that are the same, or face each other, have the same product with it but for its sign; few others have."""


def same_planes(planes: Sequence[Plane]) -> dict[int, Plane]:
    """What to write, by its index, for each plane that is an earlier one but for a factor and roundings: that one, or,
    if it faces the other way, its negative. Those that are written so already are left out.
    """
    changed: dict[int, Plane] = {}
    for cluster in _clusters(planes):
        heads: list[Plane] = []
        for k in sorted(cluster):
            shared = next((same for head in heads if (same := _as_written(planes[k], head)) is not None), None)
            if shared is None:
                heads.append(planes[k])
            elif shared != planes[k]:
                changed[k] = shared
    return changed


def _clusters(planes: Sequence[Plane]) -> Iterator[list[int]]:
    """Planes that may be the same, two or more at a time."""
    a, b, c, d = _PROBE
    probed = sorted(
        (abs(a * p[0] + b * p[1] + c * p[2] + d * p[3]) / hypot(p[0], p[1], p[2]), k) for k, p in enumerate(planes)
    )
    cluster: list[int] = []
    for (before, k), (after, next_k) in pairwise(probed):
        if after - before <= 16 * _SAME * (1 + after):
            cluster = cluster or [k]
            cluster.append(next_k)
        elif cluster:
            yield cluster
            cluster = []
    if cluster:
        yield cluster


def _as_written(plane: Plane, head: Plane) -> Plane | None:
    """`head`, or what faces it, if `plane` is the same; else None."""
    length, head_length = hypot(*plane[:3]), hypot(*head[:3])
    normal = [n / length for n in plane[:3]]
    head_normal = [n / head_length for n in head[:3]]
    offset, head_offset = plane[3] / length, head[3] / head_length
    sign = 1.0 if sum(m * n for m, n in zip(normal, head_normal, strict=True)) > 0 else -1.0
    if any(abs(m - sign * n) > _SAME for m, n in zip(normal, head_normal, strict=True)):
        return None
    if abs(offset - sign * head_offset) > _SAME * abs(head_offset):
        return None
    x, y, z, w = (sign * number for number in head)
    return (x, y, z, w)


def same_ball(ball: Sphere, head: Sphere) -> bool:
    """Whether a ball is another one but for roundings."""
    return _near((*ball.center, ball.radius), (*head.center, head.radius))


def same_quadric(quadric: Quadric, head: Quadric) -> Quadric | None:
    """`head`, or its complement, if a quadric is that but for a positive factor and roundings; else None."""
    numbers, model = quadric.coefficients, head.coefficients
    largest = max(range(len(model)), key=lambda k: abs(model[k]))
    factor = numbers[largest] / model[largest]
    if factor == 0 or not _near(numbers, [factor * x for x in model]):
        return None
    if factor > 0:
        return head
    a, b, c, d, e, f, g, h, i, j = (0.0 - x for x in model)
    return Quadric((a, b, c, d, e, f, g, h, i, j))


def sign_of(numbers: Sequence[float]) -> float:
    """1 or -1, by which to multiply the numbers of a surface for them not to depend on which side of it is inside."""
    return copysign(1.0, next(x for x in numbers if x))


def _near(numbers: Sequence[float], model: Sequence[float]) -> bool:
    return all(abs(x - y) <= _SAME * abs(y) for x, y in zip(numbers, model, strict=True))
