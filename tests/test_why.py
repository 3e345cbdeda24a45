"""`whitted why`: mistakes that are planted are named, and none where there is none."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.images.texture import read_texture
from converter.images.write import write_image
from converter.renderers.native import NativeRenderer
from converter.scene.model import Sphere
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.judge import judge
from converter.why.left import places_left
from converter.why.picture import Theirs, read_theirs
from converter.why.report import cause_lines, left_sentence, verdict
from converter.why.student import make_student, to_levels

FOLDER = Path(__file__).parent.parent / "scenes"
WIDTH, HEIGHT = 160, 120
SETTINGS = Settings(width=WIDTH, height=HEIGHT)


def load(name):
    return load_scene(FOLDER / f"{name}.in")


def draw(scene, *causes, width=WIDTH, height=HEIGHT):
    ys, xs = np.divmod(np.arange(width * height), width)
    student = make_student(scene, Settings(width=width, height=height))
    return student.drawn(np.stack((xs, ys), axis=1), frozenset(causes)).reshape(height, width, 3)


def judged_picture(scene, levels, lossy=False):
    return judge(scene, Theirs(Path("theirs.ppm"), levels, lossy), SETTINGS)


def save(file, levels, quality=85):
    """Save levels as an image; JPEG at that quality."""
    import OpenImageIO as oiio  # noqa: N813

    height, width, _ = levels.shape
    spec = oiio.ImageSpec(width, height, 3, oiio.UINT8)
    spec.attribute("Compression", f"jpeg:{quality}")
    output = oiio.ImageOutput.create(str(file))
    assert output.open(str(file), spec)
    assert output.write_image(np.ascontiguousarray(levels))
    output.close()
    return file


# ---- Causes ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scene", "causes"),
    [
        ("figure1", ["pixel_center"]),
        ("figure1", ["truncated"]),
        ("whitted", ["depth_2"]),
        ("checker", ["blinn", "checker_truncates"]),
        ("lanterns", ["attenuation_missing", "gamma_22"]),
        ("tiles", ["texture_rows_turned", "upside_down"]),
        ("solids", ["shadows_missing", "bgr", "pixel_center"]),
        ("underwater", ["total_reflection_black", "truncated"]),
    ],
    ids=str,
)
def test_planted_mistakes_are_named(scene, causes):
    scene = load(scene)
    judged = judged_picture(scene, draw(scene, *causes))
    assert set(judged.found.causes) == set(causes)
    assert not judged.found.after.any()
    assert not judged.found.right
    assert f"{WIDTH * HEIGHT:,} of {WIDTH * HEIGHT:,} pixels are the same" in verdict(judged)


@pytest.mark.parametrize("others", [[], ["bgr", "pixel_center"]], ids=str)
def test_acne_is_told_though_its_speckles_are_never_the_same(others):
    """An eye that lies a trifle off has others, which no tracer can reproduce."""
    scene = load("figure1")
    x, y, z = scene.camera.eye
    nudged = replace(scene, camera=replace(scene.camera, eye=(x + 1e-7, y + 1e-7, z)))
    judged = judged_picture(scene, draw(nudged, "epsilon_none", *others))
    assert set(judged.found.causes) == set(others)
    assert judged.acne
    assert not judged.right
    assert "(acne)" in verdict(judged)
    assert not judged_picture(scene, draw(scene, "own_side_casts_none", *others)).acne


def test_mistakes_beside_the_arithmetic_of_another_program():
    """The native tracer in single precision shares no code with the one that the mistakes are planted in."""
    scene = load("room")
    asked = Settings(WIDTH, HEIGHT, pixel="center", specular="blinn", max_depth=2)
    colors = np.asarray(NativeRenderer("float").render(scene, asked).pixels)
    levels = to_levels(colors.reshape(-1, 3)).reshape(colors.shape)
    assert set(judged_picture(scene, levels).found.causes) == {"pixel_center", "blinn", "depth_2"}


@pytest.mark.parametrize("size", [(50, 37), (120, 160), (300, 100)], ids=str)
def test_pictures_of_any_size(size):
    scene = load("figure1")
    levels = draw(scene, "shadows_missing", width=size[0], height=size[1])
    assert judged_picture(scene, levels).found.causes == ("shadows_missing",)


def test_width_and_height_exchanged():
    scene = load("figure1")
    turned = draw(scene, width=WIDTH, height=HEIGHT).transpose(1, 0, 2)
    assert judged_picture(scene, np.ascontiguousarray(turned)).found.causes == ("transposed",)


def test_mistakes_that_look_the_same_are_told():
    """In the room with one open polyhedron fewer it cannot be known why there is none."""
    scene = load("figure1")
    found = judged_picture(scene, draw(scene, "bounded_only")).found
    named = {found.causes[0], *found.alternatives[found.causes[0]]}
    assert {"bounded_only", "polyhedra_missing"} <= named


def test_a_picture_of_a_program_that_reads_the_format_another_way():
    """The settings say how the right picture is drawn."""
    scene = load("figure1")
    levels = draw(scene, "pixel_center")
    theirs = Theirs(Path("theirs.ppm"), levels, False)
    assert judge(scene, theirs, replace(SETTINGS, pixel="center")).found.right


# ---- No causes -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "quality"), [("figure1", 50), ("highlights", 90), ("whitted", 75)])
def test_no_cause_is_invented_for_compressed_pictures(name, quality, tmp_path):
    scene = load(name)
    theirs = read_theirs(save(tmp_path / "a.jpg", draw(scene), quality))
    assert theirs.lossy
    assert judge(scene, theirs, SETTINGS).found.causes == ()
    again = Theirs(theirs.file, theirs.levels, False)  # saved once more, as PNG
    judged = judge(scene, again, SETTINGS)
    assert judged.found.causes == ()
    assert judged.found.likeness.lossy
    assert "right, as far as its compression" in verdict(judged)


def test_no_cause_is_invented_for_single_precision():
    scene = load("figure1")
    colors = np.asarray(NativeRenderer("float").render(scene, SETTINGS).pixels)
    levels = to_levels(colors.reshape(-1, 3)).reshape(colors.shape)
    assert set(judged_picture(scene, levels).found.causes) <= {"single_precision"}


def test_no_cause_is_invented_for_what_is_not_known():
    """A ball that lies elsewhere is in no table."""
    scene = load("figure1")
    moved = replace(scene.objects[3], shape=Sphere((-30.0, 0.0, 16.0), 20.0))
    levels = draw(replace(scene, objects=(*scene.objects[:3], moved, *scene.objects[4:])))
    judged = judged_picture(scene, levels)
    assert judged.found.causes == ()
    assert verdict(judged).startswith("No mistake that is known explains this picture")


@pytest.mark.parametrize("color", [0, 255])
def test_no_cause_is_invented_where_nothing_was_drawn(color):
    """Some set of mistakes makes any scene black; but a program that ends too early is likelier."""
    scene = load("figure1")
    blank = np.full((HEIGHT, WIDTH, 3), color, np.uint8)
    judged = judged_picture(scene, blank)
    assert judged.found.causes == ()
    assert not judged.right
    assert verdict(judged) == "The picture is blank: no row of it shows anything."
    half = draw(scene, "bgr")
    half[HEIGHT // 2 :] = color
    judged = judged_picture(scene, half)
    assert judged.found.causes == ("bgr",)
    assert f"Nothing was drawn in rows {HEIGHT // 2} to {HEIGHT - 1}" in verdict(judged)
    assert not places_left(judged)


def test_mistakes_in_compressed_pictures(tmp_path):
    scene = load("figure1")
    theirs = read_theirs(save(tmp_path / "a.jpg", draw(scene, "shadows_missing", "mirrored")))
    assert set(judge(scene, theirs, SETTINGS).found.causes) == {"shadows_missing", "mirrored"}


# ---- What is left ----------------------------------------------------------------------------------------------------


def test_what_is_left_lies_where_it_was_put():
    """Highlights that are taken out of a third of a picture by hand are no mistake that is known."""
    scene = load("lanterns")
    levels, without = draw(scene, "pixel_center"), draw(scene, "pixel_center", "highlight_missing")
    changed = np.abs(levels.astype(int) - without).max(axis=2) > 4
    changed[:, WIDTH // 3 :] = False
    levels[changed] = without[changed]
    judged = judged_picture(scene, levels)
    assert judged.found.causes == ("pixel_center",)
    assert judged.found.after.sum() == changed.sum() > 50
    places = places_left(judged)
    assert sum(place.share for place in places) == pytest.approx(1)
    assert sum(place.share for place in places if place.mechanism.startswith("highlight of light")) > 0.5
    assert all(changed[place.pixel[1], place.pixel[0]] for place in places)
    assert left_sentence(places, judged).startswith(f"Left: {changed.sum()}: ")
    assert cause_lines(judged)[0].startswith("1. rays through the centres")


def test_silhouettes_are_told():
    scene = load("figure1")
    levels = draw(scene, "diffuse_missing")
    right = draw(scene, "diffuse_missing", "pixel_bottom_right")
    edge = (np.abs(levels.astype(int) - right).max(axis=2) > 60) & (np.arange(HEIGHT)[:, np.newaxis] < HEIGHT / 2)
    levels[edge] = right[edge]
    places = places_left(judged_picture(scene, levels))
    assert places[0].mechanism == "silhouette"


# ---- Commands --------------------------------------------------------------------------------------------------------


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


SCENE = FOLDER / "checker.in"


@pytest.fixture
def wrong(tmp_path):
    """A picture of a checker that truncates."""
    levels = draw(load_scene(SCENE), "checker_truncates")
    write_image(tmp_path / "mine.ppm", np.divide(levels, 255, dtype=np.float32), WIDTH, HEIGHT)
    return "mine.ppm"


def test_why(whitted, wrong):
    status, out, err = whitted("why", SCENE, wrong, "--json", "why.json", "--png", "why.png")
    assert (status, err) == (1, "")
    told = out.splitlines()
    assert told[0].startswith("A checker that truncates instead of rounding down: with it, 19,200 of 19,200 pixels")
    assert any(line.startswith("   look at: the checker: floor(x / s)") for line in told)
    data = json.loads(Path("why.json").read_text())
    assert data["verdict"] == told[0]
    assert [cause["name"] for cause in data["causes"]] == ["checker_truncates"]
    assert data["wrong"] == data["causes"][0]["wrong_without"] > 0 == data["wrong_with_causes"]
    assert read_texture("why.png").height > HEIGHT


def test_why_a_right_picture(whitted, tmp_path):
    whitted("render", SCENE, "right.ppm", WIDTH, HEIGHT, "--method", "native", "-q")
    status, out, _ = whitted("why", SCENE, "right.ppm")
    assert (status, out) == (0, "The picture is right: 19,200 of 19,200 pixels are the same.\n")


def test_what_is_left_comes_with_a_pixel_that_can_be_looked_at(whitted, tmp_path):
    levels = draw(load_scene(SCENE), "checker_truncates")
    levels[40:50, 60:70] = 255 - levels[40:50, 60:70]
    write_image("mine.png", np.divide(levels, 255, dtype=np.float32), WIDTH, HEIGHT)
    status, out, _ = whitted("why", SCENE, "mine.png")
    assert status == 1
    assert "Left: 100" in out.splitlines()[0]
    words = out.splitlines()[-1].partition("whitted ")[2].split()
    assert 60 <= int(words[2]) < 70
    assert 40 <= int(words[3]) < 50
    status, out, _ = whitted(*words)
    assert status == 0
    assert "native | theirs" in out
    assert out.splitlines()[0].startswith("A checker that truncates")


def test_pixel_with_a_picture_shows_two_readings(whitted, wrong):
    levels = read_theirs(Path(wrong)).levels
    right = draw(load_scene(SCENE))
    y, x = np.argwhere((levels != right).any(axis=2))[0]
    status, out, _ = whitted("pixel", SCENE, x, y, "--picture", wrong, "--json", "pixel.json")
    assert status == 0
    assert "first difference: the primary ray at depth 0" in out
    assert "\npigment" in out
    data = json.loads(Path("pixel.json").read_text())
    assert data["picture"] == levels[y, x].tolist()
    assert data["causes"] == ["checker_truncates"]
    assert data["native"]["rays"][0]["hit"]["pigment"] != data["theirs"]["rays"][0]["hit"]["pigment"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["why", SCENE], "expected a SCENE and a PICTURE"),
        (["why", SCENE, "none.ppm"], "none.ppm: no such file"),
        (["why", SCENE, SCENE], "no image that can be read"),
        (["why", SCENE, "mine.ppm", "--samples", "4"], "one ray a pixel"),
        (["pixel", SCENE, "1", "1", "--picture", "mine.ppm", "--method", "native"], "--method means nothing beside"),
        (["pixel", SCENE, "1", "1", "80", "60", "--picture", "mine.ppm"], "mine.ppm has 160 x 120 pixels, not 80 x 60"),
        (["pixel", SCENE, "160", "1", "--picture", "mine.ppm"], "lies outside the picture"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_makes_no_sense_is_told(whitted, wrong, words, told):
    status, _, err = whitted(*words)
    assert status == 2
    assert told in err


def test_the_list(whitted):
    status, out, _ = whitted("why", "--list")
    assert status == 0
    assert "checker_truncates" in out
