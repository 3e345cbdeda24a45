"""Distributed ray tracing as a whole: effects together, how fast noise falls, and pictures compared by their noise."""

from dataclasses import replace
from functools import cache
from math import acos, cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from test_soft_shadows import shadow_of_half_space
from variant import VARIANT
from welch import sidak, student_tails, uniform, welch

from converter.renderers.methods import find_method
from converter.scene.model import Camera, Checker, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere
from converter.scene.settings import Settings

BLACK, WHITE = Solid((0, 0, 0)), Solid((1, 1, 1))
GLOW = Finish(1, 0, 0, 1, 0, 0, 0)
MATTE = Finish(0, 1, 0, 1, 0, 0, 0)
NIGHT = Settings(width=24, height=16, samples=64, background=(0, 0, 0))


def drawn(scene, settings, method="native"):
    method = find_method(method)
    return np.asarray(method.renderer(VARIANT).render(scene, method.settings(settings)).pixels).astype(float)


def same_in_both(scene, settings=NIGHT):
    """That Mitsuba draws the native tracer's noise."""
    few = replace(settings, width=12, height=8, samples=4)
    assert np.abs(drawn(scene, few) - drawn(scene, few, "mitsuba-bvh")).max() < 1e-6


def same_mean(pixels, expected):
    """Whether pixels that estimate a number have it as their mean, by five deviations of the mean."""
    assert abs(pixels.mean() - expected) <= 5 * pixels.std(ddof=1) / sqrt(pixels.size) + 1e-6


# ---- Cones before what is bright on one side of a plane


def beyond(distance, half_angle):
    """The share of a cone, in solid angle, beyond a plane through its apex, that far from its axis (in radians)."""
    if abs(distance) >= half_angle:
        return 0.0 if distance > 0 else 1.0
    if distance < 0:
        return 1 - beyond(-distance, half_angle)
    cap = acos(sin(distance) / sin(half_angle)) - cos(half_angle) * acos(tan(distance) / tan(half_angle))
    return cap / (pi * (1 - cos(half_angle)))


SURFACES = {
    "mirrored": Finish(0, 0, 0, 1, 1, 0, 0),
    "refracted": Finish(0, 0, 0, 1, 0, 1, 1.5),
    "straight through": Finish(0, 0, 0, 1, 0, 1, 1.0),
}


def half_bright(way, height, cone):
    """What is seen in a floor, `height` degrees above it: bright up to the plane through the place that is seen and
    a line beyond it, 0.4 cones above the axis. And how bright that is.
    """
    glance = radians(height)
    camera = Camera((0, 5 * sin(glance), -5 * cos(glance)), (0, 0, 0), (0, 1, 0.01), 1e-5)
    axis = acos(cos(glance) / 1.5) if way == "refracted" else glance
    side = 1 if way == "mirrored" else -1
    edge = min(axis + 0.4 * radians(cone), radians(89.9))
    bright = Object(1, 1, Polyhedron(((0, side * cos(edge), -sin(edge), 0), (0, 0, -1, 1))))
    floor = Object(0, 0, Polyhedron(((0, 1, 0, 0),)))
    finishes = (replace(SURFACES[way], cone=cone), GLOW)
    # What would leave through the floor is mirrored, and meets what is bright there, too.
    dark = beyond(edge - axis, radians(cone)) + beyond(edge + axis, radians(cone))
    return Scene(camera, (1, 1, 1), (), (BLACK, WHITE), finishes, (floor, bright)), 1 - dark


@pytest.mark.parametrize("cone", [0.5, 10.0, 30.0, 60.0])
@pytest.mark.parametrize("height", [90.0, 55.0, 12.0, 3.0])
@pytest.mark.parametrize("way", SURFACES)
def test_a_cone_before_a_sky_that_is_bright_up_to_a_height(way, height, cone):
    scene, expected = half_bright(way, height, cone)
    pixels = drawn(scene, NIGHT)[..., 0]
    same_mean(pixels, expected)
    assert pixels.std() <= sqrt(expected * (1 - expected) / 64) / 1.5 + 1e-4
    if cone == 60:
        same_in_both(scene)


# ---- All four


def all_four(cone=0.01, part=0.3, time=0.37):
    """A pixel that a lens, a shutter, a cone and a lamp each leave a part of, and what these parts are.

    A half-plane before a mirror covers a part of the lens; a plate closes the way up from there after a time; the
    mirror's cone meets a wall, or passes it; and another half-plane covers a part of the lamp that lights the wall.
    """
    camera = Camera((0, 0, 0), (0, 0, 1), (0, 1, 0), 1e-7, aperture=1e-5, focal=10)
    edge = 20 * tan(0.4 * radians(cone))
    objects = (
        Object(0, 0, Polyhedron(((-1, 0, 0, part * 0.5e-5), (0, 0, -1, 5), (0, 0, 1, -5.00001)))),
        Object(0, 1, Polyhedron(((0, 1, -1, 10),))),
        Object(0, 0, Polyhedron(((-1, 0, 0, 100 * time), (0, -1, 0, 2), (0, 1, 0, -2.001))), move=(-100, 0, 0)),
        Object(1, 2, Polyhedron(((0, -1, 0, 20), (1, 0, 0, -edge)))),
        Object(0, 0, Polyhedron(((-1, 0, 0, part * 0.125), (0, -1, 0, 15), (0, 1, 0, -15.00001)))),
    )
    lamp = Light((0, 10, 10), (1, 1, 1), (1, 0, 0), radius=0.25)
    finishes = (GLOW, Finish(0, 0, 0, 1, 1, 0, 0, cone=cone), MATTE)
    parts = {
        "lens": shadow_of_half_space(part),
        "shutter": time,
        "cone": 1 - beyond(0.4 * radians(cone), radians(cone)),
        "lamp": shadow_of_half_space(part) * (1 - 0.25**2 / 400),
    }
    return Scene(camera, (1, 1, 1), (lamp,), (BLACK, WHITE), finishes, objects), parts


