"""Certified pixels against a tracer in ball arithmetic that shares no code with theirs."""

import random
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arb_tracer import ArbTracer
from quadrics import SURFACES, quadric
from tie_scenes import BLUE, CSG_SCENES, CSG_SETTINGS, GLOW, MATTE, RED, TIE_SCENES, checker, view, wall

from converter.certify.certificate import certify, levels
from converter.renderers.methods import METHODS
from converter.scene.model import Csg, Finish, Operand, Scene, Shape, Sphere, Vector
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.studies.families import ties
from converter.studies.families.scenes import light, scene
from converter.studies.family import Family

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "benchmarks"))

from oracle import SCENES, compare

OTHER = {"pixel": "center", "specular": "blinn", "ior": "ratio", "background": (0.1, 0.9, 0.3), "cutoff": 0.01}


@pytest.mark.parametrize("changes", [{}, OTHER], ids=["usual", "other"])
@pytest.mark.parametrize("file", sorted(SCENES.glob("*.in")), ids=lambda file: file.stem)
def test_pixels_of_the_gallery(file: Path, changes: dict[str, object]) -> None:
    settings = replace(Settings(160, 120), **changes)
    rng = random.Random(file.stem)
    found = compare(load_scene(file), settings, [(rng.randrange(160), rng.randrange(120)) for _ in range(12)])
    assert found.contradictions == []
    assert found.same == 12


@pytest.mark.parametrize("name", TIE_SCENES)
def test_pixels_with_ties(name: str) -> None:
    """Every third, which changes columns from row to row."""
    _, make, settings = TIE_SCENES[name]
    pixels = [(x, y) for y in range(settings.height) for x in range(settings.width)][::3]
    found = compare(make(), settings, pixels)
    assert found.contradictions == []
    assert found.not_judged == 0
    assert found.same >= len(pixels) - 12


@pytest.mark.parametrize("name", CSG_SCENES)
def test_ties_of_csgs(name: str) -> None:
    pixels = [(x, y) for x in range(CSG_SETTINGS.width) for y in range(CSG_SETTINGS.height)]
    found = compare(CSG_SCENES[name](), CSG_SETTINGS, pixels)
    assert (found.same, found.contradictions) == (len(pixels), [])


ON = {
    "ellipsoid": (1.0, 0.0, 0.0),
    "hyperboloid of one sheet": (1.0, 0.0, 0.0),
    "hyperboloid of two sheets": (0.0, 0.0, 1.0),
    "cone": (1.0, 0.0, 1.0),
    "elliptic paraboloid": (1.0, 0.0, 1.0),
    "elliptic cylinder": (1.0, 0.0, 0.5),
    "hyperbolic cylinder": (1.0, 1.0, 0.5),
    "parabolic cylinder": (0.5, 0.25, 0.5),
    "parallel planes": (1.0, 0.25, 0.5),
    "hyperbolic paraboloid": (1.0, 0.5, 0.5),
    "half-space": (1.0, 0.25, 0.5),
}
"""A point of each quadric."""


def of_quadric(name: str, eye: Vector, sign: float, cut: bool) -> Scene:
    """Clear glass, perhaps with a ball cut out; one light lies on it, another beside it."""
    numbers = [sign * float(x) for x in SURFACES[name]]
    body: Shape = quadric(numbers)
    if cut:
        body = Csg((Operand("+", body), Operand("-", Sphere((0.0, 0.0, 0.0), 1.25))))
    glass = Finish(0.1, 0.5, 0.3, 8.0, 0.2, 0.4, 1.0)
    bodies = [(body, RED, glass), (wall((0.0, 1.0, 0.0), 2.0), checker(0.5), MATTE)]
    return scene(view(eye, (-0.75, -0.25, -1.0)), bodies, [light(ON[name]), light((0.5, 2.0, 0.25))])


@pytest.mark.parametrize("cut", [False, True], ids=["whole", "cut"])
@pytest.mark.parametrize("name", ON)
def test_eyes_and_lights_on_quadrics(name: str, cut: bool) -> None:
    settings, pixels = Settings(4, 3, max_depth=3), [(x, y) for x in range(4) for y in range(3)]
    for eye in (ON[name], (0.25, 0.5, 3.0)):
        for sign in (1.0, -1.0):
            found = compare(of_quadric(name, eye, sign, cut), settings, pixels)
            assert found.contradictions == []
            assert found.same == len(pixels)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_surface_is_inside_along_its_lines(sign: float) -> None:
    """The eye is on the wall of a pipe in a ball, and rays run along it."""
    pipe = quadric([sign * float(x) for x in SURFACES["elliptic cylinder"]])
    ball = Csg((Operand("+", pipe), Operand("&", Sphere((0.0, 0.0, 0.0), 2.0))))
    made = scene(view((1.0, 0.0, 0.0)), [(ball, RED, GLOW), (wall((0.0, 0.0, 1.0), 9.0), BLUE, GLOW)])
    settings = Settings(8, 6, pixel="corner")
    found = compare(made, settings, [(4, y) for y in range(6)])
    assert (found.same, found.contradictions) == (6, [])


def test_the_oracle_contradicts_bytes_of_another_scene(small_scene) -> None:
    settings, pixels = Settings(16, 12), [(x, y) for x in range(16) for y in range(12)]
    darker = replace(small_scene, ambient=tuple(0.99 * channel for channel in small_scene.ambient))
    assert compare(small_scene, settings, pixels) == (len(pixels), [], 0, 0)
    assert len(compare(small_scene, settings, pixels, darker).contradictions) > len(pixels) / 2


@pytest.mark.parametrize("method", ["native", "mitsuba"])
def test_bounds_that_have_grown_make_no_ties(mi, method: str) -> None:
    """After six bounces in glass a ray meets the ground 1.4e-9 below the height at which a tile ends."""
    scene = load_scene(SCENES / "quadrics.in")
    truth = ArbTracer(scene, Settings()).levels(102, 454)
    pixel = Settings(crop=(102, 454, 103, 455))
    found = levels(METHODS[method].renderer("llvm_ad_rgb").render(scene, pixel))
    assert tuple(found[0, 0].tolist()) == truth


def test_a_ray_that_weighs_the_cut_off_is_followed(small_scene) -> None:
    """The floor's kr is 0.1: no double."""
    pixels = [(x, y) for x in range(16) for y in range(12)]
    settings, larger = Settings(16, 12, cutoff=0.1), Settings(16, 12, cutoff=0.11)
    found = compare(small_scene, settings, pixels)
    assert (found.same, found.contradictions) == (len(pixels), [])
    assert (certify(small_scene, settings).low != certify(small_scene, larger).low).any()


@pytest.mark.parametrize("family", ties.FAMILIES, ids=lambda family: family.name)
def test_ties_with_closed_forms(family: Family) -> None:
    case = family.case(family.values[0])
    certificate = certify(case.scene, case.settings)
    assert certificate.certified.all()
    assert np.abs(certificate.colors - case.truth).max() < 1e-6
