"""A csg of many leaves, in a loop from one crossing to the next: its code does not grow with the leaves.

Nothing is kept of a leaf from one loop to the next, whose crossings are found again: Dr.Jit may crash with local memory
for as many numbers.
"""

from dataclasses import dataclass, field
from typing import Any, Protocol

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.csg import Csg, Leaf, crossed_at_start, side_of_sheet
from mitsuba_plugins.intersection.leaf_passage import Membership, SheetRows, leaf_passage, marked
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.rays import NOTHING, UPRIGHT, Ray
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.intersection.shapes.kind import ShapeKind
from mitsuba_plugins.syntax import syntax

BOUND_ROOM = 2.0**-20
"""By how much, relatively, a sphere around a leaf is larger."""


class Leaves(Protocol):
    """The leaves of a csg, or of one for each ray, in a kernel."""

    kinds: list[ShapeKind]
    width: int

    def kind(self, k: Any) -> Any:
        """Which of `kinds` leaf k is (UInt32)."""
        ...

    def range(self, k: Any) -> tuple[Any, Any]:
        """The first row of leaf k, and the number of its primitives (UInt32)."""
        ...

    def bound(self, k: Any) -> Any:
        """A sphere around leaf k (Vector4): its centre and radius, which may be infinite."""
        ...

    def rows(self, first: Any, count: Any) -> SheetRows:
        """The rows of a leaf with this range."""
        ...


