"""The pages that people read first: what they show, link to and name is there, in both languages."""

import re
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from converter.commands import main
from converter.images.texture import read_texture
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.student import deviations, make_student

ROOT = Path(__file__).resolve().parents[1]
FIRST = [ROOT / name for name in ("README.md", "LEIAME.md", "CONTRIBUTING.md", "CHANGELOG.md")]
PAGES = [*FIRST, *sorted((ROOT / "docs").glob("*.md"))]
STEPS = [ROOT / "docs" / "format.md", ROOT / "docs" / "formato.md"]
SCENES = sorted((ROOT / "docs" / "format").glob("*.in"))
WIDTH, HEIGHT = 240, 180
MOST_PICTURE_BYTES = 20 * 1024

pages = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
steps = pytest.mark.parametrize("page", STEPS, ids=lambda page: page.name)
scenes = pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.stem)


@pages
def test_links_and_pictures_are_there(page: Path) -> None:
    targets = re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8"))
    ours = [target.partition("#") for target in targets if not target.startswith("https:")]
    assert ours or page.name != "README.md"
    lost = [name for name, _, _ in ours if not (page.parent / name).exists()]
    assert not lost
    for name, _, anchor in ours:
        assert not anchor or anchor in _anchors(page.parent / name if name else page)


@pages
def test_commands_and_options_exist(page: Path) -> None:
    for command, option in _options_named(page.read_text(encoding="utf-8")):
        assert command in {"", *main.COMMANDS}
        assert option is None or option in _options(command), f"whitted {command} has no {option}"


def test_pages_name_options() -> None:
    """What finds them above does."""
    text = "| `whitted why a.in` | as `--list` |\n\n    whitted render a.in --png\n\nAnd `--ior`."
    named = set(_options_named(text))
    assert named == {("why", None), ("why", "--list"), ("render", None), ("render", "--png"), ("", "--ior")}
    assert ("pixel", "--picture") in _options_named((ROOT / "docs" / "programs.md").read_text(encoding="utf-8"))


def test_portuguese_page_tells_all_programs() -> None:
    english, portuguese = (_programs(ROOT / name) for name in ("docs/programs.md", "LEIAME.md"))
    assert english
    assert portuguese == english


@scenes
def test_picture_is_what_the_scene_draws(scene: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As `make format` draws it; other compilers may round a colour to the level beside."""
    drawn, picture = tmp_path / "drawn.png", scene.with_suffix(".png")
    assert main.main(["render", str(scene), str(drawn), str(WIDTH), str(HEIGHT), "--method", "native"]) == 0
    assert not re.search("note|warning", capsys.readouterr().err)
    assert np.abs(_levels(drawn) - _levels(picture)).max() <= 1, "run `make format`"
    assert picture.stat().st_size < MOST_PICTURE_BYTES


@steps
def test_each_step_shows_lines_of_its_scene(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    parts = re.findall(r"^## (\d+)\. .*?\n(.*?)!\[[^\]]+\]\(format/(\w+)\.png\)", text, re.MULTILINE | re.DOTALL)
    assert [(int(number), name) for number, _, name in parts] == list(enumerate((s.stem for s in SCENES), 1))
    for _, before, name in parts:
        shown = [line.split() for line in before.splitlines() if line]
        lines = [line.split() for line in (ROOT / "docs" / "format" / f"{name}.in").read_text().splitlines()]
        assert any(lines[k : k + len(shown)] == shown for k in range(len(lines))), name


def test_a_letter_that_shows_how_a_texture_lies() -> None:
    texture = read_texture(ROOT / "docs" / "format" / "letter.ppm")
    red = np.reshape(texture.texels, (texture.height, texture.width, -1))[:, :, 1] < 0.5
    ways = [red, red[::-1], red[:, ::-1], red[::-1, ::-1]]
    assert red.shape == (8, 6)
    assert len({way.tobytes() for way in ways}) == 4


@steps
def test_mistakes_show_first_at_the_step_that_is_named(page: Path) -> None:
    """Drawn by the tracer that has them, in every second row and column."""
    named = _mistakes(page)
    assert len(named) > 40
    assert named == [(_first_step()[mistake], mistake) for _, mistake in named]


def test_both_languages_name_the_same_mistakes() -> None:
    english, portuguese = map(_mistakes, STEPS)
    assert portuguese == english


@cache
def _first_step() -> dict[str, int]:
    """The first scene, counted from 1, whose picture each mistake changes."""
    places = np.array([(x, y) for y in range(0, HEIGHT, 2) for x in range(0, WIDTH, 2)], np.int32)
    first: dict[str, int] = {}
    for step, scene in enumerate(SCENES, 1):
        student = make_student(load_scene(scene), Settings(width=WIDTH, height=HEIGHT, threads=1))
        right = student.drawn(places, frozenset())
        for mistake in student.candidates():
            if mistake.name not in first and (student.drawn(places, frozenset([mistake.name])) != right).any():
                first[mistake.name] = step
    assert first.keys() <= deviations().keys()
    return first


def _levels(file: Path) -> NDArray[np.float64]:
    """(width * height, 3) levels of a picture."""
    texture = read_texture(file)
    return np.reshape(texture.texels, (texture.width * texture.height, 3)).astype(float) * 255


def _anchors(page: Path) -> set[str]:
    """What links to a page's headings are called."""
    headings = re.findall(r"^#+ (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def _programs(page: Path) -> list[str]:
    """The programs and commands of a page's table, each with its arguments."""
    return re.findall(r"^\| (`(?:raytrace|whitted)[^`]*`) \|", page.read_text(encoding="utf-8"), re.MULTILINE)


def _mistakes(page: Path) -> list[tuple[int, str]]:
    """The step and the name in each row of a page's table of mistakes."""
    rows = re.findall(r"^\| (\d+) \| `(\w+)` \|", page.read_text(encoding="utf-8"), re.MULTILINE)
    return [(int(step), name) for step, name in rows]


def _options_named(text: str) -> Iterator[tuple[str, str | None]]:
    """Each command that a page names, with no option and with each of its options; "" is any command.

    An option that stands alone in a table's row belongs to the command that opens the row.
    """
    for block in re.split(r"\n(?=\||    )|\n\n", text):
        row = re.match(r"\| `whitted ([a-z]+)", block)
        codes = [block] if block.startswith("    ") else re.findall(r"`([^`]+)`", block)
        for code in codes:
            command = re.search(r"\bwhitted ([a-z]+)\b(.*)", code, re.DOTALL)
            options = re.findall(r"(?<!\S)--[a-z][a-z-]*", command[2] if command else code)
            if command:
                yield command[1], None
            elif not code.startswith("--"):
                continue
            yield from ((command[1] if command else row[1] if row else "", option) for option in options)


@cache
def _options(command: str) -> frozenset[str]:
    """The options in a command's help; of "" those of all."""
    names = [command] if command else list(main.COMMANDS)
    helps = (import_module(f"converter.commands.{name}").parser().format_help() for name in names)
    return frozenset(option for text in helps for option in re.findall(r"--[a-z][a-z-]*", text))
