"""The boxes around csgs in the native tracer hold the body, and are not much larger, also where no leaf has one."""

import math
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from native_scenes import CONSTANT, PRECISIONS, WHITE, add_finish, box, draw, look, new_scene, trace_ray
from test_native_csg import INTERSECT, SUBTRACT, UNITE, check, functions, random_leaf, random_program, scene_of
from test_native_quadrics import placed, turned

CYLINDER = ("quadric", (1, 0, 1, 0, 0, 0, 0, 0, 0, -1))
LYING = ("quadric", (0, 1, 1, 0, 0, 0, 0, 0, 0, -0.25))
STEM = ("quadric", (1, -0.05, 1, 0, 0, 0, 0, 0, 0, -0.04))
CONE = ("quadric", (1, -1, 1, 0, 0, 0, 0, 0, 0, 0))
BOWL = ("quadric", (1, 0, 1, 0, 0, 0, 0, -1, 0, 0))
CHANNEL = ("quadric", (1, 0, 0, 0, 0, 0, 0, -1, 0, 0))
SADDLE = ("quadric", (1, -1, 0, 0, 0, 0, 0, 0, -1, 0))
BALL = ("sphere", (0, 0, 0, 1))
SLAB = ("polyhedron", [(0, 1, 0, -2), (0, -1, 0, 1)])  # from y = 1 to 2
BELOW = ("polyhedron", [(0, 1, 0, -2)])
NOT_ABOVE = ("polyhedron", [(0, 1, 0, -0.6)])
ABOVE = ("polyhedron", [(0, -1, 0, 0.6)])
WIDTH = math.sqrt(0.24)
BEHIND = ("polyhedron", [(0, 0, 1, -2), (0, 0, -1, -1)])


def box_of(leaves, program):
    return scene_of(leaves, program).box_of(0)


@pytest.mark.parametrize(
    ("leaves", "program", "low", "high"),
    [
        ([CYLINDER, SLAB], [0, 1, INTERSECT], (-1, 1, -1), (1, 2, 1)),
        ([SLAB, CYLINDER], [0, 1, INTERSECT], (-1, 1, -1), (1, 2, 1)),
        ([CYLINDER, ABOVE, BELOW], [0, 1, INTERSECT, 2, INTERSECT], (-1, 0.6, -1), (1, 2, 1)),
        ([CYLINDER, NOT_ABOVE, BELOW], [0, 1, SUBTRACT, 2, INTERSECT], (-1, 0.6, -1), (1, 2, 1)),
        ([CYLINDER, LYING], [0, 1, INTERSECT], (-1, -0.5, -0.5), (1, 0.5, 0.5)),
        ([STEM, SLAB], [0, 1, INTERSECT], (-WIDTH, 1, -WIDTH), (WIDTH, 2, WIDTH)),
        ([CONE, SLAB], [0, 1, INTERSECT], (-2, 1, -2), (2, 2, 2)),
        ([BOWL, BELOW], [0, 1, INTERSECT], (-math.sqrt(2), 0, -math.sqrt(2)), (math.sqrt(2), 2, math.sqrt(2))),
        ([CHANNEL, BELOW, BEHIND], [0, 1, INTERSECT, 2, INTERSECT], (-math.sqrt(2), 0, -1), (math.sqrt(2), 2, 2)),
        ([BALL, ABOVE], [0, 1, INTERSECT], (-0.8, 0.6, -0.8), (0.8, 1, 0.8)),
        ([CYLINDER, BALL, SLAB], [0, 1, SUBTRACT, 2, INTERSECT], (-1, 1, -1), (1, 2, 1)),
        ([CYLINDER, SLAB, BALL], [0, 1, INTERSECT, 2, UNITE], (-1, -1, -1), (1, 2, 1)),
    ],
)  # fmt: skip
def test_what_is_cut_off_has_a_close_box(leaves, program, low, high):
    found = box_of(leaves, program)
    assert found is not None
    for exact, value in zip((*low, *high), (*found[0], *found[1]), strict=True):
        assert value == pytest.approx(exact, abs=0.02)
    assert all(a <= b for a, b in zip(found[0], low, strict=True))
    assert all(a >= b for a, b in zip(found[1], high, strict=True))


