"""Prints how time and memory grow with the number of objects, and draws a chart of it: sphereflakes and galleries.

    python benchmarks/growth.py --chart docs/growth.png
    python benchmarks/growth.py --levels 1 2 3 --galleries 10 100 --renderers native --size 320 240

Each picture is drawn in a process of its own, so that its peak memory is known, several times, so that compilation and
other first times do not count; the least time is told. The renderers take turns scene by scene. The scenes are those of
`scenes/large.py`, which show about the same whatever their size. Times of a ray are wall time by all rays that the
native tracer follows, shadow rays included, also where a renderer that does not tell its rays may follow others.
"""

import argparse
import json
import math
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from tables import print_table

LARGE = Path(__file__).resolve().parent.parent / "scenes" / "large.py"
Found = dict[str, Any]
RENDERERS = ("native", "mitsuba", "mitsuba-mesh", "mitsuba-offset", *(("povray",) if shutil.which("povray") else ()))
"""Native first: it counts the rays."""
LARGEST = 5
"""Sphereflake that others draw: a larger one takes them minutes."""
TOLD = {"native": "native", "mitsuba": "Mitsuba", "povray": "POV-Ray"}
"""Those in the table, and how they are called there."""
NAMES = {
    "native": "native",
    "mitsuba": "Mitsuba, exact (default)",
    "mitsuba-mesh": "Mitsuba, Embree and exact surfaces",
    "mitsuba-offset": "Mitsuba, Embree alone",
    "povray": "POV-Ray 3.7",
}
COLORS = {
    "native": "#0072b2",
    "mitsuba": "#d55e00",
    "mitsuba-mesh": "#e69f00",
    "mitsuba-offset": "#cc79a7",
    "povray": "#555555",
}


