"""Runs one command within limits, and leaves nothing of it behind. A process of its own, which needs only Python.

    python warden.py '{"command": [...], ...}'    the fields are those of `Order`

prints what became of the command, the fields of `Ending`, as JSON. The command is ended with all that it has started
when it ends itself, when it goes beyond a limit, and when the warden's standard input closes: so it never outlives
whoever has started the warden.

A process that loses its parent becomes a child of the warden (`PR_SET_CHILD_SUBREAPER`), and nothing can leave a
process's descendants in any other way: not by a session of its own, nor as a daemon. Memory, processor time and the
number of tasks are those of all descendants together, as /proc has them, looked at some dozens of times a second.
"""

import ctypes
import json
import os
import resource
import select
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

_SUBREAPER = 36  # PR_SET_CHILD_SUBREAPER of <sys/prctl.h>
_LOOKS = 0.02
"""Seconds between two looks at the processes, at least."""
_COST = 20
"""A look takes at most about one in so many parts of a processor's time."""
_FOLDER_EVERY = 5
"""Looks between two at what has been written."""
_TOLD = 16384
"""Bytes of what a program says that are kept."""
_PATIENCE = 5.0
"""Seconds in which killed processes have to go."""
_TICK = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True, slots=True)
class Order:
    """What is run, and how far it may go.

    Attributes:
        command: the words of the command; the first is a file or found in PATH.
        folder: where it runs, and where what it writes is counted.
        environment: all of its environment.
        cores: the processors that it may run on.
        seconds: of processor time on each of these cores.
        clock_seconds: by the clock.
        memory, tasks, files: bytes, processes and threads, files, all together.
        output: bytes that it may write, into files and to its output, each.

    """

    command: list[str]
    folder: str
    environment: dict[str, str]
    cores: list[int]
    seconds: float
    clock_seconds: float
    memory: int
    tasks: int
    files: int
    output: int


@dataclass(slots=True)
class Ending:
    """What became of a command.

    Attributes:
        status: its exit status, negative for a signal; None: it was ended, or could not be started.
        beyond: the limit that it went beyond: "time", "clock", "memory", "tasks", "files", "output"; "" for none.
        trouble: why it could not be started; "" if it was.
        clock, cpu: seconds that it took, by the clock and of processor time.
        memory: bytes, the most that was seen.
        told: what it said, its first and its last bytes.

    """

    status: int | None = None
    beyond: str = ""
    trouble: str = ""
    clock: float = 0.0
    cpu: float = 0.0
    memory: int = 0
    told: str = ""


class Abandoned(Exception):  # noqa: N818 - what it says
    """Nobody waits for the ending any more."""


def run(order: Order, abandoned: int | None = None) -> Ending:
    """Run the command to its end, or to that of a limit; `abandoned` is a descriptor that closes when nobody waits.

    Raises:
        Abandoned: it has closed.

    """
    _libc().prctl(_SUBREAPER, 1, 0, 0, 0)
    ending = Ending()
    reading, writing = os.pipe()
    started = time.monotonic()
    try:
        process = subprocess.Popen(
            order.command,
            cwd=order.folder,
            env=order.environment,
            stdin=subprocess.DEVNULL,
            stdout=writing,
            stderr=writing,
            start_new_session=True,
            preexec_fn=lambda: _limit(order),
        )
    except (OSError, ValueError, subprocess.SubprocessError) as error:
        ending.trouble = getattr(error, "strerror", None) or str(error)
        return ending
    finally:
        os.close(writing)
    try:
        _Watch(order, ending, process.pid, reading, abandoned, started).until_the_end()
    finally:
        _end_all()
        os.close(reading)
    # Processes that nobody waited for are not in it; those that were seen alive have been counted by looking.
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    ending.cpu = max(ending.cpu, used.ru_utime + used.ru_stime)
    ending.memory = max(ending.memory, used.ru_maxrss * 1024)
    return ending


def _limit(order: Order) -> None:
    """In the new process, before the command: limits that the kernel watches over, for each process by itself."""
    with suppress(OSError):
        os.sched_setaffinity(0, order.cores)
    cpu = int(order.seconds * len(order.cores)) + 2
    for what, most in (
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_CPU, cpu),
        (resource.RLIMIT_FSIZE, order.output),
        (resource.RLIMIT_NOFILE, 1024),
        (resource.RLIMIT_NPROC, _own_tasks() + 2 * order.tasks),
    ):
        with suppress(OSError, ValueError):
            resource.setrlimit(what, (most, most))


def _own_tasks() -> int:
    """Tasks of this user: the kernel counts all of them against RLIMIT_NPROC."""
    count = 0
    for entry in Path("/proc").iterdir():
        with suppress(OSError):
            if entry.name.isdigit() and entry.stat().st_uid == os.getuid():
                count += _Stat.read(int(entry.name)).tasks
    return count


