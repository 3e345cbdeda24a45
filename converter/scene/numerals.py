"""Numbers as scene files write them."""

from math import isfinite


def numerals(*values: float) -> str:
    """Each number's shortest text that reads back as the same number, with blanks between.

    Raises:
        ValueError: one is not finite.
    """
    return " ".join(map(_numeral, values))


def _numeral(value: float) -> str:
    if not isfinite(value):
        raise ValueError(f"a scene file cannot hold the number {value}")
    return repr(float(value)).removesuffix(".0")
