"""What is wrong with a file of keyframes."""

from pathlib import Path


class FilmError(Exception):
    """A film cannot be made; the message begins with the file and, where it is known, the line."""


def film_error(file: Path, line: int, message: str) -> FilmError:
    """The error; 0 is no line."""
    place = f"{file}:{line}" if line else str(file)
    return FilmError(f"{place}: {message}")
