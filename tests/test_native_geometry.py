"""The first rungs of the ladder: camera rays, first hits, points and normals, in every precision."""

import math

import pytest
from native_scenes import (
    CONSTANT,
    EPSILON,
    PRECISIONS,
    WHITE,
    add_finish,
    box,
    dot,
    new_scene,
    normalized,
    trace_ray,
)

import native_tracer

pytestmark = pytest.mark.parametrize("precision", PRECISIONS)

FEW = 16
"""Operations, each wrong by half a unit in the last place, between the numbers of a test and its result."""


def close(value, expected, precision, size=1.0, operations=FEW):
    """Whether numbers of magnitude `size` agree to the rounding of `operations` operations."""
    values = value if isinstance(value, tuple) else (value,)
    wanted = expected if isinstance(expected, tuple) else (expected,)
    tolerance = operations * EPSILON[precision] * size
    return all(abs(a - b) <= tolerance for a, b in zip(values, wanted, strict=True))


def scene_of(*shapes):
    """Spheres `(center, radius)` and polyhedra `[planes]`."""
    scene = new_scene()
    pigment, finish = scene.add_solid(WHITE), add_finish(scene, ka=1)
    for shape in shapes:
        if isinstance(shape, list):
            scene.add_polyhedron(pigment, finish, shape)
        else:
            scene.add_sphere(pigment, finish, *shape)
    return scene


def hit_of(shapes, eye, direction, precision):
    return trace_ray(scene_of(*shapes), eye, direction, precision=precision)["hit"]


# ---- Camera ----------------------------------------------------------------------------------------------------------


def camera_direction(x, y, width, height, precision, **options):
    scene = new_scene()
    scene.set_camera((1, 2, 3), (1, 2, -7), (0, 1, 0.3), 60)
    return [
        ray["direction"]
        for ray in native_tracer.trace_pixel(
            scene, width, height, x, y, cutoff=0, max_depth=0, precision=precision, **options
        )["rays"]
    ]


def window(x, y, aspect=1.0):
    """The direction through window coordinates -1..1 of a camera that looks along -z, 60 degrees high."""
    tangent = math.tan(math.radians(30))
    return normalized((x * tangent * aspect, y * tangent, -1.0))


def test_corner_of_the_first_pixel_is_the_corner_of_the_window(precision):
    (direction,) = camera_direction(0, 0, 8, 8, precision)
    assert close(direction, window(-1, 1), precision)


def test_right_is_view_cross_up_and_rows_run_down(precision):
    (direction,) = camera_direction(6, 7, 8, 8, precision)
    assert close(direction, window(0.5, -0.75), precision)


def test_pixels_are_square(precision):
    (direction,) = camera_direction(0, 0, 12, 6, precision)
    assert close(direction, window(-1, 1, aspect=2.0), precision)


def test_centre_of_a_pixel_is_half_a_pixel_from_its_corner(precision):
    (direction,) = camera_direction(0, 0, 8, 8, precision, corner=False)
    assert close(direction, window(-1 + 1 / 8, 1 - 1 / 8), precision)


@pytest.mark.parametrize("corner", [True, False])
def test_samples_are_the_centres_of_a_grid_shifted_like_the_single_ray(precision, corner):
    directions = camera_direction(3, 2, 8, 8, precision, samples=4, corner=corner)
    shift = 0.5 if corner else 0.0
    expected = [
        window(2 * (3 + dx - shift) / 8 - 1, 1 - 2 * (2 + dy - shift) / 8) for dy in (0.25, 0.75) for dx in (0.25, 0.75)
    ]
    assert len(directions) == 4
    assert all(close(d, e, precision) for d, e in zip(directions, expected, strict=True))


# ---- Spheres ---------------------------------------------------------------------------------------------------------


def test_sphere_is_hit_at_its_near_side(precision):
    hit = hit_of([((1, 2, -10), 2)], (1, 2, 3), (0, 0, -1), precision)
    assert close(hit["t"], 11.0, precision, 13)
    assert close(hit["point"], (1.0, 2.0, -8.0), precision, 13)
    assert hit["normal"] == (0, 0, 1)
    assert hit["entering"] and hit["plane"] is None


