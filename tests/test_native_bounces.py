"""Reflected and transmitted rays against closed forms, and when they are traced, in every precision."""

import math

import pytest
from native_scenes import (
    BLACK,
    CONSTANT,
    EPSILON,
    PRECISIONS,
    WHITE,
    add_finish,
    box,
    draw,
    look,
    new_scene,
    normalized,
    trace_ray,
)

pytestmark = pytest.mark.parametrize("precision", PRECISIONS)


def close(values, expected, precision, size=1.0, operations=32):
    tolerance = operations * EPSILON[precision] * size
    return all(abs(a - b) <= tolerance for a, b in zip(values, expected, strict=True))


def chain(ray):
    """A ray and its successors, where each has one at most."""
    rays = [ray]
    while rays[-1]["children"]:
        (successor,) = rays[-1]["children"]
        rays.append(successor)
    return rays


# ---- Mirrors ---------------------------------------------------------------------------------------------------------


def facing_mirrors(kr, color=0.125):
    """The half-spaces z <= -1 and z >= 1, mirrors that shine with `color` themselves."""
    scene = new_scene(WHITE, background=(9, 9, 9))
    pigment, finish = scene.add_solid((color,) * 3), add_finish(scene, ka=1, kr=kr)
    scene.add_polyhedron(pigment, finish, [(0, 0, 1, 1)])
    scene.add_polyhedron(pigment, finish, [(0, 0, -1, 1)])
    return scene


@pytest.mark.parametrize("depth", [0, 1, 2, 7, 40])
def test_facing_mirrors_are_a_geometric_series(precision, depth):
    ray = trace_ray(facing_mirrors(0.5), BLACK, (0, 0, -1), precision=precision, max_depth=depth)
    # Sums and powers of two: exact.
    assert ray["radiance"][0] == pytest.approx(0.125 * (2 - 0.5**depth), abs=EPSILON[precision])
    assert [r["hit"]["object"] for r in chain(ray)] == [i % 2 for i in range(depth + 1)]


def test_a_pixel_adds_up_the_series(precision):
    scene = facing_mirrors(0.75)
    look(scene, BLACK, (0, 0, -1))
    image = draw(scene, 2, 2, precision=precision, cutoff=0, max_depth=50)
    expected = 0.125 * (1 - 0.75**51) / (1 - 0.75)
    # Seen through any pixel the rays go on between the mirrors for ever; the picture is in single precision.
    assert image.pixels.tolist()[0][0] == pytest.approx([expected] * 3, rel=52 * EPSILON["float"])


def test_reflection_aslant(precision):
    scene = new_scene()
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kr=1), [(0, 1, 0, 0)])
    ray = trace_ray(scene, (-3, 4, 0), (3, -4, 1), precision=precision, max_depth=1)
    (mirrored,) = ray["children"]
    assert mirrored["kind"] == "reflected"
    assert close(mirrored["direction"], (3 / 26**0.5, 4 / 26**0.5, 1 / 26**0.5), precision)
    assert close(mirrored["origin"], (0, 0, 1), precision, 5)


def test_reflection_at_the_inner_side_stays_inside(precision):
    scene = new_scene()
    scene.add_sphere(scene.add_solid(WHITE), add_finish(scene, kr=1), BLACK, 1)
    ray = trace_ray(scene, (0, 0, 0.5), (1, 0, 0), precision=precision, max_depth=300)
    rays = chain(ray)
    assert len(rays) == 301
    assert all(not r["hit"]["entering"] for r in rays)
    # Every chord keeps its distance from the centre; what one reflection adds to its error, rounding alone decides.
    half = math.sqrt(1 - 0.5**2)
    assert all(close((r["hit"]["t"],), (2 * half,), precision, 2, operations=300) for r in rays[1:])


def test_missed_rays_are_weighted_backgrounds(precision):
    scene = new_scene(background=(1, 0.5, 0.25))
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kr=0.5), [(0, 1, 0, 0)])
    ray = trace_ray(scene, (0, 1, 0), (0, -1, 0), precision=precision, max_depth=3)
    assert ray["radiance"] == (0.5, 0.25, 0.125)
    assert ray["children"][0]["hit"] is None


