"""A csg of some leaves, each with code of its own, in a loop from one crossing to the next.

Its code grows with the leaves, and not with their square; what is known of them is found once and kept.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.csg import INTERSECTION, UNION, Csg
from mitsuba_plugins.intersection.csg_search import SearchedCsg
from mitsuba_plugins.intersection.csg_unrolled import UnrolledCsg
from mitsuba_plugins.intersection.leaf_passage import Membership, marked
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.rays import Ray
from mitsuba_plugins.syntax import syntax

ROOM = 2.0**-20
"""By how much, relatively, the steps begin before the csg."""


@dataclass(frozen=True)
class SteppedCsg(UnrolledCsg):
    """Which has its leaves in its code. Few rays come close to a tie: for them it is searched."""

    def deciding_ties(self) -> Csg:
        """As `Solid` has it."""
        return SearchedCsg(self.program, self.leaves)

    def _first_change(self, leaves: list[Membership], ray: Ray, by_rules: bool) -> Crossing:
        return _step(_Leaves(self, leaves, ray), dr.width(ray.d))


class _Leaves:
    """What stays the same: of a class in which Dr.Jit's loops do not look for their variables."""

    def __init__(self, csg: Csg, leaves: list[Membership], ray: Ray) -> None:
        self.csg = csg
        self.leaves = leaves
        self.crossings = [
            (dr.select((t > ray.t_min) | known, t, dr.inf), primitive, enters)
            for leaf in leaves
            for t, _, primitive, enters, known in leaf.crossings()
        ]
        self.Float = type(ray.t_min)

    def start(self) -> Any:
        """A distance up to which the ray is outside of the csg, or minus infinity; infinite where it misses it.

        Of each leaf the part of the line in which the ray is inside is bounded, and so that of the expression.
        """
        bounds: list[tuple[Any, Any]] = []
        for code in self.csg.program:
            if code >= 0:
                bounds.append(_bounds(self.leaves[code]))
                continue
            right, left = bounds.pop(), bounds.pop()
            if code == UNION:
                bounds.append((dr.minimum(left[0], right[0]), dr.maximum(left[1], right[1])))
            elif code == INTERSECTION:
                bounds.append((dr.maximum(left[0], right[0]), dr.minimum(left[1], right[1])))
            else:
                bounds.append(left)
        low, high = bounds.pop()
        return dr.select(low <= high, dr.select(low > 0, low * (1 - ROOM), -dr.inf), dr.inf)

    def next(self, behind: Any) -> Any:
        """The distance of the first crossing that is farther than a distance."""
        nearest = self.Float(dr.inf)
        for t, _, _ in self.crossings:
            nearest = dr.select((t > behind) & (t < nearest), t, nearest)
        return nearest

    def values(self, t: Any) -> tuple[Any, Any]:
        """The expression just before and just after a distance."""
        before = self.csg.value([leaf.before_distance(t, 0) for leaf in self.leaves])
        return before, self.csg.value([leaf.after_distance(t, 0) for leaf in self.leaves])

    def primitive(self, t: Any, after: Any) -> Any:
        """The first that is crossed at a distance, beyond which the expression has this value."""
        found = mi.UInt32(0)
        for its_t, primitive, enters in reversed(self.crossings):
            found = dr.select(its_t == t, marked(primitive, enters, after), found)
        return found


def _bounds(leaf: Membership) -> tuple[Any, Any]:
    """Two distances between which a ray is inside a leaf, if anywhere."""
    crosses_near, crosses_far = leaf.near < dr.inf, leaf.far < dr.inf
    first = dr.minimum(dr.select(crosses_near, leaf.near, dr.inf), dr.select(crosses_far, leaf.far, dr.inf))
    last = dr.maximum(dr.select(crosses_near, leaf.near, -dr.inf), dr.select(crosses_far, leaf.far, -dr.inf))
    ends_inside = leaf.before ^ crosses_near ^ crosses_far
    return dr.select(leaf.before, -dr.inf, first), dr.select(ends_inside, dr.inf, last)


@syntax
def _step(search: _Leaves, width: int) -> Crossing:
    t = search.next(search.start())
    after = dr.full(mi.Bool, False, width)
    walking = t < dr.inf
    while dr.hint(walking, exclude=[search]):
        before, after = search.values(t)
        walking &= before == after
        t = dr.select(walking, search.next(t), t)
        walking &= t < dr.inf
    return Crossing(t, after, search.primitive(t, after), search.Float(0), mi.Bool(False))
