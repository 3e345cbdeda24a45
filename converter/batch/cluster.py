"""Pictures drawn by the workers of Dask's distributed scheduler, on this machine or elsewhere.

What pictures share goes to a worker once: a job and each of its textures are results of tasks of their own, which Dask
keeps where they are needed, and makes again where a worker is lost. Textures travel by their bytes, so that workers
need none of our files. Few pictures are asked for at a time, so that few wait here to be written.
"""

import gc
import logging
import math
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from hashlib import sha256
from importlib import metadata
from importlib.util import find_spec
from itertools import count as counted
from pathlib import Path
from typing import Any, NamedTuple

from converter.batch.pictures import Drawn, Job, Picture, assembled, encoded, tiles_of
from converter.batch.run import Result, Wanted
from converter.batch.worker import Blob, draw_at_worker, same
from converter.pigments.table import pigment_kind
from converter.renderers.base import Progress
from converter.renderers.native import available_cores
from converter.scene.needs import scene_needs

AHEAD = 3
"""Tasks at a time, for each worker: one is at work, the others wait."""
TASK_SECONDS = 0.5
"""What a task takes, of pictures that take less."""
LEAST_SECONDS = 0.05
"""What one takes at the end: tasks get shorter there, so that no worker waits long for another's last."""
COUNTING_SECONDS = 2.0
"""Between two looks at how many workers there are."""
PATIENCE = 20.0
"""Seconds to wait for a scheduler that does not answer."""


_CALM = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500 ms",
    "distributed.admin.tick.limit": "60 s",
    "distributed.admin.system-monitor.interval": "5 s",
}
"""Dask looks at its processes less often than it does else, a hundred times a second: they are few, and have work."""


class ClusterError(Exception):
    """Others cannot draw: there is no Dask, no scheduler, or workers die."""


@dataclass(frozen=True, slots=True)
class Cluster:
    """Who draws: Dask's client, and the threads of each worker's renderer, 0 for as many as it has cores."""

    client: Any
    threads: int


