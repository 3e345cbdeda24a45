"""Prints where the native tracer's time goes on each scene that is named, or on all of the gallery: `make profile`.

    python benchmarks/hotspots.py [NAME...]

Linux's `perf` samples one thread that draws a scene again and again. What is inlined counts for the function that it is
inlined into: balls for the search. Status 1 where there is no perf, it may not sample, or the tracer has no symbols.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from tables import print_table

SCENES = Path(__file__).resolve().parent.parent / "scenes"
SECONDS = 3
PARTS = {
    "csgs": ("Csg",),
    "quadrics": ("Quadric",),
    "planes": ("ConvexPolyhedron",),
    "search and balls": ("nearest_hit", "nearest_by_rules", "find_occluder", "traverse", "ree<"),
    "shading": ("surface_at", "local_color", "Texmap", "Checker", "pigment", "power"),
    "rays": ("trace", "follow", "mirror", "PrimaryRays", "render", "memmove"),
}
"""Parts of the time, and what names of functions have in them; the first that fits counts."""
DRAW = f"""
import sys, time
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
scene, started = load_scene(sys.argv[1]), time.monotonic()
while time.monotonic() < started + {SECONDS}:
    NativeRenderer().render(scene, Settings(threads=1))
"""


def main() -> None:
    """Print the table."""
    if not shutil.which("perf"):
        sys.exit("perf is not installed (Debian: linux-perf)")
    names = sys.argv[1:] or sorted(file.stem for file in SCENES.glob("*.in"))
    print("800 x 600, native, one thread: shares of the processor time, by perf")
    print_table("profile", ["", *PARTS, "rest"], map(_row, names))


def _row(name: str) -> list[str]:
    shares: Counter[str] = Counter()
    for share, symbol in _samples(SCENES / f"{name}.in"):
        shares[next((part for part, words in PARTS.items() if any(word in symbol for word in words)), "rest")] += share
    return [name, *(f"{shares[part]:.0f} %" for part in (*PARTS, "rest"))]


def _samples(scene: Path) -> Iterator[tuple[float, str]]:
    """Percentages of the samples, and the functions that they are in."""
    with tempfile.TemporaryDirectory() as folder:
        data = str(Path(folder, "perf.data"))
        record = ["perf", "record", "--quiet", "--event", "cpu-clock", "--output", data]
        sampling = subprocess.run([*record, sys.executable, "-P", "-c", DRAW, scene], stderr=subprocess.PIPE, text=True)
        if sampling.returncode != 0:
            sys.exit(f"perf took no samples: {sampling.stderr.strip()}")
        report = ["perf", "report", "--input", data, "--stdio", "--no-children", "--fields", "overhead,symbol"]
        told = subprocess.run(report, check=True, capture_output=True, text=True).stdout
    found = re.findall(r"^ *([\d.]+)% +\[[.k]\] (.*)$", told, re.MULTILINE)
    if not any("whitted" in symbol for _, symbol in found):
        sys.exit("the tracer has no symbols: `make profile` builds one that has")
    yield from ((float(share), symbol) for share, symbol in found)


if __name__ == "__main__":
    main()
