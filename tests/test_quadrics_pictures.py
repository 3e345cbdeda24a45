"""Pictures of every kind of quadric: those of the renderers, of POV-Ray, and of the tracer without rounding."""

import shutil
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from quadrics import SURFACES, quadric, scene_with

from converter.errors import ExportError
from converter.renderers import povray
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.renderers.povray import PovrayRenderer
from converter.scene.geometry import simplified
from converter.scene.model import Object, Quadric
from converter.scene.parser import parse_scene
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind
from converter.studies.exact.tracer import exact_picture
from converter.to_povray.scale import scaled
from converter.to_povray.scene import povray_scene

SMALL = Settings(width=32, height=24, cutoff=1 / 64)
LARGE = Settings(width=200, height=150)
needs_povray = pytest.mark.skipif(
    shutil.which(povray.PROGRAM) is None, reason="POV-Ray is not installed (Debian, Ubuntu: apt install povray)"
)
every_kind = pytest.mark.parametrize("name", SURFACES)
opaque_or_glass = pytest.mark.parametrize("glass", [False, True], ids=["opaque", "glass"])


def disagreeing(one, other) -> int:
    """Pixels that differ by more than a level."""
    return int((np.abs(np.asarray(one, np.float64) - np.asarray(other, np.float64)) > 1 / 255).any(axis=2).sum())


@cache
def truth_of(name, settings, glass):
    """The scene with a kind of quadric, without rounding."""
    return exact_picture(parse_scene(scene_with(SURFACES[name], glass)), settings)


def shallow(settings: Settings) -> Settings:
    """For glass without bounds: rays go far away in it, where a double does not tell its tiles apart."""
    return replace(settings, max_depth=2)


@needs_povray
@every_kind
def test_povray_draws_what_is_true(name):
    scene = parse_scene(scene_with(SURFACES[name]))
    truth = truth_of(name, SMALL, False)
    assert len(np.unique(truth.reshape(-1, 3), axis=0)) > 50
    assert disagreeing(PovrayRenderer().render(scene, SMALL).pixels, truth) <= 1


@pytest.mark.parametrize(
    ("numbers", "block"),
    [
        ((1, 1, 1, 0, 0, 0, 0, 0, 0, -1), "sphere { <0, 0, 0>, 4096 }"),
        ((0, 0, 0, 0, 0, 0, 0, 2, 0, 1), "plane { <0, 1, 0>, -2048 }"),
        ((2, 4, -6, 1, 2, 3, 0, 0, 0, 0), "quadric { <0.5, 1, -1.5>, <0.25, 0.5, 0.75>, <0, 0, 0>, 0 }"),
    ],
)
def test_povray_is_told_what_it_is(numbers, block):
    shape = quadric(numbers)
    scene = replace(parse_scene(scene_with(numbers)), objects=(Object(0, 0, shape),))
    assert block.split("{")[0] in povray_scene(scene, LARGE).text
    simple = simplified(scene).objects[0].shape
    kind = shape_kind(simple)
    assert kind.povray(kind.scaled(simple, 4096.0), kind.facts([simple])[0]) == block


def test_povray_is_told_of_what_its_numbers_do_not_hold():
    scene = parse_scene(scene_with((1, 1, 0, 0, 0, 0, 0, 0, -1e305, 0)))
    with pytest.raises(ExportError, match="a surface would be too far away"):
        scaled(scene, 2.0**20)


@every_kind
@opaque_or_glass
def test_native_draws_what_is_true(name, glass):
    scene = parse_scene(scene_with(SURFACES[name], glass))
    settings = shallow(SMALL) if glass else SMALL
    assert disagreeing(NativeRenderer().render(scene, settings).pixels, truth_of(name, settings, glass)) == 0


@every_kind
@opaque_or_glass
def test_both_renderers_agree(name, glass):
    scene = parse_scene(scene_with(SURFACES[name], glass))
    settings = shallow(LARGE) if glass else LARGE
    native = NativeRenderer().render(scene, settings).pixels
    for intersections in ("analytic", "bvh"):
        mitsuba = MitsubaRenderer("llvm_ad_rgb", intersections).render(scene, settings).pixels
        assert disagreeing(mitsuba, native) == 0


@every_kind
def test_meshes_hardly_differ(name):
    """Where single precision decides between a body and what is beside it."""
    scene, settings = parse_scene(scene_with(SURFACES[name])), replace(LARGE, width=400, height=300)
    native = NativeRenderer().render(scene, settings).pixels
    mesh = MitsubaRenderer("llvm_ad_rgb", "mesh").render(scene, settings).pixels
    assert disagreeing(mesh, native) <= settings.width * settings.height // 1000


def test_a_ball_is_the_same_picture_as_a_quadric():
    ball = scene_with(SURFACES["ellipsoid"]).splitlines()
    quadric = ball.copy()
    ball[5], quadric[5] = "0 2 sphere .25 .5 0 1.5", "0 2 quadric 2 2 2 0 0 0 -1 -2 0 -3.875"
    one, other = (parse_scene("\n".join(lines)) for lines in (ball, quadric))
    assert isinstance(other.objects[0].shape, Quadric)
    pictures = [NativeRenderer().render(scene, LARGE).pixels for scene in (one, other)]
    np.testing.assert_array_equal(*pictures)
