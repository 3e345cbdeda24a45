"""`whitted chart`: the error of every method against its time, as a picture, a table, CSV and JSON."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from converter.commands.exits import OK, UsageError
from converter.commands.method_options import add_variant, check_variant, method_named
from converter.commands.options import Parser, add_reading_options, settings_from, size, whole
from converter.commands.results import Result, TextResult, chart_ending
from converter.descriptors import STANDARD_OUTPUT

if TYPE_CHECKING:
    from converter.renderers.methods import Method
    from converter.scene.model import Scene
    from converter.scene.settings import Settings
    from converter.studies.antialiasing import AntialiasingStudy
    from converter.studies.convergence import ConvergenceStudy
    from converter.studies.measure import SceneStudy


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted chart",
        "SCENE... -o FILE [options]",
        "Draws each scene by every method, several times in turns, and draws error against time: a mark a method, the\n"
        "front of those that nothing beats, and whole processes below. Errors are against the native tracer in long\n"
        "double, with no cut-off and 64 bounces, or as near to that as can be afforded.\n\n"
        "Of scenes that are sampled it draws how the error falls with the number of samples, up to 1024 or --samples,\n"
        "and with the time they take: a curve a method, with how fast it falls. Errors are against the native tracer\n"
        "with more samples of other seeds.\n\n"
        "With --adaptive it draws what anti-aliasing costs. With --error certified wrong pixels are certified ones\n"
        "whose bytes are not those that `whitted certify` proves.",
        "whitted chart scenes/figure1.in -o chart.svg --csv chart.csv",
    )
    result.add_argument("scenes", type=Path, nargs="+", metavar="SCENE", help="scene files, a column of the chart each")
    result.add_argument(
        "-o",
        "--out",
        action=Result,
        required=True,
        metavar="FILE",
        help="the chart, .svg or .png; - is the standard output, as SVG",
    )
    result.add_argument(
        "--size", type=size, metavar="WxH", help="of the pictures (800x600, and 160x120 where scenes are sampled)"
    )
    group = result.add_argument_group("what is measured; `whitted methods` lists the methods")
    group.add_argument(
        "--methods",
        type=_methods,
        metavar="NAME,...|all",
        help="the methods (all; for sampled scenes native, native:points=independent, mitsuba)",
    )
    group.add_argument(
        "--adaptive",
        action="store_true",
        help="what anti-aliasing costs: error against rays and time of as many rays in every pixel, of --adaptive with "
        "several limits, and, --vs povray, of its methods 1 and 2",
    )
    group.add_argument(
        "--error",
        choices=("pixels", "certified"),
        default="pixels",
        help="which share is drawn above: of the pixels those that differ from the reference by more than 1/255, or of "
        "the certified pixels those that are wrong (%(default)s)",
    )
    group.add_argument("--vs", choices=("povray",), help="with POV-Ray as well, which has to be installed")
    group.add_argument(
        "--runs",
        type=_runs,
        default=7,
        metavar="N",
        help="how often each method draws warm; slow ones less (%(default)s)",
    )
    add_variant(group, "llvm_ad_rgb, except for mitsuba-cuda")
    group = result.add_argument_group("what is told")
    group.add_argument(
        "--csv",
        action=TextResult,
        metavar="FILE",
        help="write a line for every method on every scene; - is the standard output, without the table",
    )
    group.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write every run too; - is the standard output, without the table",
    )
    group.add_argument("-q", "--quiet", action="store_true", help="no notes, no progress bar")
    add_reading_options(result, bounces=False)
    return result


def _runs(text: str) -> int:
    return whole(text, 2, 1000)


def _methods(text: str) -> "list[Method]":
    """The methods of these names, each once."""
    if text == "all":
        from converter.renderers.methods import METHODS

        return [method for method in METHODS.values() if method.family != "povray"]
    return list(dict.fromkeys(method_named(name.strip()) for name in text.split(",")))


def run(arguments: argparse.Namespace) -> int:
    """Measure, draw, and tell."""
    from converter.commands.json_out import check_json, write_json, write_text
    from converter.files import check_target, replacing

    ending = chart_ending(arguments.out)
    methods = _chosen(arguments)
    check_variant(arguments, methods)
    settings = settings_from(arguments)
    for file in (arguments.out, arguments.csv):
        if file is not None:
            check_target(file, arguments.scenes)
    check_json(arguments.json, arguments.scenes)
    scenes = _read(arguments, settings)
    kind = _kind(arguments, _are_sampled(scenes, settings))
    width, height = arguments.size or kind.size
    settings = replace(settings, width=width, height=height)
    studies = _measure(arguments, scenes, settings, kind)

    with replacing(arguments.out, ending) as temporary:
        kind.draw(studies, temporary)
    if arguments.csv is not None:
        write_text(arguments.csv, kind.to_csv(studies))
    if STANDARD_OUTPUT not in (arguments.csv, arguments.json):
        for study in studies:
            kind.show(study)
    write_json(arguments.json, kind.to_json(studies))
    return OK


class _Kind(NamedTuple):
    """A kind of chart: what it is of, where nobody says so, and what makes it."""

    size: tuple[int, int]
    methods: "Sequence[Method]"
    measure: Callable[..., Any]
    draw: Callable[[list[Any], Path], None]
    to_csv: Callable[[list[Any]], str]
    to_json: Callable[[list[Any]], dict[str, Any]]
    show: Callable[[Any], None]
    left_out: Callable[[Any], list[str]]


def _kind(arguments: argparse.Namespace, sampled: bool) -> _Kind:
    certified = arguments.error == "certified"
    if sampled and (arguments.adaptive or certified):
        raise UsageError(
            f"{'--adaptive' if arguments.adaptive else '--error certified'}: of scenes that are not sampled"
        )
    if arguments.adaptive and certified:
        raise UsageError("--error certified: not with --adaptive, whose pictures have many rays a pixel")
    if arguments.adaptive:
        return _antialiasing()
    return _sampled() if sampled else _plain(certified)


def _antialiasing() -> _Kind:
    from converter.studies import antialiasing_report as report
    from converter.studies.antialiasing import default_methods, measure_antialiasing
    from converter.studies.antialiasing_figure import draw_antialiasing

    return _Kind(
        (400, 300),
        default_methods(),
        measure_antialiasing,
        draw_antialiasing,
        report.to_csv,
        report.to_json,
        _print_antialiasing,
        report.left_out_methods,
    )


def _plain(certified: bool) -> _Kind:
    from converter.studies import chart_report as report
    from converter.studies.chart_figure import draw_chart
    from converter.studies.measure import measure_scene

    return _Kind(
        (800, 600),
        _usual_methods(),
        partial(measure_scene, certified=certified),
        draw_chart,
        report.to_csv,
        report.to_json,
        _print,
        report.left_out_methods,
    )


def _sampled() -> _Kind:
    from converter.studies import convergence_report as report
    from converter.studies.convergence import default_methods, measure_convergence
    from converter.studies.convergence_figure import draw_convergence

    return _Kind(
        (160, 120),
        default_methods(),
        measure_convergence,
        draw_convergence,
        report.to_csv,
        report.to_json,
        _print_convergence,
        report.left_out_methods,
    )


def _are_sampled(scenes: "list[tuple[Path, Scene]]", settings: "Settings") -> bool:
    """Whether all are, or none is."""
    from converter.scene.needs import scene_needs

    sampled = {scene_needs(scene, settings).sampled: file for file, scene in scenes}
    if len(sampled) > 1:
        raise UsageError(f"{sampled[True]} is sampled and {sampled[False]} is not: these need a chart each")
    return True in sampled


def _usual_methods() -> "list[Method]":
    from converter.renderers.methods import METHODS

    return [method for method in METHODS.values() if method.usual]


def _chosen(arguments: argparse.Namespace, usual: "Sequence[Method] | None" = None) -> "list[Method]":
    """What the arguments name, or what is `usual`; and what it is compared with."""
    from converter.renderers.methods import METHODS

    methods = arguments.methods or usual or _usual_methods()
    if arguments.vs is not None:
        versus = METHODS[arguments.vs]
        if reason := versus.missing():
            from converter.renderers.base import RendererUnavailable

            raise RendererUnavailable(f"--vs {versus.name}: {reason}")
        methods = list(dict.fromkeys((*methods, versus)))
    return list(methods)


def _read(arguments: argparse.Namespace, settings: "Settings") -> "list[tuple[Path, Scene]]":
    """All scenes, before the first is drawn, so that no one waits for a mistake in the last."""
    from converter.commands.notes import load_with_notices

    # No notice of how many samples are drawn: these charts draw several numbers.
    settings = replace(settings, samples=settings.samples or 1)
    return [(file, load_with_notices(file, settings, arguments.quiet)) for file in arguments.scenes]


def _measure(
    arguments: argparse.Namespace,
    scenes: "list[tuple[Path, Scene]]",
    settings: "Settings",
    kind: _Kind,
) -> list[Any]:
    from converter.commands.progress import ProgressBar

    variant = arguments.variant or "llvm_ad_rgb"
    methods = _chosen(arguments, kind.methods)
    studies: list[Any] = []
    with ProgressBar("chart", arguments.quiet) as progress:

        def tell(what: str, share: float) -> None:
            progress.tell(what, (len(studies) + share) / len(scenes))

        for file, scene in scenes:
            studies.append(kind.measure(file, scene, settings, methods, arguments.runs, variant, tell))
    for study in studies:
        if not study.drawn:
            raise UsageError(f"no method draws {study.file}; {'; '.join(kind.left_out(study))}")
    return studies


def _print(study: "SceneStudy") -> None:
    from converter.commands.tables import print_table
    from converter.studies import chart_report as report

    floor = study.reference.floor
    title = f"{study.file}, {study.settings.width} x {study.settings.height} pixels"
    print_table(report.error_rows(study), report.error_header(study), report.ERROR_ALIGN, title)
    print(f"\nagainst {report.about_reference(study)}")
    print(f"floor, double against long double: {floor.disagreeing} pixels, RMS {report.figure(floor.rms)}")
    if study.certified is not None:
        print(f"certified: {study.certified} pixels")
    print(f"{report.error_legend(study)}\n")
    title = "seconds of a whole process"
    print_table(report.process_rows(study), report.PROCESS_HEADER, report.PROCESS_ALIGN, title)
    print("\n".join(["", report.PROCESS_LEGEND, *report.left_out_methods(study), ""]))


def _print_convergence(study: "ConvergenceStudy") -> None:
    from converter.commands.tables import print_table
    from converter.studies import convergence_report as report

    title = f"{study.file}, {study.settings.width} x {study.settings.height} pixels"
    print_table(report.rows(study), report.HEADER, report.ALIGN, title)
    print("\n".join(["", f"against {report.about_truth(study)}", report.LEGEND, *report.left_out_methods(study), ""]))


def _print_antialiasing(study: "AntialiasingStudy") -> None:
    from converter.commands.tables import print_table
    from converter.studies import antialiasing_report as report

    title = f"{study.file}, {study.settings.width} x {study.settings.height} pixels"
    print_table(report.rows(study), report.HEADER, report.ALIGN, title)
    print("\n".join(["", report.LEGEND, *report.left_out_methods(study), ""]))
