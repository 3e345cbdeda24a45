"""Loops and branches over Dr.Jit's arrays, written as Python's own `while` and `if`.

Of all variables that a loop mentions Dr.Jit makes its state; those that turn out to stay the same it takes away again,
and records the loop once more, four times where it lies within another. So what a loop only reads stands in its
`dr.hint(..., exclude=[...])`, and what is not needed is None, and no number that never changes.
"""

from collections.abc import Callable
from functools import cache, wraps
from typing import Any

import drjit as dr


def syntax(function: Callable[..., Any]) -> Callable[..., Any]:
    """`drjit.syntax`, applied when the function is called first.

    That reads the function's source and compiles it once more, some milliseconds of each, and a picture needs few of
    those that there are.
    """
    rewritten = cache(lambda: dr.syntax(function))

    @wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        return rewritten()(*args, **kwargs)

    return call
