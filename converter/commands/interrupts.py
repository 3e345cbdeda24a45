"""Ctrl-C and SIGTERM where an exception would do harm, or be mistaken for another.

Compiled modules do not bear an exception while they initialise: some abort the process, some go on half made and fail
later. Nothing is worth saving at that time, so the process ends at once. Elsewhere Ctrl-C is what it always is, and
SIGTERM an exception too, so that unfinished files go; but they are remembered, for Dr.Jit makes a RuntimeError of
either while it traces a loop.
"""

import os
import signal
from contextlib import suppress
from types import FrameType, TracebackType
from typing import Any


class Terminated(BaseException):
    """SIGTERM, as KeyboardInterrupt is SIGINT."""


_HANDLED = ((signal.SIGINT, signal.default_int_handler), (signal.SIGTERM, signal.SIG_DFL))
"""Signals, and who handles them where nobody else does. Another handler is a larger program's business; a shell has
SIGINT ignored in what runs in the background."""


class InterruptWatch:
    """Within it, Ctrl-C and SIGTERM during an import write `message` to stderr and end the process.

    `seen` is the signal that came last, if any.
    """

    def __init__(self, message: str) -> None:
        self.seen: int | None = None
        self._message = message
        self._before: dict[int, Any] = {}

    def __enter__(self) -> "InterruptWatch":
        for number, usual in _HANDLED:
            if signal.getsignal(number) is usual:
                with suppress(ValueError):  # not in the main thread, which alone gets signals
                    self._before[number] = signal.signal(number, self._interrupted)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _interrupted(self, number: int, frame: FrameType | None) -> None:
        if _is_importing(frame):
            os.write(2, self._message.encode())
            os._exit(status_of(number))
        self.seen = number
        raise KeyboardInterrupt if number == signal.SIGINT else Terminated


def status_of(number: int) -> int:
    """The exit status of a process that a signal has ended, as shells count it."""
    return 128 + number


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False
