"""Reads textures: PPM files with a small reader of our own (`ppm` says why), all others through OpenImageIO."""

import os
import stat
from itertools import islice
from pathlib import Path
from typing import IO, Any

from converter.frozen import dataclass
from converter.images import ppm

MOST_SAMPLES_A_BYTE, MOST_A_BYTE_OF_LARGE = 10_000, 256
"""What compression makes of a blank page, and, above `LARGE` samples, what it makes of pictures: an image that claims
more for its bytes is broken or hostile, and room is not made for it."""
LARGE = 1 << 26


@dataclass(frozen=True, slots=True, eq=False)
class Texture:
    """An image to be looked up texel by texel.

    Attributes:
        width, height: size in texels, both at least 1.
        texels: (height, width, 3) float32 buffer, C-contiguous and read-only, RGB as the file has it (integers scaled
            to 0..1, no gamma undone), row 0 on top; `numpy.asarray` makes it an array.
    """

    width: int
    height: int
    texels: "memoryview[float]"


class TextureError(ValueError):
    """A texture cannot be used; the message names the file and says why."""


def read_texture(path: str | Path, place: str = "") -> Texture:
    """The image in the file `path`; an alpha channel is dropped, grey made RGB.

    Args:
        path: the file.
        place: where it is named, for messages: `scene.in:8`.

    Raises:
        TextureError: the file is missing, no image, broken, or larger than memory.
    """
    told = f"{place}: texture {path}" if place else str(path)
    try:
        file, start, size = _open(Path(path))
    except TextureError as error:
        raise TextureError(f"{place}: texture {error}" if place else str(error)) from error
    with file:
        try:
            if not ppm.is_ppm(start):
                return _read_other(str(path), size)
            header = ppm.read_header(start, size)
            texels = ppm.read_samples(file, header)
            return _texture(header.width, header.height, texels)
        except ValueError as error:
            raise TextureError(f"{told}: {error}") from error
        except MemoryError as error:
            raise TextureError(f"{told}: it does not fit into memory") from error


def probe_texture(path: str | Path, hint: bool = True) -> tuple[int, int]:
    """Width and height of the image in the file `path`, from its header alone.

    Args:
        path: the file.
        hint: look for a file with a similar name where it is missing, which takes its time in large folders.

    Raises:
        TextureError: the file is missing or no image.
    """
    file, start, size = _open(Path(path), hint)
    with file:
        try:
            if ppm.is_ppm(start):
                header = ppm.read_header(start, size)
                return header.width, header.height
            image = _open_other(str(path), size)
        except ValueError as error:
            raise TextureError(f"{path}: {error}") from error
        spec = image.spec()
        image.close()
        return spec.width, spec.height


def _open(path: Path, hint: bool = True) -> tuple[IO[bytes], bytes, int]:
    """The open file, its first bytes, and its length."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):  # opening a pipe might wait for ever
            raise ValueError("not a file")
        file = path.open("rb")
        try:
            return file, file.read(ppm.HEADER_BYTES), os.fstat(file.fileno()).st_size
        except BaseException:
            file.close()
            raise
    except FileNotFoundError as error:
        raise TextureError(f"{path}: no such file{_similar(path) if hint else ''}") from error
    except (OSError, ValueError) as error:
        reason = error.strerror.lower() if isinstance(error, OSError) and error.strerror else str(error)
        raise TextureError(f"{path}: {reason}") from error


def _similar(path: Path) -> str:
    """A hint at a file with a name much like it: scenes come from systems that take RAINBOW.PPM for rainbow.ppm."""
    from converter.scene.errors import did_you_mean

    try:
        names = [entry.name for entry in islice(path.parent.iterdir(), 1000)]
    except OSError:
        return ""
    # Endings make any two names of textures alike: what stands before them has to be alike as well.
    stems = tuple(Path(name).stem for name in names)
    alike = tuple(name for name, stem in zip(names, stems, strict=True) if did_you_mean(path.stem, (stem,)))
    return did_you_mean(path.name, alike)


def _texture(width: int, height: int, texels: "memoryview[float]") -> Texture:
    shaped = texels.cast("B").cast("f", (height, width, 3))  # a view's shape changes only by way of bytes
    return Texture(width, height, shaped.toreadonly())


def _open_other(path: str, size: int) -> Any:
    """OpenImageIO's input for a file that is no PPM.

    Raises:
        ValueError: it is no image, or one that cannot be meant.
    """
    import OpenImageIO as oiio  # noqa: N813 - its own documentation's name

    if os.fsencode(path).decode(errors="ignore") != path:
        raise ValueError("its name or its folder's is not UTF-8, which only a PPM file's may be")
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)  # colours as they are, not multiplied by the alpha that is dropped
    hints.attribute("pnm:pfmflip", 1)  # bottom row first, as PFM files have it
    image = oiio.ImageInput.open(path, hints)
    if image is None:
        complaint = oiio.geterror()
        known = "could not find a format reader" not in complaint
        raise ValueError(f"no image that can be read{f' ({_first_line(complaint)})' if known else ''}")
    spec = image.spec()
    samples = spec.width * spec.height * max(3, spec.nchannels)
    if samples > min(MOST_SAMPLES_A_BYTE * size, max(LARGE, MOST_A_BYTE_OF_LARGE * size)):
        image.close()
        raise ValueError(f"it claims {spec.width} x {spec.height} pixels in {size} bytes")
    if spec.depth > 1 or spec.deep:
        image.close()
        raise ValueError("a volume or deep image, not a picture")
    return image


def _read_other(path: str, size: int) -> Texture:
    import numpy as np
    import OpenImageIO as oiio  # noqa: N813

    image = _open_other(path, size)
    spec = image.spec()
    pixels = image.read_image(oiio.FLOAT)
    complaint = image.geterror()
    image.close()
    if pixels is None or complaint:
        raise ValueError(f"it is broken ({_first_line(complaint)})")
    names = list(spec.channelnames)
    if {"R", "G", "B"} <= set(names):
        channels = [names.index(name) for name in "RGB"]
    else:
        channels = [0, 1, 2] if spec.nchannels >= 3 else [0, 0, 0]  # grey, with alpha perhaps
    texels = np.ascontiguousarray(pixels.reshape(spec.height, spec.width, -1)[:, :, channels], dtype=np.float32)
    return _texture(spec.width, spec.height, memoryview(texels.data))


def _first_line(complaint: str) -> str:
    return complaint.strip().partition("\n")[0] or "no reason given"
