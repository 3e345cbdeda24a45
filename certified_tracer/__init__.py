"""A tracer of intervals, which proves the bytes of pixels or says why it cannot.

It shares no code with the other tracers, and nothing but the scene. `converter.certify` builds its scenes.
"""

from certified_tracer._certified import Scene, certify, digits, miss, reasons

__all__ = ["Scene", "certify", "digits", "miss", "reasons"]
