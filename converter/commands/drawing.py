"""From a scene file to an image file, as `raytrace` and `whitted render` do it."""

import time
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.notes import depth_warning, load_with_notices, say
from converter.commands.progress import ProgressBar
from converter.files import check_apart, is_special
from converter.frozen import dataclass
from converter.images.write import check_writable, write_image
from converter.pigments.table import pigment_kind
from converter.renderers.base import (
    Interrupted,
    Passes,
    Refinement,
    Renderer,
    Rendering,
    draws_adaptively,
    draws_in_passes,
)
from converter.scene.model import Scene
from converter.scene.settings import Settings

if TYPE_CHECKING:
    from converter.renderers.methods import Method


@dataclass(frozen=True, slots=True)
class Keeping:
    """That what is drawn when Ctrl-C comes is kept, as drawn by the method of that name; with `resume`, that drawing
    goes on from what was kept.
    """

    method: str
    resume: bool


def draw(
    renderer: Renderer,
    scene_file: Path,
    out: Path,
    settings: Settings,
    quiet: bool = False,
    keeping: Keeping | None = None,
    method: "Method | None" = None,
    ending: str | None = None,
    refinement: Refinement | None = None,
    bar: ProgressBar | None = None,
) -> tuple[Rendering, dict[str, float]]:
    """Draw a scene into an image file, which appears whole or not at all; return the picture and seconds by stage.

    With the `method` that the renderer belongs to, regions are named in which it is known to fail; None is `raytrace`.
    With `keeping`, Ctrl-C writes what is drawn before `Interrupted` goes on to the caller, and a file to go on from if
    whole passes are. `ending` chooses the image's format, if `out` does not. With `refinement`, pixels get more samples
    where it asks for them. `bar` shows how far it is, in place of one of its own.

    Raises:
        SceneError: the scene is no scene.
        OSError: the image cannot be written there, or is what the scene is read from; known before anything is drawn.
        RendererUnavailable: the renderer does not run here.
        ResumeError: what was kept is no part of this picture.
        Interrupted: Ctrl-C while drawing.

    """
    check_apart(out, [scene_file])
    check_writable(out, ending)
    started = time.perf_counter()
    scene = load_with_notices(scene_file, settings, quiet, method)
    check_apart(out, (file for pigment in scene.pigments for file in pigment_kind(pigment).files(pigment)))
    if not quiet:
        from converter.commands.readings import ior_notices_that_show

        for notice in ior_notices_that_show(scene, settings):
            say(f"note: {notice}")
    read = time.perf_counter()
    with bar or ProgressBar(out.name, quiet) as progress:
        try:
            start = _kept(scene, out, settings, keeping, quiet)
            if refinement is not None and draws_adaptively(renderer):
                rendering = renderer.render_adaptively(scene, settings, refinement, progress)
            elif start is not None and draws_in_passes(renderer):
                rendering = renderer.render(scene, settings, progress, start)
            else:
                rendering = renderer.render(scene, settings, progress)
        except Interrupted as stop:
            if keeping is not None:
                _write(stop.partial, out, ending)
                say(f"{out}: only a part of the picture{_keep(stop.partial, scene, out, settings, keeping)}", quiet)
            raise
    drawn = time.perf_counter()
    _write(rendering, out, ending)
    if keeping is not None:
        from converter.renderers.partial import partial_file

        partial_file(out).unlink(missing_ok=True)
    _warn_of_nan(rendering, out, quiet)
    if warning := depth_warning(rendering, scene, settings, method):
        say(f"warning: {out}: {warning}", quiet)
    seconds = {"read": read - started, **rendering.seconds, "write": time.perf_counter() - drawn}
    return rendering, seconds


def _kept(scene: Scene, out: Path, settings: Settings, keeping: Keeping | None, quiet: bool) -> Passes | None:
    """The passes to go on from, if that is asked for."""
    if keeping is None or not keeping.resume:
        return None
    from converter.renderers.partial import partial_file, read_partial

    file = partial_file(out)
    if not file.exists():
        say(f"note: there is no {file}: the picture is drawn from its start", quiet)
        return None
    passes = read_partial(file, scene, settings, keeping.method)
    say(f"note: {file}: {passes.done} of {passes.total} passes are drawn already", quiet)
    return passes


def _keep(partial: Rendering, scene: Scene, out: Path, settings: Settings, keeping: Keeping) -> str:
    """Write a file to go on from, if whole passes are drawn; what there is to say of it."""
    passes = partial.passes
    if passes is None or is_special(out):
        return ""
    from converter.renderers.partial import partial_file, write_partial

    file = partial_file(out)
    write_partial(file, passes, scene, settings, keeping.method)
    return f": {passes.done} of {passes.total} passes; --resume goes on from {file}"


def _write(rendering: Rendering, out: Path, ending: str | None) -> None:
    write_image(out, rendering.pixels, rendering.width, rendering.height, ending)


def _warn_of_nan(rendering: Rendering, out: Path, quiet: bool) -> None:
    """Say it where nothing less than a number's range kept a pixel from being one: most formats have black for it."""
    from native_tracer import count_nan_pixels

    if count := count_nan_pixels(rendering.pixels):
        share = f"{count} of {rendering.width * rendering.height} pixels"
        say(f"warning: {out}: {share} are NaN: the colours there exceed all numbers", quiet)
