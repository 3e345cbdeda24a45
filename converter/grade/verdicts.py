"""Verdicts of all pictures: each different one is judged once, several side by side, and what is told is stored."""

import hashlib
import json
import multiprocessing
import signal
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path

from converter.files import replacing
from converter.grade.attempts import Attempt, Tell
from converter.grade.judge import OWN, Verdict, judge_picture, mistakes
from converter.grade.tasks import Task
from converter.scene.settings import Settings
from converter.why.picture import read_theirs

JUDGED = "judged"
"""Folder of a report that holds verdicts."""
_VERSION = "3"


def judge_all(
    attempts: Mapping[str, Mapping[str, Attempt]],
    tasks: Mapping[str, Task],
    settings: Settings,
    report: Path,
    jobs: int,
    tell: Tell,
) -> dict[str, dict[str, Verdict | None]]:
    """The verdict of each program's picture of each scene; None: there is no picture.

    Args:
        attempts: what became of them, by names of programs and scenes.
        tasks: the scenes, by name.
        settings: how they are read, and the size that was asked for.
        report: the folder in which verdicts and pictures are stored.
        jobs: pictures that are judged side by side.
        tell: told what is at hand and the share that is done.

    """
    wanted: dict[str, tuple[Task, Path, bool]] = {}
    keys: dict[tuple[str, str], str] = {}
    of_task = {name: task.fingerprint() for name, task in tasks.items()}
    for program, by_scene in attempts.items():
        for scene, attempt in by_scene.items():
            if attempt.picture is not None:
                file = report / attempt.picture
                parts = (_VERSION, _known(), of_task[scene], file.read_bytes(), attempt.lossy, settings)
                key = hashlib.sha256(repr(parts).encode()).hexdigest()
                keys[program, scene] = key
                wanted.setdefault(key, (tasks[scene], file, attempt.lossy))
    found = {key: _stored(report, key) for key in wanted}
    left = {key: wanted[key] for key, verdict in found.items() if verdict is None}

    def done(key: str, verdict: Verdict, share: float) -> None:
        found[key] = verdict
        _store(report, key, verdict)
        tell(f"judging {left[key][0].name}", share)

    _judge_left(left, settings, min(jobs, len(left)), done)
    return {
        program: {
            scene: None if attempt.picture is None else _with_own(found[keys[program, scene]], attempt)
            for scene, attempt in by_scene.items()
        }
        for program, by_scene in attempts.items()
    }


def _judge_left(
    left: Mapping[str, tuple[Task, Path, bool]],
    settings: Settings,
    jobs: int,
    done: Callable[[str, Verdict, float], None],
) -> None:
    if jobs < 2:
        for count, (key, (task, file, lossy)) in enumerate(left.items(), 1):
            done(key, _judge(task.file, file, lossy, settings), count / len(left))
        return
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_begin)
    alone = replace(settings, threads=1)
    try:
        futures = {pool.submit(_judge, t.file, file, lossy, alone): key for key, (t, file, lossy) in left.items()}
        for count, future in enumerate(as_completed(futures), 1):
            done(futures[future], future.result(), count / len(left))
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _begin() -> None:
    """In a new process: Ctrl-C is the business of the first one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _judge(scene: Path, picture: Path, lossy: bool, settings: Settings) -> Verdict:
    return judge_picture(scene, read_theirs(picture).levels, lossy, settings)


def _with_own(verdict: Verdict | None, attempt: Attempt) -> Verdict:
    """The verdict with the mistakes that lie in how the program ended."""
    assert verdict is not None
    if not attempt.mistakes:
        return verdict
    causes = (*verdict.causes, *attempt.mistakes)
    told = " ".join((verdict.sentence, *(f"Also: {OWN[name].sentence}." for name in attempt.mistakes)))
    return replace(verdict, right=False, causes=causes, sentence=told)


# ---- What is stored --------------------------------------------------------------------------------------------------


@cache
def _known() -> str:
    """Changes with the mistakes that are known."""
    return hashlib.sha256(repr(sorted(mistakes().items())).encode()).hexdigest()


def _stored(report: Path, key: str) -> Verdict | None:
    try:
        return Verdict.of(json.loads((report / JUDGED / f"{key}.json").read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _store(report: Path, key: str, verdict: Verdict) -> None:
    file = report / JUDGED / f"{key}.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    with replacing(file) as temporary:
        temporary.write_text(json.dumps(asdict(verdict)), encoding="utf-8")
