"""`whitted compare`: which picture is trusted, a scene and a picture, options without a meaning, and its advice."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from tie_scenes import TIE_SCENES

from converter.compare.metrics import compare_pixels, count_shifted
from converter.images.texture import read_texture
from converter.images.write import write_image
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.scene.writer import write_scene

SCENE = """\
0 0 -10   0 0 0   0 1 0   40
2
0 0 0     1 1 1     1 0 0
5 5 -9    .8 .8 .8  1 0 0
2   solid 1 .5 .2   checker .1 .2 .3 .9 .8 .7 1
2   .2 .6 .3 20 .4 0 0   .1 .1 .3 100 .1 .8 1.5
3
0 0 sphere 0 0 0 1
0 1 sphere 1.5 0 -2 .7
1 0 sphere 0 -101.5 0 100
"""
SIZE = ("40", "30")


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """A scene, whose name a shell would take apart."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "the scene.in"
    file.write_text(SCENE)
    return file.name


@pytest.fixture
def draw(scene):
    """Draws it with some settings into an image."""

    def run(name, **settings):
        drawn = NativeRenderer().render(load_scene(scene), Settings(**{"width": 40, "height": 30} | settings))
        write_image(name, drawn.pixels, drawn.width, drawn.height)
        return name

    return run


def advice(out):
    """The words of the command that a comparison ends with."""
    (line,) = [line for line in out.splitlines() if ": whitted pixel " in line]
    return shlex.split(line.partition(": whitted ")[2])


# ---- Which is trusted


def test_help_says_which_is_trusted(whitted):
    _, out, _ = whitted("compare", "--help")
    assert "the first is the reference, the second the candidate" in " ".join(out.split())
    assert "whitted compare theirs.ppm mine.ppm" in out


def test_the_first_image_is_trusted(whitted, draw):
    status, out, _ = whitted("compare", draw("theirs.exr"), draw("mine.exr", background=(0.0, 0.0, 0.0)))
    assert status == 1
    assert out.splitlines()[:2] == ["reference: theirs.exr, which is trusted", "candidate: mine.exr, 40 x 30 pixels"]
    place = re.search(r"at \((\d+), (\d+)\)", out)
    x, y = map(int, place.groups())
    for role, file in (("reference", "theirs.exr"), ("candidate", "mine.exr")):
        shown = re.search(rf"^ +{role} +(.*)$", out, re.MULTILINE)[1]
        color = np.asarray(read_texture(file).texels)[y, x]
        assert [float(channel) for channel in shown.split()] == pytest.approx(color, abs=1e-6)


# ---- A scene and a picture of it


@pytest.mark.parametrize("name", ["a.ppm", "a.png", "a.exr"])
def test_a_scene_and_its_picture_agree(whitted, scene, draw, name):
    status, out, err = whitted("compare", scene, draw(name))
    assert status == 0
    assert out.splitlines()[:2] == ["reference: native, which is trusted", f"candidate: {name}, 40 x 30 pixels"]
    assert "pixels that disagree  0 of 1200" in out
    assert "first run" in out
    assert ("both are clamped" in err) == (name != "a.exr")
    assert "whitted pixel" not in out


def test_a_picture_is_known_by_how_it_begins(whitted, scene, draw, tmp_path):
    (tmp_path / draw("a.ppm")).rename(tmp_path / "a.dat")
    assert whitted("compare", scene, "a.dat")[0] == 0
    assert whitted("compare", "a.dat", "a.dat")[0] == 0


def test_the_reference_and_the_reading_are_chosen(whitted, scene, draw):
    picture = draw("a.exr", pixel="center", max_depth=1)
    assert whitted("compare", scene, picture)[0] == 1
    status, out, _ = whitted("compare", scene, picture, "--reference", "native:max_depth=1", "--pixel", "center")
    assert status == 0
    assert out.startswith("reference: native:max_depth=1, which is trusted\n")


