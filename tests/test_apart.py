"""Objects that nearly every ray meets have code of their own, and are met as they are in the tree."""

import json
from dataclasses import replace

import numpy as np
import pytest
from variant import VARIANT

from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere
from converter.scene.settings import Settings

SETTINGS = Settings(width=80, height=60)
SKY = Sphere((0, 0, 0), 30)
FLOOR = Polyhedron(((0, 1, 0, 0.01),))
WHITE = (1.0, 1.0, 1.0)
MATTE = Finish(0.1, 0.8, 0.3, 20, 0, 0, 0)


def box(low, high):
    return Polyhedron(
        tuple(
            (*(sign * (axis == k) for k in range(3)), -sign * end[axis])
            for axis in range(3)
            for sign, end in ((1, high), (-1, low))
        )
    )


ROOM = box((-20, -20, -20), (20, 20, 20))


def entry(planes, low, high):
    return {"material": "", "planes": dict(enumerate(planes)), "box": [low, high] if low else None}


def ball(radius, **more):
    return {"material": "", "sphere": [0, 0, 0, radius], **more}


def apart_of(*entries):
    from mitsuba_plugins.intersection.apart import apart_of
    from mitsuba_plugins.intersection.geometry import parse_geometry

    return apart_of(parse_geometry(json.dumps({str(k): of for k, of in enumerate(entries)})).surfaces)


def test_what_is_apart(mi):
    floor, half = entry(FLOOR.planes, None, None), entry(box((-4,) * 3, (4,) * 3).planes, [-4] * 3, [4] * 3)
    small = {"material": "", "sphere": [5, 5, 5, 1]}
    assert apart_of(small, ball(9), floor) == [1, 2]
    # Of what a ball holds: a box of most of that.
    assert apart_of(small, half, ball(9)) == [1, 2]
    assert apart_of(small, ball(2), ball(9)) == [2]
    # Not what moves, nor a csg.
    csg = {"material": "", "csg": {"leaves": [ball(9), ball(1)], "program": [0, 1, -2]}, "box": [[-9] * 3, [9] * 3]}
    for other in (ball(9, move=[1, 0, 0]), csg):
        assert apart_of(floor, small, other) == [0]
    assert apart_of() == []


def test_few_are_apart(mi):
    floors = [entry(((0, 1, 0, k),), None, None) for k in range(20)]
    assert apart_of(*floors) == list(range(16))


def pictures(scene, monkeypatch, **options):
    """With objects that are apart, and without."""
    from mitsuba_plugins.intersection import apart

    renderer = MitsubaRenderer(VARIANT, intersections="bvh", **options)
    parted = renderer.render(scene, SETTINGS)
    with monkeypatch.context() as context:
        context.setattr(apart, "apart_of", lambda _: [])
        whole = renderer.render(scene, SETTINGS)
    return np.asarray(parted.pixels), np.asarray(whole.pixels)


@pytest.mark.parametrize("precision", ["double", "float", "mixed"])
@pytest.mark.parametrize("lamp", [(3, 2, -3), (0, 40, -8), (2, -3, -6), (1, -0.01, -3)])
def test_they_make_no_difference(mi, small_scene, monkeypatch, precision, lamp):
    """Nor where lights are outside, below, or on one."""
    floor, *rest = small_scene.objects
    around = [Object(1, 0, SKY), Object(1, 1, ROOM)]
    lights = (small_scene.lights[0], Light(lamp, (0.6, 0.5, 0.4), (1, 0, 0)))
    scene = replace(small_scene, objects=(*rest, floor, *around), lights=lights)
    parted, whole = pictures(scene, monkeypatch, precision=precision)
    assert np.array_equal(parted, whole) if precision != "mixed" else np.abs(parted - whole).max() < 0.5 / 255
    if precision == "double":
        assert np.abs(parted - np.asarray(NativeRenderer().render(scene, SETTINGS).pixels)).max() < 1e-5


@pytest.mark.parametrize("around", [Sphere((0, 0, 0), 5), box((-4, -4, -4), (4, 4, 4)), Polyhedron(((0, -1, 0, 4),))])
@pytest.mark.parametrize("precision", ["double", "float", "mixed"])
def test_what_is_on_the_other_side_is_dark(mi, monkeypatch, around, precision):
    """A ball faces a light that it sees, and one within a ball or a box, or behind a plane."""
    scene = Scene(
        camera=Camera((0, 0, -30), (0, 0, 0), (0, 1, 0), 40),
        ambient=(0.1, 0.1, 0.1),
        lights=(Light((0, 3, 0), WHITE, (1, 0, 0)), Light((1, 3.5, -1), WHITE, (1, 0, 0))),
        pigments=(Solid(WHITE),),
        finishes=(MATTE,),
        objects=(Object(0, 0, Sphere((0, -8, -1), 1.5)), Object(0, 0, around)),
    )
    if isinstance(around, Polyhedron) and len(around.planes) == 1:
        # The lights are above a plane, the eye and the ball below.
        shelf = Polyhedron(((0, 1, 0, 1),))
        scene = replace(scene, objects=(scene.objects[0], Object(0, 0, shelf)))
        scene = replace(scene, camera=Camera((0, -6, -30), (0, -8, 0), (0, 1, 0), 20))
    parted, whole = pictures(scene, monkeypatch, precision=precision)
    native = np.asarray(NativeRenderer().render(scene, SETTINGS).pixels)
    assert np.abs(parted - native).max() < 0.5 / 255
    assert np.abs(whole - native).max() < 0.5 / 255


@pytest.mark.parametrize(("size", "beside"), [(0, True), (1.9, True), (2.1, False)])
def test_discs_beside_a_plane(mi, size, beside):
    from mitsuba_plugins.intersection.contacts import Contacts, LightContacts
    from mitsuba_plugins.intersection.rays import real

    lights = LightContacts(real("double"), Contacts([]), np.array([[5.0, 2, 7], [0, 9, 0]]), np.array([size, 0]))
    for sign in (1, -1):
        assert lights.all_beside((0, sign, 0, 0), inside=sign < 0) == beside
        assert not lights.all_beside((0, sign, 0, 0), inside=sign > 0)
        assert not lights.all_beside((0, sign, 0, -5 * sign), inside=sign < 0)
