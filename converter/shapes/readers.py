"""What reads each kind of shape from scene files."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from converter.scene.model import Shape
from converter.shapes.table import SHAPE_KINDS

if TYPE_CHECKING:
    from converter.scene.reader import Reader

ShapeReader = Callable[["Reader", int], tuple[Shape, int]]

SHAPE_READERS: Mapping[str, ShapeReader] = {
    word: read for kind in SHAPE_KINDS.values() for word, read in kind.READERS.items()
}
"""What reads a shape, by each keyword of scene files."""
