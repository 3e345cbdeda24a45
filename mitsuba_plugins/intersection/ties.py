"""The same searches as everywhere, by the format's rules for ties, for the rays that are close to some."""

from dataclasses import dataclass, replace
from typing import Any, Protocol

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.passages import Crossing
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, largest
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.syntax import syntax


class Candidates(Protocol):
    """Which objects rays may meet, in any order; a `BoxTree` is one."""

    def walk(self, ray: Ray) -> Any:
        """What `next` needs of rays; its `start` is the first node."""

    def limit(self, distance: Any) -> Any:
        """A distance as `next` takes it."""

    def next(self, walk: Any, node: Any, limit: Any, skipped: Any, active: Any) -> tuple[Any, Any]:
        """The next object, from `node` (UInt32) on, that may be met before `limit`, or NOTHING, and where to go on."""


@dataclass
class _Turns:
    start: Any  # UInt32


class AllObjects:
    """All objects in turn: of a few, as fast as any search."""

    def __init__(self, count: Any) -> None:
        self._count = count

    def walk(self, ray: Ray) -> _Turns:
        """As `Candidates` has it."""
        return _Turns(dr.zeros(mi.UInt32, dr.width(ray.d)))

    def limit(self, distance: Any) -> Any:
        """As `Candidates` has it."""
        return distance

    def next(self, walk: _Turns, node: Any, limit: Any, skipped: Any, active: Any) -> tuple[Any, Any]:
        """As `Candidates` has it."""
        return dr.select(node < self._count, node, NOTHING), node + 1


class Ties:
    """Searches objects in any order, and answers as if there were none."""

    def __init__(self, primitives: Primitives, contacts: LightContacts, candidates: Candidates) -> None:
        self._primitives = primitives
        self._contacts = contacts
        self._candidates = candidates

    @syntax
    def closest(self, ray: Ray, t: Any, index: Any, primitive: Any, close: Any) -> tuple[Any, Any, Any]:
        """Distance, object and primitive of the first hit: where rays are not close to a tie as they were found."""
        if dr.hint(close, exclude=[self, ray, close]):
            width = dr.width(close)
            nobody = dr.full(mi.UInt32, NOTHING, width)
            walk = self._candidates.walk(ray)
            # The first object of those that tie with the nearest: also where one ties with two that do not tie with one
            # another, the order in which they are visited does not matter.
            nearest = dr.full(type(t), dr.inf, width)
            error = dr.zeros(type(t), width)
            node = mi.UInt32(walk.start)
            searching = mi.Bool(close)
            while dr.hint(searching, exclude=[self, ray, walk, nobody]):
                tested, node = self._candidates.next(walk, node, self._limit(ray, nearest), nobody, searching)
                searching &= tested != NOTHING
                met = self._intersect(ray, tested, searching)
                nearer = searching & ((met.t < nearest) | ((met.t == nearest) & (met.error > error)))
                error = dr.select(nearer, met.error, error)
                nearest = dr.select(nearer, met.t, nearest)
            t = dr.full(type(t), dr.inf, width)
            index = dr.full(mi.UInt32, NOTHING, width)
            primitive = dr.zeros(mi.UInt32, width)
            node = mi.UInt32(walk.start)
            searching = close & (nearest < dr.inf)
            while dr.hint(searching, exclude=[self, ray, walk, nobody, nearest, error]):
                tested, node = self._candidates.next(walk, node, self._limit(ray, nearest), nobody, searching)
                searching &= tested != NOTHING
                met = self._intersect(ray, tested, searching)
                first = searching & (met.t < dr.inf) & (met.t - nearest <= error + met.error) & (tested < index)
                t = dr.select(first, met.t, t)
                index = dr.select(first, tested, index)
                primitive = dr.select(first, met.primitive, primitive)
        return t, index, primitive

    @syntax
    def blocker(self, ray: Ray, distance: Any, light: Any, found: Any, close: Any) -> Any:
        """Some object before a light at `distance`, or NOTHING; where rays are not close to a tie what was found."""
        if dr.hint(close, exclude=[self, ray, distance, light, close]):
            width = dr.width(close)
            nobody = dr.full(mi.UInt32, NOTHING, width)
            found = dr.full(mi.UInt32, NOTHING, width)
            walk = self._candidates.walk(ray)
            node = mi.UInt32(walk.start)
            searching = mi.Bool(close)
            while dr.hint(searching, exclude=[self, ray, distance, light, walk, nobody]):
                tested, node = self._candidates.next(walk, node, self._limit(ray, distance), nobody, searching)
                searching &= tested != NOTHING
                met = self._intersect(ray, tested, searching)
                blocks = searching & (met.t < distance) & ~self._contacts.lies_at(light, met, ray.d, searching)
                found = dr.select(blocks, tested, found)
                searching &= ~blocks
        return found

    def _limit(self, ray: Ray, distance: Any) -> Any:
        """Beyond which nothing ties with what is met at a distance."""
        return self._candidates.limit(distance + 4 * most_blur(distance) * (distance + largest(ray.o)))

    def _intersect(self, ray: Ray, index: Any, active: Any) -> Crossing:
        """Where rays cross an object by the rules, at an infinite distance if nowhere."""
        reach = largest(ray.o)
        met = self._primitives.intersect(ray, index, active, reach, by_rules=True)
        hits = met.t < dr.inf
        most = most_blur(met.t) * (met.t + reach)
        error = dr.select(hits, dr.select(met.error <= most, met.error, most), 0)
        return replace(met, t=dr.select(hits, met.t, dr.inf), error=error)
