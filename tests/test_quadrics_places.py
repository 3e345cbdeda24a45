"""Where a quadric is: points inside and on it, distances, margins of rays."""

import math
from fractions import Fraction

import numpy as np
import pytest
from quadrics import SURFACES, quadric, substituted

from converter.scene.model import Sphere
from converter.shapes import quadric as kind
from converter.shapes import quadric_frame, sphere
from converter.shapes.quadric_form import binary_form
from converter.to_mitsuba.bounds import Box
from converter.to_mitsuba.meshes.quadrics import View, quadric_mesh

TURNED = {
    name: quadric(substituted(numbers, ((3, 1, 0), (-1, 2, 1), (0, 1, 4)), (2, -1, 5)))
    for name, numbers in SURFACES.items()
}
"""Of every kind one that has no axis along another, and not its middle at the origin."""
EVERY = pytest.mark.parametrize("shape", TURNED.values(), ids=TURNED.keys())
RANDOM = np.random.default_rng(7)
POINTS = RANDOM.normal(size=(60, 3)) * 3
WAYS = RANDOM.normal(size=(60, 3))
WAYS /= np.linalg.norm(WAYS, axis=1)[:, None]


def exact(shape, p):
    return binary_form(shape).at([Fraction(float(x)) for x in p])


def lines(shape):
    """Origins and directions, half of them aimed at its middle, more or less."""
    middle = quadric_frame.frame_of(shape).origin
    for k, (o, d) in enumerate(zip(POINTS, WAYS, strict=True)):
        aimed = middle + 0.3 * d - o
        yield (o, aimed / np.linalg.norm(aimed)) if k % 2 else (o, d)


def surface(shape):
    """(n, 3) points of it."""
    return quadric_mesh(shape, Box((-9.0,) * 3, (9.0,) * 3), View((4.0, 5.0, -9.0), 4.0, 1 / 64)).vertices


@EVERY
def test_a_point_inside_is_inside(shape):
    (facts,) = kind.facts([shape])
    assert facts.drawn and exact(shape, facts.inside) < 0
    assert kind.contains(shape, facts.inside)


@EVERY
def test_what_is_inside_of_a_body_is_outside_of_its_complement(shape):
    complement = quadric(-x for x in shape.coefficients)
    for p in POINTS.tolist():
        assert kind.contains(shape, p) == (exact(shape, p) < 0)
        assert kind.contains(complement, p) == (exact(shape, p) > 0)
    (one,), (other,) = kind.facts([shape]), kind.facts([complement])
    assert one.bounded <= ("ellipsoid" in kind.classified(shape)) and not (one.bounded and other.bounded)


def test_points_on_a_surface_are_told_by_their_decimals():
    shape = quadric((1, 1, -1, 0, 0, 0, 0, 0, -0.2, -0.01))
    p = (0.3, 0.4, 0.4)  # .09 + .16 - .16 - .08 - .01 = 0
    assert exact(shape, p) != 0
    assert kind.lies_on(shape, p) and not kind.contains(shape, p)
    for step in (2.0**-49, -(2.0**-49)):
        assert not kind.lies_on(shape, (p[0] + step, *p[1:]))
    assert not kind.lies_on(shape, (math.inf, 0.0, 0.0)) and not kind.contains(shape, (math.nan, 0.0, 0.0))


def test_a_point_s_numbers_may_all_be_rounded_the_same_way():
    """Each product then has the roundings of three."""
    shape = quadric((1.13, 0, 0, 0, 0, 0, 0, 0, 0, -1.15043153))  # 1.13 1.009^2
    assert kind.lies_on(shape, (1.009, 0.3, 0.7))
    assert not kind.lies_on(shape, (1.009 + 2.0**-50, 0.3, 0.7))


@pytest.mark.parametrize("factor", [1.0, 1e-9, 1e9])
def test_those_that_lie_on_a_ball_lie_on_it_as_a_quadric(factor):
    ball = Sphere((0.1 * factor, 0.2 * factor, 0.3 * factor), 0.5 * factor)
    numbers = (1, 1, 1, 0, 0, 0, -0.2 * factor, -0.4 * factor, -0.6 * factor, -0.11 * factor**2)
    for p in ((0.6, 0.2, 0.3), (0.1, 0.5, 0.7), (0.1, 0.2, -0.2), (0.61, 0.2, 0.3)):
        place = tuple(factor * x for x in p)
        assert kind.lies_on(quadric(numbers), place) == sphere.lies_on(ball, place)


@EVERY
def test_no_point_is_nearer_or_farther_than_told(shape):
    (facts,) = kind.facts([shape])
    there = surface(shape)
    for p in POINTS[:20].tolist():
        distances = np.linalg.norm(there - p, axis=1)
        found = kind.distances(shape, facts, p)
        assert 0 <= found.nearest <= distances.min() * (1 + 1e-9)
        assert found.farthest >= distances.max()
    ray = surface(shape)[0]
    assert kind.distances(shape, facts, tuple(ray.tolist())).nearest < 1e-9


