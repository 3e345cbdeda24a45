"""`whitted compare`: how much a picture, the candidate, differs from one that is trusted, the reference."""

import argparse
import shlex
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from converter.commands.exits import DISAGREE, OK, UsageError
from converter.commands.method_options import (
    Chosen,
    add_method_options,
    check_variant,
    choose,
    method_words,
    native_instead,
)
from converter.commands.options import (
    Parser,
    add_reading_options,
    add_running_options,
    not_negative,
    pixels,
    reading_words,
    settings_from,
    whole,
)
from converter.commands.results import Result, TextResult
from converter.descriptors import STANDARD_OUTPUT
from converter.renderers.base import tells_rays

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from converter.compare.classes import Explanation
    from converter.compare.metrics import Pixels
    from converter.compare.report import Pictures, Report
    from converter.renderers.methods import Method
    from converter.scene.model import Scene
    from converter.scene.settings import Settings

FOR_IMAGES = frozenset({"--limit", "--png", "--amplify", "--json", "--quiet"})
"""Options that mean something where nothing is drawn."""


class Compared(NamedTuple):
    """What is compared: a scene drawn by two methods, or by the reference alone, or two images."""

    scene: Path | None
    reference: Path | None = None
    candidate: Path | None = None

    @property
    def files(self) -> list[Path]:
        """What is read."""
        return [file for file in self if file is not None]


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted compare",
        "SCENE [WIDTH HEIGHT] [options]\nSCENE IMAGE [WIDTH HEIGHT] [options]\nIMAGE IMAGE [options]",
        "Says how much a picture, the candidate, differs from one that is trusted, the reference:\n"
        "  SCENE        the reference is drawn by --reference (native), the candidate by --method (mitsuba)\n"
        "  SCENE IMAGE  the reference is drawn by --reference, as large as the candidate, the image\n"
        "  IMAGE IMAGE  the first is the reference, the second the candidate\n"
        "A pixel disagrees when a channel differs by more than 1/255, before anything is clamped or rounded.\n"
        "Exit status 0: they agree, 1: they do not.",
        "whitted compare figure1.in 800 600 --png difference.png\n"
        "  whitted compare figure1.in --method native-float\n  whitted compare figure1.in mine.ppm\n"
        "  whitted compare theirs.ppm mine.ppm",
    )
    result.add_argument("scene", type=Path, metavar="SCENE|IMAGE", help="the scene, or the reference")
    result.add_argument(
        "more", nargs="*", metavar="IMAGE|WIDTH HEIGHT", help="the candidate; size of the pictures to draw (800 600)"
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
        "--png",
        action=Result,
        metavar="FILE",
        help="draw both, their difference and the FLIP map side by side; - is the standard output",
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
    group.add_argument(
        "--widen",
        type=not_negative,
        metavar="ULPS",
        help="tell which of the disagreeing pixels the scene does not determine, if its numbers that are not whole are "
        "known to so many units in the last place of a double only",
    )
    group.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write every figure; - is the standard output, without the table",
    )
    group.add_argument("-q", "--quiet", action="store_true", help="no notes, no progress bar")
    add_reading_options(result)
    add_running_options(result)
    add_method_options(result, "what draws the reference", "what draws the candidate")
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

    compared = _compared(arguments)
    _check_options(arguments, compared)
    check_json(arguments.json, compared.files)
    png_ending = None
    if arguments.png is not None:
        from converter.files import check_apart, is_special
        from converter.images.write import check_writable

        png_ending = ".png" if is_special(arguments.png) and not arguments.png.suffix else None
        check_apart(arguments.png, compared.files)
        check_writable(arguments.png, png_ending)
    from converter.compare.report import make_report, to_json

    chosen: list[Chosen] = []
    if compared.scene is None:
        report = make_report(_read_both(compared, arguments.quiet), arguments.limit)
    else:
        image = None if compared.candidate is None else _read(compared.candidate)
        chosen = _chosen(arguments, compared, image)
        scene, pictures = _draw(chosen, compared, image, arguments)
        report = make_report(pictures, arguments.limit)
        undetermined = None
        if arguments.widen is not None:
            undetermined = _undetermined(scene, chosen[0].settings, report, arguments)
            report.undetermined = int(undetermined.sum())
        if image is None and report.difference.disagreeing and arguments.explain:
            report.explanation = _explained(scene, chosen, report, arguments, undetermined)
    if arguments.png is not None:
        from converter.compare.figure import draw_figure

        draw_figure(report, arguments.png, arguments.amplify, png_ending)
    if arguments.json != STANDARD_OUTPUT:
        _print(report)
        if report.difference.disagreeing and chosen:
            _print_what_to_do(arguments, compared, chosen, report)
            if compared.candidate is not None:
                _print_why(arguments, compared.candidate, chosen[0].settings)
    write_json(arguments.json, to_json(report))
    return OK if report.agrees else DISAGREE


# ------------------------------------------------------------------------------------------------- what is asked for


