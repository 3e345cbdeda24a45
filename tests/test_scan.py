"""Scene files scanned natively: the same scene as the parser's, or none at all."""

import re
import struct
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from strategies import scenes

from converter.scene import loading
from converter.scene.errors import SceneError
from converter.scene.loading import scan_text
from converter.scene.model import Polyhedron, Scene, Sphere, Texmap
from converter.scene.parser import load_scene, parse_scene
from converter.scene.writer import write_scene

SCENES = Path(__file__).parent.parent / "scenes"
CORPUS = Path(__file__).parent / "corpus"
TINY = "{0} 0 5 0 0 0 0 1 0 40\n1\n0 0 0 1 1 1 1 0 0\n1\nsolid 1 0 0\n1\n0.2 0.8 0 1 0 0 0\n1\n0 0 sphere 0 0 0 1\n"
_FORMS = """
1 1. .5 +1 +.5 -0 1e5 1E+5 -1e-5 00012 1e-320 1e-400 1e308 1e309 1e999 -1e999 0e999 9007199254740993 8.41e21
. + - e5 .e5 1e 1e+ +-1 --1 ++1 1f 1d5 1,5 1_000 1__0 1e5_0 0x10 0x1p3 \u0661 \u22121
inf -inf nan infinity Inf NAN nan(1) 1.#INF 1.# 1.#QNAN0
0.1000000000000000055511151231257827021181583404541015625 2.2250738585072011e-308 2.4703282292062327208e-324
1.7976931348623158e308 1.7976931348623159e308
"""
FORMS = [*_FORMS.split(), "1\u00a0"]
"""Words that are numbers to some."""


def everything(scene: Scene) -> str:
    """All that a scene holds, also what is left out of comparisons, signs of zeros, and the kinds of numbers."""
    lines = [o.line for o in scene.objects]
    places = [pigment.place for pigment in scene.pigments if isinstance(pigment, Texmap)]
    return repr([*(getattr(scene, field.name) for field in fields(Scene)), lines, places])


def parsed(text: bytes) -> str:
    """What the parser makes of a text; the message where it is no scene."""
    try:
        return everything(parse_scene(text, Path("a.in")))
    except SceneError as error:
        return str(error)


def agree(text: bytes) -> bool:
    """Whether the scanner reads a text; what it reads is what the parser does."""
    scanned = scan_text(text, Path("a.in"))
    assert scanned is None or everything(scanned) == parsed(text)
    return scanned is not None


@given(scenes([Path("a.ppm")], Path("a.in")))
def test_scenes_are_the_same(scene: Scene) -> None:
    text = write_scene(scene)
    read = agree(text.encode())
    plain = all(isinstance(o.shape, Sphere | Polyhedron) for o in scene.objects) and not re.search(r"\de-\d\d", text)
    extended = [scene.camera.aperture, *(light.radius for light in scene.lights), *(f.cone for f in scene.finishes)]
    attenuated = all(max(light.attenuation[0], light.attenuation[2]) > 0 for light in scene.lights)
    assert read or not plain or any(extended) or not attenuated


@given(
    scenes(most_objects=3),
    st.lists(
        st.tuples(st.integers(0, 2000), st.integers(0, 3), st.sampled_from([*FORMS, *"#\n\r\t\v\f\x1a\0 \x1c", "é"]))
    ),
)
def test_texts_that_are_changed_anywhere_are_read_the_same_or_not_at_all(
    scene: Scene, changes: list[tuple[int, int, str]]
) -> None:
    text = write_scene(scene)
    for at, cut, put in changes:
        text = text[:at] + put + text[at + cut :]
    agree(text.encode())


@pytest.mark.parametrize("word", FORMS)
def test_words_are_numbers_to_both_or_left_to_the_parser(word: str) -> None:
    agree(TINY.format(word).encode())


@pytest.mark.parametrize("shape", ["sphere 0 0 0 1", "polyhedron 2 1 0 0 1\n-1 0 0 -3"])
def test_displacements_are_read_alike(shape: str) -> None:
    made = TINY.format("7").removesuffix("sphere 0 0 0 1\n") + shape
    for gap in (" ", "\n", " # a comment\n"):
        assert agree(f"{made}{gap}move 1 -0{gap}2.5".encode())
    for moved in ("move 1 2", "move 1 2 3 4", "move 1 nan 3", "move 1 1e999 3", "move 1 2 3 move 1 2 3", "Move 1 2 3"):
        assert not agree(f"{made} {moved}".encode())


@given(st.integers(0, 2**64 - 1), st.integers(1, 40))
@example(1, 17)
def test_decimals_of_any_length_are_rounded_alike(bits: int, digits: int) -> None:
    (value,) = struct.unpack("d", struct.pack("Q", bits))
    word = f"{value:.{digits}e}"
    if agree(TINY.format(word).encode()):
        assert scan_text(TINY.format(word).encode()).camera.eye[0] == float(word)  # type: ignore[union-attr]
    else:
        assert value != value or not 1e-300 < abs(value) < 1e6


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r", " # a comment\n", "\t#\r"])
def test_lines_are_counted_alike(end: str) -> None:
    text = (end + end).join(TINY.format("7").splitlines()) + "# the end"
    assert agree(text.encode()) and agree(b"\xef\xbb\xbf" + text.encode())


def test_files_of_the_repository_are_scanned_but_for_what_is_rare() -> None:
    left = {file.name for file in SCENES.glob("*.in") if not agree(file.read_bytes())}
    assert left == {
        "arcade.in",
        "dice.in",
        "lens.in",
        "pawns.in",
        "quadrics.in",
        "saturn.in",
        "wine_glass.in",
    }  # csg and quadrics
    files = sorted(CORPUS.rglob("*.in"))
    assert sum(agree(file.read_bytes()) for file in files) > len(files) / 4


@pytest.mark.parametrize(
    "change",
    [
        ("1 1 1 0 0\n1\nsolid", "1 1 1 0 0\n1\ntexmap none.ppm 0 0 0 0 0 0 0"),
        ("sphere 0 0 0 1", "polyhedron 2 1 0 0 1 -1 0 0 1"),
        ("sphere", "shpere"),
        ("1\n0 0 sphere", "1\n0 1 sphere"),
    ],
)
def test_whoever_loads_gets_the_parsers_message(tmp_path: Path, change: tuple[str, str]) -> None:
    file = tmp_path / "a.in"
    file.write_text(TINY.format("7").replace(*change))
    with pytest.raises(SceneError) as told:
        load_scene(file)
    with pytest.raises(SceneError) as loaded:
        loading.load_scene(file)
    assert str(loaded.value) == str(told.value)


def test_a_scene_that_nobody_can_read_is_told(tmp_path: Path) -> None:
    for file in (tmp_path / "none.in", tmp_path):
        with pytest.raises(SceneError):
            loading.load_scene(file)
