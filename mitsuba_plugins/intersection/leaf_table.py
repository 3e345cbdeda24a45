"""The leaves of large csgs, as a table that kernels gather from."""

import math
from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.csg_search import SearchedCsg
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.rays import INVERTED, NOTHING, UPRIGHT, Ray, Real
from mitsuba_plugins.intersection.rows import GatheredRows
from mitsuba_plugins.intersection.shapes.kind import Shape, ShapeKind


class LeafTable:
    """The leaves of all `SearchedCsg`, in the order of their objects, and the sheets of their rows."""

    def __init__(self, types: Real, surfaces: list[Surface], first_rows: list[int]) -> None:
        """Take the surfaces, and the index of each one's first row."""
        numbers: dict[int, int] = {}
        self.kinds: list[ShapeKind] = []
        """Those that there are."""
        first_leaf: list[int] = []
        kinds: list[int] = []
        firsts: list[int] = []
        counts: list[int] = []
        bounds: list[float] = []
        sheets = list(range(sum(len(surface.rows) for surface in surfaces)))
        for surface, row in zip(surfaces, first_rows, strict=True):
            first_leaf.append(len(kinds))
            solid = surface.solid.deciding_ties()
            if not isinstance(solid, SearchedCsg):
                continue
            for leaf, (_, shape) in zip(solid.leaves, surface.shapes, strict=True):
                if id(leaf.kind) not in numbers:
                    numbers[id(leaf.kind)] = len(self.kinds)
                    self.kinds.append(leaf.kind)
                kinds.append(numbers[id(leaf.kind)])
                firsts.append(row + leaf.first)
                counts.append(len(leaf.sheets))
                bounds.extend(_sphere_around(shape))
                for k, (sheet, turned) in enumerate(zip(leaf.sheets, leaf.turned, strict=True)):
                    sheets[row + leaf.first + k * leaf.kind.ROWS] = (row + sheet) | (INVERTED if turned else 0)
        self.types = types
        self.first_leaf = column(mi.UInt32, first_leaf)
        """The number of each object's first leaf."""
        self.bound = column(types.Float, bounds)
        self.kind, self.first, self.count, self.sheet = (
            column(mi.UInt32, numbers) for numbers in (kinds, firsts, counts, sheets)
        )


def _sphere_around(shape: Shape) -> tuple[float, float, float, float]:
    """Centre and radius, infinite where there is no box."""
    if shape.box is None:
        return 0, 0, 0, math.inf
    low, high = shape.box
    x, y, z = ((a + b) / 2 for a, b in zip(low, high, strict=True))
    return x, y, z, math.dist(low, high) / 2


class GatheredLeaves:
    """The leaves of one csg for each ray; see `Leaves`."""

    def __init__(self, table: LeafTable, row: Callable[[Any, Any], Any], index: Any, active: Any, width: int) -> None:
        """Take the csgs' objects, and what gathers rows."""
        self._table = table
        self._row = row
        self._first_leaf = dr.gather(mi.UInt32, table.first_leaf, index, active)
        self._active = active
        self.kinds = table.kinds
        self.width = width

    def kind(self, k: Any) -> Any:
        """Which of `kinds` leaf k is."""
        return dr.gather(mi.UInt32, self._table.kind, self._first_leaf + k, self._active)

    def range(self, k: Any) -> tuple[Any, Any]:
        """The first row of leaf k, and the number of its primitives."""
        return tuple(
            dr.gather(mi.UInt32, numbers, self._first_leaf + k, self._active)
            for numbers in (self._table.first, self._table.count)
        )

    def bound(self, k: Any) -> Any:
        """A sphere around leaf k, its centre and radius."""
        return dr.gather(self._table.types.Vector4, self._table.bound, self._first_leaf + k, self._active)

    def rows(self, first: Any, count: Any) -> "GatheredSheets":
        """The rows of a leaf with this range, for all rays."""
        return GatheredSheets(self._table, self._row, first, count)


class GatheredSheets(GatheredRows):
    """The rows of a leaf, with their sheets; see `SheetRows`."""

    def __init__(self, table: LeafTable, row: Callable[[Any, Any], Any], first: Any, count: Any) -> None:
        super().__init__(row, first, count, mi.Bool(True), dr.width(first))
        self._table = table

    def primitive(self, k: int = 0) -> Any:
        """The sheet of the row k after the first."""
        return self._sheet(super().primitive(k))

    def fold(self, step: Callable[[Any, Any, Any], Any], state: Any) -> Any:
        """A loop."""
        return super().fold(lambda state, primitive, row: step(state, self._sheet(primitive), row), state)

    def start(self, ray: Ray) -> tuple[Any, Any, Any]:
        """As `SheetRows` has it."""

        def look(state: tuple[Any, Any, Any], primitive: Any, row: Any) -> tuple[Any, Any, Any]:
            starts, turned, start = state
            here = (ray.primitive & UPRIGHT) == (primitive & UPRIGHT)
            return starts | here, turned | (here & (primitive >= INVERTED)), dr.select(here, primitive, start)

        nowhere = dr.full(mi.Bool, False, self.width)
        return self.fold(look, (nowhere, nowhere, dr.full(mi.UInt32, NOTHING, self.width)))

    def _sheet(self, primitive: Any) -> Any:
        return dr.gather(mi.UInt32, self._table.sheet, primitive)
