"""Numbers that decide something and are equal but for their roundings: every method follows the format's rules."""

import importlib.util
import subprocess
import sys
from collections import Counter
from itertools import combinations
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from tie_scenes import CLEAR, CSG_SCENES, CSG_SETTINGS, GREEN, ONE_RAY, RAYS, RED, TIE_SCENES, WHITE, traced

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.scene.model import Polyhedron
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import Settings
from converter.studies.exact.tracer import ExactTracer, exact_picture
from converter.studies.families import ties
from converter.studies.families.scenes import NORMAL, camera, on_slope, scene, slope

ROOT = Path(__file__).resolve().parent.parent
SCRIPT = ROOT / "scenes" / "round_numbers.py"
EXACT = ("native", "native-long-double", "native-bvh", "mitsuba-analytic", "mitsuba-bvh")
DRAWN = ("native", "native-long-double", "mitsuba")


@pytest.fixture(scope="module")
def round_numbers() -> ModuleType:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(SCRIPT.parent)
        spec = importlib.util.spec_from_file_location("round_numbers", SCRIPT)
        assert spec and spec.loader
        module = importlib.util.module_from_spec(spec)
        patch.setitem(sys.modules, "round_numbers", module)
        spec.loader.exec_module(module)
        yield module


@pytest.fixture(scope="module")
def folder(round_numbers, tmp_path_factory) -> Path:
    """One with the texture of all scenes."""
    path: Path = tmp_path_factory.mktemp("round")
    (path / round_numbers.TEXTURE).write_text(round_numbers.SQUARES, encoding="ascii")
    return path


def drawn(made, settings, method):
    return np.asarray(METHODS[method].renderer("llvm_ad_rgb").render(made, settings).pixels)


def disagreeing(a, b):
    """(height, width) of pixels."""
    return ~(np.abs(a - b) <= LIMIT).all(axis=2)


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("name", TIE_SCENES)
def test_small_scenes_are_drawn_by_the_rules(mi, name, method):
    _, make, settings = TIE_SCENES[name]
    truth = np.array([[pixel.color for pixel in row] for row in traced(name)])
    wrong = disagreeing(drawn(make(), settings, method), truth)
    assert [(x, y, truth[y, x].tolist()) for y, x in np.argwhere(wrong)] == []


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("name", CSG_SCENES)
def test_csgs_are_drawn_by_the_rules(mi, name, method):
    made = CSG_SCENES[name]()
    wrong = disagreeing(drawn(made, CSG_SETTINGS, method), exact_picture(made, CSG_SETTINGS))
    assert np.argwhere(wrong).tolist() == []


@pytest.mark.parametrize("method", ["native", "native-long-double", "mitsuba-analytic"])
@pytest.mark.parametrize("name", RAYS)
def test_single_rays_follow_the_rules(mi, name, method):
    scenes = RAYS[name]()
    wrong = [disagreeing(drawn(made, ONE_RAY, method), exact_picture(made, ONE_RAY)).any() for made in scenes]
    assert np.flatnonzero(wrong).tolist() == []


@pytest.mark.parametrize("method", EXACT)
def test_what_begins_in_one_plane_is_entered_at_once(mi, method):
    """Glass written in two ways that are rounded apart, seen so slantingly that a step between them would be seen."""
    planes = [tuple(factor * c for c in slope()) for factor in (1.0, 0.3)]
    bodies = [(Polyhedron((plane,)), color, CLEAR) for plane, color in zip(planes, (RED, GREEN), strict=True)]
    eye = tuple(p + 0.01 / 7 * n for p, n in zip(on_slope(), NORMAL, strict=True))
    made = scene(camera(eye, on_slope(along=0.5), 0.2, NORMAL), bodies)
    picture = drawn(made, Settings(24, 18, background=WHITE, max_depth=4), method)
    assert np.allclose(picture, 0.2 * np.array(RED) + 0.7)


def test_scenes_of_round_numbers_are_drawn_by_the_rules(mi, round_numbers, folder):
    """Few pixels each; those that are wrong are counted by method and by the ties that they meet."""
    met: Counter[str] = Counter()
    wrong: dict[str, Counter[str]] = {}
    for seed in range(24):
        text = round_numbers.round_scene(seed)
        made, settings = parse_scene(str(text), folder / "a.in"), Settings(16, 12, pixel=text.pixel, cutoff=1 / 16)
        tracer = ExactTracer(made, settings)
        pixels = [[tracer.pixel(x, y) for x in range(settings.width)] for y in range(settings.height)]
        met.update(tie for row in pixels for pixel in row for tie in pixel.ties)
        truth = np.array([[pixel.color for pixel in row] for row in pixels])
        for method in DRAWN:
            for y, x in np.argwhere(disagreeing(drawn(made, settings, method), truth)):
                wrong.setdefault(f"{method}, scene {seed}", Counter()).update(pixels[y][x].ties or ("no tie",))
    assert len(met) >= 10
    assert wrong == {}


