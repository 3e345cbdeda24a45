"""Numbers, vectors and colours as POV-Ray's language writes them."""

import math
from collections.abc import Iterable

from converter.errors import ExportError


def number(value: float) -> str:
    """The shortest digits that read back as the same double.

    Raises:
        ExportError: it is not finite.

    """
    if not math.isfinite(value):
        raise ExportError("POV-Ray's numbers do not hold this scene: some would be too large, or undefined")
    return repr(float(value)).removesuffix(".0")


def vector(values: Iterable[float]) -> str:
    """`<x, y, z>`, of any length."""
    return f"<{', '.join(map(number, values))}>"


def rgb(color: Iterable[float]) -> str:
    """Linear RGB, not clamped."""
    return f"rgb {vector(color)}"


def transmitting(color: Iterable[float], transmitted: float) -> str:
    """Linear RGB that lets a share of the light behind it through."""
    return f"rgbt {vector((*color, transmitted))}" if transmitted else rgb(color)
