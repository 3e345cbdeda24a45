"""The scenes of many objects, and the benchmark that draws them."""

import importlib.util
import math
import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest

from converter.scene.geometry import scene_facts
from converter.scene.model import Polyhedron, Sphere
from converter.scene.parser import load_scene, parse_scene
from converter.shapes.table import shape_kind

ROOT = Path(__file__).resolve().parent.parent
LARGE = ROOT / "scenes" / "large.py"


@pytest.fixture(scope="module")
def large() -> ModuleType:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(LARGE.parent)
        spec = importlib.util.spec_from_file_location("large", LARGE)
        assert spec and spec.loader
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(("level", "balls"), [(0, 1), (1, 10), (2, 91), (3, 820), (4, 7381)])
def test_sphereflake(large: ModuleType, level: int, balls: int) -> None:
    scene = parse_scene(str(large.sphereflake(level)))
    floor, *spheres = (o.shape for o in scene.objects)
    assert isinstance(floor, Polyhedron)
    assert all(isinstance(sphere, Sphere) for sphere in spheres)
    assert len(spheres) == balls
    assert Counter(sphere.radius for sphere in spheres) == {243 / 3**k: 9**k for k in range(level + 1)}


def test_balls_of_a_sphereflake_touch(large: ModuleType) -> None:
    """Each but the first stands on one three times its size, as far as six digits tell; no two share a place."""
    balls = [o.shape for o in parse_scene(str(large.sphereflake(2))).objects[1:]]
    for ball in balls[1:]:
        gaps = (
            abs(math.dist(ball.center, other.center) - ball.radius - other.radius)
            for other in balls
            if other.radius == 3 * ball.radius
        )
        assert min(gaps) < 1e-5
    assert len({ball.center for ball in balls}) == len(balls)


@pytest.mark.parametrize("count", [1, 10, 200])
def test_gallery(large: ModuleType, count: int) -> None:
    scene = parse_scene(str(large.gallery(count)))
    bodies = scene_facts(scene)[1:]
    assert len(bodies) == len(scene.objects) - 1 == count
    assert all(body.bounded and not body.plate for body in bodies)
    counts = [shape_kind(o.shape).count(o.shape) for o in scene.objects[1:]]
    assert all(len(body.planes) == count for body, count in zip(bodies, counts, strict=True) if body.planes)
    assert all(body.low[1] < 0 < body.high[1] for body in bodies), "each stands on the floor, a little sunk into it"
    if count == 200:
        assert {o.finish for o in scene.objects} == set(range(len(scene.finishes)))
        assert {o.pigment for o in scene.objects} == set(range(len(scene.pigments)))


def test_script(tmp_path: Path) -> None:
    file = tmp_path / "a.in"
    subprocess.run([sys.executable, LARGE, "gallery", "30", file], check=True)
    assert len(load_scene(file).objects) == 31
    written = file.read_bytes()
    subprocess.run([sys.executable, LARGE, "gallery", "30", file], check=True)
    assert file.read_bytes() == written


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("sphereflake", "8", "a.in"), "the size of a sphereflake lies between 0 and 7"),
        (("gallery", "0", "a.in"), "the size of a gallery lies between 1 and 1000000"),
        (("gallery", "1", "nowhere/a.in"), "nowhere/a.in: no such file or directory"),
    ],
)
def test_script_refuses(tmp_path: Path, arguments: tuple[str, ...], message: str) -> None:
    result = subprocess.run([sys.executable, LARGE, *arguments], capture_output=True, text=True, cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr.endswith(f"{message}\n")
    assert not list(tmp_path.iterdir())


def test_growth() -> None:
    growth = ROOT / "benchmarks" / "growth.py"
    options = ["--levels", "1", "--galleries", "3", "--renderers", "native", "--size", "8", "6", "--runs", "1"]
    out = subprocess.run([sys.executable, growth, *options], capture_output=True, text=True, check=True).stdout
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in out.splitlines() if line.startswith("| ")]
    assert [row[:2] for row in rows[1:]] == [["sphereflake 1", "11"], ["gallery 3", "4"]]
    assert all(float(number) >= 0 for row in rows[1:] for cell in row[2:] for number in cell.split(" + "))
