"""Intersection of rays with any number of spheres and convex polyhedra inside the kernel, through a tree of boxes.

The tree is walked without a stack: its nodes lie in depth-first order, each with a link to the node that follows where
its box is missed. There is one such order for every octant of directions, in which of two children the nearer comes
first. Smits, Efficiency Issues for Ray Tracing, Journal of Graphics Tools 3(2), 1998.
"""

import math
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.contacts import LightContacts
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real, largest
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.intersection.surfaces import ExactSurfaces
from native_tracer.bvh import threaded_bvh

SLACK = 2.0**-20
"""By how much, relatively, a distance to a box may be wrong: some roundings to single precision."""

_LARGEST_EXPONENT = 1023
"""Of a power of two that is a double."""


class BvhSurfaces(ExactSurfaces):
    """Surfaces in a tree of single-precision boxes, which are rounded outward: what they let through is exact."""

    def __init__(self, types: Real, surfaces: list[Surface], primitives: Primitives, contacts: LightContacts) -> None:
        super().__init__(primitives, contacts)
        self._types = types
        scale = _scale(surfaces)
        self._scale = types.Float(scale)
        self._nodes, self._node_count = _nodes(surfaces, scale)
        dr.make_opaque(self._node_count, self._scale)

    def find_closest(self, ray: Ray, active: Any) -> tuple[Any, Any, Any, Any]:
        """As `ExactSurfaces` has it."""
        return self._search(ray, self._types.Float(dr.inf), None, active)

    def find_blocker(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any]:
        """As `ExactSurfaces` has it."""
        _, found, _, close = self._search(ray, distance, light, active)
        return found, close

    @dr.syntax
    def _search(self, ray: Ray, distance: Any, light: Any, active: Any) -> tuple[Any, Any, Any, Any]:
        """What is met first before `distance`; with a light there, anything that is in its way."""
        width = dr.width(ray.d)
        t_best = dr.zeros(self._types.Float, width) + distance
        object_best = dr.full(mi.UInt32, NOTHING, width)
        primitive_best = dr.zeros(mi.UInt32, width)
        t_second = dr.full(self._types.Float, dr.inf, width)
        close = dr.full(mi.Bool, False, width)
        reach = largest(ray.o)
        farthest = mi.Float(t_best * self._scale) * (1 + SLACK)
        # The origin as a sum of two single-precision numbers, so that differences to it are wrong by a share of
        # themselves and no more.
        scaled = ray.o * self._scale
        origin = mi.Vector3f(scaled)
        remainder = mi.Vector3f(scaled - self._types.Point3(origin))
        slope = quotient(1, mi.Vector3f(ray.d))
        start = _octant(ray.d) * self._node_count
        node = mi.UInt32(start)
        end = start + self._node_count
        # First the object that the ray travels inside, or leaves: a convex one it does not meet again.
        index = ray.object if self.primitives.any_concave else dr.select(ray.inside, ray.object, NOTHING)
        searching = mi.Bool(active)
        while searching:
            tested = searching & (index != NOTHING)
            if tested:
                crossing = self.primitives.intersect(ray, index, tested, reach, which_piece=light is None)
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
                farthest = mi.Float(t_best * self._scale) * (1 + SLACK)
            if dr.hint(light is not None, mode="scalar"):
                searching &= object_best == NOTHING
            # All rays walk until each is at a leaf, so that they are tested against surfaces together.
            index = dr.full(mi.UInt32, NOTHING, width)
            walking = searching & (node < end)
            while walking:
                corners = dr.gather(mi.Array4f, self._nodes, 2 * node, walking)
                rest = dr.gather(mi.Array4f, self._nodes, 2 * node + 1, walking)
                near = dr.max(((mi.Vector3f(corners.xyz) - origin) - remainder) * slope)
                far = dr.min(((mi.Vector3f(corners.w, rest.x, rest.y) - origin) - remainder) * slope)
                # A NaN comes from a ray within a side of a box, which contains nothing: no comparison holds.
                meets = (near <= dr.minimum(far * (1 + SLACK), farthest)) & (far >= 0)
                item = dr.reinterpret_array(mi.UInt32, rest.w)
                index = dr.select(walking & meets & (item != ray.object), item, index)
                node = dr.select(meets & (item == NOTHING), node + 1, start + dr.reinterpret_array(mi.UInt32, rest.z))
                walking &= (index == NOTHING) & (node < end)
            searching &= index != NOTHING
        if dr.hint(light is None, mode="scalar"):
            near = most_blur(t_best) * (t_best + reach)
            close |= (t_second - t_best <= near) | (t_best < near)
        return t_best, object_best, primitive_best, close


def _octant(d: Any) -> Any:
    """Which components of a direction are negative, a bit each."""
    return sum(dr.select(component < 0, mi.UInt32(1 << axis), 0) for axis, component in enumerate(d))


def _scale(surfaces: list[Surface]) -> float:
    """A power of two that makes the boxes so large that single precision holds them, and distances to them."""
    largest = max((abs(x) for s in surfaces if s.swept is not None for corner in s.swept for x in corner), default=0.0)
    return math.ldexp(1.0, min(-math.frexp(largest)[1], _LARGEST_EXPONENT)) if largest > 0 else 1.0


def _nodes(surfaces: list[Surface], scale: float) -> tuple[Any, Any]:
    """The nodes of all octants, and the number of an octant's.

    A node is two rows of four: the corner of its box, times the scale, that rays of the octant reach first, and the one
    they reach last, the link, and the object of a leaf, or NOTHING. Unbounded surfaces are leaves before the tree's
    root, with boxes without bounds.
    """
    bounded = [i for i, surface in enumerate(surfaces) if surface.swept is not None]
    unbounded = [i for i, surface in enumerate(surfaces) if surface.swept is None]
    boxes = np.array([surfaces[i].swept for i in bounded], dtype=np.float64).reshape(-1, 2, 3) * scale
    tree = threaded_bvh(boxes[:, 0], boxes[:, 1])
    first, count = len(unbounded), len(unbounded) + tree.size
    low = np.full((8, count, 3), -np.inf, dtype=np.float32)
    high = np.full((8, count, 3), np.inf, dtype=np.float32)
    corners = tree.boxes.reshape(8, tree.size, 2, 3)
    with np.errstate(over="ignore"):  # to an infinite side
        low[:, first:] = np.nextafter(corners[:, :, 0].astype(np.float32), np.float32(-np.inf))
        high[:, first:] = np.nextafter(corners[:, :, 1].astype(np.float32), np.float32(np.inf))
    negative = (np.arange(8)[:, None] >> np.arange(3) & 1 == 1)[:, None]
    nodes = np.empty((8, count, 8), dtype=np.float32)
    nodes[..., 0:3] = np.where(negative, high, low)
    nodes[..., 3:6] = np.where(negative, low, high)
    words = nodes.view(np.uint32)
    words[:, :first, 6], words[:, :first, 7] = np.arange(1, first + 1), unbounded
    words[:, first:, 6] = first + tree.skip.reshape(8, tree.size)
    # NO_ITEM becomes NOTHING.
    objects = np.array([*bounded, NOTHING], dtype=np.uint32)
    words[:, first:, 7] = objects[np.minimum(tree.item, len(bounded))].reshape(8, tree.size)
    return column(mi.Float, nodes), mi.UInt32(count)
