"""Numbers, vectors and colours as POV-Ray's language writes them."""

from collections.abc import Iterable


def number(value: float) -> str:
    """The shortest digits that read back as the same double."""
    return repr(float(value)).removesuffix(".0")


def vector(values: Iterable[float]) -> str:
    """`<x, y, z>`, of any length."""
    return f"<{', '.join(map(number, values))}>"


def rgb(color: Iterable[float]) -> str:
    """Linear RGB, not clamped."""
    return f"rgb {vector(color)}"
