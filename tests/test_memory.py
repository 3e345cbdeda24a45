"""Where memory is short, programs end at once, with a sentence; and what is no scene takes little of it."""

import resource
import signal
import subprocess
import sys
import time
import tracemalloc
from pathlib import Path

import pytest

from converter.scene.errors import SceneError
from converter.scene.parser import parse_scene

MEBIBYTE = 1 << 20
PATIENCE = 300.0
"""Seconds after which a process hangs: none here takes more than a few, where nothing else runs."""
CAMERA = "0 1 -5\n0 0 0\n0 1 0\n40\n"
LIGHT = "0 0 0 1 1 1 1 0 0\n"
HEAD = f"{CAMERA}1\n{LIGHT}1\nsolid 1 1 1\n1\n1 0 0 1 0 0 0\n"
SCENES = Path(__file__).parent.parent / "scenes"
RAYTRACE, WHITTED = "converter.commands.raytrace", "converter.commands.main"


def limited(room: int, *arguments: str | Path) -> "subprocess.CompletedProcess[str]":
    """A Python process that may take so many bytes of address space."""
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (room, room)),
    )


@pytest.fixture(scope="module")
def many_bodies(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of ten thousand boxes and as many balls, which need 100 MiB in all."""
    file = tmp_path_factory.mktemp("many") / "many.in"
    box = "0 0 polyhedron 6\n1 0 0 -1.5\n-1 0 0 -1.5\n0 1 0 -1.5\n0 -1 0 -1.5\n0 0 1 -1.5\n0 0 -1 -1.5\n"
    balls = "".join(f"0 0 sphere {i}.25 {i}.5 {i}.75 1\n" for i in range(10_000))
    file.write_text(f"{HEAD}20000\n{box * 10_000}{balls}")
    return file


@pytest.mark.parametrize("mebibytes", [48, 56, 64, 72, 80, 96, 128, 1024])
def test_a_large_scene_is_drawn_or_told_to_be_too_large(mebibytes: int, many_bodies: Path, tmp_path: Path) -> None:
    out = tmp_path / "picture.ppm"
    done = limited(mebibytes * MEBIBYTE, "-m", RAYTRACE, many_bodies, out, "8", "6")
    if mebibytes == 1024:
        assert (done.returncode, done.stderr) == (0, "")
    if done.returncode:
        assert (done.returncode, done.stderr) == (2, "raytrace: not enough memory\n")
    assert out.exists() == (done.returncode == 0)


def test_a_picture_beyond_all_memory_is_told(tmp_path: Path, many_bodies: Path) -> None:
    done = limited(512 * MEBIBYTE, "-m", RAYTRACE, many_bodies, tmp_path / "picture.ppm", "30000", "20000")
    assert (done.returncode, done.stderr) == (2, "raytrace: not enough memory\n")


def test_mitsuba_says_that_it_needs_more(tmp_path: Path, many_bodies: Path) -> None:
    done = limited(600 * MEBIBYTE, "-m", WHITTED, "render", many_bodies, tmp_path / "picture.ppm", "8", "6", "-q")
    assert done.returncode == 2
    needs = "Mitsuba needs 1024 MiB of address space, and 600 are allowed (ulimit -v); --method native needs less"
    assert done.stderr == f"whitted render: not enough memory: {needs}\n"


THREADS = """
import resource, sys
import numpy as np
from pathlib import Path
from converter.certify.certificate import certify
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.student import make_student

scene = load_scene(Path(sys.argv[1]))
places = np.argwhere(np.ones((160, 120), bool)).astype(np.int32)

def drawn(threads):
    settings = Settings(160, 120, threads=threads, max_depth=2)
    if sys.argv[2] == "native":
        return bytes(NativeRenderer().render(scene, settings).pixels)
    if sys.argv[2] == "certify":
        return certify(scene, settings).low.tobytes()
    return make_student(scene, settings).colors(places, [frozenset()]).tobytes()

def leave(stacks):
    held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (held + int(stacks * (1 << 30)), resource.RLIM_INFINITY))

