"""Families of bodies, mirrors, glass and ray trees: how far tracers hold, and their truth's worth."""

from dataclasses import replace

import numpy as np
import pytest
from variant import VARIANT

from converter.compare.metrics import LIMIT
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.geometry import check_geometry
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.studies.families import csgs, polyhedra, quadrics, ray_trees, reflection, refraction

FAMILIES = {
    f.name: f for module in (polyhedra, quadrics, csgs, reflection, refraction, ray_trees) for f in module.FAMILIES
}

HOLDS = {
    "slivers": 1e-10,
    "horizon": 1e11,
    "empty": 1e-13,
    "quadric-edge": 1e-12,
    "needles": 1e-12,
    "bowls": 1e-12,
    "glass-shells": 1e-13,
    "flush": 1e-13,
    "crescents": 1e-10,
    "mirror-corner": 1e10,
    "trapped-ray": 40.0,
    "critical-angle": 1e-12,
    "grazing-glass": 1e-11,
    "nested-glass": 1e-13,
    "bubble": 1e-13,
    "overlapping-glass": 1e-12,
}
"""The last value at which double precision holds, of families in which it does not hold to the end: there, surfaces are
nearer to one another, or rays to a limit, than the bounds within which numbers count as equal, or the last digit of a
number decides what is seen."""


def last_value(family):
    """The hardest value at which double precision holds."""
    return HOLDS.get(family.name, family.values[-1])


def disagreeing(rendering, truth):
    """How many pixels are off by more than 1/255."""
    return int((~(np.abs(np.asarray(rendering.pixels) - truth) <= LIMIT).all(axis=2)).sum())


def truth_of(case):
    if case.truth is not None:
        return case.truth
    return np.asarray(NativeRenderer("long double").render(case.scene, case.settings).pixels)


@pytest.mark.parametrize("name", FAMILIES)
def test_double_precision_holds(name):
    family = FAMILIES[name]
    held = family.values[: family.values.index(last_value(family)) + 1]
    off = {}
    for value in held:
        case = family.case(value)
        off[value] = disagreeing(NativeRenderer().render(case.scene, case.settings), truth_of(case))
    assert off == dict.fromkeys(held, 0)


@pytest.mark.parametrize("name", FAMILIES)
def test_mitsuba_holds_as_far(mi, name):
    family = FAMILIES[name]
    case = family.case(last_value(family))
    rendering = MitsubaRenderer(VARIANT).render(case.scene, case.settings)
    assert disagreeing(rendering, truth_of(case)) == 0


@pytest.mark.parametrize("name", [name for name, f in FAMILIES.items() if f.case(f.values[0]).truth is not None])
def test_closed_forms_are_those_of_long_double(name):
    """Up to where double precision holds, long double has digits to spare."""
    family = FAMILIES[name]
    case = family.case(last_value(family))
    assert case.truth is not None
    assert disagreeing(NativeRenderer("long double").render(case.scene, case.settings), case.truth) == 0


@pytest.mark.parametrize("name", FAMILIES)
def test_pictures_show_something(name):
    """A picture of one colour would agree with whatever else has it."""
    family = FAMILIES[name]
    truth = truth_of(family.case(last_value(family)))
    assert np.isfinite(truth).all()
    # Uniform by design: between these mirrors and balls all rays are worth the same.
    assert truth.std(axis=(0, 1)).max() > 0.05 or name in (
        "facing-mirrors", "geometric-series", "mirror-box", "mirror-corner", "full-trees", "gain"
    )  # fmt: skip


@pytest.mark.parametrize("make", [NativeRenderer, lambda: MitsubaRenderer(VARIANT)], ids=["native", "mitsuba"])
def test_progress_of_deep_trees_is_told_before_the_end(mi, make):
    """A tree of 2^10 rays a pixel: the first sign of life comes with little of the picture done."""
    case = FAMILIES["full-trees"].case(10.0)
    told = []
    make().render(case.scene, replace(case.settings, width=256, height=192), told.append)
    assert told == sorted(told)
    assert told[0] <= 0.1
    assert told[-1] == 1.0


def test_depth_has_no_room_for_rays_that_the_cutoff_drops():
    """Kernels keep room for as many rays of a tree as it is deep: a thousand, if that is what a user asks for."""
    scene = FAMILIES["full-trees"].case(3.0).scene
    assert scene_needs(scene, Settings(max_depth=1000, cutoff=0.0)).max_depth == 1000
    assert scene_needs(scene, Settings(max_depth=1000, cutoff=0.96875**20)).max_depth in (20, 21)
    assert scene_needs(scene, Settings(max_depth=5, cutoff=0.96875**20)).max_depth == 5


def test_a_plate_too_thin_for_its_faces_to_be_known_is_drawn(mi):
    case = FAMILIES["plates"].case(1e-14)
    assert check_geometry(case.scene)
    truth = truth_of(case)
    for intersections in ("analytic", "bvh"):
        rendering = MitsubaRenderer(VARIANT, intersections).render(case.scene, case.settings)
        assert disagreeing(rendering, truth) == 0


def test_planes_of_a_body_without_volume_are_kept():
    """Its faces are unknown, and it is drawn, or not, by all of its planes."""
    scene = FAMILIES["empty"].case(1e-9).scene
    needs = scene_needs(scene, Settings())
    assert needs.planes[0] == tuple(range(6))
    assert needs.bounded == (False, True)