def test_the_bound_of_a_balls_distance_is_near_it():
    shape, (facts,) = quadric((1, 1, 1, 0, 0, 0, 0, 0, 0, -1)), kind.facts([quadric((1, 1, 1, 0, 0, 0, 0, 0, 0, -1))])
    assert kind.distances(shape, facts, (3.0, 0.0, 0.0)).nearest == pytest.approx(math.sqrt(17) - 3)
    assert kind.distances(shape, facts, (0.0, 0.0, 0.0)).nearest == pytest.approx(1)


@EVERY
def test_it_reaches_where_its_points_are(shape):
    there = surface(shape)
    for n, p in zip(WAYS, POINTS, strict=True):
        below = (there - p) @ n <= 0
        plane = (*n.tolist(), float(-(n @ p)))
        if below.any():
            assert kind.reaches(shape, [plane])
        elif kind.facts([shape])[0].bounded:
            assert (((there - p) @ n).min() < 1e-2) or not kind.reaches(shape, [plane])


# ---- Margins


@EVERY
def test_a_line_crosses_where_the_sign_changes(shape):
    crossed = 0
    for o, d in lines(shape):
        for t, cosine in kind.intersections(shape, o, d):
            step = 1e-6 * (1 + abs(t))
            before, after = (exact(shape, o + (t + s) * d) for s in (-step, step))
            if cosine:
                crossed += 1
                assert (before < 0 < after) if cosine > 0 else (before > 0 > after)
    assert crossed > 10


@EVERY
def test_a_line_moved_by_its_margin_begins_or_ceases_to_meet(shape):
    """Along the gradient, there or back; not so, one that misses what has no silhouette, such as a slab."""
    frame = quadric_frame.frame_of(shape)
    moved = counted = 0
    for o, d in lines(shape):
        found = kind.intersections(shape, o, d)
        margin = kind.silhouette_margin(shape, o, d)
        if len(found) == 2 and margin < math.inf:
            gradient = frame.half_gradient(frame.of(o + (found[0].t + found[1].t) / 2 * d))
            n = frame.axes @ gradient / np.linalg.norm(gradient)
            a, b, c, e = (_discriminant(frame, o + s * margin * n, d) for s in (-1.001, -0.999, 0.999, 1.001))
            moved += a * b < 0 or c * e < 0
            counted += 1
    name = kind.classified(shape)
    if "planes" not in name and "half" not in name:
        assert counted > 10
        assert moved > counted / 3 and ("ellipsoid" not in name or moved == counted)


def _discriminant(frame, o, d):
    a, b, c = quadric_frame._along(frame, frame.of(o), frame.axes.T @ d)
    return b * b - a * c


def test_margins_of_a_ball_are_those_of_a_sphere():
    shape, ball = quadric((1, 1, 1, 0, 0, 0, -2, 0, 0, -3)), Sphere((1.0, 0.0, 0.0), 2.0)
    for o, d in zip(POINTS, WAYS, strict=True):
        assert kind.silhouette_margin(shape, o, d) == pytest.approx(sphere.silhouette_margin(ball, o, d), abs=1e-12)
        assert kind.surface_margin(shape, o, False) == pytest.approx(sphere.surface_margin(ball, o, False), abs=1e-12)
        one, other = kind.intersections(shape, o, d), sphere.intersections(ball, o, d)
        if len(one) == 2:
            np.testing.assert_allclose(one, other, atol=1e-12)
    assert kind.radius_of_curvature(shape, np.array([3.0, 0.0, 0.0])) == pytest.approx(2)
    assert kind.surface_margin(shape, POINTS[0], True) == kind.edge_margin(shape, POINTS[0], WAYS[0]) == math.inf


@pytest.mark.parametrize(
    ("numbers", "p", "radius"),
    [
        ((1, 4, 9, 0, 0, 0, 0, 0, 0, -1), (1, 0, 0), 1 / 9),  # c^2 / a
        ((1, 1, 0, 0, 0, 0, 0, 0, -2, 0), (0, 0, 0), 1),  # the focal length's double
        ((1, 1, -1, 0, 0, 0, 0, 0, 0, 0), (0, 0, 0), 0),  # a cone's tip
        ((0, 0, 0, 0, 0, 0, 1, 0, 0, 0), (0, 1, 2), math.inf),
    ],
)
def test_radii_of_curvature(numbers, p, radius):
    assert kind.radius_of_curvature(quadric(numbers), np.array(p, float)) == pytest.approx(radius)


def test_a_line_along_a_cones_side_or_a_paraboloids_axis_crosses_once_at_most():
    cone = quadric((1, 0, -1, 0, 0, 0, 0, 0, 0, 0))
    side = np.array([1.0, 0.0, 1.0]) / math.sqrt(2)
    assert len(kind.intersections(cone, np.array([1.0, 0.0, 0.0]), side)) == 1
    assert kind.intersections(cone, np.zeros(3), side) == []
    bowl = quadric((1, 1, 0, 0, 0, 0, 0, 0, -1, 0))
    (found,) = kind.intersections(bowl, np.array([1.0, 0.0, 3.0]), np.array([0.0, 0.0, 1.0]))
    assert found.t == pytest.approx(-2)
