"""A csg of a few leaves, each with code of its own, in which every crossing is compared with every leaf."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.csg import Csg, Leaf, crossed_at_start, side_of_sheet
from mitsuba_plugins.intersection.leaf_passage import LeafPassage, Membership, leaf_passage, marked
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.rays import INVERTED, NOTHING, UPRIGHT, Ray
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.intersection.shapes.kind import Rows


@dataclass(frozen=True)
class UnrolledCsg(Csg):
    """Which has its leaves in its code."""

    leaves: tuple[Leaf, ...]

    def intersect(self, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """Where the value first changes."""
        passages = [leaf_passage(leaf.kind, LeafRows(rows, leaf), ray, reach, by_rules) for leaf in self.leaves]
        if_inside = self.value([leaf.starts_inside(~leaf.turned, ray) for leaf in passages])
        if_outside = self.value([leaf.starts_inside(leaf.turned, ray) for leaf in passages])
        inside_sheet, starts_inside = side_of_sheet(if_inside, if_outside, ray)
        leaves = [leaf.ahead(inside_sheet ^ leaf.turned, ray, reach) for leaf in passages]
        found = self._first_change(leaves, ray, by_rules)
        if not by_rules:
            found.close = _is_close(passages, leaves, found, reach)
        return crossed_at_start(found, own & (starts_inside != ray.inside), _nearest_to_start(leaves, ray), ray)

    def _first_change(self, leaves: list[Membership], ray: Ray, by_rules: bool) -> Crossing:
        """Every crossing against every leaf; of those that tie with the nearest the first counts."""
        candidates = []
        for leaf in leaves:
            for t, error, primitive, enters, known in leaf.crossings():
                before = self.value([other.before_distance(t, error) for other in leaves])
                after = self.value([other.after_distance(t, error) for other in leaves])
                counts = (before != after) & ((t > ray.t_min) | known)
                candidates.append((dr.select(counts, t, dr.inf), error, after, marked(primitive, enters, after)))
        nearest, nearest_error = type(ray.t_min)(dr.inf), 0
        for t, error, *_ in candidates:
            closer = t < nearest
            nearest_error = dr.select(closer, error, nearest_error) if by_rules else 0
            nearest = dr.select(closer, t, nearest)
        error = type(nearest)(nearest_error)
        found = Crossing(nearest, mi.Bool(False), mi.UInt32(0), error, mi.Bool(False))
        for t, error, after, primitive in reversed(candidates):
            ties = (t - nearest <= error + nearest_error) if by_rules else t == nearest
            if by_rules:
                found.t = dr.select(ties, t, found.t)
                found.error = dr.select(ties, error, found.error)
            found.enters = dr.select(ties, after, found.enters)
            found.primitive = dr.select(ties, primitive, found.primitive)
        return found


def _nearest_to_start(leaves: list[Membership], ray: Ray) -> Any:
    """The primitive, but those that a ray starts on, whose crossing is nearest to where it starts."""
    nearest, found = type(ray.t_min)(dr.inf), mi.UInt32(0)
    for leaf in leaves:
        for t, _, primitive, enters, _ in leaf.crossings():
            closer = dr.abs(t) < nearest
            nearest = dr.select(closer, dr.abs(t), nearest)
            found = dr.select(closer, marked(primitive, enters, ~ray.inside), found)
    return found


def _is_close(passages: list[LeafPassage], leaves: list[Membership], found: Crossing, reach: Any) -> Any:
    """Whether a crossing is close to a tie: of a leaf's, or of two leaves'."""
    near = most_blur(found.t) * (reach + found.t)
    hits = found.t < dr.inf
    close = mi.Bool(False)
    for leaf in passages:
        close |= leaf.passage.close
        if leaf.passage.between is not None:
            close |= hits & (leaf.passage.between < near)
    for ahead in leaves:
        for t, _, primitive, _, _ in ahead.crossings():
            close |= hits & ((primitive ^ found.primitive) & UPRIGHT != 0) & (dr.abs(t - found.t) <= near)
    return close


class LeafRows:
    """The rows of a leaf, whose primitives go by their sheets, marked if turned; see `SheetRows`."""

    def __init__(self, rows: Rows, leaf: Leaf) -> None:
        self._rows = rows
        self._leaf = leaf
        self.width = rows.width

    def primitive(self, k: int = 0) -> Any:
        """The index of primitive k's sheet."""
        sheet = self._rows.primitive(self._leaf.sheets[k])
        return sheet | INVERTED if self._leaf.turned[k] else sheet

    def row(self, k: int = 0) -> Any:
        """The row k after the first."""
        return self._rows.row(self._leaf.first + k)

    def fold(self, step: Any, state: Any) -> Any:
        """Code for each of them."""
        for k in range(len(self._leaf.sheets)):
            state = step(state, self.primitive(k), self.row(k))
        return state

    def start(self, ray: Ray) -> tuple[Any, Any, Any]:
        """As `SheetRows` has it."""
        starts, turned, start = mi.Bool(False), mi.Bool(False), mi.UInt32(NOTHING)
        for k, is_turned in enumerate(self._leaf.turned):
            primitive = self.primitive(k)
            here = (ray.primitive & UPRIGHT) == (primitive & UPRIGHT)
            starts |= here
            turned |= here & is_turned
            start = dr.select(here, primitive, start)
        return starts, turned, start
