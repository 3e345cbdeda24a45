"""Whether a variant works on this machine: it draws in a process of its own, since what does not fit, an LLVM library
or a driver's compiler, aborts the process that uses it.

The answer for CUDA is remembered in the user's cache, until the device, its driver or a package changes: a trial takes
some seconds.
"""

import ctypes
import ctypes.util
import json
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from mitsuba_plugins.backend import has_cuda

PROGRAM = "converter.commands.doctor_probe"
"""Draws in the variant that it is given, and compares with the native tracer; status 0: that went well."""
SECONDS = 120
"""A cold start takes three, on a busy machine twenty."""
PACKAGES = ("mitsuba", "drjit", "whitted")
DRIVER = Path("/proc/driver/nvidia/version")


@dataclass(frozen=True, slots=True)
class Trial:
    """Whether something works, and what is to be told of it."""

    works: bool
    told: str


def try_variant(variant: str) -> Trial:
    """Draw in a Mitsuba variant."""
    command = [sys.executable, "-m", PROGRAM, variant]
    # An empty cache, so that something is compiled: only then is it noticed that the compiler does not fit.
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
    """The line that says why: a compiler's, which is followed by a dump, else the last, as in tracebacks."""
    lines = [line.strip() for line in stderr.splitlines() if line.strip()] or ["no reason given"]
    return next((line for line in lines if line.startswith(("LLVM ERROR", "ptxas"))), lines[-1])


def cuda_device() -> str | None:
    """Name of the first CUDA device, if one answers."""
    if not has_cuda():
        return None
    driver = ctypes.CDLL(ctypes.util.find_library("cuda"))
    name = ctypes.create_string_buffer(256)
    return name.value.decode() if driver.cuDeviceGetName(name, len(name), 0) == 0 else "nameless"


def cuda_trial() -> Trial:
    """The trial of cuda_ad_rgb: what is remembered of it, or else a new one."""
    try:
        known = json.loads(_memory().read_text(encoding="utf-8"))
        if known["machine"] == _machine():
            return Trial(bool(known["works"]), str(known["told"]))
    except (OSError, RuntimeError, ValueError, KeyError, TypeError):
        pass  # nothing is remembered, or nothing that can be read
    trial = try_variant("cuda_ad_rgb")
    remember_cuda(trial)
    return trial


def remember_cuda(trial: Trial) -> None:
    """Keep the outcome of a trial of cuda_ad_rgb, if there is a place for it."""
    try:
        file = _memory()
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=file.parent, suffix=".json", delete=False) as new:
            json.dump({"machine": _machine(), **asdict(trial)}, new)
        Path(new.name).replace(file)
    except (OSError, RuntimeError):
        pass  # no home, a full disk, or the like


def _memory() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()) / "whitted" / "cuda.json"


def _machine() -> dict[str, Any]:
    """All that the outcome depends on."""
    driver = DRIVER.read_text(errors="replace") if DRIVER.is_file() else ""
    return {"device": cuda_device(), "driver": driver, **{package: _version(package) for package in PACKAGES}}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