def is_image(file: str | Path) -> bool:
    """Whether a file is an image: by its name, or, since course programs write PPM under any, by how it begins."""
    from converter.images.ppm import is_ppm
    from converter.images.write import COMMON_ENDINGS

    if Path(file).suffix.lower() in (*COMMON_ENDINGS, ".jpeg", ".tiff", ".pgm", ".pnm", ".gif"):
        return True
    try:
        if not Path(file).is_file():  # what a pipe holds can be read once only
            return False
        with Path(file).open("rb") as opened:
            return is_ppm(opened.read(3))
    except OSError:
        return False


def _compared(arguments: argparse.Namespace) -> Compared:
    """What the arguments name; the size among them becomes `width` and `height`.

    Raises:
        UsageError: it is neither a scene with a picture or a size or both, nor two images.

    """
    first, more = arguments.scene, arguments.more
    size = more[-2:] if len(more) >= 2 else []
    others = more[: len(more) - len(size)]
    arguments.width = arguments.height = None
    if is_image(first):
        if len(more) != 1:
            raise UsageError(f"{first} is an image: expected one more, the candidate, found {len(more)} arguments")
        if not is_image(more[0]) and Path(more[0]).is_file():
            raise UsageError(f"{more[0]} is no image: a scene stands before the picture that is compared with it")
        return Compared(None, first, Path(more[0]))
    if len(others) > 1 or (len(others) == 1 and others[0].isdecimal()):
        expected = "expected a scene and perhaps a picture and perhaps WIDTH HEIGHT, or two images"
        raise UsageError(f"{expected}, found {len(more) + 1} arguments")
    if size:
        try:
            arguments.width, arguments.height = map(pixels, size)
        except argparse.ArgumentTypeError as error:
            raise UsageError(f"WIDTH and HEIGHT: each {error}") from None
    return Compared(first, None, Path(others[0]) if others else None)


def _check_options(arguments: argparse.Namespace, compared: Compared) -> None:
    """Refuse options that mean nothing for what is compared.

    Raises:
        UsageError: there is one.

    """
    if compared.candidate is None:
        return
    if compared.scene is None:
        for option in sorted(arguments.given - FOR_IMAGES):
            raise UsageError(f"{option} means nothing for two images: nothing is drawn")
    if "--method" in arguments.given:
        raise UsageError(f"--method: the candidate is {compared.candidate}; --reference says what draws the other")
    if "--explain" in arguments.given:
        raise UsageError(f"--explain compares the rays of two methods, and {compared.candidate} has none")


def _chosen(arguments: argparse.Namespace, compared: Compared, image: "Pixels | None") -> list[Chosen]:
    """The reference, and what draws the candidate, if it is drawn.

    Raises:
        UsageError: the two are one, or an option does not fit them, or the size is not the image's.

    """
    methods: list[Method] = [arguments.reference]
    if image is None:
        methods.append(arguments.method)
        if arguments.reference is arguments.method:
            raise UsageError(f"--reference and --method are both {arguments.method.name}: nothing to compare")
    else:
        height, width, _ = image.shape
        if arguments.width is not None and (arguments.width, arguments.height) != (width, height):
            given = f"{arguments.width} x {arguments.height}"
            raise UsageError(f"{compared.candidate} has {width} x {height} pixels, not {given}")
        arguments.width, arguments.height = width, height
    check_variant(arguments, methods)
    return [choose(method, arguments) for method in methods]


# ------------------------------------------------------------------------------------------------------ the pictures


def _read(file: Path) -> "Pixels":
    import numpy as np

    from converter.images.texture import read_texture

    return np.asarray(read_texture(file).texels)


def _read_both(compared: Compared, quiet: bool) -> "Pictures":
    from converter.compare.report import Pictures

    reference, candidate = compared.files
    pictures = Pictures(str(reference), str(candidate), _read(reference), _read(candidate))
    kept = [_keeps_all(file) for file in compared.files]
    if kept[0] != kept[1]:
        _clamp(pictures, candidate if kept[0] else reference, quiet)
    return pictures


def _draw(
    chosen: list[Chosen], compared: Compared, image: "Pixels | None", arguments: argparse.Namespace
) -> "tuple[Scene, Pictures]":
    """The scene by one or two methods, in turns where they draw more than once: a busy machine slows both."""
    import numpy as np

    from converter.commands.notes import depth_warning, load_with_notices, say
    from converter.commands.progress import ProgressBar
    from converter.compare.report import Pictures, Timing
    from converter.renderers.methods import METHODS

    assert compared.scene is not None
    scene = load_with_notices(compared.scene, chosen[0].settings, arguments.quiet)
    drawn: dict[str, Pixels] = {}
    timings: dict[str, Timing] = {}
    instead = "--method native-long-double" if image is None else "--reference native"
    for turn in range(1 + arguments.repeat):
        for name, renderer, settings in chosen:
            with ProgressBar(name, arguments.quiet) as progress, native_instead(name, instead):
                started = time.perf_counter()
                rendering = renderer.render(scene, settings, progress)
                spent = time.perf_counter() - started
            if turn == 0:
                timings[name] = Timing(spent, stages=rendering.seconds)
                drawn[name] = np.asarray(rendering.pixels)
                if warning := depth_warning(rendering, scene, settings, METHODS[name]):
                    say(f"warning: {name}: {warning}", arguments.quiet)
            else:
                timings[name].warm.append(spent)
    reference = chosen[0].name
    if image is None:
        candidate = chosen[1].name
        return scene, Pictures(reference, candidate, drawn[reference], drawn[candidate], timings)
    file = compared.candidate
    assert file is not None
    pictures = Pictures(reference, str(file), drawn[reference], image, timings)
    if not _keeps_all(file):
        _clamp(pictures, file, arguments.quiet)
    return scene, pictures


