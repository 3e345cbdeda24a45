"""A process that draws pictures for this one, so that no method can take it down, hang it, or eat up its memory."""

import contextlib
import multiprocessing
import os
import sys
from multiprocessing.connection import Connection
from types import TracebackType
from typing import Any

import numpy as np

from converter.compare.metrics import Pixels
from converter.scene.model import Scene
from converter.scene.settings import Settings

MEMORY = 8 << 30
"""Bytes of data that the process may have."""
CERTIFICATE = "certificate"
"""In the place of a method: the colours that are proven, NaN where none is."""
STARTING = 60.0
"""Seconds that it may take to start and to load what a first picture needs, beside the picture's own."""
PATIENCE = 10.0
"""Seconds to wait for each of CPU time that a picture may take: a machine is loaded, or a process sleeps for ever."""


class DrawingFailed(Exception):  # noqa: N818 - what it says
    """A method did not draw its picture; the message says why."""


class TookTooLong(DrawingFailed):
    """Nor had it when its time was over; the message says which time."""


class Worker:
    """Draws in a process of its own, which starts with the first picture, and anew after one that did not end well."""

    def __init__(self) -> None:
        self._process: Any = None
        self._pipe: Connection | None = None

    def render(self, method: str, variant: str | None, scene: Scene, settings: Settings, seconds: float) -> Pixels:
        """The picture of `scene` by a method, by its name, or by `CERTIFICATE`, within `seconds` of CPU time.

        CPU time is that of all threads, and of processes that the method starts: a loaded machine changes it little.

        Raises:
            DrawingFailed: there is none, for a reason that the method gave, or since its process ended.
            TookTooLong: it took more CPU time, or is not there after `PATIENCE` times as many seconds.
            KeyboardInterrupt: Ctrl-C; the process is gone then.

        """
        patience = PATIENCE * seconds
        try:
            if self._pipe is None:
                self._start()
                patience += STARTING
            assert self._pipe is not None
            self._pipe.send((method, variant, scene, settings, seconds))
            if not self._pipe.poll(patience):
                self.stop()
                raise TookTooLong(f"no picture within {patience:g} s")
            drawn = self._pipe.recv()
        except (EOFError, ConnectionError):
            code = self._exit_code()
            self.stop()
            why = _why(code)
            if why == "SIGPROF":
                raise _spent(seconds) from None
            raise DrawingFailed(f"its process ended: {why}") from None
        except KeyboardInterrupt:
            self.stop()
            raise
        if isinstance(drawn, DrawingFailed):
            raise drawn
        pixels: Pixels = drawn
        return pixels

    def stop(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process = None
        if self._pipe is not None:
            self._pipe.close()
            self._pipe = None

    def __enter__(self) -> "Worker":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def _start(self) -> None:
        # Not forked: the threads of Dr.Jit do not survive that.
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_work, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()

    def _exit_code(self) -> int | None:
        self._process.join(5.0)
        code: int | None = self._process.exitcode
        return code


def _why(code: int | None) -> str:
    if code is not None and code < 0:
        import signal

        with contextlib.suppress(ValueError):
            return signal.Signals(-code).name
    return f"exit status {code}"


def _spent(seconds: float) -> TookTooLong:
    return TookTooLong(f"no picture within {seconds:g} s of CPU time")


# ---- In the other process --------------------------------------------------------------------------------------------


def _work(pipe: Connection) -> None:
    """Draw what is asked for, until the other end is closed."""
    import signal

    # Ctrl-C goes to both processes: the other one decides.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _limit_memory()
    # Libraries that warn of a scene's numbers, or abort, write what would only spoil the progress bar.
    silence = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(AttributeError, OSError, ValueError):
            stream.flush()
            os.dup2(silence, stream.fileno())
    renderers: dict[tuple[str, str | None], Any] = {}
    while True:
        try:
            method, variant, scene, settings, seconds = pipe.recv()
        except EOFError:
            return
        _end_after(seconds)
        drawn = _draw(renderers, method, variant, scene, settings, seconds)
        _end_after(0.0)
        pipe.send(drawn)


def _draw(
    renderers: dict[tuple[str, str | None], Any],
    name: str,
    variant: str | None,
    scene: Scene,
    settings: Settings,
    seconds: float,
) -> Pixels | DrawingFailed:
    """The picture, or why there is none. A method that raises whatever error has failed: to find that is the aim."""
    begun = _cpu_time()
    drawn: Pixels | DrawingFailed
    try:
        drawn = _picture(renderers, name, variant, scene, settings)
    except MemoryError:
        drawn = DrawingFailed("not enough memory")
    except Exception as error:
        drawn = DrawingFailed(f"{type(error).__name__}: {error}".splitlines()[0])
    # The timer leaves out what other processes take, as POV-Ray's.
    return _spent(seconds) if _cpu_time() - begun > seconds else drawn


def _picture(
    renderers: dict[tuple[str, str | None], Any], name: str, variant: str | None, scene: Scene, settings: Settings
) -> Pixels:
    from converter.renderers.methods import find_method

    if name == CERTIFICATE:
        from converter.certify.certificate import certify

        return certify(scene, settings).colors.astype(np.float32)
    method = find_method(name)
    if (name, variant) not in renderers:
        renderers[name, variant] = method.renderer(variant)
    rendering = renderers[name, variant].render(scene, method.settings(settings))
    return np.array(rendering.pixels, dtype=np.float32)


def _cpu_time() -> float:
    """Seconds of this process, and of those that it started and that have ended."""
    return sum(os.times()[:4])


def _end_after(seconds: float) -> None:
    """Let SIGPROF end this process after so much CPU time of its own; 0 is never."""
    import signal

    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_PROF, seconds)


def _limit_memory() -> None:
    try:
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        most = MEMORY if hard == resource.RLIM_INFINITY else min(MEMORY, hard)
        resource.setrlimit(resource.RLIMIT_DATA, (most, hard))
    except (ImportError, OSError, ValueError):
        pass  # a system without such limits
