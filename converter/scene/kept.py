"""What has been worked out of a scene, kept for as long as that lives: checking and drawing it ask the same."""

from typing import Any
from weakref import ReferenceType, ref

from converter.scene.model import Scene

_kept: dict[int, tuple[ReferenceType[Scene], dict[Any, Any]]] = {}


def kept_with(scene: Scene) -> dict[Any, Any]:
    """A dictionary that goes when `scene` does: what is worked out of it, by what it is."""
    at = id(scene)
    if at not in _kept:
        _kept[at] = ref(scene, lambda _: _kept.pop(at, None)), {}
    return _kept[at][1]
