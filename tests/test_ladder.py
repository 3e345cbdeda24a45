"""The scenes of the ladder, and the page that teaches with them."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from converter.grade.rubric import read_rubric
from converter.images.texture import read_texture
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.student import deviations, make_student

FOLDER = Path(__file__).resolve().parents[1] / "scenes" / "ladder"
SCENES = sorted(FOLDER.glob("*.in"))
WIDTH, HEIGHT = 320, 240
STEP = 3
SHOWS = 2
"""Pixels in every third column and row of a scene that a mistake has to change to show in it."""
PLACES = np.array([(x, y) for y in range(HEIGHT) for x in range(WIDTH)], np.int32)


@cache
def text():
    return (FOLDER / "README.md").read_text(encoding="utf-8")


@cache
def sections():
    return dict(enumerate(re.split(r"^## \d+\. ", text(), flags=re.MULTILINE)[1:], 1))


@cache
def right(number):
    student = make_student(load_scene(SCENES[number - 1]), Settings(width=WIDTH, height=HEIGHT))
    return student, student.drawn(PLACES, frozenset())


@cache
def first_shown():
    """The first scene in which each mistake shows."""
    first = {}
    for number in range(1, len(SCENES) + 1):
        student, levels = right(number)
        some = (PLACES % STEP == 0).all(axis=1)
        for name in [d.name for d in student.candidates() if d.name not in first]:
            if (student.drawn(PLACES[some], frozenset([name])) != levels[some]).any(axis=1).sum() >= SHOWS:
                first[name] = number
    return first


def test_there_are_twenty_in_order() -> None:
    assert [file.stem[:3] for file in SCENES] == [f"{k:02}_" for k in range(1, 21)]
    assert list(sections()) == list(range(1, 21))
    for number, section in sections().items():
        name = SCENES[number - 1].stem
        assert f"[{name}.in]({name}.in)" in section
        assert f"(pictures/{name}.png)" in section


@pytest.mark.parametrize("number", range(1, 21))
def test_colours_to_check_are_those_of_the_scene(number) -> None:
    found = re.findall(r"column (\d+), row (\d+)\s+it\s+is\s+(\d+)\s+(\d+)\s+(\d+)", sections()[number])
    assert len(found) == 2
    levels = right(number)[1].reshape(HEIGHT, WIDTH, 3).astype(int)
    for x, y, *color in found:
        assert levels[int(y), int(x)].tolist() == list(map(int, color))


def test_mistakes_show_first_where_the_page_names_them() -> None:
    first = first_shown()
    named = {}
    for number, section in sections().items():
        if listed := re.search(r"Goes wrong:([^.]*)\.", section):
            named |= dict.fromkeys(re.findall(r"`(\w+)`", listed[1]), number)
    assert len(named) > 80
    assert named == {name: first.get(name) for name in named}


def test_mistakes_that_show_nowhere_are_told() -> None:
    last = text().rpartition("Two mistakes show")[2]
    assert {*re.findall(r"`(\w+)`", last)} == deviations().keys() - first_shown().keys()


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.stem)
def test_pictures_are_up_to_date(scene) -> None:
    picture = FOLDER / "pictures" / f"{scene.stem}.png"
    texture = read_texture(picture)
    student = make_student(load_scene(scene), Settings(width=texture.width, height=texture.height))
    ys, xs = np.divmod(np.arange(texture.width * texture.height), texture.width)
    levels = student.drawn(np.stack((xs, ys), axis=1).astype(np.int32), frozenset()).astype(int)
    drawn = np.rint(np.reshape(texture.texels, (-1, 3)) * 255)
    assert (np.abs(levels - drawn).max(axis=1) > 1).mean() < 0.005
    assert picture.stat().st_size < 20 * 1024


def test_rubric_names_every_scene() -> None:
    names = [scene.stem for scene in SCENES]
    rubric = read_rubric(FOLDER / "rubric.toml", names)
    assert sorted(rubric.parts) == names
    assert all(part.feature for part in rubric.parts.values())
