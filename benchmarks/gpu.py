"""Prints the figures of docs/figures.md that need a GPU: Mitsuba there against the native tracer on the processors.

    python benchmarks/gpu.py

Times are medians of pictures drawn again, once kernels are compiled; status 1 where no CUDA device answers.
"""

import os
import statistics
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np
from tables import print_table

from converter.compare.metrics import compare_pixels
from converter.renderers.base import Renderer
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.model import Scene
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from mitsuba_plugins.backend import has_cuda
from mitsuba_plugins.trial import cuda_device

SCENES = Path(__file__).resolve().parent.parent / "scenes"
RENDERERS: dict[str, Renderer] = {
    "native": NativeRenderer(),
    "default": MitsubaRenderer("cuda_ad_rgb"),
    "mixed": MitsubaRenderer("cuda_ad_rgb", precision="mixed"),
}
RUNS = 5
LARGE = ("figure1", 1), ("figure1", 16), ("brilliant", 1)
"""Scenes drawn at 3840 x 2160, and samples a pixel."""


def main() -> None:
    """Print both tables."""
    if not has_cuda():
        sys.exit("no CUDA device answers on this machine")
    print(f"{cuda_device()}, and {len(os.sched_getaffinity(0))} threads for native; 800 x 600: milliseconds to render,")
    print(f"medians of {RUNS}, and pixels of 480,000 that differ from native double by more than 1/255")
    print_table("gpu", ["", *heads(), "wrong", "mixed wrong"], map(_of_scene, sorted(SCENES.glob("*.in"))))
    print()
    print("3840 x 2160, and what of the default's time the kernels take")
    print_table("gpu_large", ["", *heads(), "kernels ms", "wrong", "mixed wrong"], _large())


def heads() -> list[str]:
    """The columns of times."""
    return [f"{name} ms" for name in RENDERERS]


def _of_scene(file: Path) -> list[str]:
    scene, settings = load_scene(file), Settings()
    return [file.stem, *_times(scene, settings), *_wrong(scene, settings)]


def _large() -> Iterator[list[str]]:
    for name, samples in LARGE:
        scene, settings = load_scene(SCENES / f"{name}.in"), Settings(3840, 2160, samples=samples)
        times = _times(scene, settings)
        yield [f"{name}, {samples}", *times, f"{_kernel_ms(scene, settings):.1f}", *_wrong(scene, settings)]


def _times(scene: Scene, settings: Settings) -> list[str]:
    """Milliseconds of each renderer, in turn, after pictures that are not counted: a kernel may be compiled twice."""
    draw = [partial(renderer.render, scene, settings) for renderer in RENDERERS.values()]
    rounds = [[each().seconds["render"] * 1e3 for each in draw] for _ in range(RUNS + 2)][2:]
    return [f"{statistics.median(times):.1f}" for times in zip(*rounds, strict=True)]


def _wrong(scene: Scene, settings: Settings) -> list[str]:
    truth, *others = (np.asarray(renderer.render(scene, settings).pixels) for renderer in RENDERERS.values())
    return [str(compare_pixels(truth, picture).disagreeing) for picture in others]


def _kernel_ms(scene: Scene, settings: Settings) -> float:
    """Milliseconds of the default's kernels, as the device measures them."""
    import drjit as dr

    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        dr.kernel_history_clear()
        RENDERERS["default"].render(scene, settings)
        return float(sum(entry["execution_time"] for entry in dr.kernel_history()))


if __name__ == "__main__":
    main()
