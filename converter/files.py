"""Files that appear as a whole or not at all, and their names."""

import errno
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def check_apart(target: Path, sources: Iterable[Path]) -> None:
    """See that a result takes the place of nothing that it is made from.

    Raises:
        OSError: it would.

    """
    for source in sources:
        if target.exists() and source.exists() and target.samefile(source):
            raise FileExistsError(errno.EEXIST, "this is read, and the result would replace it", str(target))


def check_target(path: Path, sources: Iterable[Path] = ()) -> None:
    """See that a file can be written there, so that no one waits for a result that cannot be saved.

    Raises:
        OSError: its folder is missing or not writable, it is a folder itself, or one of the `sources`.

    """
    check_apart(path, sources)
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder {str(path.parent)!r}", str(path))
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))


def shown_name(name: str | Path) -> str:
    """A file's name as text that can be drawn and stored: of bytes that are no UTF-8, each is a replacement mark."""
    return os.fsencode(name).decode(errors="replace")


def is_special(path: Path) -> bool:
    """Whether there is something that is no file, such as a pipe or /dev/null, and must not be replaced by one."""
    return path.exists() and not path.is_file()


def temporary_name(target: Path, ending: str) -> Path:
    """A new name beside `target`, so on the same file system, with the ending that tells the format."""
    return target.with_name(f".whitted-{os.getpid()}-{os.urandom(4).hex()}{ending}")


@contextmanager
def replacing(path: Path, ending: str | None = None) -> Iterator[Path]:
    """A new file to write into, which takes the place of `path` when the block ends well, and goes when not.

    Its ending is the given one, or that of `path`. A link stays, and what it points to is replaced. Into what is no
    file the new one is copied.
    """
    target = path.resolve()
    ending = path.suffix if ending is None else ending
    if is_special(target):
        from tempfile import TemporaryDirectory

        with TemporaryDirectory() as folder:
            temporary = Path(folder) / f"file{ending}"
            yield temporary
            try:
                target.write_bytes(temporary.read_bytes())
            except OSError as error:  # writing, unlike opening, does not say what
                raise OSError(error.errno, error.strerror, str(path)) from error
        return
    temporary = temporary_name(target, ending)
    try:
        yield temporary
        temporary.replace(target)
    finally:
        with suppress(OSError):  # it was never made, or is in its place
            temporary.unlink()
