"""`whitted render` where others draw."""

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from converter.batch.pictures import Drawn, Job
from converter.batch.run import Wanted, draw_pictures
from converter.commands.exits import UsageError
from converter.commands.many import Keeper, Outcome, failed
from converter.commands.method_options import Chosen
from converter.commands.notes import load_with_notices
from converter.commands.progress import ProgressBar
from converter.files import check_apart, replacing
from converter.images.write import check_writable
from converter.pigments.table import pigment_kind


def check_elsewhere(arguments: argparse.Namespace) -> None:
    """Refuse what only this process can do.

    Raises:
        UsageError: it is asked for.

    """
    for option in ("adaptive", "keep_partial"):
        if getattr(arguments, option):
            raise UsageError(f"--{option.replace('_', '-')}: not with --workers or --scheduler")


def draw_elsewhere(
    arguments: argparse.Namespace, method: Chosen, scenes: list[Path], pictures: list[Path], keeper: Keeper | None
) -> list[Outcome]:
    """Draw scenes into pictures; what is wrong with one is told, and does not stop the rest."""
    program = "whitted render"
    outcomes: dict[int, Outcome] = {}

    def wanted() -> Iterator[Wanted]:
        for k, (file, picture) in enumerate(zip(scenes, pictures, strict=True)):
            try:
                if keeper is not None and keeper.has(file, picture):
                    outcomes[k] = Outcome(file, picture, {}, {}, kept=True)
                else:
                    yield Wanted(k, _job(arguments, method, file, picture))
            except Exception as error:
                outcomes[k] = failed(program, file, picture, error)

    with (
        ProgressBar(f"{len(pictures)} pictures", arguments.quiet) as bar,
        draw_pictures(arguments, wanted(), len(scenes), bar) as results,
    ):
        for k, found in results:
            try:
                outcomes[k] = _written(arguments, scenes[k], pictures[k], found)
                if keeper is not None:
                    keeper.note(pictures[k])
            except Exception as error:
                outcomes[k] = failed(program, scenes[k], pictures[k], error)
    return [outcomes[k] for k in range(len(scenes))]


def draw_one_elsewhere(arguments: argparse.Namespace, method: Chosen) -> tuple[dict[str, float], dict[str, Any]]:
    """Draw the one scene; seconds by stage, and statistics.

    Raises:
        SceneError, OSError, RendererUnavailable, ClusterError: as they are.

    """
    wanted = [Wanted(0, _job(arguments, method, arguments.scene, arguments.out))]
    with (
        ProgressBar(arguments.out.name, arguments.quiet) as bar,
        draw_pictures(arguments, wanted, 1, bar) as results,
    ):
        outcome = _written(arguments, arguments.scene, arguments.out, next(results)[1])
    return outcome.seconds, outcome.statistics


def _written(arguments: argparse.Namespace, scene: Path, picture: Path, found: Drawn | Exception) -> Outcome:
    if isinstance(found, Exception):
        raise found
    with replacing(picture, arguments.format) as temporary:
        temporary.write_bytes(found.data)
    return Outcome(scene, picture, found.seconds, found.statistics)


def _job(arguments: argparse.Namespace, method: Chosen, file: Path, picture: Path) -> Job:
    check_apart(picture, [file])
    check_writable(picture, arguments.format)
    scene = load_with_notices(file, method.settings, arguments.quiet, arguments.method)
    check_apart(picture, (each for pigment in scene.pigments for each in pigment_kind(pigment).files(pigment)))
    ending = (arguments.format or picture.suffix).lower() or ".ppm"
    return Job(scene, method.settings, method.name, arguments.variant, ending)
