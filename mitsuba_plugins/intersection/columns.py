"""Numbers of NumPy's in Dr.Jit's memory."""

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins.backend import on_gpu

PACKET = 64
"""No packet has more lanes."""


def column(kind: Any, numbers: Any) -> Any:
    """Numbers (a NumPy array or a list) as an evaluated one-dimensional array, with at least one entry.

    In Dr.Jit's own memory. On a CPU it borrows that of a one-dimensional NumPy array, reads it in whole packets, past
    its end too, where there may be no memory at all; and it is aligned as it happens, which compiles another kernel
    where rows of four cannot be fetched in one piece.
    """
    numbers = np.ravel(numbers) if len(numbers) else np.zeros(1)
    if on_gpu():
        result = kind(numbers)  # a copy, and aligned
        dr.eval(result)
        return result
    count = len(numbers)
    borrowed = kind(np.append(numbers, np.zeros(-count % PACKET, numbers.dtype)))
    result = dr.empty(kind, count)
    index = dr.arange(mi.UInt32, count)
    dr.scatter(result, dr.gather(kind, borrowed, index), index)  # copies and the like are optimised away
    dr.eval(result)
    return result
