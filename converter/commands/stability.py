"""`whitted stability`: up to where each method holds, as a picture, a table and JSON."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.exits import OK, UsageError
from converter.commands.method_options import add_variant, check_variant, method_named
from converter.commands.options import Parser
from converter.commands.results import Result, TextResult, chart_ending
from converter.descriptors import STANDARD_OUTPUT

if TYPE_CHECKING:
    from converter.renderers.methods import Method
    from converter.studies.family import Family
    from converter.studies.stability import FamilyStudy

USUAL = (
    "native",
    "native-float",
    "mitsuba",
    "mitsuba-analytic-float",
    "mitsuba-bvh",
    "mitsuba-mesh",
    "mitsuba-offset",
    "mitsuba-ulp",
)
"""Methods whose arithmetic differs."""


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted stability",
        "-o FILE [options]\n--docs FOLDER [options]",
        "Draws families of scenes that push one number toward trouble by every method, and says up to where each\n"
        "holds: a picture holds if no pixel differs from the truth by more than 1/255.",
        "whitted stability -o stability.svg --families size,position",
    )
    result.add_argument(
        "-o",
        "--out",
        action=Result,
        metavar="FILE",
        help="the chart, .svg or .png; - is the standard output, as SVG",
    )
    group = result.add_argument_group("what is tried; `whitted methods` lists the methods")
    group.add_argument("--methods", type=_methods, metavar="NAME,...|all", help=f"({', '.join(USUAL)})")
    group.add_argument("--families", type=_families, metavar="NAME,...|all", default="all", help="(%(default)s)")
    group.add_argument("--list", action="store_true", help="say what the families are, and end")
    add_variant(group, "llvm_ad_rgb, except for mitsuba-cuda")
    group = result.add_argument_group("what is told")
    group.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write every figure; - is the standard output, without the table",
    )
    group.add_argument(
        "--docs", type=Path, metavar="FOLDER", help="write stability.md there, and the pictures that it shows"
    )
    group.add_argument("-q", "--quiet", action="store_true", help="no notes, no progress bar")
    return result


def _methods(text: str) -> "list[Method]":
    """The methods of these names, each once."""
    if text == "all":
        from converter.renderers.methods import METHODS

        chosen = [METHODS[name] for name in USUAL]
        return [*chosen, *(m for m in METHODS.values() if m.family == "povray" or m.name == "mitsuba-cuda")]
    return list(dict.fromkeys(method_named(name.strip()) for name in text.split(",")))


def _families(text: str) -> "list[Family]":
    """The families of these names, each once."""
    from converter.scene.errors import did_you_mean
    from converter.studies.families import FAMILIES

    if text == "all":
        return list(FAMILIES.values())
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if name not in FAMILIES:
            raise argparse.ArgumentTypeError(f"there is no family {name!r}{did_you_mean(name, tuple(FAMILIES))}")
    return [FAMILIES[name] for name in dict.fromkeys(names)]


def run(arguments: argparse.Namespace) -> int:
    """Try, draw, and tell."""
    from converter.commands.json_out import check_json, write_json
    from converter.files import check_target, replacing

    if arguments.list:
        _list(arguments.families)
        return OK
    out: Path | None = arguments.out
    if out is None and arguments.docs is None:
        raise UsageError("the following arguments are required: -o/--out, or --docs")
    if out is not None:
        ending = chart_ending(out)
        check_target(out)
    if arguments.docs is not None:
        check_target(arguments.docs / "stability.md")
    check_json(arguments.json)
    methods, missing = _present(arguments)
    check_variant(arguments, methods)
    studies = _study(arguments, methods)

    from converter.studies.stability_figure import draw_stability
    from converter.studies.stability_report import to_json

    if out is not None:
        with replacing(out, ending) as temporary:
            draw_stability(studies, temporary)
    if arguments.docs is not None:
        from converter.studies.stability_page import write_page

        write_page(studies, arguments.docs)
    if arguments.json != STANDARD_OUTPUT:
        _print(studies, missing)
    write_json(arguments.json, to_json(studies))
    return OK


def _list(families: "list[Family]") -> None:
    from converter.commands.tables import print_table

    rows = [(f.name, f.stress, f.about) for f in families]
    print_table(rows, ("family", "stressed", "about"))


def _present(arguments: argparse.Namespace) -> "tuple[list[Method], list[str]]":
    """The methods that run on this machine, and a line for each that does not.

    Raises:
        RendererUnavailable: none does.

    """
    from converter.renderers.base import RendererUnavailable
    from converter.renderers.methods import METHODS

    asked = arguments.methods or [METHODS[name] for name in USUAL]
    reasons = {method: method.missing() for method in asked}
    missing = [f"left out: {method.name}: {reason}" for method, reason in reasons.items() if reason is not None]
    present = [method for method, reason in reasons.items() if reason is None]
    if not present:
        raise RendererUnavailable("; ".join(missing))
    return present, missing


def _study(arguments: argparse.Namespace, methods: "list[Method]") -> "list[FamilyStudy]":
    from converter.commands.progress import ProgressBar
    from converter.studies.stability import study_family
    from converter.studies.worker import Worker

    variant = arguments.variant or "llvm_ad_rgb"
    studies: list[FamilyStudy] = []
    with ProgressBar("stability", arguments.quiet) as progress, Worker() as worker:

        def tell(what: str, share: float) -> None:
            progress.tell(what, (len(studies) + share) / len(arguments.families))

        for family in arguments.families:
            studies.append(study_family(family, methods, worker, variant, tell))
    return studies


def _print(studies: "list[FamilyStudy]", missing: list[str]) -> None:
    from converter.commands.tables import print_table
    from converter.studies import stability_report as report

    print_table(report.table_rows(studies), report.table_header(studies))
    print("\n".join(["", report.LEGEND, *report.silences(studies), *report.failures(studies), *missing]))
