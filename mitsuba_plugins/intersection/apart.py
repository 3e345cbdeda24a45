"""Objects that have no bounds, or that nearly every ray meets: a tree of boxes spares no ray their tests, so they have
code of their own, as all objects of a small scene have.

Most of them are in the way of no light: what surrounds all lights, such as a sky or a room, or lies behind them all,
such as a floor, is not met between a light and a point that is on the same side.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins.intersection.coarse import unit_scale
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.intersection.rounding import bounds_all
from mitsuba_plugins.intersection.rows import ListedRows
from mitsuba_plugins.intersection.solids import Single

MOST_ROWS = 16
"""Of all objects that are apart: kernels grow with them."""
LARGE = 0.5
"""Of the surface of the box around all that are in the tree. A box of more is met by more than half of the rays."""
ROOM = 2.0**-16
"""Relative to coordinates, how far from a surface rays start that are known to start on one side of it."""


class _Side(NamedTuple):
    """On which side of an object all lights are."""

    inside: bool
    rows: list[Any]
    """Of a ball its centre and radius (Point3f, Float), of a polyhedron its planes (Vector3f, Float); scaled."""


class ApartSurfaces:
    """Surfaces whose numbers are kernel arguments."""

    def __init__(self, types: Real, surfaces: list[Surface], primitives: Primitives, contacts: LightContacts) -> None:
        self.objects = apart_of(surfaces)
        """Their indices, ascending."""
        its = [surfaces[index] for index in self.objects]
        self._solids = [surface.solid for surface in its]
        self._kinds = [surface.shapes[0][0] for surface in its]
        self._first = [primitives.first[index] for index in self.objects]
        self._rows = [[types.Vector4(*row) for row in surface.rows] for surface in its]
        scale = unit_scale(abs(x) for surface in its for x in surface.ball or [row[3] for row in surface.rows])
        self._scale = types.Float(scale)
        self._sides = [_side(surface, contacts, scale) for surface in its]
        dr.make_opaque(self._rows, self._scale, [side.rows for side in self._sides if side is not None])

    def holds(self, index: Any) -> Any:
        """Whether an object is one of them."""
        found = mi.Bool(False)
        for own in self.objects:
            found |= index == own
        return found

    def cross(self, ray: Ray, reach: Any, found: Any, meet: Callable[[Any, Any, Crossing, Any], Any]) -> Any:
        """What is `found` after `found = meet(found, index, crossing, tested)` for each of them."""
        for k, index in enumerate(self.objects):
            found = meet(found, mi.UInt32(index), self._intersect(k, ray, reach, True), mi.Bool(True))
        return found

    def block(
        self, ray: Ray, reach: Any, active: Any, found: Any, meet: Callable[[Any, Any, Crossing, Any], Any]
    ) -> Any:
        """The same for those that may be in the way of a light, until found[0] is an object."""
        o = mi.Point3f(ray.o * self._scale)
        room = (largest(o) + 1) * ROOM
        if bounds_all(ray.t_min):
            room += (ray.t_min + ray.shift) * self._scale
        for k, index in enumerate(self.objects):
            # A branch and no mask: most packets of rays are on the lights' side.
            tested = active & (found[0] == NOTHING) & ~self._starts_beside_lights(k, ray, o, room)

            def test(*found: Any, k: int = k, index: int = index, tested: Any = tested) -> Any:
                return meet(found, mi.UInt32(index), self._intersect(k, ray, reach, False), tested)

            found = dr.if_stmt(found, tested, test, lambda *found: found)
        return found

    def _starts_beside_lights(self, k: int, ray: Ray, o: Any, room: Any) -> Any:
        """Whether rays start on that side of an object on which all lights are, given their scaled origins, and how far
        these may be off.
        """
        side = self._sides[k]
        if side is None:
            return mi.Bool(False)
        # Of what is beyond all measure nothing is known: comparisons with NaN are false.
        if self._kinds[k].FACETED:
            beside = mi.Bool(True)
            for normal, offset in side.rows:
                height = dr.dot(normal, o) + offset
                beside &= (-height if side.inside else height) > room + ROOM * dr.abs(offset)
        else:
            ((center, radius),) = side.rows
            inner = radius * (1 - ROOM) - room
            beside = (dr.squared_norm(center - o) < dr.square(inner)) & (inner > 0)
        # What faces a light on the surface itself is on the light's side of it.
        return beside | (ray.object == self.objects[k])

    def _intersect(self, k: int, ray: Ray, reach: Any, which_piece: bool) -> Crossing:
        own = ray.object == self.objects[k]
        return self._solids[k].intersect(ListedRows(self._first[k], self._rows[k]), ray, own, reach, False, which_piece)


def apart_of(surfaces: Sequence[Surface]) -> list[int]:
    """The indices of the objects that are to be apart: no csgs, and none that moves."""
    fit = {k for k, surface in enumerate(surfaces) if isinstance(surface.solid, Single) and not surface.moves}
    boxes = {k: np.array(surface.swept) for k, surface in enumerate(surfaces) if surface.swept is not None}
    chosen = sorted(fit - boxes.keys())
    by_size = sorted(boxes, key=lambda k: -_area(boxes[k]))
    for at, k in enumerate(by_size[:-1]):
        rest = np.array([boxes[other] for other in by_size[at:]])
        around = np.array([rest[:, 0].min(axis=0), rest[:, 1].max(axis=0)])
        if k not in fit or not _area(boxes[k]) > LARGE * _area(around):
            break
        chosen.append(k)
    counts = np.cumsum([len(surfaces[k].rows) for k in chosen])
    return sorted(chosen[: np.searchsorted(counts, MOST_ROWS, side="right")])


def _area(box: Any) -> float:
    (a, b, c), (d, e, f) = box.tolist()  # Python's numbers overflow without a warning
    x, y, z = d - a, e - b, f - c
    return x * y + y * z + z * x


def _side(surface: Surface, contacts: LightContacts, scale: float) -> _Side | None:
    """None where the lights are not on one side, or nothing tells."""
    if surface.ball is not None:
        x, y, z, radius = (number * scale for number in surface.ball)
        return _Side(True, [(mi.Point3f(x, y, z), mi.Float(radius))]) if contacts.all_within(surface.ball) else None
    if not surface.shapes[0][0].FACETED:
        return None
    planes = [(mi.Vector3f(*normal), mi.Float(offset * scale)) for *normal, offset in surface.rows]
    if all(contacts.all_beside(row, inside=True) for row in surface.rows):
        return _Side(True, planes)
    if len(planes) == 1 and contacts.all_beside(surface.rows[0], inside=False):
        return _Side(False, planes)
    return None
