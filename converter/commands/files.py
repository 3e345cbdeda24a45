"""Files that appear as a whole or not at all."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def check_target(path: Path) -> None:
    """See that a file can be written there, so that no one waits for a result that cannot be saved.

    Raises:
        OSError: its folder is missing or not writable, or it is a folder itself.

    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not path.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, f"there is no folder {str(path.parent)!r}", str(path))
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A new file to write into, which takes the place of `path` when the block ends well, and goes when not.

    A link stays, and what it points to is replaced. What is no file, such as a pipe or /dev/null, is written as it is.
    """
    target = path.resolve()
    if target.exists() and not target.is_file():
        yield target
        return
    temporary = target.with_name(f".whitted-{os.getpid()}-{os.urandom(4).hex()}{path.suffix}")
    try:
        yield temporary
        temporary.replace(target)
    finally:
        with suppress(OSError):  # it was never made, or is in its place
            temporary.unlink()
