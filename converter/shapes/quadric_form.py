"""What a quadric is, without rounding: its kind, its box, and the simpler shape that it may be.

A quadric is f(p) = p M p + 2 h p + j, inside where f <= 0, and its 4x4 matrix is ((M, h), (h, j)). How many eigenvalues
of both are positive and how many negative tells all kinds apart, whatever the place, the size and the factor
(Sylvester's law of inertia). The numbers are taken as the decimals that a file has for them: (0.3 x + 0.1 y)^2 is a
square there, and is none in doubles. Where the doubles have fewer eigenvalues, as a program's may, they are taken.
"""

import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import lru_cache
from operator import add, mul
from typing import NamedTuple

from converter.scene.model import Polyhedron, Quadric, Shape, Sphere, Vector

Rows = Sequence[Sequence[Fraction]]
Signs = tuple[int, int]
"""How many eigenvalues of a matrix are positive, and how many negative."""

KINDS: dict[tuple[Signs, Signs], str] = {
    ((3, 0), (3, 1)): "ellipsoid",
    ((2, 1), (2, 2)): "hyperboloid of one sheet",
    ((2, 1), (3, 1)): "hyperboloid of two sheets",
    ((2, 1), (2, 1)): "cone",
    ((2, 0), (3, 1)): "elliptic paraboloid",
    ((1, 1), (2, 2)): "hyperbolic paraboloid",
    ((2, 0), (2, 1)): "elliptic cylinder",
    ((1, 1), (2, 1)): "hyperbolic cylinder",
    ((1, 0), (2, 1)): "parabolic cylinder",
    ((1, 1), (1, 1)): "crossing planes",
    ((1, 0), (1, 1)): "parallel planes",
    ((0, 0), (1, 1)): "half-space",
}
"""By the signs of M and of the 4x4 matrix; the complement of each has them the other way round."""
EMPTY: dict[tuple[Signs, Signs], str] = {
    ((3, 0), (3, 0)): "only a point is inside, which has no volume",
    ((2, 0), (2, 0)): "only a line is inside, which has no volume",
    ((1, 0), (1, 0)): "only a plane is inside, which has no volume",
}


class Kind(NamedTuple):
    """What a quadric is.

    Attributes:
        name: "cone", or "complement of a cone"; empty where there is no surface.
        flaw: why there is none, as the end of a sentence.
        matrix, whole: the signs of the 3x3 and of the 4x4 matrix.
        form: the numbers of which that is true.

    """

    name: str
    flaw: str
    matrix: Signs
    whole: Signs
    form: "Form"


class Form(NamedTuple):
    """The numbers of f(p) = p M p + 2 h p + j."""

    matrix: Rows
    half_slope: Sequence[Fraction]
    constant: Fraction

    def at(self, p: Sequence[Fraction]) -> Fraction:
        """The value of f."""
        return _dot(p, map(add, self.half_gradient(p), self.half_slope)) + self.constant

    def half_gradient(self, p: Sequence[Fraction]) -> list[Fraction]:
        """M p + h."""
        return [_dot(row, p) + h for row, h in zip(self.matrix, self.half_slope, strict=True)]


@lru_cache(maxsize=4096)
def decimal_form(shape: Quadric) -> Form:
    """With the decimals that a file has for the numbers."""
    return _form([Fraction(repr(x)) for x in shape.coefficients])


@lru_cache(maxsize=4096)
def binary_form(shape: Quadric) -> Form:
    """With the doubles that renderers compute with."""
    return _form([Fraction(x) for x in shape.coefficients])


def _form(numbers: Sequence[Fraction]) -> Form:
    a, b, c, d, e, f, g, h, i, j = numbers
    return Form(((a, d / 2, e / 2), (d / 2, b, f / 2), (e / 2, f / 2, c)), (g / 2, h / 2, i / 2), j)


@lru_cache(maxsize=4096)
def kind_of(shape: Quadric) -> Kind:
    """What it is."""
    if not all(map(math.isfinite, shape.coefficients)):
        return Kind("", "its numbers are not finite", (0, 0), (0, 0), _form([Fraction(0)] * 10))
    return min(
        (_kind(form(shape)) for form in (decimal_form, binary_form)), key=lambda kind: sum(kind.matrix + kind.whole)
    )


def _kind(form: Form) -> Kind:
    matrix = _signs(form.matrix)
    rows = [[*row, h] for row, h in zip(form.matrix, form.half_slope, strict=True)]
    whole = _signs([*rows, [*form.half_slope, form.constant]])
    if name := KINDS.get((matrix, whole)):
        return Kind(name, "", matrix, whole, form)
    if name := KINDS.get((matrix[::-1], whole[::-1])):
        article = "an" if name[0] == "e" else "" if name.endswith("planes") else "a"
        return Kind(" ".join(filter(None, ("complement of", article, name))), "", matrix, whole, form)
    positive, negative = whole
    flaw = EMPTY.get((matrix, whole)) or ("no point is inside" if positive > negative else "every point is inside")
    return Kind("", flaw, matrix, whole, form)


def _signs(matrix: Rows) -> Signs:
    """Of the eigenvalues of a symmetric matrix, by completing squares one after the other."""
    rows = [list(row) for row in matrix]
    positive = negative = 0
    while rows:
        every = range(len(rows))
        k = next((k for k in every if rows[k][k]), None)
        if k is None:
            pair = next(((i, j) for i in every for j in every if rows[i][j]), None)
            if pair is None:
                break
            k, j = pair  # with x_j + x_k in place of x_j, the product 2 x_j x_k has a square
            rows[k] = [a + b for a, b in zip(rows[k], rows[j], strict=True)]
            for row in rows:
                row[k] += row[j]
        pivot = rows[k]
        positive, negative = (positive + 1, negative) if pivot[k] > 0 else (positive, negative + 1)
        rows = [[rows[i][j] - rows[i][k] * pivot[j] / pivot[k] for j in every if j != k] for i in every if i != k]
    return positive, negative


