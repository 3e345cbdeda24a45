"""Finishes with a cone: every direction written down once more, and the same noise in both renderers."""

from dataclasses import replace
from math import cos, radians

import numpy as np
import pytest
import sampler_specification as specification
from variant import VARIANT

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Quadric, Scene, Solid, Sphere
from converter.scene.settings import Settings
from native_tracer.sampler import MIRRORED_CONE, REFRACTED_CONE

GROUND = Finish(0.1, 0.7, 0.2, 20, 0.2, 0, 0, cone=15)
METAL = Finish(0, 0.1, 0.4, 50, 0.8, 0, 0, cone=6)
FROSTED = Finish(0, 0.1, 0.2, 30, 0.2, 0.7, 1.5, cone=9)
CLEAR = Finish(0, 0, 0.2, 30, 0, 0.9, 1.5)
PANE = Polyhedron(((0, 0, 1, 2.5), (0, 0, -1, -2.8), (1, 0, 0, -1), (-1, 0, 0, -1), (0, 1, 0, -2), (0, -1, 0, 0.1)))
ROOM = Scene(
    Camera((0.5, 2.5, -8), (0, 0.8, 0), (0.1, 1, 0), 40),
    (0.2, 0.25, 0.3),
    (Light((3, 6, -4), (1, 1, 0.9), (1, 0, 0)),),
    (Solid((0.9, 0.8, 0.7)), Solid((0.2, 0.5, 0.8))),
    (GROUND, METAL, FROSTED, CLEAR),
    (
        Object(0, 0, Polyhedron(((0, 1, 0, 0),))),
        Object(1, 1, Sphere((-1.5, 1, 0.5), 1)),
        Object(0, 3, Sphere((1.5, 1, -1), 0.9)),
        Object(1, 2, PANE),
        Object(0, 1, Quadric((1, 0.2, 1, 0, 0, 0, -5, 0, -3, 8.0))),
    ),
)
FEW = Settings(width=64, height=48, samples=4, seed=5)


def drawn(scene, settings=FEW, renderer=None):
    return np.asarray((renderer or NativeRenderer()).render(scene, settings).pixels).astype(float)


def with_cones(scene, cone):
    return replace(scene, finishes=tuple(replace(finish, cone=cone) for finish in scene.finishes))


# ---- Every direction


def successors(record, path=1):
    """Rays of a tree, each with its parent and the parent's path."""
    for child in record.children:
        yield child, record, path
        yield from successors(child, 2 * path + (child.kind == "transmitted"))


def mirrored(direction, normal):
    return direction - 2 * np.dot(direction, normal) * normal


def refracted(direction, normal, ratio):
    """Snell's law; the mirror direction where it has no answer."""
    cosine = -np.dot(direction, normal)
    squared = 1 - ratio**2 * (1 - cosine**2)
    if squared < 0:
        return mirrored(direction, normal)
    return ratio * direction + (ratio * cosine - np.sqrt(squared)) * normal


@pytest.mark.parametrize("cone", [0.0, 9.0, 60.0, 90.0])
@pytest.mark.parametrize("method", ["native", "native-long-double", "mitsuba-analytic", "mitsuba-bvh"])
def test_every_direction_is_the_specifications(method, cone):
    scene = with_cones(ROOM, cone)
    renderer = METHODS[method].renderer(VARIANT)
    kinds = dict.fromkeys(("mirrored", "turned", "through"), 0)
    places = [(20, 20), (33, 24), (40, 25), (45, 30), (10, 40)]
    for record in renderer.trace_pixels(scene, FEW, places):
        for number, primary in enumerate(record.rays):
            for child, parent, path in successors(primary):
                direction, normal = np.array(parent.direction), np.array(parent.hit.normal)
                facing = normal if parent.hit.entering else -normal
                through = child.kind == "transmitted"
                ratio = 1 / 1.5 if parent.hit.entering else 1.5
                axis = refracted(direction, facing, ratio) if through else mirrored(direction, facing)
                use = REFRACTED_CONE if through else MIRRORED_CONE
                point = specification.sample_points(FEW.seed, record.x, record.y, number, path, use)
                if cone > 0:
                    (expected,) = specification.cone_directions(axis[None], [1 - cos(radians(cone))], point)
                else:
                    expected = axis
                side = facing if np.dot(axis, facing) > 0 else -facing
                turned = np.dot(expected, side) < 0
                expected = mirrored(expected, side) if turned else expected
                assert np.array(child.direction) == pytest.approx(expected.astype(float), abs=1e-9)
                kinds["through" if through else "turned" if turned else "mirrored"] += 1
    assert kinds["mirrored"] > 30
    assert kinds["through"] > 30
    assert kinds["turned"] > 10 or cone < 60


