"""Numbers whose signs are certain, in two kinds: fractions, and decimals of 200 digits.

Fractions prove: they have no rounding at all, but no roots either. Decimals take roots, so that they follow rays off
spheres and through glass. A number in them that should be 0 is smaller than 1e-110, for what leads to it is below 1e60;
one that is not 0, made of a scene's few digits by some products and roots, is far larger than 1e-75. What lies between
is nothing that either explains, and ends the computation.
"""

from contextlib import AbstractContextManager, nullcontext
from decimal import Context, Decimal, localcontext
from fractions import Fraction
from math import isqrt
from typing import Any, Protocol

Number = Any
"""A Fraction or a Decimal; in one computation all are of one kind."""


class Undecided(ArithmeticError):  # noqa: N818 - what it says
    """A number's sign, or its root, is not known."""


class Arithmetic(Protocol):
    """What a tracer has to know of a kind of numbers, besides + - * and /."""

    def context(self) -> AbstractContextManager[Any]:
        """In which its numbers are computed."""
        ...

    def number(self, value: float) -> Number:
        """The decimal number that a file has for `value`: 0.3 is 3/10, and not the double next to it."""
        ...

    def sign(self, x: Number) -> int:
        """-1, 0 or 1."""
        ...

    def root(self, x: Number) -> Number:
        """The square root of what is not negative."""
        ...

    def nearest_whole(self, x: Number) -> int:
        """The whole number nearest to x."""
        ...

    def tangent(self, degrees: Number) -> Number:
        """Of half an angle between 0 and 180 degrees."""
        ...


class Fractions:
    """Rational numbers."""

    def context(self) -> AbstractContextManager[Any]:
        """None is needed."""
        return nullcontext()

    def number(self, value: float) -> Fraction:
        """The decimal number that is written `value`."""
        return Fraction(repr(value))

    def sign(self, x: Fraction) -> int:
        """-1, 0 or 1."""
        return (x > 0) - (x < 0)

    def root(self, x: Fraction) -> Fraction:
        """The square root.

        Raises:
            Undecided: it is irrational.

        """
        result = Fraction(isqrt(x.numerator), isqrt(x.denominator))
        if result * result != x:
            raise Undecided(f"the square root of {x} is irrational")
        return result

    def nearest_whole(self, x: Fraction) -> int:
        """The whole number nearest to x."""
        return round(x)

    def tangent(self, degrees: Fraction) -> Fraction:
        """Of 45 degrees, which is 1.

        Raises:
            Undecided: of other angles; it is irrational.

        """
        if degrees != 90:
            raise Undecided(f"the tangent of half of {degrees} degrees is irrational")
        return Fraction(1)


class Decimals:
    """Decimals of 200 digits, for scenes whose numbers lie between 1e-15 and 1e15."""

    _ZERO, _CERTAIN = Decimal("1e-110"), Decimal("1e-75")

    def context(self) -> AbstractContextManager[Any]:
        """In which 200 digits are kept."""
        return localcontext(Context(prec=200))

    def number(self, value: float) -> Decimal:
        """The decimal number that is written `value`."""
        return Decimal(repr(value))

    def sign(self, x: Decimal) -> int:
        """-1, 0 or 1.

        Raises:
            Undecided: x is neither 0 nor far from it.

        """
        size = abs(x)
        if size < self._ZERO:
            return 0
        if size < self._CERTAIN:
            raise Undecided(f"{x:.3e} is neither 0 nor far from it")
        return 1 if x > 0 else -1

    def root(self, x: Decimal) -> Decimal:
        """The square root."""
        return x.sqrt()

    def nearest_whole(self, x: Decimal) -> int:
        """The whole number nearest to x."""
        return int(x.to_integral_value())

    def tangent(self, degrees: Decimal) -> Decimal:
        """Of half an angle."""
        return _tangent_of_degrees(degrees / 2)


def _tangent_of_degrees(degrees: Decimal) -> Decimal:
    """By the series of sine and cosine, at an angle halved until they converge at once."""
    x = degrees * _pi() / 180 / 1024
    sine = term = x
    cosine = even = Decimal(1)
    k = 1
    while abs(term) > Decimal("1e-230"):
        even *= -x * x / ((2 * k - 1) * (2 * k))
        term *= -x * x / ((2 * k) * (2 * k + 1))
        cosine, sine, k = cosine + even, sine + term, k + 1
    for _ in range(10):
        sine, cosine = 2 * sine * cosine, cosine * cosine - sine * sine
    return sine / cosine


def _pi() -> Decimal:
    """Machin's formula, pi = 16 arctan(1/5) - 4 arctan(1/239)."""

    def arctangent_of_one_over(n: int) -> Decimal:
        power = total = Decimal(1) / n
        k = 1
        while power > Decimal("1e-230"):
            power /= n * n
            total += (-1) ** k * power / (2 * k + 1)
            k += 1
        return total

    return 16 * arctangent_of_one_over(5) - 4 * arctangent_of_one_over(239)