@dataclass(slots=True)
class _Watch:
    order: Order
    ending: Ending
    pid: int
    output: int
    abandoned: int | None
    started: float
    _first: bytes = b""
    _last: bytes = b""
    _said: int = 0
    _looks: int = 0

    def until_the_end(self) -> None:
        os.set_blocking(self.output, False)
        watched = [self.output] + ([] if self.abandoned is None else [self.abandoned])
        look, ended = self.started + _LOOKS, os.pidfd_open(self.pid)
        try:
            while True:
                ready, _, _ = select.select([*watched, ended], [], [], max(0.0, look - time.monotonic()))
                if self.abandoned in ready:
                    raise Abandoned
                if self.output in ready and not self._listen():
                    watched.remove(self.output)
                if ended in ready:
                    self.ending.clock = time.monotonic() - self.started
                    _, status = os.waitpid(self.pid, 0)
                    self.ending.status = os.waitstatus_to_exitcode(status)
                    while self._listen() and not self.ending.beyond:
                        pass
                    break
                now = time.monotonic()
                if now >= look:
                    spent = time.process_time()  # by the clock, looks would be rare on a machine that is busy
                    self.ending.beyond = self.ending.beyond or self._look(now - self.started)
                    look = time.monotonic() + max(_LOOKS, _COST * (time.process_time() - spent))
                if self.ending.beyond:
                    self.ending.clock = now - self.started
                    break
        finally:
            os.close(ended)
        if not self.ending.beyond:
            self.ending.beyond = self._beyond_folder()
        cut = b"\n[...]\n" if self._said > len(self._first) + len(self._last) else b""
        self.ending.told = (self._first + cut + self._last).decode(errors="replace")

    def _listen(self) -> bool:
        """Take what the program says; False: there is nothing more for now, or for ever."""
        try:
            said = os.read(self.output, 1 << 16)
        except BlockingIOError:
            return False
        self._said += len(said)
        room = _TOLD // 2 - len(self._first)
        self._first += said[: max(room, 0)]
        self._last = (self._last + said[max(room, 0) :])[-_TOLD // 2 :]
        if self._said > self.order.output:
            self.ending.beyond = "output"
        return bool(said)

    def _look(self, clock: float) -> str:
        """The limit that the processes are beyond, if any."""
        order, ending = self.order, self.ending
        tasks, memory, cpu = 0, 0, 0.0
        for stat in _descendants():
            tasks += stat.tasks
            cpu += stat.cpu
            memory += _own_memory(stat.pid)
        ending.cpu, ending.memory = max(ending.cpu, cpu), max(ending.memory, memory)
        self._looks += 1
        if clock > order.clock_seconds:
            return "clock"
        if cpu > order.seconds * len(order.cores):
            return "time"
        if memory > order.memory:
            return "memory"
        if tasks > order.tasks:
            return "tasks"
        return self._beyond_folder() if self._looks % _FOLDER_EVERY == 0 else ""

    def _beyond_folder(self) -> str:
        size, count = 0, 0
        for folder, _, files in os.walk(self.order.folder):
            count += 1 + len(files)
            if count > self.order.files:
                return "files"
            for name in files:
                with suppress(OSError):
                    size += os.lstat(os.path.join(folder, name)).st_blocks * 512  # noqa: PTH118 - half the time
        return "output" if size > self.order.output else ""


# ---- Processes -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Stat:
    pid: int
    parent: int
    dead: bool
    cpu: float
    tasks: int

    @staticmethod
    def read(pid: int) -> "_Stat":
        text = Path(f"/proc/{pid}/stat").read_bytes()
        fields = text[text.rindex(b")") + 2 :].split()  # after the name, which may hold anything
        cpu = sum(map(int, fields[11:15])) / _TICK
        return _Stat(pid, int(fields[1]), fields[0] in (b"Z", b"X"), cpu, int(fields[17]))


def _descendants() -> Iterator[_Stat]:
    """All that come from this process, and are still there."""
    children: dict[int, list[_Stat]] = {}
    for name in os.listdir("/proc"):  # noqa: PTH208 - half the time
        if name.isdigit():
            with suppress(OSError, ValueError, IndexError):
                stat = _Stat.read(int(name))
                children.setdefault(stat.parent, []).append(stat)
    left = children.pop(os.getpid(), [])
    while left:
        stat = left.pop()
        left += children.pop(stat.pid, [])
        yield stat


def _own_memory(pid: int) -> int:
    """Bytes that a process has to itself, or shares as memory with its likes: not those of files."""
    with suppress(OSError, ValueError, IndexError):
        _, resident, shared = Path(f"/proc/{pid}/statm").read_bytes().split()[:3]
        return (int(resident) - int(shared)) * _PAGE
    return 0


def _end_all() -> None:
    """Kill all descendants: first stop them, so that none has time to make others."""
    until = time.monotonic() + _PATIENCE
    while time.monotonic() < until:
        alive = [stat.pid for stat in _descendants() if not stat.dead]
        for number in (signal.SIGSTOP, signal.SIGKILL):
            for pid in alive:
                with suppress(OSError):
                    os.kill(pid, number)
        with suppress(ChildProcessError):
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        if not alive and not any(True for _ in _descendants()):
            return
        time.sleep(0.002)


def _libc() -> ctypes.CDLL:
    return ctypes.CDLL(None, use_errno=True)


def main() -> int:
    """Run what the argument orders."""
    order = Order(**json.loads(sys.argv[1]))
    try:
        ending = run(order, abandoned=0)
    except Abandoned:
        return 1
    print(json.dumps(asdict(ending)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
