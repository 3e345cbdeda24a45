"""`whitted grade`: runs a class of programs on scenes, and reports what each gets wrong."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.exits import OK, UsageError
from converter.commands.options import Parser, add_reading_options, settings_from, size, whole

if TYPE_CHECKING:
    from converter.grade.attempts import Attempt, Order
    from converter.grade.grades import Grades
    from converter.grade.rubric import Rubric
    from converter.grade.run import Limits
    from converter.grade.sandbox import Walls
    from converter.grade.tasks import Task

SIZE = (320, 240)


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted grade",
        "PROGRAM... --scenes FOLDER -o REPORT [options]",
        "Runs programs on scenes, one after the other within limits, compares what they draw with the native tracer's\n"
        "pictures, and asks `whitted why` which mistakes lead to them. A PROGRAM is\n"
        "  a folder         built first, in a copy: by make where there is a Makefile\n"
        "  a file           called with SCENE PICTURE WIDTH HEIGHT\n"
        "  a command line   with {scene} {out} {width} {height} in it, perhaps NAME=...\n"
        "Under bubblewrap, where it is installed, a program has no network and sees nothing but its own folder.\n"
        "After an interruption the same command goes on where it was.",
        "whitted grade submissions/* --scenes scenes/ladder -o report\n"
        "  whitted grade 'ada=python3 ada.py {scene} {out} {width} {height}' --scenes scenes/ladder -o report",
    )
    result.add_argument("programs", nargs="+", metavar="PROGRAM", help="what is graded")
    result.add_argument("--scenes", type=Path, required=True, metavar="FOLDER", help="the scenes, *.in, or one of them")
    result.add_argument("-o", "--out", type=Path, required=True, metavar="REPORT", help="the folder for the report")
    group = result.add_argument_group("what is graded")
    group.add_argument(
        "--size", type=size, default=SIZE, metavar="WxH", help=f"size of the pictures ({SIZE[0]}x{SIZE[1]})"
    )
    group.add_argument(
        "--rubric",
        type=Path,
        metavar="FILE",
        help="which scene counts how much, and what is tolerated (rubric.toml beside the scenes, if it is there)",
    )
    group.add_argument("--picture", default="out.ppm", metavar="NAME", help="name of the pictures (%(default)s)")
    group.add_argument("--make", metavar="COMMAND", help="what builds a folder's program (make, or cmake)")
    group.add_argument(
        "--run", metavar="COMMAND", help="a folder's program and its arguments (what the build makes, and all four)"
    )
    group = result.add_argument_group("how programs are run")
    group.add_argument(
        "--time", type=_seconds, default=10.0, metavar="S", help="processor time for a picture, a core (%(default)g)"
    )
    group.add_argument("--memory", type=_mebibytes, default=1024, metavar="MIB", help="memory (%(default)s)")
    group.add_argument("--output", type=_mebibytes, default=64, metavar="MIB", help="bytes written (%(default)s)")
    group.add_argument(
        "--tasks", type=_count, default=128, metavar="N", help="processes and threads at once (%(default)s)"
    )
    group.add_argument("--cores", type=_count, default=1, metavar="N", help="cores for each program (%(default)s)")
    group.add_argument(
        "--jobs", type=_count, metavar="N", help="programs side by side (as many as have their own cores)"
    )
    group.add_argument(
        "--walls",
        choices=("auto", "bubblewrap", "none"),
        default="auto",
        help="keep programs apart by bubblewrap: where it works, always, or never (%(default)s)",
    )
    group.add_argument("--anew", action="store_true", help="run all programs, also those that were run before")
    group.add_argument("-q", "--quiet", action="store_true", help="no notes, no progress bar")
    add_reading_options(result)
    return result


def _seconds(text: str) -> float:
    from converter.commands.options import finite

    value = finite(text)
    if not 0.1 <= value <= 36000:
        raise argparse.ArgumentTypeError(f"must lie between 0.1 and 36000, found {text}")
    return value


def _mebibytes(text: str) -> int:
    return whole(text, 1, 1 << 20)


def _count(text: str) -> int:
    return whole(text, 1, 4096)


def run(arguments: argparse.Namespace) -> int:
    """Run, judge, and report."""
    import os

    if not hasattr(os, "pidfd_open"):
        raise UsageError("programs are run within limits on Linux only")
    from converter.commands.notes import say
    from converter.commands.progress import ProgressBar
    from converter.grade.attempts import Order, attempt_all
    from converter.grade.grades import grade
    from converter.grade.programs import NoProgram, read_programs
    from converter.grade.report.write import write_report
    from converter.grade.rubric import Rubric, RubricError, read_rubric
    from converter.grade.run import Limits, Runner
    from converter.grade.tasks import NoTask, read_tasks
    from converter.grade.verdicts import judge_all

    if arguments.samples != 1:
        raise UsageError("--samples: pictures of one ray a pixel are graded")
    if "/" in arguments.picture or arguments.picture in ("", ".", ".."):
        raise UsageError(f"--picture: must be a file's name, found {arguments.picture!r}")
    if arguments.run is not None and not ("{scene}" in arguments.run and "{out}" in arguments.run):
        raise UsageError("--run: {scene} and {out} must stand in it")
    limits = Limits(arguments.time, arguments.memory, arguments.output, arguments.tasks, arguments.cores)
    walls = _walls(arguments.walls)
    jobs = _jobs(arguments.jobs, limits)
    try:
        tasks = {task.name: task for task in read_tasks(arguments.scenes)}
        programs = read_programs(arguments.programs, arguments.run)
        beside = arguments.scenes / "rubric.toml"
        file = arguments.rubric or (beside if beside.is_file() else None)
        rubric = Rubric() if file is None else read_rubric(file, tasks)
    except (NoTask, NoProgram, RubricError) as error:
        raise UsageError(str(error)) from None
    arguments.width, arguments.height = arguments.size
    settings = settings_from(arguments)
    report: Path = arguments.out.absolute()
    report.mkdir(parents=True, exist_ok=True)
    if not walls.bubblewrap:
        say(f"warning: {walls.told}", arguments.quiet)

    width, height = arguments.size
    order = Order(width, height, arguments.picture, limits, jobs, arguments.make, arguments.anew)
    with ProgressBar("running", arguments.quiet) as bar:
        reference = _reference(list(tasks.values()), order, report)
        attempts = attempt_all(programs, list(tasks.values()), order, Runner(walls), report, bar.tell)
        verdicts = judge_all(attempts, tasks, settings, report, _jobs(None, Limits()), bar.tell)
        grades = grade(tasks, attempts, verdicts, reference, rubric, _conditions(order, walls, rubric))
        write_report(grades, settings, report, bar.tell)
    _print(grades, arguments.out)
    return OK


def _walls(asked: str) -> "Walls":
    from converter.grade.sandbox import Walls, find_walls
    from converter.renderers.base import RendererUnavailable

    if asked == "none":
        return Walls(None, "as --walls none asked for")
    found = find_walls()
    if asked == "bubblewrap" and not found.bubblewrap:
        raise RendererUnavailable(f"--walls: {found.why_not}")
    return found


def _jobs(asked: int | None, limits: "Limits") -> int:
    """How many programs are run side by side: no two share a core, so that times mean something."""
    import os

    cores = len(os.sched_getaffinity(0))
    most = cores // limits.cores
    if most < 1:
        raise UsageError(f"--cores: this process has {cores}, not {limits.cores}")
    if asked is not None and asked > most:
        raise UsageError(
            f"--jobs: {asked} with {limits.cores} each need {asked * limits.cores} cores, and there are {cores}"
        )
    return asked or most


def _reference(tasks: "list[Task]", order: "Order", report: Path) -> "dict[str, Attempt]":
    """How long the native tracer takes, run as the programs are: a whole process on as many cores."""
    import shlex
    import sys
    from dataclasses import replace

    from converter.grade.attempts import attempt_all
    from converter.grade.programs import CALL, Program
    from converter.grade.run import Limits, Runner
    from converter.grade.sandbox import Walls

    call = f"{shlex.quote(sys.executable)} -m converter.commands.raytrace {CALL}"
    ours = Program(".reference", None, call)
    generous = replace(order, limits=Limits(seconds=600, memory=1 << 16, cores=order.limits.cores), jobs=1)
    found = attempt_all([ours], tasks, generous, Runner(Walls(None)), report, lambda what, share: None)
    return found[ours.name]


def _conditions(order: "Order", walls: "Walls", rubric: "Rubric") -> list[str]:
    """Sentences that the report begins with."""
    from converter.grade.run import CLOCK

    limits = order.limits
    cores = "one core" if limits.cores == 1 else f"{limits.cores} cores"
    tolerated = f"Tolerated: {', '.join(sorted(rubric.tolerate))}." if rubric.tolerate else ""
    charge = "the first scene in which it is found" if rubric.once else "each scene in which it is found"
    return [
        f"Pictures of {order.width} x {order.height} pixels. Each program had {cores} to itself, {limits.seconds:g} s "
        f"of processor time on each and {CLOCK:g} times as long by the clock, {limits.memory} MiB of memory, "
        f"{limits.output} MiB to write, and {limits.tasks} processes and threads.",
        walls.told,
        f"A mistake costs marks in {charge}; a wrong picture is worth up to {100 * rubric.partial:g} % of its points, "
        "by the share of it that is right. Pixels that single precision cannot decide do not count.",
        *([tolerated] if tolerated else []),
    ]


def _print(grades: "Grades", out: Path) -> None:
    from converter.commands.tables import print_table

    rows = [
        (
            row.name,
            f"{row.points:.2f}",
            *(str(row.count(kind) or "") for kind in ("right", "forgiven", "mistakes", "unexplained", "none")),
            ", ".join(list(row.mistakes)[:3]),
        )
        for row in grades.rows
    ]
    header = ("program", f"of {grades.most:g}", "right", "forgiven", "mistakes", "unexplained", "none", "most frequent")
    print_table(rows, header, "lrrrrrrl", title=f"{len(grades.rows)} programs, {len(grades.tasks)} scenes")
    print(f"\nThe report: {out / 'index.html'}")
