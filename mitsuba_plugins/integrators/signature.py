"""Signatures of pixels: a word that tells what has been decided along a pixel's rays.

Neighbouring pixels whose rays take the same way, meet the same pieces of surface and of pigment and are shadowed by the
same lights have the same signature, and nearly always others have another. It is a sum over the tree of rays, so that
their order does not matter, and the native tracer has the same, see native_tracer/src/tracing/signer.h.
"""

from typing import Any

from mitsuba_plugins.sampler import combine


def hit_word(path: Any, index: Any, piece: Any, inside: Any, cell: Any) -> Any:
    """What the hit of a ray adds (UInt32): the object, its piece, from which side (0 or 1), and the pigment's cell."""
    return combine(combine(combine(path, index), 2 * piece + inside), cell)


def shadow_word(path: Any, light: Any) -> Any:
    """What a light adds (UInt32) that something hides from the hit of a ray."""
    return combine(path, ~light)
