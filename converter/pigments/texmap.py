"""An image projected through space."""

import math
import os
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.frozen import replace
from converter.pigments.kind import Box
from converter.scene.errors import place, shown
from converter.scene.fields import Lost, Numbers
from converter.scene.model import Color, Texmap
from converter.scene.numerals import numerals

if TYPE_CHECKING:
    from converter.images.texture import Texture
    from converter.pigments.kind import Floats
    from converter.scene.reader import Reader
    from converter.to_povray.image_maps import Image

SPELLINGS = ("texmap", "textmap")  # the second is found in real files
WORDS = 2
NUMBERS = Numbers("texmap", "P0 and P1", tuple(f"{p}[{i}]" for p in ("P0", "P1") for i in range(4)))
TEXTURE = "projected_bitmap"
REPEATS = "copies of its image"


# ---- Scene files -----------------------------------------------------------------------------------------------------


def read(reader: "Reader", at: int, k: int) -> tuple[Texmap, int]:
    """A file's name, one word, and two rows of four numbers."""
    name = reader.word(at + 1, "a texture file")
    following = reader.word(at + 2, "P0 and P1")
    if reader.is_stray_name(following):
        raise Lost(at + 2, f"a texture's name is one word: unexpected {shown(following)} after {shown(name)}")
    reader.textures[k] = at + 1
    a, b, c, d, e, f, g, h = reader.numbers(at + 2, NUMBERS, at + 1)
    where = place(reader.text.file, reader.text.line(at + 1))
    return Texmap(_file_beside(reader.folder, name), (a, b, c, d), (e, f, g, h), where), at + 10


@lru_cache(maxsize=1024)  # a texture may have many pigments, which share its name then
def _file_beside(folder: Path, name: str) -> Path:
    return folder / name


def write(pigment: Texmap, folder: Path | None) -> list[str]:
    """`texmap FILE`, and a line for each row; the file relative to the folder."""
    return [f"texmap {_name(pigment.file, folder)}", numerals(*pigment.p0), numerals(*pigment.p1)]


def _name(file: Path, folder: Path | None) -> str:
    """A texture's name in a scene file in `folder`."""
    if folder is not None:
        if file.is_relative_to(folder):  # by its text: no link is followed, and `..` stays
            file = file.relative_to(folder)
        elif not file.is_absolute():
            file = Path(os.path.relpath(file, folder))
    name = file.as_posix()
    if not name or "#" in name or name.split() != [name]:
        raise ValueError(f"a scene file cannot name the texture {name!r}: white space and # end a name")
    return name


def files(pigment: Texmap) -> tuple[Path, ...]:
    """The image."""
    return (pigment.file,)


# ---- What it looks like ----------------------------------------------------------------------------------------------


def colors(pigment: Texmap) -> tuple[Color, ...]:
    """None: they are the image's."""
    return ()


def largest(pigment: Texmap) -> Color:
    """Of all texels."""
    import numpy as np

    texels = np.asarray(_texture(pigment).texels)
    extremes = np.array([texels.min(axis=(0, 1)), texels.max(axis=(0, 1))], dtype=np.float64)
    red, green, blue = np.abs(extremes).max(axis=0).tolist()
    return red, green, blue


def period(pigment: Texmap, far: "Floats") -> float:
    """A copy of the image, where there are most of them on the way there."""
    point = [*far, 1.0]
    images = max(sum(abs(a) * x for a, x in zip(row, point, strict=True)) for row in (pigment.p0, pigment.p1))
    return float(1 / images) if images > 0 else math.inf


def edge_margin(pigment: Texmap, p: "Floats") -> float:
    """To the nearest side of a texel."""
    image = _texture(pigment)
    result = math.inf
    for row, count in ((pigment.p0, image.width), (pigment.p1, image.height)):
        gradient = math.hypot(*row[:3]) * count
        if gradient > 0:
            position = (float(p.dot(row[:3])) + row[3]) * count
            result = min(result, abs(position - round(position)) / gradient)
    return result


def facts(pigment: Texmap) -> dict[str, Any]:
    """Its file, the image's size, and the rows."""
    from converter.images.texture import probe_texture

    # A scene may have one that is missing, if no object uses it.
    width, height = probe_texture(pigment.file) if pigment.file.exists() else (None, None)
    return {"file": str(pigment.file), "width": width, "height": height, "p0": pigment.p0, "p1": pigment.p1}


def summary(facts: dict[str, Any]) -> str:
    """E.g. `wood.ppm, 64 x 64, P0 1 0 0 0, P1 0 1 0 0`."""
    size = f"{facts['width']} x {facts['height']}" if facts["width"] else "missing"
    p0, p1 = (" ".join(f"{value:g}" for value in facts[name]) for name in ("p0", "p1"))
    return f"{facts['file']}, {size}, P0 {p0}, P1 {p1}"


def scaled(pigment: Texmap, factor: float) -> Texmap:
    """Rows for longer coordinates."""
    (a, b, c, d), (e, f, g, h) = pigment.p0, pigment.p1
    return replace(pigment, p0=(a / factor, b / factor, c / factor, d), p1=(e / factor, f / factor, g / factor, h))


# ---- Renderers -------------------------------------------------------------------------------------------------------


def _texture(pigment: Texmap) -> "Texture":
    from converter.images.texture import read_texture  # late: the image library takes a while to import

    return read_texture(pigment.file, pigment.place)


def add_to(native: Any, pigment: Texmap) -> int:
    """A texmap."""
    image = _texture(pigment)
    return int(native.add_texmap(image.width, image.height, image.texels, pigment.p0, pigment.p1))


def texture(pigment: Texmap) -> dict[str, Any]:
    """A `projected_bitmap` texture, whose `data` is a `Texture` of ours."""
    to_s, to_r = (" ".join(map(repr, row)) for row in (pigment.p0, pigment.p1))
    return {"type": TEXTURE, "data": _texture(pigment), "to_s": to_s, "to_r": to_r}


def povray_image(pigment: Texmap, name: str) -> "Image | None":
    """The texels."""
    from converter.to_povray.image_maps import Image

    return Image(f"{name}.ppm", _texture(pigment), pigment)


def povray(pigment: Texmap, transmitted: float, image: "Image | None", boxes: Sequence[Box] | None) -> str:
    """An `image_map`, or several."""
    from converter.to_povray.image_maps import image_maps

    assert image is not None
    return image_maps(pigment, transmitted, image, boxes)
