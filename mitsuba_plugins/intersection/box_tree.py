"""A tree of boxes about any number of surfaces, which says which of them rays may meet.

It is walked without a stack: its nodes lie in depth-first order, each with a link to the node that follows where its
box is missed. There is one such order for every octant of directions, in which of two children the nearer comes first.
Smits, Efficiency Issues for Ray Tracing, Journal of Graphics Tools 3(2), 1998.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.coarse import unit_scale
from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.geometry import Box
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.intersection.rounding import bounds_all
from mitsuba_plugins.syntax import syntax
from native_tracer.bvh import NO_ITEM, ThreadedBvh, threaded_bvh

SLACK = 2.0**-20
"""By how much, relatively, a distance to a box may be wrong: some roundings to single precision."""
MARGIN = 2.0**-20
"""By how much, relative to the tree and the ray's origin, boxes are wider: some roundings, and what ties with a hit."""
LEAST_SLOPE = 2.0**-60
"""Of a direction: with less, along an axis, products might overflow, and the ray moves by much less than `MARGIN`."""

LARGE_NODE = 2 / 3
"""Of the surface of the box above: a box of more, inside the tree, costs more tests than it spares."""


@dataclass
class Walk:
    """How rays pass through a tree: what does not depend on the node. Lengths are times the tree's scale."""

    slope: Any  # Vector3f, the reciprocal of the direction, which has no 0 here
    enter: Any  # Vector3f, what is to be added to `slope` times the sides of a box that are reached first
    leave: Any  # Vector3f, and last: so that boxes are wider by more than the roundings
    start: Any  # UInt32, the first node
    end: Any  # UInt32, behind the last node
    blur: Any = None  # Vector3f, relative to distances, by how much more these may be wrong where all is bounded


class BoxTree:
    """Single-precision boxes, which are rounded outward: what they let through is exact."""

    def __init__(
        self, types: Real, boxes: list[Box | None], objects: list[int] | None = None, apart: Sequence[int] = ()
    ) -> None:
        """Take the boxes of all objects, or of parts of them; None of those that have no bounds. Of parts take the
        objects, too.

        Those that are `apart` are the first nodes, one each: a search may begin behind them.
        """
        self._types = types
        scale = unit_scale(abs(x) for box in boxes if box is not None for corner in box for x in corner)
        self._scale = types.Float(scale)
        self._nodes, self._node_count = _nodes(
            boxes, list(range(len(boxes))) if objects is None else objects, scale, apart
        )
        dr.make_opaque(self._node_count, self._scale)

    def walk(self, ray: Ray) -> Walk:
        """How rays pass through the tree; boxes that they miss by a little count as met."""
        origin = mi.Vector3f(ray.o * self._scale)
        d = mi.Vector3f(ray.d)
        slope = quotient(1, dr.select(d < 0, dr.minimum(d, -LEAST_SLOPE), dr.maximum(d, LEAST_SLOPE)))
        before, margin = -origin * slope, ((largest(origin) + 1) * MARGIN) * dr.abs(slope)
        start = _octant(d) * self._node_count
        blur = None
        if bounds_all(ray.t_min):
            margin += ((ray.t_min + ray.shift) * self._scale) * dr.abs(slope)
            blur = 2 * ray.spread * dr.abs(slope)
            blur = dr.select(blur < 1, blur, dr.inf)
        return Walk(slope, before - margin, before + margin, start, start + self._node_count, blur)

    def limit(self, distance: Any) -> Any:
        """A distance as `next` takes it, and a little more."""
        return mi.Float(distance * self._scale) * (1 + SLACK)

    @syntax
    def next(self, walk: Walk, node: Any, limit: Any, skipped: Any, active: Any) -> tuple[Any, Any]:
        """The next object or part, from `node` on, whose box rays enter before `limit`, or NOTHING, and the node to go
        on at.

        All rays walk until each is at a leaf, so that they are tested against surfaces together. The object `skipped`
        is passed over.
        """
        index = dr.full(mi.UInt32, NOTHING, dr.width(walk.slope))
        walking = active & (node < walk.end)
        while dr.hint(walking, exclude=[self, walk, limit, skipped]):
            corners = dr.gather(mi.Array4f, self._nodes, 2 * node, walking)
            rest = dr.gather(mi.Array4f, self._nodes, 2 * node + 1, walking)
            enter = dr.fma(mi.Vector3f(corners.xyz), walk.slope, walk.enter)
            leave = dr.fma(mi.Vector3f(corners.w, rest.x, rest.y), walk.slope, walk.leave)
            if dr.hint(walk.blur is not None, mode="scalar"):
                enter -= dr.abs(enter) * walk.blur
                leave += dr.abs(leave) * walk.blur
            # Of an origin beyond all measure these are NaN: then every box counts as met.
            near = _larger(_larger(enter.x, enter.y), _larger(enter.z, 0))
            far = _smaller(_smaller(leave.x, leave.y), _smaller(leave.z, limit))
            meets = ~(near > far)
            link, item = dr.reinterpret_array(mi.UInt32, rest.z), dr.reinterpret_array(mi.UInt32, rest.w)
            is_leaf = item != NOTHING
            found = walking & meets & is_leaf & (link != skipped)
            index = dr.select(found, item, index)
            node = dr.select(meets | is_leaf, node + 1, walk.start + link)
            walking &= ~found & (node < walk.end)
        return index, node


