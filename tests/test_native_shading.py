"""Local colour: pigments, lights, highlights and shadows, against closed forms, in every precision."""

import math
from array import array
from random import Random

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

import native_tracer

pytestmark = pytest.mark.parametrize("precision", PRECISIONS)

FLOOR = [(0.0, 1.0, 0.0, 0.0)]
DOWN = (0.0, -1.0, 0.0)


def floor_seen_at(point, pigment_of, finish, precision, lights=(), ambient=BLACK, objects=(), **options):
    """The ray that comes down on the floor y <= 0 at (x, z) = `point`; `pigment_of(scene)` adds its pigment.

    `objects` are functions of the scene, a pigment and a finish, called after the floor was added.
    """
    scene = new_scene(ambient)
    pigment, finish = pigment_of(scene), add_finish(scene, **finish)
    scene.add_polyhedron(pigment, finish, FLOOR)
    for light in lights:
        scene.add_light(*light)
    for add_object in objects:
        add_object(scene, pigment, finish)
    x, z = point
    return trace_ray(scene, (x, 1.0, z), DOWN, precision=precision, **options)


def red(scene):
    return scene.add_solid((0.5, 0.25, 0.125))


def close(color, expected, precision, operations=24):
    tolerance = operations * EPSILON[precision]
    return all(abs(a - b) <= tolerance * max(1.0, abs(b)) for a, b in zip(color, expected, strict=True))


# ---- Pigments --------------------------------------------------------------------------------------------------------


def test_ambient_light_is_tinted_by_the_pigment(precision):
    ray = floor_seen_at((0, 0), red, {"ka": 0.5}, precision, ambient=(1, 0.5, 0.25))
    assert ray["local"] == (0.25, 0.0625, 0.015625)


@pytest.mark.parametrize(
    ("x", "z", "even"),
    [(0.5, 0.5, True), (1.5, 0.5, False), (-0.5, 0.5, False), (-0.5, -0.5, True), (-1.5, 0.5, True), (2.5, -3.5, True)],
)
def test_checker_counts_cells_by_floor(precision, x, z, even):
    # The floor stands at y = 1.5 sizes, in the cell with number 1.
    scene = new_scene(WHITE)
    checker = scene.add_checker((1, 0, 0), (0, 1, 0), 2)
    scene.add_polyhedron(checker, add_finish(scene, ka=1), [(0, 1, 0, -3)])
    ray = trace_ray(scene, (2 * x, 5, 2 * z), DOWN, precision=precision)
    assert ray["local"] == ((0, 1, 0) if even else (1, 0, 0))


@pytest.mark.parametrize("column", range(4))
@pytest.mark.parametrize("share", [0.1, 0.9])
def test_whole_numbers_are_meant_as_they_stand(precision, column, share):
    # If the heights of eye and floor were known to an epsilon only, so would be where these small texels are.
    size, height = 2.0**-30, 2.0**20
    texels = array("f", [c / 4 for c in range(4) for _ in range(3)])
    scene = new_scene(WHITE)
    texture = scene.add_texmap(4, 1, texels, (0.25 / size, 0, 0, 0), (0, 0, 0, 0))
    scene.add_polyhedron(texture, add_finish(scene, ka=1), [(0, 1, 0, -height)])
    ray = trace_ray(scene, (0, height + 1, 0), ((column + share) * size, -1, 0), precision=precision)
    assert ray["radiance"] == (column / 4,) * 3


