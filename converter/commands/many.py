"""`whitted render SCENE... -o PATTERN`: many scenes in one process."""

import argparse
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from converter.batch.manifest import Manifest, digest_of
from converter.commands.exits import OK, UsageError, tell, told
from converter.commands.patterns import fields_of, named
from converter.files import make_folder

if TYPE_CHECKING:
    from converter.commands.method_options import Chosen
    from converter.commands.progress import ProgressBar
    from converter.renderers.base import Rendering

FIELDS = ("name", "number")
"""Of a pattern: the scene file's name without its ending, and the scene's place among all, from 1."""
DrawOne = Callable[[Path, Path, "ProgressBar"], "tuple[Rendering, dict[str, float]] | None"]
"""Draws a scene into a picture; None, if that is there already."""


class Outcome(NamedTuple):
    """How a scene fared: `error` is None if its picture is there; the statistics are the renderer's."""

    scene: Path
    picture: Path
    seconds: dict[str, float]
    statistics: dict[str, Any]
    error: str | None = None
    status: int = OK
    kept: bool = False


def pictures_of(scenes: list[Path], pattern: str) -> list[Path]:
    """A picture's name for each scene; their folders are there then.

    Raises:
        UsageError: two would have the same.
        OSError: a folder cannot be made.

    """
    fields_of("-o/--out", pattern, FIELDS)
    pictures = [named("-o/--out", pattern, name=scene.stem, number=k) for k, scene in enumerate(scenes, 1)]
    first: dict[Path, Path] = {}
    for scene, picture in zip(scenes, pictures, strict=True):
        if picture in first:
            raise UsageError(
                f"-o/--out: {first[picture]} and {scene} would both become {picture}: "
                "{name} is a scene's name, {number} its place among all"
            )
        first[picture] = scene
    for folder in {picture.parent for picture in pictures}:
        make_folder(folder)
    return pictures


class Keeper:
    """Which pictures are there already, and drawn from what they are to be drawn from now."""

    def __init__(self, arguments: argparse.Namespace, method: "Chosen") -> None:
        self._method = method
        self._format = arguments.format
        self._adaptive = arguments.adaptive
        self._manifests: dict[Path, Manifest] = {}
        self._sources: dict[Path, str] = {}

    def has(self, scene_file: Path, picture: Path) -> bool:
        """Whether the picture of a scene is there; an error of the scene is told where it is drawn."""
        from converter.commands.notes import load
        from converter.renderers.partial import identity
        from converter.scene.errors import SceneError

        try:
            found = identity(load(scene_file), self._method.settings, self._method.name)
        except (SceneError, OSError):
            return False
        self._sources[picture] = digest_of(found, self._format or picture.suffix, self._adaptive)
        return self._manifest(picture).has(picture, self._sources[picture])

    def note(self, picture: Path) -> None:
        """Remember that it is drawn, and written."""
        self._manifest(picture).note(picture, self._sources[picture], picture.read_bytes())

    def _manifest(self, picture: Path) -> Manifest:
        if picture.parent not in self._manifests:
            self._manifests[picture.parent] = Manifest(picture.parent)
        return self._manifests[picture.parent]


def draw_all(program: str, scenes: list[Path], pictures: list[Path], draw_one: DrawOne, quiet: bool) -> list[Outcome]:
    """Draw scene after scene. What keeps one from being drawn is told, and does not stop the rest."""
    from converter.commands.progress import ProgressBar

    result: list[Outcome] = []
    with ProgressBar("", quiet) as bar:
        for k, (scene, picture) in enumerate(zip(scenes, pictures, strict=True)):
            progress = bar.part(picture.name, k / len(scenes), (k + 1) / len(scenes))
            try:
                drawn = draw_one(scene, picture, progress)
                if drawn is None:
                    result.append(Outcome(scene, picture, {}, {}, kept=True))
                else:
                    rendering, seconds = drawn
                    result.append(Outcome(scene, picture, seconds, dict(rendering.statistics)))
            except Exception as error:
                result.append(failed(program, scene, picture, error))
    return result


def failed(program: str, scene: Path, picture: Path, error: Exception) -> Outcome:
    """What there is to say of an error, which is told; a bug goes on."""
    found = told(program, error)
    if found is None:
        raise error
    message, status = found
    tell(message)
    return Outcome(scene, picture, {}, {}, message.splitlines()[0], status)


def print_outcomes(outcomes: list[Outcome]) -> None:
    """A row a scene: its picture, how long it took, and what was wrong."""
    from converter.commands.tables import print_table

    print_table(list(_rows(outcomes)), header=("scene", "picture", "seconds", ""), align="llrl")
    drawn = sum(o.error is None and not o.kept for o in outcomes)
    seconds = sum(sum(o.seconds.values()) for o in outcomes)
    print(f"{drawn} of {len(outcomes)} scenes drawn, {seconds:.2f} s", file=sys.stdout)


def _rows(outcomes: list[Outcome]) -> Iterator[tuple[str, str, str, str]]:
    for o in outcomes:
        if o.error is not None:
            yield str(o.scene), "", "", "failed"
        else:
            yield str(o.scene), str(o.picture), f"{sum(o.seconds.values()):.2f}", "was there" if o.kept else ""


def status_of(outcomes: list[Outcome]) -> int:
    """The exit status: that of the scenes that were not drawn, the worst of them."""
    return max((o.status for o in outcomes), default=OK)


def check_together(arguments: argparse.Namespace) -> None:
    """Refuse what makes sense for one picture only.

    Raises:
        UsageError: it is asked for.

    """
    if arguments.adaptive_map is not None:
        raise UsageError("--adaptive-map: it is for one scene, without -o")
    for scene in arguments.scene[1:]:
        if str(scene).isdecimal() and not scene.exists():
            raise UsageError(f"{scene}: there is no such scene; a size is given as --size WxH where there is -o")
    if arguments.stats:
        raise UsageError("--stats: it is for one scene, without -o; --json tells it of many")
