"""What the pictures in a folder are pictures of, so that none is drawn twice.

A file beside them has a line of JSON for each: its name, a digest of what it is drawn from, and one of its bytes. The
line comes before the picture: one without the other is no picture that is there.
"""

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

from converter.files import make_folder, replacing

MANIFEST = ".whitted-pictures"


def digest_of(*parts: Any) -> str:
    """A digest of values that `repr` tells apart."""
    return sha256("\n".join(map(repr, parts)).encode(errors="surrogateescape")).hexdigest()


class Manifest:
    """The pictures of a folder, which is made where it is missing."""

    def __init__(self, folder: Path) -> None:
        make_folder(folder)
        self._file = folder / MANIFEST
        self._known = dict(_read(self._file))

    def has(self, picture: Path, source: str) -> bool:
        """Whether a picture is there, whole, and drawn from what has that digest."""
        known = self._known.get(picture.name)
        if known is None or known[0] != source:
            return False
        try:
            return sha256(picture.read_bytes()).hexdigest() == known[1]
        except OSError:
            return False

    def write(self, picture: Path, source: str, data: bytes) -> None:
        """Write a picture, which appears as a whole.

        Raises:
            OSError: it cannot be written.

        """
        self.note(picture, source, data)
        with replacing(picture) as temporary:
            temporary.write_bytes(data)

    def note(self, picture: Path, source: str, data: bytes) -> None:
        """Remember what a picture of these bytes is drawn from."""
        found = (source, sha256(data).hexdigest())
        if self._known.get(picture.name) == found:
            return
        self._known[picture.name] = found
        with self._file.open("a", encoding="ascii") as out:
            out.write(json.dumps([picture.name, *found]) + "\n")

    def remove(self) -> None:
        """Forget all, and the file."""
        self._file.unlink(missing_ok=True)


def _read(file: Path) -> list[tuple[str, tuple[str, str]]]:
    """The lines that are whole: the last may be cut short where a process was killed."""
    result = []
    try:
        lines = file.read_bytes().splitlines()
    except OSError:
        return []
    for line in lines:
        try:
            name, source, data = json.loads(line)
        except (ValueError, TypeError):
            continue
        result.append((name, (source, data)))
    return result
