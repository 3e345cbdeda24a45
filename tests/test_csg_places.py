"""Where a csg is: points inside and on it, the box around it, distances, margins of rays."""

import math

import numpy as np
import pytest
from csgs import BALL, CUBE, CYLINDER, FAR, RIGHT, box, csg, half_space, is_inside, random_csg

from converter.scene.model import Polyhedron, Quadric, Sphere
from converter.shapes import csg as kind
from converter.shapes.csg_places import inside_point

RANDOM = np.random.default_rng(11)
BODIES = {
    "lens": csg("+", BALL, "&", RIGHT),
    "bitten": csg("+", BALL, "-", RIGHT),
    "drilled": csg("+", CUBE, "-", CYLINDER),
    "rod": csg("+", CYLINDER, "&", CUBE),
    "pair": csg("+", BALL, "+", FAR),
    "shell": csg("+", BALL, "-", Sphere((0.0, 0.0, 0.0), 0.9)),
    "nested": csg("+", BALL, "-", csg("+", RIGHT, "-", Sphere((0.75, 0.25, 0.0), 0.5))),
    "stacked": csg("+", CUBE, "+", box((-0.5, 1, -0.5), (0.5, 2, 0.5))),
    "half": csg("+", BALL, "-", half_space(1, 1, 0, 0)),
    **{f"random {seed}": random_csg(seed) for seed in (1, 7, 10, 15, 22)},
}
SLAB = Polyhedron(((0, 1, 0, -1), (0, -2, 0, -2)))
CONE, BOWL, WAIST = (
    Quadric((1, square, 1, 0, 0, 0, 0, slope, 0, constant))
    for square, slope, constant in ((-1, 0, 0), (0, -1, 0), (-1, 0, -1))
)
EVERY = pytest.mark.parametrize("shape", BODIES.values(), ids=BODIES.keys())


RIM = (0.4033126, 0.9150623)
"""Where the surfaces of both balls of "bitten" meet, in the plane z = 0."""


def facts_of(shape):
    (facts,) = kind.facts([shape])
    return facts


@EVERY
def test_box_holds_all_that_is_inside(shape):
    facts = facts_of(shape)
    points = RANDOM.uniform(-3, 6, (300, 3))
    inside = np.array([p for p in points.tolist() if is_inside(shape, p)])
    if facts.bounded and len(inside):
        assert np.all(inside >= facts.low) and np.all(inside <= facts.high)


@pytest.mark.parametrize(
    ("shape", "low", "high"),
    [
        (csg("+", BALL, "-", FAR), (-1, -1, -1), (1, 1, 1)),
        (csg("+", BALL, "+", FAR), (-1, -1, -1), (6, 6, 6)),
        (csg("+", BALL, "&", RIGHT), (0, -0.5, -0.75), (1, 1, 0.75)),
        (csg("+", half_space(1, 0, 0, -1), "&", CUBE, "-", half_space(0, 1, 0, 0)), (-1, 0, -1), (1, 1, 1)),
        (csg("+", CYLINDER, "&", CUBE), (-0.5, -1, -0.5), (0.5, 1, 0.5)),
        (
            csg("+", CYLINDER, "&", half_space(0, 1, 0, -3), "-", half_space(0, 2, 0, 4)),
            (-0.5, -2, -0.5),
            (0.5, 3, 0.5),
        ),
        (csg("+", csg("+", BALL, "+", CYLINDER), "&", SLAB), (-1, -1, -1), (1, 1, 1)),
        (csg("+", CONE, "&", SLAB), (-1, -1, -1), (1, 1, 1)),
        (csg("+", BOWL, "&", SLAB), (-1, 0, -1), (1, 1, 1)),
        (csg("+", WAIST, "&", SLAB), (-math.sqrt(2), -1, -math.sqrt(2)), (math.sqrt(2), 1, math.sqrt(2))),
        (csg("+", CYLINDER, "&", Polyhedron(((1, 2, 0, -2), (-1, -2, 0, -2)))), (-0.5, -1.25, -0.5), (0.5, 1.25, 0.5)),
        (csg("+", BALL, "-", half_space(1, 0, 0, -0.5)), (0.5, -1, -1), (1, 1, 1)),
    ],
)
def test_box_is_no_larger_than_its_leaves_ask_for(shape, low, high):
    facts = facts_of(shape)
    assert facts.bounded
    assert facts.low == pytest.approx(low, abs=1e-8) and facts.high == pytest.approx(high, abs=1e-8)


