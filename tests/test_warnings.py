"""What a scene's reader is warned of: where a method is known to fail, and lights that light nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.renderers.native import NativeRenderer
from converter.scene.model import Finish
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.scene.warnings import (
    DISTANCE,
    HIGHLIGHT,
    HUGE,
    POSITION,
    arithmetic_of,
    method_warnings,
    scene_warnings,
)
from converter.studies.families import FAMILIES
from converter.studies.families.scenes import (
    GLASS,
    MATTE,
    WHITE,
    box,
    camera,
    floor,
    light,
    scene,
    sphere,
)

SCENES = Path(__file__).parents[1] / "scenes"
VIEW = camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0))
BALL = (sphere((0.0, 0.0, 0.0), 1.0), WHITE, MATTE)


def warnings(made, method):
    return method_warnings(made, Settings(), METHODS[method])


def far_ball(distance):
    return scene(camera((0.0, 0.0, distance), (0.0, 0.0, 0.0)), [BALL])


@pytest.mark.parametrize(
    ("made", "method", "part"),
    [
        (far_ball(1e6), "native-float", "object 0 is 1e+06 of its radii from the camera (more than 1e+05)"),
        (far_ball(1e6), "mitsuba-analytic-float", "is 1e+06 of its radii from the camera"),
        (far_ball(3e3), "mitsuba-offset", "is 3e+03 of its radii from the camera (more than 1e+03)"),
        (scene(VIEW, [(sphere((3e5, 0.0, 0.0), 1.0), WHITE, MATTE)]), "mitsuba-mesh", "of its radii from the origin"),
        (scene(VIEW, [(box((3e5, 0.0, 0.0), (3e5 + 1, 1.0, 1.0)), WHITE, MATTE)]), "native-float", "from the origin"),
        (
            scene(VIEW, [BALL, (sphere((0.0, -1e6, 0.0), 1e6 - 1), WHITE, MATTE)]),
            "native-float",
            "object 1 has 1e+06 times the radius of object 0",
        ),
        (
            scene(VIEW, [(BALL[0], WHITE, Finish(0.1, 0.1, 0.5, 2e4, 0.0, 0.0, 1.0))], [light((0.0, 9.0, 0.0))]),
            "native-float",
            "finish 0 has an alpha of 20000, more than 10000",
        ),
        (scene(VIEW, [BALL], [light((0.0, 1.00001, 0.0))]), "native-float", "light 1 is 1e-05 radii from the surface"),
        (
            scene(camera((0.0, 1 + 1e-9, 0.0), (0.0, 1.0, 1.0)), [(floor(1.0), WHITE, MATTE)]),
            "mitsuba-mesh",
            "the camera is 1e-09 from plane 0 of object 0",
        ),
    ],
)
def test_a_region_in_which_a_method_fails_is_named_with_the_method_that_holds(made, method, part):
    (warning,) = [warning for warning in warnings(made, method) if part in warning]
    family = METHODS[method].family
    assert warning.endswith(f"where {method} is known to fail; --method {family} holds")
    assert not warnings(made, family)


@pytest.mark.parametrize(
    "method", [name for name, m in METHODS.items() if arithmetic_of(m) in ("double", "float", "mesh")]
)
def test_a_plain_scene_is_in_no_such_region(method):
    made = scene(VIEW, [BALL, (floor(-1.0), WHITE, MATTE)], [light((3.0, 4.0, 5.0))])
    assert not warnings(made, method)


def test_povray_is_not_known_that_well():
    assert warnings(far_ball(1e9), "povray") == ()


def test_double_precision_has_an_end_too():
    made = scene(VIEW, [(sphere((3e12, 0.0, 0.0), 1.0), WHITE, MATTE)])
    (warning,) = warnings(made, "native")
    assert warning.endswith("where native is known to fail")


def test_the_worst_is_named_and_the_others_are_counted():
    made = scene(VIEW, [(sphere((x, 0.0, 0.0), 1.0), WHITE, MATTE) for x in (3e5, 5e5, 4e5)])
    (warning,) = [w for w in warnings(made, "mitsuba-mesh") if "origin" in w]
    assert "object 1 is 5e+05 of its radii" in warning
    assert "so are 2 others" in warning


@pytest.mark.parametrize(
    ("family", "limits"),
    [("position", POSITION), ("huge", HUGE), ("distance", DISTANCE), ("highlight", HIGHLIGHT)],
)
@pytest.mark.parametrize(
    ("arithmetic", "method"), [("float", "native-float"), ("offset", "mitsuba-offset"), ("ulp", "mitsuba-ulp")]
)
def test_the_limits_are_where_the_study_finds_them(family, limits, arithmetic, method):
    """The method holds at the limit, and fails a decade or two beyond it."""
    made = FAMILIES[family]

    def holds(value):
        case = made.case(value)
        truth = case.truth
        if truth is None:
            truth = np.asarray(NativeRenderer("long double").render(case.scene, case.settings).pixels)
        drawn = np.asarray(METHODS[method].renderer("llvm_ad_rgb").render(case.scene, case.settings).pixels)
        return (~(np.abs(drawn - truth) <= LIMIT).all(axis=2)).mean() <= case.allowed

    assert holds(limits[arithmetic])
    assert not holds(100 * limits[arithmetic])


# ---- Lights and cameras that are cut off


def told(*lights, bodies=(BALL,), view=VIEW):
    return scene_warnings(scene(view, bodies, [light(position) for position in lights]), Settings())


def test_a_light_inside_a_body_lights_nothing_outside():
    assert told((0.0, 0.5, 0.0)) == ("scene: light 1 is inside object 0, and lights nothing outside of it",)
    assert told((0.0, 0.5, 0.0), bodies=[(BALL[0], WHITE, replace(GLASS, kd=0.5))])  # everything blocks
    assert told((0.0, 1.5, 0.0)) == ()


def test_a_light_outside_of_the_sky_lights_nothing_in_there():
    sky = (sphere((0.0, 0.0, 0.0), 10.0), WHITE, MATTE)
    assert told((0.0, 9.0, 0.0), bodies=[BALL, sky]) == ()
    assert told((0.0, 11.0, 0.0), bodies=[BALL, sky]) == (
        "scene: light 1 is outside of object 1, which the camera is in, and lights nothing in there",
    )


def test_nobody_is_warned_of_lights_that_nothing_answers_to():
    dull = (BALL[0], WHITE, GLASS)
    assert told((0.0, 0.5, 0.0), bodies=[dull]) == ()


def test_a_camera_shut_in_by_an_opaque_body():
    within = camera((0.0, 0.5, 0.0), (0.0, 0.0, 0.0))
    other = (sphere((5.0, 0.0, 0.0), 1.0), WHITE, MATTE)
    assert told(bodies=[BALL, other], view=within) == ("scene: object 0 has the camera inside, and nothing else",)
    glass = (BALL[0], WHITE, GLASS)
    assert told(bodies=[glass, other], view=within) == ()
    inner = (sphere((0.0, -0.5, 0.0), 0.1), WHITE, MATTE)
    assert told(bodies=[BALL, inner], view=within) == ()


def test_lines_of_the_file_are_named():
    file = SCENES / "underwater.in"
    made = load_scene(file)
    found = scene_warnings(made, Settings())
    assert found[0].startswith(f"{file}:{made.light_lines[0]}: light 1 is outside of object 1 (line ")
