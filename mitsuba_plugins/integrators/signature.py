"""Signatures of pixels: a word that tells what has been decided along a pixel's rays.

Neighbouring pixels whose rays take the same way, meet the same pieces of surface and of pigment and are shadowed by the
same lights have the same signature, and nearly always others have another. It is a sum over the tree of rays, so that
their order does not matter, and the native tracer has the same, see native_tracer/src/tracing/signer.h.
"""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.primitives import pieces
from mitsuba_plugins.intersection.rays import UPRIGHT, Hit, Real
from mitsuba_plugins.sampler import combine


class Signer:
    """Makes signatures of the rays of a scene that weigh at least `least_weight`."""

    def __init__(self, types: Real, surfaces: list[Surface], least_weight: float) -> None:
        self.least_weight = dr.opaque(types.Float, least_weight)
        self._pieces = column(mi.UInt32, pieces(surfaces))

    def hit_word(self, path: Any, hit: Hit, cell: Any) -> Any:
        """What the hit of a ray adds (UInt32): the object, its piece, from which side, and the pigment's cell."""
        piece = dr.gather(mi.UInt32, self._pieces, hit.primitive & UPRIGHT, hit.valid)
        inside = dr.select(hit.inside, mi.UInt32(1), 0)
        return combine(combine(combine(path, hit.object), 2 * piece + inside), cell)

    def shadow_word(self, path: Any, light: Any) -> Any:
        """What a light adds (UInt32) that something hides from the hit of a ray."""
        return combine(path, ~light)
