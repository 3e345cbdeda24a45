"""Loops and branches over Dr.Jit's arrays, written as Python's own `while` and `if`."""

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