def _keeps_all(image: Path) -> bool:
    """Whether a file of that name holds colours beyond 0..1."""
    from converter.images.write import FLOAT_ENDINGS

    return image.suffix.lower() in FLOAT_ENDINGS


def _clamp(pictures: "Pictures", lesser: Path, quiet: bool) -> None:
    """Clamp both pictures to 0..1, since the file `lesser` can hold no more."""
    from converter.commands.notes import say
    from converter.compare.metrics import clamped

    say(f"note: {lesser} holds no colours beyond 0..1: both are clamped", quiet)
    pictures.reference_pixels = clamped(pictures.reference_pixels)
    pictures.test_pixels = clamped(pictures.test_pixels)


# ----------------------------------------------------------------------------------------------------- what is told


def _undetermined(
    scene: "Scene", settings: "Settings", report: "Report", arguments: argparse.Namespace
) -> "NDArray[np.bool_]":
    """(height, width), those of the disagreeing pixels that the scene's decimals do not determine."""
    import numpy as np

    from converter.certify.certificate import undetermined
    from converter.commands.progress import ProgressBar
    from converter.compare.metrics import LIMIT, absolute_difference

    pictures = report.pictures.reference_pixels, report.pictures.test_pixels
    disagrees = np.asarray(~(absolute_difference(*pictures) <= LIMIT).all(axis=2), np.bool_)
    with ProgressBar("certificate", arguments.quiet) as progress:
        return undetermined(scene, settings, arguments.widen, disagrees, progress)


def _explained(
    scene: "Scene",
    chosen: list[Chosen],
    report: "Report",
    arguments: argparse.Namespace,
    undetermined: "NDArray[np.bool_] | None",
) -> "Explanation | None":
    """Why pixels disagree; None where a renderer does not tell its rays."""
    from converter.compare.classes import explain, less_exact

    arithmetic = less_exact(arguments.reference, arguments.method)
    if arithmetic is None:
        return None
    pictures = report.pictures.reference_pixels, report.pictures.test_pixels
    settings = chosen[0].settings, chosen[1].settings
    renderers: list[Any] = [method.renderer for method in chosen]
    one, other = (partial(r.trace_pixels, scene, s) for r, s in zip(renderers, settings, strict=True))
    return explain(scene, pictures, settings, (one, other), arithmetic, arguments.explain, undetermined)


def _print(report: "Report") -> None:
    from converter.commands.tables import print_table
    from converter.compare.report import class_rows, difference_rows, timing_rows, verdict

    found = report.difference
    size = f"{found.width} x {found.height} pixels"
    print(f"reference: {report.pictures.reference}, which is trusted")
    print(f"candidate: {report.pictures.test}, {size}\n")
    print_table(difference_rows(report))
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


def _print_why(arguments: argparse.Namespace, candidate: Path, settings: "Settings") -> None:
    """The mistakes that lead to a picture, in a sentence."""
    from converter.commands.notes import load, say
    from converter.why.judge import judge
    from converter.why.picture import read_theirs
    from converter.why.report import verdict
    from converter.why.student import UnknownToStudent

    try:
        print(verdict(judge(load(arguments.scene), read_theirs(candidate), settings)))
    except UnknownToStudent as error:
        say(f"note: {error}", arguments.quiet)


def _print_what_to_do(
    arguments: argparse.Namespace, compared: Compared, chosen: list[Chosen], report: "Report"
) -> None:
    """How to see the rays behind the largest difference, with the options in force."""
    if not all(tells_rays(method.renderer) for method in chosen):
        return
    found = report.difference
    place = map(str, (found.largest.x, found.largest.y, found.width, found.height))
    scene = f"./{compared.scene}" if str(compared.scene).startswith("-") else str(compared.scene)
    candidate = arguments.method if compared.candidate is None else arguments.reference
    words = ["whitted", "pixel", scene, *place, *reading_words(settings_from(arguments))]
    if compared.candidate is not None and arguments.reference.name == "native":
        words += ["--picture", str(compared.candidate)]
    else:
        words += method_words(arguments.reference, candidate, arguments.variant)
    print(f"The rays behind the largest difference: {shlex.join(words)}")
