"""Small PNG files."""

import struct
import zlib
from typing import Any


def palette_png(pixels: Any) -> bytes:
    """A PNG file of at most 256 colours, a third as large as one of all.

    The colours are found by median cut (Heckbert, "Color image quantization for frame buffer display", 1982).

    Args:
        pixels: (height, width, 3) array, 0 to 255.
    """
    import numpy as np

    height, width, _ = pixels.shape
    colors = pixels.reshape(-1, 3)
    boxes = [np.arange(len(colors))]
    spreads = [1.0]
    while len(boxes) < 256 and max(spreads) > 0:
        # The box that is widest for the number of its pixels is cut in two, across its widest channel.
        widest = int(np.argmax(spreads))
        box = boxes.pop(widest)
        spreads.pop(widest)
        values = colors[box, np.argmax(np.ptp(colors[box], axis=0))]
        low = values <= (values.min() + values.max()) / 2
        for part in (box[low], box[~low]):
            if len(part) > 0:
                boxes.append(part)
                spreads.append(float(np.ptp(colors[part], axis=0).max()) * len(part) ** 0.4)
    indices = np.zeros(len(colors), np.uint8)
    for k, box in enumerate(boxes):
        indices[box] = k
    palette = np.array([np.rint(colors[box].mean(axis=0)) for box in boxes], np.uint8)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.insert(indices.reshape(height, width), 0, 0, axis=1)  # each row begins with its filter: none
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
        + chunk(b"PLTE", palette.tobytes())
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9))
        + chunk(b"IEND", b"")
    )
