"""A quadric: where A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J <= 0.

Kernels have it about an anchor m, its centre or a point of its axis, as q . Q q + 2 g . q + k with q = p - m: far away
from the scene's origin the ten numbers cancel one another. They are moved there in exact arithmetic, and scaled so that
the largest number of Q is about 1. That makes four rows:

    m, k
    the diagonal of Q, and as its fourth number e2
    Qxy, Qxz, Qyz, and e1
    g, and e0

The quadric may be off by e0 + e1 r + e2 r^2 + |q| . |Q| |q|, in units of the distance from 1 to the next double, where
no coordinate of q is larger than r. The last term is the rounding of q . Q q, which is tiny along a needle's axis.

Sigg, Weyrich, Botsch and Gross, GPU-Based Ray-Casting of Quadratic Surfaces, Symposium on Point-Based Graphics, 2006.
Haines, Gunther and Akenine-Moller, Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems ch. 7, have the
discriminant taken where the ray is nearest.
"""

import math
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import drjit as dr
import numpy as np

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.passages import Passage
from mitsuba_plugins.intersection.rays import Ray, largest
from mitsuba_plugins.intersection.rounding import bounds_all, epsilon, input_error, least_spread, most_of_radius
from mitsuba_plugins.intersection.shapes.kind import Contact, Row, Rows, Shape, SurfacePoint
from native_tracer.incidence import surfaces_at

ROWS = 4
FACETED = False
CONVEX = False

DISTINCT = 2.0**-10
"""An axis along which the surface bends this little, compared with the others, need not have its centre near by."""


# ---- Before tracing --------------------------------------------------------------------------------------------------


def read(entry: dict[str, Any]) -> Shape:
    """`"quadric": [A, ..., J]`, and `"box"` or null."""
    numbers = [float(x) for x in entry["quadric"]]
    # The same rows for a quadric and its complement, but for the signs.
    first = next((x for x in numbers if x != 0), 1.0)
    rows = _rows(numbers) if first > 0 else [*(turned(tuple(_rows([-x for x in numbers]))) or ())]
    return Shape([tuple(numbers)], rows, (None,) * 4, entry.get("box"))


def contacts(point: Any, rows: Any) -> list[Contact]:
    """Where the quadric may be 0 for numbers that round to these, as the decimals of a file do."""
    return [contact for k, row in enumerate(rows) if (contact := _contact(point, row, k)) is not None]


def turned(rows: tuple[Row, ...]) -> tuple[Row, ...] | None:
    """All signs turned, but those of the place and of the errors."""
    (x, y, z, k), *others = rows
    return (x, y, z, -k), *((-a, -b, -c, error) for a, b, c, error in others)


def contains(point: Any, rows: Any) -> bool:
    """By the sign, or on it."""
    q, form = [*map(Fraction, point.tolist())], _form(rows[0].tolist())
    half = form.half_gradient(q)
    value = sum((x * (h + g) for x, h, g in zip(q, half, form.g, strict=True)), form.k)
    return value <= 0 or _contact(point, rows[0], 0) is not None


def slides(move: Any, row: Any) -> bool:
    """A cylinder does along itself, and a plane.

    A moved point's value is another by the gradient's product with the displacement, halfway along it: at all points if
    what multiplies each coordinate, and the rest, is 0.
    """
    a, b, c, d, e, f, g, h, i, _ = row
    factors = [[2 * a, d, e, 0], [d, 2 * b, f, 0], [e, f, 2 * c, 0], [g, h, i, 0]]
    return len(surfaces_at(move, factors, [False] * 4)) == len(factors)


@dataclass(frozen=True)
class _Form:
    """q . Q q + 2 g . q + k in exact arithmetic."""

    matrix: list[list[Fraction]]
    g: list[Fraction]
    k: Fraction

    def half_gradient(self, q: list[Fraction]) -> list[Fraction]:
        return [
            sum((a * x for a, x in zip(row, q, strict=True)), g) for row, g in zip(self.matrix, self.g, strict=True)
        ]

    def about(self, m: list[Fraction]) -> "_Form":
        half = self.half_gradient(m)
        return _Form(self.matrix, half, sum((x * (h + g) for x, h, g in zip(m, half, self.g, strict=True)), self.k))


def _form(numbers: Any) -> _Form:
    """The form about the scene's origin, scaled by a power of two."""
    a, b, c, d, e, f, g, h, i, j = map(Fraction, numbers)
    scale = _scale(numbers)
    matrix = [[a, d / 2, e / 2], [d / 2, b, f / 2], [e / 2, f / 2, c]]
    return _Form([[scale * x for x in row] for row in matrix], [scale * x / 2 for x in (g, h, i)], scale * j)


