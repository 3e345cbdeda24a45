"""Compares certified pixels with those of a tracer that shares no code with theirs, tests/arb_tracer.py.

    python benchmarks/oracle.py [--pixels N] [--size W H] [--seed S] [SCENE...]

N pixels in all (10,000), as many of each scene of the gallery, at random places of its picture. Status 1: the two
contradict each other somewhere.
"""

import argparse
import random
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

import certified_tracer
from converter.certify.scene import certified_scene
from converter.scene.model import Scene
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from arb_tracer import ArbTracer, Undecided

SCENES = Path(__file__).resolve().parent.parent / "scenes"


class Compared(NamedTuple):
    """Pixels by what the two say of them: both know the bytes, and they are the same; they are others; the certificate
    alone is undecided, or the oracle is.
    """

    same: int
    contradictions: list[tuple[int, int]]
    not_certified: int
    not_judged: int


def compare(
    scene: Scene, settings: Settings, pixels: Sequence[tuple[int, int]], judged: Scene | None = None
) -> Compared:
    """The certified bytes of pixels, columns and rows, against the oracle's, of a scene, or of another one."""
    built = certified_scene(scene, settings)
    last = len(certified_tracer.digits) - 1
    found = certified_tracer.certify(built, np.array(pixels, np.int32), 0, last, 1)
    oracle = ArbTracer(judged or scene, settings)
    same, not_certified, not_judged = 0, 0, 0
    contradictions = []
    for (x, y), reason, low, high in zip(pixels, found["reason"], found["low"], found["high"], strict=True):
        if reason:
            not_certified += 1
            continue
        try:
            levels = oracle.levels(x, y)
        except Undecided:
            not_judged += 1
            continue
        if all(a <= level <= b for a, level, b in zip(low.tolist(), levels, high.tolist(), strict=True)):
            same += 1
        else:
            contradictions.append((x, y))
    return Compared(same, contradictions, not_certified, not_judged)


def main() -> int:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pixels", type=int, default=10_000)
    parser.add_argument("--size", nargs=2, type=int, default=(800, 600), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("scenes", nargs="*", type=Path)
    arguments = parser.parse_args()
    scenes = arguments.scenes or sorted(SCENES.glob("*.in"))
    settings = Settings(*arguments.size)
    totals = np.zeros(4, int)
    print(f"{'':<14}{'the same':>10}{'contradictions':>16}{'not certified':>15}{'not judged':>12}{'seconds':>9}")
    for number, file in enumerate(scenes):
        rng = random.Random(f"{arguments.seed} {file.stem}")
        count = (arguments.pixels + number) // len(scenes)
        pixels = [(rng.randrange(settings.width), rng.randrange(settings.height)) for _ in range(count)]
        started = time.process_time()
        found = compare(load_scene(file), settings, pixels)
        counts = [found.same, len(found.contradictions), found.not_certified, found.not_judged]
        totals += counts
        places = " ".join(f"({x}, {y})" for x, y in found.contradictions[:5])
        print(f"{file.stem:<14}{_told(counts)}{time.process_time() - started:>9.1f} {places}", flush=True)
    print(f"{'all':<14}{_told(totals)}")
    return 1 if totals[1] else 0


def _told(counts: Sequence[int]) -> str:
    same, contradictions, not_certified, not_judged = counts
    return f"{same:>10}{contradictions:>16}{not_certified:>15}{not_judged:>12}"


if __name__ == "__main__":
    sys.exit(main())