@pytest.mark.parametrize("far", [3e9, 1e13, 1e17])
def test_checker_and_texmap_survive_any_coordinate(precision, far):
    # Twice the cell's number, no integer holds; the colour is one of the two, or one of the texels.
    scene = new_scene(WHITE)
    checker = scene.add_checker((1, 0, 0), (0, 1, 0), 1e-9)
    texture = scene.add_texmap(3, 1, array("f", [1, 0, 0, 0, 1, 0, 0, 0, 1]), (1e10, 1, 1, 1), (1e10, -1e10, 1e10, 0))
    finish = add_finish(scene, ka=1)
    scene.add_sphere(checker, finish, (far, 0, 0), 1e-3 * far)
    scene.add_sphere(texture, finish, (-far, 0, 0), 1e-3 * far)
    for sign in (1, -1):
        color = trace_ray(scene, BLACK, (sign, 1e-4, 2e-4), precision=precision)["local"]
        assert sorted(color) == [0, 0, 1]


def texel_scene(p0, p1, width=4, height=2):
    """A floor whose texel in column c and row r has the colour (c, r, 0)."""
    texels = array("f", [v for r in range(height) for c in range(width) for v in (c, r, 0)])
    scene = new_scene(WHITE)
    pigment = scene.add_texmap(width, height, texels, p0, p1)
    scene.add_polyhedron(pigment, add_finish(scene, ka=1), FLOOR)
    return scene


@pytest.mark.parametrize(
    ("s", "column"),
    [(0.1, 0), (0.3, 1), (0.99, 3), (1.01, 0), (2.6, 2), (-0.1, 0), (-0.2, 0), (-0.3, 3), (-0.99, 1), (-1.3, 3)],
)
def test_texmap_truncates_toward_zero_and_wraps(precision, s, column):
    # trunc(s W) mod W, plus W if negative: the column on both sides of s = 0 is the first.
    scene = texel_scene((1, 0, 0, 0), (0, 0, 1, 0))
    assert trace_ray(scene, (s, 1, 0.1), DOWN, precision=precision)["local"] == (column, 0, 0)


def test_texmap_rows_run_down_from_the_top(precision):
    scene = texel_scene((0, 0, 0, 0.8), (0, 0, 1, 0.25))
    rows = [trace_ray(scene, (0, 1, z), DOWN, precision=precision)["local"][1] for z in (0, 0.3, 0.8, -0.3, -0.8)]
    assert rows == [0, 1, 0, 0, 1]


# ---- Lights ----------------------------------------------------------------------------------------------------------


def test_floor_lit_by_an_attenuated_light(precision):
    # A 3-4-5 triangle: distance 5, cosine 4/5.
    light = ((3, 4, 0), (1, 0.5, 2), (0.5, 0.25, 0.125))
    ray = floor_seen_at((0, 0), red, {"kd": 0.5}, precision, [light])
    factor = 0.5 * 0.8 / (0.5 + 0.25 * 5 + 0.125 * 25)
    assert close(ray["local"], (factor * 0.5, factor * 0.5 * 0.25, factor * 2 * 0.125), precision)
    (contribution,) = ray["hit"]["lights"]
    assert close((contribution["cosine"], contribution["attenuation"]), (0.8, 4.875), precision)
    assert contribution["shadowed_by"] is None


def test_lights_add_up_and_are_not_clamped(precision):
    lights = [((0, 2, 0), (3, 3, 3), CONSTANT), ((0, 4, 0), (5, 5, 5), CONSTANT)]
    ray = floor_seen_at((0, 0), red, {"ka": 1, "kd": 1}, precision, lights, ambient=WHITE)
    assert close(ray["local"], (4.5, 2.25, 1.125), precision)


def test_light_behind_the_surface_adds_nothing(precision):
    ray = floor_seen_at((0, 0), red, {"kd": 1, "ks": 1, "alpha": 0}, precision, [((0, -3, 0), WHITE, CONSTANT)])
    assert ray["local"] == BLACK


def test_phong_highlight_is_white_and_uses_the_mirror_direction(precision):
    # Seen from straight above, r.v is the cosine of the light's direction.
    light = ((3, 4, 0), (1, 0.5, 0.25), CONSTANT)
    ray = floor_seen_at((0, 0), red, {"ks": 0.5, "alpha": 3}, precision, [light])
    shine = 0.5 * 0.8**3
    assert close(ray["local"], (shine, shine * 0.5, shine * 0.25), precision)


