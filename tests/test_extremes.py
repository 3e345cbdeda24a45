"""Where roundings leave nothing of a number, both renderers draw the same, and no pixel is without one."""

import math
from dataclasses import replace

import numpy as np
import pytest

from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Finish
from converter.scene.settings import Settings
from converter.studies.families.scenes import BLACK, GLASS, MIRROR, WHITE, camera, light, scene, sphere

SETTINGS = Settings(width=2, height=2, background=BLACK, max_depth=4)
"""The ray of the last pixel runs along the camera's axis."""
GLOSSY = Finish(0.2, 0.5, 0.3, 20.0, 0.5, 0.0, 0.0)
LIT_FROM_THE_EYE = GLOSSY.ka + GLOSSY.kd + GLOSSY.ks
FAR = 1e18
MIDDLE = (0.0, 0.0, 0.0)


def middle_of(renderer, made):
    return np.asarray(renderer.render(made, SETTINGS).pixels)[1, 1]


@pytest.fixture(params=["float", "double", "long double", "analytic", "bvh"])
def renderer(request, mi):
    """The native tracer in each precision, and the ways in which Mitsuba intersects exact surfaces."""
    if request.param in ("analytic", "bvh"):
        return MitsubaRenderer(mi.variant(), request.param)
    return NativeRenderer(request.param)


@pytest.fixture(params=["native", "mitsuba"])
def double(request, mi):
    """Either renderer in double precision."""
    return NativeRenderer() if request.param == "native" else MitsubaRenderer(mi.variant(), "analytic")


# ---- Hits that are rounded to the centre of a ball ------------------------------------------------------------------


def far_ball(finish=GLOSSY, light_at=FAR):
    """A ball, seen from so far away that a point on it is its centre."""
    eye = (0.0, 0.0, FAR)
    return scene(camera(eye, MIDDLE), [(sphere(MIDDLE, 1.0), WHITE, finish)], [light((0.0, 0.0, light_at))])


def test_a_far_ball_is_seen_from_the_front(renderer):
    assert middle_of(renderer, far_ball()) == pytest.approx([LIT_FROM_THE_EYE] * 3, abs=1e-6)


def test_a_far_ball_has_a_back(renderer):
    assert middle_of(renderer, far_ball(light_at=-FAR)) == pytest.approx([GLOSSY.ka] * 3, abs=1e-6)


def test_rays_go_straight_through_the_middle_of_a_far_glass_ball(double):
    (primary,) = double.trace_pixel(far_ball(GLASS), SETTINGS, 1, 1).rays
    (within,) = primary.children
    (behind,) = within.children
    assert [ray.direction for ray in (primary, within, behind)] == [(0.0, 0.0, -1.0)] * 3
    assert [ray.hit.normal for ray in (primary, within)] == [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    assert [ray.hit.entering for ray in (primary, within)] == [True, False]


def test_the_inside_of_a_far_ball_faces_the_eye(double):
    at = (0.0, 0.0, FAR)
    view = Camera(at, MIDDLE, (0.0, 1.0, 0.0), 40.0)
    made = scene(view, [(sphere(at, 1.0), WHITE, GLOSSY)], [light((0.0, 0.0, 2 * FAR))])
    (ray,) = double.trace_pixel(made, SETTINGS, 1, 1).rays
    assert ray.hit.normal == (0.0, 0.0, -1.0)
    assert not ray.hit.entering


def test_a_ball_in_a_mirror_that_is_far_away(renderer):
    """The mirror shows the ball to itself, twice in five hits."""
    bodies = [(sphere(MIDDLE, 1.0), WHITE, GLOSSY), (sphere(MIDDLE, FAR), BLACK, MIRROR)]
    made = scene(camera((0.0, 0.0, 5.0), MIDDLE), bodies, [light((0.0, 0.0, 5.0))])
    three_times = LIT_FROM_THE_EYE * (1 + GLOSSY.kr + GLOSSY.kr**2)
    assert middle_of(renderer, made) == pytest.approx([three_times] * 3, abs=1e-6)


def test_a_light_at_the_hit_gives_no_light(renderer):
    """It has no direction: here the point of the surface is rounded to the ball's centre, where the light is."""
    at = (0.0, 0.0, 1e20)
    made = scene(Camera(at, MIDDLE, (0.0, 1.0, 0.0), 40.0), [(sphere(at, 1.0), WHITE, GLOSSY)], [light(at)])
    made = replace(made, finishes=(replace(GLOSSY, kr=0.0),))
    assert middle_of(renderer, made) == pytest.approx([GLOSSY.ka] * 3)


# ---- Directions ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ior", [1e-40, 1e-162, 1e-300])
def test_no_refraction_is_without_direction(double, ior):
    """Rays that leave something so much denser are reflected, be they straight or slanted."""
    for y in (0.0, 0.5):
        view = camera((0.0, y, 5.0), (0.0, y, 0.0))
        made = scene(view, [(sphere(MIDDLE, 1.0), WHITE, replace(GLASS, ior=ior))])
        (ray,) = double.trace_pixel(made, SETTINGS, 1, 1).rays
        (within,) = ray.children
        assert within.hit.total_reflection
        while ray.children:
            (ray,) = ray.children
            assert math.hypot(*ray.direction) == pytest.approx(1)


def test_a_view_across_all_numbers(double):
    ends = (1.7e308, 1.7e308, 1.7e308), (-1.7e308, -1.7e308, -1.7e308)
    made = scene(camera(*ends), [(sphere(MIDDLE, 1.0), WHITE, GLOSSY)])
    (ray,) = double.trace_pixel(made, SETTINGS, 1, 1).rays
    assert ray.direction == pytest.approx([-1 / math.sqrt(3)] * 3)
