"""Our own scenes: they are read, are what their script writes, and stand in their table."""

import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

from converter.scene.parser import load_scene

FOLDER = Path(__file__).resolve().parent.parent / "scenes"
SCENES = sorted(FOLDER.glob("*.in"))
MOST_PICTURE_BYTES = 400 * 1024
MOST_TEXTURE_BYTES = 60 * 1024


@pytest.fixture(scope="module")
def script() -> ModuleType:
    sys.path.insert(0, str(FOLDER))
    spec = importlib.util.spec_from_file_location("generate", FOLDER / "generate.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_there_are_scenes() -> None:
    assert len(SCENES) >= 14


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_scene_is_read(file: Path) -> None:
    assert load_scene(file).objects


def test_generated_files_are_up_to_date(script: ModuleType) -> None:
    files = script.generated()
    stale = [name for name, data in files.items() if (FOLDER / name).read_bytes() != data]
    assert not stale, "run `python scenes/generate.py`"
    textures = {file.relative_to(FOLDER).as_posix() for file in FOLDER.rglob("*.ppm")}
    assert textures <= files.keys()
    said = {file.name for file in SCENES if "# Computed by generate.py." in file.read_text(encoding="utf-8")}
    assert said == {name for name in files if name.endswith(".in")}


def test_table_lists_every_scene() -> None:
    rows = re.findall(
        r'^\| \[<img src="pictures/(\w+)\.png" width="240">\]\(pictures/\1\.png\) \| \[(\w+)\]\((\w+)\.in\) \|',
        (FOLDER / "README.md").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    assert all(picture == name == link for picture, name, link in rows)
    assert sorted(name for _, name, _ in rows) == [file.stem for file in SCENES]


def test_every_scene_has_a_small_picture() -> None:
    pictures = sorted((FOLDER / "pictures").iterdir())
    assert [picture.name for picture in pictures] == [f"{file.stem}.png" for file in SCENES]
    assert all(picture.stat().st_size < MOST_PICTURE_BYTES for picture in pictures)


def test_textures_are_small() -> None:
    assert all(file.stat().st_size < MOST_TEXTURE_BYTES for file in FOLDER.rglob("*.ppm"))