alone = drawn(1)
leave(2.5)
print(drawn(8) == alone)
leave(0.5)
try:
    print(drawn(8) == alone)
except MemoryError:
    print("no memory")
"""


@pytest.mark.parametrize(("tracer", "told"), [("native", "no memory"), ("certify", "no memory"), ("student", "True")])
def test_fewer_threads_draw_where_there_is_no_room_for_more(tracer: str, told: str) -> None:
    """Their stacks take a gibibyte each. The student's tracer draws with the thread that called it, too."""
    stack = 1 << 30
    most = resource.getrlimit(resource.RLIMIT_STACK)[1]
    if most != resource.RLIM_INFINITY and most < stack:
        pytest.skip("stacks may not be so large")
    done = subprocess.run(
        [sys.executable, "-c", THREADS, SCENES / "whitted.in", tracer],
        capture_output=True,
        text=True,
        timeout=PATIENCE,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_STACK, (stack, most)),
    )
    assert (done.returncode, done.stdout) == (0, f"True\n{told}\n"), done.stderr


def test_a_reserve_is_left_where_memory_is_not() -> None:
    """Without one, CPython does not get out of the handler below, whose place in the code is a number to allocate."""
    lines = "\n".join(f"    x{i} = {i}" for i in range(400))
    code = f"""\
def fill():
{lines}
    numbers = [None] * 5_000_000
    try:
        for i in range(len(numbers)):
            numbers[i] = i
    finally:
        print("finally")
from native_tracer import keep_reserve
keep_reserve()
try:
    fill()
except MemoryError:
    print("told")
"""
    done = limited(128 * MEBIBYTE, "-c", code)
    assert (done.returncode, done.stdout) == (0, "finally\ntold\n"), done.stderr


def test_a_termination_is_obeyed_while_a_scene_is_read(tmp_path: Path) -> None:
    file = tmp_path / "large.in"
    file.write_text(f"{HEAD}1000000\n" + "0 0 sphere 1.25 2.5 3.75 1\n" * 1_000_000)
    command = [sys.executable, "-m", RAYTRACE, str(file), str(tmp_path / "picture.ppm")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        until = time.monotonic() + PATIENCE
        while _bytes_read(process.pid) < file.stat().st_size:  # then numbers are made of them, which takes a while
            assert process.poll() is None and time.monotonic() < until
            time.sleep(0.001)
        process.send_signal(signal.SIGTERM)
        _, told = process.communicate(timeout=PATIENCE)
    assert (process.returncode, told) == (143, "raytrace: interrupted\n")
    assert list(tmp_path.iterdir()) == [file]


def _bytes_read(pid: int) -> int:
    return int(Path(f"/proc/{pid}/io").read_text().split()[1])


SIZE = 200_000
KINDS = {
    "newlines": "\n" * SIZE,
    "comments": "#\n" * (SIZE // 2),
    "a number a line": "10\n" * (SIZE // 3),
    "numbers on a line": "10 " * (SIZE // 3),
    "numbers behind a camera": CAMERA + "10\n" * (SIZE // 3),
    "one word": "1" * SIZE,
    "lights": f"{CAMERA}{SIZE // 18}\n{LIGHT * (SIZE // 18)}x",
    "balls": f"{HEAD}{SIZE // 19}\n" + "0 0 sphere 0 0 0 1\n" * (SIZE // 19) + "x",
    "balls without a radius": f"{HEAD}{SIZE // 19}\n" + "0 0 sphere 0 0 0 0\n" * (SIZE // 19),
    "planes": f"{HEAD}1\n0 0 polyhedron {SIZE // 8}\n" + "1 0 0 0\n" * (SIZE // 8) + "x",
    "a word too many at every ball": f"{HEAD}{SIZE // 21}\n" + "0 0 sphere 0 0 0 1 5\n" * (SIZE // 21),
}


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_refused_takes_little_memory(kind: str) -> None:
    data = KINDS[kind].encode()
    tracemalloc.start()
    try:
        with pytest.raises(SceneError):
            parse_scene(data)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 20 * len(data) + 5 * MEBIBYTE // 2
