"""One command, run within limits and walls by a warden."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

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


CLOCK = 2.0
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


def run(
    command: Sequence[str], folder: Path, seen: Sequence[Path], limits: Limits, walls: Walls, cores: Sequence[int]
) -> Ending:
    """Run a command in `folder`, where alone it may write, on the processors `cores`.

    Its environment is bare and the same for all. An interruption of this process ends the command.
    """
    order = Order(
        command=walls.around(command, folder, seen),
        folder=str(folder),
        environment={
            "PATH": os.defpath if walls.bubblewrap else os.environ.get("PATH", os.defpath),
            "HOME": str(folder),
            "LANG": "C.UTF-8",
            "OMP_NUM_THREADS": str(len(cores)),
        },
        cores=list(cores),
        seconds=limits.seconds,
        clock_seconds=limits.clock_seconds,
        memory=limits.memory * MIB,
        tasks=limits.tasks,
        files=_FILES,
        output=limits.output * MIB,
    )
    process = subprocess.Popen(
        [sys.executable, "-I", "-S", warden.__file__, json.dumps(asdict(order))],
        stdin=subprocess.PIPE,  # never written to: it closes with this process, whatever ends it
        stdout=subprocess.PIPE,
        start_new_session=True,
    )
    assert process.stdin is not None and process.stdout is not None
    with process.stdin, process.stdout:
        said = process.stdout.read()
    process.wait()
    try:
        return Ending(**json.loads(said))
    except (ValueError, TypeError):
        return Ending(trouble="its warden was ended, most likely by the program")


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


_BY_SIGNAL = {signal.SIGXCPU: "time", signal.SIGXFSZ: "output"}
"""Signals by which the kernel keeps to limits."""


def _signal(status: int | None) -> int:
    """The signal that ended a program, 0 for none; a shell, or bubblewrap, adds 128 to its number."""
    number = 0 if status is None else -status if status < 0 else status - 128
    return number if number in set(signal.Signals) else 0