def test_what_has_no_bounds_says_so():
    assert not facts_of(csg("+", CYLINDER, "-", BALL)).bounded
    assert not facts_of(csg("+", BALL, "+", half_space(0, 1, 0, 3))).bounded


@EVERY
def test_a_point_inside_is_inside(shape):
    p = inside_point(shape)
    assert p is not None and is_inside(shape, p) and kind.contains(shape, p)
    assert facts_of(shape).inside == p


@EVERY
def test_what_is_inside_is_so_by_the_definition(shape):
    for p in RANDOM.uniform(-2, 2, (60, 3)).tolist():
        assert kind.contains(shape, p) == is_inside(shape, p)
        assert not kind.lies_on(shape, p)


@pytest.mark.parametrize(
    ("shape", "point", "inside", "on_it"),
    [
        (csg("+", CUBE, "+", box((-0.5, 1, -0.5), (0.5, 2, 0.5))), (0, 1, 0), True, False),  # a face of both
        (csg("+", CUBE, "+", box((-0.5, 1, -0.5), (0.5, 2, 0.5))), (0.75, 1, 0), False, True),
        (csg("+", CUBE, "-", box((-2, -2, -2), (2, 2, 1))), (0, 0, 1), False, False),  # nothing is left there
        (csg("+", CUBE, "-", box((-1, -1, -1), (0, 1, 1))), (-1, 0, 0), False, False),  # no film
        (csg("+", CUBE, "-", box((-1, -1, -1), (0, 1, 1))), (0, 0, 0), False, True),
        (csg("+", CUBE, "-", BALL), (1, 0, 0), False, True),
        (csg("+", BALL, "-", BALL, "+", CUBE), (0, 0, 1), False, True),
        (csg("+", BALL, "-", RIGHT), (1.5, 0.25, 0), False, False),  # of RIGHT's surface, outside of the ball
        (csg("+", BALL, "-", RIGHT), (0, 0.25, 0), False, True),
        (csg("+", half_space(1, 3, 0, -1), "+", csg("+", half_space(-0.1, -0.3, 0, 0.1), "&", BALL)),
         (1, 0, 0), False, True),
        (csg("+", half_space(1, 3, 0, -0.1), "+", csg("+", half_space(-0.1, -0.3, 0, 0.01), "&", BALL)),
         (0.1, 0, 0), True, False),
        (csg("+", CYLINDER, "-", Quadric(tuple(-x for x in CYLINDER.coefficients))), (0.5, 0, 0), False, True),
    ],
)  # fmt: skip
def test_places_where_surfaces_meet(shape, point, inside, on_it):
    p = tuple(map(float, point))
    assert (kind.contains(shape, p), kind.lies_on(shape, p)) == (inside, on_it)


@EVERY
def test_bounds_of_distances(shape):
    """Along lines from a point: no crossing is nearer than the least, or farther than the most."""
    facts = facts_of(shape)
    for p in RANDOM.uniform(-4, 4, (3, 3)):
        found = kind.distances(shape, facts, tuple(p.tolist()))
        assert 0 <= found.nearest <= found.farthest
        for d in RANDOM.normal(size=(6, 3)):
            d /= np.linalg.norm(d)
            for at in changes(shape, p, d, 12.0):
                assert found.nearest <= at + 1e-9 and at <= found.farthest + 1e-9


def changes(shape, p, d, far, steps=120):
    """Where it is entered or left along a ray, to some digits; thin parts are missed."""
    ts = np.linspace(0, far, steps)
    values = [is_inside(shape, (p + t * d).tolist()) for t in ts]
    for k in range(steps - 1):
        if values[k] != values[k + 1]:
            low, high = ts[k], ts[k + 1]
            for _ in range(25):
                middle = (low + high) / 2
                low, high = (
                    (middle, high) if is_inside(shape, (p + middle * d).tolist()) == values[k] else (low, middle)
                )
            yield (low + high) / 2


