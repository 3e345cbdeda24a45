"""What a quadric is, exactly: its kind, its box, and the simpler shape that it may be."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quadrics import FLAWS, SURFACES, quadric, substituted

from converter.scene.model import Polyhedron, Sphere
from converter.shapes.quadric import NAME, facts, scaled, simplified
from converter.shapes.quadric_form import kind_of, moved, root_above, surface_box
from converter.shapes.table import SHAPE_KINDS

whole = st.integers(-9, 9)
matrices = st.tuples(*[st.tuples(whole, whole, whole)] * 3).filter(
    lambda m: (
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    )
)
shifts = st.tuples(*[st.integers(-(10**5), 10**5)] * 3)
factors = st.sampled_from([1, 3, Fraction(1, 8), 2**200, Fraction(1, 2**200)])


@settings(deadline=None)
@given(st.sampled_from(sorted(SURFACES)), matrices, shifts, factors)
def test_a_kind_stays_what_it_is_turned_stretched_and_moved(name, matrix, shift, factor):
    numbers = substituted(SURFACES[name], matrix, shift)
    assert kind_of(quadric(factor * x for x in numbers)).name == name


@settings(deadline=None)
@given(st.sampled_from(sorted(FLAWS)), st.integers(0, 7), matrices, shifts)
def test_so_does_what_has_no_surface(flaw, k, matrix, shift):
    numbers = substituted(FLAWS[flaw][k % len(FLAWS[flaw])], matrix, shift)
    assert kind_of(quadric(numbers))[:2] == ("", flaw)
    assert not facts([quadric(numbers)])[0].drawn


@settings(deadline=None)
@given(st.tuples(*[st.integers(-3, 3)] * 10), st.booleans())
def test_signs_are_those_of_eigenvalues(numbers, hollow):
    """Hollow matrices have no square to begin with."""
    a, b, c, d, e, f, g, h, i, j = (0, 0, 0, *numbers[3:9], 0) if hollow else numbers
    matrix = np.array([[2 * a, d, e, g], [d, 2 * b, f, h], [e, f, 2 * c, i], [g, h, i, 2 * j]], float)
    kind = kind_of(quadric((a, b, c, d, e, f, g, h, i, j)))
    for part, signs in ((matrix[:3, :3], kind.matrix), (matrix, kind.whole)):
        values = np.linalg.eigvalsh(part)
        assert signs == ((values > 1e-9).sum(), (values < -1e-9).sum())


def test_decimals_are_taken_as_they_are_written():
    square = (0.09, 0.01, 0, 0.06, 0, 0, 0, 0, 0, 0)  # (0.3 x + 0.1 y)^2
    assert 4 * Fraction(0.09) * Fraction(0.01) != Fraction(0.06) ** 2
    assert kind_of(quadric(square)).flaw == "only a plane is inside, which has no volume"
    assert kind_of(quadric((*square[:9], -0.04))).name == "parallel planes"


@pytest.mark.parametrize("share", [10.0**-k for k in range(0, 301, 20)])
def test_needles_of_any_length_have_bounds_and_paraboloids_do_not(share):
    long = quadric((1, 1, share, 0, 0, 0, 0, 0, -1, -1))
    assert kind_of(long).name == "ellipsoid"
    _, high = surface_box(long)
    assert high[2] > 0.5 / share and facts([long])[0].bounded
    assert surface_box(quadric((1, 1, 0, 0, 0, 0, 0, 0, -1, -1))) is None


# ---- Boxes


@settings(deadline=None)
@given(shifts, st.tuples(*[st.integers(1, 60)] * 3))
def test_a_box_is_exact_where_doubles_hold_it(center, axes):
    squares = [Fraction(1, a * a) for a in axes]
    lcm = math.lcm(*(a * a for a in axes))
    numbers = [lcm * s for s in squares] + [0, 0, 0] + [-2 * lcm * s * c for s, c in zip(squares, center, strict=True)]
    constant = sum(lcm * s * c * c for s, c in zip(squares, center, strict=True)) - lcm
    if constant.denominator == 1 and abs(constant) < 2**53:  # else the double is another quadric
        low, high = surface_box(quadric([*numbers, constant]))
        assert low == tuple(c - a for c, a in zip(center, axes, strict=True))
        assert high == tuple(c + a for c, a in zip(center, axes, strict=True))


@settings(deadline=None)
@given(matrices, st.tuples(*[st.integers(-100, 100)] * 3))
def test_a_box_is_the_smallest_that_holds_the_body(matrix, shift):
    """The half-space beyond a side touches the body in a point at most, and one a little nearer cuts it."""
    numbers = substituted(SURFACES["ellipsoid"], matrix, shift)
    shape = quadric(numbers)
    for axis, (low, high) in enumerate(zip(*surface_box(shape), strict=True)):
        for side, inward in ((low, 1), (high, -1)):
            assert _least_on_plane(numbers, axis, Fraction(side)) >= 0
            nearer = Fraction(side) + inward * Fraction(2) ** -50 * max(1, abs(Fraction(side)))
            assert _least_on_plane(numbers, axis, nearer) < 0


def _least_on_plane(numbers, axis, value):
    """The least that f is where one coordinate has a value: it is a polynomial of the others, with a minimum."""
    a, b, c, d, e, f, g, h, i, j = map(Fraction, numbers)
    square = (a, b, c)
    mixed = {(0, 1): d, (0, 2): e, (1, 2): f}
    slope = (g, h, i)
    u, v = (k for k in range(3) if k != axis)

    def cross(k):
        return mixed[min(k, axis), max(k, axis)] * value + slope[k]

    p, q, r, s, t = square[u], mixed[u, v], square[v], cross(u), cross(v)
    rest = square[axis] * value * value + slope[axis] * value + j
    # p x^2 + q x y + r y^2 + s x + t y + rest
    det = 4 * p * r - q * q
    x, y = (q * t - 2 * r * s) / det, (q * s - 2 * p * t) / det
    return p * x * x + q * x * y + r * y * y + s * x + t * y + rest


@settings(deadline=None)
@given(st.fractions(min_value=0, max_value=10**300, max_denominator=10**60))
def test_a_root_is_not_below_and_hardly_above(x):
    root = root_above(x)
    assert x <= root * root <= x * (1 + Fraction(2) ** -99)
    if math.isqrt(x.numerator) ** 2 == x.numerator and math.isqrt(x.denominator) ** 2 == x.denominator == 1:
        assert root * root == x


# ---- Simpler shapes


@settings(deadline=None)
@given(st.tuples(*[st.integers(-999, 999)] * 3), st.integers(1, 999), st.sampled_from([1, 7, 0.1, 2**-300, 2**300]))
def test_a_ball_is_drawn_as_a_ball(center, radius, factor):
    x, y, z = center
    numbers = (1, 1, 1, 0, 0, 0, -2 * x, -2 * y, -2 * z, x * x + y * y + z * z - radius * radius)
    ball = simplified(quadric(factor * n for n in numbers))
    if factor in (1, 7):
        assert ball == Sphere(center, radius)
    assert ball.center == pytest.approx(center, rel=1e-15, abs=0)
    assert ball.radius**2 == pytest.approx(radius**2, rel=0, abs=2**-50 * (x * x + y * y + z * z + radius * radius))
    assert simplified(outside := quadric(-factor * n for n in numbers)) == outside


@settings(deadline=None)
@given(st.tuples(whole, whole, whole).filter(any), st.integers(-999, 999), st.integers(1, 999))
def test_a_slab_is_drawn_as_two_planes(normal, low, width):
    """Between n p = low and n p = low + width, which is (n p - low) (n p - low - width) <= 0."""
    a, b, c = normal
    high = low + width
    numbers = (
        *(a * a, b * b, c * c, 2 * a * b, 2 * a * c, 2 * b * c),
        *(-n * (low + high) for n in normal),
        low * high,
    )
    slab = simplified(quadric(numbers))
    assert isinstance(slab, Polyhedron)
    k = max(range(3), key=lambda k: abs(normal[k]))
    ends = []
    for plane in slab.planes:
        factor = plane[k] / normal[k]
        assert plane[:3] == pytest.approx([factor * n for n in normal], rel=1e-15, abs=0)
        assert -plane[3] / factor == pytest.approx(high if factor > 0 else low, rel=1e-15, abs=1e-300)
        ends.append(factor > 0)
    assert sorted(ends) == [False, True]


def test_a_linear_one_is_a_half_space():
    assert simplified(quadric((0, 0, 0, 0, 0, 0, 1, 2, 3, -4))) == Polyhedron(((1, 2, 3, -4),))


@pytest.mark.parametrize("name", [name for name in SURFACES if name not in ("parallel planes", "half-space")])
def test_others_stay_what_they_are(name):
    shape = quadric(SURFACES[name])
    assert simplified(shape) == shape


def test_what_doubles_do_not_hold_stays_a_quadric():
    far = quadric((1e-300, 1e-300, 1e-300, 0, 0, 0, 1e300, 0, 0, 0))
    assert simplified(far) == far and not facts([far])[0].bounded
    thin = quadric((1, 0, 0, 0, 0, 0, -2, 0, 0, math.nextafter(1, 0)))
    assert simplified(quadric((1, 0, 0, 0, 0, 0, -2e7, 0, 0, 1e14 - 1))).planes[0] == (1, 0, 0, -1e7 - 1)
    assert isinstance(simplified(thin), Polyhedron)


@pytest.mark.parametrize("kind", [k for k in SHAPE_KINDS.values() if k.NAME != NAME])
def test_other_kinds_are_simple(kind):
    shape = {"sphere": Sphere((0, 0, 0), 1), "polyhedron": Polyhedron(((1, 0, 0, -1),))}.get(kind.NAME)
    if shape is not None:
        assert kind.simplified(shape) is shape


# ---- Elsewhere


@settings(deadline=None)
@given(st.sampled_from(sorted(SURFACES)), st.tuples(whole, whole, whole), st.tuples(whole, whole, whole))
def test_moving_is_a_substitution(name, way, point):
    numbers = SURFACES[name]
    back = substituted(numbers, ((1, 0, 0), (0, 1, 0), (0, 0, 1)), [-w for w in way])
    assert moved(quadric(numbers), [Fraction(w) for w in way]) == quadric(back)
    half = substituted(back, ((2, 0, 0), (0, 2, 0), (0, 0, 2)), (0, 0, 0))  # half as large; a factor does not matter
    assert moved(quadric(numbers), [Fraction(w) for w in way], Fraction(1, 2)) == quadric(x / 4 for x in half)
    assert scaled(quadric(back), 0.5) == quadric(x / 4 for x in half)
    del point
