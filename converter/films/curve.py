"""Numbers that change with time, through keyframes."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

Easing = Literal["linear", "smooth", "catmull-rom"]
EASINGS: tuple[Easing, ...] = get_args(Easing)
Value = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Key:
    """That something has a value at a time, in seconds, and how it goes on from there."""

    time: float
    value: Value
    easing: Easing = "linear"


def value_at(keys: Sequence[Key], time: float, loop: bool = False) -> Value:
    """The value at a time, which at a key's own is the key's: before the first key that of the first, after the last
    that of the last, or, in a loop, what it was a turn before.

    `smooth` stands still at both ends of a piece: the cubic 3 u^2 - 2 u^3. `catmull-rom` passes through the keys with
    the velocity of the chord between their neighbours, at the ends of what is no loop with that of the first and of
    the last chord: Catmull and Rom, A class of local interpolating splines, 1974, with times that need not be even.

    Args:
        keys: with times that grow.
        time: in seconds.
        loop: whether the last key is the first again.

    """
    first, last = keys[0].time, keys[-1].time
    if loop and last > first:
        time = first + (time - first) % (last - first)
    k = bisect_right(keys, time, key=lambda key: key.time) - 1
    if k < 0:
        return keys[0].value
    begin = keys[k]
    if k + 1 == len(keys) or time == begin.time:
        return begin.value
    end = keys[k + 1]
    span = end.time - begin.time
    u = (time - begin.time) / span
    if begin.easing == "catmull-rom":
        velocities = (_velocity(keys, k, loop), _velocity(keys, k + 1, loop))
        return tuple(_hermite(u, *four) for four in _in_turn(begin.value, end.value, span, velocities))
    share = u * u * (3 - 2 * u) if begin.easing == "smooth" else u
    return tuple(a + (b - a) * share for a, b in zip(begin.value, end.value, strict=True))


def _velocity(keys: Sequence[Key], k: int, loop: bool) -> Value:
    """Change per second at a key."""
    last = len(keys) - 1
    before, after = keys[max(k - 1, 0)], keys[min(k + 1, last)]
    span = after.time - before.time
    if loop and k in (0, last):
        before, after = keys[last - 1], keys[1]
        span = keys[last].time - before.time + after.time - keys[0].time
    return tuple((b - a) / span for a, b in zip(before.value, after.value, strict=True))


def _in_turn(
    begin: Value, end: Value, span: float, velocities: tuple[Value, Value]
) -> list[tuple[float, float, float, float]]:
    leaving, arriving = velocities
    return [(a, b, span * m, span * n) for a, b, m, n in zip(begin, end, leaving, arriving, strict=True)]


def _hermite(u: float, begin: float, end: float, leaving: float, arriving: float) -> float:
    """The cubic with these values and slopes at 0 and 1."""
    v = 1 - u
    return v * v * ((1 + 2 * u) * begin + u * leaving) + u * u * ((3 - 2 * u) * end - v * arriving)
