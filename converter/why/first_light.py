"""The file's first light, of which the format keeps only the colour: some programs let it shine."""

from pathlib import Path

from converter.scene.model import Vector

_BEFORE = 11
"""Numbers before it: eye, look-at, up, fovy, and the count of lights."""


def first_light(file: Path) -> tuple[Vector, Vector] | None:
    """Position and attenuation of the first light in a scene file; None where it cannot be read a second time."""
    try:
        if not file.is_file():  # what came through a pipe is gone
            return None
        text = file.read_text(encoding="utf-8-sig", errors="replace")
        words = " ".join(line.partition("#")[0] for line in text.splitlines()).split()
        x, y, z, _, _, _, a, b, c = map(float, words[_BEFORE : _BEFORE + 9])
    except (OSError, ValueError):
        return None
    return (x, y, z), (a, b, c)
