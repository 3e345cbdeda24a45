"""Where rays meet quadrics in Mitsuba's kernels: against exact arithmetic, and balls against themselves."""

from decimal import Decimal, localcontext
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

from converter.renderers.mitsuba import MitsubaRenderer
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.shapes import sphere

SCENES = Path(__file__).parent.parent / "scenes"
EPSILON = 2.0**-52
MOST_ROUNDINGS = 64
"""How far a crossing may be off the surface, in units of epsilon times the largest number that goes into it."""

QUADRICS = {
    "ball": (1, 1, 1, 0, 0, 0, 0, 0, 0, -1),
    "ellipsoid": (1, 2, 5, 0.5, 0.25, -0.5, 0, 0, 0, -1),
    "needle": (1, 1, 1e-6, 0, 0, 0, 0, 0, 0, -1),
    "plate": (1, 1, 1e8, 0, 0, 0, 0, 0, 0, -1),
    "slanting plate": (5001, 5001, 1, 9998, 0, 0, 0, 0, 0, -1),
    "cylinder": (1, 1, 0, 0, 0, 0, 0, 0, 0, -1),
    "slanting cylinder": (5, 5, 2, -2, 4, 4, 0, 0, 0, -6),
    "cone": (1, 1, -1, 0, 0, 0, 0, 0, 0, 0),
    "needle cone": (1, 1, -1e-8, 0, 0, 0, 0, 0, 0, 0),
    "paraboloid": (1, 1, 0, 0, 0, 0, 0, 0, -1, 0),
    "nearly a paraboloid": (1, 1, 1e-13, 0, 0, 0, 0, 0, -1, 0),
    "saddle": (1, -1, 0, 0, 0, 0, 0, 0, -1, 0),
    "one sheet": (1, 1, -1, 0, 0, 0, 0, 0, 0, -1),
    "two sheets": (1, 1, -1, 0, 0, 0, 0, 0, 0, 1),
    "hollow": (-1, -1, -1, 0, 0, 0, 0, 0, 0, 1),
    "parallel planes": (1, 0, 0, 0, 0, 0, 0, 0, 0, -1),
    "crossing planes": (0, 0, 0, 1, 0, 0, 0, 0, 0, 0),
    "parabolic cylinder": (1, 0, 0, 0, 0, 0, 0, -1, 0, 0),
}
every_quadric = pytest.mark.parametrize("numbers", QUADRICS.values(), ids=QUADRICS)


def moved(numbers, by) -> list[float]:
    """The quadric elsewhere."""
    a, b, c, d, e, f, g, h, i, j = map(Fraction, numbers)
    x, y, z = (-Fraction(number) for number in by)
    constant = a * x * x + b * y * y + c * z * z + d * x * y + e * x * z + f * y * z + g * x + h * y + i * z + j
    linear = (g + 2 * a * x + d * y + e * z, h + 2 * b * y + d * x + f * z, i + 2 * c * z + e * x + f * y)
    return [float(number) for number in (a, b, c, d, e, f, *linear, constant)]


def polynomial(numbers, o, d) -> tuple[Fraction, Fraction, Fraction]:
    """The coefficients of the square, of t and of 1 along a ray, exact."""
    a, b, c, k, m, n, g, h, i, j = map(Fraction, numbers)
    (x, y, z), (u, v, w) = map(Fraction, o), map(Fraction, d)
    square = a * u * u + b * v * v + c * w * w + k * u * v + m * u * w + n * v * w
    linear = 2 * (a * x * u + b * y * v + c * z * w) + k * (x * v + y * u) + m * (x * w + z * u) + n * (y * w + z * v)
    constant = a * x * x + b * y * y + c * z * z + k * x * y + m * x * z + n * y * z + g * x + h * y + i * z + j
    return square, linear + g * u + h * v + i * w, constant


def crossings(square, linear, constant) -> list[float]:
    """The real roots, ascending."""
    if square == 0:
        return [float(-constant / linear)] if linear else []
    discriminant = linear * linear - 4 * square * constant
    if discriminant <= 0:
        return []
    with localcontext() as context:
        context.prec = 80
        a, b, c, square_of_root = (
            Decimal(n.numerator) / Decimal(n.denominator) for n in (square, linear, constant, discriminant)
        )
        q = -(b + square_of_root.sqrt().copy_sign(b)) / 2
        return sorted(float(root) for root in (q / a, c / q))


