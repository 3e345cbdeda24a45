"""Which object, and which of our primitives, a primitive of Mitsuba's acceleration structure belongs to."""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.primitives import Primitives


class MitsubaPrimitives:
    """The shapes of a scene, by their names, as the surfaces they were made from.

    Raises:
        ValueError: they are not that scene's.

    """

    def __init__(self, scene: Any, surfaces: list[Surface], primitives: Primitives) -> None:
        shapes = scene.shapes()
        by_name = {surface.name: index for index, surface in enumerate(surfaces)}
        if sorted(by_name) != sorted(shape.id() for shape in shapes):
            raise ValueError(
                "whitted: the scene's shapes are not those of 'geometry'. Mitsuba merges meshes of one material unless "
                "it is told not to: mitsuba.load_file(..., optimize=False), mitsuba.load_dict(..., optimize=False)"
            )
        # Dr.Jit numbers shapes by a registry of the whole process, in which this scene's shapes may lie anywhere.
        registry = dr.reinterpret_array(mi.UInt32, scene.shapes_dr()).numpy()
        size = int(registry.max()) + 1 if len(registry) else 1
        object_of, first_triangle = [0] * size, [0] * size
        primitive_of: list[int] = []
        for shape, identifier in zip(shapes, registry, strict=True):
            index = by_name[shape.id()]
            surface = surfaces[index]
            object_of[identifier] = index
            first_triangle[identifier] = len(primitive_of)
            if surface.faceted and shape.primitive_count() != len(surface.triangles):
                raise ValueError(f"whitted: mesh {surface.name} has not the triangles that 'geometry' gives planes for")
            row: dict[Any, int] = {}
            for k, piece in enumerate(surface.pieces):
                row.setdefault(piece, k)  # a piece of several rows is known by the first
            pieces = surface.triangles or (None,) * shape.primitive_count()
            primitive_of.extend(primitives.first[index] + row.get(piece, 0) for piece in pieces)
        self._object = column(mi.UInt32, object_of)
        self._first_triangle = column(mi.UInt32, first_triangle)
        self._primitive = column(mi.UInt32, primitive_of)

    def find(self, hit: Any, active: Any) -> tuple[Any, Any]:
        """Object and primitive of what a PreliminaryIntersection3f has met."""
        shape = dr.reinterpret_array(mi.UInt32, hit.shape)
        index = dr.gather(mi.UInt32, self._object, shape, active)
        triangle = dr.gather(mi.UInt32, self._first_triangle, shape, active) + hit.prim_index
        return index, dr.gather(mi.UInt32, self._primitive, triangle, active)