def test_sphere_hit_aslant(precision):
    # The ray passes the centre at 3/5 of the radius, and meets the surface 4/5 of it before.
    hit = hit_of([((0, 0, 0), 5)], (-20, 3, 0), (1, 0, 0), precision)
    assert close(hit["t"], 16.0, precision, 20)
    assert close(hit["normal"], (-0.8, 0.6, 0.0), precision)


def test_sphere_seen_from_within(precision):
    hit = hit_of([((0, 0, 0), 5)], (1, 0, 0), (1, 0, 0), precision)
    assert close(hit["t"], 4.0, precision, 5)
    assert hit["normal"] == (1, 0, 0)
    assert not hit["entering"]


def test_sphere_behind_is_not_hit(precision):
    assert hit_of([((0, 0, 10), 2)], (0, 0, 0), (0, 0, -1), precision) is None


def test_small_sphere_far_away(precision):
    # The textbook discriminant b^2 - 4ac loses all digits of this one: Ray Tracing Gems, ch. 7.
    distance, radius = 4096.0, 2.0**-7
    hit = hit_of([((0, 0, -distance), radius)], (0, radius / 2, 0), (0, 0, -1), precision)
    assert close(hit["t"], distance - radius * math.sqrt(0.75), precision, distance)
    assert close(hit["normal"], (0.0, 0.5, math.sqrt(0.75)), precision, distance * 2**7)


def test_points_lie_on_the_sphere(precision):
    # The error along the normal does not grow with the distance that the ray came.
    scene = scene_of(((1, -2, 3), 1.5))
    for i in range(40):
        aim = (1 + 0.7 * math.sin(i), -2 + 0.7 * math.cos(i), 3 + 0.5 * math.sin(2 * i))
        eye = (900.0, 40.0 * i, -700.0)
        hit = trace_ray(scene, eye, tuple(a - e for a, e in zip(aim, eye, strict=True)), precision=precision)["hit"]
        distance = math.dist(hit["point"], (1, -2, 3))
        assert close(distance, 1.5, precision, 4)
        assert close(math.hypot(*hit["normal"]), 1.0, precision)


# ---- Polyhedra -------------------------------------------------------------------------------------------------------


BOX = box((-1, -2, -3), (1, 2, 3))


def test_box_from_outside(precision):
    hit = hit_of([BOX], (0, 0, 10), (0, 0, -1), precision)
    assert (hit["t"], hit["plane"], hit["normal"], hit["entering"]) == (7, 5, (0, 0, 1), True)


def test_box_hit_aslant(precision):
    hit = hit_of([BOX], (4, 0, 0), (-3, 1, 0.5), precision)
    assert hit["plane"] == 3
    assert close(hit["t"], math.sqrt(9 + 1 + 0.25), precision, 4)
    assert close(hit["point"], (1.0, 1.0, 0.5), precision, 4)


def test_box_from_within(precision):
    hit = hit_of([BOX], (0.5, 0, 0), (0, 1, 0), precision)
    assert (hit["t"], hit["plane"], hit["normal"], hit["entering"]) == (2, 4, (0, 1, 0), False)


def test_box_missed(precision):
    assert hit_of([BOX], (0, 5, 10), (0, 0, -1), precision) is None
    assert hit_of([BOX], (0, 0, 10), (0, 0, 1), precision) is None


def test_ray_along_a_face_outside_misses(precision):
    assert hit_of([BOX], (1.5, 0, 10), (0, 0, -1), precision) is None


def test_edge_belongs_to_the_lower_plane(precision):
    # Through the edge of x = 1 and z = 3 at 45 degrees, so that both planes are entered at the same t.
    hit = hit_of([BOX], (3, 0, 5), (-1, 0, -1), precision)
    assert hit["plane"] == 3
    hit = hit_of([BOX[::-1]], (3, 0, 5), (-1, 0, -1), precision)
    assert hit["plane"] == 0


def test_an_edge_belongs_to_the_lower_plane_whatever_is_rounded(precision):
    if precision == "float":
        pytest.skip("decides no ties")
    for i in range(50):
        x, y = round(0.1 + 0.07 * i, 2), round(0.3 + 0.11 * i, 2)
        edge = box((-1, -1, -1), (x, y, 1))
        hit = hit_of([edge], (round(x + 0.3, 2), round(y + 0.7, 2), 0), (-0.3, -0.7, 0), precision)
        assert (hit["plane"], hit["entering"]) == (3, True)
        hit = hit_of([edge], (round(x - 0.3, 2), round(y - 0.7, 2), 0), (0.3, 0.7, 0), precision)
        assert (hit["plane"], hit["entering"]) == (3, False)


