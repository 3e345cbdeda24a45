"""Division as C has it, every component rounded once, which Dr.Jit's `/` has only between arrays of numbers.

It multiplies by a rounded reciprocal instead where the divisor is known when the kernel is recorded, and where a vector
is divided by a scalar; and on CUDA that reciprocal is an approximation, of a double only the first digits.
"""

from typing import Any

import drjit as dr


def quotient(a: Any, b: Any) -> Any:
    """`a` over `b`: numbers, or vectors, whose components it divides each by its own divisor or all by the same.

    One of the two has a type of Dr.Jit.
    """
    vector = next((type(x) for x in (a, b) if dr.depth_v(x) > 1), None)
    if vector is not None:
        pairs = ((_component(a, k), _component(b, k)) for k in range(dr.size_v(vector)))
        return vector(*(quotient(x, y) for x, y in pairs))
    if not dr.is_jit_v(b):
        b = dr.opaque(type(a), b)
    elif b.state == dr.VarState.Literal:
        b = dr.opaque(type(b), b[0], dr.width(b))
    return a / b


def _component(x: Any, k: int) -> Any:
    return x[k] if dr.depth_v(x) > 1 else x
