"""A process that does for the page what takes long, so that typing and the native picture never wait for it.

It starts with the first call, and anew after one that has taken it down.
"""

import asyncio
import multiprocessing
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any


class HelperError(Exception):
    """A call has failed; the message says why."""


class Helper:
    """Calls functions of modules in another process, one at a time, in the order in which they are asked for."""

    def __init__(self) -> None:
        self._turn = asyncio.Lock()
        self._alive = threading.Lock()
        self._process: Any = None
        self._pipe: Connection | None = None
        self._ended = False

    async def call(self, function: Callable[..., Any], *arguments: Any, wanted: Callable[[], bool]) -> Any:
        """What the function returns; None if, when its turn comes, it is no longer wanted.

        Raises:
            HelperError: it raised an error, or took the process down.

        """
        async with self._turn:
            if self._ended or not wanted():
                return None
            # Shielded: a caller who goes away must not let the next one speak into the same pipe.
            return await asyncio.shield(asyncio.to_thread(self._call, function, arguments))

    def end(self) -> None:
        """End the process, and with it whatever it is doing."""
        self._ended = True
        with self._alive:
            if self._process is not None:
                self._process.kill()
                self._process.join()

    def _call(self, function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
        try:
            pipe = self._started()
            pipe.send((function, arguments))
            fine, result = pipe.recv()
        except (EOFError, OSError):
            self._pipe = None
            raise HelperError("the process that does this has ended") from None
        if not fine:
            raise HelperError(result)
        return result

    def _started(self) -> Connection:
        with self._alive:
            if self._ended:
                raise EOFError
            if self._pipe is None:
                # Not forked: neither threads nor Dr.Jit survive that.
                context = multiprocessing.get_context("spawn")
                self._pipe, theirs = context.Pipe()
                self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
                self._process.start()
                theirs.close()
            return self._pipe


def _serve(pipe: Connection) -> None:
    """In the other process: do what is asked for, until the other end is closed."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to both: the page decides
    while True:
        try:
            function, arguments = pipe.recv()
        except EOFError:
            return
        try:
            answer = True, function(*arguments)
        except MemoryError:
            answer = False, "not enough memory"
        except Exception as error:  # whatever it is, the page goes on without
            answer = False, str(error) or type(error).__name__
        pipe.send(answer)
