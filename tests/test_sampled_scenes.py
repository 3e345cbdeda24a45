"""The scenes of scenes/sampled: they are what their script writes, have their effects, and both renderers draw them."""

import importlib.util
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.renderers.native import NativeRenderer
from converter.scene.needs import scene_needs
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "scenes" / "sampled"
SCENES = sorted(FOLDER.glob("*.in"))
SETTINGS = Settings(width=64, height=48, samples=1, seed=3)
SHOWS = {
    "evening": {"soft shadows"},
    "frosted": {"glossy rays"},
    "dew": {"depth of field"},
    "billiards": {"motion"},
    "carousel": {"motion"},
    "pinball": {"soft shadows", "glossy rays", "depth of field", "motion"},
}


@pytest.fixture(scope="module")
def script():
    sys.path.insert(0, str(ROOT / "scenes"))
    spec = importlib.util.spec_from_file_location("sampled", ROOT / "scenes" / "sampled.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_files_are_up_to_date_and_small(script):
    files = script.generated()
    assert sorted(files) == [file.name for file in SCENES]
    stale = [name for name, data in files.items() if (FOLDER / name).read_bytes() != data]
    assert not stale, "run `python scenes/sampled.py`"
    assert all(file.stat().st_size < 20 << 10 for file in SCENES)


def test_every_scene_has_a_row_and_a_small_picture():
    rows = re.findall(
        r'^\| <img src="pictures/(\w+)\.png" width="320" alt="\w+"> \| \[(\w+)\]\((\w+)\.in\) \|',
        (FOLDER / "README.md").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    assert all(picture == name == link for picture, name, link in rows)
    assert [name for _, name, _ in rows] == list(SHOWS)
    assert sorted(SHOWS) == [file.stem for file in SCENES]
    pictures = {file.stem: file.stat().st_size for file in (FOLDER / "pictures").iterdir()}
    assert set(pictures) == {*SHOWS, "sheet"}
    assert all(size < 200 << 10 for size in pictures.values())


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_a_scene_shows_its_effects(file):
    """Each changes many pixels: without it the picture is another."""
    scene = load_scene(file)
    assert set(scene_needs(scene, SETTINGS).effects) >= SHOWS[file.stem]
    settings = replace(SETTINGS, samples=4)
    picture = np.asarray(NativeRenderer().render(scene, settings).pixels)
    without = {
        "soft shadows": replace(scene, lights=tuple(replace(light, radius=0.0) for light in scene.lights)),
        "glossy rays": replace(scene, finishes=tuple(replace(finish, cone=0.0) for finish in scene.finishes)),
        "depth of field": replace(scene, camera=replace(scene.camera, aperture=0.0)),
        "motion": replace(scene, objects=tuple(replace(o, move=(0.0, 0.0, 0.0)) for o in scene.objects)),
    }
    for effect in SHOWS[file.stem]:
        plain = np.asarray(NativeRenderer().render(without[effect], settings).pixels)
        assert (np.abs(plain - picture).max(axis=2) > 4 * LIMIT).mean() > 0.05, effect


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_both_renderers_draw_the_same(mi, file):
    scene = load_scene(file)
    native, mitsuba = (
        np.asarray(METHODS[name].renderer(VARIANT).render(scene, SETTINGS).pixels) for name in ("native", "mitsuba")
    )
    assert (np.abs(native - mitsuba).max(axis=2) > LIMIT).sum() == 0