def main() -> None:
    """Print the table and draw the chart, or, in one of the processes, draw one picture."""
    parser = argparse.ArgumentParser(description="Draw scenes of growing size, and print times and memory.")
    parser.add_argument("--levels", type=int, nargs="*", default=[1, 2, 3, 4, 5, 6], help="sphereflakes (1 to 6)")
    parser.add_argument("--galleries", type=int, nargs="*", default=[10, 100, 1000, 10000], help="their sizes")
    parser.add_argument("--renderers", nargs="+", choices=RENDERERS, default=RENDERERS)
    parser.add_argument("--size", type=int, nargs=2, default=(800, 600), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--runs", type=int, default=3, help="times that each picture is drawn (3)")
    parser.add_argument("--limit", type=float, default=300, help="seconds after which a process is given up (300)")
    parser.add_argument("--chart", type=Path, help="draw rays a second over the number of objects into this .png")
    parser.add_argument("--one", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(draw(arguments.one, arguments.renderers[0], arguments.size, arguments.runs)))
        return
    width, height = arguments.size
    threads = len(os.sched_getaffinity(0))
    print(f"{width} x {height}, {threads} threads, least of {arguments.runs} runs; seconds are load + build + render")
    told = [name for name in arguments.renderers if name in TOLD]
    heads = ["", "objects", *(f"{TOLD[name]} {what}" for name in told for what in ("s", "ns a ray", "MiB"))]
    measured: list[tuple[str, dict[str, Found]]] = []

    def rows() -> Iterator[list[str]]:
        for kind, sizes in (("sphereflake", arguments.levels), ("gallery", arguments.galleries)):
            for size in sizes:
                found = of_scene(kind, size, arguments)
                measured.append((kind, found))
                objects = next(iter(found.values()))["objects"] if found else 0
                yield [f"{kind} {size}", f"{objects:,}", *(cell for name in told for cell in cells(found.get(name)))]

    print_table("growth", heads, rows())
    if arguments.chart:
        chart(measured, arguments.chart)


def of_scene(kind: str, size: int, arguments: argparse.Namespace) -> dict[str, Found]:
    """What is found of each renderer with a scene; the reason goes to stderr where one draws nothing."""
    found: dict[str, Found] = {}
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(folder, f"{kind}{size}.in")
        subprocess.run([sys.executable, LARGE, kind, str(size), scene], check=True)
        for renderer in arguments.renderers:
            if renderer != "native" and kind == "sphereflake" and size > LARGEST:
                continue
            result = in_process(scene, renderer, arguments)
            if isinstance(result, str):
                print(f"{renderer}, {kind} {size}: {result}", file=sys.stderr)
            else:
                found[renderer] = result
    rays = max((each["rays"] for each in found.values()), default=0)
    return {name: {**each, "rays": rays} for name, each in found.items()}


def cells(found: Found | None) -> list[str]:
    """The columns of one picture."""
    if found is None:
        return ["-", "-", "-"]
    seconds = " + ".join(f"{found.get(stage, 0):.2f}" for stage in ("load", "build", "render"))
    return [seconds, f"{nanoseconds(found):.3g}", f"{found['peak']:.0f}"]


def nanoseconds(found: Found) -> float:
    """Of a ray; NaN where nobody has counted them."""
    return 1e9 * float(found["render"]) / found["rays"] if found["rays"] else math.nan


def in_process(scene: Path, renderer: str, arguments: argparse.Namespace) -> Found | str:
    """What `draw` finds in a process of its own, or why it found nothing."""
    size = map(str, arguments.size)
    command = [sys.executable, __file__, "--one", str(scene), "--renderers", renderer, "--runs", str(arguments.runs)]
    try:
        result = subprocess.run(
            [*command, "--size", *size], capture_output=True, text=True, timeout=arguments.limit, check=True
        )
    except subprocess.TimeoutExpired:
        return f"not done in {arguments.limit:g} s"
    except subprocess.CalledProcessError as error:
        return f"failed: {(error.stderr.strip().splitlines() or [f'status {error.returncode}'])[-1]}"
    found: Found = json.loads(result.stdout)
    return found


def draw(file: Path, renderer: str, size: tuple[int, int], runs: int) -> Found:
    """Load and draw a scene; the least seconds by stage, the number of objects and rays, and the peak memory in MiB."""
    # Late: the process that prints the tables stays small, for its own peak is handed down to those that it starts.
    from converter.scene.loading import load_scene
    from converter.scene.settings import Settings

    drawer = _renderers()[renderer]()
    seconds: dict[str, float] = {}
    rays = 0
    for _ in range(runs):
        started = time.perf_counter()
        scene = load_scene(file)
        loaded = time.perf_counter() - started
        rendering = drawer.render(scene, Settings(*size))
        for stage, value in {"load": loaded, **rendering.seconds}.items():
            seconds[stage] = min(value, seconds.get(stage, math.inf))
        rays = rendering.statistics.get("rays", 0)
    who = resource.RUSAGE_CHILDREN if renderer == "povray" else resource.RUSAGE_SELF
    return {"objects": len(scene.objects), "rays": rays, "peak": resource.getrusage(who).ru_maxrss / 1024, **seconds}


def _renderers() -> dict[str, Callable[[], Any]]:
    from converter.renderers.methods import METHODS
    from converter.renderers.povray import PovrayRenderer

    return {**{name: METHODS[name].renderer for name in RENDERERS if name in METHODS}, "povray": PovrayRenderer}


def chart(measured: list[tuple[str, dict[str, Found]]], file: Path) -> None:
    """Draw million rays a second over the number of objects, a panel for each kind of scene."""
    from matplotlib.figure import Figure

    from converter.studies.figure_png import save_png

    kinds = list(dict.fromkeys(kind for kind, _ in measured))
    figure = Figure(figsize=(4.6 * len(kinds), 3.6), layout="constrained")
    panels = figure.subplots(1, len(kinds), sharey=True, squeeze=False)[0]
    for panel, kind in zip(panels, kinds, strict=True):
        for name in RENDERERS:
            points = [found[name] for k, found in measured if k == kind and name in found]
            rates = [1e3 / nanoseconds(point) for point in points]
            panel.loglog([p["objects"] for p in points], rates, "o-", color=COLORS[name], label=NAMES[name], ms=4)
        panel.set(title=kind, xlabel="objects")
        panel.grid(True, which="major", alpha=0.3)
    panels[0].set_ylabel("million rays a second")
    panels[0].legend(fontsize=8, loc="lower left")
    save_png(figure, file, 110)


if __name__ == "__main__":
    main()