# ---- Whatever draws it


@pytest.mark.parametrize("samples", [1, 16])
@pytest.mark.parametrize("method", ["mitsuba-analytic", "mitsuba-bvh", "mitsuba-mesh"])
def test_both_renderers_draw_the_same_noise(method, samples):
    settings = replace(FEW, samples=samples)
    scene = ROOM
    if method == "mitsuba-mesh":  # it has no horizon, and the outlines of its quadrics are a little off
        sides = ((1, 0, 0, -20), (-1, 0, 0, -20), (0, 0, 1, -20), (0, 0, -1, -20), (0, -1, 0, -1))
        floor = Polyhedron(((0, 1, 0, 0), *sides))
        scene = replace(ROOM, objects=(Object(0, 0, floor), *ROOM.objects[1:-1]))
    native, mitsuba = (METHODS[name].renderer(VARIANT) for name in ("native", method))
    difference = np.abs(drawn(scene, settings, native) - drawn(scene, settings, mitsuba)).max(axis=2)
    assert (difference > LIMIT).sum() == 0
    assert np.median(difference) < 1e-6


@pytest.mark.parametrize("left", [(METAL,), (CLEAR, FROSTED)])
@pytest.mark.parametrize("kept", ["mirrored", "transmitted", "either"])
def test_each_loop_of_the_integrator_draws_it(kept, left):
    """Rays that are only mirrored, only transmitted, or one of them at each surface."""
    finishes = [
        replace(finish, kr=0.0 if kept == "transmitted" or (kept == "either" and finish.kt) else finish.kr)
        for finish in ROOM.finishes
    ]
    finishes = [replace(finish, kt=0.0 if kept == "mirrored" else finish.kt) for finish in finishes]
    scene = replace(ROOM, finishes=tuple(finishes))
    found = METHODS["mitsuba"].renderer(VARIANT)
    assert np.abs(drawn(scene) - drawn(scene, renderer=found)).max() < LIMIT


def test_nothing_depends_on_threads_or_search():
    first = drawn(ROOM).tobytes()
    assert drawn(ROOM, replace(FEW, threads=1)).tobytes() == first
    assert drawn(ROOM, renderer=NativeRenderer(search="bvh")).tobytes() == first
    assert drawn(ROOM, replace(FEW, seed=6)).tobytes() != first
    exact = drawn(ROOM, renderer=NativeRenderer("long double"))
    assert np.abs(exact - drawn(ROOM)).max() < 1e-5


@pytest.mark.parametrize("method", ["native", "mitsuba-analytic"])
def test_a_pixels_rays_have_its_colour(method):
    renderer = METHODS[method].renderer(VARIANT)
    pixels = drawn(ROOM, renderer=renderer)
    places = [(20, 20), (33, 24), (45, 30)]
    for record, (x, y) in zip(renderer.trace_pixels(ROOM, FEW, places), places, strict=True):
        assert record.color == pytest.approx(pixels[y, x], abs=1e-6)


@pytest.mark.parametrize("method", ["native", "mitsuba"])
def test_a_cone_of_0_is_a_mirror_to_the_last_bit(method):
    """Beside others that have one, too; and a cone that is nearly none gives nearly the same."""
    renderer = METHODS[method].renderer(VARIANT)
    plain = with_cones(ROOM, 0.0)
    picture = drawn(plain, renderer=renderer)
    elsewhere = replace(
        plain, finishes=(*plain.finishes, METAL), objects=(*plain.objects, Object(0, 4, Sphere((0, 1, -90), 1)))
    )
    assert drawn(elsewhere, renderer=renderer).tobytes() == picture.tobytes()
    assert np.quantile(np.abs(drawn(with_cones(ROOM, 1e-7), renderer=renderer) - picture), 0.99) < 1e-4


