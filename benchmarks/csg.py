"""Prints how many pixels disagree in random csgs, of 2 to 64 leaves, nested, many of whose faces coincide.

    python benchmarks/csg.py             300 scenes, drawn by native and mitsuba
    python benchmarks/csg.py 40 --first 500 --methods native native-long-double --size 320 240

The scenes are those of `scenes/random_csg.py`, each as large as a power of ten from 1e-6 to 1e6. Every pair of methods
is compared. Compiling Mitsuba's kernels takes most of the time; `--leaves 12` leaves out csgs of more leaves. Status 1:
some pixels disagree.
"""

import argparse
import sys
import time
from collections import Counter, defaultdict
from itertools import combinations
from pathlib import Path

import numpy as np

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.scene.model import Csg, Scene
from converter.scene.parser import parse_scene
from converter.scene.settings import Settings
from converter.shapes.csg_program import program_of
from converter.to_povray.scale import scaled

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "scenes"))

from random_csg import random_csg_scene

USUAL = ("native", "mitsuba")
LARGEST = 6
"""Sizes are powers of ten up to this one, and down to its reciprocal."""


def main() -> int:
    """Draw, compare and print; return the status."""
    parser = argparse.ArgumentParser(description="Count pixels that disagree in random csgs.")
    parser.add_argument("count", type=int, nargs="?", default=300, help="how many scenes (300)")
    parser.add_argument("--first", type=int, default=0, help="the number of the first one (0)")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=USUAL, help="two or more of `whitted methods`")
    parser.add_argument("--size", type=int, nargs=2, default=(160, 120), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--leaves", type=int, default=64, help="most leaves that matter (64)")
    arguments = parser.parse_args()
    width, height = arguments.size
    pairs = list(combinations(arguments.methods, 2))
    disagreeing: Counter[tuple[str, str]] = Counter()
    seconds: dict[str, float] = defaultdict(float)
    renderers = {name: METHODS[name].renderer() for name in arguments.methods}
    drawn = 0
    for seed in range(arguments.first, arguments.first + arguments.count):
        scene = random_scene(seed)
        leaves = max(len(program_of(o.shape).leaves) for o in scene.objects if isinstance(o.shape, Csg))
        if leaves > arguments.leaves:
            continue
        drawn += 1
        pictures = {}
        for name, renderer in renderers.items():
            started = time.perf_counter()
            settings = METHODS[name].settings(Settings(width, height))
            pictures[name] = np.asarray(renderer.render(scene, settings).pixels)
            seconds[name] += time.perf_counter() - started
        for a, b in pairs:
            count = int((~(np.abs(pictures[a] - pictures[b]) <= LIMIT).all(axis=2)).sum())
            disagreeing[a, b] += count
            if count:
                print(f"number {seed}, of {leaves} leaves, {size_of(seed):g} large: {a} and {b}, {count}", flush=True)
    for a, b in pairs:
        total = f"{drawn * width * height:,} pixels of {drawn} scenes"
        print(f"{a} and {b} disagree in {disagreeing[a, b]} of {total}")
    print(", ".join(f"{name} {spent:.0f} s" for name, spent in seconds.items()))
    return 1 if disagreeing.total() else 0


def size_of(seed: int) -> float:
    """How large a scene is."""
    return 10.0 ** (seed % (2 * LARGEST + 1) - LARGEST)


def random_scene(seed: int) -> Scene:
    """The scene with this number."""
    return scaled(parse_scene(str(random_csg_scene(seed))), size_of(seed))


if __name__ == "__main__":
    sys.exit(main())
