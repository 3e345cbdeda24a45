"""Certified pixels against a tracer in ball arithmetic that shares no code with theirs."""

import random
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arb_tracer import ArbTracer
from tie_scenes import TIE_SCENES

from converter.certify.certificate import certify, levels
from converter.renderers.methods import METHODS
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.studies.families import ties
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
