"""Parts of pictures about the pixels that are left: theirs, with the causes, and the right one, side by side."""

from collections.abc import Sequence

import numpy as np

from converter.compare.figure import GAP, GROUND, Panel, side_by_side
from converter.compare.metrics import Pixels
from converter.why.judge import Judged
from converter.why.left import Place
from converter.why.likeness import errors
from converter.why.picture import Picture

EDGE = 40
"""Columns and rows of a part."""
_MOST = 4


def draw_crops(judged: Judged, places: Sequence[Place]) -> Pixels:
    """A sheet: the whole pictures, and below them a part about an example of each of the first places."""
    rows = [_row(judged, "", 0, 0, judged.settings.width, judged.settings.height)]
    for place in places[:_MOST]:
        width, height = min(EDGE, judged.settings.width), min(EDGE, judged.settings.height)
        left = int(np.clip(place.pixel[0] - width // 2, 0, judged.settings.width - width))
        top = int(np.clip(place.pixel[1] - height // 2, 0, judged.settings.height - height))
        rows.append(
            _row(judged, f" at {place.pixel[0]}, {place.pixel[1]}: {place.mechanism}", left, top, width, height)
        )
    width = max(row.shape[1] for row in rows)
    height = sum(row.shape[0] + GAP for row in rows) - GAP
    sheet: Pixels = np.full((height, width, 3), GROUND, dtype=np.float32)
    top = 0
    for row in rows:
        sheet[top : top + row.shape[0], : row.shape[1]] = row
        top += row.shape[0] + GAP
    return sheet


def _row(judged: Judged, told: str, left: int, top: int, width: int, height: int) -> Pixels:
    part = slice(top, top + height), slice(left, left + width)
    ys, xs = np.mgrid[part]
    places = np.stack((xs.ravel(), ys.ravel()), axis=1).astype(np.int32)
    drawn = judged.student.drawn(places, frozenset(judged.found.causes)).reshape(height, width, 3)
    theirs = judged.theirs.levels[part]
    panels = [Panel(f"theirs{told}", _colors(theirs)), Panel("the right picture", _colors(judged.reference[part]))]
    if judged.found.causes:
        panels.insert(1, Panel("with the mistakes named", _colors(drawn)))
    wrong = errors(drawn, theirs) > judged.found.likeness.tolerance
    panels.append(Panel("pixels left", _colors(np.repeat(wrong[:, :, np.newaxis], 3, axis=2).astype(np.uint8) * 255)))
    return side_by_side(tuple(panels))


def _colors(levels: Picture) -> Pixels:
    return np.divide(levels, 255, dtype=np.float32)
