"""Intersection of rays with a few spheres and convex polyhedra inside the kernel.

Every surface becomes its own piece of code, so that there is neither a traversal nor a call: fastest for the dozens of
surfaces of a typical course scene, and its kernel grows with their number.
"""

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.coarse import Balls
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.csg_search import SearchedCsg
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.motion import bring_back, motion_row
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.intersection.rounding import bounds_all, most_blur
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
        self._balls = Balls(types, [surface.surrounding_ball for surface in surfaces])
        self._around_lights = [s.ball is not None and not s.moves and contacts.all_within(s.ball) for s in surfaces]
        self._motions = [types.Vector4(*motion_row(surface)) if surface.moves else None for surface in surfaces]
        dr.make_opaque(self._rows, self._motions)

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """As `ExactSurfaces` has it."""
        if bounds_all(ray.t_min):
            return self._find_doubtful(ray)
        width = dr.width(ray.d)
        t_best, t_second = (dr.full(self._types.Float, dr.inf, width) for _ in range(2))
        close = dr.full(mi.Bool, False, width)
        object_best, primitive_best = dr.full(mi.UInt32, NOTHING, width), dr.zeros(mi.UInt32, width)
        found: Any = t_best, t_second, close, object_best, primitive_best

        def nearer_of(found: Any, index: int, crossing: Crossing, _: Any) -> Any:
            t_best, t_second, close, object_best, primitive_best = found
            t = crossing.t
            closer = t < t_best
            return (
                dr.select(closer, t, t_best),
                dr.select(closer, t_best, dr.select((t > t_best) & (t < t_second), t, t_second)),
                close | crossing.close,
                dr.select(closer, mi.UInt32(index), object_best),
                dr.select(closer, crossing.primitive, primitive_best),
            )

        t_best, t_second, close, object_best, primitive_best = self._each(ray, True, found, nearer_of)
        near = most_blur(t_best) * (t_best + largest(ray.o))
        close |= (t_second - t_best <= near) | (t_best < near)
        return t_best, object_best, primitive_best, close

    def _find_doubtful(self, ray: Ray) -> tuple[Any, Any, Any, Any]:
        """`find_closest` with bounds: a tie is what is within these."""
        width = dr.width(ray.d)
        t_best, other = (dr.full(self._types.Float, dr.inf, width) for _ in range(2))
        error = dr.zeros(self._types.Float, width)
        close = dr.full(mi.Bool, False, width)
        object_best, primitive_best = dr.full(mi.UInt32, NOTHING, width), dr.zeros(mi.UInt32, width)

        def nearer_of(found: Any, index: int, crossing: Crossing, _: Any) -> Any:
            t_best, error, other, close, object_best, primitive_best = found
            t, hits = crossing.t, crossing.t < dr.inf
            closer = t < t_best
            farther = dr.select(closer, t_best - error, dr.select(hits, t - crossing.error, dr.inf))
            return (
                dr.select(closer, t, t_best),
                dr.select(closer, crossing.error, error),
                dr.select(farther > other, other, farther),
                close | crossing.close,
                dr.select(closer, mi.UInt32(index), object_best),
                dr.select(closer, crossing.primitive, primitive_best),
            )

        found: Any = t_best, error, other, close, object_best, primitive_best
        t_best, error, other, close, object_best, primitive_best = self._each(ray, True, found, nearer_of)
        close |= (t_best < dr.inf) & ~(t_best + error < other)
        return t_best, object_best, primitive_best, close

    @syntax
    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """As `ExactSurfaces` has it."""
        found = dr.full(mi.UInt32, NOTHING, dr.width(ray.d))
        close = dr.full(mi.Bool, False, dr.width(ray.d))
        if dr.hint(active, exclude=[self, ray, distance, light, active]):

            def blocked_by(blocked: Any, index: int, crossing: Crossing, reach: Any) -> Any:
                found, close = blocked
                t = crossing.t
                blocks = t < distance
                apart = True
                if index in self.contacts.objects:
                    apart = ~self.contacts.lies_at(light, crossing, ray.d, active)
                    blocks &= apart
                if bounds_all(t):
                    doubtful = crossing.close | (apart & (t < dr.inf) & ~(dr.abs(t - distance) > crossing.error))
                    return dr.select(blocks & ~doubtful, mi.UInt32(index), found), close | doubtful
                close |= crossing.close | (t < most_blur(t) * reach)
                return dr.select(blocks, mi.UInt32(index), found), close

            found, close = self._each(ray, False, (found, close), blocked_by)
        return found, close

    def _each(self, ray: Ray, which_piece: bool, state: Any, step: Callable[[Any, int, Crossing, Any], Any]) -> Any:
        """`state` after `state = step(state, index, crossing, reach)` for each surface that rays may meet; if it does
        not matter `which_piece` is met, none once rays are blocked, which is first in the state.
        """
        coarse, reach = self._balls.ray(ray), largest(ray.o)
        for index, motion in enumerate(self._motions):
            at_rest, its_coarse, its_reach = ray, coarse, reach
            if motion is not None:
                at_rest = bring_back(ray, motion)
                its_coarse, its_reach = self._balls.ray(at_rest), largest(at_rest.o)

            def meet(*state: Any, index: int = index, ray: Ray = at_rest, reach: Any = its_reach) -> Any:
                return step(state, index, self._intersect(index, ray, reach, which_piece), reach)

            if not self._balls.bounds(index):
                state = meet(*state)
                continue
            # A branch and no mask: most packets of rays pass by most surfaces.
            meets = self._balls.may_meet(index, its_coarse)
            if not which_piece:
                meets &= state[0] == NOTHING
                if self._around_lights[index]:
                    meets &= ~self._balls.starts_within(index, its_coarse)
            state = dr.if_stmt(state, meets, meet, lambda *state: state)
        return state

    def _intersect(self, index: int, ray: Ray, reach: Any, which_piece: bool) -> Crossing:
        """Where rays cross one surface."""
        own = ray.object == index
        solid, rows = self._solids[index], self._rows_of(index, ray)
        return solid.intersect(rows, ray, own, reach, False, which_piece)

    def _rows_of(self, index: int, ray: Ray) -> Any:
        if isinstance(self._solids[index], SearchedCsg):
            width = dr.width(ray.d)
            return self.primitives.leaves_of(mi.UInt32(index), mi.Bool(True), width)
        return ListedRows(self.primitives.first[index], self._rows[index])
