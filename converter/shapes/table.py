"""All kinds of shapes."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from converter.scene.model import Csg, Shape
from converter.shapes import csg
from converter.shapes.kind import ShapeKind
from converter.shapes.primitives import PRIMITIVE_KINDS

if TYPE_CHECKING:
    from converter.scene.reader import Reader

ShapeReader = Callable[["Reader", int], tuple[Shape, int]]

SHAPE_KINDS: Mapping[type[Shape], ShapeKind[Any]] = {**PRIMITIVE_KINDS, Csg: csg}
"""The module of each class of shapes."""

SHAPE_READERS: Mapping[str, ShapeReader] = {
    word: read for kind in SHAPE_KINDS.values() for word, read in kind.READERS.items()
}
"""What reads a shape, by each keyword of scene files."""


def shape_kind(shape: Shape) -> ShapeKind[Any]:
    """The module for a shape."""
    return SHAPE_KINDS[type(shape)]
