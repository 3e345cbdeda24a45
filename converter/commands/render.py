"""`whitted render`: scenes into image files."""

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.commands.cluster_options import add_cluster_options, check_cluster_options, wants_cluster
from converter.commands.exits import OK, UsageError
from converter.commands.method_options import Chosen, add_method_options, check_variant, choose, native_instead
from converter.commands.options import Parser, add_reading_options, add_running_options, add_size, not_negative, size
from converter.commands.parts import add_part_options, with_part
from converter.commands.results import Result, TextResult
from converter.descriptors import STANDARD_OUTPUT
from converter.scene.settings import ADAPTIVE_SAMPLES

if TYPE_CHECKING:
    from converter.commands.progress import ProgressBar
    from converter.renderers.base import Rendering

_MANY = ("-o", "--out")


class _RenderParser(Parser):
    """Takes one scene and its picture, or, where `-o` is given, many scenes."""

    def parse_intermixed_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> argparse.Namespace:  # type: ignore[override]
        words = list(sys.argv[1:] if args is None else args)
        before = words[: words.index("--")] if "--" in words else words
        many = any(word in _MANY or word.startswith("--out=") or word[:2] == "-o" for word in before)
        if many and not {"-h", "--help"} & set(before):
            return _parser(Parser, many=True).parse_intermixed_args(words)
        result: argparse.Namespace = super().parse_intermixed_args(words, namespace)
        return result


def parser() -> Parser:
    """The command's arguments."""
    return _parser(_RenderParser, many=False)


def _parser(kind: type[Parser], many: bool) -> Parser:
    result = kind(
        "whitted render",
        "SCENE OUT [WIDTH HEIGHT] [options]\nSCENE... -o PATTERN [options]",
        "Draws scenes into image files: .ppm, .png, or .exr, which keeps the colours unclamped.",
        "whitted render figure1.in figure2.png 1600 1200 --samples 9\n"
        "  whitted render figure1.in - --format png | display\n"
        "  whitted render scenes/*.in -o 'pictures/{name}.png' --size 320x240",
    )
    if many:
        result.add_argument("scene", nargs="+", type=Path, metavar="SCENE")
    else:
        result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
        result.add_argument(
            "out",
            action=Result,
            metavar="OUT",
            help="the picture; its ending says what kind of file; - is the standard output",
        )
        add_size(result)
    group = result.add_argument_group("many scenes")
    group.add_argument(
        *_MANY,
        dest="pattern",
        metavar="PATTERN",
        help="the pictures of many scenes, such as 'pictures/{name}.png'; {number} is a scene's place, from 1",
    )
    group.add_argument("--size", type=size, metavar="WxH", help="WIDTH and HEIGHT in one word")
    add_reading_options(result)
    add_part_options(result)
    add_running_options(result)
    add_cluster_options(result)
    add_method_options(result)
    _add_adaptive_options(result)
    group = result.add_argument_group("what is told and kept")
    group.add_argument("-q", "--quiet", action="store_true", help="no notes, no progress bar, no closing line")
    group.add_argument(
        "--format", type=_ending, metavar="NAME", help="ppm, png, exr, ... whatever OUT ends in (PPM into a pipe)"
    )
    group.add_argument("--stats", action="store_true", help="print seconds by stage, rays and memory")
    group.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write what --stats prints; - is the standard output, without the table",
    )
    group.add_argument(
        "--keep-partial",
        action="store_true",
        help="on Ctrl-C write what is drawn, and OUT.partial for --resume if whole passes of samples are",
    )
    group.add_argument(
        "--resume",
        action="store_true",
        help="go on from OUT.partial, if it is there, to the same picture; keeps what is drawn, too; of many scenes, "
        "leave those pictures that are there already",
    )
    return result


def _add_adaptive_options(parser: Parser) -> None:
    group = parser.add_argument_group("more samples where they matter")
    group.add_argument(
        "--adaptive",
        type=not_negative,
        metavar="LIMIT",
        help="draw a pass of --samples of pixels that differ from a neighbour by more than LIMIT of 255 levels, half a "
        "pass where only what their rays meet differs, and one ray of others; in sampled scenes, passes until errors "
        f"are below LIMIT; with no --samples, a pass has {math.isqrt(ADAPTIVE_SAMPLES)} rays and there are as many",
    )
    group.add_argument(
        "--adaptive-map",
        action=Result,
        metavar="FILE",
        help="draw how many rays pixels have: white for all, black for one",
    )


def _ending(text: str) -> str:
    return f".{text.lower().removeprefix('.')}"


def run(arguments: argparse.Namespace) -> int:
    """Draw the scenes."""
    check_variant(arguments, [arguments.method])
    check_cluster_options(arguments)
    if arguments.size is not None:
        if getattr(arguments, "width", None) is not None:
            raise UsageError("--size: WIDTH and HEIGHT are given already")
        arguments.width, arguments.height = arguments.size
    method = choose(arguments.method, arguments)
    method = method._replace(settings=with_part(method.settings, arguments))
    if method.settings.crop is not None and arguments.adaptive is not None:
        raise UsageError("--adaptive: what a pixel's neighbours are decides, which a part does not have")
    if arguments.quiet:
        import logging

        logging.getLogger("mitsuba_plugins").setLevel(logging.ERROR)
    return _run_one(arguments, method) if arguments.pattern is None else _run_many(arguments, method)


