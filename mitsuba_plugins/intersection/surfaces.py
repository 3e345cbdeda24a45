"""What a ray meets: the first of the exact surfaces, and the point and the normal there."""

from dataclasses import replace
from typing import Any

import drjit as dr

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Hit, Ray, largest, origin_error, shadow_spread, spawn
from mitsuba_plugins.intersection.rounding import bounds_all, decides_ties, least_spread, most_blur
from mitsuba_plugins.intersection.ties import AllObjects, Candidates, Ties


class ExactSurfaces:
    """What a ray meets, the point and the normal from the exact surfaces; subclasses know how to search them.

    Masks of active rays come from `lanes`. Rays that are close to a tie are searched for once more, by the format's
    rules; unless `postpones_ties`: then it is only told which they are, and the kernel has none of the rules' code.
    """

    finds_ties = True

    def __init__(self, primitives: Primitives, contacts: LightContacts, candidates: Candidates | None = None) -> None:
        """Look for ties among `candidates`, or all objects."""
        self.primitives = primitives
        self.contacts = contacts
        self.postpones_ties = False
        self._ties = Ties(primitives, contacts, candidates or AllObjects(primitives.object_count))

    def closest(self, ray: Ray, active: Any) -> Hit:
        """The first surface that a ray meets, the point moved onto it to shed the error along the normal."""
        t, index, primitive, close = self.find_closest(ray, active)
        bounded = bounds_all(t)
        ties = bounded or (self.finds_ties and decides_ties(t))
        if ties and not bounded and not self.postpones_ties:
            t, index, primitive = self._ties.closest(ray, t, index, primitive, active & close)
        valid = active & (index != NOTHING)
        moving, ray = ray, self.primitives.at_rest(ray, index, valid)
        p = type(ray.o)(ray.o + t * ray.d)
        surface = self.primitives.surface_at(ray, index, primitive, p, valid, largest(ray.o))
        p, n = surface.p, surface.n
        inside = dr.select(index == ray.object, ray.inside, dr.dot(n, ray.d) > 0)
        off = ray.t_min + surface.error + t * ray.spread
        error = origin_error(p, t)
        if ties:
            # A ray that is off meets the surface farther off the more it slants.
            slope = dr.abs(dr.dot(n, ray.d))
            along = quotient(off, slope)
            if bounded:
                along = quotient(off, slope - ray.spread)
                bent = quotient(along, surface.radius * slope)
                along += along * bent
                off += off * bent
            error += dr.minimum(along, most_blur(t) * (largest(p) + t))
        lean = quotient(error, surface.radius)
        undecided = active & close if ties and (bounded or self.postpones_ties) else False
        if bounded:
            # Which side the ray comes from, and whether what is known to first order is known at all. Shapes call
            # such rays close, all that were ever tried; but by rules of their own, of which this does not follow.
            lean += least_spread(lean)
            grazes = ~(slope > 2 * (ray.spread + lean)) | ~(lean < 0.25) | ~(bent < 0.25)
            undecided |= (active & ~(ray.spread < 0.25)) | (valid & grazes)
        hit = Hit(valid, t, index, primitive, p, n, inside, off, error, lean, undecided)
        return self.primitives.taken_along(hit, moving, valid)

    def spawn(self, hit: Hit, d: Any, inside: Any, spread: Any) -> Ray:
        """The ray that leaves `hit` in direction `d`, on the given side of the object."""
        ray = spawn(hit, d, inside, spread)
        if bounds_all(spread):
            # A mirror moves the line of a ray sideways by no more than that is off; a refracting surface by more where
            # it makes a beam wider.
            across = dr.maximum(hit.off, hit.error * dr.abs(dr.dot(hit.n, d)))
            ray = replace(ray, t_min=across + origin_error(hit.p, 0), shift=hit.error)
        return ray

    def blocker(self, hit: Hit, d: Any, distance: Any, error: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """Some object between `hit` and a light at `distance` in direction `d`, on the side it was seen from, and
        whether that is undecided; these two ends of the way may be off by `error`.
        """
        ray = spawn(hit, d, hit.inside, shadow_spread(error, distance))
        if bounds_all(distance):
            ray.shift = hit.error
        # From within it does not matter where the surface is crossed.
        leaves = self.contacts.lies_outside(light, hit.object, distance, active & hit.inside)
        active &= ~leaves
        found, close = self.find_blocker(ray, distance, light, active)
        close &= active
        undecided: Any = False
        if bounds_all(distance):
            undecided = close & (found == NOTHING)
        elif self.finds_ties and decides_ties(distance):
            if self.postpones_ties:
                undecided = close
            else:
                found = self._ties.blocker(ray, distance, light, found, close)
        return dr.select(leaves, hit.object, found), undecided

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """Distance (infinite for none), object (NOTHING for none) and primitive of the first hit, and whether it was
        close to a tie.
        """
        raise NotImplementedError

    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """Some object that the ray meets before it comes to a light at `distance`, or NOTHING, and whether that was
        close to a tie.
        """
        raise NotImplementedError
