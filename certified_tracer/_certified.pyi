from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Number = tuple[Sequence[float], float]
"""Doubles that add up to a number, and how far it may be off."""
Numbers = Sequence[Number]

reasons: list[str]
"""By number, why a pixel is undecided; the first is that it is not."""
digits: list[int]
"""Binary digits of each rung's numbers."""

class Scene:
    def __init__(
        self,
        *,
        eye: Numbers,
        look_at: Numbers,
        up: Numbers,
        fovy: Number,
        ambient: Numbers,
        background: Numbers,
        cutoff: Number,
        max_depth: int,
        width: int,
        height: int,
        grid: int,
        corner: bool,
        blinn: bool,
        ties: bool,
    ) -> None: ...
    def add_light(self, position: Numbers, color: Numbers, attenuation: Numbers) -> None: ...
    def add_solid(self, color: Numbers) -> None: ...
    def add_checker(self, first: Numbers, second: Numbers, size: Number) -> None: ...
    def add_texmap(self, texels: NDArray[np.uint16], largest: int, columns: Numbers, rows: Numbers) -> None: ...
    def add_finish(self, numbers: Numbers, ior_is_index: bool) -> None: ...
    def add_leaf(
        self,
        kind: int,
        surfaces: Sequence[Numbers],
        identities: Sequence[int],
        eye: Sequence[bool],
        lights: Sequence[Sequence[bool]],
        layers: Sequence[tuple[int, int]],
    ) -> int: ...
    def add_body(
        self,
        pigment: int,
        finish: int,
        leaves: Sequence[int],
        program: Sequence[int],
        low: Sequence[float],
        high: Sequence[float],
    ) -> None: ...

def certify(
    scene: Scene,
    pixels: NDArray[np.int32],
    first: int,
    last: int,
    threads: int,
    progress: Callable[[float], None] | None = None,
    quick: bool = True,
) -> dict[str, NDArray[Any]]: ...
def miss(function: str, arguments: Sequence[Number], truth: Number, rung: int) -> tuple[float, float]: ...
def sift(
    planes: Sequence[Numbers], origin: Numbers, direction: Numbers, entries: bool, end: float
) -> list[int] | None: ...
def misses_ball(center: Numbers, radius: Number, origin: Numbers, direction: Numbers, end: float) -> bool: ...
def meets_box(
    low: Sequence[float], high: Sequence[float], origin: Numbers, direction: Numbers, end: float
) -> float | None: ...