def test_normals_of_any_length(precision):
    planes = [
        tuple(c * factor for c in plane) for plane, factor in zip(BOX, (1e-200, 1e200, 7, 1e-30, 1e30, 3), strict=True)
    ]
    hit = hit_of([planes], (0, 0, 10), (0, 0, -1), precision)
    assert hit["plane"] == 5
    assert close(hit["t"], 7.0, precision, 10)
    assert close(hit["normal"], (0.0, 0.0, 1.0), precision)


@pytest.mark.parametrize("count", range(1, 6))
def test_polyhedra_that_close_no_volume(precision, count):
    # Of a box's planes in the order z, x, y from above, then from below, the first few.
    planes = [BOX[i] for i in (5, 3, 4, 2, 0, 1)][:count]
    hit = hit_of([planes], (0.5, 0.5, 10), (0, 0, -1), precision)
    assert (hit["t"], hit["plane"], hit["entering"]) == (7, 0, True)
    # From within, downwards: open until the fourth plane closes it.
    hit = hit_of([planes], (0.5, 0.5, 0), (0, 0, -1), precision)
    assert (hit and (hit["t"], hit["plane"], hit["entering"])) == (None if count < 4 else (3, 3, False))


def test_polyhedron_of_2000_planes_is_nearly_a_sphere(precision):
    count, golden = 2000, math.pi * (3 - math.sqrt(5))
    planes = []
    for i in range(count):
        y = 1 - (2 * i + 1) / count
        r = math.sqrt(1 - y * y)
        planes.append((r * math.cos(golden * i), y, r * math.sin(golden * i), -1.0))
    scene = scene_of(planes)
    for i in range(20):
        direction = normalized((math.sin(3 * i), math.cos(5 * i), math.sin(7 * i + 1)))
        eye = tuple(-5 * c for c in direction)
        hit = trace_ray(scene, eye, direction, precision=precision)["hit"]
        # The planes touch the unit sphere, and no point of a face is farther than a tenth from where its plane does.
        assert 4 - 0.01 <= hit["t"] <= 4 + 8 * EPSILON[precision] * 5
        assert dot(hit["normal"], direction) < -0.99
        # Of all planes it is the one that the ray enters last.
        entered = max(
            -(dot(p[:3], eye) + p[3]) / dot(p[:3], direction) for p in planes if dot(p[:3], direction) < -1e-9
        )
        assert close(hit["t"], entered, precision, 10)


def test_of_equal_distances_the_first_object_counts(precision):
    ball, slab = ((0, 0, 0), 1.0), [(0, 0, 1, -1), (0, 0, -1, -1)]
    for shapes in ([ball, ball, slab], [slab, ball, ball]):
        assert hit_of(shapes, (0, 0, 5), (0, 0, -1), precision)["object"] == 0


# ---- Self-intersection -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("scale", [2.0**-40, 1.0, 2.0**40])
def test_a_plane_does_not_shade_itself(precision, scale):
    scene = new_scene()
    pigment, finish = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_polyhedron(pigment, finish, [(0.1, 1, 0.2, 0.3 * scale)])
    scene.add_light((3 * scale, 50 * scale, 2 * scale), WHITE, (1, 0, 0))
    scene.set_camera((7 * scale, scale, 11 * scale), (0, -0.5 * scale, 0), (0, 1, 0), 50)
    image = native_tracer.Image(48, 48)
    native_tracer.render(scene, image, cutoff=0, max_depth=0, precision=precision)
    lit = [pixel[0] > 0 for row in image.pixels.tolist() for pixel in row]
    statistics = image.statistics
    assert sum(lit) == statistics["shadow"] > 1000


@pytest.mark.parametrize("scale", [2.0**-40, 1.0, 2.0**40])
def test_touching_spheres_light_up_to_the_point_of_contact(precision, scale):
    # The light stands so that no ray to it from the left sphere's lit side passes the right one.
    scene = new_scene()
    pigment, finish = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_sphere(pigment, finish, (-scale, 0, 0), scale)
    scene.add_sphere(pigment, finish, (scale, 0, 0), scale)
    scene.add_light((-scale, 100 * scale, 0), WHITE, (1, 0, 0))
    for i in range(50):
        angle = math.radians(90 - 1.7 * i)
        point = (-scale + scale * math.cos(angle), scale * math.sin(angle), 0.0)
        eye = (point[0], point[1] + 0.3 * scale, 2 * scale)
        ray = trace_ray(scene, eye, (0, -0.3, -2), precision=precision)
        assert ray["hit"]["object"] == 0
        (light,) = ray["hit"]["lights"]
        assert (light["cosine"] > 0) == (light["diffuse"][0] > 0)


