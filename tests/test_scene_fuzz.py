"""Whatever the parser is given, it gives a scene or a `SceneError`, soon; and a scene can be drawn."""

import re
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from finite import assert_finite
from hypothesis import given, settings
from hypothesis import strategies as st
from test_corpus import SETTINGS
from test_scene_errors import FIGURE_1, TEXT

from converter.images.texture import TextureError
from converter.renderers.base import EffectUnavailable
from converter.renderers.native import NativeRenderer
from converter.scene.errors import SceneError
from converter.scene.geometry import check_geometry
from converter.scene.parser import parse_scene

KEYWORDS = ["sphere", "polyhedron", "plane", "solid", "checker", "texmap", "csg", "move", "quadric", "Sphere"]
NUMBERS = ["-1", "0", "1", "7", "3.5", "nan", "1e999", "999999999999", "1_0", "\u0663"]
JUNK = st.one_of(
    st.sampled_from(KEYWORDS + NUMBERS),
    st.sampled_from(
        [
            "\n",
            "\n\n",
            "\t",
            "#",
            "x",
            "-",
            "+",
            "&",
            "csg 2",
            "csg 1 + 0 0",
            "+ 0 0 sphere 1 2 3 4",
            "polyhedron 2",
            "0 0 sphere",
            "0 0 plane 0 1 0 2",
            "//",
            "1,2,3",
            "2;",
            "\x1a",
        ]
    ),
    st.text(max_size=6),
)
EXTREMES = ["1e308", "-1e308", "1e155", "1e-162", "-1e-40", "5e-324", "1e16", "1", "-1", "0", "0.5", "90"]
SCENES = sorted(path for path in (Path(__file__).parents[1] / "scenes").glob("*.in") if path.stat().st_size < 5000)
"""Those of the gallery that a few mutations may ruin."""
BASES = [TEXT, FIGURE_1, " ".join(TEXT.split()), "\n".join(TEXT.split())]


@settings(max_examples=200, deadline=2000)
@given(st.sampled_from(BASES), st.data())
def test_mutated_scenes_are_read_or_refused(text: str, data: st.DataObject) -> None:
    separators = st.sampled_from([" ", "", "\n"])
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 30)))
        text = text[:start] + data.draw(separators) + data.draw(JUNK) + data.draw(separators) + text[end:]
    check_verdict(text)


@settings(max_examples=200, deadline=2000)
@given(st.sampled_from(BASES), st.data())
def test_lines_in_another_order_are_read_or_refused(text: str, data: st.DataObject) -> None:
    lines = text.splitlines()
    order = data.draw(st.lists(st.integers(0, len(lines) - 1), max_size=2 * len(lines)))
    start = data.draw(st.integers(0, len(lines)))
    check_verdict("\n".join(lines[:start] + [lines[k] for k in order]))


@settings(max_examples=200, deadline=2000)
@given(st.lists(JUNK, max_size=60), st.sampled_from(["", "0 0 0\n0 0 1\n0 1 0\n40\n1\n0 0 0 1 1 1 1 0 0\n"]))
def test_junk_is_refused(words: list[str], head: str) -> None:
    check_verdict(head + " ".join(words))


@settings(max_examples=100, deadline=2000)
@given(st.binary(max_size=200))
def test_bytes_are_refused(data: bytes) -> None:
    check_verdict(data)


@settings(max_examples=200, deadline=10_000)
@given(st.sampled_from(SCENES), st.sampled_from(SCENES), st.data())
def test_mutated_scenes_of_the_gallery_are_drawn_or_refused(file: Path, other: Path, data: st.DataObject) -> None:
    """Words are deleted, doubled and replaced, by numbers mostly, and lines of another scene put in."""
    words = re.split(r"(\s+)", file.read_text())
    strange = other.read_text().splitlines(keepends=True)
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(words) - 1))
        match data.draw(st.sampled_from(["number", "number", "number", "delete", "double", "splice"])):
            case "number":
                words[at - at % 2] = data.draw(st.sampled_from(EXTREMES))
            case "delete":
                del words[at : at + 2]
            case "double":
                words[at:at] = words[at : at + 2]
            case "splice":
                words.insert(at, "\n" + data.draw(st.sampled_from(strange)))
    text = "".join(words)
    check_verdict(text)
    try:
        scene = parse_scene(text, file)
    except SceneError:
        return
    if not check_geometry(scene):
        with suppress(TextureError, EffectUnavailable):  # of a name that is none any more; an optional number
            limited = replace(SETTINGS, max_depth=4)
            assert_finite(NativeRenderer().render(scene, limited).pixels, scene, limited)


def check_verdict(text: str | bytes) -> None:
    try:
        parse_scene(text, Path("a.in"))
    except SceneError as error:
        assert 1 <= len(error.problems) <= 20
        assert str(error).startswith("a.in:")
        places = [(p.line, p.column) for p in error.problems]
        assert places == sorted(places)
        for problem in error.problems:
            assert problem.message
            assert problem.line == 0 or problem.column >= 1