class Kernel:
    """A quadric, and rays (n, 3), in Mitsuba."""

    def __init__(self, mi, numbers, o, d) -> None:
        import drjit as dr

        from mitsuba_plugins.intersection.rays import real, start_ray
        from mitsuba_plugins.intersection.rows import ListedRows
        from mitsuba_plugins.intersection.shapes import quadric

        self.kind, self.types = quadric, real("double")
        rows = [self.types.Vector4(*row) for row in quadric.read({"quadric": numbers}).rows]
        dr.make_opaque(rows)
        self.rows = ListedRows(0, rows)
        columns = (np.ascontiguousarray(v.T) for v in (o, d))
        self.ray = start_ray(self.types, *(kind(v) for kind, v in zip((mi.Point3d, mi.Vector3d), columns, strict=True)))
        self.own = mi.Bool(False)

    def passage(self):
        from mitsuba_plugins.intersection.rays import largest

        return self.kind.passage(self.rows, self.ray, self.own, largest(self.ray.o))

    def first_crossing(self):
        from mitsuba_plugins.intersection.passages import first_crossing
        from mitsuba_plugins.intersection.rays import largest

        return first_crossing(self.passage(), self.ray, self.own, largest(self.ray.o))


def rays_near(center, count):
    """Origins at distances of 0.1 to 100, and unit directions, among them some that are simple."""
    rng = np.random.default_rng(1)
    o = center + rng.normal(size=(count, 3)) * 10 ** rng.uniform(-1, 2, size=(count, 1))
    d = center + rng.normal(size=(count, 3)) * rng.uniform(0, 2, size=(count, 1)) - o
    d[:40] = rng.integers(-2, 3, size=(40, 3)) + np.array([0, 0, 0.5])
    d[40 : count // 2, 2] += center[2] - o[40 : count // 2, 2]
    d[40 : count // 2, :2] = center[:2] - o[40 : count // 2, :2]  # through the third axis
    return o, d / np.linalg.norm(d, axis=1)[:, None]


@every_quadric
@pytest.mark.parametrize("center", [(0, 0, 0), (1000, -2000, 512)], ids=["here", "far"])
def test_crossings_are_exact(mi, numbers, center):
    """Each is off the surface, which the ray may meet at any slant, by some roundings."""
    numbers, center, count = moved(numbers, center), np.array(center, float), 200
    o, d = rays_near(center, count)
    passage = Kernel(mi, numbers, o, d).passage()
    near, far, close, inside = (np.array(x) for x in (passage.near, passage.far, passage.close, passage.inside_before))
    checked = 0
    for k in range(count):
        if close[k]:
            continue
        square, linear, constant = polynomial(numbers, o[k], d[k])
        expected = crossings(square, linear, constant)
        # What is 0 may come out as a rounding error, and the other root of an equation of the first degree far away.
        found, expected = ([t for t in roots if abs(t) < 1e15] for roots in ((near[k], far[k]), expected))
        assert len(found) == len(expected), k
        if len(expected) != 1:
            before = Fraction(expected[0] - 1 if expected else 0)
            assert inside[k] == (square * before * before + linear * before + constant <= 0), k
        for t, true in zip(found, expected, strict=True):
            p = o[k] + t * d[k]
            slope = float(2 * square * Fraction(t) + linear)
            gradient = [float(polynomial(numbers, p, axis)[1]) for axis in np.eye(3)]
            off = abs(t - true) * abs(slope) / np.linalg.norm(gradient)
            assert off <= MOST_ROUNDINGS * EPSILON * max(*map(abs, o[k]), *map(abs, p), abs(t)), k
            checked += 1
    assert checked > 50


@every_quadric
def test_a_ray_meets_what_it_leaves_at_the_other_root(mi, numbers):
    """From inside and, where the surface is hollow, from outside; never where it starts."""
    import drjit as dr

    o, d = rays_near(np.zeros(3), 300)
    near = np.array(Kernel(mi, numbers, o, d).passage().near)
    starts = np.abs(near) < 100
    start, d = (
        (o[starts] + near[starts, None] * d[starts]),
        np.random.default_rng(2).normal(size=(int(starts.sum()), 3)),
    )
    d /= np.linalg.norm(d, axis=1)[:, None]
    kernel = Kernel(mi, numbers, start, d)
    exact = [polynomial(numbers, *ray) for ray in zip(start, d, strict=True)]
    inside = np.array([linear < 0 for _, linear, _ in exact])
    kernel.own, kernel.ray.inside = dr.full(mi.Bool, True, len(d)), mi.Bool(inside)
    t = np.array(kernel.first_crossing().t)
    meets = 0
    for k, (square, linear, _) in enumerate(exact):
        other = -linear / square if square else 0
        steep = abs(linear) > 1e-6 * float(np.abs(numbers).max())
        if steep and other > 0:
            assert t[k] == pytest.approx(float(other), rel=1e-6), k
            meets += 1
        elif steep:
            assert not t[k] < np.inf, k
    assert meets > 10


def test_a_ray_along_a_cone_s_side_or_a_paraboloid_s_axis_meets_it_once(mi):
    """Equations of the first degree."""
    o = np.array([[3.0, 0.0, 0.0], [0.5, 0.25, -7.0], [0.5, 0.25, 7.0]])
    d = np.array([[3.0, 4.0, 5.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]) / np.array([[5.0], [1.0], [1.0]])
    cone = np.array(Kernel(mi, QUADRICS["cone"], o[:1], d[:1]).first_crossing().t)
    assert not (cone < np.inf)
    cone = np.array(Kernel(mi, QUADRICS["cone"], o[:1], -d[:1]).first_crossing().t)
    assert cone == pytest.approx([2.5], abs=4 * EPSILON)
    paraboloid = Kernel(mi, QUADRICS["paraboloid"], o[1:], d[1:]).first_crossing()
    assert np.array_equal(np.array(paraboloid.t), [7.3125, 6.6875])
    assert np.array_equal(np.array(paraboloid.enters), [True, False])
    hollow = Kernel(mi, [-x for x in QUADRICS["paraboloid"]], o[1:], d[1:]).first_crossing()
    assert np.array_equal(np.array(hollow.t), [7.3125, 6.6875])
    assert np.array_equal(np.array(hollow.enters), [False, True])


def test_a_ray_leaves_a_hollow_body_where_it_enters_a_ball(mi):
    o, d = np.array([[0.0, 0.0, -5.0], [0.0, 0.0, 0.0]]), np.array([[0.0, 0.0, 1.0]] * 2)
    for name, enters in (("hollow", [False, True]), ("ball", [True, False])):
        crossing = Kernel(mi, QUADRICS[name], o, d).first_crossing()
        assert np.array(crossing.t).tolist() == [4, 1]
        assert np.array(crossing.enters).tolist() == enters


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("name", ["cylinder", "parallel planes", "crossing planes", "parabolic cylinder"])
def test_a_line_that_crosses_nothing_is_inside_or_outside_all_the_way(mi, name, sign):
    o, d = np.array([[0.25, 0.5, -7.0], [2.0, 0.5, 3.0], [2.0, -0.5, 3.0]]), np.array([[0.0, 0.0, 1.0]] * 3)
    numbers = [sign * x for x in QUADRICS[name]]
    passage = Kernel(mi, numbers, o, d).passage()
    inside = [polynomial(numbers, *ray)[2] <= 0 for ray in zip(o, d, strict=True)]
    assert len(set(inside)) == 2
    assert np.array(passage.inside_before).tolist() == inside
    assert not np.isfinite([np.array(passage.near), np.array(passage.far)]).any()


@every_quadric
def test_points_near_a_surface_are_moved_onto_it(mi, numbers):
    o, d = rays_near(np.zeros(3), 200)
    kernel = Kernel(mi, numbers, o, d)
    t = np.array(kernel.passage().near)
    near = (np.abs(t) < 100) & (np.abs(t) > 0.1)
    p = o[near] + t[near, None] * d[near] * (1 + 1e-8)
    kernel = Kernel(mi, numbers, o[near], d[near])
    ray = kernel.ray
    found = kernel.kind.surface_at(kernel.rows, kernel.types.Point3(np.ascontiguousarray(p.T)), ray, kernel.own, 100.0)

    def off(point):
        """NaN where crossing planes cross."""
        gradient = [float(polynomial(numbers, point, axis)[1]) for axis in np.eye(3)]
        return abs(float(polynomial(numbers, point, (1, 0, 0))[2])) / np.linalg.norm(gradient)

    before, after = (np.array([*map(off, points)]) for points in (p, np.array(found.p).T))
    assert np.nanmedian(after) <= np.nanmedian(before) / 1000


def test_a_complement_has_the_same_rows_but_for_signs():
    """So that a surface is met at the same distance from both sides."""
    from mitsuba_plugins.intersection.shapes import quadric

    for numbers in np.random.default_rng(3).integers(-3, 4, size=(100, 10)).astype(float).tolist():
        one, other = (quadric.read({"quadric": [sign * x for x in numbers]}).rows for sign in (1, -1))
        assert [*quadric.turned(tuple(one))] == other


FEW_BALLS = ["figure1", "whitted", "nested", "bubble"]


@pytest.mark.parametrize(
    ("name", "intersections"),
    [*product(FEW_BALLS, ["analytic", "bvh"]), ("lanterns", "bvh")],  # its many take seconds to compile one by one
)
def test_balls_are_drawn_alike_as_quadrics(monkeypatch, name, intersections):
    scene, settings = load_scene(SCENES / f"{name}.in"), Settings(width=160, height=120, max_depth=8)

    def draw():
        return MitsubaRenderer(VARIANT, intersections).render(scene, settings).pixels

    def as_quadric(shape, facts):
        (x, y, z), r = shape.center, shape.radius
        drawn.append(shape)
        numbers = [1, 1, 1, 0, 0, 0, -2 * x, -2 * y, -2 * z, x * x + y * y + z * z - r * r]
        return {"quadric": [1.7 * number for number in numbers], "box": (facts.low, facts.high)}

    drawn: list[object] = []
    balls = draw()
    monkeypatch.setattr(sphere, "geometry", as_quadric)
    quadrics = draw()
    assert drawn
    assert (np.abs(balls - quadrics) <= 1 / 255).all()
