"""`whitted compare`: both renderers' pictures of a scene, or two image files, and what tells them apart."""

import argparse
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.commands.exits import DISAGREE, OK, UsageError
from converter.commands.method_options import Chosen, add_method_options, check_variant, choose
from converter.commands.options import Parser, add_reading_options, add_running_options, not_negative, pixels, whole

if TYPE_CHECKING:
    from converter.compare.classes import Explanation
    from converter.compare.metrics import Pixels
    from converter.compare.report import Pictures, Report
    from converter.scene.model import Scene


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted compare",
        "SCENE [WIDTH HEIGHT] [options]\nIMAGE IMAGE [options]",
        "Draws a scene by two methods, native and mitsuba, or takes two images, and says how much they differ.\n"
        "A pixel disagrees when a channel differs by more than 1/255, before anything is clamped or rounded.\n"
        "Exit status 0: they agree, 1: they do not.",
        "whitted compare figure1.in 800 600 --png difference.png\n"
        "  whitted compare figure1.in --method native-float\n  whitted compare one.png other.exr",
    )
    result.add_argument("scene", type=Path, metavar="SCENE|IMAGE", help="the scene, or the picture to be trusted")
    result.add_argument(
        "more", nargs="*", metavar="WIDTH HEIGHT|IMAGE", help="picture size (800 600); the other picture"
    )
    group = result.add_argument_group("what is told")
    group.add_argument(
        "--limit",
        type=not_negative,
        default=0.1,
        metavar="PERCENT",
        help="share of disagreeing pixels up to which they agree (%(default)s)",
    )
    group.add_argument(
        "--repeat", type=repeats, default=0, metavar="N", help="draw N times more, in turns, for the time of a warm run"
    )
    group.add_argument(
        "--png", type=Path, metavar="FILE", help="draw both, their difference and the FLIP map side by side"
    )
    group.add_argument(
        "--amplify", type=not_negative, default=10.0, metavar="F", help="factor of that difference (%(default)g)"
    )
    group.add_argument(
        "--explain",
        type=traced,
        default=256,
        metavar="N",
        help="look for the reason in the rays behind so many of the disagreeing pixels (%(default)s)",
    )
    group.add_argument("--json", metavar="FILE", help="write every figure; - is the standard output, without the table")
    group.add_argument("-q", "--quiet", action="store_true", help="no notes, no progress bar")
    add_reading_options(result)
    add_running_options(result)
    add_method_options(result, "what the picture to be trusted is drawn by")
    return result


def repeats(text: str) -> int:
    """How often more a picture is drawn."""
    return whole(text, 0, 1000)


def traced(text: str) -> int:
    """How many pixels to look into."""
    return whole(text, 0, 10000)


def run(arguments: argparse.Namespace) -> int:
    """Compare, and tell."""
    from converter.commands.json_out import check_json, write_json

    two_images = len(arguments.more) == 1 and is_image(arguments.scene)
    sources = [arguments.scene, *(Path(file) for file in arguments.more if two_images)]
    check_json(arguments.json, sources)
    if arguments.png is not None:
        from converter.files import check_apart
        from converter.images.write import check_writable

        check_apart(arguments.png, sources)
        check_writable(arguments.png)
    from converter.compare.report import make_report, to_json

    if two_images:
        report = make_report(_read_both(arguments), arguments.limit)
    else:
        scene, methods, pictures = _draw_both(arguments)
        report = make_report(pictures, arguments.limit)
        if report.difference.disagreeing and arguments.explain:
            report.explanation = _explained(scene, methods, report, arguments)
    if arguments.png is not None:
        from converter.compare.figure import draw_figure

        draw_figure(report, arguments.png, arguments.amplify)
    if arguments.json != "-":
        _print(report)
        if report.difference.disagreeing and not two_images:
            found = report.difference
            place = f"{found.largest.x} {found.largest.y} {found.width} {found.height}"
            print(f"The rays behind the largest difference: whitted pixel {arguments.scene} {place}")
    write_json(arguments.json, to_json(report))
    return OK if report.agrees else DISAGREE


def is_image(file: str | Path) -> bool:
    """Whether a file's name is an image's."""
    from converter.images.write import COMMON_ENDINGS

    return Path(file).suffix.lower() in (*COMMON_ENDINGS, ".jpeg", ".tiff", ".pgm", ".pnm", ".gif")