# ---- Glass -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("degrees", [0, 10, 45, 80])
def test_slab_of_glass_displaces_the_ray_and_keeps_its_direction(precision, degrees):
    index, thickness = 1.5, 2.0
    scene = new_scene()
    glass = add_finish(scene, kt=1, eta=1 / index)
    scene.add_polyhedron(scene.add_solid(WHITE), glass, [(0, 1, 0, 0), (0, -1, 0, -thickness)])
    theta = math.radians(degrees)
    direction = (math.sin(theta), -math.cos(theta), 0.0)
    eye = tuple(-c for c in direction)
    first, within, out = chain(trace_ray(scene, eye, direction, precision=precision, max_depth=5))
    bent = math.asin(math.sin(theta) / index)
    assert [r["kind"] for r in (first, within, out)] == ["primary", "transmitted", "transmitted"]
    assert close(within["direction"], (math.sin(bent), -math.cos(bent), 0), precision)
    assert close((within["hit"]["t"],), (thickness / math.cos(bent),), precision, 4)
    assert not within["hit"]["entering"]
    # Rounding of the cosine weighs 1 / cos(theta) in the sine.
    assert close(out["direction"], direction, precision, 1 / math.cos(theta))
    assert close(out["origin"], (thickness * math.tan(bent), -thickness, 0), precision, 4 / math.cos(theta))
    assert out["hit"] is None


def test_ball_of_glass_is_crossed_along_a_diameter(precision):
    scene = new_scene(background=WHITE)
    scene.add_sphere(scene.add_solid(WHITE), add_finish(scene, kt=0.5, eta=1 / 1.5), BLACK, 3)
    rays = chain(trace_ray(scene, (0, 0, 10), (0, 0, -1), precision=precision, max_depth=5))
    assert [r["direction"] for r in rays] == [(0, 0, -1)] * 3
    assert rays[1]["hit"]["t"] == 6
    assert rays[0]["radiance"] == (0.25, 0.25, 0.25)


def test_ball_lens_bends_symmetrically(precision):
    # What enters a ball under some angle leaves it under the same.
    scene = new_scene()
    scene.add_sphere(scene.add_solid(WHITE), add_finish(scene, kt=1, eta=1 / 1.5), BLACK, 1)
    rays = chain(trace_ray(scene, (0, 0.5, 5), (0, 0, -1), precision=precision, max_depth=5))
    assert len(rays) == 3
    outer, inner = math.asin(0.5), math.asin(0.5 / 1.5)
    assert close((rays[1]["hit"]["t"],), (2 * math.cos(inner),), precision, 5)
    turn = 2 * (outer - inner)
    assert close(rays[2]["direction"], (0, -math.sin(turn), -math.cos(turn)), precision, 5)


MARGIN = {"float": 1e-3, "double": 1e-7, "long double": 1e-7}
"""Sine beyond or before the critical angle: 1 - sin^2 cancels there, to about the root of the rounding error."""


@pytest.mark.parametrize("entering", [False, True], ids=["leaving", "entering"])
@pytest.mark.parametrize("total", [False, True])
def test_total_reflection_begins_at_the_critical_angle(precision, entering, total):
    # Leaving glass, or entering a bubble in it: the denser side is the ray's.
    index = 1.5
    scene = new_scene()
    finish = add_finish(scene, kt=1, eta=index if entering else 1 / index)
    scene.add_polyhedron(scene.add_solid(WHITE), finish, [(0, 1 if entering else -1, 0, 0)])
    sine = 1 / index + (1 if total else -1) * MARGIN[precision]
    direction = (sine, -math.sqrt(1 - sine**2), 0.0)
    first, second = chain(trace_ray(scene, (0, 1, 0), direction, precision=precision, max_depth=1))
    assert first["hit"]["entering"] == entering
    assert first["hit"]["total_reflection"] == total
    assert second["kind"] == "transmitted" and second["weight"] == 1
    if total:
        assert close(second["direction"], (sine, -direction[1], 0), precision)
    else:
        assert second["direction"][1] < 0 and close((second["direction"][0],), (sine * index,), precision)


@pytest.mark.parametrize("sine", [0.28, 0.352, 0.6, 0.8, 0.936, 0.96])
def test_at_the_critical_angle_a_ray_is_bent_along_the_surface(precision, sine):
    # Sines of Pythagorean triples, and frames of whole numbers; single precision decides no ties.
    cosine = round(math.sqrt(1 - sine**2), 3)
    frames = [((2, 3, 6), (3, -6, 2)), ((6, 2, -3), (2, 3, 6)), ((1, 4, 8), (8, -4, 1)), ((0, 9, 0), (9, 0, 0))]
    for normal, along in frames:
        scene = new_scene()
        scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kt=1, eta=1 / sine), [(*normal, 0)])
        direction = tuple(round(1000 * (sine * a - cosine * n)) for a, n in zip(along, normal, strict=True))
        first = trace_ray(scene, tuple(-d / 1000 for d in direction), direction, precision=precision, max_depth=1)
        assert precision == "float" or not first["hit"]["total_reflection"]