# ---- The simplest shape that it is -----------------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def simplest(shape: Quadric) -> Shape:
    """A ball, a half-space, or the intersection of two, where it is one of them; else itself."""
    kind = kind_of(shape)
    match kind.name:
        case "ellipsoid":
            return _ball(kind.form) or shape
        case "parallel planes":
            return _slab(kind.form) or shape
        case "half-space":
            a, b, c, d = shape.coefficients[6:]
            return Polyhedron(((a, b, c, d),))
    return shape


def _ball(form: Form) -> Sphere | None:
    """Where the axes are equally long, and doubles hold the numbers."""
    square = form.matrix[0][0]
    if any(form.matrix[i][j] != (square if i == j else 0) for i in range(3) for j in range(3)):
        return None
    center = [-h / square for h in form.half_slope]
    radius = nearest(root_above(_dot(center, center) - form.constant / square))
    x, y, z = map(nearest, center)
    return Sphere((x, y, z), radius) if radius > 0 and all(map(math.isfinite, (x, y, z, radius))) else None


def _slab(form: Form) -> Polyhedron | None:
    """What is between two planes n p = s: M is m n n, h is b n, and f is m s^2 + 2 b s + j."""
    k = max(range(3), key=lambda k: form.matrix[k][k])
    square = form.matrix[k][k]
    n = [x / square for x in form.matrix[k]]
    middle = -form.half_slope[k] / square
    half = root_above(middle * middle - form.constant / square)
    a, b, c = map(nearest, n)
    low, high = nearest(middle - half), nearest(middle + half)
    if not (low < high and math.isfinite(low) and math.isfinite(high)):
        return None
    return Polyhedron(((a, b, c, -high), (0.0 - a, 0.0 - b, 0.0 - c, low)))


def moved(shape: Quadric, way: Sequence[Fraction], factor: Fraction = Fraction(1)) -> Quadric:
    """The same elsewhere, f(p - way), and then that many times as large."""
    form = decimal_form(shape)
    back = [-w for w in way]
    g, h, i = (nearest(2 * factor * x) for x in form.half_gradient(back))
    a, b, c, d, e, f = shape.coefficients[:6]
    return Quadric((a, b, c, d, e, f, g, h, i, nearest(factor * factor * form.at(back))))


# ---- Numbers ---------------------------------------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def surface_box(shape: Quadric) -> tuple[Vector, Vector] | None:
    """The smallest box of doubles around the surface; None where it has no bounds.

    An ellipsoid about c with f(c) = -k reaches sqrt(k (M^-1)_ii) along axis i.
    """
    if kind_of(shape).matrix not in ((3, 0), (0, 3)):
        return None
    form = binary_form(shape)
    inverse = _inverse(form.matrix)
    if inverse is None or _signs(form.matrix) != kind_of(shape).matrix:
        return None
    center = [-_dot(row, form.half_slope) for row in inverse]
    depth = -form.at(center)
    squares = [depth * inverse[i][i] for i in range(3)]
    if min(squares) < 0:  # of doubles, it is nothing
        return None
    (a, b, c), (d, e, f) = (
        [rounded(x) for x in ends]
        for rounded, ends in (
            (_below, [x - root_above(s) for x, s in zip(center, squares, strict=True)]),
            (_above, [x + root_above(s) for x, s in zip(center, squares, strict=True)]),
        )
    )
    return ((a, b, c), (d, e, f)) if all(map(math.isfinite, (a, b, c, d, e, f))) else None


def nearest(x: Fraction) -> float:
    """The double nearest to a number; infinite where there is none."""
    try:
        return float(x)
    except OverflowError:
        return math.inf if x > 0 else -math.inf


def root_above(x: Fraction) -> Fraction:
    """The square root, if it is rational; else a number that is larger by a 2^100th of it at most."""
    if x <= 0:
        return Fraction(0)
    square = x.numerator * x.denominator
    shift = max(0, 104 - square.bit_length() // 2)
    root = math.isqrt(square << 2 * shift)
    return Fraction(root + (root * root != square << 2 * shift), x.denominator << shift)


def _below(x: Fraction) -> float:
    """The largest double that is not above x, or the least one of all."""
    value = nearest(x)
    if math.isinf(value):
        return value if value < 0 else _MOST
    return value if Fraction(value) <= x else math.nextafter(value, -math.inf)


def _above(x: Fraction) -> float:
    return -_below(-x)


_MOST = math.nextafter(math.inf, 0)


def _inverse(matrix: Rows) -> Rows | None:
    (a, b, c), (_, e, f), (*_, i) = matrix
    cofactors = (
        (e * i - f * f, c * f - b * i, b * f - c * e),
        (c * f - b * i, a * i - c * c, b * c - a * f),
        (b * f - c * e, b * c - a * f, a * e - b * b),
    )
    determinant = _dot(matrix[0], cofactors[0])
    return [[x / determinant for x in row] for row in cofactors] if determinant else None


def _dot(p: Sequence[Fraction], q: Iterable[Fraction]) -> Fraction:
    return sum(map(mul, p, q), Fraction(0))
