"""The kinds of shapes that a csg's expression is over: those that are no csg."""

from collections.abc import Mapping
from typing import Any

from converter.late import LateModule
from converter.scene.model import Polyhedron, Primitive, Quadric, Shape, Sphere
from converter.shapes import polyhedron, sphere
from converter.shapes.kind import ShapeKind

PRIMITIVE_KINDS: Mapping[type[Shape], ShapeKind[Any]] = {
    Sphere: sphere,
    Polyhedron: polyhedron,
    Quadric: LateModule("converter.shapes.quadric"),
}
"""The module of each class of primitives."""


def primitive_kind(shape: Primitive) -> ShapeKind[Any]:
    """The module for a primitive."""
    return PRIMITIVE_KINDS[type(shape)]
