"""Images projected through space, and the files of these images."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from converter.errors import ExportError
from converter.images.texture import Texture
from converter.pigments.kind import Box
from converter.scene.model import Texmap
from converter.to_povray.text import number

Floats = NDArray[np.float64]
MARK = b"# Written by whitted convert\n"
"""A comment in the header of every image that is written."""
SKEW = 1e-7
"""How much of a right angle parallel axes of a texture are turned apart, since POV-Ray has to invert them."""


class Image:
    """The image of a texmap, ready to be written.

    Attributes:
        file: name of the image file.
        texels: (height, width, 3), row 0 on top; a single column or row where the pigment uses no other.
        clamped: whether a texel had to be clamped to 0..1.

    """

    def __init__(self, file: str, texture: Texture, pigment: Texmap) -> None:
        texels: Floats = np.asarray(texture.texels, dtype=np.float64)
        column, row = _constant(pigment.p0, texture.width), _constant(pigment.p1, texture.height)
        if column is not None:
            texels = texels[:, column : column + 1]
        if row is not None:
            texels = texels[row : row + 1]
        self.file = file
        self.texels: Floats = np.clip(texels, 0, 1)
        self.clamped = bool((self.texels != texels).any())

    def ppm(self) -> bytes:
        """A binary PPM file, bottom row first: in POV-Ray y goes up, and our rows go down.

        8 bits where they hold every texel, else 16. The header ends with a line feed, but before a raster that begins
        with the byte of a carriage return with one of those: POV-Ray takes the two together for the end of a line.
        """
        height, width, _ = self.texels.shape
        levels = 255 * self.texels
        most, kind = (255, "u1") if np.abs(levels - np.round(levels)).max() < 2**-10 else (65535, ">u2")
        raster = np.round(most * self.texels[::-1]).astype(kind)
        data = raster.tobytes()
        end = b"\r" if data.startswith(b"\r") else b"\n"
        return b"P6\n" + MARK + b"%d %d\n%d" % (width, height, most) + end + data


def image_maps(source: Texmap, transmitted: float, image: Image, boxes: Sequence[Box] | None) -> str:
    """An image map, or a choice of them where s or r have either sign: what is inside a `pigment` block.

    POV-Ray rounds a texel's number down where our format truncates it: below 0 that is one texel less.

    Args:
        source: the pigment.
        transmitted: how much of the light that comes from behind it lets through.
        image: its image.
        boxes: what has this pigment lies in them; None where it has no bounds.

    Raises:
        ExportError: POV-Ray has no numbers for it.

    """
    height, width, _ = image.texels.shape
    axes = [(p, _negative(p, boxes), 1 / texels) for p, texels in ((source.p0, width), (source.p1, height))]

    def choose(k: int, shifts: tuple[float, ...]) -> str:
        if k == len(axes):
            return _image_map(source, transmitted, image.file, shifts)
        p, negative, texel = axes[k]
        below, above = (choose(k + 1, (*shifts, texel * n)) if n in negative else "" for n in (True, False))
        if not (below and above):
            return below or above
        (x, y, z), d = map(number, p[:3]), number(p[3])
        side = f"select(({x})*x + ({y})*y + ({z})*z + ({d}), 0.25, 0.75)"
        return f"function {{ {side} }}\n  pigment_map {{\n  [0.5 {below}]\n  [0.5 {above}] }}"

    return choose(0, ())


def _image_map(source: Texmap, transmitted: float, file: str, shifts: tuple[float, ...]) -> str:
    to_image, offset = _to_image(source)
    if not np.linalg.det(to_image):
        raise ExportError("POV-Ray inverts the axes of a texmap, and has no numbers for the inverse of such short ones")
    to_world = np.linalg.inv(to_image)
    columns = [*to_world.T, -to_world @ (offset + np.array([*shifts, 0]))]
    transmit = f" transmit all {number(transmitted)}" if transmitted else ""
    matrix = ", ".join(number(value) for column in columns for value in column.tolist())
    return f'image_map {{ ppm "{file}" gamma 1.0{transmit} }} matrix <{matrix}>'


def _to_image(source: Texmap) -> tuple[Floats, Floats]:
    """An invertible 3 x 3 matrix and an offset that take a point to s, r and something."""
    s, r = np.array(source.p0[:3]), np.array(source.p1[:3])
    offset = np.array([source.p0[3], source.p1[3], 0])
    if not s.any():  # a single column, whatever s is
        s, offset[0] = _across(r if r.any() else np.array([0.0, 0.0, 1.0])), 0
    if not r.any():
        r, offset[1] = _across(s), 0
    across = np.cross(_unit(s), _unit(r))
    if np.linalg.norm(across) < SKEW:
        r = r + SKEW * np.linalg.norm(r) * _across(s)
        across = np.cross(_unit(s), _across(s))
    return np.stack([s, r, np.linalg.norm(s) * _unit(across)]), offset


def _unit(v: Floats) -> Floats:
    result: Floats = v / np.linalg.norm(v)
    return result


def _across(v: Floats) -> Floats:
    """A unit vector at right angles to `v`."""
    return _unit(np.cross(v, np.eye(3)[np.abs(v).argmin()]))


def _constant(p: Sequence[float], count: int) -> int | None:
    """The texel, of `count`, where s or r is the same everywhere."""
    if any(p[:3]):
        return None
    position = p[3] * count
    return int(math.fmod(math.trunc(position), count)) % count if math.isfinite(position) else 0


def _negative(p: Sequence[float], boxes: Sequence[Box] | None) -> set[bool]:
    """Whether s or r is negative somewhere in these boxes, and whether it is not."""
    if not any(p[:3]):
        return {False}
    if boxes is None:
        return {True, False}
    signs = set()
    for low, high in boxes:
        middle = np.dot(p[:3], np.add(low, high)) / 2 + p[3]
        around = np.dot(np.abs(p[:3]), np.subtract(high, low)) / 2
        signs |= {bool(middle - around < 0), bool(middle + around < 0)}
    return signs
