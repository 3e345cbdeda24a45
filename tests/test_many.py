"""Many scenes in one process, and parts of pictures."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

from converter.images.texture import read_texture
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

SCENES = Path(__file__).parents[1] / "scenes"
NATIVE = ("--method", "native")


def texels(file):
    texture = read_texture(file)
    return np.reshape(texture.texels, (texture.height, texture.width, 3))


@pytest.mark.parametrize(
    ("options", "part"),
    [
        (("--crop", "3,5,30,17"), (slice(5, 17), slice(3, 30))),
        (("--rows", "4:9"), (slice(4, 9), slice(None))),
        (("--rows", ":9"), (slice(9), slice(None))),
        (("--rows", "20:"), (slice(20, None), slice(None))),
    ],
)
@pytest.mark.parametrize("samples", [4, 25])
def test_a_part_has_the_pixels_of_the_whole(whitted, tmp_path, options, part, samples, method="native"):
    words = (40, 30, "--method", method, "--samples", samples, "-q")
    scene = SCENES / "sampled" / "billiards.in"
    assert whitted("render", scene, tmp_path / "whole.pfm", *words)[0] == 0
    assert whitted("render", scene, tmp_path / "part.pfm", *words, *options)[0] == 0
    whole = texels(tmp_path / "whole.pfm")
    assert np.array_equal(texels(tmp_path / "part.pfm"), whole[part])
    assert len(np.unique(whole[part])) > 50


@pytest.mark.parametrize("samples", [1, 25])
def test_a_part_by_mitsuba(whitted, tmp_path, samples):
    part = (slice(5, 17), slice(3, 30))
    words = (whitted, tmp_path, ("--crop", "3,5,30,17"), part, samples, "mitsuba-analytic")
    test_a_part_has_the_pixels_of_the_whole(*words)


@pytest.mark.parametrize("renderer", [NativeRenderer(), MitsubaRenderer(VARIANT)])
def test_a_part_of_what_no_memory_holds(mi, renderer):
    """Of a picture of 90 GiB, with more pixels than 32 bits can number."""
    scene = load_scene(SCENES / "figure1.in")
    left, top = 51_000, 66_000
    settings = Settings(100_000, 75_000, crop=(left, top, left + 3, top + 2))
    pixels = np.asarray(renderer.render(scene, settings).pixels)
    places = [(left + column, top + row) for row in range(2) for column in range(3)]
    records = NativeRenderer().trace_pixels(scene, settings, places)
    assert pixels.reshape(-1, 3) == pytest.approx(np.array([record.color for record in records]), abs=1e-6)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ("--crop", "3,5,3,17"),
            "--crop: a part has X0 < X1 and Y0 < Y1 within a picture of 40 x 30 pixels, found 3,5,3,17",
        ),
        (
            ("--crop", "3,5,41,17"),
            "--crop: a part has X0 < X1 and Y0 < Y1 within a picture of 40 x 30 pixels, found 3,5,41",
        ),
        (("--crop", "-3,5,4,17"), "argument --crop: must lie between 0 and 1000000, found -3"),
        (("--rows", "-3:5"), "argument --rows: must lie between 0 and 1000000, found -3"),
        (("--crop", "3,5,7"), "argument --crop: must be four numbers with commas between them, found '3,5,7'"),
        (("--rows", "31:"), "--rows: a part has A < B within a picture of 40 x 30 pixels, found 31:30"),
        (("--rows", "3"), "argument --rows: must be FIRST:END, such as 0:100, found '3'"),
        (("--rows", "3:4", "--adaptive", "8"), "--adaptive: what a pixel's neighbours are decides"),
        (("--size", "3x4"), "--size: WIDTH and HEIGHT are given already"),
    ],
)
def test_no_part(whitted, tmp_path, options, message):
    status, _, err = whitted("render", SCENES / "figure1.in", tmp_path / "a.png", 40, 30, *NATIVE, *options)
    assert status == 2
    assert err.startswith(f"whitted render: {message}")


def test_many_scenes(whitted, tmp_path):
    """One that is bad does not stop the rest, and the status tells of it."""
    bad = tmp_path / "bad.in"
    bad.write_text("nonsense")
    scenes = (SCENES / "figure1.in", bad, SCENES / "whitted.in", tmp_path / "missing.in")
    pattern, words = tmp_path / "new" / "{number:02}_{name}.ppm", ("--size", "40x30", *NATIVE)
    status, out, err = whitted("render", *scenes[:2], "-o", pattern, *scenes[2:], *words, "--json", tmp_path / "j")
    assert status == 2
    assert err.count("bad.in:1:1: expected the eye's x") == err.count("missing.in: there is no such file") == 1
    assert out.splitlines()[-1].startswith("2 of 4 scenes drawn")
    assert [line.endswith("failed") for line in out.splitlines()[1:-1]] == [False, True, False, True]
    assert sorted(file.name for file in (tmp_path / "new").glob("*.ppm")) == ["01_figure1.ppm", "03_whitted.ppm"]
    found = json.loads((tmp_path / "j").read_text())["pictures"]
    assert [each["status"] for each in found] == [0, 2, 0, 2]
    assert found[0]["statistics"]["rays"] > 1200
    assert whitted("render", SCENES / "whitted.in", tmp_path / "one.ppm", 40, 30, *NATIVE)[0] == 0
    assert (tmp_path / "one.ppm").read_bytes() == (tmp_path / "new" / "03_whitted.ppm").read_bytes()


def test_many_quietly(whitted, tmp_path):
    words = ("--size", "8x6", *NATIVE, "-q")
    assert whitted("render", SCENES / "figure1.in", f"-o{tmp_path}/{{name}}.ppm", *words) == (0, "", "")


def test_a_size_among_many_scenes(whitted, tmp_path):
    status, _, err = whitted("render", SCENES / "figure1.in", "-o", tmp_path / "{name}.ppm", "40", "30")
    assert status == 2
    assert "a size is given as --size WxH where there is -o" in err


def test_files_that_begin_with_a_hyphen(whitted, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(SCENES / "films" / "orbit.in", "-a.in")
    assert whitted("render", *NATIVE, "-q", "--", "-a.in", "-b.ppm", "8", "6") == (0, "", "")
    assert (tmp_path / "-b.ppm").exists()


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (("--adaptive-map", "m.png"), "--adaptive-map: it is for one scene, without -o"),
        (("--stats",), "--stats: it is for one scene, without -o; --json tells it of many"),
    ],
)
def test_many_refuse_what_is_for_one(whitted, tmp_path, option, message):
    words = ("render", SCENES / "figure1.in", "-o", tmp_path / "{name}.ppm", "--size", "8x6", *NATIVE, *option)
    status, _, err = whitted(*words)
    assert (status, err.splitlines()[0]) == (2, f"whitted render: {message}")
    assert not list(tmp_path.iterdir())


def test_what_an_earlier_call_drew_is_kept(whitted, tmp_path):
    """Not a picture that is another's now, one that has been written over or deleted, or one of other options."""
    names = ("same", "other", "spoilt", "gone")
    texture = tmp_path / "steps.ppm"
    texture.write_bytes(b"P6 1 2 255\n" + bytes(range(6)))
    text = (SCENES / "figure1.in").read_text().replace("rainbow1.ppm", texture.name)
    for name in names:
        (tmp_path / f"{name}.in").write_text(text)
    (tmp_path / "bad.in").write_text("nonsense")
    scenes = [tmp_path / f"{name}.in" for name in (*names, "bad")]

    def drawn(*options):
        """How many are drawn by a call, and not there."""
        words = ("render", *scenes, "-o", tmp_path / "{name}.ppm", "--size", "8x6", *NATIVE, "--resume", *options)
        status, out, err = whitted(*words)
        assert (status, err.count("bad.in:1:1: "), out.count("failed")) == (2, 1, 1)
        return 4 - out.count("was there")

    assert drawn() == 4
    first = {name: (tmp_path / f"{name}.ppm").read_bytes() for name in names}
    (tmp_path / "other.in").write_bytes((SCENES / "highlights.in").read_bytes())
    (tmp_path / "spoilt.ppm").write_bytes(first["spoilt"][:-1])
    (tmp_path / "gone.ppm").unlink()
    assert drawn() == 3
    assert {name for name in names if (tmp_path / f"{name}.ppm").read_bytes() != first[name]} == {"other"}
    assert drawn() == 0
    assert drawn("--specular", "blinn") == drawn("--specular", "blinn", "--format", "png") == 4
    texture.write_bytes(b"P6 1 2 255\n" + bytes(range(1, 7)))
    assert drawn("--specular", "blinn", "--format", "png") == 3  # the other has no texture


@pytest.mark.parametrize(
    ("pattern", "message"),
    [
        ("a.ppm", "figure1.in would both become a.ppm: {name} is"),
        ("{nome}.ppm", "-o/--out: there is no {nome}: a pattern may have {name} and {number}"),
        ("{name.ppm", "-o/--out: '{name.ppm' is no pattern: expected '}' before end of string"),
        ("{name:9999999999}.ppm", "-o/--out: '{name:9999999999}.ppm' asks for a name of more than 999 characters"),
        ("{number:q}.ppm", "-o/--out: '{number:q}.ppm' is no pattern: Unknown format code 'q'"),
    ],
)
def test_no_pattern(whitted, tmp_path, monkeypatch, pattern, message):
    monkeypatch.chdir(tmp_path)
    status, _, err = whitted("render", SCENES / "figure1.in", SCENES / "figure1.in", "-o", pattern)
    assert status == 2
    assert message in err
    assert not list(tmp_path.iterdir())
