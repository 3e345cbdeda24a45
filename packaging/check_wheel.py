"""Tries an installed whitted: draws a scene by every door, and compares. Takes the folder of the project's scenes.

    python packaging/check_wheel.py scenes

Where Mitsuba cannot run, the native tracer must work without it, and `whitted render` must say what is missing.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

SIZE = ("160", "120")
UNAVAILABLE = 3


def main() -> None:
    """Exit with a sentence where something does not hold."""
    scene = Path(sys.argv[1]).resolve() / "figure1.in"
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        program(work, "raytrace", str(scene), "one.ppm", *SIZE)
        program(work, "whitted", "render", str(scene), "two.ppm", *SIZE, "--method", "native", "--quiet")
        same(work / "one.ppm", work / "two.ppm", "raytrace and whitted render --method native")
        library(work, scene)
        same(work / "one.ppm", work / "three.ppm", "raytrace and the library")
        drawn = program(work, "whitted", "render", str(scene), "four.ppm", *SIZE, "--quiet", may_fail=True)
        if drawn.returncode == 0:
            same(work / "one.ppm", work / "four.ppm", "the native tracer and Mitsuba")
            program(work, "whitted", "compare", str(scene), *SIZE)
            print("both renderers draw the same picture")
        elif drawn.returncode == UNAVAILABLE and "--method native draws without Mitsuba" in drawn.stderr:
            print(f"the native tracer draws; Mitsuba does not run here: {drawn.stderr.strip()}")
        else:
            sys.exit(f"whitted render ends with status {drawn.returncode}:\n{drawn.stderr}")


def program(work: Path, name: str, *arguments: str, may_fail: bool = False) -> subprocess.CompletedProcess[str]:
    """Run a program that lies beside this Python, in the folder `work`."""
    command = [str(Path(sys.executable).parent / name), *arguments]
    ended = subprocess.run(command, cwd=work, capture_output=True, text=True, check=False)
    if ended.returncode and not may_fail:
        sys.exit(f"{' '.join([name, *arguments])} ends with status {ended.returncode}:\n{ended.stderr}")
    return ended


def library(work: Path, scene: Path) -> None:
    """Draw by `import whitted`."""
    import whitted

    whitted.render(whitted.load_scene(scene), *map(int, SIZE)).save(work / "three.ppm")


def same(one: Path, other: Path, what: str) -> None:
    """Exit unless two files hold the same bytes."""
    if one.read_bytes() != other.read_bytes():
        sys.exit(f"{what} draw different pictures")


if __name__ == "__main__":
    main()
