"""Vectors of certain numbers, three each."""

import math
from collections.abc import Sequence

from converter.studies.exact.arithmetic import Number

Vec = tuple[Number, Number, Number]


def dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vec, b: Vec) -> Vec:
    """The vector product."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def add(a: Vec, b: Vec) -> Vec:
    """The sum."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a: Vec, b: Vec) -> Vec:
    """The difference."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(a: Vec, factor: Number) -> Vec:
    """A vector that is `factor` times as long."""
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def unit(a: Vec) -> Vec:
    """The vector of length 1, in floating point."""
    x, y, z = map(float, a)
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length)
