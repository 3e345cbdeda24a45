"""A leaf of a csg along a ray: where it is crossed, and whether the ray is inside before."""

from dataclasses import dataclass
from typing import Any, Protocol

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.passages import Passage
from mitsuba_plugins.intersection.rays import INVERTED, Ray
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.intersection.shapes.kind import Rows, ShapeKind, passage_of


class SheetRows(Rows, Protocol):
    """The rows of a leaf. In the place of its primitives stand their sheets.

    A sheet is the first primitive of the expression that is the same set of points, marked as `INVERTED` if its inside
    is the primitive's outside: so that coincident faces are crossed together, and left together.
    """

    def start(self, ray: Ray) -> tuple[Any, Any, Any]:
        """Whether a ray starts on one of them (Bool), whether that is turned (Bool), and which it is (UInt32)."""
        ...


@dataclass
class Membership:
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

    def crossings(self) -> list[tuple[Any, Any, Any, Any, Any]]:
        """Distance, error and primitive of both, whether they enter, and whether they are known to lie ahead."""
        return [
            (self.near, self.near_error, self.near_primitive, self.near_enters, mi.Bool(False)),
            (self.far, self.far_error, self.far_primitive, self.far_enters, self.known),
        ]


@dataclass
class LeafPassage:
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

    def ahead(self, side: Any, ray: Ray, reach: Any) -> Membership:
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
        return Membership(
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


def leaf_passage(kind: ShapeKind, rows: SheetRows, ray: Ray, reach: Any, by_rules: bool) -> LeafPassage:
    """A leaf's; `by_rules` of ties, or else saying whether that is close to one."""
    starts, turned, start = rows.start(ray)
    ray = Ray(ray.o, ray.d, ray.object, start, ray.inside, ray.t_min, ray.spread)
    return LeafPassage(kind, passage_of(kind, rows, ray, starts, reach, by_rules), starts, turned)


def marked(primitive: Any, enters_leaf: Any, enters: Any) -> Any:
    """A leaf's primitive, as the surface of the csg, which the ray enters or leaves there."""
    return primitive ^ dr.select(enters_leaf != enters, mi.UInt32(INVERTED), 0)
