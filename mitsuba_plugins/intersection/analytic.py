"""Intersection of rays with a few spheres and convex polyhedra inside the kernel.

Every surface becomes its own piece of code, so that there is neither a traversal nor a call: fastest for the dozens of
surfaces of a typical course scene, and its kernel grows with their number.
"""

import math
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.csg_search import SearchedCsg
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.motion import bring_back, motion_row
from mitsuba_plugins.intersection.passages import Crossing, crossing_if
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.intersection.rows import ListedRows
from mitsuba_plugins.intersection.surfaces import ExactSurfaces
from mitsuba_plugins.syntax import syntax


class AnalyticSurfaces(ExactSurfaces):
    """Surfaces whose numbers are kernel arguments: scenes that differ in numbers only share one compiled kernel."""

    def __init__(self, types: Real, surfaces: list[Surface], primitives: Primitives, contacts: LightContacts) -> None:
        super().__init__(primitives, contacts)
        self._types = types
        self._solids = [surface.solid for surface in surfaces]
        self._rows = [[types.Vector4(*row) for row in surface.rows] for surface in surfaces]
        self._bounds = [self._bound(surface) for surface in surfaces]
        self._motions = [types.Vector4(*motion_row(surface)) if surface.moves else None for surface in surfaces]
        dr.make_opaque(self._rows, self._bounds, self._motions)

    def _bound(self, surface: Surface) -> tuple[Any, Any] | None:
        """Centre and radius of a sphere around a bounded surface, if it is worth its test."""
        if surface.box is None or not surface.solid.bounded_first:
            return None
        low, high = surface.box
        center = ((a + b) / 2 for a, b in zip(low, high, strict=True))
        return self._types.Point3(*center), self._types.Float(math.dist(low, high) / 2)

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """As `ExactSurfaces` has it."""
        reach = largest(ray.o)
        t_best, t_second = self._types.Float(dr.inf), self._types.Float(dr.inf)
        close = mi.Bool(False)
        object_best = mi.UInt32(NOTHING)
        primitive_best = mi.UInt32(0)
        for index in range(len(self._solids)):
            crossing = self._intersect(index, ray, reach, which_piece=True)
            t = crossing.t
            close |= crossing.close
            closer = t < t_best
            t_second = dr.select(closer, t_best, dr.select((t > t_best) & (t < t_second), t, t_second))
            t_best = dr.select(closer, t, t_best)
            object_best = dr.select(closer, index, object_best)
            primitive_best = dr.select(closer, crossing.primitive, primitive_best)
        near = most_blur(t_best) * (t_best + reach)
        close |= (t_second - t_best <= near) | (t_best < near)
        return t_best, object_best, primitive_best, close

    @syntax
    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """As `ExactSurfaces` has it."""
        found = dr.full(mi.UInt32, NOTHING, dr.width(ray.d))
        close = dr.full(mi.Bool, False, dr.width(ray.d))
        if dr.hint(active, exclude=[self, ray, distance, light, active]):
            reach = largest(ray.o)
            for index in range(len(self._solids)):
                crossing = self._intersect(index, ray, reach, which_piece=False)
                t = crossing.t
                close |= crossing.close | (t < most_blur(t) * reach)
                blocks = t < distance
                if dr.hint(index in self.contacts.objects, mode="scalar"):
                    blocks &= ~self.contacts.lies_at(light, crossing, ray.d, active)
                found = dr.select(blocks, mi.UInt32(index), found)
        return found, close

    def _intersect(self, index: int, ray: Ray, reach: Any, which_piece: bool) -> Crossing:
        """Where rays cross one surface."""
        motion = self._motions[index]
        if motion is not None:
            ray = bring_back(ray, motion)
            reach = largest(ray.o)
        bound = self._bounds[index]
        if bound is None:
            return self._intersect_rows(index, ray, reach, which_piece)
        # A branch and no mask: most packets of rays pass by most surfaces and save their primitives.
        center, radius = bound
        f = ray.o - center
        b = -dr.dot(f, ray.d)
        meets = (dr.squared_norm(f + b * ray.d) <= radius * radius) & (b > -radius)
        return crossing_if(meets, ray, dr.width(ray.d), lambda: self._intersect_rows(index, ray, reach, which_piece))

    def _intersect_rows(self, index: int, ray: Ray, reach: Any, which_piece: bool) -> Crossing:
        own = ray.object == index
        solid, rows = self._solids[index], self._rows_of(index, ray)
        return solid.intersect(rows, ray, own, reach, False, which_piece)

    def _rows_of(self, index: int, ray: Ray) -> Any:
        if isinstance(self._solids[index], SearchedCsg):
            width = dr.width(ray.d)
            return self.primitives.leaves_of(mi.UInt32(index), mi.Bool(True), width)
        return ListedRows(self.primitives.first[index], self._rows[index])