def _read_both(arguments: argparse.Namespace) -> "Pictures":
    """Two image files; both clamped to 0..1 where one of them can hold no more."""
    import numpy as np

    from converter.commands.notes import say
    from converter.compare.metrics import clamped
    from converter.compare.report import Pictures
    from converter.images.texture import read_texture
    from converter.images.write import FLOAT_ENDINGS

    first, second = (str(file) for file in (arguments.scene, arguments.more[0]))
    reference, test = (np.asarray(read_texture(file).texels) for file in (first, second))
    kept = [Path(file).suffix.lower() in FLOAT_ENDINGS for file in (first, second)]
    if kept[0] != kept[1]:
        say(f"note: {second if kept[0] else first} holds no colours beyond 0..1: both are clamped", arguments.quiet)
        reference, test = clamped(reference), clamped(test)
    return Pictures(first, second, reference, test)


def _draw_both(arguments: argparse.Namespace) -> "tuple[Scene, tuple[Chosen, Chosen], Pictures]":
    """The scene by both methods, in turns where they draw more than once, so that a busy machine slows both."""
    methods = _methods(arguments)

    import numpy as np

    from converter.commands.notes import load_with_notices
    from converter.commands.progress import ProgressBar
    from converter.compare.report import Pictures, Timing

    scene = load_with_notices(arguments.scene, methods[0].settings, arguments.quiet)
    drawn: dict[str, Pixels] = {}
    timings: dict[str, Timing] = {}
    for turn in range(1 + arguments.repeat):
        for name, renderer, settings in methods:
            with ProgressBar(name, arguments.quiet) as progress:
                started = time.perf_counter()
                rendering = renderer.render(scene, settings, progress)
                spent = time.perf_counter() - started
            if turn == 0:
                timings[name] = Timing(spent, stages=rendering.seconds)
                drawn[name] = np.asarray(rendering.pixels)
            else:
                timings[name].warm.append(spent)
    reference, test = timings
    return scene, methods, Pictures(reference, test, drawn[reference], drawn[test], timings)


def _explained(
    scene: "Scene", methods: tuple[Chosen, Chosen], report: "Report", arguments: argparse.Namespace
) -> "Explanation | None":
    """Why pixels disagree; None where a renderer does not tell its rays."""
    from converter.compare.classes import explain, less_exact

    arithmetic = less_exact(arguments.reference, arguments.method)
    if arithmetic is None:
        return None
    pictures = report.pictures.reference_pixels, report.pictures.test_pixels
    settings = methods[0].settings, methods[1].settings
    renderers: list[Any] = [method.renderer for method in methods]
    one, other = (partial(r.trace_pixels, scene, s) for r, s in zip(renderers, settings, strict=True))
    return explain(scene, pictures, settings, (one, other), arithmetic, arguments.explain)


def _methods(arguments: argparse.Namespace) -> tuple[Chosen, Chosen]:
    """The reference and the method."""
    size = arguments.more
    if len(size) not in (0, 2):
        raise UsageError(f"expected a scene and perhaps WIDTH HEIGHT, or two images, found {len(size) + 1} arguments")
    try:
        arguments.width, arguments.height = map(pixels, size) if size else (None, None)
    except argparse.ArgumentTypeError as error:
        raise UsageError(f"WIDTH and HEIGHT: each {error}") from None
    reference, method = arguments.reference, arguments.method
    if reference is method:
        raise UsageError(f"--reference and --method are both {method.name}: nothing to compare")
    check_variant(arguments, [reference, method])
    return choose(reference, arguments), choose(method, arguments)


def _print(report: "Report") -> None:
    from converter.commands.tables import print_table
    from converter.compare.report import class_rows, difference_rows, timing_rows, verdict

    found = report.difference
    title = f"{report.pictures.test} against {report.pictures.reference}, {found.width} x {found.height} pixels"
    print_table(difference_rows(report), title=title)
    if report.explanation is not None:
        traced = len(report.explanation.pixels)
        sampled = f", by {traced} of them" if traced < found.disagreeing else ""
        print()
        print_table(class_rows(report.explanation), title=f"what the pixels that disagree are near to{sampled}")
    if report.pictures.timings:
        print()
        header, rows = timing_rows(report.pictures.timings)
        print_table(rows, header, align="l" + "r" * (len(header) - 2) + "l")
    print(f"\n{verdict(report)}")
