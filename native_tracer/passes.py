"""In which order the samples of a pixel are drawn: pass after pass, each a fair picture of the whole.

The n x n samples lie in the cells of a grid, cell k in column k mod n and row k // n. A pass has n of them, one in each
column and one in each row: a rank-1 lattice, whose generator is near the golden section of n, so that its points are
well spread. Passes are the same lattice moved down, in steps that are near the golden section too. Sums of whole passes
are what a picture goes on from, so both renderers add samples up pass after pass.

Sloan and Joe, Lattice Methods for Multiple Integration, 1994.
"""

from math import gcd, isqrt

ONE_PASS = 16
"""Samples up to which a picture is drawn in one pass."""
_GOLDEN = (5**0.5 - 1) / 2


def passes(samples: int, in_one: int = ONE_PASS) -> list[list[int]]:
    """The cells of each pass, for a square number of samples, of which `in_one` are drawn in one pass.

    Raises:
        ValueError: it is none.

    """
    n = isqrt(max(samples, 0))
    if n < 1 or n * n != samples:
        raise ValueError(f"samples per pixel are laid out as a grid, and {samples} is no square number")
    if samples <= in_one:
        return [list(range(samples))]
    step = min((i for i in range(1, n) if gcd(i, n) == 1), key=lambda i: abs(i - _GOLDEN * n))
    return [[(step * (column + number)) % n * n + column for column in range(n)] for number in range(n)]


def halves(samples: int) -> list[list[int]]:
    """The cells of the first pass in two parts, of which the first is spread over the pixel, too: every other column.

    What is drawn in one pass is one part: the columns of so small a grid lie too far to one side.
    """
    first, *others = passes(samples)
    return [first[::2], first[1::2]] if others else [first]