def _scale(numbers: Any) -> Fraction:
    """A power of two that makes the largest number of Q, or if that is 0 of g, about 1."""
    second, first = (max(map(abs, some)) for some in (numbers[:6], numbers[6:9]))
    _, exponent = math.frexp(second or first)
    return Fraction(2) ** (1 - exponent)


def _rows(numbers: list[float]) -> list[Row]:
    given = _form(numbers)
    m = _anchor(given)
    form = given.about(list(map(Fraction, m)))
    q, g, k = [[*map(_float, row)] for row in form.matrix], [*map(_float, form.g)], _float(form.k)
    # Decimals that were rounded, and what is rounded here and in the kernel.
    errors = [_float(_scale(numbers) * Fraction(input_error(x)) * 2**52) for x in numbers]
    far = max(map(abs, m))
    e2, e1, e0 = sum(errors[:6]), sum(errors[6:9]), errors[9]
    e0 += far * (e1 + far * e2) + abs(k)
    e1 += 2 * far * e2 + 2 * sum(map(abs, g))
    return [
        (*m, k),
        (q[0][0], q[1][1], q[2][2], e2),
        (q[0][1], q[0][2], q[1][2], e1),
        (g[0], g[1], g[2], e0),
    ]


def _float(number: Fraction) -> float:
    """The nearest double, the largest where there is none."""
    try:
        return float(number)
    except OverflowError:
        return sys.float_info.max if number > 0 else -sys.float_info.max


def _anchor(form: _Form) -> tuple[float, float, float]:
    """The centre, or along axes on which there is none, or only far away, the point nearest the scene's origin."""
    matrix = np.array([[*map(_float, row)] for row in form.matrix])
    bends, axes = np.linalg.eigh(matrix)
    m, constant, g = np.zeros(3), _float(form.k), np.array([*map(_float, form.g)])
    for bend, axis in sorted(zip(bends.tolist(), axes.T, strict=True), key=lambda pair: -abs(pair[0])):
        slope = float(axis @ g)
        if abs(bend) <= 1e-15 * np.abs(bends).max():
            continue
        at_center = constant - slope * slope / bend
        if abs(bend) >= DISTINCT * np.abs(bends).max() or abs(at_center) <= abs(constant):
            m -= slope / bend * axis
            constant = at_center
    x, y, z = m.tolist()
    return x, y, z


def _contact(point: Any, numbers: Any, k: int) -> Contact | None:
    x, y, z = p = [*map(Fraction, point.tolist())]
    monomials = (x * x, y * y, z * z, x * y, x * z, y * z, x, y, z, Fraction(1))
    degrees = (2, 2, 2, 2, 2, 2, 1, 1, 1, 0)
    terms = [Fraction(number) * monomial for number, monomial in zip(numbers.tolist(), monomials, strict=True)]
    error = sum((abs(term) * (1 + degree) for term, degree in zip(terms, degrees, strict=True)), Fraction(0)) / 2**53
    form = _form(numbers.tolist())
    half = form.half_gradient(p)
    steepest = max(abs(h) for h in half)
    if abs(sum(terms, Fraction(0))) > error or steepest == 0:
        return None
    normal = np.array([float(h / steepest) for h in half])
    length = float(np.linalg.norm(normal))
    x, y, z = (normal / length).tolist()
    turn = np.array(form.matrix, dtype=np.float64) / (float(steepest) * length)
    rows = [(x, y, z) for x, y, z in turn.tolist()]
    return Contact(k, (x, y, z), float(np.linalg.norm(turn)), (rows[0], rows[1], rows[2]))


# ---- In a kernel -----------------------------------------------------------------------------------------------------


class _Quadric:
    """A quadric's rows."""

    def __init__(self, rows: Rows, ray: Ray) -> None:
        first, diagonal, mixed, linear = (rows.row(k) for k in range(4))
        vector = type(ray.d)
        self.anchor = type(ray.o)(first.xyz)
        self.k = first.w
        self.diagonal, self.mixed = vector(diagonal.xyz), vector(mixed.xyz)
        self.g = vector(linear.xyz)
        self.errors = diagonal.w, mixed.w, linear.w

    def times(self, v: Any) -> Any:
        """Q v."""
        xy, xz, yz = self.mixed
        return type(v)(
            self.diagonal.x * v.x + xy * v.y + xz * v.z,
            xy * v.x + self.diagonal.y * v.y + yz * v.z,
            xz * v.x + yz * v.y + self.diagonal.z * v.z,
        )

    def value(self, q: Any, half_gradient: Any) -> Any:
        """What is negative inside, at a point seen from the anchor."""
        return dr.dot(q, half_gradient + self.g) + self.k

    def error(self, q: Any) -> Any:
        """How far that may be off."""
        e2, e1, e0 = self.errors
        reach, v = largest(q), dr.abs(q)
        xy, xz, yz = dr.abs(self.mixed)
        rounding = dr.dot(dr.abs(self.diagonal), v * v) + 2 * (xy * v.x * v.y + xz * v.x * v.z + yz * v.y * v.z)
        return epsilon(reach) * (e0 + reach * (e1 + reach * e2) + rounding)

    def bend(self) -> Any:
        """A bound of the length of Q v for unit vectors v."""
        return dr.sqrt(dr.squared_norm(self.diagonal) + 2 * dr.squared_norm(self.mixed))


