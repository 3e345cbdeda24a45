"""In which precisions a scene is drawn: in one that decides everything, and first, where it helps, in single.

Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition, 2002, section 3.3: running error analysis.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from mitsuba_plugins.integrators.kernel_scene import KernelScene
from mitsuba_plugins.integrators.parameters import Parameters
from mitsuba_plugins.integrators.tables import Bsdfs
from mitsuba_plugins.intersection.contacts import Contacts
from mitsuba_plugins.intersection.csg import Csg
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.rays import real
from mitsuba_plugins.intersection.rounding import bounded

LARGEST = 2.0**40
"""Numbers up to which, and sizes down to one over which, scenes are drawn in single precision: it has their squares."""


class Precisions:
    """A scene as kernels read it, in each precision, and how much has been drawn in which.

    Attributes:
        deciding: in the precision that leaves nothing undecided, unless ties are postponed.

    """

    def __init__(
        self,
        parameters: Parameters,
        surfaces: list[Surface],
        bsdfs: Bsdfs,
        scene: Any,
        sensor: Any,
        least_weight: float | None,
    ) -> None:
        """Read a Mitsuba scene; the arguments are those of `KernelScene`."""
        contacts = Contacts(surfaces)
        rest = parameters, surfaces, bsdfs, contacts, scene, sensor, least_weight
        self.deciding = KernelScene(real("float" if parameters.precision == "float" else "double"), *rest)
        self._single: KernelScene | None = None
        if parameters.precision == "mixed" and fits_single(self.deciding):
            self._bound = bounded(axes_are_exact(surfaces))
            with self._bound():
                self._single = KernelScene(real("float"), *rest)
        self._drawn = self._redrawn = 0

    @property
    def tries_single(self) -> bool:
        """Whether single precision is worth a try: its errors are bounded, and it has not left half of the pixels
        undecided.
        """
        return self._single is not None and 2 * self._redrawn <= self._drawn

    @property
    def share_in_double(self) -> float:
        """Of the pixels drawn, those drawn in double."""
        return self._redrawn / self._drawn if self._drawn > 0 else 1.0

    @contextmanager
    def single(self) -> Iterator[KernelScene]:
        """The scene in single precision, for kernels that are recorded meanwhile: they tell what that cannot decide."""
        assert self._single is not None
        with self._bound():
            yield self._single

    def count(self, drawn: int, undecided: int) -> None:
        """Note that so many pixels are drawn in single precision, and so many of them once more in double."""
        self._drawn += drawn
        self._redrawn += undecided


def fits_single(scene: KernelScene) -> bool:
    """Whether all errors of single precision are bounded: not where anything is sampled, nor of rays that start on a
    surface, nor for csgs, nor where squares leave the range of its numbers.
    """
    on_something = scene.eye_contact is not None and scene.eye_contact.exists
    if scene.sampled or on_something or any(isinstance(surface.solid, Csg) for surface in scene.surfaces):
        return False
    numbers = [abs(x) for surface in scene.surfaces for row in surface.rows for x in row]
    sizes = [ball[3] for surface in scene.surfaces if (ball := surface.surrounding_ball) is not None]
    return max(numbers, default=0) < LARGEST and min(sizes, default=1) * LARGEST > 1


def axes_are_exact(surfaces: list[Surface]) -> bool:
    """Whether single precision has all numbers of the planes along the axes: points of them have that coordinate."""
    rows = np.array([row for surface in surfaces for row in surface.rows], dtype=np.float64).reshape(-1, 4)
    along_axis = np.abs(rows[:, :3]).astype(np.float32).sum(axis=1) == 1
    return bool(np.all(rows[along_axis].astype(np.float32) == rows[along_axis]))
