"""Prints the table of docs/certify.md: processor seconds, what is undecided and why, and what methods get wrong.

.venv/bin/python benchmarks/certify.py [--size W H] [--methods NAME,...] [SCENE...]

Of the pixels that a method gets wrong those by more than a level stand in brackets. A cell is empty where a method is
missing, or does not draw such a scene.
"""

import argparse
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from tables import print_table

from converter.certify.certificate import certify, levels
from converter.renderers.base import RendererUnavailable
from converter.renderers.methods import Method, find_method
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

SCENES = Path(__file__).resolve().parent.parent / "scenes"


def main() -> None:
    """Print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", nargs=2, type=int, default=(400, 300), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--methods", default="native,mitsuba,mitsuba-mesh,native-float,povray")
    parser.add_argument("scenes", nargs="*", type=Path)
    arguments = parser.parse_args()
    settings = Settings(*arguments.size)
    methods = [find_method(name) for name in arguments.methods.split(",")]
    files = arguments.scenes or sorted(SCENES.glob("*.in"))
    columns = ["", "seconds", "128 digits", "256", "512", "by ties", "undecided", *(method.name for method in methods)]
    print_table("certified", columns, (_row(file, settings, methods) for file in files))


def _row(file: Path, settings: Settings, methods: Sequence[Method]) -> list[str]:
    """A scene's."""
    scene = load_scene(file)
    started = time.process_time()
    certificate = certify(scene, settings)
    seconds = time.process_time() - started
    rungs = np.bincount(certificate.rung.ravel(), minlength=len(certificate.digits))
    undecided = ", ".join(f"{name} {count}" for name, count in certificate.counts().items()) or "0"
    row = [file.stem, f"{seconds:.1f}", *map(str, rungs[1:]), str(certificate.tied.sum())]
    row.append(undecided)
    for method in methods:
        try:
            rendering = method.renderer(None).render(scene, method.settings(settings))
        except RendererUnavailable:
            row.append("")
            continue
        misses = certificate.misses(levels(rendering))
        wrong, more = int((misses > 0).sum()), int((misses > 1).sum())
        row.append(f"{wrong} ({more})" if more else str(wrong))
    return row


if __name__ == "__main__":
    main()
