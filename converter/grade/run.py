"""One command, run within limits and walls by a warden."""

import json
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from threading import Lock

from converter.grade import warden
from converter.grade.sandbox import Walls
from converter.grade.warden import Ending, Order

MIB = 1 << 20


@dataclass(frozen=True, slots=True)
class Limits:
    """How far a program may go.

    Attributes:
        seconds: of processor time on each of its cores; by the clock it has `CLOCK` times as much and a second.
        memory, output: MiB in use, and written.
        tasks: processes and threads.
        cores: on which it runs.

    """

    seconds: float = 10.0
    memory: int = 1024
    output: int = 64
    tasks: int = 128
    cores: int = 1

    @property
    def clock_seconds(self) -> float:
        """Seconds by the clock: a program may have to wait for a busy machine."""
        return CLOCK * self.seconds + 1


CLOCK = 3.0
_PATH = "/usr/local/bin:/usr/bin:/bin"
_FILES = 10_000
_BUILD = Limits(seconds=120.0, memory=2048, output=512, tasks=256)


def build_limits(limits: Limits) -> Limits:
    """What making a program may take, on the same cores: more than the program itself."""
    return replace(
        _BUILD,
        memory=max(_BUILD.memory, limits.memory),
        tasks=max(_BUILD.tasks, limits.tasks),
        cores=limits.cores,
    )


class Stopped(Exception):  # noqa: N818 - what it says
    """All is to end: the command was ended before its time."""


class Runner:
    """Runs commands within limits and walls, from any thread.

    Attributes:
        walls: that stand about each.

    """

    def __init__(self, walls: Walls) -> None:
        self.walls = walls
        self._lock = Lock()
        self._running: set[subprocess.Popen[bytes]] = set()
        self._stopped = False

    def run(
        self, command: Sequence[str], folder: Path, seen: Sequence[Path], limits: Limits, cores: Sequence[int]
    ) -> Ending:
        """Run a command in `folder`, where alone it may write, on the processors `cores`.

        Its environment is bare and the same for all. It does not outlive this process.

        Raises:
            Stopped: `stop` has ended it.

        """
        environment = {"PATH": _PATH, "HOME": str(folder), "LANG": "C.UTF-8", "OMP_NUM_THREADS": str(len(cores))}
        order = Order(
            command=self.walls.around(command, folder, seen),
            folder=str(folder),
            environment=environment,
            cores=list(cores),
            seconds=limits.seconds,
            clock_seconds=limits.clock_seconds,
            memory=limits.memory * MIB,
            tasks=limits.tasks,
            files=_FILES,
            output=limits.output * MIB,
        )
        said = self._watched([sys.executable, "-I", "-S", warden.__file__, json.dumps(asdict(order))])
        try:
            return Ending(**json.loads(said))
        except (ValueError, TypeError):
            return Ending(trouble="its warden was ended, most likely by the program")

    def stop(self) -> None:
        """End all commands, and begin none any more."""
        with self._lock:
            self._stopped = True
            for process in self._running:
                if process.stdin is not None:
                    process.stdin.close()

    def _watched(self, command: Sequence[str]) -> bytes:
        with self._lock:
            if self._stopped:
                raise Stopped
            # Nothing is written to its standard input, which closes with this process, whatever ends it.
            pipe = subprocess.PIPE
            process = subprocess.Popen(command, stdin=pipe, stdout=pipe, start_new_session=True)
            self._running.add(process)
        assert process.stdin is not None and process.stdout is not None
        with process.stdout:
            said = process.stdout.read()
        process.wait()
        with self._lock:
            self._running.remove(process)
            process.stdin.close()
            if self._stopped:
                raise Stopped
        return said


def told(ending: Ending, limits: Limits) -> str:
    """What went wrong, in a sentence without its first capital; "" if nothing did."""
    beyond = ending.beyond or _BY_SIGNAL.get(_signal(ending.status), "")
    match beyond:
        case "time":
            cores = "" if limits.cores == 1 else f" on each of {limits.cores} cores"
            return f"ended after {limits.seconds:g} s of processor time{cores}"
        case "clock":
            return f"ended after {limits.clock_seconds:g} s in which it did not end itself"
        case "memory":
            return f"ended at more than {limits.memory} MiB of memory"
        case "tasks":
            return f"ended at more than {limits.tasks} processes and threads"
        case "files":
            return f"ended at more than {_FILES} files"
        case "output":
            return f"ended at more than {limits.output} MiB of output"
    if ending.trouble:
        return f"could not be started: {ending.trouble.lower()}"
    if number := _signal(ending.status):
        return f"crashed: {signal.Signals(number).name} ({(signal.strsignal(number) or '').lower()})"
    return f"ended with status {ending.status}" if ending.status else ""


_BY_SIGNAL: dict[int, str] = {signal.SIGXCPU: "time", signal.SIGXFSZ: "output"}
"""Signals by which the kernel keeps to limits."""


def _signal(status: int | None) -> int:
    """The signal that ended a program, 0 for none; a shell, or bubblewrap, adds 128 to its number."""
    number = 0 if status is None else -status if status < 0 else status - 128
    return number if number in set(signal.Signals) else 0
