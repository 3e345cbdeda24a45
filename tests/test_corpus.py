"""Broken and hostile inputs: each is refused with a message, or used without a crash, a hang or too much memory.

corpus/refused          no scenes
corpus/drawn            scenes, however odd: huge and tiny numbers, bodies that coincide, rays without end
corpus/textures/refused images that a scene must not use
corpus/textures/drawn   odd images that it may
"""

import faulthandler
import os
import re
import subprocess
import sys
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from finite import assert_finite

from converter.commands import main, raytrace
from converter.commands.inspection import inspect_scene
from converter.errors import ExportError
from converter.images.texture import TextureError
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene import parser
from converter.scene.errors import SceneError
from converter.scene.model import Sphere
from converter.scene.parser import MOST_PROBLEMS, load_scene, parse_scene
from converter.scene.settings import Settings
from converter.to_mitsuba.export import export_scene
from converter.to_mitsuba.meshes import MeshError
from converter.to_povray.export import export_povray

CORPUS = Path(__file__).parent / "corpus"
REFUSED = sorted((CORPUS / "refused").iterdir())
DRAWN = sorted((CORPUS / "drawn").glob("*.in"))
FARTHEST_OFF = [file for file in DRAWN if not re.search("_1e-?(40|155|162)$", file.stem)]
"""Without the scenes whose odd numbers are less odd than another's."""
BAD_TEXTURES = sorted((CORPUS / "textures" / "refused").iterdir())
ODD_TEXTURES = sorted((CORPUS / "textures" / "drawn").iterdir())
SETTINGS = Settings(width=4, height=3, threads=1)
TEXTURED = """\
0 0 5
0 0 0
0 1 0
40
1
0 0 0 1 1 1 1 0 0
1
texmap {} .1 .2 .3 0 .3 .2 .1 0
1
1 0 0 1 0 0 0
1
0 0 sphere 0 0 0 2
"""
MINUTE = 60.0
"""A test that takes longer hangs: none here takes more than a few seconds."""

each = pytest.mark.parametrize
no_warning = pytest.mark.filterwarnings("error")  # one on the terminal would be as bad as a traceback


def names(files: list[Path]) -> list[str]:
    return [file.name for file in files]


@pytest.fixture(autouse=True)
def bounded() -> Iterator[None]:
    """Ends the process, with its stacks shown, where a test hangs, in native code too."""
    faulthandler.dump_traceback_later(MINUTE, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


def refusal(file: Path) -> SceneError:
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    return caught.value


# ---- Scenes that are refused -----------------------------------------------------------------------------------------


@no_warning
@each("file", REFUSED, ids=names(REFUSED))
def test_what_is_no_scene_is_refused(file: Path) -> None:
    tracemalloc.start()
    try:
        error = refusal(file)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < (1 << 20) + 500 * file.stat().st_size
    assert 1 <= len(error.problems) <= MOST_PROBLEMS
    message = str(error)
    assert len(message) < 1 << 14
    assert message.isprintable() or set(c for c in message if not c.isprintable()) == {"\n"}
    for problem in error.problems:
        place = f"{file}:{problem.line}:{problem.column}: " if problem.line else f"{file}: "
        assert str(problem).startswith(place)
        assert problem.message


@pytest.fixture
def programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[[Path], dict[str, str]]:
    """Runs every program on a scene that is no good for it; gives what each told.

    Each has to fail with status 2 and leave the files as they were, an older picture among them.
    """
    picture = tmp_path / "picture.ppm"
    pov = tmp_path / "scene.pov"
    commands: dict[str, tuple[Callable[[list[str]], int], tuple[Any, ...]]] = {
        "raytrace": (raytrace.main, (picture, 4, 3)),
        "render": (main.main, ("render", picture, 4, 3, "--method", "native-float")),
        "convert": (main.main, ("convert", tmp_path / "folder", 4, 3)),
        "convert to POV-Ray": (main.main, ("convert", pov, 4, 3)),
        "inspect": (main.main, ("inspect",)),
    }

    def run(file: Path) -> dict[str, str]:
        picture.write_bytes(b"an older picture")
        before = sorted(tmp_path.rglob("*"))
        told = {}
        for name, (program, arguments) in commands.items():
            words = [str(word) for word in arguments]
            words.insert(0 if program is raytrace.main else 1, str(file))
            capsys.readouterr()
            status = program(words)
            told[name] = capsys.readouterr().err
            assert status == 2, name
            assert "Traceback" not in told[name]
            assert picture.read_bytes() == b"an older picture"
            assert sorted(tmp_path.rglob("*")) == before, name
        return told

    return run


@no_warning
@each("file", REFUSED, ids=names(REFUSED))
def test_no_program_uses_what_is_no_scene(file: Path, programs: Callable[[Path], dict[str, str]]) -> None:
    message = f"{refusal(file)}\n"
    assert set(programs(file).values()) == {message}


def test_a_process_of_its_own_refuses_too(tmp_path: Path) -> None:
    file = CORPUS / "refused" / "millions_of_objects_announced.in"
    out = tmp_path / "picture.png"
    command = [sys.executable, "-m", "converter.commands.main", "render", str(file), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=MINUTE)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"{file}:12:1: the number of objects is given as 4000000, but 1 follows\n")
    assert not out.exists()