def test_total_reflection_keeps_both_rays(precision):
    # The weights of a finish that reflects and transmits are not added up, so that each meets the cut-off by itself.
    scene = new_scene()
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kr=0.25, kt=0.5, eta=0.5), [(0, -1, 0, 0)])
    ray = trace_ray(scene, (0, 1, 0), (1, -0.5, 0), precision=precision, max_depth=1)
    reflected, transmitted = ray["children"]
    assert reflected["direction"] == transmitted["direction"]
    assert (reflected["weight"], transmitted["weight"]) == (0.25, 0.5)


def test_a_prism_turns_a_ray_by_a_right_angle(precision):
    # In by one face, totally reflected by the slanting one, and out by the third.
    scene = new_scene()
    prism = [(0, 1, 0, -1), (-1, 0, 0, -1), (1, -1, 0, -1)]
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kt=1, eta=1 / 1.5), prism)
    rays = chain(trace_ray(scene, (0.5, 5, 0), (0, -1, 0), precision=precision, max_depth=9))
    met = [(r["hit"]["plane"], r["hit"]["entering"], r["hit"]["total_reflection"]) for r in rays[:-1]]
    assert met == [(0, True, False), (2, False, True), (1, False, False)]
    assert close(rays[-1]["direction"], (-1, 0, 0), precision)
    assert close(rays[-1]["origin"], (-1, -0.5, 0), precision, 5)


def test_a_ray_bent_along_a_face_does_not_leave_by_it(precision):
    # Near the critical angle, where roundings decide on which side of the face the bent ray leads.
    index, bent = 1.5, 0
    for i in range(400):
        angle = math.asin(1 / index) + (i - 200) * EPSILON[precision] / 4
        normal = normalized((math.sin(i), 1.7, math.cos(7 * i)))
        along = normalized((normal[1], -normal[0], 0.0))
        bubble = [(*normal, 0.0), (*(-c for c in normal), -1.0)]
        scene = new_scene()
        scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kt=1, eta=index), bubble)
        direction = tuple(math.sin(angle) * a - math.cos(angle) * n for a, n in zip(along, normal, strict=True))
        rays = chain(trace_ray(scene, tuple(-d for d in direction), direction, precision=precision, max_depth=1))
        if not rays[0]["hit"]["total_reflection"]:
            bent += 1
            assert rays[1]["hit"] is None or rays[1]["hit"]["plane"] == 1
    assert bent > 100


@pytest.mark.parametrize("kind", ["mirror", "glass"])
def test_a_small_ball_makes_directions_uncertain(precision, kind):
    # A ball of radius 1/20, met where its normal is rational, sends the ray to a wall, to the very edge of a tile: that
    # of the larger number. The ball's normal, and with it the ray, is off by the error of a point over the radius.
    for i in range(20):
        x, y, z = 7.3, 0.2, round(5.1 + 0.17 * i, 2)
        side, met, left = (1, 0.03, 0.04) if kind == "mirror" else (-1, 0.048, -0.05)
        finish = {"kr": 1} if kind == "mirror" else {"kt": 1, "eta": 0.625}
        start = x + met if kind == "mirror" else x
        edge = round(z + left + side * 2.8, 3)
        scene = new_scene(WHITE)
        scene.add_sphere(scene.add_solid(WHITE), add_finish(scene, **finish), (x, y, z), 0.05)
        tiles = scene.add_checker(WHITE, BLACK, edge / 10)
        wall = (-side, 0, 0, side * round(start + side * 9.6, 2))
        scene.add_polyhedron(tiles, add_finish(scene, ka=1), [wall])
        rays = chain(
            trace_ray(scene, (x + met, y, z + 8), (0, 0, -1), precision=precision, max_depth=1 if side > 0 else 2)
        )
        assert rays[-1]["hit"]["object"] == 1
        assert close(rays[-1]["hit"]["point"], (start + side * 9.6, y, edge), precision, 20, 8000)
        column, row = (math.floor(c / (edge / 10)) for c in (start + side * 9.6, y))
        if precision != "float":  # which decides no ties
            assert rays[0]["radiance"][0] == (10 + column + row + 1) % 2


