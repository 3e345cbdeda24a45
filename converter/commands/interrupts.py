"""Ctrl-C where an exception would do harm, or be mistaken for another.

Compiled modules do not bear a KeyboardInterrupt while they initialise: some abort the process, some go on half made and
fail later. Nothing is worth saving at that time, so the process ends at once. Elsewhere Ctrl-C is what it always is,
but is remembered, for Dr.Jit makes a RuntimeError of it while it traces a loop.
"""

import os
import signal
from contextlib import suppress
from types import FrameType, TracebackType
from typing import Any


class InterruptWatch:
    """Within it, Ctrl-C during an import writes `message` to stderr and ends the process with `status`.

    `seen` tells whether there was a Ctrl-C at all.
    """

    def __init__(self, message: str, status: int) -> None:
        self.seen = False
        self._message = message
        self._status = status
        self._before: Any = None

    def __enter__(self) -> "InterruptWatch":
        # Another handler is a larger program's business; a shell has SIGINT ignored in what runs in the background.
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            with suppress(ValueError):  # not in the main thread, which alone gets signals
                self._before = signal.signal(signal.SIGINT, self._interrupted)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)

    def _interrupted(self, number: int, frame: FrameType | None) -> None:
        if _is_importing(frame):
            os.write(2, self._message.encode())
            os._exit(self._status)
        self.seen = True
        raise KeyboardInterrupt


def _is_importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename == "<frozen importlib._bootstrap>":
            return True
        frame = frame.f_back
    return False