def _run_one(arguments: argparse.Namespace, method: Chosen) -> int:
    from converter.commands.json_out import check_json, write_json
    from converter.commands.notes import say
    from converter.files import check_target

    check_json(arguments.json, [arguments.scene])
    if arguments.adaptive_map is not None:
        check_target(arguments.adaptive_map, [arguments.scene, arguments.out])
    if wants_cluster(arguments):
        stages, statistics = _drawn_elsewhere(arguments, method)
    else:
        _, stages, statistics = _draw(arguments, method, arguments.scene, arguments.out)
    seconds = sum(stages.values())
    size = "{} x {}".format(*method.settings.drawn_size)
    say(f"{arguments.out}: {size}, {method.name}, {seconds:.2f} s", arguments.quiet)
    if arguments.stats and arguments.json != STANDARD_OUTPUT:
        from converter.commands.tables import print_table

        rows = [(stage, f"{spent:.4f} s") for stage, spent in stages.items()]
        rows += [("all", f"{seconds:.4f} s")]
        rows += [(name.replace("_", " "), str(value)) for name, value in statistics.items()]
        rows += [("memory peak", f"{_memory_peak():.0f} MiB")]
        print_table(rows, align="lr")
    statistics["memory_peak_mib"] = _memory_peak()
    write_json(arguments.json, {"method": method.name, "seconds": stages, "statistics": statistics})
    return OK


def _drawn_elsewhere(arguments: argparse.Namespace, method: Chosen) -> tuple[dict[str, float], dict[str, Any]]:
    from converter.commands.drawing_elsewhere import check_elsewhere, draw_one_elsewhere

    check_elsewhere(arguments)
    if arguments.resume:
        raise UsageError("--resume: with --workers or --scheduler it is for many scenes, with -o")
    with native_instead(method.name):
        return draw_one_elsewhere(arguments, method)


def _run_many(arguments: argparse.Namespace, method: Chosen) -> int:
    from converter.commands.json_out import check_json, write_json
    from converter.commands.many import Keeper, check_together, draw_all, pictures_of, print_outcomes, status_of

    check_together(arguments)
    check_json(arguments.json, arguments.scene)
    pictures = pictures_of(arguments.scene, arguments.pattern)

    keeper = Keeper(arguments, method) if arguments.resume else None

    def draw_one(scene: Path, picture: Path, bar: "ProgressBar") -> "tuple[Rendering, dict[str, float]] | None":
        if keeper is not None and keeper.has(scene, picture):
            return None
        rendering, stages, _ = _draw(arguments, method, scene, picture, bar)
        if keeper is not None:
            keeper.note(picture)
        return rendering, stages

    if wants_cluster(arguments):
        from converter.commands.drawing_elsewhere import check_elsewhere, draw_elsewhere

        check_elsewhere(arguments)
        outcomes = draw_elsewhere(arguments, method, arguments.scene, pictures, keeper)
    else:
        outcomes = draw_all("whitted render", arguments.scene, pictures, draw_one, arguments.quiet)
    if not arguments.quiet and arguments.json != STANDARD_OUTPUT:
        print_outcomes(outcomes)
    found = [o._asdict() | {"scene": str(o.scene), "picture": str(o.picture)} for o in outcomes]
    write_json(arguments.json, {"method": method.name, "pictures": found, "memory_peak_mib": _memory_peak()})
    return status_of(outcomes)


def _draw(
    arguments: argparse.Namespace, method: Chosen, scene: Path, out: Path, bar: "ProgressBar | None" = None
) -> "tuple[Rendering, dict[str, float], dict[str, Any]]":
    """Draw a scene; the picture, seconds by stage, and all statistics."""
    from converter.commands.adapting import adapting, write_map
    from converter.commands.drawing import Keeping, draw
    from converter.files import is_special
    from converter.renderers.base import draws_in_passes

    resume = arguments.resume and (arguments.pattern is None or draws_in_passes(method.renderer))
    keeping = Keeping(method.name, resume) if arguments.keep_partial or resume else None
    if arguments.resume and is_special(out):
        raise UsageError("--resume: OUT must be a file, with what was kept beside it")
    if resume and not draws_in_passes(method.renderer):
        raise UsageError(f"--resume: {method.name} draws a picture in one go")
    chooser, settings = adapting(arguments, method)
    with native_instead(method.name):
        rendering, stages = draw(
            method.renderer,
            scene,
            out,
            settings,
            arguments.quiet,
            keeping,
            arguments.method,
            arguments.format,
            chooser,
            bar,
        )
    statistics = dict(rendering.statistics)
    if chooser is not None:
        statistics |= chooser.statistics()
        if arguments.adaptive_map is not None:
            write_map(arguments.adaptive_map, chooser)
    return rendering, stages, statistics


def _memory_peak() -> float:
    """Most memory that this process has held at once, in MiB."""
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)