def test_glass_within_glass(precision):
    # A ball within a ball: the far sides are met in the right order, and each surface by its own eta.
    scene = new_scene()
    pigment = scene.add_solid(WHITE)
    scene.add_sphere(pigment, add_finish(scene, kt=1, eta=0.5), BLACK, 2)
    scene.add_sphere(pigment, add_finish(scene, kt=1, eta=0.9), BLACK, 1)
    rays = chain(trace_ray(scene, (0, 0, 5), (0, 0, -1), precision=precision, max_depth=9))
    assert [(r["hit"]["object"], r["hit"]["entering"], r["hit"]["t"]) for r in rays[:-1]] == [
        (0, True, 3),
        (1, True, 1),
        (1, False, 2),
        (0, False, 1),
    ]


def test_boxes_back_to_back(precision):
    # The face that they share is met twice, at distance 0 the second time: neither is skipped, none is met again.
    scene = new_scene()
    pigment, glass = scene.add_solid(WHITE), add_finish(scene, kt=1)
    scene.add_polyhedron(pigment, glass, box((0, -1, -1), (1, 1, 1)))
    scene.add_polyhedron(pigment, glass, box((-1, -1, -1), (0, 1, 1)))
    rays = chain(trace_ray(scene, (5, 0.3, 0.2), (-1, 0, 0), precision=precision, max_depth=9))
    met = [(r["hit"]["object"], r["hit"]["plane"]) for r in rays if r["hit"]]
    assert met[0] == (0, 3) and met[-1] == (1, 0)
    assert len(rays) <= 5


# ---- Which rays are traced -------------------------------------------------------------------------------------------


def test_rays_below_the_cutoff_are_dropped(precision):
    # Weights 1, 1/2, 1/4, 1/8; the next would be below.
    rays = chain(trace_ray(facing_mirrors(0.5), BLACK, (0, 0, -1), precision=precision, cutoff=1 / 8, max_depth=99))
    assert [r["weight"] for r in rays] == [1, 0.5, 0.25, 0.125]
    assert [r["dropped"] for r in rays] == [{}, {}, {}, {"reflected": "cutoff"}]
    assert rays[0]["radiance"][0] == 0.125 * 1.875


def test_rays_beyond_the_depth_limit_are_dropped(precision):
    rays = chain(trace_ray(facing_mirrors(0.5), BLACK, (0, 0, -1), precision=precision, max_depth=2))
    assert [r["depth"] for r in rays] == [0, 1, 2]
    assert rays[-1]["dropped"] == {"reflected": "depth"}


def test_without_a_cutoff_rays_of_any_weight_are_traced(precision):
    rays = chain(trace_ray(facing_mirrors(2.0**-10), BLACK, (0, 0, -1), precision=precision, max_depth=11))
    assert len(rays) == 12 and rays[-1]["weight"] == 2.0**-110


def test_no_ray_follows_from_what_neither_reflects_nor_transmits(precision):
    ray = trace_ray(facing_mirrors(0.0), BLACK, (0, 0, -1), precision=precision, max_depth=5)
    assert ray["children"] == [] and ray["dropped"] == {}


def test_a_full_tree_of_both_kinds(precision):
    # Between a half-mirror's two faces every hit has two successors: the radiance is a finite double series.
    scene = new_scene(background=WHITE)
    scene.add_polyhedron(scene.add_solid(BLACK), add_finish(scene, kr=0.5, kt=0.5), [(0, 1, 0, 0), (0, -1, 0, -1)])
    scene.add_light((0, 5, 0), WHITE, CONSTANT)
    ray = trace_ray(scene, (0, 2, 0), (0, -1, 0), precision=precision, max_depth=8)
    # Of the light 1/2 goes up at once; of what enters, half leaves at each face: 1/4 down and 1/8 up, and so on.
    inside = [0.25 * 0.5**k for k in range(7)]
    assert ray["radiance"][0] == pytest.approx(0.5 + sum(inside), abs=8 * EPSILON[precision])


def test_rays_are_counted_by_kind(precision):
    scene = facing_mirrors(0.5)
    look(scene, BLACK, (0, 0, -1))
    statistics = draw(scene, 20, 10, precision=precision, cutoff=0, max_depth=3, samples=4, threads=1).statistics
    assert statistics == {
        "primary": 800,
        "reflected": 2400,
        "transmitted": 0,
        "shadow": 0,
        "deepest": 3,
        "pixels_too_deep": 200,
        "threads": 1,
        "search": "brute",
    }