def test_the_size_may_be_given_and_must_be_the_pictures(whitted, scene, draw):
    assert whitted("compare", scene, draw("a.ppm"), *SIZE)[0] == 0
    status, _, err = whitted("compare", scene, "a.ppm", "80", "60")
    assert (status, err.splitlines()[0]) == (2, "whitted compare: a.ppm has 40 x 30 pixels, not 80 x 60")


def test_what_can_be_told_of_a_picture(whitted, scene, draw):
    """No classes, for a picture has no rays; but how to see those that lead to it, and why it differs, at the end."""
    picture = draw("a.exr", pixel="center")
    status, out, _ = whitted("compare", scene, picture, "--specular", "blinn", "--json", "a.json")
    assert status == 1
    assert "off by less than a pixel" in out
    assert out.splitlines()[-1].startswith(
        "Rays through the centres of the pixels instead of their top left corners: with"
    )
    words = advice(out)
    assert words[:2] == ["pixel", scene]
    assert words[-4:] == ["--specular", "blinn", "--picture", picture]
    found = json.loads(Path("a.json").read_text())
    status, out, _ = whitted(*words)
    assert status == 0
    colour = re.search(r"^colour  native  ([0-9. ]+)  ", out, re.MULTILINE)[1]
    assert [float(channel) for channel in colour.split()] == pytest.approx(found["largest"]["reference"], abs=1e-6)


def test_a_scene_comes_first(whitted, scene, draw):
    status, _, err = whitted("compare", draw("a.ppm"), scene)
    assert status == 2
    assert f"{scene} is no image: a scene stands before the picture" in err


def test_a_missing_picture(whitted, scene):
    status, _, err = whitted("compare", scene, "none.ppm")
    assert (status, err) == (2, "whitted compare: none.ppm: no such file\n")


def test_a_comparison_takes_the_place_of_no_picture_that_it_reads(whitted, scene, draw, tmp_path):
    before = (tmp_path / draw("a.ppm")).read_bytes()
    for option in ("--json", "--png"):
        status, _, err = whitted("compare", scene, "a.ppm", option, "a.ppm")
        assert status == 2
        assert "this is read, and the result would replace it" in err
    assert (tmp_path / "a.ppm").read_bytes() == before


# ---- Options that mean nothing


@pytest.mark.parametrize(
    "option",
    [
        "--method=native",
        "--method=mitsuba",
        "--reference=native",
        "--variant=auto",
        "--repeat=1",
        "--explain=9",
        "--pixel=corner",
        "--specular=phong",
        "--samples=4",
        "--ior=auto",
        "--background=1,1,1",
        "--cutoff=0",
        "--max-depth=3",
        "--threads=1",
        "--seed=1",
    ],
)
def test_two_images_refuse_what_is_for_scenes(whitted, draw, option):
    name, _, value = option.partition("=")
    for words in ([option], [name, value]):
        status, out, err = whitted("compare", draw("a.ppm"), "a.ppm", *words)
        assert (status, out) == (2, "")
        assert err.splitlines()[0] == f"whitted compare: {name} means nothing for two images: nothing is drawn"


def test_an_image_is_compared_with_one_other(whitted, draw):
    for more in ((), ("a.ppm", "a.ppm")):
        status, _, err = whitted("compare", draw("a.ppm"), *more)
        assert status == 2
        assert err.startswith("whitted compare: a.ppm is an image: expected one more, the candidate, found")


def test_two_images_take_the_others(whitted, draw):
    options = ("--limit", "1", "--png", "b.png", "--amplify", "2", "--json", "b.json", "-q")
    assert whitted("compare", *options, draw("a.ppm"), "a.ppm")[0] == 0


@pytest.mark.parametrize(
    ("option", "message"), [("--method=mitsuba", "the candidate is a.ppm"), ("--explain=9", "rays")]
)
def test_a_scene_and_a_picture_refuse_what_is_for_two_methods(whitted, scene, draw, option, message):
    status, _, err = whitted("compare", scene, draw("a.ppm"), option)
    assert status == 2
    assert err.startswith(f"whitted compare: {option.partition('=')[0]}")
    assert message in err


