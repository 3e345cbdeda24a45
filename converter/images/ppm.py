"""Reads PPM files, P3 and P6, with the standard library alone.

The course's textures are PPM files, and `raytrace` is to draw a small scene in 0.15 s as a whole process: importing
OpenImageIO takes 0.06 s of that, and its arrays import NumPy, 0.13 s.

Errors are `ValueError`s that do not name the file.
"""

import sys
from array import array
from struct import pack
from typing import IO, NamedTuple

HEADER_BYTES = 1 << 16
"""A header, comments and all, ends within these first bytes."""
LARGE = 1 << 20
"""Samples of 16 bits from which on NumPy takes less time than it takes to import."""
_BLOCK = 1 << 20  # bytes of plain text that are cut into words at once
_SPACE = b" \t\n\r\v\f"


class Header(NamedTuple):
    """What a PPM file says of itself: `plain` is P3, and the raster begins at the byte `offset`."""

    plain: bool
    width: int
    height: int
    maxval: int
    offset: int

    @property
    def samples(self) -> int:
        """Numbers in the raster."""
        return 3 * self.width * self.height


def is_ppm(start: bytes) -> bool:
    """Whether a file that begins like this is a PPM file."""
    return start[:2] in (b"P3", b"P6") and (start[2:3] in (*_bytes(_SPACE), b"#"))


def read_header(start: bytes, size: int) -> Header:
    """The header at the `start` of a PPM file of `size` bytes; the raster it announces fits into these.

    Raises:
        ValueError: it is no such header.
    """
    at = 2
    numbers = []
    for name in ("width", "height", "maxval"):
        at = _skip_space(start, at)
        end = at
        while start[end : end + 1].isdigit():
            end += 1
        if not 0 < end - at < 10:
            found = start[at : end or at + 1][:20] or start[at : at + 1]
            raise ValueError(f"its header has no proper {name}, found {found.decode('latin-1')!r}")
        numbers.append(int(start[at:end]))
        at = end
    width, height, maxval = numbers
    if width == 0 or height == 0:
        raise ValueError(f"it is empty: {width} x {height} pixels")
    if not 0 < maxval < 65536:
        raise ValueError(f"its largest value must lie between 1 and 65535, found {maxval}")
    # One character of white space ends the header; a comment before it is part of that.
    if start[at : at + 1] == b"#":
        at = _skip_comment(start, at)
    if start[at : at + 1] not in _bytes(_SPACE):
        raise ValueError("its header does not end with white space")
    plain = start[:2] == b"P3"
    samples = 3 * width * height
    needed = 2 * samples - 1 if plain else samples * (1 if maxval < 256 else 2)
    at += 1
    if start[at - 1 : at + 1] == b"\r\n" and size - at == needed + 1:
        at += 1  # written as text on Windows
    if needed > size - at:
        least = "at least " if plain else ""
        raise ValueError(f"it is cut off: {width} x {height} pixels need {least}{needed} bytes, {size - at} are there")
    return Header(plain, width, height, maxval, at)


def read_samples(file: IO[bytes], header: Header) -> "memoryview[float]":
    """The raster of the open `file` as flat float32 in 0..1.

    Raises:
        ValueError: numbers are missing, too large, or none.
    """
    file.seek(header.offset)
    if header.plain:
        return memoryview(_plain_samples(file.read(), header))
    data = file.read(header.samples * (1 if header.maxval < 256 else 2))
    return _byte_samples(data, header) if header.maxval < 256 else _word_samples(data, header)


def _byte_samples(data: bytes, header: Header) -> "memoryview[float]":
    maxval = header.maxval
    if data.translate(None, bytes(range(maxval + 1))):
        raise ValueError(f"it has values above its largest, {maxval}")
    # A float's four bytes are looked up one plane at a time: 50 million samples take a second, without any loop here.
    floats = [pack("f", value / maxval) if value <= maxval else bytes(4) for value in range(256)]
    result = bytearray(4 * len(data))
    for k in range(4):
        result[k::4] = data.translate(bytes(four[k] for four in floats))
    return memoryview(result).cast("f")


def _word_samples(data: bytes, header: Header) -> "memoryview[float]":
    maxval = header.maxval
    if header.samples >= LARGE:
        import numpy as np

        words = np.frombuffer(data, ">u2")
        largest = int(words.max())
        result = memoryview((words.astype(np.float32) / np.float32(maxval)).tobytes()).cast("f")
    else:
        values = array("H", data)
        if sys.byteorder == "little":
            values.byteswap()
        largest = max(values)
        result = memoryview(array("f", [value / maxval for value in values]))
    if largest > maxval:
        raise ValueError(f"it has the value {largest} above its largest, {maxval}")
    return result


def _plain_samples(data: bytes, header: Header) -> "array[float]":
    if b"#" in data:
        data = b"\n".join(line.partition(b"#")[0] for line in data.split(b"\n"))
    strange = data.translate(None, b"0123456789" + _SPACE)
    if strange:
        raise ValueError(f"it has {strange[:10].decode('latin-1')!r} where numbers belong")
    result = array("f")
    at = 0
    while at < len(data) and len(result) < header.samples:
        end = min(at + _BLOCK, len(data))
        while end < len(data) and data[end : end + 1].isdigit():  # not within a number
            end += 1
        values = list(map(float, data[at:end].split()))
        if values and max(values) > header.maxval:
            raise ValueError(f"it has the value {max(values):g} above its largest, {header.maxval}")
        result.extend([value / header.maxval for value in values])
        at = end
    if len(result) < header.samples:
        raise ValueError(f"it is cut off: {header.samples} numbers are needed, {len(result)} are there")
    return result[: header.samples]


def _skip_space(start: bytes, at: int) -> int:
    while start[at : at + 1] in (*_bytes(_SPACE), b"#"):
        at = _skip_comment(start, at) if start[at : at + 1] == b"#" else at + 1
    return at


def _skip_comment(start: bytes, at: int) -> int:
    """Index of the end of line that ends the comment."""
    while at < len(start) and start[at : at + 1] not in (b"\n", b"\r"):
        at += 1
    return at


def _bytes(characters: bytes) -> tuple[bytes, ...]:
    return tuple(characters[i : i + 1] for i in range(len(characters)))
