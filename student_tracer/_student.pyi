"""The compiled tracer; its public face is `student_tracer`."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

_Triple = Sequence[float]
_Quadruple = Sequence[float]

class Scene:
    """A scene, built element by element; indices count from 0."""

    def __init__(
        self,
        *,
        eye: _Triple,
        look_at: _Triple,
        up: _Triple,
        fovy: float,
        ambient: _Triple,
        background: _Triple,
        cutoff: float,
        max_depth: int,
    ) -> None: ...
    def set_ambient_lamp(self, position: _Triple, attenuation: _Triple) -> None:
        """Say where the file's first light lies, for those that let it shine."""

    def add_lamp(self, position: _Triple, color: _Triple, attenuation: _Triple) -> None:
        """Add a point light that is not the ambient one."""

    def add_solid(self, color: _Triple) -> int:
        """Add a pigment of one colour, and return its index."""

    def add_checker(self, first: _Triple, second: _Triple, size: float) -> int:
        """Add a checkerboard pigment, and return its index."""

    def add_texmap(self, texels: NDArray[np.float32], p0: _Quadruple, p1: _Quadruple) -> int:
        """Add an image pigment of (height, width, 3) texels, and return its index."""

    def add_finish(
        self, *, ka: float, kd: float, ks: float, alpha: float, kr: float, kt: float, eta: float, ior: float
    ) -> int:
        """Add a finish, and return its index; `eta` is n1/n2, `ior` what the file has."""

    def add_sphere(self, pigment: int, finish: int, center: _Triple, radius: float) -> int:
        """Add a sphere, and return its index."""

    def add_polyhedron(self, pigment: int, finish: int, planes: Sequence[_Quadruple], bounded: bool) -> int:
        """Add a convex polyhedron, and return its index."""

def deviations() -> list[tuple[str, str, str, str, str]]:
    """Name, part, group, sentence and hint of each deviation."""

def shows(scene: Scene) -> list[bool]:
    """For each deviation whether the scene holds what it needs to show."""

def trace(
    scene: Scene,
    width: int,
    height: int,
    pixels: NDArray[np.int32],
    sets: Sequence[Sequence[int]],
    threads: int = 1,
) -> NDArray[np.float32]:
    """Colours (sets, n, 3) of pixels (n, 2), column and row, with each set of deviations."""

def levels(colors: NDArray[np.float32], deviations: Sequence[int]) -> NDArray[np.uint8]:
    """Bytes (n, 3) of colours (n, 3)."""

def trace_pixel(scene: Scene, width: int, height: int, x: int, y: int, deviations: Sequence[int]) -> dict[str, Any]:
    """The rays of one pixel as nested dictionaries."""