@each("device", ["/dev/zero", "/dev/urandom"])
def test_a_device_that_never_ends_is_no_scene(device: str) -> None:
    if not os.access(device, os.R_OK):
        pytest.skip(f"there is no {device}")
    assert "binary data" in str(refusal(Path(device)))


def test_what_is_no_text_is_read_no_farther(tmp_path: Path) -> None:
    """A gigabyte of nothing, after a comment as long as a scene."""
    file = tmp_path / "sparse.in"
    with file.open("wb") as opened:
        opened.write(b"#" * 100_000)
        opened.truncate(1 << 30)
    tracemalloc.start()
    try:
        error = refusal(file)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert "binary data (a NUL byte)" in str(error)
    assert peak < 1 << 21


def test_a_text_that_never_ends_is_no_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parser, "LONGEST", 1 << 20)
    pipe = tmp_path / "pipe.in"
    os.mkfifo(pipe)
    with (
        os.fdopen(os.open(pipe, os.O_RDWR), "wb", buffering=0) as end,
        subprocess.Popen(["yes"], stdout=end) as endless,
    ):
        error = refusal(pipe)
        endless.kill()
    assert str(error) == f"{pipe}: this is longer than any scene"


def test_links_and_folders_are_no_scenes(tmp_path: Path) -> None:
    loop = tmp_path / "loop.in"
    loop.symlink_to(loop)
    assert str(refusal(loop)).startswith(f"{loop}: ")
    assert "this is a folder" in str(refusal(tmp_path))


# ---- Scenes that are drawn -------------------------------------------------------------------------------------------


@no_warning
@each("file", DRAWN, ids=names(DRAWN))
def test_an_odd_scene_is_drawn(file: Path) -> None:
    scene = load_scene(file)
    pictures = {
        (precision, search): np.asarray(NativeRenderer(precision, search).render(scene, SETTINGS).pixels)
        for precision in ("float", "double")
        for search in ("brute", "bvh")
    }
    for precision in ("float", "double"):
        np.testing.assert_array_equal(pictures[precision, "brute"], pictures[precision, "bvh"])
    assert_finite(pictures["double", "bvh"], scene, SETTINGS)


@no_warning
@each("file", DRAWN, ids=names(DRAWN))
def test_an_odd_scene_is_inspected_and_converted(file: Path, tmp_path: Path) -> None:
    scene = load_scene(file)
    assert inspect_scene(scene, SETTINGS)["objects"]["count"] == len(scene.objects)
    folder, pov = tmp_path / "folder", tmp_path / "scene.pov"
    try:
        assert (folder / "scene.xml") in export_scene(scene, SETTINGS, folder)
    except MeshError as error:  # a mesh of single precision has its limits
        assert str(error).startswith("object ")
        assert not folder.exists()
    try:
        export_povray(scene, SETTINGS, pov)
        code = re.sub("//.*", "", pov.read_text())
        assert not re.search(r"\b(inf|nan)\b", code)
    except ExportError as error:  # so has POV-Ray
        assert "POV-Ray" in str(error)
        assert not pov.exists()


@no_warning
@each("file", FARTHEST_OFF, ids=names(FARTHEST_OFF))
def test_mitsuba_draws_an_odd_scene(file: Path, mi: Any) -> None:
    # Through the tree, whose kernel most scenes share; small scenes would each be compiled into one of their own.
    scene = load_scene(file)
    assert_finite(MitsubaRenderer(mi.variant(), "bvh").render(scene, SETTINGS).pixels, scene, SETTINGS)


@no_warning
@each("name", ["smallest", "radius_1e308", "normal_denormal", "everything_1e308", "eye_inside_everything"])
def test_mitsuba_draws_a_small_odd_scene_by_default(name: str, mi: Any) -> None:
    scene = load_scene(CORPUS / "drawn" / f"{name}.in")
    assert_finite(MitsubaRenderer(mi.variant()).render(scene, SETTINGS).pixels, scene, SETTINGS)


def test_mitsuba_draws_many_bodies_without_a_box(mi: Any) -> None:
    scene = load_scene(CORPUS / "drawn" / "radius_1e308.in")
    ball = replace(scene.objects[0], shape=Sphere((1e308, 1e308, 1e308), 1e308))
    many = replace(scene, objects=scene.objects + 40 * (ball,))
    assert_finite(MitsubaRenderer(mi.variant()).render(many, SETTINGS).pixels, many, SETTINGS)


