"""Scenes that are sampled: which effects they have, who is told of them, and that no renderer ignores one."""

from dataclasses import replace

import numpy as np
import pytest
from variant import VARIANT

from converter.commands.inspection import inspect_scene
from converter.renderers.base import EffectUnavailable
from converter.renderers.methods import METHODS
from converter.scene.model import Camera, Finish, Light, Object, Scene, Solid, Sphere
from converter.scene.needs import scene_needs
from converter.scene.parser import parse_scene
from converter.scene.settings import Settings
from converter.scene.writer import write_scene
from converter.studies.exact.tracer import ExactTracer
from converter.to_mitsuba.export import export_scene
from converter.to_povray.scene import povray_scene
from converter.why.student import UnknownToStudent, make_student

SETTINGS = Settings(width=8, height=6)
MATTE = Finish(0.2, 0.8, 0, 1, 0, 0, 0)
MIRROR = Finish(0.1, 0, 0, 1, 0.7, 0, 0)
PLAIN = Scene(
    camera=Camera((0, 0, -10), (0, 0, 0), (0, 1, 0), 40),
    ambient=(0.1, 0.2, 0.3),
    lights=(Light((0, 10, 0), (1, 1, 1), (1, 0, 0)), Light((0, 10, -9), (1, 1, 1), (1, 0, 0))),
    pigments=(Solid((1, 0, 0)),),
    finishes=(MATTE, MIRROR),
    objects=(Object(0, 0, Sphere((0, 0, 0), 1)), Object(0, 1, Sphere((3, 0, 0), 1))),
)
EFFECTS = {
    "depth of field": replace(PLAIN, camera=replace(PLAIN.camera, aperture=0.5, focal=10)),
    "soft shadows": replace(PLAIN, lights=(PLAIN.lights[0], replace(PLAIN.lights[1], radius=0.5))),
    "glossy rays": replace(PLAIN, finishes=(MATTE, replace(MIRROR, cone=5))),
    "motion": replace(PLAIN, objects=(PLAIN.objects[0], replace(PLAIN.objects[1], move=(0, -1, 0)))),
}
CAUSES = {
    "depth of field": "scene: the camera has an aperture",
    "soft shadows": "scene:9: light 2 has a radius",
    "glossy rays": "scene:16: finish 1 has a cone",
    "motion": "scene:20: object 1 moves",
}
STILL = {"mitsuba-mesh"}
"""Those that do not draw motion."""


@pytest.mark.parametrize("effect", EFFECTS)
def test_an_effect_is_needed(effect):
    needs = scene_needs(parse_scene(write_scene(EFFECTS[effect])), SETTINGS)
    assert needs.effects == {effect: CAUSES[effect]}
    assert needs.sampled


def unseen():
    """Effects that no ray meets."""
    lens, lamp, gloss, moves = EFFECTS.values()
    yield PLAIN
    yield replace(lens, objects=())
    yield replace(lens, camera=replace(lens.camera, aperture=0))
    yield replace(lamp, objects=lamp.objects[1:])  # the mirror is not lit
    yield replace(gloss, objects=gloss.objects[:1])
    yield replace(gloss, finishes=(replace(MATTE, cone=5), MIRROR))
    yield replace(gloss, finishes=(MATTE, replace(MIRROR, cone=5, kr=1e-3)))
    yield replace(moves, objects=(replace(moves.objects[1], move=(0.0, -0.0, 0)),))


@pytest.mark.parametrize("scene", list(unseen()))
def test_an_effect_that_nobody_sees_is_none(scene):
    needs = scene_needs(scene, SETTINGS)
    assert needs.effects == {}
    assert not needs.sampled


def test_no_bounces_no_cones():
    assert not scene_needs(EFFECTS["glossy rays"], replace(SETTINGS, max_depth=0)).sampled


DRAWING = ("native", "mitsuba-analytic", "mitsuba-mesh")


@pytest.mark.parametrize("effect", EFFECTS)
@pytest.mark.parametrize("method", DRAWING)
def test_no_renderer_ignores_an_effect(method, effect):
    scene = parse_scene(write_scene(EFFECTS[effect]))
    if effect != "motion" or method not in STILL:
        pixels, plain = (METHODS[method].renderer(VARIANT).render(each, SETTINGS).pixels for each in (scene, PLAIN))
        assert np.asarray(pixels).tobytes() != np.asarray(plain).tobytes()
        return
    message = rf"{CAUSES[effect]}, and .* does not draw {effect}"
    with pytest.raises(EffectUnavailable, match=message):
        METHODS[method].renderer(VARIANT).render(scene, SETTINGS)


@pytest.mark.parametrize("effect", EFFECTS)
def test_other_uses_refuse_or_tell_an_effect(effect, tmp_path):
    scene = parse_scene(write_scene(EFFECTS[effect]))
    with pytest.raises(EffectUnavailable, match=CAUSES[effect]):
        ExactTracer(scene, SETTINGS)
    export_scene(scene, SETTINGS, tmp_path)
    assert ('"move"' in (tmp_path / "geometry.json").read_text()) == (effect == "motion")
    with pytest.raises(UnknownToStudent, match="mistakes are not looked for in scenes with"):
        make_student(scene, SETTINGS)
    assert f"{CAUSES[effect]}, and is drawn without {effect}" in povray_scene(scene, SETTINGS).omissions
    found = inspect_scene(scene, SETTINGS)
    assert found["needs"]["effects"] == [effect]
    assert bool(found["moving"]) == (effect == "motion")


def test_a_focal_distance_alone_is_the_plain_scene():
    camera = replace(PLAIN.camera, focal=5)
    assert make_student(replace(PLAIN, camera=camera), SETTINGS).candidates()


def test_inspect_tells_the_numbers(whitted_inspect):
    everything = replace(
        EFFECTS["depth of field"],
        lights=EFFECTS["soft shadows"].lights,
        finishes=EFFECTS["glossy rays"].finishes,
        objects=EFFECTS["motion"].objects,
    )
    told = whitted_inspect(everything)
    assert "aperture 0.5, in focus at 10" in told
    assert "attenuation  radius" in told
    assert "ior  cone" in told
    assert "displacement\n     1    20  0 -1 0" in told
    assert "depth of field, soft shadows, glossy rays, motion" in told
    plain = whitted_inspect(PLAIN)
    assert not any(word in plain for word in ("aperture", "radius", "cone", "displacement"))


@pytest.fixture
def whitted_inspect(tmp_path, capsys):
    from converter.commands.main import main

    def inspect(scene):
        (tmp_path / "scene.in").write_text(write_scene(scene))
        assert main(["inspect", str(tmp_path / "scene.in")]) == 0
        return capsys.readouterr().out

    return inspect
