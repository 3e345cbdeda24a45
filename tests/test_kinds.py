"""Every command over every kind of pigment and shape that the tables name."""

import json

import numpy as np
import pytest
from kinds import IMAGE, PIGMENTS, SHAPES, scene_of

from converter.commands import main, raytrace
from converter.images.texture import read_texture
from converter.pigments.table import PIGMENT_KINDS, PIGMENT_WORDS
from converter.renderers.methods import METHODS
from converter.scene.parser import load_scene, parse_scene
from converter.scene.writer import write_scene
from converter.shapes.readers import SHAPE_READERS
from converter.shapes.table import SHAPE_KINDS

WORDS = [*PIGMENT_WORDS, *SHAPE_READERS]
KINDS = [*(kind.SPELLINGS[0] for kind in PIGMENT_KINDS.values()), *(kind.NAME for kind in SHAPE_KINDS.values())]
RENDERED = [name for name, method in METHODS.items() if not method.changes and name != "native"]
"""Methods that are a renderer's own way; the others are these, and `native`, with other settings."""
CURVED = ("quadric", "csg")
DRAWN = [(kind, name) for kind in KINDS for name in RENDERED if kind in CURVED or not METHODS[name].curved_only]
SIZE = ("40", "30")


def text_with(word):
    samples = PIGMENTS if word in PIGMENT_WORDS else SHAPES
    assert word in samples, f"tests/kinds.py has no example of {word!r}"
    return scene_of(pigment=samples[word]) if word in PIGMENT_WORDS else scene_of(shape=samples[word])


@pytest.fixture
def scene(request, tmp_path, monkeypatch):
    """A scene file with the kind of the parameter, and the image of texmaps beside it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "image.ppm").write_bytes(IMAGE)
    (tmp_path / "scene.in").write_text(text_with(request.param))
    return "scene.in"


@pytest.fixture
def whitted(capsys):
    """Runs `whitted`, which has to end well, and returns stdout."""

    def run(*arguments, statuses=(0,)):
        status = main.main([*arguments])
        out, err = capsys.readouterr()
        assert status in statuses, err
        return out

    return run


@pytest.mark.parametrize("word", WORDS)
def test_what_is_read_is_written(word):
    scene = parse_scene(text_with(word))
    assert parse_scene(write_scene(scene)) == scene


@pytest.mark.parametrize("scene", WORDS, indirect=True)
def test_inspect(scene, whitted):
    out = whitted("inspect", scene)
    found = json.loads(whitted("inspect", scene, "--json", "-"))
    for kind in [*(pigment["kind"] for pigment in found["pigments"]), *found["objects"]["kinds"]]:
        assert kind in KINDS
        assert kind[:-2] in out  # singular or plural


@pytest.mark.parametrize("scene", WORDS, indirect=True)
def test_render(scene, whitted):
    whitted("render", scene, "native.png", *SIZE, "--method", "native")
    whitted("render", scene, "mitsuba.png", *SIZE, "--method", "mitsuba")
    assert raytrace.main([scene, "raytrace.ppm", *SIZE]) == 0
    native, mitsuba = (np.asarray(read_texture(name).texels) for name in ("native.png", "mitsuba.png"))
    np.testing.assert_array_equal(native, mitsuba)
    np.testing.assert_allclose(np.asarray(read_texture("raytrace.ppm").texels), native, atol=1e-6)
    assert len(np.unique(native.reshape(-1, 3), axis=0)) > 20


@pytest.mark.parametrize("scene", WORDS, indirect=True)
def test_convert_for_mitsuba(scene, whitted, mi):
    whitted("convert", scene, "folder", *SIZE)
    whitted("render", scene, "mitsuba.exr", *SIZE, "--method", "mitsuba")
    loaded = np.array(mi.render(mi.load_file("folder/scene.xml", optimize=False)))
    np.testing.assert_array_equal(loaded, np.asarray(read_texture("mitsuba.exr").texels))


@pytest.mark.parametrize("scene", WORDS, indirect=True)
def test_convert_for_povray(scene, whitted, tmp_path):
    whitted("convert", scene, "scene.pov", *SIZE)
    text = (tmp_path / "scene.pov").read_text()
    assert text.count("{") == text.count("}") > 0


@pytest.mark.parametrize("scene", WORDS, indirect=True)
def test_pixel(scene, whitted):
    whitted("pixel", scene, "20", "15", *SIZE)
    trees = json.loads(whitted("pixel", scene, "20", "15", *SIZE, "--json", "-"))
    assert all(trees[name]["rays"][0]["hit"] for name in ("native", "mitsuba"))


@pytest.mark.parametrize(("scene", "method"), DRAWN, indirect=["scene"])
def test_compare(scene, method, whitted):
    """By every method; causes are looked for in all that disagree."""
    assert METHODS[method].unfit(load_scene(scene)) is None
    if missing := METHODS[method].missing():
        pytest.skip(missing)
    whitted("compare", scene, *SIZE, "--method", method, "--json", "-", statuses=(0, 1))


@pytest.mark.parametrize("scene", KINDS, indirect=True)
def test_causes_of_disagreement(scene, whitted):
    """Rays that start off their surfaces miss edges of each kind; margins tell it."""
    found = json.loads(
        whitted("compare", scene, "80", "60", "--method", "mitsuba-offset", "--json", "-", statuses=(0, 1))
    )
    assert found["disagreeing"] > 0


@pytest.mark.parametrize("scene", KINDS, indirect=True)
def test_chart(scene, whitted, tmp_path):
    whitted("chart", scene, "-o", "chart.svg", "--methods", "native,native-float", "--size", "16x12", "--runs", "2")
    assert (tmp_path / "chart.svg").stat().st_size > 1000


@pytest.mark.parametrize("scene", KINDS, indirect=True)
def test_why(scene, whitted, capsys):
    """The student's tracer draws what the statement has, and says so where there is more."""
    whitted("render", scene, "picture.png", *SIZE, "--method", "native")
    status = main.main(["why", scene, "picture.png"])
    assert status == 0 or (status == 2 and "mistakes are " in capsys.readouterr().err)
