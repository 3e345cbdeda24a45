"""`whitted render`: a scene into an image file."""

import argparse
import math
import sys
from pathlib import Path

from converter.commands.exits import OK, UsageError
from converter.commands.method_options import add_method_options, check_variant, choose, native_instead
from converter.commands.options import Parser, add_reading_options, add_running_options, add_size, not_negative
from converter.commands.results import Result, TextResult
from converter.descriptors import STANDARD_OUTPUT
from converter.scene.settings import ADAPTIVE_SAMPLES


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted render",
        "SCENE OUT [WIDTH HEIGHT] [options]",
        "Draws a scene into an image file: .ppm, .png, or .exr, which keeps the colours unclamped.",
        "whitted render figure1.in figure2.png 1600 1200 --samples 9\n"
        "  whitted render figure1.in - --format png | display",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
    result.add_argument(
        "out",
        action=Result,
        metavar="OUT",
        help="the picture; its ending says what kind of file; - is the standard output",
    )
    add_size(result)
    add_reading_options(result)
    add_running_options(result)
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
        help="go on from OUT.partial, if it is there, to the same picture; keeps what is drawn, too",
    )
    return result


def _add_adaptive_options(parser: Parser) -> None:
    group = parser.add_argument_group("more samples where they matter")
    group.add_argument(
        "--adaptive",
        type=not_negative,
        metavar="LIMIT",
        help="draw a pass of --samples of pixels that are unlike a neighbour, in what their rays meet or by more than "
        "LIMIT of 255 levels, and one ray of others; in sampled scenes, passes until errors are below LIMIT; with no "
        f"--samples, a pass has {math.isqrt(ADAPTIVE_SAMPLES)} rays and there are as many",
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
    """Draw the scene."""
    check_variant(arguments, [arguments.method])
    method = choose(arguments.method, arguments)

    from converter.commands.adapting import adapting
    from converter.commands.drawing import Keeping, draw
    from converter.commands.json_out import check_json, write_json
    from converter.commands.notes import say
    from converter.files import check_target, is_special
    from converter.renderers.base import draws_in_passes

    check_json(arguments.json, [arguments.scene])
    keeping = Keeping(method.name, arguments.resume) if arguments.keep_partial or arguments.resume else None
    if arguments.adaptive_map is not None:
        check_target(arguments.adaptive_map, [arguments.scene, arguments.out])
    if arguments.resume and is_special(arguments.out):
        raise UsageError("--resume: OUT must be a file, with what was kept beside it")
    if arguments.resume and not draws_in_passes(method.renderer):
        raise UsageError(f"--resume: {method.name} draws a picture in one go")
    chooser, settings = adapting(arguments, method)
    quiet = arguments.quiet
    if quiet:
        import logging

        logging.getLogger("mitsuba_plugins").setLevel(logging.ERROR)
    with native_instead(method.name):
        rendering, stages = draw(
            method.renderer,
            arguments.scene,
            arguments.out,
            settings,
            quiet,
            keeping,
            arguments.method,
            arguments.format,
            chooser,
        )
    statistics = dict(rendering.statistics)
    if chooser is not None:
        statistics |= chooser.statistics()
        if arguments.adaptive_map is not None:
            chooser.write_map(arguments.adaptive_map)
    seconds = sum(stages.values())
    say(f"{arguments.out}: {settings.width} x {settings.height}, {method.name}, {seconds:.2f} s", quiet)
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


def _memory_peak() -> float:
    """Most memory that this process has held at once, in MiB."""
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1 << 20 if sys.platform == "darwin" else 1 << 10)
