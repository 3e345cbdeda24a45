"""Places names beside marks, so that none covers another."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Box = tuple[float, float, float, float]
"""Left, lower, right and upper edge."""

_ANGLES = np.linspace(0, 2 * np.pi, 24, endpoint=False)
_REACHES = np.array([0.0, 0.3, 0.7, 1.2, 2, 3, 4, 5.5, 7, 9, 12, 15])
"""In heights of the name."""
_SWEEPS = 6
_FAR = 80.0
_COVERS_NAME = 1e4
_COVERS_MARK = 500.0
_COVERS_LINE = 60.0
_LINE_UNDER_NAME = 200.0
_LINE_PASSES_MARK = 200.0
_LINES_CROSS = 60.0
"""What is bad about a place, in dots of distance from its mark; beyond `_FAR` distance counts more than once."""


@dataclass(slots=True)
class Crowd:
    """What names must not cover.

    Attributes:
        anchors: (n, 2) float, the marks that the names belong to.
        radius: of a mark.
        bounds: within which names have to be.
        boxes: that are taken.
        segments: (m, 4) float, lines x0 y0 x1 y1 that are better left free.

    """

    anchors: Array
    radius: float
    bounds: Box
    boxes: list[Box] = field(default_factory=list)
    segments: Array = field(default_factory=lambda: np.zeros((0, 4)))


def place_labels(crowd: Crowd, sizes: Array) -> Array:
    """(n, 4) float boxes for names of (n, 2) float `sizes`, each as near to its mark as the others let it.

    Each name in turn takes the best of some hundred places around its mark, the most crowded ones first; a few more
    rounds let each move to where the others have left room.
    """
    count = len(sizes)
    placed = np.full((count, 4), np.nan)
    leaders = np.full((count, 4), np.nan)
    places = [_Places(crowd, i, sizes[i]) for i in range(count)]
    for _ in range(_SWEEPS):
        before = placed.copy()
        for i in _most_crowded_first(crowd.anchors, 4 * sizes[:, 1]):
            others = (np.arange(count) != i) & ~np.isnan(placed[:, 0])
            best = places[i].best(placed[others], leaders[others])
            placed[i], leaders[i] = places[i].boxes[best], places[i].leaders[best]
        if np.array_equal(before, placed):
            break
    return placed


def _most_crowded_first(anchors: Array, near: Array) -> list[int]:
    """Indices of marks, those first that have the most others nearby."""
    distances = np.linalg.norm(anchors[:, None] - anchors[None], axis=2)
    order: list[int] = np.argsort(-(distances < near).sum(axis=1), kind="stable").tolist()
    return order


def leader(anchor: Array, box: Array) -> Array:
    """The line x0 y0 x1 y1 from a mark to the nearest point of its name's box."""
    x0, y0, x1, y1 = box
    return np.array([anchor[0], anchor[1], np.clip(anchor[0], x0, x1), np.clip(anchor[1], y0, y1)])


class _Places:
    """The places where one name may stand, and what is bad about each wherever the other names stand."""

    def __init__(self, crowd: Crowd, own: int, size: Array) -> None:
        anchor, r = crowd.anchors[own], crowd.radius
        left, low, right, high = crowd.bounds
        reach, angle = (grid.ravel() for grid in np.meshgrid(r + 2 + size[1] * _REACHES, _ANGLES, indexing="ij"))
        direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        corner = anchor + direction * (reach[:, None] + np.abs(direction) * size / 2) - size / 2
        corner = np.clip(corner, [left, low], np.maximum([right, high] - size, [left, low]))
        self.boxes = np.concatenate([corner, corner + size], axis=1)
        nearest = np.clip(anchor, self.boxes[:, :2], self.boxes[:, 2:])
        self.leaders = np.concatenate([np.broadcast_to(anchor, nearest.shape), nearest], axis=1)
        taken = np.reshape(crowd.boxes, (-1, 4))
        marks = np.concatenate([crowd.anchors - r, crowd.anchors + r], axis=1)
        others = marks[np.arange(len(marks)) != own]
        far = np.linalg.norm(nearest - anchor, axis=1)
        self._cost = far + far**2 / _FAR
        self._cost += _COVERS_NAME * _overlap(self.boxes, taken, 1.0).sum(axis=1)
        self._cost += _COVERS_MARK * _overlap(self.boxes, marks, 0.0).sum(axis=1)
        self._cost += _COVERS_LINE * _crosses_box(crowd.segments, self.boxes).any(axis=1)
        self._cost += _LINE_UNDER_NAME * _crosses_box(self.leaders, taken).sum(axis=0)
        self._cost += _LINE_PASSES_MARK * _crosses_box(self.leaders, others).sum(axis=0)

    def best(self, names: Array, leaders: Array) -> int:
        """Index of the best place beside the other names and their leaders."""
        cost = self._cost + _COVERS_NAME * _overlap(self.boxes, names, 1.0).sum(axis=1)
        cost += _LINE_UNDER_NAME * _crosses_box(self.leaders, names).sum(axis=0)
        cost += _LINE_UNDER_NAME * _crosses_box(leaders, self.boxes).sum(axis=1)
        cost += _LINES_CROSS * _cross(self.leaders, leaders).sum(axis=1)
        return int(np.argmin(cost))


def _overlap(boxes: Array, others: Array, margin: float) -> NDArray[np.bool_]:
    """(n, m) whether boxes overlap, or come nearer than `margin`."""
    a, b = boxes[:, None], others[None]
    result: NDArray[np.bool_] = (
        (a[..., 0] < b[..., 2] + margin)
        & (b[..., 0] < a[..., 2] + margin)
        & (a[..., 1] < b[..., 3] + margin)
        & (b[..., 1] < a[..., 3] + margin)
    )
    return result


def _crosses_box(segments: Array, boxes: Array) -> NDArray[np.bool_]:
    """(boxes, segments) whether a segment passes through a box: the slab method."""
    start, along = segments[None, :, :2], (segments[:, 2:] - segments[:, :2])[None]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.stack([(boxes[:, None, :2] - start) / along, (boxes[:, None, 2:] - start) / along])
    inside = (start >= boxes[:, None, :2]) & (start <= boxes[:, None, 2:])
    flat = along == 0
    enter = np.where(flat, np.where(inside, -np.inf, np.inf), np.nan_to_num(t.min(axis=0))).max(axis=2)
    leave = np.where(flat, np.where(inside, np.inf, -np.inf), np.nan_to_num(t.max(axis=0))).min(axis=2)
    result: NDArray[np.bool_] = (np.maximum(enter, 0) < np.minimum(leave, 1)) & (along != 0).any(axis=2)
    return result


def _cross(a: Array, b: Array) -> NDArray[np.bool_]:
    """(a, b) whether segments cross."""

    def side(p: Array, q: Array, r: Array) -> Array:
        result: Array = (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (
            r[..., 0] - p[..., 0]
        )
        return result

    a0, a1, b0, b1 = a[:, None, :2], a[:, None, 2:], b[None, :, :2], b[None, :, 2:]
    result: NDArray[np.bool_] = (side(a0, a1, b0) * side(a0, a1, b1) < 0) & (side(b0, b1, a0) * side(b0, b1, a1) < 0)
    return result
