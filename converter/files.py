"""Files that appear as a whole or not at all, and their names."""

import errno
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from converter.descriptors import check_descriptor, named_descriptor


def check_apart(target: Path, sources: Iterable[Path]) -> None:
    """See that a result takes the place of nothing that it is made from.

    Raises:
        OSError: it would.

    """
    for source in sources:
        if target.exists() and source.exists() and target.samefile(source):
            raise FileExistsError(errno.EEXIST, "this is read, and the result would replace it", str(target))


@contextmanager
def only_one(folder: Path) -> Iterator[bool]:
    """Whether no other process is within such a block for this folder, which is there; other machines may be.

    True where the folder's file system knows no locks.
    """
    import fcntl

    opened = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # Another may have removed it meanwhile.
            alone = folder.exists() and os.path.samestat(os.fstat(opened), folder.stat())
        except BlockingIOError:
            alone = False
        except OSError:
            alone = True
        yield alone
    finally:
        os.close(opened)


def make_folder(folder: Path) -> None:
    """Make a folder with those that it is in, where they are missing.

    Raises:
        OSError: it cannot be made.

    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, "this is a file, and a folder is needed", str(folder)) from None


def check_target(path: Path, sources: Iterable[Path] = ()) -> None:
    """See that a file can be written there, so that no one waits for a result that cannot be saved.

    Raises:
        OSError: its folder is missing or not writable, it is a folder itself, or one of the `sources`.

    """
    check_apart(path, sources)
    if is_special(path):
        check_special(path)
        return
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
    """Whether results are copied into what is there, for it is no file that may be replaced.

    Such are a pipe, /dev/null, and whatever a descriptor has open, be it a file.
    """
    if named_descriptor(path) is not None:
        return True
    return path.exists() and not path.is_file() and not path.is_dir()


def check_special(path: Path) -> None:
    """See that something special can be written into, without opening it: a pipe's end would wait for the other.

    Raises:
        OSError: it is a descriptor that is not open, or open for reading only, or is write-protected.

    """
    descriptor = named_descriptor(path)
    if descriptor is not None:
        check_descriptor(descriptor, path)
    elif not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))


def temporary_name(target: Path, ending: str) -> Path:
    """A new name beside `target`, so on the same file system, with the ending that tells the format."""
    return target.with_name(f".whitted-{os.getpid()}-{os.urandom(4).hex()}{ending}")


@contextmanager
def replacing(path: Path, ending: str | None = None) -> Iterator[Path]:
    """A new file to write into, which takes the place of `path` when the block ends well, and goes when not.

    Its ending is the given one, or that of `path`. A link stays, and what it points to is replaced. Into what is
    special the new one is copied. An OSError of the block that tells no file, or this one, tells `path`.
    """
    ending = path.suffix if ending is None else ending
    if is_special(path):
        from tempfile import TemporaryDirectory

        with TemporaryDirectory() as folder:
            temporary = Path(folder) / f"file{ending}"
            yield temporary
            _copy(temporary, path)
        return
    target = path.resolve()
    temporary = temporary_name(target, ending)
    try:
        yield temporary
        temporary.replace(target)
    except OSError as error:
        # Writing, unlike opening, does not say what; and of the other name nobody knows.
        if error.errno is None or error.filename not in (None, str(temporary)):
            raise
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with suppress(OSError):  # it was never made, or is in its place
            temporary.unlink()


def _copy(file: Path, special: Path) -> None:
    """Write what is in a file into something special, a descriptor from where it stands."""
    descriptor = named_descriptor(special)
    try:
        with special.open("wb") if descriptor is None else os.fdopen(os.dup(descriptor), "wb") as opened:
            opened.write(file.read_bytes())
    except OSError as error:  # writing, unlike opening, does not say what
        raise OSError(error.errno, error.strerror, str(special)) from error
