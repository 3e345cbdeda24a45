"""What an object is in a kernel: one primitive or convex polyhedron, or a Boolean expression over several (csg)."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.passages import Crossing, Passage, first_crossing
from mitsuba_plugins.intersection.rays import INVERTED, NOTHING, UPRIGHT, Ray
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.intersection.shapes.kind import Row, Rows, Shape, ShapeKind

UNION, DIFFERENCE, INTERSECTION = -1, -2, -3
"""In a program, which is in postfix notation; numbers from 0 on are leaves."""

MOST_UNROLLED = 8
"""Leaves up to which every crossing is compared with every leaf; beyond, crossings are gone through in a loop."""


class Solid(Protocol):
    """The structure of an object, without its numbers: objects that are equal in it share their code."""

    @property
    def convex(self) -> bool:
        """Whether a ray that leaves it never meets it again."""
        ...

    @property
    def bounded_first(self) -> bool:
        """Whether it takes so long to intersect that a sphere around it is tested before."""
        ...

    def intersect(self, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """Where rays first cross it; `by_rules` of ties, or else saying whether that is close to one.

        `own` where a ray starts on it, `reach` the largest coordinate of its origin; planes may tie where it does not
        matter `which_piece` is met.
        """
        ...


@dataclass(frozen=True)
class Single:
    """One shape."""

    kind: ShapeKind

    @property
    def convex(self) -> bool:
        """As its kind."""
        return self.kind.CONVEX

    @property
    def bounded_first(self) -> bool:
        """As its kind."""
        return self.kind.BOUNDED_FIRST

    def intersect(self, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """At the crossing of its passage that counts."""
        return first_crossing(_passage(self.kind, rows, ray, own, reach, by_rules), ray, own, reach, which_piece)


@dataclass(frozen=True)
class Leaf:
    """A shape of an expression.

    Attributes:
        kind: its kind.
        first: its first row among the expression's.
        sheets: for each of its primitives the first row of the first primitive of the expression that is the same set
            of points. So that coincident faces are crossed together, and left together.
        turned: whether the inside of that is this one's outside.

    """

    kind: ShapeKind
    first: int
    sheets: tuple[int, ...]
    turned: tuple[bool, ...]


class LeafRows:
    """The rows of a leaf, whose primitives go by their sheets, marked if turned; see `Rows`."""

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


@dataclass
class _Membership:
    """A leaf along a ray: inside `before`, and the other way round between its near and its far crossing.

    Where a ray starts on the leaf it is about what lies ahead: `before` is where it starts.
    """

    before: Any  # Bool
    near: Any  # Float, infinite or NaN if there is none, as is `far`
    far: Any
    near_primitive: Any  # UInt32, as is `far_primitive`
    far_primitive: Any
    near_enters: Any  # Bool, whether the ray enters the leaf there, as is `far_enters`
    far_enters: Any
    near_error: Any  # Float, as is `far_error`
    far_error: Any
    known: Any  # Bool, whether the far one lies ahead by knowledge, be it no farther than `t_min`

    def before_distance(self, t: Any, error: Any) -> Any:
        """Whether the ray is inside just before a distance, not counting what is crossed at that distance."""
        return self.before ^ (self.near < t - error - self.near_error) ^ (self.far < t - error - self.far_error)

    def after_distance(self, t: Any, error: Any) -> Any:
        """Whether the ray is inside just after a distance."""
        return self.before ^ (self.near <= t + error + self.near_error) ^ (self.far <= t + error + self.far_error)


@dataclass(frozen=True)
class Csg:
    """A Boolean expression over shapes: its surface is where the value changes along a ray.

    What is crossed at one distance is crossed together. Roth, Ray Casting for Modeling Solids, Computer Graphics and
    Image Processing 18(2), 1982, without his lists of intervals.
    """

    leaves: tuple[Leaf, ...]
    program: tuple[int, ...]

    convex = False
    bounded_first = True

    def value(self, inside: list[Any]) -> Any:
        """The expression, of which leaves a point is in."""
        stack: list[Any] = []
        for code in self.program:
            if code >= 0:
                stack.append(inside[code])
                continue
            right, left = stack.pop(), stack.pop()
            both = left & right
            stack.append(left | right if code == UNION else both if code == INTERSECTION else left ^ both)
        return stack.pop()

    def intersect(self, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool, which_piece: bool) -> Crossing:
        """Where the value first changes."""
        passages = [_leaf_passage(rows, leaf, ray, reach, by_rules) for leaf in self.leaves]
        leaves, starts_inside = self._ahead(passages, ray, reach)
        if len(leaves) <= MOST_UNROLLED:
            found = self._unrolled(leaves, ray, by_rules)
        else:
            found = _in_order(_Search(leaves, self.value), ray)
        if not by_rules:
            found.close = _is_close(passages, leaves, found, reach)
        # Where a ray is not on the side of the result that it is known to be on, it crosses another leaf at once.
        lost = own & (starts_inside != ray.inside)
        return Crossing(
            t=dr.select(lost, 0, found.t),
            enters=dr.select(lost, ~ray.inside, found.enters),
            primitive=dr.select(lost, _nearest_to_start(leaves, ray), found.primitive),
            error=found.error,
            close=found.close,
        )

    def _ahead(self, passages: list["_LeafPassage"], ray: Ray, reach: Any) -> tuple[list[_Membership], Any]:
        """What of the leaves lies ahead of a ray, and whether it starts inside.

        The leaves that it starts on share a sheet. On which side of that it travels follows from the side of the
        result: the one on which, all other leaves as they are, the value is that.
        """
        if_inside = self.value([leaf.starts_inside(~leaf.turned, ray) for leaf in passages])
        if_outside = self.value([leaf.starts_inside(leaf.turned, ray) for leaf in passages])
        inside_sheet = dr.select(if_inside != if_outside, ray.inside == if_inside, ray.inside)
        ahead = [leaf.ahead(inside_sheet ^ leaf.turned, ray, reach) for leaf in passages]
        starts_inside = dr.select(inside_sheet, if_inside, if_outside)
        return ahead, starts_inside

    def _unrolled(self, leaves: list[_Membership], ray: Ray, by_rules: bool) -> Crossing:
        """Every crossing against every leaf; of those that tie with the nearest the first counts."""
        candidates = []
        for leaf in leaves:
            for t, error, primitive, enters, known in _crossings(leaf):
                before = self.value([other.before_distance(t, error) for other in leaves])
                after = self.value([other.after_distance(t, error) for other in leaves])
                counts = (before != after) & ((t > ray.t_min) | known)
                candidates.append((dr.select(counts, t, dr.inf), error, after, _marked(primitive, enters, after)))
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


@dr.syntax
def _in_order(search: "_Search", ray: Ray) -> Crossing:
    """From one crossing to the next."""
    width = dr.width(ray.d, search.leaves[0].near)
    kind = type(ray.t_min)
    t, error = dr.full(kind, dr.inf, width), dr.zeros(kind, width)
    primitive, enters = dr.zeros(mi.UInt32, width), dr.full(mi.Bool, False, width)
    behind = dr.zeros(kind, width) + ray.t_min
    started = dr.full(mi.Bool, False, width)
    walking = dr.full(mi.Bool, True, width)
    while walking:
        # What is known to lie ahead of a ray's start may be no farther than t_min.
        next_t, next_error = dr.full(kind, dr.inf, width), dr.zeros(kind, width)
        for leaf in search.leaves:
            for distance, its_error, _, _, known in _crossings(leaf):
                ahead = (distance > behind) | (known & ~started)
                closer = ahead & (distance < next_t)
                next_error = dr.select(closer, its_error, next_error)
                next_t = dr.select(closer, distance, next_t)
        before = search.value([leaf.before_distance(next_t, next_error) for leaf in search.leaves])
        after = search.value([leaf.after_distance(next_t, next_error) for leaf in search.leaves])
        changes = before != after
        for leaf in reversed(search.leaves):
            for distance, its_error, its_primitive, its_enters, _ in _crossings(leaf):
                here = changes & (dr.abs(distance - next_t) <= its_error + next_error)
                primitive = dr.select(here, _marked(its_primitive, its_enters, after), primitive)
        t = dr.select(changes, next_t, t)
        error = dr.select(changes, next_error, error)
        enters = dr.select(changes, after, enters)
        behind = next_t
        started = dr.full(mi.Bool, True, width)
        walking &= ~changes & (next_t < dr.inf)
    return Crossing(t, enters, primitive, error, dr.full(mi.Bool, False, width))


class _Search:
    """What `_in_order` goes through: of a class in which Dr.Jit's loops do not look for their variables."""

    def __init__(self, leaves: list[_Membership], value: Callable[[list[Any]], Any]) -> None:
        self.leaves = leaves
        self.value = value