@contextmanager
def cluster(workers: int | None, scheduler: str | None, quiet: bool) -> Iterator[Cluster]:
    """So many workers on this machine, or those of the scheduler at an address.

    Raises:
        ClusterError: Dask is not installed, or the scheduler does not answer.

    """
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise ClusterError("--workers and --scheduler need Dask: pip install 'whitted[cluster]'") from None
    from converter.commands.notes import say

    for name in logging.root.manager.loggerDict:  # what they have to say, our errors say
        if name.startswith("distributed"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    if scheduler is not None:
        with _connected(Client, scheduler) as client:
            say(f"note: the workers of {client.scheduler.address} draw{_dashboard(client)}", quiet)
            if not client.nthreads():
                say("note: there are no workers yet; those that come draw", quiet)
            yield Cluster(client, 0)
        return
    count = workers or 1
    with (
        _started(
            LocalCluster,
            n_workers=count,
            threads_per_worker=1,
            memory_limit=None,
            silence_logs=logging.CRITICAL,
            dashboard_address=":0",  # any that is free
        ) as local,
        Client(local) as client,
    ):
        if find_spec("bokeh"):
            say(f"note: {count} workers draw{_dashboard(client)}", quiet)
        yield Cluster(client, max(1, available_cores() // count))


def _connected(make: Callable[..., Any], address: str) -> Any:
    """A client of the scheduler at an address."""
    try:
        with warnings.catch_warnings(action="ignore"):  # of other versions of what does not matter
            return make(address, timeout=PATIENCE)
    except Exception as error:  # Dask has many for addresses that are none, or need what is not set up
        told = str(error)
    # A client that has failed closes itself when it is collected. In a thread of Dask's that starts meanwhile, it would
    # wait for that thread.
    gc.collect()
    raise ClusterError(f"--scheduler: nothing answers at {address!r}: {told}")


def _started(make: Callable[..., Any], **options: Any) -> Any:
    """A cluster whose processes leave Ctrl-C to this one, which ends them."""
    from dask import config

    with config.set(_CALM):
        if threading.current_thread() is not threading.main_thread():
            return make(**options)
        before = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            return make(**options)
        finally:
            signal.signal(signal.SIGINT, before)


def _dashboard(client: Any) -> str:
    return f"; dashboard: {client.dashboard_link}" if find_spec("bokeh") and client.dashboard_link else ""


@dataclass(slots=True)
class _Tiled:
    """A picture of which bands are drawn: those that are there, by their places."""

    wanted: Wanted
    missing: int
    tiles: list[Any]


class _Piece(NamedTuple):
    """A picture, or a band of one, that is drawn at once."""

    tiled: _Tiled
    place: int
    picture: Picture


def drawn_by(found: Cluster, wanted: Iterable[Wanted], count: int, progress: Progress) -> Iterator[Result]:
    """The pictures, as they are finished: large ones in bands, by several workers at once, small ones several at a
    time, for a task costs some milliseconds.

    Raises:
        ClusterError: the scheduler is gone.

    """
    sending = _Sending(found, count)
    pieces = _Pieces(piece for each in wanted for piece in sending.pieces_of(each))
    waiting: dict[Any, list[_Piece]] = {}
    seconds, drawn, sent, done = 0.0, 0, 0.0, 0.0
    while True:
        sending.count_workers()
        while len(waiting) < sending.room:
            if not (group := pieces.take(_task_size(seconds / drawn if drawn else 1.0, count - sent, sending.workers))):
                break
            sent += sum(1 / len(piece.tiled.tiles) for piece in group)
            waiting[sending.submit(group)] = group
        if not waiting:
            return
        for future in _finished(found.client, list(waiting)):
            group = waiting.pop(future)
            results = _results(found.client, future, len(group))
            for (tiled, place, _), result in zip(group, results, strict=True):
                if isinstance(result, Drawn):
                    seconds, drawn = seconds + sum(result.seconds.values()), drawn + 1
                done += 1 / len(tiled.tiles)
                progress(min(done / count, 1))
                tiled.tiles[place] = result
                tiled.missing -= 1
                if tiled.missing == 0:
                    yield tiled.wanted.number, _whole(tiled)


def _task_size(seconds: float, left: float, workers: int) -> int:
    """How many pictures of so many seconds each are a task.

    Half of each worker's share of what is left, after Polychronopoulos and Kuck, "Guided self-scheduling", 1987, within
    limits of time.
    """
    a_second = 1 / max(seconds, 1e-6)
    return int(max(1, LEAST_SECONDS * a_second, min(TASK_SECONDS * a_second, left / (2 * workers))))


class _Pieces:
    """Pieces in turn, taken in groups of one job."""

    def __init__(self, pieces: Iterator[_Piece]) -> None:
        self._pieces = pieces
        self._next: _Piece | None = None

    def take(self, most: int) -> list[_Piece]:
        """The next ones, so many at most; none at the end."""
        result: list[_Piece] = []
        while len(result) < most:
            piece = self._next or next(self._pieces, None)
            self._next = None
            if piece is None:
                break
            if result and piece.tiled.wanted.job is not result[0].tiled.wanted.job:
                self._next = piece
                break
            result.append(piece)
        return result


class _Sending:
    """What is sent to workers, and what of it is there already."""

    def __init__(self, found: Cluster, count: int) -> None:
        self._client, self._threads = found.client, found.threads
        self._keys = counted()
        self.workers = 1
        self._known: set[str] = set()
        self._job: tuple[Job | None, Any, list[Any]] = (None, None, [])
        self._textures: dict[str, Any] = {}
        self._counted = -math.inf
        self.count_workers()
        # Fewer pictures than workers are cut finer, so that all have something to do.
        self._least = 2 * self.workers if count < self.workers else 1

    def count_workers(self) -> None:
        """See how many workers there are, if that was some time ago: of a cluster they come and go.

        Raises:
            ClusterError: one does not have this package, or another version of it.

        """
        if time.monotonic() - self._counted < COUNTING_SECONDS:
            return
        with suppress(OSError):  # the scheduler is gone, as is told elsewhere
            found = set(self._client.nthreads())
            _check_versions(self._client, found - self._known)
            self._known |= found
            self.workers = max(1, len(found))
        self.room = AHEAD * self.workers
        self._counted = time.monotonic()

    def pieces_of(self, wanted: Wanted) -> Iterator[_Piece]:
        job, picture = wanted.job, wanted.picture
        tiles = tiles_of(job.settings, scene_needs(job.scene, job.settings).samples, self._least)
        tiled = _Tiled(wanted, len(tiles), [None] * len(tiles))
        for place, tile in enumerate(tiles):
            yield _Piece(tiled, place, picture if len(tiles) == 1 else replace(picture, crop=tile))

    def submit(self, group: list[_Piece]) -> Any:
        if self._client.status != "running":
            raise _gone()
        job = group[0].tiled.wanted.job
        if self._job[0] is not job:
            threads = job.settings.threads or self._threads
            sent = replace(job, settings=replace(job.settings, threads=threads))
            blobs = [self._sent_texture(file) for file in sorted(_textures(job))]
            name = f"job-{next(self._keys)}-{time.time_ns()}"
            self._job = (job, self._client.submit(same, (name, sent), key=name, pure=False), blobs)
        _, its_future, blobs = self._job
        key = f"pictures-{next(self._keys)}-{time.time_ns()}"
        pictures = [piece.picture for piece in group]
        return self._client.submit(draw_at_worker, its_future, blobs, pictures, key=key, pure=False)

    def _sent_texture(self, file: Path) -> Any:
        data = file.read_bytes()
        name = sha256(data).hexdigest() + file.suffix
        if name not in self._textures:
            self._textures[name] = self._client.submit(same, Blob(name, data), key=f"texture-{name}", pure=True)
        return self._client.submit(_named, str(file), self._textures[name], pure=False)


def _check_versions(client: Any, workers: set[str]) -> None:
    from converter.commands.version import version

    ours = version()
    if not workers or not ours[0].isdigit():  # which of a source folder is not known
        return
    # A function of ours could not travel to a worker that lacks the package.
    answers = client.run(metadata.version, "whitted", workers=sorted(workers), on_error="return")
    for address, found in answers.items():
        if isinstance(found, metadata.PackageNotFoundError):
            raise ClusterError(f"the worker at {address} does not have this package: pip install 'whitted[cluster]'")
        if isinstance(found, str) and found != ours:
            raise ClusterError(
                f"the worker at {address} has whitted {found}, and this is {ours}: they must be the same"
            )


def _named(file: str, blob: Blob) -> tuple[str, Blob]:
    return file, blob


def _textures(job: Job) -> set[Path]:
    """The files of the pigments that are used."""
    pigments = (job.scene.pigments[k] for k in scene_needs(job.scene, job.settings).pigments)
    return {file for pigment in pigments for file in pigment_kind(pigment).files(pigment)}


def _finished(client: Any, futures: list[Any]) -> list[Any]:
    """Those that are finished, one at least.

    Raises:
        ClusterError: the scheduler is gone.

    """
    from distributed import wait
    from distributed.client import FuturesCancelledError

    while True:
        try:
            return list(wait(futures, timeout=1, return_when="FIRST_COMPLETED").done)
        except TimeoutError:
            if client.status != "running":
                raise _gone() from None
        except FuturesCancelledError as error:  # as they are once the connection is lost
            raise _gone() from error


def _gone() -> ClusterError:
    return ClusterError("the scheduler is gone; what is drawn is kept, and the same command goes on from there")


def _results(client: Any, future: Any, count: int) -> list[Drawn | Exception]:
    from distributed import KilledWorker
    from distributed.client import FutureCancelledError

    while True:
        try:
            return future.result(timeout=PATIENCE)  # type: ignore[no-any-return]
        except TimeoutError as error:
            if future.status == "error":  # it is the worker's
                return [error] * count
            if client.status != "running":
                raise _gone() from None
            # What was drawn has died with its worker, and another draws it again.
        except FutureCancelledError as error:
            raise _gone() from error
        except KilledWorker:
            return [ClusterError("workers die of this picture: have they enough memory?")] * count
        except Exception as error:
            return [error] * count


def _whole(tiled: _Tiled) -> Drawn | Exception:
    for tile in tiled.tiles:
        if isinstance(tile, Exception):
            return tile
    if len(tiled.tiles) == 1:
        return tiled.tiles[0]  # type: ignore[no-any-return]
    job = tiled.wanted.job
    rendering = assembled(tiled.tiles, job.settings)
    return Drawn(encoded(rendering, job.ending), dict(rendering.seconds), dict(rendering.statistics))
