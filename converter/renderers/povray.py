"""POV-Ray, seen as one of the renderers, where it is installed."""

import math
import re
import shutil
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Literal

from converter.renderers.base import Interrupted, Progress, RendererUnavailable, Rendering
from converter.scene.model import Color, Scene
from converter.scene.settings import Settings

PROGRAM = "povray"
BRIGHTEST = 8
"""A power of two. POV-Ray's files of 16 bits end at 1: it draws in light that is dimmed by this, so that they reach
this far, in steps of an 8000th."""
_RAYS = re.compile(r"^Pixels: *(\d+) *Samples: *(\d+)", re.MULTILINE)
_TRACE_TIME = re.compile(r"Trace Time:.*?\(([\d.]+) seconds\)")
_COMPLAINT = re.compile(r"((?:Parse|Fatal|Possible Parse) Error|Problem):?\s", re.IGNORECASE)


class PovrayError(RuntimeError):
    """POV-Ray gave up; the message says what it complained of."""


@dataclass(frozen=True, slots=True)
class Supersampling:
    """POV-Ray's own anti-aliasing, of pixels that are unlike their neighbours.

    Attributes:
        method: 1 draws a grid of rays then, 2 divides squares whose corners are unlike.
        threshold: sum of the channels' differences, where white is 1.
        depth: of the grid, or how often squares are halved.

    """

    method: Literal[1, 2]
    threshold: float
    depth: int = 3


@dataclass(frozen=True)
class PovrayRenderer:
    """Draws with the program `povray`, version 3.7, what `whitted convert SCENE FILE.pov` writes.

    It always draws the whole picture. Colours come in steps of an 8000th, and those beyond 0..8 are clamped before
    samples are averaged.

    Attributes:
        supersampling: in addition to what settings ask for.

    """

    supersampling: Supersampling | None = None

    def render(self, scene: Scene, settings: Settings, progress: Progress | None = None) -> Rendering:
        """Draw `scene`.

        `seconds["render"]` is POV-Ray's own trace time, `"start"` the rest of its process, `"build"` the conversion.
        `statistics["primary"]` are the rays from the eye; `["clamped"]` says whether a colour was clamped,
        `["omissions"]` what is drawn otherwise than the scene means it.

        Raises:
            RendererUnavailable: POV-Ray is not installed.
            PovrayError: it failed.
            ValueError: a texture cannot be read.
            Interrupted: Ctrl-C while it was drawing.

        """
        import numpy as np

        from converter.images.texture import read_texture
        from converter.renderers.native import available_cores
        from converter.to_povray.export import export_povray
        from converter.to_povray.scene import draw_options

        program = shutil.which(PROGRAM)
        if program is None:
            raise RendererUnavailable(
                "POV-Ray is not installed; install version 3.7 (Debian, Ubuntu: apt install povray; "
                "Fedora: dnf install povray; macOS: brew install povray)"
            )
        started = time.perf_counter()
        pixels = np.zeros((settings.height, settings.width, 3), dtype=np.float32)
        seconds = {"build": 0.0, "start": 0.0, "render": 0.0}
        n = math.isqrt(settings.rays_a_pixel())
        with tempfile.TemporaryDirectory() as folder:
            exported, _ = export_povray(*_dimmed(scene, settings), Path(folder, "scene.pov"))
            seconds["build"] = time.perf_counter() - started
            options = [*draw_options(settings), f"+WT{settings.threads or available_cores()}"]
            if self.supersampling is not None:
                options += _options(self.supersampling)
            began = time.perf_counter()
            try:
                seconds["render"], rays = _run([program, "+Iscene.pov", "+Opicture.ppm", *options], folder)
            except KeyboardInterrupt:
                raise Interrupted(Rendering(pixels, settings.width, settings.height, seconds)) from None
            seconds["start"] = time.perf_counter() - began - seconds["render"]
            fine = np.asarray(read_texture(Path(folder, "picture.ppm")).texels)
        cells = fine.reshape(settings.height, n, settings.width, n, 3)
        pixels[:] = BRIGHTEST * cells.mean(axis=(1, 3), dtype=np.float64)
        left, top, right, bottom = settings.drawn
        part = np.ascontiguousarray(pixels[top:bottom, left:right])
        if progress is not None:
            progress(1.0)
        statistics = {"primary": rays, "clamped": bool((fine >= 1).any()), "omissions": exported.omissions}
        return Rendering(part, *settings.drawn_size, seconds, statistics)


def _dimmed(scene: Scene, settings: Settings) -> tuple[Scene, Settings]:
    """All light divided by `BRIGHTEST`, which no digit is lost by."""

    def dim(color: Color) -> Color:
        red, green, blue = color
        return (red / BRIGHTEST, green / BRIGHTEST, blue / BRIGHTEST)

    lights = tuple(replace(light, color=dim(light.color)) for light in scene.lights)
    background = None if settings.background is None else dim(settings.background)
    return replace(scene, ambient=dim(scene.ambient), lights=lights), replace(settings, background=background)


def _options(how: Supersampling) -> list[str]:
    """No jitter, and differences of linear colours, as dimmed as they are."""
    threshold = f"+A{how.threshold / BRIGHTEST:.9f}"
    return [threshold, f"+AM{how.method}", f"+R{how.depth}", "-J", "Antialias_Gamma=1"]


def _run(command: list[str], folder: str) -> tuple[float, int]:
    """Run POV-Ray in `folder`, where alone it may read and write; its trace time in seconds, and rays from the eye."""
    # In a session of its own, so that Ctrl-C reaches it through us alone; and started by another thread, where Ctrl-C
    # does not come between the process and our knowing of it.
    start = partial(
        subprocess.Popen, command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True, errors="replace", start_new_session=True,
    )  # fmt: skip
    with ThreadPoolExecutor(1) as executor:
        starting = executor.submit(start)
        try:
            process = starting.result()
            _, told = process.communicate()
        except BaseException:
            if starting.exception() is None:
                starting.result().kill()
                starting.result().wait()
            raise
    found, rays = _TRACE_TIME.search(told), _RAYS.search(told)
    if process.returncode != 0 or found is None or rays is None:
        raise PovrayError(f"POV-Ray failed: {_complaint(told) or f'exit status {process.returncode}'}")
    return float(found[1]), int(rays[1]) + int(rays[2])


def _complaint(told: str) -> str:
    """The lines in which POV-Ray says what is wrong."""
    found = _COMPLAINT.search(told)
    if found is None:
        return ""
    return " ".join(told[told.rfind("\n", 0, found.start()) + 1 :].split()[:60])
