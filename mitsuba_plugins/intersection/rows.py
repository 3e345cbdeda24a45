"""The rows of shapes in a kernel: gathered from the table of all primitives, or arguments of the kernel."""

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.syntax import syntax


class GatheredRows:
    """The rows of primitives from `first` on, `count` of them, that differ from ray to ray; see `Rows`."""

    def __init__(
        self, gather: Callable[[Any, Any], Any], first: Any, count: Any, active: Any, width: int, first_row: Any = None
    ) -> None:
        """Take what gathers a row by its index."""
        self._first_row = first_row
        self._gather = gather
        self._first = first
        self._count = count
        self._active = active
        self.width = width

    def primitive(self, k: int = 0) -> Any:
        """The index of the row k after the first."""
        return self._first + k if k else self._first

    def row(self, k: int = 0) -> Any:
        """The row k after the first."""
        if k == 0 and self._first_row is not None:
            return self._first_row
        return self._gather(self._first + k, self._active)

    @syntax
    def fold(self, step: Callable[[Any, Any, Any], Any], state: Any) -> Any:
        """A loop."""
        primitive = mi.UInt32(self._first) + dr.zeros(mi.UInt32, self.width)
        end = self._first + self._count
        while dr.hint(self._active & (primitive < end), exclude=[self, step, end]):
            state = step(state, primitive, self._gather(primitive, self._active))
            primitive += 1
        return state


class ListedRows:
    """Rows that are arguments of the kernel (Vector4), the same for all rays, the first with index `first`."""

    width = 1

    def __init__(self, first: int, rows: list[Any]) -> None:
        self._first = first
        self._rows = rows

    def primitive(self, k: int = 0) -> Any:
        """The index of the row k after the first."""
        return mi.UInt32(self._first + k)

    def row(self, k: int = 0) -> Any:
        """The row k after the first."""
        return self._rows[k]

    def fold(self, step: Callable[[Any, Any, Any], Any], state: Any) -> Any:
        """Code for each of them."""
        for primitive, row in enumerate(self._rows, self._first):
            state = step(state, mi.UInt32(primitive), row)
        return state
