"""What a worker of Dask does. It draws one picture at a time, and keeps the last job with its textures."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any, TypeVar

from converter.batch.pictures import Drawn, Job, Picture, draw_picture
from converter.scene.model import Texmap

T = TypeVar("T")

_lock = Lock()
_last: tuple[str, Job] | None = None


@dataclass(frozen=True, slots=True)
class Blob:
    """A file's bytes, under a name that tells them from all others."""

    name: str
    data: bytes


def same(value: T) -> T:
    """What it is given: a task that Dask keeps the result of."""
    return value


def draw_at_worker(
    named_job: tuple[str, Job], textures: Sequence[tuple[str, Blob]], pictures: Sequence[Picture]
) -> list[Drawn | Exception]:
    """Draw pictures of a job, whose texture files, by their names elsewhere, have these bytes. An error is a result."""
    global _last
    name, job = named_job
    with _lock:
        if _last is None or _last[0] != name:
            _last = (name, _with_textures(job, {file: _file(blob) for file, blob in textures}))
        return [_drawn(_last[1], picture) for picture in pictures]


def _drawn(job: Job, picture: Picture) -> Drawn | Exception:
    try:
        return draw_picture(job, picture)
    except Exception as error:
        return error


def _with_textures(job: Job, files: dict[str, Path]) -> Job:
    pigments = tuple(
        replace(pigment, file=files.get(str(pigment.file), pigment.file)) if isinstance(pigment, Texmap) else pigment
        for pigment in job.scene.pigments
    )
    return replace(job, scene=replace(job.scene, pigments=pigments))


def _file(blob: Blob) -> Path:
    file = Path(_folder().name, blob.name)
    if not file.exists():
        file.write_bytes(blob.data)
    return file


@cache
def _folder() -> Any:
    return TemporaryDirectory(prefix="whitted-textures-")
