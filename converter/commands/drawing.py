"""From a scene file to an image file, as `raytrace` and `whitted render` do it."""

import time
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.notes import depth_warning, load_with_notices, say
from converter.commands.progress import ProgressBar
from converter.files import check_apart
from converter.images.write import check_writable, write_image
from converter.renderers.base import Interrupted, Renderer, Rendering
from converter.scene.model import Texmap
from converter.scene.settings import Settings

if TYPE_CHECKING:
    from converter.renderers.methods import Method


def draw(
    renderer: Renderer,
    scene_file: Path,
    out: Path,
    settings: Settings,
    quiet: bool = False,
    keep_partial: bool = False,
    method: "Method | None" = None,
    ending: str | None = None,
) -> tuple[Rendering, dict[str, float]]:
    """Draw a scene into an image file, which appears whole or not at all; return the picture and seconds by stage.

    With the `method` that the renderer belongs to, regions are named in which it is known to fail; None is `raytrace`.
    With `keep_partial`, Ctrl-C writes what is finished before `Interrupted` goes on to the caller. `ending` chooses the
    image's format, if `out` does not.

    Raises:
        SceneError: the scene is no scene.
        OSError: the image cannot be written there, or is what the scene is read from; known before anything is drawn.
        RendererUnavailable: the renderer does not run here.
        Interrupted: Ctrl-C while drawing.

    """
    check_apart(out, [scene_file])
    check_writable(out, ending)
    started = time.perf_counter()
    scene = load_with_notices(scene_file, settings, quiet, method)
    check_apart(out, (pigment.file for pigment in scene.pigments if isinstance(pigment, Texmap)))
    if not quiet:
        from converter.commands.readings import ior_notices_that_show

        for notice in ior_notices_that_show(scene, settings):
            say(f"note: {notice}")
    read = time.perf_counter()
    with ProgressBar(out.name, quiet) as progress:
        try:
            rendering = renderer.render(scene, settings, progress)
        except Interrupted as stop:
            if keep_partial:
                _write(stop.partial, out, ending)
                say(f"{out}: only a part of the picture", quiet)
            raise
    drawn = time.perf_counter()
    _write(rendering, out, ending)
    _warn_of_nan(rendering, out, quiet)
    if warning := depth_warning(rendering, scene, settings, method):
        say(f"warning: {out}: {warning}", quiet)
    seconds = {"read": read - started, **rendering.seconds, "write": time.perf_counter() - drawn}
    return rendering, seconds


def _write(rendering: Rendering, out: Path, ending: str | None) -> None:
    write_image(out, rendering.pixels, rendering.width, rendering.height, ending)


def _warn_of_nan(rendering: Rendering, out: Path, quiet: bool) -> None:
    """Say it where nothing less than a number's range kept a pixel from being one: most formats have black for it."""
    from native_tracer import count_nan_pixels

    if count := count_nan_pixels(rendering.pixels):
        share = f"{count} of {rendering.width * rendering.height} pixels"
        say(f"warning: {out}: {share} are no numbers (NaN): the colours there exceed all numbers", quiet)
