"""The same searches as everywhere, by the format's rules for ties, for the rays that are close to some."""

from dataclasses import replace
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, largest
from mitsuba_plugins.intersection.rounding import most_blur


class Ties:
    """Searches all objects in turn."""

    def __init__(self, primitives: Primitives, contacts: LightContacts) -> None:
        self._primitives = primitives
        self._contacts = contacts

    @dr.syntax
    def closest(self, ray: Ray, t: Any, index: Any, primitive: Any, close: Any) -> tuple[Any, Any, Any]:
        """Distance, object and primitive of the first hit: where rays are not close to a tie as they were found."""
        if close:
            width = dr.width(close)
            count = self._primitives.object_count
            # The first object of those that tie with the nearest: also where one ties with two that do not tie with one
            # another, the order in which they are visited does not matter.
            nearest = dr.full(type(t), dr.inf, width)
            error = dr.zeros(type(t), width)
            tested = dr.zeros(mi.UInt32, width)
            while close & (tested < count):
                met = self._intersect(ray, tested, close)
                error = dr.select((met.t < nearest) | ((met.t == nearest) & (met.error > error)), met.error, error)
                nearest = dr.minimum(met.t, nearest)
                tested += 1
            t = dr.full(type(t), dr.inf, width)
            index = dr.full(mi.UInt32, NOTHING, width)
            primitive = dr.zeros(mi.UInt32, width)
            tested = dr.zeros(mi.UInt32, width)
            while close & (tested < count) & (index == NOTHING):
                met = self._intersect(ray, tested, close)
                ties = (met.t < dr.inf) & (met.t - nearest <= error + met.error)
                t = dr.select(ties, met.t, t)
                index = dr.select(ties, tested, index)
                primitive = dr.select(ties, met.primitive, primitive)
                tested += 1
        return t, index, primitive

    @dr.syntax
    def blocker(self, ray: Ray, distance: Any, light: Any, found: Any, close: Any) -> Any:
        """Some object before a light at `distance`, or NOTHING; where rays are not close to a tie what was found."""
        if close:
            found = dr.full(mi.UInt32, NOTHING, dr.width(close))
            tested = dr.zeros(mi.UInt32, dr.width(close))
            while close & (tested < self._primitives.object_count) & (found == NOTHING):
                met = self._intersect(ray, tested, close)
                blocks = (met.t < distance) & ~self._contacts.lies_at(light, met, ray.d, close)
                found = dr.select(blocks, tested, found)
                tested += 1
        return found

    def _intersect(self, ray: Ray, index: Any, active: Any) -> Crossing:
        """Where rays cross an object by the rules, at an infinite distance if nowhere."""
        reach = largest(ray.o)
        met = self._primitives.intersect(ray, index, active, reach, by_rules=True)
        hits = met.t < dr.inf
        most = most_blur(met.t) * (met.t + reach)
        error = dr.select(hits, dr.select(met.error <= most, met.error, most), 0)
        return replace(met, t=dr.select(hits, met.t, dr.inf), error=error)
