"""What a command tells on stderr besides errors."""

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.exits import tell
from converter.scene import loading
from converter.scene.model import Scene
from converter.scene.settings import Settings

if TYPE_CHECKING:
    from converter.renderers.base import Rendering
    from converter.renderers.methods import Method


def say(message: str, quiet: bool = False) -> None:
    """One line on stderr."""
    if not quiet:
        tell(message)


def load(path: str | Path) -> Scene:
    """The scene in a file. From then on, running out of memory can be told: scenes may be large, and so may pictures.

    Raises:
        SceneError: the file is no scene.

    """
    with suppress(ImportError):  # it is not built: whoever needs it says so
        from native_tracer import keep_reserve

        keep_reserve()
    return loading.load_scene(path)


def load_with_notices(
    path: str | Path, settings: Settings, quiet: bool = False, method: "Method | None" = None
) -> Scene:
    """The scene in a file; what is worth knowing about how it is read, and drawn by `method`, goes to stderr.

    Raises:
        SceneError: the file is no scene.

    """
    scene = load(path)
    if not quiet:
        from converter.analysis.notices import scene_notices

        for warning in scene.warnings:
            say(f"warning: {warning}")
        for notice in scene_notices(scene, settings):
            say(f"note: {notice}")
        if method is not None:
            from converter.analysis.regions.warnings import method_warnings

            for warning in method_warnings(scene, settings, method):
                say(f"warning: {warning}")
    return scene


def depth_warning(
    rendering: "Rendering", scene: Scene, settings: Settings, method: "Method | None" = None
) -> str | None:
    """In how many pixels the depth limit, and not the cut-off, dropped a ray, and which limit would do; None in none.

    `method` drew them; None is `raytrace`, which has no option for it.
    """
    from converter.scene.depth import MAX_DEPTH, depth_limit

    count = rendering.statistics.get("pixels_too_deep", 0)
    if not count:
        return None
    limit = depth_limit((scene.finishes[o.finish] for o in scene.objects), settings)
    option = "--max-depth" if method is not None else "whitted render --max-depth"
    if method is not None and "max_depth" in method.changes:
        advice = f"more is not what {method.name} follows"
    elif limit.needed is not None and limit.needed <= MAX_DEPTH:
        advice = f"{option} {limit.needed} would do"
    else:
        advice = f"{option} {MAX_DEPTH} is the most, and may not do either"
    pixels = f"{count} of {rendering.width * rendering.height} pixels"
    return f"{pixels} lack rays that --cutoff would keep, beyond {limit.bounces} bounces: {advice}"
