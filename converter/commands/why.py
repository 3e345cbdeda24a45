"""`whitted why`: the mistakes that lead from a scene to a picture."""

import argparse
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.exits import DISAGREE, OK
from converter.commands.options import Parser, add_reading_options, reading_words, settings_from
from converter.commands.results import Result, TextResult
from converter.descriptors import STANDARD_OUTPUT

if TYPE_CHECKING:
    from converter.why.judge import Judged
    from converter.why.left import Place


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted why",
        "SCENE PICTURE [options]",
        "Names the mistakes that lead from a scene to a picture of it, by making them: a small tracer of its own is\n"
        "tried with each mistake that students are known to make, with pairs of them and more, until it draws that\n"
        "picture. What stays unexplained is told by its place. The picture may have any size.\n"
        "Exit status 0: the picture is right, 1: it is not.",
        "whitted why figure1.in mine.ppm\n  whitted why figure1.in mine.png --png left.png",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", nargs="?", help="the scene file")
    result.add_argument("picture", type=Path, metavar="PICTURE", nargs="?", help="the picture to be explained")
    group = result.add_argument_group("what is told")
    group.add_argument("--list", action="store_true", help="list the mistakes that are known, and end")
    group.add_argument(
        "--png",
        action=Result,
        metavar="FILE",
        help="draw the pictures, and parts of them where pixels are left unexplained; - is the standard output",
    )
    group.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write all of it; - is the standard output, without the text",
    )
    group.add_argument("-q", "--quiet", action="store_true", help="no notes")
    add_reading_options(result)
    return result


def run(arguments: argparse.Namespace) -> int:
    """Judge the picture, and tell."""
    from converter.commands.exits import UsageError
    from converter.commands.json_out import check_json, write_json

    if arguments.list:
        _list()
        return OK
    if arguments.picture is None:
        raise UsageError("expected a SCENE and a PICTURE")
    files = [arguments.scene, arguments.picture]
    check_json(arguments.json, files)
    png_ending = None
    if arguments.png is not None:
        from converter.files import check_apart, is_special
        from converter.images.write import check_writable

        png_ending = ".png" if is_special(arguments.png) and not arguments.png.suffix else None
        check_apart(arguments.png, files)
        check_writable(arguments.png, png_ending)

    from converter.commands.notes import load_with_notices
    from converter.why.judge import judge
    from converter.why.left import places_left
    from converter.why.picture import read_theirs
    from converter.why.report import to_json

    settings = settings_from(arguments)
    scene = load_with_notices(arguments.scene, settings, arguments.quiet)
    judged = judge(scene, read_theirs(arguments.picture), settings)
    places = places_left(judged)
    if arguments.json != STANDARD_OUTPUT:
        _print(arguments, judged, places)
    write_json(arguments.json, to_json(judged, places))
    if arguments.png is not None:
        from converter.images.write import write_image
        from converter.why.crops import draw_crops

        sheet = draw_crops(judged, places)
        write_image(arguments.png, sheet, sheet.shape[1], sheet.shape[0], png_ending)
    return OK if judged.right else DISAGREE


def _list() -> None:
    from converter.commands.tables import print_table
    from converter.why.student import deviations

    rows = [(d.name, d.part, d.sentence) for d in deviations().values()]
    print_table(rows, ("mistake", "part", ""), title=f"{len(rows)} mistakes that are known")


def _print(arguments: argparse.Namespace, judged: "Judged", places: "list[Place]") -> None:
    from converter.commands.tables import print_table
    from converter.why.report import cause_lines, left_sentence, verdict

    print(" ".join(filter(None, (verdict(judged), left_sentence(places, judged)))))
    lines = cause_lines(judged)
    if lines:
        print()
        print("\n".join(lines))
    if places:
        rows = [
            (p.object, "" if p.finish is None else str(p.finish), p.mechanism, f"{100 * p.share:.0f} %")
            for p in places[:10]
        ]
        print()
        print_table(
            rows, ("object (line)", "finish", "mechanism", "share"), "lllr", "where the pixels lie that are left"
        )
        print(f"\nThe rays behind one of them: {shlex.join(_pixel_words(arguments, judged, places[0]))}")


def _pixel_words(arguments: argparse.Namespace, judged: "Judged", place: "Place") -> list[str]:
    """The command that shows a pixel in both readings."""
    scene, picture = (f"./{file}" if str(file).startswith("-") else str(file) for file in _files(arguments))
    words = ["whitted", "pixel", scene, *map(str, place.pixel), "--picture", picture]
    return words + reading_words(judged.settings)


def _files(arguments: argparse.Namespace) -> tuple[Path, Path]:
    return arguments.scene, arguments.picture
