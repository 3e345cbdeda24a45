"""Cameras with an aperture: every ray written down once more, closed forms, and the same noise in both renderers."""

from dataclasses import replace
from math import acos, pi, sqrt

import numpy as np
import pytest
import sampler_specification as specification
from variant import VARIANT

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Checker, Finish, Light, Object, Polyhedron, Quadric, Scene, Solid, Sphere
from converter.scene.settings import Settings
from native_tracer.sampler import LENS

CAMERA = Camera((0.5, 2, -8), (0, 0.8, 0), (0.1, 1, 0), 40, aperture=0.4, focal=7)
GLASS = Finish(0, 0.1, 0.2, 30, 0.2, 0.7, 1.5)
TABLE = Scene(
    CAMERA,
    (0.2, 0.25, 0.3),
    (Light((3, 6, -4), (1, 1, 0.9), (1, 0, 0)),),
    (Checker((0.9, 0.9, 0.9), (0.1, 0.1, 0.2), 0.75), Solid((0.2, 0.5, 0.8))),
    (Finish(0.1, 0.7, 0.2, 20, 0.2, 0, 0), GLASS),
    (
        Object(0, 0, Polyhedron(((0, 1, 0, 0),))),
        Object(1, 1, Sphere((-1.5, 1, -3.5), 0.8)),
        Object(1, 0, Sphere((1.5, 1, 4), 1)),
        Object(0, 0, Quadric((1, 0.2, 1, 0, 0, 0, 0, 0, -3, 1.5))),
    ),
)
GLOW = Finish(1, 0, 0, 1, 0, 0, 0)
FEW = Settings(width=64, height=48, samples=4, seed=5)


def drawn(scene, settings=FEW, renderer=None):
    return np.asarray((renderer or NativeRenderer()).render(scene, settings).pixels).astype(float)


def with_lens(scene, aperture, focal=7.0):
    return replace(scene, camera=replace(scene.camera, aperture=aperture, focal=focal))


# ---- Every ray


def unit(v):
    return np.asarray(v) / np.linalg.norm(v)


@pytest.mark.parametrize(("aperture", "focal"), [(0.4, 7), (3, 0.5), (1e-3, 1e6), (1e160, 1e-3)])
@pytest.mark.parametrize("method", ["native", "native-long-double", "mitsuba-analytic"])
def test_every_ray_is_the_specifications(method, aperture, focal):
    renderer = METHODS[method].renderer(VARIANT)
    scene, pinhole = with_lens(TABLE, aperture, focal), with_lens(TABLE, 0.0)
    places = [(0, 0), (33, 24), (63, 5), (10, 40)]
    forward = unit(np.subtract(CAMERA.look_at, CAMERA.eye))
    right = unit(np.cross(forward, CAMERA.up))
    for record, plain in zip(
        renderer.trace_pixels(scene, FEW, places), renderer.trace_pixels(pinhole, FEW, places), strict=True
    ):
        for k, (ray, through_eye) in enumerate(zip(record.rays, plain.rays, strict=True)):
            (point,) = specification.disc_points(specification.sample_points(5, record.x, record.y, k, 1, LENS))
            x, y = point.astype(float) * aperture
            origin = CAMERA.eye + x * right + y * np.cross(right, forward)
            focus = CAMERA.eye + np.multiply(through_eye.direction, focal / np.dot(through_eye.direction, forward))
            assert ray.origin == pytest.approx(origin, rel=1e-12, abs=1e-12)
            way = focus - origin
            assert ray.direction == pytest.approx(
                way / np.abs(way).max() / np.linalg.norm(way / np.abs(way).max()), abs=1e-9
            )


# ---- Closed forms


def edge(distance, at):
    """Something bright on the right of x = `at`, seen from the origin along z, and black without end behind it."""
    bright = Object(1, 0, Polyhedron(((0, 0, -1, distance), (0, 0, 1, -distance - 1e-6), (-1, 0, 0, at))))
    return Scene(
        Camera((0, 0, 0), (0, 0, 1), (0, 1, 0), 1e-7, aperture=0.5, focal=10),
        (1, 1, 1),
        (),
        (Solid((0, 0, 0)), Solid((1, 1, 1))),
        (GLOW,),
        (bright,),
    )


def segment(at):
    """The part of the unit disc beyond a line at a distance from its centre."""
    return 0 if at >= 1 else 1 if at <= -1 else (acos(at) - at * sqrt(1 - at * at)) / pi


@pytest.mark.parametrize("distance", [2.0, 5.0, 9.0, 12.0, 40.0])
@pytest.mark.parametrize("part", [-1.05, -0.7, -0.2, 0.0, 0.5, 0.9, 1.05])
def test_the_circle_of_confusion(distance, part):
    """Of an edge before and behind what is in focus: the radius is aperture |distance / focal - 1|."""
    radius = 0.5 * abs(distance / 10 - 1)
    settings = Settings(width=24, height=16, samples=64, background=(0, 0, 0))
    pixels = drawn(edge(distance, part * radius), settings)[..., 0]
    expected = segment(part)
    assert pixels.mean() == pytest.approx(expected, abs=5 * pixels.std() / sqrt(pixels.size) + 1e-4)
    gain = 2 if abs(part) <= 0.75 else 1  # over independent points
    assert pixels.std() <= sqrt(expected * (1 - expected) / 64) / gain + 1e-4