def test_faces_in_one_plane_neither_shade_nor_hide_each_other(precision):
    # Two slabs whose tops are one plane, written in two ways that are rounded apart; the second is the deeper one.
    for i in range(100):
        normal = normalized((math.sin(3 * i), 1.5, math.cos(5 * i)))
        height = 1 + i / 7

        def slab(factor, depth, normal=normal, height=height):
            top = tuple(factor * c for c in (*normal, -height))
            return [top, (*(-c for c in top[:3]), factor * (height - depth))]

        def above(up, x, z, normal=normal, height=height):
            aside = normalized((normal[1], -normal[0], 0.0))
            other = tuple(normal[j - 2] * aside[j - 1] - normal[j - 1] * aside[j - 2] for j in range(3))
            return tuple((height + up) * n + x * a + z * b for n, a, b in zip(normal, aside, other, strict=True))

        scene = new_scene()
        pigment, finish = scene.add_solid(WHITE), add_finish(scene, kd=1, kt=1)
        scene.add_polyhedron(pigment, finish, slab(1.0, 1.0))
        scene.add_polyhedron(pigment, finish, slab(3.0, 2.0))
        scene.add_light(above(2.0, 3.0, 1.0), WHITE, CONSTANT)
        eye, aim = above(2.0, -1.0, 0.5), above(0.0, 0.3, 0.2)
        ray = trace_ray(
            scene, eye, tuple(a - e for a, e in zip(aim, eye, strict=True)), precision=precision, max_depth=1
        )
        (within,) = ray["children"]
        assert ray["hit"]["plane"] == 0
        assert ray["hit"]["lights"][0]["diffuse"][0] > 0
        assert (within["hit"]["object"], within["hit"]["plane"]) == (0, 1)


def test_a_ball_that_begins_within_the_error_of_a_point_is_seen_from_within(precision):
    # The ray meets a floor where it meets a ball below.
    for i in range(100):
        eye, aim = (math.sin(i), 2.0, math.cos(i)), (math.sin(5 * i), 0.1, math.cos(3 * i))
        toward = normalized(tuple(a - e for a, e in zip(aim, eye, strict=True)))
        arm = normalized((toward[0] + 0.5 * math.sin(2 * i), toward[1], toward[2] + 0.5 * math.cos(2 * i)))
        center = tuple(a + 0.7 * c for a, c in zip(aim, arm, strict=True))
        scene = new_scene()
        pigment, clear = scene.add_solid(WHITE), add_finish(scene, kt=1)
        scene.add_polyhedron(pigment, clear, [(0, 1, 0, -0.1)])
        scene.add_sphere(pigment, clear, center, 0.7)
        (within,) = trace_ray(scene, eye, toward, precision=precision, max_depth=1)["children"]
        assert (within["hit"]["object"], within["hit"]["entering"]) == (1, False)
        assert close(within["hit"]["t"], 1.4 * dot(arm, toward), precision, 4, 4 * FEW)


def test_a_body_that_begins_within_the_error_of_the_eye_is_seen_from_within(precision):
    # The eye lies on the first body, and one unit in the last place above the second.
    slab = [(0, 1, 0, -math.nextafter(0.1, 0)), (0, -1, 0, -1)]
    hit = hit_of([[(0, 1, 0, -0.1)], slab], (0, 0.1, 0), (0, -1, 0), precision)
    assert (hit["object"], hit["plane"], hit["entering"]) == (1, 1, False)
    assert close(hit["t"], 1.1, precision, 2)


def test_a_ball_that_begins_within_the_error_of_the_eye_is_seen_from_within(precision):
    ball = ((0, math.nextafter(0.05, 0), 0), 0.05)
    hit = hit_of([[(0, 1, 0, -0.1)], ball], (0, 0.1, 0), (0, -1, 0), precision)
    assert (hit["object"], hit["entering"]) == (1, False)
    assert close(hit["t"], 0.1, precision)
