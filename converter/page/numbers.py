"""The number under the cursor, what it is, and the range in which a slider moves it."""

import math
from bisect import bisect_left
from dataclasses import dataclass

from converter.scene.entries import FINISH, FOVY
from converter.scene.fields import RGB, Numbers
from converter.scene.names import read_names
from converter.scene.tokens import number, word_spans

STEPS = 100
"""Of a slider from one end to the other, at least."""
MOST_NAMED = 1 << 16
"""Characters of a text whose numbers are named; a larger one is not read whenever the cursor moves."""
_SHARES = frozenset({*RGB, "ka", "kd", "ks", "kr", "kt"})
_LENGTHS = frozenset({"radius", "size", "edge"})


@dataclass(frozen=True, slots=True)
class Slider:
    """A number in a text and how it is moved.

    Attributes:
        start, end: its characters.
        word: how it is written.
        name: what it is, such as `a finish: kr`; empty where the text does not say.
        value, low, high, step: of the slider.
        decimals: to write a value of it with.

    """

    start: int
    end: int
    word: str
    name: str
    value: float
    low: float
    high: float
    step: float
    decimals: int


def number_at(text: str, at: int) -> Slider | None:
    """The number that the character `at` belongs to, or that ends before it; None if there is none."""
    spans = list(word_spans(text))
    k = bisect_left(spans, at, key=lambda span: span[1])
    if k == len(spans) or spans[k][0] > at:
        return None
    start, end = spans[k]
    word = text[start:end]
    value = number(word)
    if not math.isfinite(value):
        return None
    named = read_names(text).get(k) if len(text) <= MOST_NAMED else None
    low, high = _range(value, *named) if named else _around(value)
    step = _step(high - low)
    decimals = max(0, -math.floor(math.log10(step)))
    name = f"{named[0].owner}: {named[1]}" if named else ""
    return Slider(start, end, word, name, value, low, high, step, decimals)


def _range(value: float, numbers: Numbers, field: str) -> tuple[float, float]:
    """From where to where a number of that name is moved, so that the scene stays one."""
    if numbers is FOVY:
        return 1.0, 179.0
    if field in _SHARES:
        return min(0.0, value), max(1.0, value)
    if numbers is FINISH and field == "ior":
        return min(0.1, value), max(3.0, value)
    if numbers is FINISH and field == "alpha":
        return 0.0, max(200.0, 2 * value)
    if field in _LENGTHS and value > 0:
        return value / 100, 2 * value
    return _around(value)


def _around(value: float) -> tuple[float, float]:
    half = max(1.0, abs(value))
    return value - half, value + half


def _step(length: float) -> float:
    """1, 2 or 5 times a power of ten, with at least `STEPS` of them in a length."""
    exact = length / STEPS
    power = 10.0 ** math.floor(math.log10(exact))
    return max(factor * power for factor in (1, 2, 5) if factor * power <= exact * (1 + 1e-9))
