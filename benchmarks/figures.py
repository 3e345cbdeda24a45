"""Prints the figures of the README: agreement of the renderers on every scene, speed on Figure 1, memory.

    python benchmarks/figures.py [agreement] [speed] [memory]

Times are medians of runs that take turns, so that a machine whose speed drifts is fair to all; they depend on the
machine, their ratios much less. POV-Ray joins where it is installed.
"""

import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from converter.compare.metrics import compare_pixels
from converter.renderers.base import Renderer
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.renderers.povray import PovrayRenderer
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

ROOT = Path(__file__).resolve().parent.parent
FIGURE1 = ROOT / "scenes" / "figure1.in"
PROGRAMS = Path(sys.executable).parent
RUNS = 11


def main() -> None:
    """Print what the command line names, or everything."""
    parts = {"agreement": agreement, "speed": speed, "memory": memory}
    for name in sys.argv[1:] or parts:
        parts[name]()
        print()


def agreement() -> None:
    """Each scene at 800 x 600: Mitsuba's default method against native double."""
    print("Agreement at 800 x 600, pixels that differ by more than 1/255 in any channel")
    print(f"{'scene':<18}{'disagree':>9}{'%':>9}{'largest':>12}{'native s':>10}{'Mitsuba s':>10}  intersections")
    for file in sorted((ROOT / "scenes").glob("*.in")):
        scene, settings = load_scene(file), Settings()
        native = NativeRenderer().render(scene, settings)
        MitsubaRenderer().render(scene, settings)
        mitsuba = MitsubaRenderer().render(scene, settings)
        metrics = compare_pixels(np.asarray(native.pixels), np.asarray(mitsuba.pixels))
        seconds = f"{native.seconds['render']:>10.3f}{mitsuba.seconds['render']:>10.3f}"
        difference = f"{metrics.disagreeing_percent:>9.4f}{metrics.largest.difference:>12.2e}"
        print(f"{file.name:<18}{metrics.disagreeing:>9}{difference}{seconds}  {mitsuba.statistics['intersections']}")


def speed() -> None:
    """Figure 1 at 800 x 600: rendering alone, warm, and whole processes."""
    scene, settings = load_scene(FIGURE1), Settings()

    def seconds(renderer: Renderer) -> Callable[[], float]:
        return lambda: renderer.render(scene, settings).seconds["render"]

    print(f"Figure 1 at 800 x 600, {len(os.sched_getaffinity(0))} threads, seconds of {RUNS} runs in turn")
    with tempfile.TemporaryDirectory() as folder:
        subjects = {
            "native double": seconds(NativeRenderer()),
            "native float": seconds(NativeRenderer("float")),
            "Mitsuba": seconds(MitsubaRenderer()),
            "Mitsuba, meshes": seconds(MitsubaRenderer(intersections="mesh")),
            "raytrace (process)": _process("raytrace", FIGURE1, Path(folder, "a.ppm")),
            "whitted render (process)": _process("whitted", "render", FIGURE1, Path(folder, "b.ppm"), "--quiet"),
        }
        if shutil.which("povray"):
            subjects["POV-Ray (trace time)"] = seconds(PovrayRenderer())
        times = _interleaved(subjects)
    print(f"{'':<26}{'median':>9}{'least':>9}{'faster than POV-Ray, medians':>32}")
    povray = statistics.median(times.get("POV-Ray (trace time)", [math.nan]))
    for name, values in times.items():
        median = statistics.median(values)
        print(f"{name:<26}{median:>9.4f}{min(values):>9.4f}{povray / median:>30.1f} x")


def memory() -> None:
    """Largest resident set of both renderers at 3840 x 2160."""
    print("Figure 1 at 3840 x 2160, one sample a pixel, largest resident set")
    for method in ("native", "mitsuba"):
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder, "large.ppm")
            options = ["--quiet", "--method", method]
            command = [PROGRAMS / "whitted", "render", FIGURE1, picture, "3840", "2160", *options]
            process = subprocess.Popen(command)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            if process.returncode != 0:
                raise SystemExit(f"whitted render --method {method} failed")
        print(f"{method:<10}{usage.ru_maxrss / 1024:>8.0f} MiB")


def _interleaved(subjects: dict[str, Callable[[], float]]) -> dict[str, list[float]]:
    """Seconds of each subject in RUNS rounds, after one that is not counted."""
    times: dict[str, list[float]] = {name: [] for name in subjects}
    for _ in range(RUNS + 1):
        for name, subject in subjects.items():
            times[name].append(subject())
    return {name: values[1:] for name, values in times.items()}


def _process(program: str, *arguments: str | Path) -> Callable[[], float]:
    def run() -> float:
        started = time.perf_counter()
        subprocess.run(
            [PROGRAMS / program, *arguments], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        return time.perf_counter() - started

    return run


if __name__ == "__main__":
    main()