def test_a_lens_is_narrower_than_its_balls():
    """It is 0.44 wide, at its rim; each ball alone is 0.6 wide where it cuts the other."""
    low, high = box_of([BALL, ("sphere", (1.8, 0, 0, 1))], [0, 1, INTERSECT])
    assert low[0] == pytest.approx(0.8) and high[0] == pytest.approx(1)
    assert 0.43 < high[1] < 0.61
    assert low[1] == pytest.approx(-high[1])


@pytest.mark.parametrize(
    ("leaves", "program"),
    [
        ([CYLINDER, BELOW], [0, 1, INTERSECT]),
        ([CYLINDER, BEHIND], [0, 1, INTERSECT]),
        ([CONE, BELOW], [0, 1, INTERSECT]),
        ([SADDLE, SLAB], [0, 1, INTERSECT]),
        ([BALL, CYLINDER], [0, 1, UNITE]),
        ([CYLINDER, BALL], [0, 1, SUBTRACT]),
    ],
)
def test_what_goes_on_has_none(leaves, program):
    assert box_of(leaves, program) is None


@pytest.mark.parametrize("seed", range(20))
def test_a_turned_cylinder_of_rounded_numbers_has_a_box(seed):
    """Its coefficients are rounded to six digits, so that it is a cone or an ellipsoid, a million times as long."""
    rng = random.Random(seed)
    axes = turned(rng)
    center = [rng.uniform(-4, 4) for _ in range(3)]
    q = [round(c, 6) for c in placed((1, 0, 1, 0, 0, 0, 0, 0, 0, -1), axes, center, 1)]
    along = next(
        a for a in axes_of(axes) if abs(sum(x * y for x, y in zip(bent(q, a), a, strict=True))) < 1e-4
    )  # fmt: skip
    middle = sum(a * c for a, c in zip(along, center, strict=True))
    ends = [(*(round(s * a, 6) for a in along), -s * middle - 1.5) for s in (1, -1)]
    found = box_of([("quadric", q), ("polyhedron", ends)], [0, 1, INTERSECT])
    assert found is not None
    for k in range(3):
        width = 1.5 * abs(along[k]) + math.sqrt(1 - along[k] ** 2)
        assert found[0][k] <= center[k] - width + 1e-4
        assert center[k] + width - 1e-4 <= found[1][k]
        assert found[1][k] - found[0][k] <= 1.5 * math.hypot(2 * 1.5, 2, 2)


def axes_of(matrix):
    return [*matrix, *zip(*matrix, strict=True)]


def bent(q, v):
    x, y, z = v
    return (
        q[0] * x + (q[3] * y + q[4] * z) / 2,
        q[1] * y + (q[3] * x + q[5] * z) / 2,
        q[2] * z + (q[4] * x + q[5] * y) / 2,
    )


def inside(leaves, program, points):
    """Of which of the points, n x 3, the body has each."""
    x, y, z = points.T
    terms = np.stack([x * x, y * y, z * z, x * y, x * z, y * z, x, y, z, np.ones_like(x)])
    stack = []
    for step in program:
        if step >= 0:
            stack.append(np.all([np.asarray(q, float) @ terms <= 0 for q in functions(leaves[step])], axis=0))
            continue
        right, left = stack.pop(), stack.pop()
        stack.append(left | right if step == UNITE else left & ~right if step == SUBTRACT else left & right)
    return stack[0]


def half_spaces(rng, count):
    return [(*(rng.uniform(-1, 1) for _ in range(3)), -rng.uniform(0.05, 1.5)) for _ in range(count)]


