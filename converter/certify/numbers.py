"""The numbers of a file as the tracer of intervals takes them: 0.3 is 3/10, and not the double next to it."""

import math
from collections.abc import Iterable
from fractions import Fraction

Number = tuple[list[float], float]
"""Doubles that add up to a number, and how far it may be off."""

MOST_PARTS = 9
"""Doubles of a number, some 470 binary digits; what is left becomes its error."""


def exact(value: float) -> Fraction:
    """The decimal number that a file has for `value`: the shortest one whose double it is."""
    return Fraction(int(value)) if value == int(value) else Fraction(repr(float(value)))


def number(value: float, ulps: float = 0.0) -> Number:
    """The decimal number that a file has for `value`; unless it is whole, known to so many units in the last place of
    that double.
    """
    if value == int(value):
        return [value], 0.0
    parts, error = _parts(exact(value))
    return parts, error if ulps == 0 else math.nextafter(error + ulps * math.ulp(value), math.inf)


def numbers(values: Iterable[float], ulps: float = 0.0) -> list[Number]:
    """Such for each value."""
    return [number(value, ulps) for value in values]


def _parts(value: Fraction) -> Number:
    parts = [float(value)]
    rest = value - Fraction(parts[0])
    while rest and len(parts) < MOST_PARTS and abs(float(rest)) > 1e-290:
        parts.append(float(rest))
        rest -= Fraction(parts[-1])
    return parts, math.nextafter(abs(float(rest)), math.inf) if rest else 0.0
