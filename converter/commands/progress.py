"""A progress bar on stderr, for pictures that take their time and a terminal that shows it."""

import sys
import time
from types import TracebackType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress

PATIENCE = 1.0
"""Seconds before a bar appears: most pictures are done by then, and the bar's library takes a tenth to import."""


class ProgressBar:
    """Called with the finished share of a picture (0..1), a `Progress` as renderers take one; closed by `with`."""

    def __init__(self, what: str, quiet: bool = False) -> None:
        self._what = what
        self._started = time.monotonic()
        self._wanted = not quiet and sys.stderr is not None and sys.stderr.isatty()
        self._bar: Progress | None = None

    def tell(self, what: str, share: float) -> None:
        """Show that `share` of everything is finished, and what is at hand."""
        self._what = what
        self(share)
        if self._bar is not None:
            self._bar.update(self._bar.task_ids[0], description=_plain(what))

    def part(self, what: str, begin: float, end: float) -> "ProgressBar":
        """A bar that shows its own share as one of this, from one share to another."""
        return _Part(self, what, begin, end)

    def __call__(self, share: float) -> None:
        """Show that `share` of the picture is finished."""
        if self._bar is None and self._wanted and share < 1 and time.monotonic() - self._started >= PATIENCE:
            self._bar = self._appear(share)
        if self._bar is not None:
            self._bar.update(self._bar.task_ids[0], completed=share)

    def __enter__(self) -> "ProgressBar":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.stop()
            self._bar = None

    def _appear(self, share: float) -> "Progress":
        from rich.console import Console
        from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

        columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
        bar = Progress(*columns, console=Console(stderr=True), transient=True)
        bar.add_task(_plain(self._what), total=1.0)
        bar.update(bar.task_ids[0], completed=share)  # at the start, so that no speed is taken from it
        bar.start()
        return bar


class _Part(ProgressBar):
    """A part of another bar, which is not closed by it."""

    def __init__(self, whole: ProgressBar, what: str, begin: float, end: float) -> None:
        super().__init__(what, quiet=True)
        self._whole, self._begin, self._end = whole, begin, end

    def __call__(self, share: float) -> None:
        self._whole.tell(self._what, self._begin + (self._end - self._begin) * share)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self(1.0)


def _plain(text: str) -> str:
    """Text in which brackets are no markup."""
    return text.replace("[", r"\[")