def test_an_index_beyond_all_numbers_is_drawn() -> None:
    text = TEXTURED.replace("texmap {} .1 .2 .3 0 .3 .2 .1 0", "solid 1 1 1")
    scene = parse_scene(text.replace("1 0 0 1 0 0 0", "1 0 0 1 0 1 5e-324"))
    assert_finite(NativeRenderer().render(scene, replace(SETTINGS, ior="index")).pixels, scene, SETTINGS)


# ---- Textures --------------------------------------------------------------------------------------------------------


def textured(folder: Path, image: Path | str) -> Path:
    """A scene whose texture is a copy of `image`, or has that name."""
    if isinstance(image, Path):
        (folder / image.name).write_bytes(image.read_bytes())
        image = image.name
    file = folder / "textured.in"
    file.write_text(TEXTURED.format(image))
    return file


@no_warning
@each("image", BAD_TEXTURES, ids=names(BAD_TEXTURES))
def test_a_texture_that_is_no_image_draws_nothing(
    image: Path, tmp_path: Path, programs: Callable[[Path], dict[str, str]]
) -> None:
    file = textured(tmp_path, image)
    tracemalloc.start()
    try:
        with pytest.raises((SceneError, TextureError), match=image.name):
            NativeRenderer().render(load_scene(file), SETTINGS)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < (1 << 22) + 100 * image.stat().st_size
    out = tmp_path / "out.ppm"
    assert raytrace.main([str(file), str(out), "4", "3"]) == 2
    assert not out.exists()
    try:
        load_scene(file)
    except SceneError as error:  # the image's beginning is wrong already
        assert set(programs(file).values()) == {f"{error}\n"}


@no_warning
@each("image", ODD_TEXTURES, ids=names(ODD_TEXTURES))
def test_an_odd_texture_is_drawn(image: Path, tmp_path: Path) -> None:
    scene = load_scene(textured(tmp_path, image))
    assert_finite(NativeRenderer().render(scene, SETTINGS).pixels, scene, SETTINGS)
    export_scene(scene, SETTINGS, tmp_path / "folder")
    export_povray(scene, SETTINGS, tmp_path / "scene.pov")


def test_special_files_are_no_textures(tmp_path: Path, programs: Callable[[Path], dict[str, str]]) -> None:
    (tmp_path / "loop.ppm").symlink_to("loop.ppm")
    (tmp_path / "nowhere.ppm").symlink_to("missing.ppm")
    (tmp_path / "zero.ppm").symlink_to("/dev/zero")
    (tmp_path / "folder.ppm").mkdir()
    os.mkfifo(tmp_path / "pipe.ppm")
    for name in ("loop.ppm", "nowhere.ppm", "zero.ppm", "folder.ppm", "pipe.ppm", "x" * 5000, "..", "/", "a/b/c.ppm"):
        file = textured(tmp_path, name)
        (told,) = set(programs(file).values())
        assert told.startswith(f"{file}:8:8: texture ")


def test_a_blank_page_takes_no_more_room_than_pictures_do(tmp_path: Path) -> None:
    """17 kB that would be 1.7 GB of texels."""
    error = refusal(textured(tmp_path, CORPUS / "textures" / "refused" / "blank_page_of_a_gigabyte.png"))
    assert "it claims 12000 x 12000 pixels in 17582 bytes" in str(error)


# ---- All together ----------------------------------------------------------------------------------------------------


def test_the_whole_corpus_needs_little_memory() -> None:
    """In a process that may take half a gigabyte besides what its libraries do; a crash of native code is seen here."""
    code = """\
import resource, sys
from pathlib import Path
import numpy, OpenImageIO
from converter.renderers.native import NativeRenderer
from converter.analysis.cutoff import cutoff_bound
from converter.scene.errors import SceneError
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

pages = int(Path("/proc/self/statm").read_text().split()[0])
limit = pages * resource.getpagesize() + (1 << 29)
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
drawn = 0
for file in sorted(Path(sys.argv[1]).rglob("*.in")):
    try:
        scene = load_scene(file)
    except SceneError:
        continue
    for precision in ("float", "double", "long double"):
        NativeRenderer(precision).render(scene, Settings(width=4, height=3, threads=2))
    drawn += 1
print(drawn)
"""
    if not Path("/proc/self/statm").exists():
        pytest.skip("no /proc here")
    done = subprocess.run([sys.executable, "-c", code, str(CORPUS)], capture_output=True, text=True, timeout=2 * MINUTE)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{len(DRAWN)}\n", "")
