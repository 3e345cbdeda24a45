"""What is wrong with a scene file, told so that it can be found and mended."""

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from converter.frozen import dataclass

TAB = 8
"""Distance of tab stops, as GNU's coding standards count columns and as terminals show them."""
SHOWN_WIDTH = 100
"""Characters of a line that are shown; a scene may be written on one line of a megabyte."""


def place(file: Path | None, line: int) -> str:
    """`file:line`; line 0 is the file as a whole, and None a scene that came from none."""
    return f"{file or 'scene'}{f':{line}' if line else ''}"


def so_are(others: int) -> str:
    """E.g. "; so are 3 others", after a sentence about the first; nothing if there are none."""
    return f"; so {'is one other' if others == 1 else f'are {others} others'}" if others else ""


@dataclass(frozen=True, slots=True)
class Problem:
    """One thing that is wrong, and where.

    Attributes:
        file: the scene file; None for text that came from none.
        line, column: place of the offending word, both from 1, tab stops every 8 columns; line 0: the file as a whole.
        message: what was found and what was expected.
        source_line: the offending line as it stands in the file; empty if there is none to show.
    """

    file: Path | None
    line: int
    column: int
    message: str
    source_line: str = ""

    def __str__(self) -> str:
        """`file:line:column: message`, the line itself, and a caret below the column."""
        if self.line == 0:
            return f"{place(self.file, 0)}: {self.message}"
        told = f"{place(self.file, self.line)}:{self.column}: {self.message}"
        if not self.source_line.strip():
            return told
        shown, caret = _window(self.source_line.expandtabs(TAB).rstrip(), self.column - 1)
        return f"{told}\n    {shown}\n    {' ' * caret}^"


class SceneError(ValueError):
    """A scene cannot be used; `str()` of it is what a command prints.

    Attributes:
        problems: what is wrong, in the file's order; the first of them where there are many.
        omitted: how many more there are.
    """

    def __init__(self, problems: Sequence[Problem], omitted: int = 0) -> None:
        super().__init__(problems, omitted)
        self.problems = list(problems)
        self.omitted = omitted

    def __str__(self) -> str:
        """Every problem, each with its line and caret."""
        told = [str(problem) for problem in self.problems]
        if self.omitted:
            told.append(f"... and {self.omitted} more")
        return "\n".join(told)


def shown(word: str) -> str:
    """A word of the file between quotes, cut where it is long, harmless to a terminal."""
    return repr(word if len(word) <= 40 else word[:37] + "...")


@lru_cache(maxsize=64)  # a mistake is often made throughout a file
def did_you_mean(word: str, names: tuple[str, ...]) -> str:
    """` (did you mean 'sphere'?)` if one of `names` is close to `word`, else nothing."""
    from difflib import get_close_matches  # late: takes longer to import than most scenes to parse

    lower = {name.lower(): name for name in names}
    close = get_close_matches(word[:80].lower(), lower, n=1)
    return f" (did you mean {lower[close[0]]!r}?)" if close else ""


def _window(line: str, column: int) -> tuple[str, int]:
    """The part of `line` to show around `column` (from 0), and the column within it."""
    start = max(0, min(column - SHOWN_WIDTH // 2, len(line) - SHOWN_WIDTH))
    before, after = ("..." if start else ""), ("..." if start + SHOWN_WIDTH < len(line) else "")
    part = "".join(c if c.isprintable() else "?" for c in line[start : start + SHOWN_WIDTH])
    return before + part + after, len(before) + column - start