def cut_off(rng):
    """A body that is likely to have bounds: a random one of few leaves, in random half-spaces."""
    count = rng.randint(1, 4)
    leaves = [random_leaf(rng) for _ in range(count)]
    program = random_program(rng, count)
    for _ in range(rng.randint(1, 3)):
        planes = half_spaces(rng, rng.randint(1, 3))
        leaves.append(("polyhedron", planes))
        program = [*program, len(leaves) - 1, INTERSECT]
        if rng.random() < 0.5:
            leaves.append(("polyhedron", [tuple(-x for x in plane) for plane in half_spaces(rng, 1)]))
            program = [*program, len(leaves) - 1, SUBTRACT]
    return leaves, program


@settings(max_examples=300, deadline=None)
@given(st.integers(0, 2**32))
def test_no_point_lies_outside_the_box(seed):
    rng = random.Random(seed)
    leaves, program = cut_off(rng)
    found = box_of(leaves, program)
    if found is None:
        return
    low, high = map(np.array, found)
    numbers = np.random.default_rng(seed)
    size = high - low + 1e-3
    far = np.concatenate(
        [numbers.uniform(low - k * size, high + k * size, (4000, 3)) for k in (0.02, 0.5, 4, 100)]
        + [numbers.uniform(low - 1e-6 * size, high + 1e-6 * size, (4000, 3))]
    )
    # And close to each side, on its outside.
    for k in range(3):
        for side, sign in ((low, -1), (high, 1)):
            points = numbers.uniform(low, high, (2000, 3))
            points[:, k] = side[k] + sign * size[k] * 10.0 ** numbers.uniform(-12, 0, 2000)
            far = np.concatenate([far, points])
    outside = ((far < low) | (far > high)).any(axis=1)
    assert not inside(leaves, program, far[outside]).any()


def test_most_bodies_between_planes_have_boxes():
    found = 0
    for seed in range(200):
        rng = random.Random(seed)
        leaves = [CYLINDER, ("polyhedron", half_spaces(rng, 1)), ("polyhedron", half_spaces(rng, 4))]
        found += box_of(leaves, [0, 1, INTERSECT, 2, INTERSECT]) is not None
    assert found > 120


@pytest.mark.parametrize("seed", range(8))
def test_leaves_are_left_out_only_where_they_make_no_difference(seed):
    rng = random.Random(seed)
    compared = 0
    for _ in range(40):
        leaves, program = cut_off(rng)
        scene = scene_of(leaves, program)
        for _ in range(20):
            origin = tuple(rng.uniform(-4, 4) for _ in range(3))
            ray = trace_ray(scene, origin, tuple(rng.uniform(-1, 1) for _ in range(3)))
            compared += check(leaves, program, ray, "double")
    assert compared > 700


@pytest.mark.parametrize("precision", PRECISIONS)
def test_what_a_half_space_takes_away_outside_the_box_stays_away(precision):
    """Of two bowls back to back, the half-space takes the larger, which a ray meets that passes the box beside it."""
    bowls = ("quadric", (-1, 1, 1, 0, 0, 0, 0, 0, 0, 1))
    leaves = [bowls, ("polyhedron", [(-1, 0, 0, -3), (1, 0, 0, -30)]), ("polyhedron", [(-1, 0, 0, 0.5)])]
    scene = scene_of(leaves, [0, 1, INTERSECT, 2, SUBTRACT])
    _, high = scene.box_of(0)
    assert high[0] < 0.6 and high[1] < 2.9
    assert trace_ray(scene, (-1.5, 2.7, 0), (1, 0.3, 0), precision=precision)["hit"] is None
    assert trace_ray(scene, (1.5, 0, 0), (-1, 0, 0), precision=precision)["hit"]["t"] == pytest.approx(2.5)