def _larger(a: Any, b: Any) -> Any:
    """One operation of processors, unlike dr.maximum, whose answer is never NaN if one of the two is not."""
    return dr.select(a > b, a, b)


def _smaller(a: Any, b: Any) -> Any:
    return dr.select(a < b, a, b)


def _octant(d: Any) -> Any:
    """Which components of a direction are negative, a bit each."""
    return sum(dr.select(component < 0, mi.UInt32(1 << axis), 0) for axis, component in enumerate(d))


def _nodes(boxes: list[Box | None], objects: list[int], scale: float, apart: Sequence[int]) -> tuple[Any, Any]:
    """The nodes of all octants, and the number of an octant's.

    A node is two rows of four: the corner of its box, times the scale, that rays of the octant reach first, the one
    they reach last, the link, and NOTHING. A leaf, which the next node follows in any case, has its object there, and
    which of the boxes it is. What is apart, and then what has no bounds, are leaves before the tree's root, with boxes
    without bounds.
    """
    bounded = [i for i, box in enumerate(boxes) if box is not None and i not in apart]
    unbounded = [*apart, *(i for i, box in enumerate(boxes) if box is None and i not in apart)]
    corners = np.array([boxes[i] for i in bounded], dtype=np.float64).reshape(-1, 2, 3) * scale
    tree = without_large_nodes(threaded_bvh(corners[:, 0], corners[:, 1]))
    first, count = len(unbounded), len(unbounded) + tree.size
    low = np.full((8, count, 3), -np.inf, dtype=np.float32)
    high = np.full((8, count, 3), np.inf, dtype=np.float32)
    corners = tree.boxes.reshape(8, tree.size, 2, 3)
    with np.errstate(over="ignore"):  # to an infinite side
        low[:, first:] = np.nextafter(corners[:, :, 0].astype(np.float32), np.float32(-np.inf))
        high[:, first:] = np.nextafter(corners[:, :, 1].astype(np.float32), np.float32(np.inf))
    negative = (np.arange(8)[:, None] >> np.arange(3) & 1 == 1)[:, None]
    nodes = np.empty((8, count, 8), dtype=np.float32)
    nodes[..., 0:3] = np.where(negative, high, low)
    nodes[..., 3:6] = np.where(negative, low, high)
    words = nodes.view(np.uint32)
    words[:, :first, 7] = unbounded
    words[:, first:, 6] = first + tree.skip.reshape(8, tree.size)
    # NO_ITEM becomes NOTHING.
    numbers = np.array([*bounded, NOTHING], dtype=np.uint32)
    words[:, first:, 7] = numbers[np.minimum(tree.item, len(bounded))].reshape(8, tree.size)
    leaf = words[..., 7] != NOTHING
    words[leaf, 6] = np.array(objects, dtype=np.uint32)[words[leaf, 7]]
    return column(mi.Float, nodes), mi.UInt32(count)


def without_large_nodes(tree: ThreadedBvh) -> ThreadedBvh:
    """A tree without the nodes whose boxes spare too few rays the tests of what is below them, which is met from the
    node above. Of n boxes that rays reach, one around them is worth its test if fewer than n - 1 of n rays meet it.
    """
    size = tree.size
    with np.errstate(over="ignore", invalid="ignore"):  # of boxes beyond all measure any answer will do
        edges = tree.boxes[:, 3:] - tree.boxes[:, :3]
        area = edges[:, 0] * edges[:, 1] + edges[:, 1] * edges[:, 2] + edges[:, 2] * edges[:, 0]
    above = np.flatnonzero(tree.item == NO_ITEM)
    first = above + 1
    second = above // max(size, 1) * size + tree.skip[first]
    kept = np.ones(len(area), dtype=np.bool_)
    for child in (first, second):
        kept[child] = (tree.item[child] != NO_ITEM) | (area[child] <= LARGE_NODE * area[above])
    number = np.zeros((8, size + 1), dtype=np.uint32)
    number[:, 1:] = np.cumsum(kept.reshape(8, size), axis=1)
    skip = np.take_along_axis(number, tree.skip.reshape(8, size).astype(np.intp), axis=1).ravel()
    return ThreadedBvh(tree.boxes[kept], skip[kept], tree.item[kept])