@dataclass
class _Line:
    """A quadric along a ray, a s^2 + 2 b s + c from a point `middle` on, near which the ray is nearest to it."""

    turn: Any  # Vector3, Q d
    a: Any  # Float
    b: Any
    c: Any
    middle: Any  # Float, the distance at which s is 0
    q: Any  # Vector3, the point there, from the anchor
    half_gradient: Any  # Vector3, there
    start: Any  # Vector3, the ray's origin from the anchor
    start_b: Any  # Float, b there

    @property
    def discriminant(self) -> Any:
        return dr.square(self.b) - self.a * self.c

    def other_root(self) -> Any:
        """Where the ray crosses the quadric if it starts on it, besides there: infinite or NaN if it does not."""
        return quotient(-2 * self.start_b, self.a)

    def roots(self, discriminant: Any) -> tuple[Any, Any]:
        """The distances of both, the nearer first; NaN where it misses."""
        root = dr.sqrt(discriminant)
        sum_of_both = -(self.b + dr.copysign(root, self.b))
        one = self.middle + quotient(sum_of_both, self.a)  # infinite of an equation of first degree
        other = self.middle + quotient(self.c, sum_of_both)
        return dr.minimum(one, other), dr.maximum(one, other)

    def inside_before(self) -> Any:
        """Whether the ray comes from inside."""
        constant = (self.a == 0) & (self.b == 0)
        return (self.a < 0) | (constant & (self.c <= 0))


def _line(quadric: _Quadric, ray: Ray) -> _Line:
    vector = type(ray.d)
    start = vector(ray.o - quadric.anchor)
    turn = quadric.times(ray.d)
    a = dr.dot(ray.d, turn)
    a = dr.select(a == 0, 0, a)  # not -0, by which the infinite root would change sides
    start_b = dr.dot(start, turn) + dr.dot(ray.d, quadric.g)
    # Where the quadric along the ray is stationary, if that is not far away, as for a ray that is nearly parallel to a
    # cone's side; else where the ray is nearest to the anchor.
    stationary = -quotient(start_b, a)
    middle = dr.select(dr.abs(stationary) <= 16 * largest(start), stationary, -dr.dot(start, ray.d))
    q = vector(start + middle * ray.d)
    half_gradient = quadric.times(q) + quadric.g
    b = dr.dot(ray.d, half_gradient)
    return _Line(turn, a, b, quadric.value(q, half_gradient), middle, q, half_gradient, start, start_b)


def _most_touching(quadric: _Quadric, line: _Line, reach: Any) -> Any:
    """The discriminant of rays that are near to touching; the gradient is 0 at a cone's tip, and small near by."""
    near_tip = dr.square(least_spread(reach) * quadric.bend() * (reach + dr.abs(line.middle)))
    return most_of_radius(reach) * dr.squared_norm(line.half_gradient) + near_tip