def test_a_leaf_that_is_used_twice_matters_in_both_places():
    """A ball, of which two slabs leave a piece each."""
    slabs = [("polyhedron", box((x - 0.1, -2, -2), (x + 0.1, 2, 2))) for x in (0.5, -0.5)]
    scene = scene_of([BALL, *slabs], [0, 1, INTERSECT, 0, 2, INTERSECT, UNITE])
    for x in (0.5, -0.5):
        assert trace_ray(scene, (x, 0, 3), (0, 0, -1))["hit"]["t"] == pytest.approx(3 - math.sqrt(0.75))
    assert trace_ray(scene, (0, 0, 3), (0, 0, -1))["hit"] is None


@pytest.mark.parametrize("precision", PRECISIONS)
def test_boxes_of_what_is_cut_off_lose_no_hit(precision):
    """Each csg's leaves are searched by boxes, and the csgs too."""
    rng = random.Random(4)
    scene = new_scene()
    scene.add_light((3, 4, 5), WHITE, CONSTANT)
    for _ in range(24):
        leaves, program = cut_off(rng)
        scene.add_csg(scene.add_solid(WHITE), add_finish(scene, ka=0.3, kd=0.6, kr=0.3), leaves, program)
    look(scene, (0, 0, 6), (0, 0, -1))
    brute, tree = (draw(scene, precision=precision, search=search) for search in ("brute", "bvh"))
    assert bytes(brute.pixels) == bytes(tree.pixels)


# ---- Light -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("light", "blocker"), [((0, 1.5, 0), 1), ((0, 30, 0), 0)])
def test_of_what_is_in_the_way_of_a_light_outside_it_is_the_csg_seen_from_within(light, blocker):
    scene = new_scene()
    matte, white = add_finish(scene, kd=1), scene.add_solid(WHITE)
    scene.add_csg(white, matte, [CYLINDER, ("polyhedron", [(0, 1, 0, -2), (0, -1, 0, -2)])], [0, 1, INTERSECT])
    scene.add_sphere(white, matte, (0, 0.5, 0), 0.25)
    scene.add_light(light, WHITE, CONSTANT)
    ray = trace_ray(scene, (0, -1, 0), (0, -1, 0))
    assert ray["hit"]["lights"][0]["shadowed_by"] == blocker


@pytest.mark.parametrize("light", [(0, 0.5, 0), (0.9, 1.9, 0.9)])
def test_a_light_in_the_box_of_a_csg_shines_through_its_hole(light):
    """The box is not the body: what is drilled out, or rounded off, is lit from there."""
    scene = new_scene()
    matte, white = add_finish(scene, kd=1), scene.add_solid(WHITE)
    hole = ("quadric", (1, 0, 1, 0, 0, 0, 0, 0, 0, -0.25))
    room = ("polyhedron", box((-1, -2, -1), (1, 2, 1)))
    scene.add_csg(white, matte, [room, hole], [0, 1, SUBTRACT])
    scene.add_light(light, WHITE, CONSTANT)
    wall = trace_ray(scene, (0, 0, 0), (-1, 0, 0))
    assert wall["hit"]["lights"][0]["shadowed_by"] == (None if light[0] == 0 else 0)


def test_a_disc_that_reaches_into_the_box_lights_the_body_from_within():
    scene = new_scene()
    scene.add_csg(
        scene.add_solid(WHITE), add_finish(scene, kd=1),
        [("quadric", (1, 0, 1, 0, 0, 0, 0, 0, 0, -4)), ("polyhedron", [(0, 1, 0, -10), (0, -1, 0, -2)])],
        [0, 1, INTERSECT],
    )  # fmt: skip
    scene.add_light((2.25, 2.25, 0), WHITE, CONSTANT, 0.75)
    look(scene, (-1.25, 0, 0), (0, -1, 0))
    seen = {draw(scene, 1, 1, seed=seed, corner=False).pixels[0, 0, 0] > 0 for seed in range(64)}
    assert seen == {False, True}
