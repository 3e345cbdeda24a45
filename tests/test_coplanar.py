"""Planes of several bodies that are one plane, written differently."""

from dataclasses import replace

import numpy as np
import pytest

from converter.analysis.coplanar import with_planes_shared
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.model import Object, Polyhedron
from converter.studies.families import FAMILIES
from converter.studies.families.scenes import BLACK, GLOW, camera, scene, sphere

VIEW = camera((1.0, 5.0, 6.0), (0.0, 0.0, 0.0))


def bodies(*planes):
    return scene(VIEW, [(Polyhedron((plane,)), BLACK, GLOW) for plane in planes])


def planes_of(shared):
    return [plane for o in shared.objects for plane in o.shape.planes]


@pytest.mark.parametrize("factor", [1.0, 3.0, 7.0, 0.1, 1e7, 1e-9, -1.0, -3.0])
def test_the_same_plane_gets_the_same_numbers(factor):
    first = (1.0, 3.0, 2.0, -2.0)
    sign = 1.0 if factor > 0 else -1.0
    shared = with_planes_shared(bodies(first, tuple(factor * number for number in first)))
    assert planes_of(shared) == [first, tuple(sign * number for number in first)]


@pytest.mark.parametrize(
    "other",
    [
        (1.0, 3.0, 2.0, -2.0 * (1 + 1e-14)),
        (1.0, 3.0, 2.0 * (1 + 1e-14), -2.0),
        (1.0, 3.0, 2.0, 2.0),
        (1.0, 3.0, -2.0, -2.0),
        (3.0, 1.0, 2.0, -2.0),
    ],
)
def test_another_plane_keeps_its_own(other):
    given = bodies((1.0, 3.0, 2.0, -2.0), other)
    assert with_planes_shared(given) is given


def test_the_first_of_the_file_is_the_model_of_all():
    planes = [tuple(k * number for number in (0.1, 0.3, 0.2, -0.2)) for k in (1.0, 3.0, 7.0, 11.0)]
    assert planes_of(with_planes_shared(bodies(*planes))) == [planes[0]] * 4


def test_pigments_finishes_and_lines_stay():
    given = bodies((1.0, 3.0, 2.0, -2.0), (3.0, 9.0, 6.0, -6.0))
    ball = Object(1, 0, sphere((0.0, 0.0, 0.0), 1.0), 8)
    given = replace(given, objects=(*(replace(o, line=k) for k, o in enumerate(given.objects)), ball))
    shared = with_planes_shared(given)
    assert [(o.pigment, o.finish, o.line) for o in shared.objects] == [(0, 0, 0), (1, 1, 1), (1, 0, 8)]
    assert shared.objects[2] is ball


@pytest.mark.parametrize("renderer", [NativeRenderer(), NativeRenderer("float"), MitsubaRenderer()])
@pytest.mark.parametrize("length", [7.0, 1e1, 1e6, 1e7])
def test_of_two_bodies_below_one_plane_the_first_is_seen_everywhere(renderer, length):
    """Normals rounded apart made the second body nearer, for some rays or for all, in each of these renderers."""
    case = FAMILIES["coplanar"].case(length)
    drawn = np.asarray(renderer.render(case.scene, case.settings).pixels)
    assert drawn == pytest.approx(case.truth, abs=1e-6)
