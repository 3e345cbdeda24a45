"""Prints the table of docs/certify.md: seconds of processors, what is undecided and why, what methods get wrong.

.venv/bin/python benchmarks/certify.py [--size W H] [--methods NAME,...] [SCENE...]
"""

import argparse
import time
from pathlib import Path

import numpy as np

from converter.certify.certificate import certify
from converter.renderers.base import RendererUnavailable
from converter.renderers.methods import find_method
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from native_tracer import quantize

SCENES = Path(__file__).parent.parent / "scenes"


def main() -> None:
    """Print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", nargs=2, type=int, default=(800, 600), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--methods", default="native,mitsuba,mitsuba-mesh,native-float")
    parser.add_argument("scenes", nargs="*", type=Path)
    arguments = parser.parse_args()
    width, height = arguments.size
    settings = Settings(width=width, height=height)
    names = [name for name in arguments.methods.split(",") if name]
    columns = ["", "seconds", "128 digits", "256", "512", "by ties", "undecided", *names]
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|")
    for file in arguments.scenes or sorted(SCENES.glob("*.in")):
        scene = load_scene(file)
        started = time.process_time()
        certificate = certify(scene, settings)
        used = time.process_time() - started
        rungs = np.bincount(certificate.rung.ravel(), minlength=len(certificate.digits))
        undecided = ", ".join(f"{name} {count}" for name, count in certificate.counts().items()) or "0"
        row = [
            file.stem,
            f"{sum(certificate.seconds.values()):.1f}",
            f"{used:.1f}",
            *map(str, rungs[1:]),
            str(certificate.tied.sum()),
        ]
        row.append(undecided)
        for name in names:
            try:
                method = find_method(name)
                rendering = method.renderer(None).render(scene, method.settings(settings))
            except RendererUnavailable:
                row.append("")
                continue
            levels = np.frombuffer(quantize(rendering.pixels), np.uint8).reshape(height, width, 3)
            row.append(str(int((certificate.misses(levels) > 0).sum())))
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