def test_scenes_of_round_numbers_agree(mi, round_numbers, folder):
    """`benchmarks/ties.py` does it with a thousand of them."""
    found = {}
    for seed in range(24):
        text = round_numbers.round_scene(seed)
        made, settings = parse_scene(str(text), folder / "a.in"), Settings(160, 120, pixel=text.pixel)
        pictures = {method: drawn(made, settings, method) for method in DRAWN}
        for a, b in combinations(DRAWN, 2):
            if count := int(disagreeing(pictures[a], pictures[b]).sum()):
                found[seed, a, b] = count
    assert found == {}


# ---- Far from the origin

HOLDS = 1e8
"""The distance from the origin, in pictures, up to which double precision knows the numbers of a scene well enough."""


def held(family):
    return [value for value in family.values if value <= HOLDS]


@pytest.mark.parametrize("family", ties.FAMILIES, ids=lambda family: family.name)
@pytest.mark.parametrize("method", ["native", "mitsuba"])
def test_ties_are_decided_by_the_rules_far_from_the_origin(mi, family, method):
    wrong = {}
    for value in held(family):
        case = family.case(value)
        wrong[value] = int(disagreeing(drawn(case.scene, case.settings, method), case.truth).sum())
    assert wrong == dict.fromkeys(held(family), 0)


@pytest.mark.parametrize("family", ties.FAMILIES[:-1], ids=lambda family: family.name)  # the last stays where it is
def test_scenes_far_from_the_origin_have_one_truth(family):
    case = family.case(family.values[-1])
    assert np.array_equal(exact_picture(case.scene, case.settings), case.truth)
    assert len(np.unique(case.truth.reshape(-1, 3), axis=0)) > 1


@pytest.mark.parametrize("family", ties.FAMILIES, ids=lambda family: family.name)
def test_families_are_about_ties(family):
    """Many pixels meet one; the kind that a family is named after is among them."""
    kinds = {
        "tie-tile": "tile",
        "tie-texel": "texel",
        "tie-along": "along",
        "tie-in-plane": "in",
        "tie-edge": "touched edge",
        "tie-bodies": "bodies",
        "tie-shadow": "at start",
        "tie-tangent": "tangent",
        "tie-critical": "critical",
        "tie-mirrored": "tile",
    }
    case = family.case(family.values[0])
    tracer = ExactTracer(case.scene, case.settings)
    pixels = [tracer.pixel(x, y) for x in range(case.settings.width) for y in range(case.settings.height)]
    assert sum(kinds[family.name] in pixel.ties for pixel in pixels) >= 7


# ---- The scenes of round numbers themselves


def test_scenes_of_round_numbers_are_scenes(round_numbers, folder):
    texts = [str(round_numbers.round_scene(seed)) for seed in range(200)]
    assert len(set(texts)) == 200
    assert texts == [str(round_numbers.round_scene(seed)) for seed in range(200)]
    for text in texts:
        (folder / "a.in").write_text(text, encoding="ascii")
        load_scene(folder / "a.in")
    assert {text.split(": ")[1].split(";")[0] for text in texts} == {cast.name for cast in round_numbers.CASTS}
    assert {text.split("\n")[0].split()[-1] for text in texts} == {"corner", "center"}


def test_script(tmp_path):
    file = tmp_path / "a.in"
    subprocess.run([sys.executable, SCRIPT, "7", file], check=True)
    written = file.read_bytes()
    load_scene(file)
    subprocess.run([sys.executable, SCRIPT, "7", file], check=True)
    assert file.read_bytes() == written
    refused = subprocess.run([sys.executable, SCRIPT, "7", tmp_path / "no" / "a.in"], capture_output=True, text=True)
    assert refused.returncode == 2
    assert refused.stderr.endswith("no such file or directory\n")


def compared(method, *options):
    command = [sys.executable, ROOT / "benchmarks" / "ties.py", *options, "--methods", "native", method]
    return subprocess.run(command, capture_output=True, text=True)


def test_benchmark():
    """The native tracer agrees with itself, and not with one that follows no mirrored ray twice."""
    same = compared("native-brute", "3", "--size", "16", "12")
    assert same.returncode == 0, same.stderr
    assert "native against native-brute: 0 pixels disagree, in 0 scenes" in same.stdout
    other = compared("native:max_depth=1", "12", "--size", "32", "24")
    assert other.returncode == 1, other.stderr
    assert "native against native:max_depth=1: " in other.stdout
    assert "\n  0: " in other.stdout