@dataclass
class _LeafPassage:
    """The passage through a leaf."""

    kind: ShapeKind
    passage: Passage
    starts: Any  # Bool, whether the ray starts on one of the leaf's sheets
    turned: Any  # Bool, whether that is turned in the leaf

    def starts_inside(self, side: Any, ray: Ray) -> Any:
        """Whether a ray starts inside the leaf, if from a sheet on the leaf's `side` of that."""
        passed = [self.passage.meets & (t <= ray.t_min) for t in (self.passage.near, self.passage.far)]
        inside = passed[0] ^ passed[1] ^ self.passage.inside_before
        if self.kind.FACETED:
            return inside & (side | ~self.starts)  # of all the other planes, and of its own
        return dr.select(self.starts, side, inside)

    def ahead(self, side: Any, ray: Ray, reach: Any) -> _Membership:
        """What lies ahead of a ray, if it starts from a sheet on the leaf's `side` of that."""
        passage, starts = self.passage, self.starts
        inside_before = before = mi.Bool(passage.inside_before)
        near, far = (dr.select(passage.meets, t, dr.inf) for t in (passage.near, passage.far))
        known = mi.Bool(False)
        if self.kind.FACETED:
            never = starts & ~side
            near, far = dr.select(never, dr.inf, near), dr.select(never, dr.inf, far)
        else:
            # From between the two crossings it comes to the other; what touches it there, it crosses at once.
            other = dr.select(side ^ before, dr.maximum(passage.far, ray.t_min), dr.inf)
            near, far = dr.select(starts, dr.inf, near), dr.select(starts, other, far)
            before = dr.select(starts, side, before)
            known = starts
        return _Membership(
            before=before,
            near=near,
            far=far,
            near_primitive=passage.near_primitive,
            far_primitive=passage.far_primitive,
            near_enters=~inside_before,
            far_enters=inside_before,
            near_error=self._error(True, near, reach),
            far_error=self._error(False, far, reach),
            known=known,
        )

    def _error(self, near: bool, t: Any, reach: Any) -> Any:
        """How far a distance may be off where ties are decided; where it is more than bounds tell, nothing is known."""
        if self.passage.error is None:
            return 0
        error, most = self.passage.error(mi.Bool(near), t), most_blur(t) * (dr.abs(t) + reach)
        return dr.select(error <= most, error, dr.select(dr.isfinite(t), most, 0))


