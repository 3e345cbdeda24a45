"""What a tree of boxes holds: objects, or the faces of polyhedra that have many.

Where a convex polyhedron is not met at a face, that plane and those of the faces around it say so already. So of many
planes few are tested: only those about faces whose boxes rays meet.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.geometry import Box, Surface
from mitsuba_plugins.intersection.passages import Crossing, crossing_if, first_crossing
from mitsuba_plugins.intersection.primitives import Primitives
from mitsuba_plugins.intersection.rays import NOTHING, Ray, Real
from mitsuba_plugins.intersection.rounding import decides_ties
from mitsuba_plugins.intersection.rows import GatheredRows
from mitsuba_plugins.intersection.shapes import polyhedron
from native_tracer.halfspaces import HalfSpace, polyhedron_faces

MANY = 96
"""Planes from which on a polyhedron is parted into its faces: of fewer, to test all is faster than to walk."""


class Part(NamedTuple):
    """An object, or a face of one."""

    object: int
    box: Box | None
    planes: tuple[int, ...] = ()
    """Of a face: the index of its plane among all primitives, and of those around it."""


class Parts:
    """The parts of all objects."""

    def __init__(self, types: Real, surfaces: list[Surface], primitives: Primitives) -> None:
        self._primitives = primitives
        splits = decides_ties(types.Float)
        parts: list[Part] = []
        whole: list[int] = []
        for index, surface in enumerate(surfaces):
            faces = faces_of(index, surface, primitives.first[index]) if splits else []
            whole.append(NOTHING if faces else len(parts))
            parts += faces or [Part(index, surface.swept)]
        self.boxes = [part.box for part in parts]
        self.objects = [part.object for part in parts]
        self.any_faces = len(parts) > len(surfaces)
        if self.any_faces:
            self._whole = column(mi.UInt32, whole)
            self._object = column(mi.UInt32, self.objects)
            self._first = column(mi.UInt32, np.cumsum([0] + [len(part.planes) for part in parts]))
            self._plane = column(mi.UInt32, [plane for part in parts for plane in part.planes])

    def whole(self, index: Any) -> Any:
        """The part that is all of an object, or NOTHING."""
        if not self.any_faces:
            return index
        exists = index != NOTHING
        return dr.select(exists, dr.gather(mi.UInt32, self._whole, index, exists), NOTHING)

    def object(self, part: Any, active: Any) -> Any:
        """The object of a part."""
        return dr.gather(mi.UInt32, self._object, part, active) if self.any_faces else part

    def intersect(self, ray: Ray, part: Any, index: Any, active: Any, reach: Any, which_piece: bool) -> Crossing:
        """Where each ray crosses a part of object `index`, a different one for each."""
        if not self.any_faces:
            return self._primitives.intersect(ray, index, active, reach, which_piece)
        width = dr.width(ray.d, part)
        first = dr.gather(mi.UInt32, self._first, part, active)
        count = dr.gather(mi.UInt32, self._first, part + 1, active) - first
        is_face = active & (count > 0)

        def meet_face() -> Crossing:
            rows = FaceRows(self._primitives.row, self._plane, first, count, is_face, width)
            own = ray.object == index
            passage = polyhedron.passage(rows, ray, own, reach)
            crossing = first_crossing(passage, ray, own, reach, which_piece)
            return replace(crossing, t=dr.select(crossing.primitive == rows.primitive(), crossing.t, dr.inf))

        at_face = crossing_if(is_face, ray, width, meet_face)
        return dr.select(
            is_face, at_face, self._primitives.intersect(ray, index, active & ~is_face, reach, which_piece)
        )


class FaceRows(GatheredRows):
    """The plane of a face, and those around it."""

    def __init__(
        self, row: Callable[[Any, Any], Any], planes: Any, first: Any, count: Any, active: Any, width: int
    ) -> None:
        def plane(place: Any, active: Any) -> Any:
            return dr.gather(mi.UInt32, planes, place, active)

        super().__init__(plane, first, count, active, width)
        self._row = row

    def primitive(self, k: int = 0) -> Any:
        """The index of the plane k after the first."""
        return super().row(k)

    def row(self, k: int = 0) -> Any:
        """The row of that."""
        return self._row(self.primitive(k), self._active)

    def fold(self, step: Callable[[Any, Any, Any], Any], state: Any) -> Any:
        """A loop."""
        return super().fold(lambda state, _, plane: step(state, plane, self._row(plane, self._active)), state)


def faces_of(index: int, surface: Surface, first: int) -> list[Part]:
    """The faces of an object that is parted into them: a polyhedron that has bounds and stands still."""
    (kind, shape), *others = surface.shapes
    if others or kind is not polyhedron or len(shape.given) < MANY or surface.box is None or surface.moves:
        return []
    faces = _surroundings(tuple(map(tuple, shape.given)))
    return [Part(index, box, tuple(first + plane for plane in planes)) for box, planes in faces]


@lru_cache(maxsize=256)
def _surroundings(planes: tuple[HalfSpace, ...]) -> list[tuple[Box, tuple[int, ...]]]:
    """The box of each face of a polyhedron that has neighbours, its plane, and those of the faces around it.

    Kept, for it takes some milliseconds, as long as a GPU draws a picture, and a film has the same polyhedra again.
    """
    result = []
    for plane, face in enumerate(polyhedron_faces(planes)):
        if face.neighbors:
            corners = np.reshape(face.points, (-1, 3))
            box = tuple(corners.min(axis=0)), tuple(corners.max(axis=0))
            result.append((box, (plane, *face.neighbors)))
    return result
