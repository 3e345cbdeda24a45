"""What the shell has opened for a program: descriptors, which paths such as /dev/stdout and /dev/fd/3 name."""

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path

STANDARD_OUTPUT = Path("/dev/stdout")
_FOLDERS = ("/dev/fd", "/proc/self/fd")
_MOST_LINKS = 40  # as many as Linux follows
_places = {1: 1}  # where the standard output has its place


def named_descriptor(path: Path) -> int | None:
    """The descriptor that a path names, such as /dev/stdout, /dev/fd/3, and what a shell has for >(command).

    Opening such a name again would empty the file behind it, and cannot be done where that is a socket.
    """
    folders = {os.path.realpath(folder) for folder in _FOLDERS}
    for _ in range(_MOST_LINKS):
        if path.name.isdecimal() and os.path.realpath(path.parent) in folders:
            descriptor = int(path.name)
            return _places.get(descriptor, descriptor)
        try:
            path = path.parent / path.readlink()
        except OSError:  # it is no link
            return None
    return None


def check_descriptor(descriptor: int, path: Path) -> None:
    """See that the descriptor that `path` names can be written into.

    Raises:
        OSError: it is not open, or for reading only.

    """
    import fcntl

    try:
        mode = fcntl.fcntl(descriptor, fcntl.F_GETFL)
    except (OSError, OverflowError):
        raise OSError(errno.EBADF, "nothing is open there", str(path)) from None
    if not mode & (os.O_WRONLY | os.O_RDWR):
        raise OSError(errno.EBADF, "this is open for reading only", str(path))


def is_standard_output(path: Path) -> bool:
    """Whether a path names the standard output, or a descriptor of the same open file."""
    descriptor = named_descriptor(path)
    try:
        return descriptor is not None and os.path.sameopenfile(descriptor, _places[1])
    except (OSError, OverflowError):  # one of them is not open
        return descriptor == _places[1]


@contextmanager
def standard_output_for_a_result() -> Iterator[None]:
    """Within it the standard output takes nothing but what is written into `STANDARD_OUTPUT`.

    What is printed goes to stderr, also by libraries that do not know of Python's streams: Mitsuba's log is one.
    """
    try:
        place = os.dup(1)
    except OSError:  # it is closed, which `check_descriptor` tells
        yield
        return
    try:
        os.dup2(2, 1)
    except OSError:  # stderr is closed
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.close(nowhere)
    _places[1] = place
    try:
        with redirect_stdout(sys.stderr):
            yield
    finally:
        _flush_libraries()
        _places[1] = 1
        os.dup2(place, 1)
        os.close(place)


def _flush_libraries() -> None:
    """Write what C and C++ libraries have printed and still hold."""
    import ctypes

    ctypes.CDLL(None).fflush(None)
