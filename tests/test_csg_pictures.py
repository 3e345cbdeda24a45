"""Pictures of csgs: those of the renderers, of POV-Ray, and of the tracer without rounding."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from csgs import BALL, CUBE, CYLINDER, FAR, RIGHT, box, csg, half_space, random_csg_scene

from converter.renderers import povray
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.renderers.povray import PovrayRenderer
from converter.scene.geometry import simplified
from converter.scene.model import (
    Camera,
    Checker,
    Csg,
    Finish,
    Light,
    Object,
    Operand,
    Polyhedron,
    Quadric,
    Scene,
    Solid,
    Sphere,
)
from converter.scene.parser import parse_scene
from converter.scene.settings import Settings
from converter.studies.exact.tracer import exact_picture
from converter.studies.families.scenes import camera
from converter.to_povray.scale import scaled
from converter.to_povray.scene import povray_scene

SMALL = Settings(width=32, height=24, cutoff=1 / 64)
LARGE = Settings(width=200, height=150)
MATTE, GLASS = Finish(0.2, 0.6, 0.3, 20.0, 0.0, 0.0, 0.0), Finish(0.1, 0.2, 0.4, 30.0, 0.2, 0.6, 1.5)
needs_povray = pytest.mark.skipif(
    shutil.which(povray.PROGRAM) is None, reason="POV-Ray is not installed (Debian, Ubuntu: apt install povray)"
)
BODIES = {
    "lens": csg("+", BALL, "&", RIGHT),
    "bitten": csg("+", BALL, "-", RIGHT),
    "drilled": csg("+", CUBE, "-", CYLINDER),
    "rod": csg("+", CYLINDER, "&", CUBE),
    "shell": csg("+", BALL, "-", Sphere((0.0, 0.0, 0.0), 0.9), "-", half_space(0, 0, -1, 0.25)),
    "nested": csg("+", BALL, "-", csg("+", RIGHT, "-", Sphere((0.75, 0.25, 0.0), 0.5))),
    "stacked": csg("+", CUBE, "+", box((-0.5, 1, -0.5), (0.5, 2, 0.5))),
    "flush": csg("+", CUBE, "-", box((0, 0, 0), (1, 1, 1))),
    "endless": csg("+", half_space(0, 1, 0, 0.2), "-", BALL, "+", csg("+", CYLINDER, "&", half_space(0, 1, 0, -1))),
    "complement": csg("+", CUBE, "&", Quadric((-1.0, -1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))),
}
SAME = {
    "ball": (csg("+", BALL), BALL),
    "box": (Csg(tuple(Operand("&" if k else "+", half_space(*plane)) for k, plane in enumerate(CUBE.planes))), CUBE),
    "twice": (csg("+", BODIES["bitten"], "+", BODIES["bitten"]), BODIES["bitten"]),
    "far": (csg("+", BALL, "-", RIGHT, "-", FAR), BODIES["bitten"]),
    "added and taken away": (csg("+", BALL, "+", RIGHT, "-", RIGHT), BODIES["bitten"]),
    "De Morgan, union": (
        csg("+", CUBE, "-", csg("+", BALL, "+", CYLINDER)),
        csg("+", csg("+", CUBE, "-", BALL), "&", csg("+", CUBE, "-", CYLINDER)),
    ),
    "De Morgan, intersection": (
        csg("+", CUBE, "-", csg("+", BALL, "&", CYLINDER)),
        csg("+", csg("+", CUBE, "-", BALL), "+", csg("+", CUBE, "-", CYLINDER)),
    ),
    "reordered": (csg("+", CUBE, "-", BALL, "-", RIGHT), csg("+", CUBE, "-", RIGHT, "-", BALL)),
    "quadric": (csg("+", CUBE, "-", Quadric((2.0, 2.0, 2.0, 0, 0, 0, 0, 0, 0, -2.0))), csg("+", CUBE, "-", BALL)),
}


def scene_with(shape, finish=MATTE):
    return Scene(
        camera=camera((2.3, 3.1, 5.7), (0.1, 0.2, 0.1)),
        ambient=(0.4, 0.5, 0.6),
        lights=(Light((4.3, 6.1, 3.9), (0.8, 0.8, 0.7), (1.0, 0.0, 0.0)),),
        pigments=(Checker((0.9, 0.4, 0.2), (0.2, 0.5, 0.8), 0.37),),
        finishes=(finish, MATTE),
        objects=(Object(0, 0, shape), Object(0, 1, half_space(0, 1, 0, 1.3))),
    )


def picture(renderer, scene, settings):
    return np.asarray(renderer.render(scene, settings).pixels)


def disagreeing(one, other) -> int:
    """Pixels that differ by more than a level."""
    return int((np.abs(np.asarray(one, np.float64) - np.asarray(other, np.float64)) > 1 / 255).any(axis=2).sum())


@pytest.mark.parametrize("finish", [MATTE, GLASS], ids=["opaque", "glass"])
@pytest.mark.parametrize("name", BODIES)
def test_native_draws_what_is_true(name, finish):
    scene = scene_with(BODIES[name], finish)
    truth = exact_picture(scene, SMALL)
    assert len(np.unique(truth.reshape(-1, 3), axis=0)) > 50
    assert disagreeing(picture(NativeRenderer(), scene, SMALL), truth) == 0


@pytest.mark.parametrize("finish", [MATTE, GLASS], ids=["opaque", "glass"])
@pytest.mark.parametrize("name", BODIES)
def test_both_renderers_agree(name, finish):
    scene = scene_with(BODIES[name], finish)
    native = picture(NativeRenderer(), scene, LARGE)
    for intersections in ("analytic", "bvh"):
        assert disagreeing(picture(MitsubaRenderer("llvm_ad_rgb", intersections), scene, LARGE), native) == 0


ROUND = {
    "quadric": Quadric((1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -12.6025)),
    "sphere": Sphere((0.0, 5.5, 0.0), 3.55),
}


@pytest.mark.parametrize("name", ROUND)
def test_rays_leave_a_round_surface_in_a_plane_that_another_csg_begins_at(name):
    """Where the one begins, which has the same round surface, they are outside of it as soon as they start."""
    slab = Polyhedron(((0, -1, 0, 5.35), (0, 1, 0, -5.8)))
    left, right = (
        Polyhedron(((-0.951057, 0, 0.309017, 0), (1, 0, 0, 0))),
        Polyhedron(((-1, 0, 0, 0), (0.951057, 0, 0.309017, 0))),
    )
    wedges = [csg("+", csg("+", ROUND[name], "&", slab), "&", wedge) for wedge in (left, right)]
    scene = Scene(
        Camera((0, 1.7, -15.5), (0, 3.5, 0), (0, 1, 0), 34),
        (1, 1, 1),
        (),
        (Solid((0.1, 0.5, 0.5)), Solid((0.9, 0.7, 0.2))),
        (Finish(0.5, 0, 0, 1, 0.5, 0, 0),),
        tuple(Object(k, 0, wedge) for k, wedge in enumerate(wedges)),
    )
    settings = Settings(64, 48)
    exact = picture(NativeRenderer("long double"), scene, settings)
    assert disagreeing(picture(NativeRenderer(), scene, settings), exact) == 0
    for intersections in ("analytic", "bvh"):
        assert disagreeing(picture(MitsubaRenderer("llvm_ad_rgb", intersections), scene, settings), exact) == 0


@pytest.mark.parametrize("name", BODIES)
def test_meshes_lead_to_the_exact_surfaces(name):
    scene = scene_with(BODIES[name])
    native = picture(NativeRenderer(), scene, LARGE)
    assert disagreeing(picture(MitsubaRenderer("llvm_ad_rgb", "mesh"), scene, LARGE), native) <= 30  # one in a thousand


@pytest.mark.parametrize("finish", [MATTE, GLASS], ids=["opaque", "glass"])
@pytest.mark.parametrize("name", SAME)
def test_what_is_the_same_is_the_same_picture(name, finish):
    pictures = [picture(NativeRenderer(), scene_with(shape, finish), LARGE) for shape in SAME[name]]
    np.testing.assert_array_equal(*pictures)


def test_what_is_the_same_is_the_same_picture_at_every_size():
    for power in range(-6, 7, 3):
        scenes = (scaled(scene_with(shape, GLASS), 10.0**power) for shape in SAME["De Morgan, union"])
        np.testing.assert_array_equal(*(picture(NativeRenderer(), scene, SMALL) for scene in scenes))


@pytest.mark.parametrize("seed", [0, 5, 8, 10, 16, 19])
def test_random_csgs(seed):
    scene = parse_scene(str(random_csg_scene(seed)))
    native = picture(NativeRenderer(), scene, LARGE)
    assert disagreeing(native, picture(MitsubaRenderer("llvm_ad_rgb"), scene, LARGE)) == 0
    assert disagreeing(picture(NativeRenderer(), scene, SMALL), exact_picture(scene, SMALL)) == 0


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 12])
def test_random_csgs_of_many_leaves(seed):
    scene = parse_scene(str(random_csg_scene(seed)))
    settings = replace(SMALL, width=16, height=12)
    assert disagreeing(picture(NativeRenderer(), scene, settings), exact_picture(scene, settings)) == 0


@needs_povray
@pytest.mark.parametrize("finish", [MATTE, GLASS], ids=["opaque", "glass"])
@pytest.mark.parametrize("name", [name for name in BODIES if name not in ("stacked", "flush")])
def test_povray_agrees_where_no_surfaces_coincide(name, finish):
    scene, settings = scene_with(BODIES[name], finish), replace(LARGE, cutoff=0.0, max_depth=8)
    native = picture(NativeRenderer(), scene, settings)
    assert disagreeing(picture(PovrayRenderer(), scene, settings), native) <= LARGE.width * LARGE.height // 1000


def test_povray_is_told_where_surfaces_coincide():
    told = {name: povray_scene(scene_with(shape), LARGE).omissions for name, shape in BODIES.items()}
    assert [name for name, omissions in told.items() if any("coincide" in text for text in omissions)] == [
        "stacked",
        "flush",
    ]


def test_only_what_is_no_primitive_is_drawn_as_a_csg():
    kinds = {name: type(simplified(scene_with(shape)).objects[0].shape) for name, (shape, _) in SAME.items()}
    assert {name for name, kind in kinds.items() if kind is not Csg} == {"ball", "box"}
