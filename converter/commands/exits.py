"""How a program ends: its exit statuses, and errors told in a line instead of a traceback."""

import os
import signal
import sys
from collections.abc import Callable

from converter.commands.interrupts import InterruptWatch, Terminated, status_of

OK = 0
DISAGREE = 1
"""`compare` found more disagreeing pixels than allowed."""
USAGE = 2
"""Wrong arguments, a scene or file that cannot be used: whatever the user can mend."""
UNAVAILABLE = 3
"""A renderer does not run on this machine."""
BROKEN_PIPE = 141
"""The reader of the output went away, as shells count it: 128 + SIGPIPE."""


_UNUSABLE = (
    ("converter.images.texture", "TextureError"),
    ("converter.compare.metrics", "SizeMismatch"),
    ("converter.why.student", "UnknownToStudent"),
    ("converter.errors", "ExportError"),
    ("converter.to_mitsuba.meshes", "MeshError"),
    ("converter.renderers.povray", "PovrayError"),
    ("converter.renderers.base", "EffectUnavailable"),
    ("converter.renderers.base", "ResumeError"),
    ("converter.films.errors", "FilmError"),
    ("converter.batch.cluster", "ClusterError"),
)
_UNAVAILABLE = (("converter.renderers.base", "RendererUnavailable"), ("mitsuba_plugins.backend", "BackendError"))
"""Modules and the errors in them that a user can mend; by name, so that telling one loads nothing."""


_NO_ROOM = "failed to map segment"
"""What the loader says of a library that does not fit into memory."""


class UsageError(Exception):
    """The arguments make no sense; the message says which and why."""


def run(program: str, command: Callable[[], int]) -> int:
    """Run `command`, and return the exit status. Errors that a user can cause are told; bugs keep their traceback."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):  # file names need not be UTF-8, nor the terminal
            stream.reconfigure(errors="backslashreplace")
    interrupted = f"{program}: interrupted"
    watch = InterruptWatch(f"{interrupted}\n")
    try:
        with watch:
            status = command()
            if sys.stdout is not None:
                sys.stdout.flush()  # here, where a full disk or a closed pipe can still be told
        return status
    except SystemExit as ended:  # argparse, after --help or --version
        return ended.code if isinstance(ended.code, int) else OK
    except KeyboardInterrupt:
        tell(interrupted)
        return status_of(signal.SIGINT)
    except Terminated:
        tell(interrupted)
        return status_of(signal.SIGTERM)
    except BrokenPipeError:
        _discard_output()
        return BROKEN_PIPE
    except Exception as error:
        found = (interrupted, status_of(watch.seen)) if watch.seen else told(program, error)
        if found is None:
            raise
        message, status = found
        tell(message)
        return status


def tell(message: str) -> None:
    """A message on stderr, if it is open: `print` to None would go to stdout.

    What a terminal would take for an order, in the name of a file, is shown as a question mark.
    """
    if sys.stderr is not None:
        print("".join(c if c.isprintable() or c in "\n\t" else "?" for c in message), file=sys.stderr)


def told(program: str, error: BaseException) -> tuple[str, int] | None:
    """The message and the exit status for an error that a user can do something about."""
    if isinstance(error, UsageError):
        return f"{program}: {error}\nTry '{program} --help'.", USAGE
    if isinstance(error, OSError):
        reason = error.strerror.lower() if error.strerror else str(error)
        return f"{program}: {error.filename}: {reason}" if error.filename else f"{program}: {reason}", USAGE
    if isinstance(error, MemoryError) or (isinstance(error, ImportError) and _NO_ROOM in str(error)):
        detail = f": {error}" if isinstance(error, MemoryError) and str(error) not in ("", "std::bad_alloc") else ""
        return f"{program}: not enough memory{detail}", USAGE
    if _is_any(error, (("converter.scene.errors", "SceneError"),)):
        return str(error), USAGE  # it begins with file, line and column, as compilers have it
    if _is_any(error, _UNUSABLE):
        return f"{program}: {error}", USAGE
    if _is_any(error, _UNAVAILABLE):
        return f"{program}: {error}", UNAVAILABLE
    return None


def _is_any(error: BaseException, kinds: tuple[tuple[str, str], ...]) -> bool:
    """Whether an error is of one of these classes. A module that is not loaded has raised nothing."""
    return any(isinstance(error, getattr(sys.modules[module], name)) for module, name in kinds if module in sys.modules)


def _discard_output() -> None:
    """Send what is left in the buffer nowhere, so that the interpreter does not fail on it once more at its end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, sys.stdout.fileno())
    except (OSError, ValueError, AttributeError):  # no such file behind it
        pass
    finally:
        os.close(nowhere)