def test_blinn_highlight_uses_the_half_vector(precision):
    light = ((3, 4, 0), WHITE, CONSTANT)
    ray = floor_seen_at((0, 0), red, {"ks": 0.5, "alpha": 3}, precision, [light], blinn=True)
    # Half the angle whose cosine is 4/5.
    shine = 0.5 * math.sqrt((1 + 0.8) / 2) ** 3
    assert close(ray["local"], (shine, shine, shine), precision)


def test_highlight_away_from_the_mirror_direction(precision):
    # The viewer stands where r.v < 0: nothing, unless alpha is 0, when even nothing to the power of 0 is 1.
    scene = new_scene()
    light = ((1, 0.5, 0), WHITE, CONSTANT)
    for alpha, expected in ((1, 0), (0, 1), (0.5, 0)):
        scene = new_scene()
        scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, ks=1, alpha=alpha), FLOOR)
        scene.add_light(*light)
        ray = trace_ray(scene, (1, 0.5, 0), (-1, -0.5, 0), precision=precision)
        assert ray["local"] == (expected,) * 3


@pytest.mark.parametrize("alpha", [0, 0.5, 1, 2, 3.75, 17, 1000, 65535, 65536.5, 1e6])
def test_highlights_of_any_exponent(precision, alpha):
    # Whole exponents are multiplied out, others left to the C library; close to 1, so that something is left to see.
    base = 1 - 2.0**-20
    light = (((1 - base**2) ** 0.5, base, 0), WHITE, CONSTANT)
    ray = floor_seen_at((0, 0), red, {"ks": 1, "alpha": alpha}, precision, [light])
    # An error of the base counts alpha times; in single precision the light's direction is rounded too.
    tolerance = (alpha + 4) * 8 * EPSILON[precision]
    assert ray["local"] == pytest.approx((base**alpha,) * 3, abs=tolerance)


@pytest.mark.parametrize("finish", [{"ka": 1}, {"kr": 1}, {"kt": 1}])
def test_no_shadow_rays_where_nothing_answers_them(precision, finish):
    scene = new_scene()
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, **finish), FLOOR)
    scene.add_light((0, 5, 0), WHITE, CONSTANT)
    look(scene, (0, 1, 0), DOWN)
    assert draw(scene, precision=precision).statistics["shadow"] == 0


# ---- Shadows ---------------------------------------------------------------------------------------------------------

ABOVE = ((0, 10, 0), WHITE, CONSTANT)


def a_ball(center, radius):
    return lambda scene, pigment, finish: scene.add_sphere(pigment, finish, center, radius)


def a_pane_of_glass(scene, pigment, _):
    scene.add_polyhedron(pigment, add_finish(scene, kt=1), box((-5, 5, -5), (5, 5.5, 5)))


@pytest.mark.parametrize(
    ("blocker", "blocked"),
    [
        (a_ball((0, 5, 0), 1), True),
        (a_ball((1.01, 5, 0), 1), False),
        (a_ball((0, 12, 0), 1), False),  # behind the light
        (a_ball((0, 9, 0), 3), True),  # the light stands within
        (a_ball((0, 7, 0), 7.01), False),  # and so does the floor
        (a_ball((0, 5, 0), 100), False),
        (a_ball((0, 0, 0), 6), True),  # the floor alone
        (a_pane_of_glass, True),
    ],
)
def test_whatever_stands_before_the_light_blocks_it(precision, blocker, blocked):
    ray = floor_seen_at((0, 0), red, {"kd": 1}, precision, [ABOVE], objects=[blocker])
    assert ray["hit"]["lights"][0]["shadowed_by"] == (1 if blocked else None)
    assert (ray["local"] == BLACK) == blocked


