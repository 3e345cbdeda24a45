"""Intersection of rays with any number of spheres and convex polyhedra inside the kernel, through a tree of boxes."""

from collections.abc import Callable
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.apart import ApartSurfaces
from mitsuba_plugins.intersection.box_tree import BoxTree
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.faces import Parts
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.intersection.rounding import bounds_all, most_blur
from mitsuba_plugins.intersection.surfaces import ExactSurfaces
from mitsuba_plugins.syntax import syntax

Meet = Callable[[Any, Any, Crossing, Any], Any]
"""What a search has found, a tuple, after `found, index, crossing, tested`: its `tested` rays cross object `index`."""


class BvhSurfaces(ExactSurfaces):
    """Surfaces in a tree of boxes, but those that nearly every ray meets."""

    def __init__(self, types: Real, surfaces: list[Surface], primitives: Primitives, contacts: LightContacts) -> None:
        self._types = types
        self._parts = Parts(types, surfaces, primitives)
        self._apart = ApartSurfaces(types, surfaces, primitives, contacts)
        apart = [self._parts.objects.index(index) for index in self._apart.objects]
        self._tree = BoxTree(types, self._parts.boxes, self._parts.objects, apart)
        # By the rules for ties objects are met as a whole.
        objects = BoxTree(types, [surface.swept for surface in surfaces]) if self._parts.any_faces else self._tree
        super().__init__(primitives, contacts, objects)

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """As `ExactSurfaces` has it."""
        if bounds_all(ray.t_min):
            return self._find_doubtful(ray, active)
        width, reach = dr.width(ray.d), largest(ray.o)
        infinity = dr.full(self._types.Float, dr.inf, width)
        nobody, close = dr.full(mi.UInt32, NOTHING, width), dr.full(mi.Bool, False, width)

        def meet(found: Any, index: Any, crossing: Crossing, tested: Any) -> Any:
            t_best, object_best, primitive_best, t_second, close = found
            t = crossing.t
            # Of surfaces at the same distance the first counts.
            ties = (t == t_best) & (object_best != NOTHING) & (index < object_best)
            closer = tested & ((t < t_best) | ties)
            farther = dr.select(t < t_best, t_best, dr.select(t > t_best, t, dr.inf))
            return (
                dr.select(closer, t, t_best),
                dr.select(closer, index, object_best),
                dr.select(closer, crossing.primitive, primitive_best),
                dr.select(tested & (farther < t_second), farther, t_second),
                close | (tested & (crossing.close | (t < most_blur(t) * reach))),
            )

        start: Any = infinity, nobody, dr.zeros(mi.UInt32, width), self._types.Float(infinity), close
        found = self._search(ray, active, start, meet, lambda found: found[0], nearest=True)
        t_best, object_best, primitive_best, t_second, close = found
        near = most_blur(t_best) * (t_best + reach)
        close |= (t_second - t_best <= near) | (t_best < near)
        return t_best, object_best, primitive_best, close

    def _find_doubtful(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """`find_closest` with bounds: a tie is what is within these."""
        width = dr.width(ray.d)
        infinity, error = dr.full(self._types.Float, dr.inf, width), dr.zeros(self._types.Float, width)
        nobody, close = dr.full(mi.UInt32, NOTHING, width), dr.full(mi.Bool, False, width)

        def meet(found: Any, index: Any, crossing: Crossing, tested: Any) -> Any:
            # The least that the distance of any `other` may be, too.
            t_best, object_best, primitive_best, error, other, close = found
            t = crossing.t
            hits = tested & (t < dr.inf)
            closer = hits & (t < t_best)
            farther = dr.select(closer, t_best - error, dr.select(hits, t - crossing.error, dr.inf))
            return (
                dr.select(closer, t, t_best),
                dr.select(closer, index, object_best),
                dr.select(closer, crossing.primitive, primitive_best),
                dr.select(closer, crossing.error, error),
                dr.select(farther > other, other, farther),
                close | (tested & crossing.close),
            )

        start: Any = infinity, nobody, dr.zeros(mi.UInt32, width), error, self._types.Float(infinity), close
        found = self._search(ray, active, start, meet, lambda found: found[0] + found[3], nearest=True)
        t_best, object_best, primitive_best, error, other, close = found
        close |= (t_best < dr.inf) & ~(t_best + error < other)
        return t_best, object_best, primitive_best, close

    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """As `ExactSurfaces` has it."""
        width, reach = dr.width(ray.d), largest(ray.o)

        def meet(found: Any, index: Any, crossing: Crossing, tested: Any) -> Any:
            blocker, close = found
            t = crossing.t
            if bounds_all(distance):
                apart = tested & (t < dr.inf)
                apart &= ~self.contacts.lies_at(light, crossing, ray.d, apart)
                doubtful = (tested & crossing.close) | (apart & ~(dr.abs(t - distance) > crossing.error))
                return dr.select(apart & (t < distance) & ~doubtful, index, blocker), close | doubtful
            blocks = tested & (t < distance)
            blocks &= ~self.contacts.lies_at(light, crossing, ray.d, blocks)
            close |= tested & (crossing.close | (t < most_blur(t) * reach))
            return dr.select(blocks, index, blocker), close

        start: Any = dr.full(mi.UInt32, NOTHING, width), dr.full(mi.Bool, False, width)
        # Nothing once something is found: of a loop's state all has to change.
        found: tuple[Any, Any] = self._search(
            ray, active, start, meet, lambda found: dr.select(found[0] == NOTHING, distance, 0), nearest=False
        )
        return found

    @syntax
    def _search(
        self, ray: Ray, active: Any, found: Any, meet: Meet, limit_of: Callable[[Any], Any], nearest: bool
    ) -> Any:
        """What is `found` after `found = meet(found, ...)` for what rays may meet before a distance, `limit_of(found)`:
        of everything the `nearest`, or else something, until found[0] is an object.
        """
        reach, walk, node, part, skipped, searching = self._start(ray, active)
        if dr.hint(nearest, mode="scalar"):
            found = self._apart.cross(ray, reach, found, meet)
        else:
            found = self._apart.block(ray, reach, searching, found, meet)
            searching &= found[0] == NOTHING
        limit = self._tree.limit(limit_of(found))
        while dr.hint(searching, exclude=[self, ray, meet, limit_of, reach, walk, skipped]):
            tested = searching & (part != NOTHING)
            index = self._parts.object(part, tested)
            if dr.hint(tested, exclude=[self, ray, meet, limit_of, reach, walk, skipped, part, index, tested]):
                crossing = self._parts.intersect(ray, part, index, tested, reach, nearest)
                found = meet(found, index, crossing, tested)
                limit = self._tree.limit(limit_of(found))
            if dr.hint(not nearest, mode="scalar"):
                searching &= found[0] == NOTHING
            part, node = self._tree.next(walk, node, limit, skipped, searching)
            searching &= part != NOTHING
        return found

    def _start(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any, Any, Any]:
        """How a search begins: the largest coordinate of rays' origins, the walk through the tree and its first node,
        what is tested before, the object that is then passed over, and which rays search.
        """
        walk = self._tree.walk(ray)
        # First the object that the ray travels inside, or leaves: a convex one it does not meet again.
        whole, skipped = self._parts.whole(ray.object), ray.object
        part = whole if self.primitives.any_concave else dr.select(ray.inside, whole, NOTHING)
        if self._parts.any_faces:
            # From inside it meets the faces.
            skipped = dr.select(ray.inside & (whole == NOTHING), NOTHING, skipped)
        part = dr.select(self._apart.holds(ray.object), NOTHING, part)
        node = mi.UInt32(walk.start + len(self._apart.objects))
        return largest(ray.o), walk, node, part, skipped, mi.Bool(active)
