"""The primitives of a scene's surfaces, as a table that kernels gather from."""

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.passages import Crossing, first_crossing
from mitsuba_plugins.intersection.rays import Ray, Real
from mitsuba_plugins.intersection.shapes.kind import SurfacePoint
from mitsuba_plugins.intersection.shapes.table import SHAPE_KINDS


class Primitives:
    """The rows of all shapes, in the order of their objects."""

    def __init__(self, types: Real, surfaces: list[Surface]) -> None:
        rows: list[Any] = []
        self.first = []
        """The index of each object's first primitive."""
        for surface in surfaces:
            self.first.append(len(rows))
            rows.extend(surface.shape.rows)
        self.types = types
        present = {id(surface.kind): surface.kind for surface in surfaces}
        self.any_concave = not all(kind.CONVEX for kind in present.values())
        """Whether rays may meet again what they leave."""
        self._kinds = list(present.values()) or list(SHAPE_KINDS.values())[:1]  # of nothing any kind will do
        self._rows = column(types.Float, rows)
        self._kind = column(mi.UInt32, [self._kinds.index(surface.kind) for surface in surfaces])
        self._first = column(mi.UInt32, self.first)
        self._count = column(mi.UInt32, [len(surface.shape.rows) for surface in surfaces])
        self.object_count = mi.UInt32(len(surfaces))
        dr.make_opaque(self.object_count)

    def row(self, primitive: Any, active: Any) -> Any:
        """The four numbers of a primitive (Vector4)."""
        return dr.gather(self.types.Vector4, self._rows, primitive, active)

    def intersect(
        self, ray: Ray, index: Any, active: Any, reach: Any, which_piece: bool = True, by_rules: bool = False
    ) -> Crossing:
        """Where each ray crosses an object, a different one for each; `by_rules` of ties, or saying if it is close."""
        own = ray.object == index
        first = dr.gather(mi.UInt32, self._first, index, active)

        def intersect(kind: Any, active: Any) -> Crossing:
            count = dr.gather(mi.UInt32, self._count, index, active)
            rows = GatheredRows(self, first, count, active, dr.width(ray.d, index))
            passage = (kind.passage_by_rules if by_rules else kind.passage)(rows, ray, own, reach)
            return first_crossing(passage, ray, own, reach, which_piece)

        return self._by_kind(index, active, intersect)

    def intersect_one(self, ray: Ray, index: Any, primitive: Any, active: Any, reach: Any) -> Crossing:
        """Where each ray crosses one primitive of an object, the others left away."""
        own = ray.object == index

        def intersect(kind: Any, active: Any) -> Crossing:
            rows = GatheredRows(self, primitive, mi.UInt32(1), active, dr.width(ray.d, index))
            return first_crossing(kind.passage(rows, ray, own, reach), ray, own, reach)

        return self._by_kind(index, active, intersect)

    def surface_at(self, ray: Ray, index: Any, primitive: Any, p: Any, active: Any, reach: Any) -> SurfacePoint:
        """The point of a primitive nearest to a point near it that a ray has met."""
        own = ray.object == index
        first = self.row(primitive, active)  # in one gather for all kinds

        def surface_at(kind: Any, active: Any) -> SurfacePoint:
            rows = GatheredRows(self, primitive, mi.UInt32(1), active, dr.width(ray.d, index), first)
            return kind.surface_at(rows, p, ray, own, reach)

        return self._by_kind(index, active, surface_at)

    def _by_kind(self, index: Any, active: Any, answer: Callable[[Any, Any], Any]) -> Any:
        """What `answer(kind, active)` gives for the kind of each object."""
        if len(self._kinds) == 1:
            return answer(self._kinds[0], active)
        number = dr.gather(mi.UInt32, self._kind, index, active)
        result = None
        for k, kind in enumerate(self._kinds):
            chosen = number == k
            found = answer(kind, active & chosen)
            result = found if result is None else dr.select(chosen, found, result)
        return result


class GatheredRows:
    """The rows of primitives from `first` on, `count` of them, that differ from ray to ray; see `Rows`."""

    def __init__(
        self, primitives: Primitives, first: Any, count: Any, active: Any, width: int, first_row: Any = None
    ) -> None:
        self._first_row = first_row
        self._primitives = primitives
        self._first = first
        self._count = count
        self._active = active
        self.width = width

    def primitive(self) -> Any:
        """The index of the first."""
        return self._first

    def row(self, k: int = 0) -> Any:
        """The row k after the first."""
        if k == 0 and self._first_row is not None:
            return self._first_row
        return self._primitives.row(self._first + k, self._active)

    @dr.syntax
    def fold(self, step: Callable[[Any, Any, Any], Any], state: Any) -> Any:
        """A loop."""
        primitive = mi.UInt32(self._first) + dr.zeros(mi.UInt32, self.width)
        end = self._first + self._count
        while self._active & (primitive < end):
            state = step(state, primitive, self._primitives.row(primitive, self._active))
            primitive += 1
        return state


class ListedRows:
    """Rows that are arguments of the kernel (Vector4), the same for all rays, the first with index `first`."""

    width = 1

    def __init__(self, first: int, rows: list[Any]) -> None:
        self._first = first
        self._rows = rows

    def primitive(self) -> Any:
        """The index of the first."""
        return mi.UInt32(self._first)

    def row(self, k: int = 0) -> Any:
        """The row k after the first."""
        return self._rows[k]

    def fold(self, step: Callable[[Any, Any, Any], Any], state: Any) -> Any:
        """Code for each of them."""
        for primitive, row in enumerate(self._rows, self._first):
            state = step(state, mi.UInt32(primitive), row)
        return state