def passage(rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
    """Both roots; those that nearly touch are close to a tie."""
    quadric = _Quadric(rows, ray)
    line = _line(quadric, ray)
    discriminant = line.discriminant
    near, far = line.roots(discriminant)
    if bounds_all(discriminant):
        return _doubtful_passage(rows, quadric, line, ray, own, near, far)
    return Passage(
        near=near,
        far=dr.select(own, line.other_root(), far),
        near_primitive=rows.primitive(),
        far_primitive=rows.primitive(),
        inside_before=line.inside_before(),
        close=(dr.abs(discriminant) <= _most_touching(quadric, line, reach)) & ~own,
    )


def _doubtful_passage(rows: Rows, quadric: _Quadric, line: _Line, ray: Ray, own: Any, near: Any, far: Any) -> Passage:
    """The same with bounds: a tie is what is within these."""
    bend, number = quadric.bend(), epsilon(ray.t_min)
    at_start = ray.t_min + 2 * number * largest(quadric.anchor)
    start_error = at_start * 2 * dr.norm(quadric.times(line.start) + quadric.g)

    def value_error(q: Any, half_gradient: Any, t: Any) -> Any:
        """How far the quadric's value may be off at a distance."""
        off = at_start + dr.abs(t) * ray.spread
        slope = dr.norm(half_gradient) + 4 * number * (bend * dr.norm(q) + dr.norm(quadric.g))
        return off * (2 * slope + bend * off) + 4 * quadric.error(q)

    def distance_error(_: Any, t: Any) -> Any:
        along = t - line.middle
        half_gradient = line.half_gradient + along * line.turn
        slope = 2 * dr.abs(dr.dot(half_gradient, ray.d))
        error = value_error(line.q + along * ray.d, half_gradient, t) + dr.select(own, start_error, 0)
        # As large that the quadric is away from 0 by more than the error at both ends, also where it bends.
        known = 8 * dr.abs(line.a) * error < dr.square(slope)
        return dr.select(dr.isfinite(t), dr.select(known, quotient(4 * error, slope), dr.inf), 0)

    a_error = 2 * bend * (ray.spread + 2 * number)
    b_error = ray.spread * dr.norm(line.half_gradient) + bend * (at_start + dr.abs(line.middle) * ray.spread)
    b_error += 4 * number * (bend * dr.norm(line.q) + dr.norm(quadric.g))
    c_error = value_error(line.q, line.half_gradient, line.middle)
    touching = (
        (dr.abs(line.a) + a_error) * c_error + dr.abs(line.c) * a_error + b_error * (2 * dr.abs(line.b) + b_error)
    )
    return Passage(
        near=near,
        far=dr.select(own, line.other_root(), far),
        near_primitive=rows.primitive(),
        far_primitive=rows.primitive(),
        inside_before=line.inside_before(),
        close=(~own & ~(dr.abs(line.discriminant) > 2 * touching)) | ~(dr.abs(line.a) > a_error),
        error=distance_error,
    )


def passage_by_rules(rows: Rows, ray: Ray, own: Any, reach: Any) -> Passage:
    """A ray that only touches the quadric passes by, as one through the tip of a cone."""
    quadric = _Quadric(rows, ray)
    line = _line(quadric, ray)
    off = ray.t_min + dr.abs(line.middle) * ray.spread
    steepest = 2 * dr.norm(line.half_gradient) + quadric.bend() * off
    touching = dr.abs(line.a) * (off * steepest + quadric.error(line.q))
    touching = dr.minimum(touching, _most_touching(quadric, line, reach))
    discriminant = dr.select(line.discriminant > touching, line.discriminant, dr.nan)
    near, far = line.roots(discriminant)

    # A ray that starts on the quadric by its origin's roundings, and not by knowledge, does not meet it there. That
    # crossing lies behind, and so do both where it leads away from the other.
    start_gradient = quadric.times(line.start) + quadric.g
    start_slope = 2 * dr.norm(start_gradient)
    start_off = quadric.error(line.start) + ray.t_min * start_slope
    starts = ~own & (dr.abs(quadric.value(line.start, start_gradient)) <= start_off)
    starts &= start_off * quadric.bend() <= most_of_radius(off) * dr.square(start_slope)
    other = line.other_root()
    near = dr.select(starts, -dr.inf, near)
    far = dr.select(own, other, dr.select(starts, dr.select(far > ray.t_min, other, -dr.inf), far))

    def distance_error(_: Any, t: Any) -> Any:
        along = t - line.middle
        q = line.q + along * ray.d
        half_gradient = line.half_gradient + along * line.turn
        off = (ray.t_min + dr.abs(t) * ray.spread) * dr.norm(half_gradient) + 0.5 * quadric.error(q)
        return quotient(off, dr.abs(dr.dot(half_gradient, ray.d)))

    return Passage(
        near=near,
        far=far,
        near_primitive=rows.primitive(),
        far_primitive=rows.primitive(),
        inside_before=line.inside_before(),
        error=distance_error,
    )


def surface_at(rows: Rows, p: Any, ray: Ray, own: Any, reach: Any) -> SurfacePoint:
    """Along the gradient, by a step of Newton's method; at the tip of a cone, which has no normal, against the ray."""
    quadric = _Quadric(rows, ray)
    vector = type(ray.d)
    q = vector(p - quadric.anchor)
    half_gradient = quadric.times(q) + quadric.g
    steepness = 2 * dr.squared_norm(half_gradient)
    step = quotient(quadric.value(q, half_gradient), steepness)
    q = vector(q - dr.select(steepness > 0, step, 0) * half_gradient)
    half_gradient = quadric.times(q) + quadric.g
    slope = dr.norm(half_gradient)
    n = vector(dr.select(slope == 0, dr.select(own & ray.inside, ray.d, -ray.d), half_gradient * quotient(1, slope)))
    error = quotient(0.5 * quadric.error(q), slope)
    if bounds_all(error):
        bend = quadric.bend()
        error *= 4
        error += 4 * epsilon(error) * (largest(quadric.anchor) + dr.norm(q) + quotient(dr.norm(quadric.g), bend))
        error += quotient(dr.square(step) * dr.squared_norm(half_gradient) * bend, slope)
    return SurfacePoint(type(p)(quadric.anchor + q), n, error, quotient(slope, quadric.bend()))
