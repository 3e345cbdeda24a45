"""The primitives of a scene's surfaces, as a table that kernels gather from."""

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.csg import Csg
from mitsuba_plugins.intersection.csg_search import SearchedCsg
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.leaf_table import GatheredLeaves, LeafTable
from mitsuba_plugins.intersection.motion import bring_back, motion_row, take_along
from mitsuba_plugins.intersection.passages import Crossing, crossing_if, first_crossing
from mitsuba_plugins.intersection.rays import UPRIGHT, Hit, Ray, Real, largest
from mitsuba_plugins.intersection.rows import GatheredRows
from mitsuba_plugins.intersection.shapes.kind import ShapeKind, SurfacePoint
from mitsuba_plugins.intersection.shapes.table import SHAPE_KINDS
from mitsuba_plugins.intersection.solids import Single, Solid


class Primitives:
    """The rows of all shapes, in the order of their objects."""

    def __init__(self, types: Real, surfaces: list[Surface]) -> None:
        rows: list[Any] = []
        kinds: list[ShapeKind] = []
        self.first = []
        """The index of each object's first primitive."""
        for surface in surfaces:
            self.first.append(len(rows))
            rows.extend(surface.rows)
            kinds.extend(kind for kind, shape in surface.shapes for _ in shape.rows)
        self.types = types
        self._kinds = list(dict.fromkeys(kinds)) or list(SHAPE_KINDS.values())[:1]  # of nothing any kind will do
        self._solids = list(dict.fromkeys(surface.solid for surface in surfaces)) or [Single(self._kinds[0])]
        self.any_concave = not all(solid.convex for solid in self._solids)
        """Whether rays may meet again what they leave."""
        self.any_csg = any(isinstance(solid, Csg) for solid in self._solids)
        """Whether primitives may be marked as `INVERTED`."""
        self._rows = column(types.Float, rows)
        self._kind = column(mi.UInt32, [self._kinds.index(kind) for kind in kinds])
        self._solid = column(mi.UInt32, [self._solids.index(surface.solid) for surface in surfaces])
        ruled = [surface.solid.deciding_ties() for surface in surfaces]
        self._solids_by_rules = list(dict.fromkeys(ruled)) or self._solids
        self._solid_by_rules = self._solid
        if self._solids_by_rules != self._solids:
            self._solid_by_rules = column(mi.UInt32, [self._solids_by_rules.index(solid) for solid in ruled])
        self._first = column(mi.UInt32, self.first)
        self._count = column(mi.UInt32, [len(surface.rows) for surface in surfaces])
        any_searched = any(isinstance(solid, SearchedCsg) for solid in self._solids_by_rules)
        self._leaves = LeafTable(types, surfaces, self.first) if any_searched else None
        self.any_moving = any(surface.moves for surface in surfaces)
        """Whether rays need a time."""
        self._motion = column(types.Float, [motion_row(surface) for surface in surfaces]) if self.any_moving else None
        self.object_count = mi.UInt32(len(surfaces))
        dr.make_opaque(self.object_count)

    def row(self, primitive: Any, active: Any) -> Any:
        """The four numbers of a row (Vector4), by its index."""
        return dr.gather(self.types.Vector4, self._rows, primitive, active)

    def at_rest(self, ray: Ray, index: Any, active: Any) -> Ray:
        """A ray as it meets an object, a different one for each, where that stands still."""
        return bring_back(ray, self._motion_of(index, active)) if self.any_moving else ray

    def taken_along(self, hit: Hit, ray: Ray, active: Any) -> Hit:
        """A hit on an object at rest where that is at the time of the ray."""
        return take_along(hit, ray, self._motion_of(hit.object, active)) if self.any_moving else hit

    def _motion_of(self, index: Any, active: Any) -> Any:
        return dr.gather(self.types.Vector4, self._motion, index, active)

    def leaves_of(self, index: Any, active: Any, width: int) -> GatheredLeaves:
        """The leaves of large csgs, by the indices of their objects."""
        assert self._leaves is not None
        return GatheredLeaves(self._leaves, self.row, index, active, width)

    def intersect(
        self, ray: Ray, index: Any, active: Any, reach: Any, which_piece: bool = True, by_rules: bool = False
    ) -> Crossing:
        """Where each ray crosses an object, a different one for each; `by_rules` of ties, or saying if it is close."""
        if self.any_moving:
            ray = self.at_rest(ray, index, active)
            reach = largest(ray.o)
        own = ray.object == index
        first = dr.gather(mi.UInt32, self._first, index, active)
        width = dr.width(ray.d, index)

        def intersect(solid: Solid, active: Any) -> Crossing:
            count = dr.gather(mi.UInt32, self._count, index, active)
            if isinstance(solid, SearchedCsg):
                rows: Any = self.leaves_of(index, active, width)
            else:
                rows = GatheredRows(self.row, first, count, active, width)
            asked = rows, ray, own, reach, by_rules, which_piece
            # A branch and no mask: the rays of a packet often meet objects of one kind.
            return crossing_if(active, ray, width, lambda: solid.intersect(*asked))

        if by_rules:
            return _by_kind(self._solids_by_rules, self._solid_by_rules, index, active, intersect)
        return _by_kind(self._solids, self._solid, index, active, intersect)

    def intersect_one(self, ray: Ray, index: Any, primitive: Any, active: Any, reach: Any) -> Crossing:
        """Where each ray crosses one primitive of an object, the others left away; of a csg none is."""
        if self.any_csg:
            whole = mi.Bool(False)
            for k, solid in enumerate(self._solids):
                if isinstance(solid, Csg):
                    whole |= dr.gather(mi.UInt32, self._solid, index, active) == k
            crossing = self.intersect(ray, index, active & whole, reach)
            return dr.select(whole, crossing, self._intersect_alone(ray, index, primitive, active & ~whole, reach))
        return self._intersect_alone(ray, index, primitive, active, reach)

    def _intersect_alone(self, ray: Ray, index: Any, primitive: Any, active: Any, reach: Any) -> Crossing:
        own = ray.object == index

        def intersect(kind: ShapeKind, active: Any) -> Crossing:
            rows = GatheredRows(self.row, primitive, mi.UInt32(1), active, dr.width(ray.d, index))
            return first_crossing(kind.passage(rows, ray, own, reach), ray, own, reach)

        return _by_kind(self._kinds, self._kind, primitive, active, intersect)

    def surface_at(self, ray: Ray, index: Any, primitive: Any, p: Any, active: Any, reach: Any) -> SurfacePoint:
        """The point of a primitive of object `index` nearest to a point near it that a ray has met, both at rest."""
        own = ray.object == index
        row = primitive & UPRIGHT if self.any_csg else primitive
        first = self.row(row, active)  # in one gather for all kinds

        def surface_at(kind: ShapeKind, active: Any) -> SurfacePoint:
            rows = GatheredRows(self.row, row, mi.UInt32(1), active, dr.width(ray.d, index), first)
            return kind.surface_at(rows, p, ray, own, reach)

        result: SurfacePoint = _by_kind(self._kinds, self._kind, row, active, surface_at)
        if self.any_csg:
            result.n = dr.select(primitive == row, result.n, -result.n)
        return result


def pieces(surfaces: list[Surface]) -> list[int]:
    """What number each primitive has among the smooth pieces of its object."""
    return [piece for surface in surfaces for piece in _pieces(surface)]


def _pieces(surface: Surface) -> list[int]:
    """The number of the piece that each row of an object belongs to: some kinds have several rows a piece."""
    result, first = [], 0
    for _, shape in surface.shapes:
        rows, count = len(shape.rows), len(shape.given)
        result += [first + row * count // rows for row in range(rows)]
        first += count
    return result


def _by_kind(kinds: list[Any], column: Any, index: Any, active: Any, answer: Callable[[Any, Any], Any]) -> Any:
    """What `answer(kind, active)` gives for the kind, by its number, that stands at an index of a column."""
    if len(kinds) == 1:
        return answer(kinds[0], active)
    number = dr.gather(mi.UInt32, column, index, active)
    result = None
    for k, kind in enumerate(kinds):
        chosen = number == k
        found = answer(kind, active & chosen)
        result = found if result is None else dr.select(chosen, found, result)
    return result
