"""Prints how time and memory grow with the number of objects: sphereflakes and galleries drawn by each renderer.

    python benchmarks/growth.py
    python benchmarks/growth.py --levels 1 2 3 --galleries 10 100 --renderers native --size 320 240

Each picture is drawn in a process of its own, so that its peak memory is known, several times, so that compilation and
other first times do not count; the least time is told. The scenes are those of `scenes/large.py`, which show about the
same whatever their size. Nanoseconds a ray are wall time by all rays, shadow rays included; both renderers follow the
same ones, and the native tracer counts them. Where the time of a ray grows as the logarithm of the number of objects,
the column before the last stays the same.
"""

import argparse
import json
import math
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

LARGE = Path(__file__).resolve().parent.parent / "scenes" / "large.py"
RENDERERS = ("native", "mitsuba")
COLUMNS = ("objects", "load s", "build s", "render s", "million rays", "ns a ray", "by log2 n", "peak MiB")


def main() -> None:
    """Print the tables, or, in one of the processes, draw one picture."""
    parser = argparse.ArgumentParser(description="Draw scenes of growing size, and print times and memory.")
    parser.add_argument("--levels", type=int, nargs="*", default=[1, 2, 3, 4, 5], help="sphereflakes (1 to 5)")
    parser.add_argument("--galleries", type=int, nargs="*", default=[10, 100, 1000, 10000], help="their sizes")
    parser.add_argument("--renderers", nargs="+", choices=RENDERERS, default=RENDERERS)
    parser.add_argument("--size", type=int, nargs=2, default=(800, 600), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--runs", type=int, default=3, help="times that each picture is drawn (3)")
    parser.add_argument("--limit", type=float, default=300, help="seconds after which a process is given up (300)")
    parser.add_argument("--one", type=Path, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.one:
        print(json.dumps(draw(arguments.one, arguments.renderers[0], arguments.size, arguments.runs)))
        return
    for kind, sizes in (("sphereflake", arguments.levels), ("gallery", arguments.galleries)):
        if sizes:
            table(kind, sizes, arguments)


def table(kind: str, sizes: list[int], arguments: argparse.Namespace) -> None:
    """Print how each renderer fares with each size of a kind of scene."""
    width, height = arguments.size
    print(f"{kind}, {width} x {height}, least of {arguments.runs} runs")
    print(f"{'':<10}{'size':>7}" + "".join(f"{name:>14}" for name in COLUMNS))
    rays: dict[int, int] = {}
    with tempfile.TemporaryDirectory() as folder:
        for renderer in arguments.renderers:
            for size in sizes:
                scene = Path(folder, f"{kind}{size}.in")
                if not scene.exists():
                    subprocess.run([sys.executable, LARGE, kind, str(size), scene], check=True)
                found = in_process(scene, renderer, arguments)
                if isinstance(found, str):
                    print(f"{renderer:<10}{size:>7}  {found}", flush=True)
                    continue
                rays.setdefault(size, found["rays"])
                print(f"{renderer:<10}{size:>7}" + row(found, rays[size]), flush=True)
    print()


def row(found: dict[str, Any], rays: int) -> str:
    """The columns of one picture; `rays` is 0 where nobody has counted them."""
    nanoseconds = 1e9 * found["render"] / rays if rays else math.nan
    cells = [f"{found['objects']:>14}", *(f"{found[stage]:>14.3f}" for stage in ("load", "build", "render"))]
    cells += [f"{rays / 1e6:>14.2f}", f"{nanoseconds:>14.1f}", f"{nanoseconds / math.log2(found['objects']):>14.2f}"]
    return "".join([*cells, f"{found['peak']:>14.0f}"])


def in_process(scene: Path, renderer: str, arguments: argparse.Namespace) -> dict[str, Any] | str:
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
    found: dict[str, Any] = json.loads(result.stdout)
    return found


def draw(file: Path, renderer: str, size: tuple[int, int], runs: int) -> dict[str, Any]:
    """Load and draw a scene; the least seconds by stage, the number of objects and rays, and the peak memory in MiB."""
    # Late: the process that prints the tables stays small, for its own peak is handed down to those that it starts.
    from converter.renderers.mitsuba import MitsubaRenderer
    from converter.renderers.native import NativeRenderer
    from converter.scene.parser import load_scene
    from converter.scene.settings import Settings

    seconds: dict[str, float] = {}
    rays = 0
    for _ in range(runs):
        started = time.perf_counter()
        scene = load_scene(file)
        loaded = time.perf_counter() - started
        drawer = NativeRenderer() if renderer == "native" else MitsubaRenderer()
        rendering = drawer.render(scene, Settings(*size))
        for stage, value in {"load": loaded, **rendering.seconds}.items():
            seconds[stage] = min(value, seconds.get(stage, math.inf))
        rays = rendering.statistics.get("rays", 0)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return {"objects": len(scene.objects), "rays": rays, "peak": peak, **seconds}


if __name__ == "__main__":
    main()