# ---- Closed forms


@pytest.mark.parametrize("cone", [1.0, 20.0, 60.0, 90.0])
def test_a_mirror_under_a_sky_that_is_bright_on_one_side(cone):
    """Half of it, by symmetry, with fewer samples than independent points need."""
    floor = Object(0, 0, Polyhedron(((0, 1, 0, 0),)))
    wall = Object(1, 1, Polyhedron(((1, 0, 0, 0), (0, -1, 0, 100))))  # x < 0, above
    scene = replace(
        ROOM,
        camera=Camera((0, 5, 0), (0, 0, 0), (0, 0, 1), 1e-4),
        ambient=(1, 1, 1),
        finishes=(replace(METAL, kr=1, kd=0, ks=0, cone=cone), Finish(1, 0, 0, 1, 0, 0, 0)),
        pigments=(Solid((0, 0, 0)), Solid((1, 1, 1))),
        objects=(floor, wall),
    )
    pixels = drawn(scene, replace(FEW, samples=64, background=(0, 0, 0)))[..., 0]
    if cone == 90.0:  # at the height of 100 the last rays pass between floor and wall, as many on either side
        assert pixels.mean() == pytest.approx(0.5, abs=0.01)
    else:
        assert pixels.mean() == pytest.approx(0.5, abs=5 * pixels.std() / pixels.size**0.5 + 1e-6)
    assert pixels.std() < 0.5 / 8 / 2  # half of independent points'


@pytest.mark.parametrize("tilt", [30.0, 70.0, 85.0])
def test_near_the_tangent_plane_all_directions_stay_above_it(tilt):
    """Seen at grazing angles in a mirror floor there is never anything below: the ball under it."""
    floor = Object(0, 0, Polyhedron(((0, 1, 0, 0), (0, -1, 0, -0.1))))
    below = Object(1, 1, Polyhedron(((0, 1, 0, 5),)))
    angle = radians(tilt)
    scene = replace(
        ROOM,
        camera=Camera((0, 5 * cos(angle), -5 * np.sin(angle)), (0, 0, 0), (0, 1, 0), 1e-4),
        ambient=(1, 1, 1),
        finishes=(replace(METAL, kr=1, kd=0, ks=0, cone=80), Finish(1, 0, 0, 1, 0, 0, 0)),
        pigments=(Solid((0, 0, 0)), Solid((1, 0, 0))),
        objects=(floor, below),
    )
    pixels = drawn(scene, replace(FEW, background=(0, 1, 0)))
    assert (pixels[..., 0] == 0).all()
    assert (pixels[..., 1] == 1).all()


def test_the_part_of_a_cone_that_a_ball_covers():
    """A ball on the cone's axis: the share of solid angles, (1 - cos b) / (1 - cos a)."""
    floor = Object(0, 0, Polyhedron(((0, 1, 0, 0),)))
    for cone, half in ((30.0, 10.0), (90.0, 40.0), (20.0, 19.0)):
        radius = 10 * np.sin(radians(half))
        ball = Object(1, 1, Sphere((0, 10, 0), radius))
        scene = replace(
            ROOM,
            camera=Camera((1e-9, 2, 0), (0, 0, 0), (0, 0, 1), 1e-4),
            ambient=(1, 1, 1),
            finishes=(replace(METAL, kr=1, kd=0, ks=0, cone=cone), Finish(1, 0, 0, 1, 0, 0, 0)),
            pigments=(Solid((0, 0, 0)), Solid((1, 1, 1))),
            objects=(floor, ball),
        )
        pixels = drawn(scene, replace(FEW, samples=64, background=(0, 0, 0)))[..., 0]
        expected = (1 - cos(radians(half))) / (1 - cos(radians(cone)))
        assert pixels.mean() == pytest.approx(expected, abs=5 * pixels.std() / pixels.size**0.5 + 1e-6)
        assert pixels.std() < (expected * (1 - expected)) ** 0.5 / 8