def test_small_ball_far_from_the_light_blocks_it(precision):
    # Seen from the light, the ball's radius is lost in the rounding of its distance.
    light = (3011.7, 2543.3, -1507.9)
    radius, center = 2.0**-9, tuple(2 * c / math.hypot(*light) for c in light)
    aslant = math.sqrt(1 - (center[0] / 2) ** 2)  # between steps along the floor and across the way to the light
    for step in (-15, -11, *range(-9, 10), 11, 15):
        x = step / 10 * radius / aslant
        lights, objects = [(light, WHITE, CONSTANT)], [a_ball(center, radius)]
        ray = floor_seen_at((x, 0), red, {"kd": 1}, precision, lights, objects=objects)
        assert ray["hit"]["lights"][0]["shadowed_by"] == (1 if abs(step) < 10 else None)


@pytest.mark.parametrize(
    "add_object",
    [
        lambda scene, pigment, finish: scene.add_sphere(pigment, finish, (0, 0, 0), 2),
        lambda scene, pigment, finish: scene.add_polyhedron(pigment, finish, box((-2, -2, -2), (2, 2, 2))),
    ],
    ids=["sphere", "box"],
)
@pytest.mark.parametrize(("light", "blocker"), [((0, 1.5, 0), None), ((0, 30, 0), 0)])
def test_a_body_seen_from_within_is_shaded_by_its_own_far_side(precision, add_object, light, blocker):
    scene = new_scene()
    add_object(scene, scene.add_solid(WHITE), add_finish(scene, kd=1))
    scene.add_light(light, WHITE, CONSTANT)
    ray = trace_ray(scene, (0, -1, 0), DOWN, precision=precision)
    assert not ray["hit"]["entering"] and ray["hit"]["normal"] == DOWN
    (contribution,) = ray["hit"]["lights"]
    assert contribution["cosine"] == 1 and contribution["shadowed_by"] == blocker


@pytest.mark.parametrize(("light", "blocker"), [((0, 1.5, 0), 1), ((0, 30, 0), 0)])
def test_of_what_is_in_the_way_of_a_light_outside_it_is_the_body_seen_from_within(precision, light, blocker):
    scene = new_scene()
    matte = add_finish(scene, kd=1)
    scene.add_polyhedron(scene.add_solid(WHITE), matte, box((-2, -2, -2), (2, 2, 2)))
    scene.add_sphere(scene.add_solid(WHITE), matte, (0, 0.5, 0), 0.25)
    scene.add_light(light, WHITE, CONSTANT)
    ray = trace_ray(scene, (0, -1, 0), DOWN, precision=precision)
    assert ray["hit"]["lights"][0]["shadowed_by"] == blocker


@pytest.mark.parametrize(("place", "lit"), [(1.0, {True}), (2.25, {False, True}), (3.5, {False})])
def test_a_disc_in_a_wall_lights_the_room_with_its_inner_part(precision, place, lit):
    scene = new_scene()
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kd=1), box((-2, -2, -2), (2, 10, 2)))
    scene.add_light((place, 2.25, 0), WHITE, CONSTANT, 0.75)
    look(scene, (-1.75, 0, 0), DOWN)
    image = native_tracer.Image(1, 1)
    seen = set()
    for seed in range(64):
        native_tracer.render(scene, image, cutoff=0, max_depth=0, precision=precision, seed=seed, corner=False)
        seen.add(image.pixels[0, 0, 0] > 0)
    assert seen == lit


@pytest.mark.parametrize(("height", "blocker"), [(4 - 2**-12, None), (4 + 2**-12, 0), (5, 0)])
def test_a_light_near_a_wall_is_on_one_side_of_it(precision, height, blocker):
    scene = new_scene()
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kd=1), box((-2, 0, -2), (2, 4, 2)))
    scene.add_light((0.5, height, 0), WHITE, CONSTANT)
    ray = trace_ray(scene, (0, 2, 0), DOWN, precision=precision)
    assert ray["hit"]["lights"][0]["shadowed_by"] == blocker


