"""Files that keep the passes of a picture that was stopped, beside it, until it is whole.

A line that says what the file is; a line of JSON with what the picture is a picture of, and its passes; then the sums
of the samples' colours (float64, row by row, in the machine's byte order), a byte a pixel for the depth limit, and a
checksum (CRC-32, hexadecimal) of all but the first line.
"""

import json
import sys
import zlib
from dataclasses import fields
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from converter.files import replacing
from converter.pigments.table import pigment_kind
from converter.renderers.base import Passes, ResumeError
from converter.scene.model import Scene
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.scene.writer import write_scene

_MAGIC = f"whitted partial picture 1 {sys.byteorder}\n".encode()
_BYTES_A_PIXEL = 3 * 8 + 1
_MOST_HEADER = 1 << 16


def partial_file(picture: Path) -> Path:
    """The file that keeps the passes of a picture."""
    return picture.with_name(f"{picture.name}.partial")


def write_partial(file: Path, passes: Passes, scene: Scene, settings: Settings, method: str) -> None:
    """Keep passes of `scene`, drawn with these settings by the method of that name. The file appears as a whole.

    Raises:
        OSError: it cannot be written.

    """
    parts = [memoryview(part).cast("B") for part in (passes.colors, passes.too_deep)]
    header = {
        "of": identity(scene, settings, method),
        "done": passes.done,
        "total": passes.total,
        "notes": dict(passes.notes),
    }
    text = json.dumps(header).encode() + b"\n"
    with replacing(file) as temporary, temporary.open("xb") as out:
        out.write(_MAGIC + text)
        for part in parts:
            out.write(part)
        out.write(_sum([text, *parts]))


def read_partial(file: Path, scene: Scene, settings: Settings, method: str) -> Passes:
    """The passes that are kept in a file.

    Raises:
        OSError: there is no such file, or it cannot be read.
        ResumeError: it holds none, or those of another picture; the message says what is different.

    """
    columns, rows = settings.drawn_size
    pixels = columns * rows
    with file.open("rb") as opened:
        if opened.read(len(_MAGIC)) != _MAGIC:
            raise ResumeError(f"{file}: this is no partial picture of this program and machine")
        try:
            text = opened.readline(_MOST_HEADER)
            header = json.loads(text)
            then, done, total, notes = header["of"], header["done"], header["total"], header["notes"]
        except (ValueError, KeyError, TypeError):
            raise ResumeError(f"{file}: its header is damaged") from None
        _check_same(file, then, identity(scene, settings, method))
        body = memoryview(opened.read(pixels * _BYTES_A_PIXEL))
        kept = opened.read()
    if len(body) != pixels * _BYTES_A_PIXEL or _sum([text, body]) != kept:
        raise ResumeError(f"{file}: it is damaged, or was cut short")
    return Passes(done, total, body[: 24 * pixels], body[24 * pixels :], notes)


def _sum(parts: "list[bytes | memoryview]") -> bytes:
    result = 0
    for part in parts:
        result = zlib.crc32(part, result)
    return b"%08x\n" % result


def identity(scene: Scene, settings: Settings, method: str) -> dict[str, Any]:
    """What decides a picture's bytes, by the names that users know."""
    from converter.commands.version import version

    digest = sha256(write_scene(scene).encode(errors="surrogateescape"))
    needs = scene_needs(scene, settings)
    for i in needs.pigments:
        for texture in pigment_kind(scene.pigments[i]).files(scene.pigments[i]):
            about = texture.stat()
            digest.update(_texture_digest(texture, about.st_mtime_ns, about.st_size))
    result = {"version": version(), "scene": digest.hexdigest(), "method": method}
    values = {f.name: getattr(settings, f.name) for f in fields(settings) if f.name != "threads"}
    values |= {"samples": needs.samples, "background": needs.background, "max_depth": needs.max_depth}
    result |= {f"--{name.replace('_', '-')}": value for name, value in values.items()}
    result["size"] = f"{result.pop('--width')} x {result.pop('--height')}"
    return json.loads(json.dumps(result))  # type: ignore[no-any-return]


@lru_cache(maxsize=64)
def _texture_digest(texture: Path, modified: int, size: int) -> bytes:
    """A file's digest, taken once for the many pictures of a film."""
    return sha256(texture.read_bytes()).digest()


def _check_same(file: Path, then: Any, now: dict[str, Any]) -> None:
    if not isinstance(then, dict) or then.keys() != now.keys():
        raise ResumeError(f"{file}: its header is damaged")
    for name, value in now.items():
        if then[name] != value:
            what = "the scene or a texture of it has changed since"
            if name != "scene":
                what = f"it was drawn with {name} {then[name]}, and not {value}"
            raise ResumeError(f"{file}: {what}; without --resume the picture is drawn anew")
