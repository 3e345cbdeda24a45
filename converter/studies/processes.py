"""Whole processes: what a user waits for who types `whitted render` and has nothing loaded yet."""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from converter.scene.settings import Settings

PATIENCE = 120.0
"""Seconds after which a process is given up."""


class ProcessFailed(Exception):  # noqa: N818 - what it says
    """A process did not draw its picture; the message says why."""


@dataclass(frozen=True, slots=True)
class Process:
    """Wall-clock seconds of a process as a whole, and those that it told by stage."""

    whole: float
    stages: Mapping[str, float]


def render_in_a_process(
    method: str, scene: Path, settings: Settings, variant: str | None = None, empty_cache: bool = False
) -> Process:
    """Draw `scene` by `whitted render --method`, its own settings changing `settings`, into a file nobody keeps.

    With `empty_cache` Dr.Jit finds no kernel that was compiled before; else it finds those of the user's cache.

    Raises:
        ProcessFailed: it failed, or took longer than `PATIENCE`.

    """
    with tempfile.TemporaryDirectory(prefix="whitted-") as folder:
        command = [sys.executable, "-m", "converter.commands.main", "render", str(scene), str(Path(folder, "a.ppm"))]
        command += [str(settings.width), str(settings.height), "--method", method, "--quiet", "--json", "-"]
        command += _arguments(settings) + ([] if variant is None else ["--variant", variant])
        environment = {**os.environ, "DRJIT_CACHE_DIR": folder} if empty_cache else None
        started = time.perf_counter()
        try:
            child = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            raise ProcessFailed(f"no answer within {PATIENCE:g} s") from None
        whole = time.perf_counter() - started
    if child.returncode != 0:
        lines = [line for line in child.stderr.splitlines() if line.strip()]
        raise ProcessFailed(lines[-1].strip() if lines else f"exit status {child.returncode}")
    return Process(whole, json.loads(child.stdout)["seconds"])


def _arguments(settings: Settings) -> list[str]:
    """The settings that a study shares among all methods, as arguments."""
    result = ["--pixel", settings.pixel, "--specular", settings.specular, "--ior", settings.ior]
    if settings.samples is not None:
        result += ["--samples", str(settings.samples)]
    result += ["--seed", str(settings.seed)]
    if settings.background is not None:
        result.append("--background=" + ",".join(map(repr, settings.background)))
    return result