@pytest.mark.parametrize("count", [8, 64, 1000])
def test_a_stone_is_lit_as_a_csg_of_the_same_planes(precision, count):
    # No light is known to be outside of a csg: its shadow rays are traced.
    random = Random(count)

    def direction():
        return normalized([random.gauss(0, 1) for _ in range(3)])

    planes = [(*direction(), -random.uniform(0.97, 1.03)) for _ in range(count)]
    lights = [
        (tuple(distance * c for c in direction()), (0.4, 0.3, 0.2), CONSTANT, radius)
        for distance in (0.5, 0.9, 0.99, 1, 1.01, 1.1, 9)
        for radius in (0, 0.1)
    ]

    def picture(add_stone):
        scene = new_scene(WHITE, (0.2, 0.3, 0.5))
        scene.set_camera((0, 1, 5), BLACK, (0, 1, 0), 30)
        for light in lights:
            scene.add_light(*light)
        add_stone(scene, scene.add_solid(WHITE), add_finish(scene, ka=0.1, kd=0.4, kr=0.2, kt=0.6, eta=1 / 1.6))
        image = draw(scene, 16, 12, precision=precision, cutoff=1 / 16, max_depth=4)
        return bytes(image.pixels.cast("B")), image.statistics["shadow"]

    stone = picture(lambda scene, *looks: scene.add_polyhedron(*looks, planes))
    assert stone == picture(lambda scene, *looks: scene.add_csg(*looks, [("polyhedron", planes)], [0]))


def test_light_outside_a_sphere_seen_from_within_is_behind_its_near_side(precision):
    scene = new_scene()
    scene.add_sphere(scene.add_solid(WHITE), add_finish(scene, kd=1), BLACK, 2)
    scene.add_light((0, -30, 0), WHITE, CONSTANT)
    ray = trace_ray(scene, BLACK, DOWN, precision=precision)
    assert ray["hit"]["lights"][0]["cosine"] == -1 and ray["local"] == BLACK


def test_a_light_on_the_surface_is_no_accident(precision):
    ray = floor_seen_at((0, 0), red, {"kd": 1, "ks": 1}, precision, [(BLACK, WHITE, (0, 0, 1))])
    assert ray["local"] == BLACK


def test_a_shadow_ray_in_the_plane_of_a_face_is_blocked(precision):
    # The light is so near that an error of where the ray starts is a large one of its direction.
    if precision == "float":
        pytest.skip("decides no ties")
    for i in range(100):
        x, z = round(5.1 + 0.37 * i, 2), round(0.3 + 0.11 * i, 2)
        scene = new_scene()
        pigment, finish = scene.add_solid(WHITE), add_finish(scene, kd=1)
        scene.add_polyhedron(pigment, finish, [(0, 1, 0, -0.3)])
        scene.add_polyhedron(pigment, finish, box((x, -1, z + 0.1), (x + 1, 1, z + 0.2)))
        scene.add_light((x, 0.5, round(z + 0.3, 2)), WHITE, CONSTANT)
        ray = trace_ray(scene, (round(x - 0.7, 2), 1.4, round(z - 0.3, 2)), (0.7, -1.1, 0.3), precision=precision)
        assert ray["hit"]["lights"][0]["shadowed_by"] == 1


def test_shadow_rays_are_counted(precision):
    scene = new_scene()
    scene.add_polyhedron(scene.add_solid(WHITE), add_finish(scene, kd=1), FLOOR)
    for light in [(0, 5, 0), (3, 4, 0), (0, -1, 0)]:
        scene.add_light(light, WHITE, CONSTANT)
    look(scene, (0, 1, 0), DOWN)
    image = native_tracer.Image(10, 10)
    native_tracer.render(scene, image, cutoff=0, max_depth=0, precision=precision)
    assert image.statistics["shadow"] == 200
