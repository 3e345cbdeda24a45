"""Arrays that kernels gather from."""

from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np


def column(kind: Any, numbers: Any) -> Any:
    """Numbers (a NumPy array or a list) as an evaluated one-dimensional array, with at least one entry.

    In Dr.Jit's own memory: it borrows NumPy's, which is aligned as it happens, and compiles another kernel where rows
    of four cannot be fetched in one piece.
    """
    borrowed = kind(np.ravel(numbers) if len(numbers) else np.zeros(1))
    result = dr.empty(kind, dr.width(borrowed))
    dr.scatter(result, borrowed, dr.arange(mi.UInt32, dr.width(borrowed)))  # copies and the like are optimised away
    dr.eval(result)
    return result