@dataclass(frozen=True)
class SearchedCsg(Csg):
    """Which gathers its leaves: those that have the same program share their code."""

    leaves: tuple[Leaf, ...] = field(compare=False)

    def intersect(self, rows: Any, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """Where the value first changes; `rows` are its `Leaves`."""
        leaves: Leaves = rows
        search = _Search(self, leaves, ray, reach, by_rules)
        start = _start(search)
        found = _first_change(search, start)
        lost = own & (start.inside != ray.inside)
        return crossed_at_start(found, lost, _nearest_to_start(search, start, lost), ray)


@dataclass
class _Met:
    """A leaf along a ray."""

    if_inside: Any  # Bool, whether the ray starts inside it, if inside of the sheet that it starts on
    if_outside: Any  # likewise, if outside of that
    ahead: Membership
    matters: Any  # Bool, whether it may be crossed, or starts a tie
    close: Any  # Bool, as `Passage` has it
    between: Any  # Float, likewise, infinite if there are not several planes


@dataclass
class _Start:
    """Where each ray starts."""

    near: Any  # UInt64, a bit for each leaf that the ray comes near
    met: Any  # UInt64, a bit for each of these that it may cross
    passed: Any  # UInt64, a bit for each other that it is in
    inside_sheet: Any  # Bool, on which side of the sheet that it starts on
    inside: Any  # Bool, whether in the csg
    close: Any  # Bool, whether the passage of some leaf is close to a tie
    between: Any  # Float, how close two planes of a leaf are


class _Search:
    """What stays the same: of a class in which Dr.Jit's loops do not look for their variables."""

    def __init__(self, csg: SearchedCsg, leaves: Leaves, ray: Ray, reach: Any, by_rules: bool) -> None:
        self.csg = csg
        self.leaves = leaves
        self.ray = ray
        self.reach = reach
        self.by_rules = by_rules
        self.count = len(csg.leaves)
        self.width = dr.width(ray.d, leaves.width)

    def comes_near(self, k: Any) -> Any:
        """Whether rays may meet leaf k, or start in it: not if they miss a sphere around it, or leave it behind."""
        bound, ray = self.leaves.bound(k), self.ray
        f = ray.o - type(ray.o)(bound.xyz)
        b = -dr.dot(f, ray.d)
        # With room for roundings, and for rays that are off as much as where ties are decided.
        radius = bound.w * (1 + BOUND_ROOM) + BOUND_ROOM * (self.reach + dr.abs(b))
        return (dr.squared_norm(f + b * ray.d) <= dr.square(radius)) & (b >= -radius)

    def meet(self, k: Any, inside_sheet: Any, active: Any) -> _Met:
        """Leaf k along the rays, by a call of its kind's function: so it is in the kernel once a kind."""
        first, count = self.leaves.range(k)
        calls = [lambda *asked, kind=kind: self._meet(kind, *asked) for kind in self.leaves.kinds]
        return dr.switch(self.leaves.kind(k), calls, first, count, self.ray, inside_sheet, self.reach, active)

    def _meet(self, kind: Any, first: Any, count: Any, ray: Ray, inside_sheet: Any, reach: Any, active: Any) -> _Met:
        leaf = leaf_passage(kind, self.leaves.rows(first, count), ray, reach, self.by_rules)
        between = leaf.passage.between
        number = type(reach)
        ahead = leaf.ahead(inside_sheet ^ leaf.turned, ray, reach)
        ahead.near_error, ahead.far_error = number(ahead.near_error), number(ahead.far_error)
        return _Met(
            if_inside=leaf.starts_inside(~leaf.turned, ray),
            if_outside=leaf.starts_inside(leaf.turned, ray),
            ahead=ahead,
            matters=leaf.starts | self.matters(ahead, ray.t_min - most_blur(reach) * reach),
            close=mi.Bool(leaf.passage.close),
            between=number(dr.inf if between is None else between),
        )

    def matters(self, ahead: Membership, t: Any) -> Any:
        """Whether a leaf may be crossed farther away than at a distance; where ties are decided that is not told."""
        beyond = [(crossed > t) & (crossed < dr.inf) for crossed in (ahead.near, ahead.far)]
        return beyond[0] | beyond[1] | self.by_rules

    def value(self, bits: Any) -> Any:
        """The expression, of a bit for each leaf that a point is in."""
        return self.csg.value([(bits & (1 << k)) != 0 for k in range(self.count)])


@syntax
def _start(search: _Search) -> _Start:
    """By all leaves, one after the other."""
    width = search.width
    near, met = dr.zeros(mi.UInt64, width), dr.zeros(mi.UInt64, width)
    if_inside, if_outside = dr.zeros(mi.UInt64, width), dr.zeros(mi.UInt64, width)
    close = dr.full(mi.Bool, False, width)
    between = dr.full(type(search.reach), dr.inf, width)
    nowhere = dr.full(mi.Bool, False, width)
    k = dr.zeros(mi.UInt32, width)
    bit = dr.full(mi.UInt64, 1, width)
    while dr.hint(k < search.count, exclude=[search, nowhere]):
        comes_near = search.comes_near(k)
        leaf = search.meet(k, nowhere, comes_near)
        near |= dr.select(comes_near, bit, 0)
        met |= dr.select(comes_near & leaf.matters, bit, 0)
        if_inside |= dr.select(comes_near & leaf.if_inside, bit, 0)
        if_outside |= dr.select(comes_near & leaf.if_outside, bit, 0)
        close |= comes_near & leaf.close
        between = dr.select(comes_near & (leaf.between < between), leaf.between, between)
        bit <<= 1
        k += 1
    inside_sheet, inside = side_of_sheet(search.value(if_inside), search.value(if_outside), search.ray)
    passed = dr.select(inside_sheet, if_inside, if_outside) & ~met
    return _Start(near, met, passed, inside_sheet, inside, close, between)


@syntax
def _first_change(search: _Search, start: _Start) -> Crossing:
    """From one crossing to the next, until the value changes."""
    ray, width, kind = search.ray, search.width, type(search.reach)
    t, error = dr.full(kind, dr.inf, width), dr.zeros(kind, width)
    primitive, enters = dr.zeros(mi.UInt32, width), dr.full(mi.Bool, False, width)
    several = dr.full(mi.Bool, False, width)
    behind = dr.zeros(kind, width) + ray.t_min
    started = dr.full(mi.Bool, False, width)
    met, passed = mi.UInt64(start.met), mi.UInt64(start.passed)
    walking = met != 0
    while dr.hint(walking, exclude=[search, start]):
        # What is known to lie ahead of a ray's start may be no farther than t_min.
        next_t, next_error = dr.full(kind, dr.inf, width), dr.zeros(kind, width)
        left = mi.UInt64(met)
        while dr.hint(walking & (left != 0), exclude=[search, start, walking, behind, started]):
            ahead = search.meet(mi.UInt32(dr.tzcnt(left)), start.inside_sheet, walking & (left != 0)).ahead
            for distance, its_error, _, _, known in ahead.crossings():
                closer = ((distance > behind) | (known & ~started)) & (distance < next_t)
                next_error = dr.select(closer, its_error, next_error)
                next_t = dr.select(closer, distance, next_t)
            left &= left - 1
        # What is crossed there, at once; of that the first counts.
        before, after = mi.UInt64(passed), mi.UInt64(passed)
        found, found_enters = dr.full(mi.UInt32, NOTHING, width), dr.full(mi.Bool, False, width)
        least, most = dr.full(mi.UInt32, NOTHING, width), dr.zeros(mi.UInt32, width)
        near = most_blur(next_t) * (search.reach + next_t)
        walking &= next_t < dr.inf
        left = mi.UInt64(met)
        while dr.hint(walking & (left != 0), exclude=[search, start, walking, next_t, next_error, near]):
            ahead = search.meet(mi.UInt32(dr.tzcnt(left)), start.inside_sheet, walking & (left != 0)).ahead
            others = left & (left - 1)
            bit = left ^ others
            before |= dr.select(ahead.before_distance(next_t, next_error), bit, 0)
            after |= dr.select(ahead.after_distance(next_t, next_error), bit, 0)
            for distance, its_error, its_primitive, its_enters, _ in ahead.crossings():
                apart = dr.abs(distance - next_t)
                first = (apart <= its_error + next_error) & (found == NOTHING)
                found = dr.select(first, its_primitive, found)
                found_enters = dr.select(first, its_enters, found_enters)
                sheet = its_primitive & UPRIGHT
                least = dr.select(apart <= near, dr.minimum(least, sheet), least)
                most = dr.select(apart <= near, dr.maximum(most, sheet), most)
            gone = dr.select(search.matters(ahead, next_t - near), 0, bit)
            met ^= gone
            passed |= after & gone
            left = others
        value_after = search.value(after)
        changes = walking & (search.value(before) != value_after)
        t = dr.select(changes, next_t, t)
        error = dr.select(changes, next_error, error)
        primitive = dr.select(changes, marked(found, found_enters, value_after), primitive)
        enters = dr.select(changes, value_after, enters)
        several = dr.select(changes, least != most, several)
        behind = next_t
        started = dr.full(mi.Bool, True, width)
        walking &= ~changes
    tied = (t < dr.inf) & (several | (start.between < most_blur(t) * (search.reach + t)))
    return Crossing(t, enters, primitive, error, (start.close | tied) & (not search.by_rules))


@syntax
def _nearest_to_start(search: _Search, start: _Start, lost: Any) -> Any:
    """The primitive, but those that a ray starts on, whose crossing is nearest to where it starts, where it is lost."""
    nearest = dr.full(type(search.reach), dr.inf, search.width)
    found = dr.zeros(mi.UInt32, search.width)
    left = mi.UInt64(start.near)
    while dr.hint(lost & (left != 0), exclude=[search, start, lost]):
        ahead = search.meet(mi.UInt32(dr.tzcnt(left)), start.inside_sheet, lost & (left != 0)).ahead
        for t, _, primitive, enters, _ in ahead.crossings():
            closer = dr.abs(t) < nearest
            nearest = dr.select(closer, dr.abs(t), nearest)
            found = dr.select(closer, marked(primitive, enters, ~search.ray.inside), found)
        left &= left - 1
    return found
