"""`whitted certify`: prove the bytes of each pixel, or say why not, and see which methods get them wrong."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.commands.exits import DISAGREE, OK
from converter.commands.method_options import add_variant, check_variant, choose, method_named, native_instead
from converter.commands.options import (
    Parser,
    add_reading_options,
    add_running_options,
    add_size,
    not_negative,
    settings_from,
)
from converter.commands.results import Result, TextResult
from converter.descriptors import STANDARD_OUTPUT

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from converter.certify.certificate import Certificate

METHODS = ("native", "mitsuba")
"""What is judged where nobody says so."""


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted certify",
        "SCENE [WIDTH HEIGHT] [options]",
        "Computes every pixel with intervals that enclose all rounding errors, first of doubles, then of ever more\n"
        "digits. A pixel is certified where each decision is certain and its colour rounds to one byte; of the others\n"
        "the reason is told. Then it says which certified pixels other methods get wrong.\n"
        "Exit status 0: they get none wrong, 1: they do.",
        "whitted certify figure1.in 800 600 --png out.png\n  whitted certify figure1.in --widen 1 --method none",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene")
    add_size(result)
    group = result.add_argument_group("what is told")
    group.add_argument(
        "--widen",
        type=not_negative,
        default=0.0,
        metavar="ULPS",
        help="take every number of the scene that is not whole as known to so many units in the last place of a double "
        "only: what is undecided then, the scene does not determine",
    )
    group.add_argument(
        "--png", action=Result, metavar="FILE", help="draw the picture, what is undecided, by reason, and what is wrong"
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
    group = result.add_argument_group("the methods that are judged; `whitted methods` lists them")
    group.add_argument(
        "--method",
        action="append",
        type=_method,
        metavar="NAME",
        help=f"one, and once more for another ({' and '.join(METHODS)}); none: nothing is judged",
    )
    add_variant(group)
    return result


def _method(text: str) -> Any:
    return None if text == "none" else method_named(text)


def run(arguments: argparse.Namespace) -> int:
    """Certify, judge, and tell."""
    from converter.certify.certificate import certify, levels
    from converter.commands.json_out import check_json, write_json
    from converter.commands.notes import load_with_notices
    from converter.commands.progress import ProgressBar
    from converter.files import check_target, is_special

    asked = [method_named(name) for name in METHODS] if arguments.method is None else arguments.method
    methods = [method for method in dict.fromkeys(asked) if method is not None]
    if methods:
        check_variant(arguments, methods)
    chosen = [choose(method, arguments) for method in methods]
    settings = settings_from(arguments)
    check_json(arguments.json, [arguments.scene])
    ending = None
    if arguments.png is not None:
        ending = ".png" if is_special(arguments.png) and not arguments.png.suffix else None
        check_target(arguments.png, [arguments.scene])
    scene = load_with_notices(arguments.scene, settings, arguments.quiet)
    with ProgressBar("certificate", arguments.quiet) as progress:
        certificate = certify(scene, settings, arguments.widen, progress)
    misses: dict[str, NDArray[np.int16]] = {}
    for name, renderer, own in chosen:
        with ProgressBar(name, arguments.quiet) as progress, native_instead(name):
            rendering = renderer.render(scene, own, progress)
        misses[name] = certificate.misses(levels(rendering))
    if arguments.png is not None:
        from converter.certify.figure import draw_certificate

        draw_certificate(certificate, list(misses.values()), arguments.png, ending)
    if arguments.json != STANDARD_OUTPUT:
        _print(certificate, misses)
    write_json(arguments.json, _figures(certificate, misses))
    return DISAGREE if any(miss.any() for miss in misses.values()) else OK


def _print(certificate: "Certificate", misses: "dict[str, NDArray[np.int16]]") -> None:
    from converter.certify.certificate import REASONS
    from converter.commands.tables import print_table

    height, width = certificate.undecided.shape
    count, certified = height * width, int(certificate.certified.sum())
    print(f"certified: {certified} of {count} pixels, in {certificate.seconds['certify']:.2f} s")
    rows = [
        [f"with {digits} binary digits", str(int((certificate.certified & (certificate.rung == k)).sum()))]
        for k, digits in enumerate(certificate.digits)
    ]
    tied = int((certificate.tied & certificate.certified).sum())
    rows += [["of these, by the rule for ties", str(tied)]] if tied else []
    rows += [[f"undecided: {REASONS[name]}", str(found)] for name, found in certificate.counts().items()]
    print_table([row for row in rows if row[1] != "0"], align="lr")
    for name, miss in misses.items():
        wrong = int((miss > 0).sum())
        if not wrong:
            print(f"{name}: none of the certified pixels is wrong")
            continue
        y, x = divmod(int(miss.argmax()), width)
        print(f"{name}: {wrong} of the certified pixels are wrong, by up to {int(miss.max())} levels at ({x}, {y})")


def _figures(certificate: "Certificate", misses: "dict[str, NDArray[np.int16]]") -> dict[str, Any]:
    height, width = certificate.undecided.shape
    certified = certificate.certified
    return {
        "width": width,
        "height": height,
        "seconds": certificate.seconds,
        "certified": int(certified.sum()),
        "by_digits": {
            str(digits): int((certified & (certificate.rung == k)).sum()) for k, digits in enumerate(certificate.digits)
        },
        "by_rule_for_ties": int((certificate.tied & certified).sum()),
        "two_levels_right": int((certified & (certificate.low != certificate.high).any(axis=2)).sum()),
        "undecided": certificate.counts(),
        "methods": {
            name: {
                "wrong": int((miss > 0).sum()),
                "largest": int(miss.max()),
                "pixels": [
                    {"x": int(x), "y": int(y), "levels": int(miss[y, x])} for y, x in zip(*miss.nonzero(), strict=True)
                ][:1000],
            }
            for name, miss in misses.items()
        },
    }
