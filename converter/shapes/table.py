"""All kinds of shapes."""

from collections.abc import Mapping
from typing import Any

from converter.late import LateModule
from converter.scene.model import Csg, Shape
from converter.shapes.kind import ShapeKind
from converter.shapes.primitives import PRIMITIVE_KINDS

SHAPE_KINDS: Mapping[type[Shape], ShapeKind[Any]] = {**PRIMITIVE_KINDS, Csg: LateModule("converter.shapes.csg")}
"""The module of each class of shapes."""


def shape_kind(shape: Shape) -> ShapeKind[Any]:
    """The module for a shape."""
    return SHAPE_KINDS[type(shape)]
