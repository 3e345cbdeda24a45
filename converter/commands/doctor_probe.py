"""Tries whether the renderers work, each way to run Mitsuba in a process of its own.

    python -m converter.commands.doctor_probe llvm_ad_rgb

An LLVM library that does not fit aborts the process that uses it.
"""

import ctypes
import ctypes.util
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass

from converter.commands.exits import DISAGREE, OK, UNAVAILABLE

SCENE = """
0 0 5   0 0 0   0 1 0   40
2
0 0 0   1 1 1   1 0 0
9 9 9   1 1 1   1 0 0
1   solid 1 .5 .25
1   .3 .4 .3 20 .2 0 0
2
0 0 sphere 0 0 0 1
0 0 polyhedron 1   0 1 0 1
"""
SECONDS = 120
"""A cold start takes two, on a busy machine ten."""


@dataclass(frozen=True, slots=True)
class Trial:
    """Whether something works, and what is to be told of it."""

    works: bool
    told: str


def try_native() -> Trial:
    """Draw a small picture with the native tracer."""
    from converter.renderers.base import RendererUnavailable

    try:
        seconds, _ = _draw("native")
    except RendererUnavailable as error:
        return Trial(False, str(error))
    return Trial(True, f"works, {seconds:.3f} s for a small picture")


def try_variant(variant: str) -> Trial:
    """Draw a small picture in a Mitsuba variant."""
    command = [sys.executable, "-m", __name__, variant]
    # An empty cache, so that something is compiled: a bad LLVM library is noticed only then.
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "DRJIT_CACHE_DIR": cache}
        try:
            child = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=SECONDS)
        except subprocess.TimeoutExpired:
            return Trial(False, f"no answer within {SECONDS} s")
    if child.returncode == 0:
        return Trial(True, f"works, {child.stdout.strip()}")
    complaint = _complaint(child.stderr)
    if child.returncode > 0:
        return Trial(False, f"fails: {complaint}")
    return Trial(False, f"the process dies of {signal.Signals(-child.returncode).name}: {complaint}")


def _complaint(stderr: str) -> str:
    """The line that says why: LLVM's, which is followed by a dump, else the last, as in tracebacks."""
    lines = [line.strip() for line in stderr.splitlines() if line.strip()] or ["no reason given"]
    return next((line for line in lines if line.startswith("LLVM ERROR")), lines[-1])


def cuda_device() -> str | None:
    """Name of the first CUDA device, if one answers."""
    from mitsuba_plugins.backend import has_cuda

    if not has_cuda():
        return None
    driver = ctypes.CDLL(ctypes.util.find_library("cuda"))
    name = ctypes.create_string_buffer(256)
    return name.value.decode() if driver.cuDeviceGetName(name, len(name), 0) == 0 else "nameless"


def main(variant: str) -> int:
    """Draw in `variant`, and print how that went."""
    from converter.renderers.base import RendererUnavailable

    try:
        seconds, values = _draw(variant)
    except RendererUnavailable as error:
        print(error, file=sys.stderr)
        return UNAVAILABLE
    told = f"{seconds:.1f} s for a small picture with an empty kernel cache"
    try:
        _, reference = _draw("native")
    except RendererUnavailable:
        print(told)
        return OK
    largest = max(abs(a - b) for a, b in zip(values, reference, strict=True))
    if not largest <= 1 / 255:
        print(f"its picture is wrong by {largest:.3g}", file=sys.stderr)
        return DISAGREE
    print(f"{told}, the same as the native tracer's")
    return OK


def _draw(what: str) -> tuple[float, list[float]]:
    """Seconds for a small picture by the native tracer or in a Mitsuba variant, and its values."""
    from converter.renderers.native import NativeRenderer
    from converter.scene.parser import parse_scene
    from converter.scene.settings import Settings

    started = time.perf_counter()
    scene, settings = parse_scene(SCENE), Settings(16, 12)
    if what == "native":
        rendering = NativeRenderer().render(scene, settings)
    else:
        from converter.renderers.mitsuba import MitsubaRenderer

        rendering = MitsubaRenderer(what).render(scene, settings)
    values = memoryview(rendering.pixels).cast("B").cast("f")
    return time.perf_counter() - started, [float(value) for value in values]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
