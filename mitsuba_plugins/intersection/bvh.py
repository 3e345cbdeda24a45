"""Intersection of rays with any number of spheres and convex polyhedra inside the kernel, through a tree of boxes."""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.box_tree import BoxTree
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.faces import Parts
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.intersection.rounding import bounds_all, most_blur
from mitsuba_plugins.intersection.surfaces import ExactSurfaces
from mitsuba_plugins.syntax import syntax


class BvhSurfaces(ExactSurfaces):
    """Surfaces in a tree of boxes."""

    def __init__(self, types: Real, surfaces: list[Surface], primitives: Primitives, contacts: LightContacts) -> None:
        self._types = types
        self._parts = Parts(types, surfaces, primitives)
        self._tree = BoxTree(types, self._parts.boxes, self._parts.objects)
        # By the rules for ties objects are met as a whole.
        objects = BoxTree(types, [surface.swept for surface in surfaces]) if self._parts.any_faces else self._tree
        super().__init__(primitives, contacts, objects)

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """As `ExactSurfaces` has it."""
        if bounds_all(ray.t_min):
            return self._doubtful_search(ray, self._types.Float(dr.inf), None, active)
        return self._search(ray, self._types.Float(dr.inf), None, active)

    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """As `ExactSurfaces` has it."""
        search = self._doubtful_search if bounds_all(distance) else self._search
        _, found, _, close = search(ray, distance, light, active)
        return found, close

    def _start(self, ray: Ray, t: Any, active: Any) -> tuple[Any, Any, Any, Any, Any, Any, Any]:
        """How a search begins: the largest coordinate of rays' origins, the limit for hits before `t`, the walk and its
        first node, what is tested before, the object that is then passed over, and which rays search.
        """
        walk = self._tree.walk(ray)
        # First the object that the ray travels inside, or leaves: a convex one it does not meet again.
        whole, skipped = self._parts.whole(ray.object), ray.object
        part = whole if self.primitives.any_concave else dr.select(ray.inside, whole, NOTHING)
        if self._parts.any_faces:
            # From inside it meets the faces.
            skipped = dr.select(ray.inside & (whole == NOTHING), NOTHING, skipped)
        return largest(ray.o), self._tree.limit(t), walk, mi.UInt32(walk.start), part, skipped, mi.Bool(active)

    @syntax
    def _search(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any, Any, Any]:
        """What is met first before `distance`; with a light there, anything that is in its way."""
        width = dr.width(ray.d)
        t_best = dr.zeros(self._types.Float, width) + distance
        object_best = dr.full(mi.UInt32, NOTHING, width)
        primitive_best = dr.zeros(mi.UInt32, width)
        t_second = dr.full(self._types.Float, dr.inf, width) if light is None else None
        close = dr.full(mi.Bool, False, width)
        reach, limit, walk, node, part, skipped, searching = self._start(ray, t_best, active)
        while dr.hint(searching, exclude=[self, ray, distance, light, reach, walk, skipped]):
            tested = searching & (part != NOTHING)
            index = self._parts.object(part, tested)
            if dr.hint(tested, exclude=[self, ray, distance, light, reach, walk, skipped, part, index, tested]):
                crossing = self._parts.intersect(ray, part, index, tested, reach, light is None)
                t, primitive = crossing.t, crossing.primitive
                close |= tested & (crossing.close | (t < most_blur(t) * reach))
                # Of surfaces at the same distance the first counts.
                ties = (t == t_best) & (object_best != NOTHING) & (index < object_best)
                closer = tested & ((t < t_best) | ties)
                if dr.hint(light is not None, mode="scalar"):
                    closer &= ~self.contacts.lies_at(light, crossing, ray.d, closer)
                if dr.hint(light is None, mode="scalar"):
                    farther = dr.select(t < t_best, t_best, dr.select(t > t_best, t, dr.inf))
                    t_second = dr.select(tested & (farther < t_second), farther, t_second)
                t_best = dr.select(closer, t, t_best)
                object_best = dr.select(closer, index, object_best)
                primitive_best = dr.select(closer, primitive, primitive_best)
                limit = self._tree.limit(t_best)
            if dr.hint(light is not None, mode="scalar"):
                searching &= object_best == NOTHING
            part, node = self._tree.next(walk, node, limit, skipped, searching)
            searching &= part != NOTHING
        if dr.hint(light is None, mode="scalar"):
            near = most_blur(t_best) * (t_best + reach)
            close |= (t_second - t_best <= near) | (t_best < near)
        return t_best, object_best, primitive_best, close

    @syntax
    def _doubtful_search(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any, Any, Any]:
        """`_search` with bounds: a tie is what is within these."""
        width = dr.width(ray.d)
        t_best = dr.zeros(self._types.Float, width) + distance
        error = dr.zeros(self._types.Float, width)
        other = dr.full(self._types.Float, dr.inf, width)  # the least that the distance of any other may be
        object_best, primitive_best = dr.full(mi.UInt32, NOTHING, width), dr.zeros(mi.UInt32, width)
        close = dr.full(mi.Bool, False, width)
        reach, limit, walk, node, index, skipped, searching = self._start(ray, t_best, active)
        while dr.hint(searching, exclude=[self, ray, walk, distance, light, reach, skipped]):
            tested = searching & (index != NOTHING)
            if dr.hint(tested, exclude=[self, ray, distance, light, reach, walk, skipped, index, tested]):
                crossing = self.primitives.intersect(ray, index, tested, reach, which_piece=light is None)
                t = crossing.t
                hits = tested & (t < dr.inf)
                if dr.hint(light is None, mode="scalar"):
                    close |= tested & crossing.close
                    closer = hits & (t < t_best)
                    farther = dr.select(closer, t_best - error, dr.select(hits, t - crossing.error, dr.inf))
                    other = dr.select(farther > other, other, farther)
                    error = dr.select(closer, crossing.error, error)
                    t_best = dr.select(closer, t, t_best)
                else:
                    apart = hits & ~self.contacts.lies_at(light, crossing, ray.d, hits)
                    doubtful = tested & crossing.close
                    doubtful |= apart & ~(dr.abs(t - distance) > crossing.error)
                    close |= doubtful
                    closer = apart & (t < distance) & ~doubtful
                object_best = dr.select(closer, index, object_best)
                primitive_best = dr.select(closer, crossing.primitive, primitive_best)
                limit = self._tree.limit(t_best + error)
            if dr.hint(light is not None, mode="scalar"):
                searching &= object_best == NOTHING
            index, node = self._tree.next(walk, node, limit, skipped, searching)
            searching &= index != NOTHING
        if dr.hint(light is None, mode="scalar"):
            close |= (t_best < dr.inf) & ~(t_best + error < other)
        return t_best, object_best, primitive_best, close