def without(scene, effects):
    """The scene with none of these effects' bodies in the way, in whose place all is seen."""
    lens, mirror, shutter, wall, shade = scene.objects
    kept = [lens] * ("lens" not in effects) + [mirror] + [shutter] * ("shutter" not in effects)
    wall = replace(wall, shape=Polyhedron(wall.shape.planes[:1])) if "cone" in effects else wall
    return replace(scene, objects=(*kept, wall, *([shade] * ("lamp" not in effects))))


@pytest.mark.parametrize(
    "left", ["lens", "shutter", "cone", "lamp", "lens lamp", "cone lamp", "lens shutter cone", "lens shutter cone lamp"]
)
def test_effects_that_have_nothing_to_do_with_each_other_multiply(left):
    scene, parts = all_four()
    expected = np.prod([part for name, part in parts.items() if name in left.split()])
    scene = without(scene, set(parts) - set(left.split()))
    pixels = drawn(scene, NIGHT)[..., 0]
    same_mean(pixels, expected)
    same_in_both(scene)


# ---- How fast noise falls

SHADOW = Scene(
    Camera((0, 2, 0), (0, 0, 0), (0, 0, 1), 40),
    (0, 0, 0),
    (Light((0, 8, 0), (1, 1, 1), (1, 0, 0), radius=1.5),),
    (WHITE,),
    (MATTE,),
    (Object(0, 0, Polyhedron(((0, 1, 0, 0),))), Object(0, 0, Sphere((0.5, 4, 0), 0.6))),
)
BLUR = Scene(
    Camera((0.1, 0.2, 0), (0.1, 0.2, 1), (0, 1, 0), 20, aperture=0.2, focal=10),
    (1, 1, 1),
    (),
    (Checker((1, 1, 1), (0, 0, 0), 0.3),),
    (GLOW,),
    (Object(0, 0, Polyhedron(((0, 0, -1, 4),))),),
)
FROSTED = Scene(
    Camera((0, 3, -6), (0, 0, 0), (0, 1, 0), 20),
    (1, 1, 1),
    (),
    (BLACK, Checker((1, 1, 1), (0, 0, 0), 4)),
    (Finish(0, 0, 0, 1, 1, 0, 0, cone=8), GLOW),
    (Object(0, 0, Polyhedron(((0, 1, 0, 0),))), Object(1, 1, Polyhedron(((0, 0, -1, 6),)))),
)
PASSING = Scene(
    Camera((0, 0, -10), (0, 0, 0), (0, 1, 0), 20),
    (1, 1, 1),
    (),
    (WHITE,),
    (GLOW,),
    (Object(0, 0, Sphere((-2, 0, 0), 1.2), move=(4, 0.5, 0)),),
)


@pytest.mark.parametrize("scene", [SHADOW, BLUR, FROSTED, PASSING], ids=["lamp", "lens", "cone", "shutter"])
def test_at_64_samples_the_error_is_at_most_half_of_that_of_independent_points(scene):
    settings = Settings(width=32, height=24, samples=64, background=(0, 0, 0))
    truth = drawn(scene, replace(settings, samples=4096, seed=1))
    stratified, independent = (
        sqrt(np.square(drawn(scene, settings, method) - truth).mean())
        for method in ("native", "native:points=independent")
    )
    assert independent > 0.005
    assert stratified <= independent / 2


# ---- Compared by their noise

FEW = Settings(width=20, height=15, samples=16, background=(0, 0, 0))
SETS = 16
"""Pictures of a set, each with a seed of its own."""


@cache
def pictures(first, scene=SHADOW, method="native"):
    """(SETS, pixels) of a scene with seeds from `first` on."""
    return np.stack([drawn(scene, replace(FEW, seed=first + k), method)[..., 0].ravel() for k in range(SETS)])


@pytest.mark.parametrize("other", ["native", "mitsuba-bvh", "native-float", "native:points=independent"])
def test_pictures_of_other_seeds_and_renderers_have_the_same_means(other):
    p = welch(pictures(0), pictures(1000, method=other))
    assert len(p) > 200
    assert p.min() > sidak(1e-3, len(p))
    assert uniform(p) > 1e-3


@pytest.mark.parametrize("radius", [1.35, 1.65])
def test_a_lamp_that_is_a_tenth_too_large_or_too_small_is_found(radius):
    other = replace(SHADOW, lights=(replace(SHADOW.lights[0], radius=radius),))
    p = welch(pictures(0), pictures(1000, other))
    assert p.min() < sidak(1e-3, len(p))
    assert uniform(p) < 1e-3


def test_the_least_p_value_alone_finds_a_pixel_that_is_wrong():
    wrong = pictures(1000).copy()
    deviations = wrong.std(axis=0)
    wrong[:, 150] += 3 * deviations[150]
    p = welch(pictures(0), wrong)
    assert p.min() < sidak(1e-3, len(p))
    assert uniform(p) > 1e-3


def test_students_tails_are_those_of_the_tables():
    t, freedom = np.array([[12.706, 1], [2.228139, 10], [2.845340, 20], [1.959968, 1e6]]).T
    assert student_tails(t, freedom) == pytest.approx([0.05, 0.05, 0.01, 0.05], rel=1e-4)
    assert student_tails(np.zeros(1), np.ones(1)) == pytest.approx([1])
