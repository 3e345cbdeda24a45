"""Numbers of python-flint, and vectors of three of them."""

from collections.abc import Sequence
from fractions import Fraction

from flint import arb, fmpq

Vec = tuple[arb, arb, arb]


def number(value: float | Fraction) -> arb:
    """The decimal number that a file has for `value`."""
    exact = Fraction(repr(value)) if isinstance(value, float) else Fraction(value)
    return arb(fmpq(exact.numerator, exact.denominator))


def numbers(values: Sequence[float]) -> tuple[arb, ...]:
    """Such for each value."""
    return tuple(map(number, values))


def gradient(n: Sequence[arb], p: Vec) -> Vec:
    """Of a quadric's value, at a point."""
    x, y, z = p
    return (
        2 * n[0] * x + n[3] * y + n[4] * z + n[6],
        2 * n[1] * y + n[3] * x + n[5] * z + n[7],
        2 * n[2] * z + n[4] * x + n[5] * y + n[8],
    )


def dot(a: Sequence[arb], b: Sequence[arb]) -> arb:
    """Their inner product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec, b: Vec) -> Vec:
    """Their vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def added(a: Vec, b: Vec) -> Vec:
    """Their sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def difference(a: Sequence[arb], b: Sequence[arb]) -> Vec:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def product(a: Vec, b: Vec) -> Vec:
    """Number by number."""
    return (a[0] * b[0], a[1] * b[1], a[2] * b[2])


def scaled(a: Vec, factor: arb) -> Vec:
    """A multiple."""
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def unit(a: Vec) -> Vec:
    """Of length 1."""
    return scaled(a, 1 / dot(a, a).sqrt())
