"""`whitted doctor`: what works on this machine, and what to install where something does not."""

import argparse
import os
import platform
import sys
from collections.abc import Iterator
from pathlib import Path

from converter.commands.exits import OK, UNAVAILABLE
from converter.commands.options import Parser
from converter.commands.serve import INSTALL, missing
from converter.commands.tables import print_table

PACKAGES = ("mitsuba", "drjit", "numpy", "OpenImageIO", "trimesh", "manifold3d", "flip-evaluator", "rich", "matplotlib")
KERNEL_CACHE = Path.home() / ".drjit"


def parser() -> Parser:
    """The command's arguments."""
    return Parser(
        "whitted doctor",
        "[-h]",
        "Says what works on this machine, and what to install where something does not. Each way to run Mitsuba\n"
        "draws a small picture in a process of its own. Exit status 0: both renderers work, 3: they do not.",
        "whitted doctor",
    )


def run(arguments: argparse.Namespace) -> int:
    """Try everything, and tell."""
    from converter.commands.version import version

    print_table([("whitted", version()), ("Python", f"{platform.python_version()}, {sys.executable}"), *_packages()])
    print()
    rows, advice, works = _findings()
    print_table(rows)
    for line in advice:
        print(f"\n{line}")
    print(f"\n{'All is well.' if works else 'Something is missing, see above.'}")
    return OK if works else UNAVAILABLE


def _packages() -> Iterator[tuple[str, str]]:
    from importlib.metadata import PackageNotFoundError
    from importlib.metadata import version as installed

    for name in PACKAGES:
        try:
            yield name, installed(name)
        except PackageNotFoundError:
            yield name, f"missing: pip install {name}"


def _findings() -> tuple[list[tuple[str, str]], list[str], bool]:
    """What was found, what to do about it, and whether both renderers work."""
    from converter.commands.doctor_probe import try_native
    from converter.grade.sandbox import find_walls
    from converter.renderers.native import available_cores
    from mitsuba_plugins.backend import VARIANTS, find_llvm
    from mitsuba_plugins.trial import cuda_device, remember_cuda, try_variant

    rows = [("cores", str(available_cores()))]
    advice = []
    native = try_native()
    rows.append(("native tracer", native.told))
    if not native.works:
        advice.append("The native tracer: run `make`, or `pip install .`; it needs a C++20 compiler.")

    library = find_llvm()
    rows.append(("LLVM library", f"{library.path}, {library.reason}" if library else "none that can be used"))
    device = cuda_device()
    rows.append(("CUDA device", device or "none"))
    working = []
    for variant in VARIANTS:
        if variant == "cuda_ad_rgb" and device is None:
            rows.append((variant, "needs a CUDA device"))
            continue
        trial = try_variant(variant)
        rows.append((variant, trial.told))
        if variant == "cuda_ad_rgb":
            remember_cuda(trial)
        if trial.works:
            working.append(variant)
    if device is not None and "cuda_ad_rgb" not in working:
        advice.append("CUDA failed its trial: --variant auto takes llvm_ad_rgb.")
    if not working:
        advice.append("Mitsuba does not run here; the native tracer needs none of it: --method native.")
    rows.append(("kernel cache", _kernel_cache()))
    walls = find_walls()
    rows.append(("walls for grade", walls.bubblewrap or f"none: {walls.why_not}"))
    rows.append(("page", f"needs {INSTALL}" if missing() else "whitted serve can show it"))
    return rows, advice, native.works and bool(working)


def _kernel_cache() -> str:
    """Where Dr.Jit keeps compiled kernels, and how much of them."""
    folder = Path(os.environ.get("DRJIT_CACHE_DIR") or KERNEL_CACHE)
    if not folder.is_dir():
        return f"{folder}, empty"
    sizes = [file.stat().st_size for file in folder.iterdir() if file.is_file()]
    return f"{folder}, {len(sizes)} kernels, {sum(sizes) / (1 << 20):.1f} MiB"
