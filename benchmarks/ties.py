"""Prints how many pixels disagree in scenes of round numbers, whose rays meet edges, planes and tiles exactly.

    python benchmarks/ties.py            1,000 scenes, drawn by native, native-long-double and mitsuba
    python benchmarks/ties.py 40 --first 500 --methods native mitsuba-bvh --size 320 240

The scenes are those of `scenes/round_numbers.py`, which writes the one of a number to a file. Every pair of methods is
compared. Status 1: some pixels disagree.
"""

import argparse
import sys
import tempfile
import time
from collections import defaultdict
from itertools import combinations
from pathlib import Path

import numpy as np

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.scene.parser import parse_scene
from converter.scene.settings import Settings

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "scenes"))

from round_numbers import SQUARES, TEXTURE, round_scene

USUAL = ("native", "native-long-double", "mitsuba")


def main() -> int:
    """Draw, compare and print; return the status."""
    parser = argparse.ArgumentParser(description="Count pixels that disagree in scenes of round numbers.")
    parser.add_argument("count", type=int, nargs="?", default=1000, help="how many scenes (1000)")
    parser.add_argument("--first", type=int, default=0, help="the number of the first one (0)")
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=USUAL, help="two or more of `whitted methods`")
    parser.add_argument("--size", type=int, nargs=2, default=(160, 120), metavar=("WIDTH", "HEIGHT"))
    arguments = parser.parse_args()
    width, height = arguments.size
    pairs = list(combinations(arguments.methods, 2))
    disagreeing: dict[tuple[str, str], dict[int, int]] = {pair: {} for pair in pairs}
    seconds: dict[str, float] = defaultdict(float)
    renderers = {name: METHODS[name].renderer() for name in arguments.methods}
    seeds = range(arguments.first, arguments.first + arguments.count)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, TEXTURE).write_text(SQUARES, encoding="ascii")
        for seed in seeds:
            text = round_scene(seed)
            scene = parse_scene(str(text), Path(folder, "round.in"))
            pictures = {}
            for name, renderer in renderers.items():
                settings = METHODS[name].settings(Settings(width, height, pixel=text.pixel))
                started = time.perf_counter()
                pictures[name] = np.asarray(renderer.render(scene, settings).pixels)
                seconds[name] += time.perf_counter() - started
            for a, b in pairs:
                count = int((~(np.abs(pictures[a] - pictures[b]) <= LIMIT).all(axis=2)).sum())
                if count:
                    disagreeing[a, b][seed] = count
    pixels = arguments.count * width * height
    print(f"{arguments.count} scenes of round numbers, {width} x {height}, {pixels:,} pixels")
    print("seconds: " + ", ".join(f"{name} {spent:.0f}" for name, spent in seconds.items()))
    for (a, b), found in disagreeing.items():
        print(f"{a} against {b}: {sum(found.values())} pixels disagree, in {len(found)} scenes")
        if found:
            print("  " + ", ".join(f"{seed}: {count}" for seed, count in found.items()))
    return 1 if any(disagreeing.values()) else 0


if __name__ == "__main__":
    raise SystemExit(main())