def test_what_is_in_focus_is_sharp():
    """A wall across the view at the focal distance is what a pinhole shows, whatever the aperture."""
    wall = Object(0, 0, Polyhedron(((0, 0, -1, 10),)))
    board = Checker((1, 1, 1), (0, 0.2, 0.4), 0.7)
    camera = Camera((0.1, 0.2, 0), (0.1, 0.2, 1), (0, 1, 0), 40, focal=10)
    scene = Scene(camera, (1, 1, 1), (), (board,), (GLOW,), (wall,))
    sharp = drawn(replace(scene, camera=replace(camera, aperture=0)))
    for aperture in (0.01, 1.0, 100.0):
        assert (np.abs(drawn(replace(scene, camera=replace(camera, aperture=aperture))) - sharp) < 1e-6).all()
    assert np.abs(drawn(replace(scene, camera=replace(camera, aperture=1, focal=9))) - sharp).max() > 0.2


# ---- Whatever draws it


@pytest.mark.parametrize("samples", [1, 16])
@pytest.mark.parametrize("method", ["mitsuba-analytic", "mitsuba-bvh", "mitsuba-mesh"])
def test_both_renderers_draw_the_same_noise(method, samples):
    settings = replace(FEW, samples=samples)
    scene = TABLE
    if method == "mitsuba-mesh":  # it has no horizon, and the outlines of its quadrics are a little off
        sides = ((1, 0, 0, -20), (-1, 0, 0, -20), (0, 0, 1, -20), (0, 0, -1, -20), (0, -1, 0, -1))
        floor = Polyhedron(((0, 1, 0, 0), *sides))
        scene = replace(TABLE, objects=(Object(0, 0, floor), *TABLE.objects[1:-1]))
    native, mitsuba = (METHODS[name].renderer(VARIANT) for name in ("native", method))
    difference = np.abs(drawn(scene, settings, native) - drawn(scene, settings, mitsuba)).max(axis=2)
    assert (difference > LIMIT).sum() == 0
    assert np.median(difference) < 1e-6


@pytest.mark.parametrize("aperture", [0.4, 4.0, 40.0])
def test_culling_from_the_eye_reckons_with_the_lens(aperture):
    """Brute force looks only at what lines through the lens may meet."""
    scene = with_lens(TABLE, aperture)
    assert drawn(scene).tobytes() == drawn(scene, renderer=NativeRenderer(search="bvh")).tobytes()
    assert drawn(scene).tobytes() == drawn(scene, renderer=NativeRenderer(search="brute")).tobytes()
    assert np.abs(drawn(scene) - drawn(scene, renderer=NativeRenderer("long double"))).max() < 1e-5


@pytest.mark.parametrize("method", ["native", "mitsuba-analytic"])
def test_an_eye_on_a_ball_with_a_lens_lies_on_nothing(method):
    """Half its lens is inside the ball, whose own side is seen from there."""
    ball = Object(1, 0, Sphere((0, 0, 0), 1))
    scene = replace(
        TABLE,
        camera=Camera((0, 0, -1), (0, 1, -1), (0, 0, -1), 40, aperture=0.5, focal=3),
        finishes=(GLOW, GLASS),
        objects=(ball,),
    )
    settings = replace(FEW, samples=16, background=(0, 0, 0))
    found, exact = (drawn(scene, settings, METHODS[name].renderer(VARIANT)) for name in (method, "native-long-double"))
    assert np.abs(found - exact).max() < LIMIT
    assert 0 < exact[..., 2].mean() < 0.3


@pytest.mark.parametrize("method", ["native", "mitsuba-bvh"])
def test_a_pixels_rays_have_its_colour(method):
    renderer = METHODS[method].renderer(VARIANT)
    pixels = drawn(TABLE, renderer=renderer)
    places = [(20, 20), (33, 24), (45, 30)]
    for record, (x, y) in zip(renderer.trace_pixels(TABLE, FEW, places), places, strict=True):
        assert record.color == pytest.approx(pixels[y, x], abs=1e-6)


@pytest.mark.parametrize("method", ["native", "mitsuba"])
def test_an_aperture_of_0_is_a_pinhole_to_the_last_bit(method):
    renderer = METHODS[method].renderer(VARIANT)
    plain = replace(TABLE, camera=Camera(*(getattr(CAMERA, name) for name in ("eye", "look_at", "up", "fovy"))))
    picture = drawn(plain, renderer=renderer)
    assert drawn(with_lens(TABLE, 0.0), replace(FEW, seed=9), renderer).tobytes() == picture.tobytes()
    assert np.quantile(np.abs(drawn(with_lens(TABLE, 1e-9), renderer=renderer) - picture), 0.99) < 1e-6
