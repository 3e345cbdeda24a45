"""Which renderer draws, as the arguments say."""

import argparse
from typing import TYPE_CHECKING, Any

from converter.commands.exits import UsageError

if TYPE_CHECKING:
    from converter.renderers.mitsuba import MitsubaRenderer
    from converter.renderers.native import NativeRenderer

RENDERERS = ("mitsuba", "native")
_ONLY_FOR = {"variant": "mitsuba", "intersections": "mitsuba", "precision": "native"}


def add_renderer_options(parser: argparse.ArgumentParser, choice: str | None = None) -> None:
    """Options of each renderer, and `--renderer` with `choice` as its help where there is one to be chosen."""
    group = parser.add_argument_group("the renderers")
    if choice is not None:
        group.add_argument("--renderer", choices=RENDERERS, help=choice)
    group.add_argument(
        "--variant", choices=("auto", "llvm_ad_rgb", "cuda_ad_rgb"), help="what Mitsuba runs on (auto: a GPU if any)"
    )
    group.add_argument(
        "--intersections",
        choices=("auto", "analytic", "mesh"),
        help="how Mitsuba finds what a ray hits (auto: by the size of the scene)",
    )
    group.add_argument(
        "--precision", choices=("float", "double", "long-double"), help="real numbers of the native tracer (double)"
    )


def check_renderer_options(arguments: argparse.Namespace, renderer: str) -> None:
    """Refuse an option of a renderer other than the only one that draws.

    Raises:
        UsageError: there is such an option.

    """
    for option, owner in _ONLY_FOR.items():
        if owner != renderer and getattr(arguments, option) is not None:
            raise UsageError(f"--{option} is for --renderer {owner}, and --renderer {renderer} draws")


def make_renderer(name: str, arguments: argparse.Namespace) -> "MitsubaRenderer | NativeRenderer":
    """The renderer of that name, with its options."""
    options: dict[str, Any] = {
        option: getattr(arguments, option).replace("-", " ")
        for option, owner in _ONLY_FOR.items()
        if owner == name and getattr(arguments, option, None) is not None
    }
    if name == "native":
        from converter.renderers.native import NativeRenderer

        return NativeRenderer(**options)
    from converter.renderers.mitsuba import MitsubaRenderer
    from mitsuba_plugins.backend import has_cuda

    if options.get("variant", "auto") == "auto":  # chosen here, so that the renderer's name says which it is
        options["variant"] = "cuda_ad_rgb" if has_cuda() else "llvm_ad_rgb"
    return MitsubaRenderer(**options)
