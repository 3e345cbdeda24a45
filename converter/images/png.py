"""Writes PNG files of 8-bit RGB (PNG Specification, third edition): importing OpenImageIO takes as long as drawing."""

import struct
import zlib
from collections.abc import Iterator

SIGNATURE = b"\x89PNG\r\n\x1a\n"
ROWS = 64
"""Rows that are filtered and compressed at once."""
_SRGB = (
    (b"sRGB", bytes([3])),  # absolute colorimetric
    (b"gAMA", struct.pack(">I", 45455)),
    (b"cHRM", struct.pack(">8I", 31270, 32900, 64000, 33000, 30000, 60000, 15000, 6000)),
)
"""That numbers are display values, for programs that know the first of these, or only the others."""
_UP = b"\x02"
"""The filter that keeps of each byte its difference from the one above, modulo 256."""


def png(levels: bytes, width: int, height: int) -> Iterator[bytes]:
    """The file, piece by piece, for height x width x 3 bytes, row 0 on top."""
    yield SIGNATURE
    yield _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
    for kind, data in _SRGB:
        yield _chunk(kind, data)
    row = 3 * width
    compressor = zlib.compressobj()
    above = bytes(row)
    for start in range(0, row * height, ROWS * row):
        rows = levels[start : start + ROWS * row]
        filtered = _minus(rows, above + rows[:-row])
        above = rows[-row:]
        lines = (_UP + filtered[k : k + row] for k in range(0, len(rows), row))
        yield _chunk(b"IDAT", compressor.compress(b"".join(lines)))
    yield _chunk(b"IDAT", compressor.flush())
    yield _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _minus(a: bytes, b: bytes) -> bytes:
    """Byte by byte, modulo 256: as one number, whose digits lend nothing to each other because each has its top bit set
    first (Warren, Hacker's Delight, 2-18).
    """
    size = len(a)
    top = int.from_bytes(b"\x80" * size, "big")
    x, y = int.from_bytes(a, "big"), int.from_bytes(b, "big")
    return (((x | top) - (y & ~top)) ^ (~(x ^ y) & top)).to_bytes(size, "big")
