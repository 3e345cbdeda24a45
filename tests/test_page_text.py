"""What the page of `whitted serve` does to texts and cameras, without a server."""

import math
from pathlib import Path

import pytest

from converter.page.camera import turned
from converter.page.document import MOST_CHARACTERS, ChangedElsewhereError, encoded, read_document, save
from converter.page.edits import with_eye, with_words
from converter.page.numbers import number_at
from converter.page.offsets import at_column, from_browser, to_browser
from converter.page.paths import FAR, ray_lines
from converter.page.reading import read
from converter.renderers.native import NativeRenderer
from converter.scene.errors import SceneError
from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Scene, Solid
from converter.scene.names import read_names
from converter.scene.parser import load_scene, load_text
from converter.scene.settings import Settings
from converter.scene.tokens import Words, word_spans

ROOT = Path(__file__).resolve().parents[1]
TEXT = """\
# café \U0001f600
0 0 -10  # the eye
0 0 0
0 1 0
40
1
0 0 0 1 1 1 1 0 0
2
solid 1 .5 .2
checker 0 0 0 1 1 1 .25
1
.2 .6 .3 20 .2 0 1.5
2
0 0 sphere 0 0 0 1
0 0 polyhedron 2
0 1 0 1
0 -1 0 -4
"""
PPM = b"P6\n1 1\n255\n\x10\x20\x30"


# ---- Places ----------------------------------------------------------------------------------------------------------


def test_places_in_browsers_count_two_for_what_utf_16_needs_two_for():
    text = "a\U0001f600b"
    assert [to_browser(text, k) for k in range(4)] == [0, 1, 3, 4]
    assert [from_browser(text, k) for k in (0, 1, 3, 4)] == [0, 1, 2, 3]
    assert from_browser(text, 99) == 3
    assert from_browser("abc", -5) == 0


@pytest.mark.parametrize(("column", "character"), [(1, 0), (2, 1), (9, 2), (10, 3), (17, 4), (99, 5)])
def test_columns_count_tab_stops(column, character):
    assert at_column("a\tb\tc", column) == character


@pytest.mark.parametrize("scene", sorted((ROOT / "scenes").glob("*.in")), ids=lambda file: file.stem)
def test_word_spans_are_the_parser_s_words(scene):
    text = scene.read_text()
    words = Words(text)
    spans = list(word_spans(text))
    assert [text[start:end] for start, end in spans] == words.cut(0, len(spans) + 1)


def test_word_spans_leave_comments_out_but_not_windows_infinities():
    assert [s for s in word_spans("1 #2 3\n1.#INF#x")] == [(0, 1), (7, 13)]


# ---- Mistakes --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "underlined"),
    [("solid 1", "sollid 1", "sollid"), (".2 0 1.5", ".2 0\t x", "x"), ("40\n1\n", "240\n1\n", "240")],
)
def test_the_word_that_is_wrong_is_underlined(old, new, underlined):
    text = TEXT.replace(old, new)
    assert read(TEXT, Path("a.in")).scene is not None
    reading = read(text, Path("a.in"))
    assert reading.scene is None
    mark = reading.marks[0]
    units = text.encode("utf-16-le")
    assert units[2 * mark.start : 2 * mark.end].decode("utf-16-le") == underlined
    assert text.split("\n")[mark.line - 1].expandtabs()[mark.column - 1 :].startswith(underlined)


def test_a_line_that_ends_too_soon_has_its_last_word_underlined():
    text = TEXT.replace(".2 .6 .3 20 .2 0 1.5", ".2 .6")
    (mark,) = read(text, Path("a.in")).marks
    assert "needs 7 numbers" in mark.message
    assert mark.start < mark.end


@pytest.mark.parametrize("text", ["", "\n\n", "#\n", "\0", "0"])
def test_what_is_no_scene_at_all_has_marks_within_it(text):
    marks = read(text, Path("a.in")).marks
    assert marks
    assert all(0 <= mark.start <= mark.end <= len(text) for mark in marks)


# ---- Textures --------------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "in" / "below").mkdir(parents=True)
    for place in ("secret.ppm", "in/beside.ppm", "in/below/deep.ppm"):
        (tmp_path / place).write_bytes(PPM)
    (tmp_path / "in" / "link.ppm").symlink_to("../secret.ppm")
    (tmp_path / "in" / "round.ppm").symlink_to("round.ppm")
    (tmp_path / "in" / "way").symlink_to("..")
    return tmp_path


def _textured(name):
    return TEXT.replace("solid 1 .5 .2", f"texmap {name} 1 0 0 0 0 1 0 0")


@pytest.mark.parametrize("name", ["beside.ppm", "below/deep.ppm", "below/../beside.ppm", "./beside.ppm"])
def test_textures_of_the_scene_s_folder_are_read(folder, name):
    assert load_text(_textured(name), folder / "in" / "a.in").pigments[0].file.read_bytes() == PPM


