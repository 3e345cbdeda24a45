"""Prints how much memory and time it takes to refuse a large file, by each byte of it.

    python benchmarks/refused.py [MEGABYTES]

Each file is one mistake, or nothing but: what a scene's reader keeps of a file before it knows better. A process of its
own loads it; memory is its largest resident set without that of a process that refuses a file of a few bytes.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

MEGABYTES = 10
CAMERA = "0 1 -5\n0 0 0\n0 1 0\n40\n"
LIGHT = "0 0 0 1 1 1 1 0 0\n"
REST = "1\n1 0 0 1 0 0 0\n1\n0 0 sphere 0 0 0 1\n"
HEAD = f"{CAMERA}1\n{LIGHT}1\nsolid 1 1 1\n1\n1 0 0 1 0 0 0\n"


def main() -> None:
    """Print a row for each kind of file."""
    if sys.argv[1:2] == ["--load"]:
        load(Path(sys.argv[2]))
        return
    size = int(float(sys.argv[1]) * 1e6) if sys.argv[1:] else MEGABYTES * 1_000_000
    print(f"files of {size / 1e6:g} MB that are refused: bytes of memory for each byte of the file, and seconds")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "refused.in")
        file.write_text("0\n")
        least, _, _ = refuse(file)
        for name, text in kinds(size):
            file.write_text(text)
            del text
            peak, seconds, told = refuse(file)
            shown = told.removeprefix(f"{file}:")[:70]
            print(f"{name:<40}{(peak - least) / size:>7.1f}{seconds:>8.2f}  {shown}", flush=True)


def kinds(size: int) -> Iterator[tuple[str, str]]:
    """Names and texts of so many characters, about."""
    yield "newlines", "\n" * size
    yield "blanks", " " * size
    yield "comments", "#\n" * (size // 2)
    yield "'10', a line each", "10\n" * (size // 3)
    yield "'10', all on one line", "10 " * (size // 3)
    yield "numbers behind a camera", CAMERA + "10\n" * (size // 3)
    yield "one word", "1" * size
    yield "vectors", "0 1 -5\n" * (size // 7)
    yield "names", "sphere\n" * (size // 7)
    yield "lights", _repeated(CAMERA, LIGHT, size, "x")
    yield "pigments", _repeated(f"{CAMERA}1\n{LIGHT}", "solid 1 1 1\n", size, "x")
    texmap = "texmap a 0 0 0 0 0 0 0 0\n"
    yield "textures that are missing", _repeated(f"{CAMERA}1\n{LIGHT}", texmap, size, REST)
    yield "finishes", _repeated(f"{CAMERA}1\n{LIGHT}0\n", "1 0 0 1 0 0 0\n", size, "x")
    yield "spheres, then a word", _repeated(HEAD, "0 0 sphere 0 0 0 1\n", size, "x")
    yield "spheres without a radius", _repeated(HEAD, "0 0 sphere 0 0 0 0\n", size, "")
    yield "spheres, one too few", _repeated(HEAD, "0 0 sphere 0 0 0 1\n", size, "", missing=1)
    yield "long numbers in spheres, then a word", _repeated(HEAD, "0 0 sphere 1.234 2.345 3.456 4.567\n", size, "x")
    yield "planes, then a word", _planes(size, "x")
    yield "planes without a normal", f"{HEAD}1\n0 0 polyhedron {size // 8}\n" + "0 0 0 1\n" * (size // 8)
    yield "planes that exclude each other", _planes(size, "", "1 0 0 1\n-1 0 0 1\n")


def _repeated(head: str, entry: str, size: int, tail: str, missing: int = 0) -> str:
    count = size // len(entry)
    return f"{head}{count + missing}\n{entry * count}{tail}"


def _planes(size: int, tail: str, planes: str = "1 0 0 0\n") -> str:
    times = size // len(planes)
    count = times * planes.count("\n")
    return f"{HEAD}1\n0 0 polyhedron {count}\n{planes * times}{tail}"


def refuse(file: Path) -> tuple[int, float, str]:
    """Peak memory in bytes, seconds, and the first line told, of a process that loads a file."""
    process = subprocess.Popen(
        [sys.executable, __file__, "--load", file], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout and process.stderr
    told, error = process.stdout.read(), process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(error)
    seconds, _, message = told.partition(" ")
    return usage.ru_maxrss * 1024, float(seconds), message.partition("\n")[0]


def load(file: Path) -> None:
    """Load a file that is no scene; print the seconds that this takes, and why it is none."""
    # Late: the process that prints the table stays small, for its own peak is handed down to those that it starts.
    from converter.scene.errors import SceneError
    from converter.scene.parser import load_scene

    started = time.perf_counter()
    try:
        load_scene(file)
    except SceneError as error:
        print(time.perf_counter() - started, error)
    else:
        raise SystemExit("this is a scene")


if __name__ == "__main__":
    main()