# ---- What it advises


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("native:max_depth=1", []),
        ("native:max_depth=1", ["--pixel", "center"]),
        ("native:max_depth=1", ["--specular", "blinn", "--samples", "4"]),
        ("native:max_depth=1", ["--ior", "ratio", "--background=-1,0.1,1e-3"]),
        ("native:max_depth=1", ["--cutoff", "0.05"]),
        ("native:cutoff=1/64", ["--max-depth", "5"]),
    ],
)
def test_following_the_advice_shows_the_difference(whitted, scene, method, options):
    words = ["--method", method, "--reference", "native-long-double", "--json", "a.json", "--explain", "0"]
    status, out, _ = whitted("compare", scene, *SIZE, *options, *words)
    assert status == 1
    status, told, _ = whitted(*advice(out))
    assert status == 0
    assert "first difference" in told
    largest = json.loads(Path("a.json").read_text())["largest"]
    for name, role in (("native-long-double", "reference"), (method, "test")):
        colour = re.search(rf"^colour  {name} +([0-9. -]+)  ", told, re.MULTILINE)[1]
        assert [float(channel) for channel in colour.split()] == pytest.approx(largest[role], abs=1e-6)


def test_no_advice_where_a_method_tells_no_rays(whitted, scene, monkeypatch):
    monkeypatch.delattr(NativeRenderer, "trace_pixel")
    status, out, _ = whitted("compare", scene, *SIZE, "--method", "native:max_depth=1", "--explain", "0")
    assert status == 1
    assert "whitted pixel" not in out


# ---- Pixels at edges


def test_pixels_that_are_off_by_less_than_a_pixel():
    reference = np.zeros((5, 8, 3), np.float32)
    reference[:, 4:] = 1
    moved = np.roll(reference, 1, axis=1)
    moved[:, 0] = 0
    between, other = moved.copy(), moved.copy()
    between[:, 4] = 0.5
    other[2, 2] = 0.5
    assert compare_pixels(reference, moved).disagreeing == count_shifted(reference, moved) == 5
    assert count_shifted(reference, between) == 5
    assert (compare_pixels(reference, other).disagreeing, count_shifted(reference, other)) == (6, 5)
    assert count_shifted(reference, reference) == 0
    other[2, 2] = np.nan
    assert count_shifted(reference, other) == 5


def test_what_the_scene_does_not_determine_is_a_class(whitted, tmp_path, monkeypatch):
    """Rows of tiles whose edges lie where rays meet the floor: single precision decides no ties, and `widen` tells that
    tenths are not known so well.
    """
    monkeypatch.chdir(tmp_path)
    _, make, settings = TIE_SCENES["tiles of 0.3"]
    (tmp_path / "a.in").write_text(write_scene(make()))
    words = ["compare", "a.in", str(settings.width), str(settings.height), "--method", "native-float", "--limit", "100"]
    found = {}
    for ulps in ("0", "1"):
        status, out, _ = whitted(*words, "--widen", ulps, "--json", "a.json")
        assert status == 0
        found[ulps] = json.loads(Path("a.json").read_text())
        told = f"{found[ulps]['undetermined']} of {found[ulps]['disagreeing']}"
        assert ["not", "determined", "by", "the", "scene", *told.split()] in [line.split() for line in out.splitlines()]
    assert found["0"]["undetermined"] == 0
    assert found["1"]["undetermined"] == found["1"]["disagreeing"] > 20
    assert found["1"]["classes"]["counts"] == {"not determined by the scene": found["1"]["classes"]["traced"]}
    assert "not determined by the scene" not in found["0"]["classes"]["counts"]


def test_what_is_not_determined_of_a_scene_and_a_picture(whitted, scene, draw):
    draw("mine.png", specular="blinn")
    _, out, _ = whitted("compare", scene, "mine.png", "--widen", "1")
    assert re.search(r"not determined by the scene +0 of \d+", out)
    status, _, err = whitted("compare", "mine.png", "mine.png", "--widen", "1")
    assert status == 2
    assert "--widen means nothing for two images" in err
