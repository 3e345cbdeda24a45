"""What the page tells of a text: the scene that it is, or the mistakes in it and where they are underlined."""

from dataclasses import dataclass
from pathlib import Path

from converter.page.offsets import at_column, to_browser
from converter.scene.errors import Problem, SceneError
from converter.scene.model import Scene
from converter.scene.parser import load_text


@dataclass(frozen=True, slots=True)
class Mark:
    """A mistake: the underlined part of the text, as browsers count, its line and column from 1, and the sentence.

    A mistake of the text as a whole has line 0, and underlines nothing.
    """

    start: int
    end: int
    line: int
    column: int
    message: str


@dataclass(frozen=True, slots=True)
class Reading:
    """What a text is: a scene, or mistakes, and how many more there are than are told."""

    scene: Scene | None
    marks: tuple[Mark, ...] = ()
    omitted: int = 0


def read(text: str, file: Path) -> Reading:
    """Read a text as what stands in `file`."""
    try:
        return Reading(load_text(text, file))
    except SceneError as error:
        lines = text.split("\n")
        return Reading(None, tuple(_mark(problem, text, lines) for problem in error.problems), error.omitted)


def _mark(problem: Problem, text: str, lines: list[str]) -> Mark:
    """The word at the problem's place, or the one before it where a line ends there."""
    if not 0 < problem.line <= len(lines):
        return Mark(0, 0, 0, 0, problem.message)
    line = lines[problem.line - 1]
    start = at_column(line, problem.column)
    word = line[start:].split(maxsplit=1)[0] if line[start:].strip() else ""
    if word and not line[start].isspace():
        end = start + len(word)
    else:
        end = len(line[:start].rstrip()) or len(line)
        start = len(line[:end]) - len((line[:end].split() or [""])[-1])
    before = sum(len(earlier) + 1 for earlier in lines[: problem.line - 1])
    start, end = to_browser(text, before + start), to_browser(text, before + end)
    return Mark(start, end, problem.line, problem.column, problem.message)
