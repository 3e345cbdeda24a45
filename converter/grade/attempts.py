"""Programs at work on scenes: side by side, each on processors of its own, and what is left is kept.

What an attempt has left is stored as soon as it is there, under a key of all that it depends on: so that a run that was
interrupted goes on where it was, and one with another rubric runs no program at all.
"""

import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from queue import SimpleQueue

import numpy as np

from converter.files import replacing
from converter.grade.pictures import NoPicture, decode, take
from converter.grade.programs import Built, Program, build, fingerprint, remove_all
from converter.grade.run import MIB, Limits, Runner, told
from converter.grade.tasks import Task
from converter.grade.warden import Ending
from converter.images.write import write_image

RUNS, WORK = "runs", "work"
"""Folders of a report: what attempts have left, and where they are made."""
_VERSION = "1"
"""Changes with what is stored, and with how programs are run."""

Tell = Callable[[str, float], None]


@dataclass(frozen=True, slots=True)
class Attempt:
    """What became of a program on a scene.

    Attributes:
        trouble: why there is no picture, or what else went wrong; "" for nothing.
        said: what the program, or its build, said where something went wrong.
        clock, cpu: seconds that it took, by the clock and of processor time.
        memory: MiB, the most that was seen.
        picture: the file that holds it, below the report's folder; None: there is none.
        lossy: whether the picture was compressed with losses.
        mistakes: those that lie in how the program ended, of `judge.OWN`.

    """

    trouble: str = ""
    said: str = ""
    clock: float = 0.0
    cpu: float = 0.0
    memory: int = 0
    picture: str | None = None
    lossy: bool = False
    mistakes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Order:
    """How programs are run.

    Attributes:
        width, height: of the pictures.
        out: name of the pictures.
        limits: how far a program may go.
        jobs: how many are run side by side.
        make: what makes programs of folders; None: by what they hold.
        anew: whether what is stored does not count.

    """

    width: int
    height: int
    out: str
    limits: Limits
    jobs: int
    make: str | None = None
    anew: bool = False


def attempt_all(
    programs: Sequence[Program], tasks: Sequence[Task], order: Order, runner: Runner, report: Path, tell: Tell
) -> dict[str, dict[str, Attempt]]:
    """What becomes of each program on each scene, by their names.

    Args:
        programs: they; each runs alone on its processors, one scene after the other.
        tasks: the scenes.
        order: how they are run.
        runner: what runs them.
        report: a folder, in which all is stored.
        tell: told what is at hand and the share that is done.

    """
    free: SimpleQueue[list[int]] = SimpleQueue()
    available = sorted(os.sched_getaffinity(0))
    for job in range(order.jobs):
        free.put(available[job * order.limits.cores : (job + 1) * order.limits.cores])
    done = 0

    def work(program: Program) -> dict[str, Attempt]:
        cores = free.get()
        try:
            return _Bench(program, order, runner, report, cores).attempt(tasks)
        finally:
            free.put(cores)

    (report / WORK).mkdir(parents=True, exist_ok=True)
    result: dict[str, dict[str, Attempt]] = {}
    with ThreadPoolExecutor(order.jobs) as pool:
        futures = {pool.submit(work, program): program for program in programs}
        try:
            for future in as_completed(futures):
                result[futures[future].name] = future.result()
                done += 1
                tell(f"running {futures[future].name}", done / len(programs))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            runner.stop()
            raise
    remove_all(report / WORK)
    return {program.name: result[program.name] for program in programs}


@dataclass(slots=True)
class _Bench:
    """A program at work, on its processors."""

    program: Program
    order: Order
    runner: Runner
    report: Path
    cores: list[int]

    def attempt(self, tasks: Sequence[Task]) -> dict[str, Attempt]:
        of_program = fingerprint(self.program)
        built: Built | None = None
        result = {}
        for task in tasks:
            key = self._key(of_program, task)
            stored = None if self.order.anew else self._stored(task, key)
            if stored is None:
                if built is None:
                    built = self._built()
                stored = self._fresh(task, built)
                self._store(task, key, stored)
            result[task.name] = stored
        return result

    def _built(self) -> Built:
        order = self.order
        return build(self.program, self.report / WORK, order.make, order.limits, self.runner, self.cores)

    def _fresh(self, task: Task, built: Built) -> Attempt:
        if built.trouble:
            return Attempt(built.trouble, built.said)
        order = self.order
        folder = Path(tempfile.mkdtemp(prefix="run-", dir=self.report / WORK))
        try:
            scene = task.copy_to(folder)
            before = [path.name for path in folder.iterdir()]
            command = built.command(scene, order.out, order.width, order.height)
            ending = self.runner.run(command, folder, built.seen, order.limits, self.cores)
            return self._taken(task, folder, before, ending)
        finally:
            remove_all(folder)

    def _taken(self, task: Task, folder: Path, before: Sequence[str], ending: Ending) -> Attempt:
        limits = self.order.limits
        trouble = told(ending, limits)
        bare = Attempt(trouble, ending.told, ending.clock, ending.cpu, ending.memory // MIB)
        if ending.beyond or ending.trouble:
            return bare
        try:
            left = take(folder, self.order.out, [*before, ".tmp"], limits.output * MIB)
            with tempfile.TemporaryDirectory() as name:
                file = Path(name) / f"picture{Path(left.name).suffix[:8]}"
                file.write_bytes(left.data)
                theirs = decode(file, self.runner, self.cores)
        except NoPicture as error:
            return replace(bare, trouble=f"{trouble}, and {error}" if trouble else str(error))
        picture = self._place(task, ".png")
        picture.parent.mkdir(parents=True, exist_ok=True)
        height, width, _ = theirs.levels.shape
        write_image(picture, np.divide(theirs.levels, 255, dtype=np.float32), width, height)
        mistakes = [name for name, made in (("status", trouble), ("name", left.name != self.order.out)) if made]
        if left.name != self.order.out and not trouble:
            trouble = f"its picture is called {left.name}"
        return replace(
            bare,
            trouble=trouble,
            said=ending.told if trouble else "",
            picture=str(picture.relative_to(self.report)),
            lossy=theirs.lossy,
            mistakes=tuple(mistakes),
        )

    # ---- What is stored -----------------------------------------------------------------------------------------

    def _place(self, task: Task, ending: str) -> Path:
        return self.report / RUNS / self.program.name / f"{task.name}{ending}"

    def _key(self, of_program: str, task: Task) -> str:
        order = self.order
        walls = bool(self.runner.walls.bubblewrap)
        parts = (_VERSION, of_program, task.fingerprint(), order.width, order.height, order.out, order.make, walls)
        return hashlib.sha256(repr((*parts, order.limits)).encode()).hexdigest()

    def _stored(self, task: Task, key: str) -> Attempt | None:
        try:
            data = json.loads(self._place(task, ".json").read_text(encoding="utf-8"))
            if data.pop("key") != key:
                return None
            attempt = Attempt(**{**data, "mistakes": tuple(data["mistakes"])})
        except (OSError, ValueError, TypeError, KeyError):
            return None
        there = attempt.picture is None or (self.report / attempt.picture).is_file()
        return attempt if there else None

    def _store(self, task: Task, key: str, attempt: Attempt) -> None:
        file = self._place(task, ".json")
        file.parent.mkdir(parents=True, exist_ok=True)
        if attempt.picture is None:
            self._place(task, ".png").unlink(missing_ok=True)
        with replacing(file) as temporary:
            temporary.write_text(json.dumps({"key": key, **asdict(attempt)}, indent=1), encoding="utf-8")