@pytest.mark.parametrize("name", ["../secret.ppm", "link.ppm", "round.ppm", "way/secret.ppm", "/etc/passwd", "{}"])
def test_textures_elsewhere_are_refused_and_not_looked_at(folder, name, monkeypatch):
    name = name.format(folder / "secret.ppm")
    looked: list[Path] = []
    monkeypatch.setattr("converter.images.texture.probe_texture", lambda file, hint=True: looked.append(file))
    monkeypatch.chdir(folder)
    with pytest.raises(SceneError, match="lies outside of the scene's folder"):
        load_text(_textured(name), folder / "in" / "a.in")
    assert not looked
    for text in (_textured("missing.ppm"), _textured("secret.ppm")):  # which lies in the working folder
        monkeypatch.undo()
        with pytest.raises(SceneError, match="no such file"):
            load_text(text, folder / "in" / "a.in")


def test_a_text_is_read_as_its_file_is(tmp_path):
    file = tmp_path / "a.in"
    file.write_text(TEXT.replace("solid 1 .5 .2", "texmap b.ppm 1 0 0 0 0 1 0 0"))
    (tmp_path / "b.ppm").write_bytes(PPM)
    assert load_text(file.read_text(), file) == load_scene(file)


# ---- The camera ------------------------------------------------------------------------------------------------------

CAMERA = Camera((0.0, 0.0, -10.0), (0.0, 0.0, 0.0), (0.0, 2.0, 0.0), 40.0)


@pytest.mark.parametrize(
    ("yaw", "pitch", "eye"),
    [
        (math.pi / 2, 0, (-10, 0, 0)),  # counter-clockwise from above
        (math.pi, 0, (0, 0, 10)),
        (0, math.pi / 4, (0, 7.071, -7.071)),
        (0, 9, (0, 10 * math.cos(math.radians(2)), -10 * math.sin(math.radians(2)))),
        (0, -9, (0, -10 * math.cos(math.radians(2)), -10 * math.sin(math.radians(2)))),
        (0, 0, (0, 0, -10)),
    ],
)
def test_a_camera_turns_about_what_it_looks_at(yaw, pitch, eye):
    camera = turned(CAMERA, yaw, pitch)
    assert camera.eye == pytest.approx(eye, abs=2e-3)
    assert (camera.look_at, camera.up, camera.fovy) == (CAMERA.look_at, CAMERA.up, CAMERA.fovy)


def test_a_turned_camera_keeps_its_distance_and_few_digits():
    camera = turned(Camera((1e5, 3.25e5, -2e5), (1e5, 1e5, 1e5), (0.1, 1, 0.3), 40), 0.3, -0.2)
    assert math.dist(camera.eye, camera.look_at) == pytest.approx(math.dist((0, 2.25e5, -3e5), (0, 0, 0)), rel=1e-4)
    assert all(c == round(c) for c in camera.eye)
    small = turned(Camera((0, 0, -1e-5), (0, 0, 0), (0, 1, 0), 40), 1, 0)
    assert math.hypot(*small.eye) == pytest.approx(1e-5, rel=1e-3)


def test_another_eye_changes_its_three_words_only():
    text = with_eye(TEXT, (1.5, -0.25, 3.0))
    assert text == TEXT.replace("0 0 -10  #", "1.5 -0.25 3  #")
    assert with_words(TEXT, {}) == TEXT
    with pytest.raises(IndexError):
        with_words("# 1 2 3\n1 2", {2: "x"})


# ---- Numbers ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("before", "word", "name", "low", "high", "decimals"),
    [
        ("café", "-10", "the eye: z", -20, 0, 1),
        ("0 1 0\n", "40", "fovy: angle", 1, 179, 0),
        ("solid 1 ", ".5", "solid: green", 0, 1, 2),
        (".3 20 ", ".2", "a finish: kr", 0, 1, 2),
        ("checker 0 0 0 1 1 1 ", ".25", "checker: size", 0.0025, 0.5, 3),
        (".2 0 ", "1.5", "a finish: ior", 0.1, 3, 2),
        ("sphere 0 0 0 ", "1", "sphere: radius", 0.01, 2, 2),
        ("0 -1 0 ", "-4", "a plane: d", -8, 0, 2),
        ("1.5\n", "2", "", 0, 4, 2),
    ],
)
def test_the_number_under_the_cursor_and_its_range(before, word, name, low, high, decimals):
    start = TEXT.index(word, TEXT.index(before) + len(before))
    for at in (start, start + len(word)):
        found = number_at(TEXT, at)
        assert found is not None
        assert (found.start, found.end, found.word, found.name) == (start, start + len(word), word, name)
        assert (found.low, found.high, found.decimals) == (pytest.approx(low), pytest.approx(high), decimals)
        assert found.value == float(word)
        assert (found.high - found.low) / found.step >= 99
        assert float(f"{found.step:.{found.decimals}f}") == pytest.approx(found.step)