def _leaf_passage(rows: Rows, leaf: Leaf, ray: Ray, reach: Any, by_rules: bool) -> _LeafPassage:
    own_rows = LeafRows(rows, leaf)
    starts, turned, start = mi.Bool(False), mi.Bool(False), mi.UInt32(NOTHING)
    for k, is_turned in enumerate(leaf.turned):
        primitive = own_rows.primitive(k)
        here = (ray.primitive & UPRIGHT) == (primitive & UPRIGHT)
        starts |= here
        turned |= here & is_turned
        start = dr.select(here, primitive, start)
    ray = Ray(ray.o, ray.d, ray.object, start, ray.inside, ray.t_min, ray.spread)
    return _LeafPassage(leaf.kind, _passage(leaf.kind, own_rows, ray, starts, reach, by_rules), starts, turned)


def _passage(kind: ShapeKind, rows: Rows, ray: Ray, own: Any, reach: Any, by_rules: bool) -> Passage:
    return (kind.passage_by_rules if by_rules else kind.passage)(rows, ray, own, reach)


def _crossings(leaf: _Membership) -> list[tuple[Any, Any, Any, Any, Any]]:
    """Distance, error and primitive of both, whether they enter, and whether they are known to lie ahead."""
    return [
        (leaf.near, leaf.near_error, leaf.near_primitive, leaf.near_enters, mi.Bool(False)),
        (leaf.far, leaf.far_error, leaf.far_primitive, leaf.far_enters, leaf.known),
    ]


def _marked(primitive: Any, enters_leaf: Any, enters: Any) -> Any:
    """A leaf's primitive, as the result's surface."""
    return primitive ^ dr.select(enters_leaf != enters, mi.UInt32(INVERTED), 0)


def _nearest_to_start(leaves: list[_Membership], ray: Ray) -> Any:
    """The primitive, but those that a ray starts on, whose crossing is nearest to where it starts."""
    nearest, found = type(ray.t_min)(dr.inf), mi.UInt32(0)
    for leaf in leaves:
        for t, _, primitive, enters, _ in _crossings(leaf):
            closer = dr.abs(t) < nearest
            nearest = dr.select(closer, dr.abs(t), nearest)
            found = dr.select(closer, _marked(primitive, enters, ~ray.inside), found)
    return found


def _is_close(passages: list[_LeafPassage], leaves: list[_Membership], found: Crossing, reach: Any) -> Any:
    """Whether a crossing is close to a tie: of a leaf's, or of two leaves'."""
    near = most_blur(found.t) * (reach + found.t)
    hits = found.t < dr.inf
    close = mi.Bool(False)
    for leaf in passages:
        close |= leaf.passage.close
        if leaf.passage.between is not None:
            close |= hits & (leaf.passage.between < near)
    for ahead in leaves:
        for t, _, primitive, _, _ in _crossings(ahead):
            close |= hits & ((primitive ^ found.primitive) & UPRIGHT != 0) & (dr.abs(t - found.t) <= near)
    return close


# ---- Before tracing --------------------------------------------------------------------------------------------------


def leaves_of(shapes: Iterable[tuple[ShapeKind, Shape]]) -> tuple[Leaf, ...]:
    """The leaves of an expression, with the sheets that they share."""
    sheets: dict[tuple[int, tuple[Row, ...] | None], tuple[int, bool]] = {}
    leaves, first = [], 0
    for kind, shape in shapes:
        found = []
        for k in range(0, len(shape.rows), kind.ROWS):
            rows = tuple(shape.rows[k : k + kind.ROWS])
            for turned, same in ((False, rows), (True, kind.turned(rows))):
                sheets.setdefault((id(kind), same), (first + k, turned))
            found.append(sheets[id(kind), rows])
        leaves.append(Leaf(kind, first, tuple(sheet for sheet, _ in found), tuple(turned for _, turned in found)))
        first += len(shape.rows)
    return tuple(leaves)
