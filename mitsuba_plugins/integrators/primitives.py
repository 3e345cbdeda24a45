"""Which object, and which of its planes, a primitive of Mitsuba's acceleration structure belongs to."""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.columns import column
from mitsuba_plugins.integrators.exact import Records
from mitsuba_plugins.integrators.geometry import Surface


class Primitives:
    """The shapes of a scene, by their names, as the surfaces they were made from.

    Raises:
        ValueError: they are not that scene's.

    """

    def __init__(self, scene: Any, surfaces: list[Surface], records: Records) -> None:
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
        object_of, first_primitive = [0] * size, [0] * size
        record_of: list[int] = []
        for shape, identifier in zip(shapes, registry, strict=True):
            index = by_name[shape.id()]
            surface = surfaces[index]
            object_of[identifier] = index
            first_primitive[identifier] = len(record_of)
            if surface.sphere is None and shape.primitive_count() != len(surface.triangles):
                raise ValueError(f"whitted: mesh {surface.name} has not the triangles that 'geometry' gives planes for")
            row = {plane: row for row, plane in enumerate(surface.planes)}
            planes = surface.triangles or (0,) * shape.primitive_count()
            record_of.extend(records.first[index] + row.get(plane, 0) for plane in planes)
        self._object = column(mi.UInt32, object_of)
        self._first_primitive = column(mi.UInt32, first_primitive)
        self._record = column(mi.UInt32, record_of)

    def find(self, hit: Any, active: Any) -> tuple[Any, Any]:
        """Object and record of what a PreliminaryIntersection3f has met."""
        shape = dr.reinterpret_array(mi.UInt32, hit.shape)
        index = dr.gather(mi.UInt32, self._object, shape, active)
        primitive = dr.gather(mi.UInt32, self._first_primitive, shape, active) + hit.prim_index
        return index, dr.gather(mi.UInt32, self._record, primitive, active)