@pytest.mark.parametrize("at", ["# café", "the eye", "solid", "polyhedron"])
def test_no_number_there(at):
    assert number_at(TEXT, TEXT.index(at) + 1) is None
    assert number_at("", 0) is None


def test_numbers_of_a_broken_scene_have_ranges_too():
    text = TEXT.replace("0 0 sphere", "0 0 shpere")
    found = number_at(text, text.index("0 0 0 1\n0 0 poly"))
    assert found is not None
    assert (found.low, found.high, found.name) == (-1, 1, "")


def test_every_number_of_a_scene_has_its_name_but_counts_and_indices():
    names = read_names(TEXT)
    words = Words(TEXT).cut(0, 999)
    unnamed = [word for k, word in enumerate(words) if k not in names]
    assert unnamed == ["1", "2", "solid", "checker", "1", "2", "0", "0", "sphere", "0", "0", "polyhedron", "2"]
    assert all(field in numbers.fields for numbers, field in names.values())


# ---- The file --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("data", [b"1 2\n# caf\xc3\xa9\n", b"\xef\xbb\xbf1\r\n2\r\n", b"# caf\xe9\r\n1\r\n", b"1", b""])
def test_what_is_saved_unchanged_is_the_same_file(tmp_path, data):
    file = tmp_path / "a.in"
    file.write_bytes(data)
    document = read_document(file)
    assert "\r" not in document.text
    assert save(file, document.text, document).data == data
    assert file.read_bytes() == data


def test_a_file_keeps_its_mode_and_its_link(tmp_path):
    file, link = tmp_path / "a.in", tmp_path / "link.in"
    file.write_text("1\n")
    file.chmod(0o640)
    link.symlink_to(file)
    save(link, "2\n", read_document(link))
    assert link.is_symlink()
    assert file.read_text() == "2\n"
    assert file.stat().st_mode & 0o777 == 0o640
    assert sorted(tmp_path.iterdir()) == [file, link]


def test_what_latin_1_has_no_room_for_is_saved_as_utf_8(tmp_path):
    file = tmp_path / "a.in"
    file.write_bytes(b"# \xe9\n")
    assert encoded("# é€\n", read_document(file)) == "# é€\n".encode()


def test_a_change_elsewhere_is_not_saved_over_unless_asked(tmp_path):
    file = tmp_path / "a.in"
    file.write_text("1\n")
    document = read_document(file)
    file.write_text("2\n")
    with pytest.raises(ChangedElsewhereError):
        save(file, "3\n", document)
    assert file.read_text() == "2\n"
    save(file, "3\n", document, over=True)
    assert file.read_text() == "3\n"
    file.unlink()
    save(file, "4\n", document)
    assert file.read_text() == "4\n"


def test_a_file_that_is_too_long_or_an_image_is_refused(tmp_path):
    file = tmp_path / "a.in"
    file.write_text("#" * (MOST_CHARACTERS + 1))
    with pytest.raises(SceneError, match="1,048,576 characters"):
        read_document(file)
    file.write_bytes(PPM)
    with pytest.raises(SceneError, match="image"):
        read_document(file)


# ---- Rays in the picture ---------------------------------------------------------------------------------------------


def _mirror(normal, height):
    """A mirror before a camera that looks along z, and the ray of the middle pixel."""
    scene = Scene(
        camera=Camera((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0), 90.0),
        ambient=(1.0, 1.0, 1.0),
        lights=(Light((0.0, 5.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 0.0)),),
        pigments=(Solid((1.0, 1.0, 1.0)),),
        finishes=(Finish(0.1, 0.1, 0.0, 1.0, 0.9, 0.0, 0.0),),
        objects=(Object(0, 0, Polyhedron(((*normal, height),))),),
    )
    settings = Settings(width=80, height=60)
    return ray_lines(NativeRenderer().trace_pixel(scene, settings, 40, 30).rays, scene.camera, 80, 60)


def test_a_ray_that_is_reflected_sideways_goes_straight_up_in_the_picture():
    """A mirror at 45 degrees, 4 before the eye: its ray rises at constant depth, so that x stays 40."""
    (line,) = _mirror((0.0, 1.0, -1.0), 4.0)
    assert (line.kind, line.depth) == ("reflected", 1)
    assert (line.x0, line.y0) == pytest.approx((40, 30))
    assert line.x1 == pytest.approx(40)
    assert line.y1 == pytest.approx(30 - 30 * FAR / 4)


def test_a_ray_that_comes_back_past_the_eye_ends_before_it():
    """A mirror tilted a little sends the ray back, to the side: it is seen up to the eye's near plane."""
    (line,) = _mirror((0.1, 0.0, -1.0), 4.0)
    assert (line.x0, line.y0) == pytest.approx((40, 30))
    assert math.isfinite(line.x1)
    assert abs(line.x1 - 40) > 100  # far outside, for it passes the eye
    assert line.y1 == pytest.approx(30)
