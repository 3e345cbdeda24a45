"""Lights that light nothing, and cameras that see nothing, since a body shuts them in or out."""

from dataclasses import replace
from pathlib import Path

from converter.analysis.enclosure import enclosure_notices
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.studies.families.scenes import GLASS, MATTE, WHITE, camera, light, scene, sphere

SCENES = Path(__file__).parents[1] / "scenes"
VIEW = camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0))
BALL = (sphere((0.0, 0.0, 0.0), 1.0), WHITE, MATTE)


def told(*lights, bodies=(BALL,), view=VIEW):
    return enclosure_notices(scene(view, bodies, [light(position) for position in lights]), Settings())


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
    found = enclosure_notices(made, Settings())
    assert found[0].startswith(f"{file}:{made.light_lines[0]}: light 1 is outside of object 1 (line ")