@pytest.mark.parametrize("name", ["lens", "bitten", "drilled", "shell", "nested", "stacked", "random 7", "random 10"])
def test_intersections_are_where_it_is_entered_and_left(name):
    shape = BODIES[name]
    for _ in range(6):
        p = RANDOM.normal(size=3)
        p *= 4 / np.linalg.norm(p)
        d = RANDOM.uniform(-0.6, 0.6, 3) - p
        d /= np.linalg.norm(d)
        found = kind.intersections(shape, p, d)
        for at in changes(shape, p, d, 9.0):
            nearest = min(found, key=lambda c: abs(c.t - at))
            assert nearest.t == pytest.approx(at, abs=1e-6)
            assert 0 < abs(nearest.cosine) <= 1 + 1e-12


def test_no_intersection_where_faces_coincide():
    shape = csg("+", CUBE, "+", box((-0.5, 1, -0.5), (0.5, 2, 0.5)))
    found = kind.intersections(shape, np.array((0.1, 5.0, 0.2)), np.array((0.0, -1.0, 0.0)))
    assert sorted(c.t for c in found) == pytest.approx([3.0, 6.0])


def test_margins_tell_how_near_a_ray_is_to_what_it_would_meet():
    bitten = csg("+", BALL, "-", RIGHT)
    down = np.array((0.0, -1.0, 0.0))
    past = kind.silhouette_margin(bitten, np.array((-1.25, 5.0, 0.0)), down)
    assert past == pytest.approx(0.25)
    assert kind.edge_margin(bitten, np.array((-0.5, 5.0, 0.0)), down) == math.inf  # a ball has one face
    on_rim = np.array((RIM[0] + 0.01, 5.0, 0.0))  # the line crosses both balls at nearly one place
    assert 1e-4 < kind.silhouette_margin(bitten, on_rim, down) < 0.01
    hidden = csg("+", CUBE, "+", Sphere((0.0, 0.0, 0.0), 0.5))
    assert kind.silhouette_margin(hidden, np.array((0.5, 5.0, 0.0)), down) == pytest.approx(0.5)  # to the cube's side


def test_margins_of_a_point():
    bitten = csg("+", CUBE, "-", half_space(0, -1, 0, 0.5))  # which leaves what is below 1/2
    assert kind.surface_margin(bitten, np.array((0.0, 0.75, 0.0)), False) == pytest.approx(0.25)
    assert kind.surface_margin(csg("+", CUBE, "-", BALL), np.array((1.0, 0.9, 0.9)), True) == pytest.approx(0.1)
    assert kind.radius_of_curvature(csg("+", CUBE, "-", BALL), np.array((0.0, 0.6, 0.8))) == pytest.approx(1.0)
    assert kind.radius_of_curvature(csg("+", CUBE, "-", BALL), np.array((1.0, 0.9, 0.9))) == math.inf


def test_reaching_into_half_spaces():
    ring = csg("+", BALL, "-", CYLINDER)
    assert kind.reaches(ring, [(1.0, 0.0, 0.0, 0.5)])
    assert not kind.reaches(ring, [(1.0, 0.0, 0.0, 1.5)])
    assert not kind.reaches(csg("+", BALL, "&", half_space(1, 0, 0, 0)), [(-1.0, 0.0, 0.0, 0.5)])
    assert kind.reaches(csg("+", BALL, "+", half_space(1, 0, 0, 3)), [(1.0, 0.0, 0.0, 7.0)])
    assert kind.reaches(csg("+", BALL, "&", half_space(1, 0, 0, 0), "+", FAR), [(-1.0, 0.0, 0.0, 4.5)])


@EVERY
def test_a_scaled_csg_is_as_much_larger(shape):
    larger, facts, more = kind.scaled(shape, 4.0), facts_of(shape), facts_of(kind.scaled(shape, 4.0))
    assert more.bounded == facts.bounded
    for p in RANDOM.uniform(-2, 2, (40, 3)):
        assert kind.contains(larger, tuple((4 * p).tolist())) == kind.contains(shape, tuple(p.tolist()))
    assert kind.extent(larger) == pytest.approx(4 * kind.extent(shape))
