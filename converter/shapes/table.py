"""All kinds of shapes."""

from collections.abc import Mapping
from typing import Any

from converter.scene.model import Polyhedron, Quadric, Shape, Sphere
from converter.shapes import polyhedron, quadric, sphere
from converter.shapes.kind import ShapeKind

SHAPE_KINDS: Mapping[type[Shape], ShapeKind[Any]] = {
    Sphere: sphere,
    Polyhedron: polyhedron,
    Quadric: quadric,
}
"""The module of each class of shapes."""

SHAPE_READERS = {word: read for kind in SHAPE_KINDS.values() for word, read in kind.READERS.items()}
"""What reads a shape, by each keyword of scene files."""


def shape_kind(shape: Shape) -> ShapeKind[Any]:
    """The module for a shape."""
    return SHAPE_KINDS[type(shape)]
