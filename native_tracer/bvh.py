"""Bounding volume hierarchies for searches without a stack, as in a kernel that runs many rays at once.

A search starts at the first node of its octant's block and ends after the last:

>>> import numpy as np
>>> low, high = np.array([[0.0, 0, 0], [4, 0, 0]]), np.array([[1.0, 1, 1], [5, 1, 1]])
>>> tree = threaded_bvh(low, high)
>>> def first_box_at(point, octant=0):
...     node = 0
...     while node < tree.size:
...         at = octant * tree.size + node
...         inside = (tree.boxes[at, :3] <= point).all() and (point <= tree.boxes[at, 3:]).all()
...         if inside and tree.item[at] != NO_ITEM:
...             return int(tree.item[at])
...         node = node + 1 if inside else int(tree.skip[at])
>>> first_box_at([4.5, 0.5, 0.5])
1
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from native_tracer import _core

NO_ITEM = 0xFFFFFFFF
"""The `item` of a node that is no leaf."""


@dataclass(frozen=True, slots=True)
class ThreadedBvh:
    """One binary tree in eight orders, one for each octant of ray directions, each a block of `size` nodes.

    Octant sum of 2^k over the k with direction[k] < 0 has the nodes in the order in which its rays meet them: parents
    before their children, and of two children the nearer one, by the axis along which they lie apart, with all that is
    below it, before the other.
    """

    boxes: NDArray[np.float64]
    """(8 size, 6): low and high corner of the union of the items' boxes, exact: what rounding asks for is not added."""
    skip: NDArray[np.uint32]
    """(8 size,): the node to go on with, counted within the block, when the box is missed or the node is a leaf; `size`
    at the end. Otherwise the first child follows, the next node."""
    item: NDArray[np.uint32]
    """(8 size,): the item of a leaf, `NO_ITEM` in all other nodes."""

    @property
    def size(self) -> int:
        """Nodes in a block: 2 n - 1 for n items, 0 for none."""
        return len(self.skip) // 8


def threaded_bvh(low: ArrayLike, high: ArrayLike) -> ThreadedBvh:
    """Build a tree with one item in each leaf, by the surface area heuristic, in n log n steps.

    The same boxes give the same tree on every machine.

    Args:
        low: (n, 3) numbers, the lower corners of the items' boxes.
        high: (n, 3) numbers, the upper ones.

    Raises:
        ValueError: the shapes are wrong, a number is not finite, or a low corner lies above its high one.

    """
    corners = [np.ascontiguousarray(corner, dtype=np.float64) for corner in (low, high)]
    for corner in corners:
        if corner.ndim != 2 or corner.shape[1] != 3:
            raise ValueError(f"corners of boxes have the shape (n, 3), not {corner.shape}")
    boxes, skip, item = map(np.asarray, _core.threaded_bvh(*(corner.data for corner in corners)))
    return ThreadedBvh(boxes, skip, item)
