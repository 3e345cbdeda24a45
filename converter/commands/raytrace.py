"""`raytrace SCENE OUT [WIDTH HEIGHT]`: the program that the course's statement asks for, drawn by the native tracer."""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from converter.commands.options import Parser
    from converter.scene.settings import Settings


def main(argv: Sequence[str] | None = None) -> int:
    """Run `raytrace` with these arguments, the process's own by default; return its exit status."""
    from converter.commands.exits import run
    from converter.commands.garbage import collect_seldom

    if argv is None:
        collect_seldom()
    words = list(sys.argv[1:] if argv is None else argv)
    return run("raytrace", lambda: _dispatch(words))


def parser() -> "Parser":
    """The program's arguments."""
    from converter.commands.options import Parser, add_size
    from converter.commands.results import Result

    result = Parser(
        "raytrace",
        "SCENE OUT [WIDTH HEIGHT]",
        "Draws a scene of the course with the native tracer, in double precision.\n"
        "For everything else there is `whitted`.",
        "raytrace figure1.in figure2.ppm 600 450",
    )
    result.add_argument("scene", metavar="SCENE", help="the scene file")
    result.add_argument(
        "out",
        action=Result,
        metavar="OUT",
        help="the picture: .png, .exr, ... as its ending says, else PPM; - is the standard output",
    )
    add_size(result)
    result.add_argument("-V", "--version", action="store_true", help="show the version and exit")
    return result


def _dispatch(words: list[str]) -> int:
    from converter.commands.exits import OK

    if words[:1] in (["-V"], ["--version"]):
        from converter.commands.version import version

        print(f"raytrace {version()}")
        return OK
    from pathlib import Path

    if settings := _as_stated(words):
        _draw(Path(words[0]), Path(words[1]), settings)
        return OK
    from converter.commands.options import settings_from
    from converter.commands.results import standard_output_shared

    arguments = parser().parse_args(words)
    with standard_output_shared(arguments):
        _draw(Path(arguments.scene), arguments.out, settings_from(arguments))
    return OK


def _as_stated(words: list[str]) -> "Settings | None":
    """The settings of `SCENE OUT [WIDTH HEIGHT]`, two files and small numbers: what that is takes no `argparse`, whose
    import is a tenth of drawing a small picture.
    """
    from pathlib import Path

    from converter.descriptors import named_descriptor
    from converter.scene.settings import Settings

    size = words[2:]
    if len(words) not in (2, 4) or words[0].startswith("-") or words[1].startswith("-"):
        return None
    if not all(word.isascii() and word.isdigit() and len(word) < 5 and int(word) for word in size):
        return None
    if named_descriptor(Path(words[1])) is not None:
        return None
    if not size:
        return Settings()
    return Settings(width=int(size[0]), height=int(size[1]))


def _draw(scene: "Path", out: "Path", settings: "Settings") -> None:
    from converter.commands.drawing import draw
    from converter.images.write import COMMON_ENDINGS
    from converter.renderers.native import NativeRenderer

    # The statement asks for a PPM file, whatever its name.
    known = out.suffix.lower() in (*COMMON_ENDINGS, ".jpeg", ".tiff")
    draw(NativeRenderer(), scene, out, settings, ending=None if known else ".ppm")


if __name__ == "__main__":
    sys.exit(main())
