"""All kinds of pigments."""

from collections.abc import Mapping
from typing import Any

from converter.pigments import checker, solid, texmap
from converter.pigments.kind import PigmentKind
from converter.scene.model import Checker, Pigment, Solid, Texmap

PIGMENT_KINDS: Mapping[type[Pigment], PigmentKind[Any]] = {Solid: solid, Checker: checker, Texmap: texmap}
"""The module of each class of pigments."""

PIGMENT_WORDS = {word: kind for kind in PIGMENT_KINDS.values() for word in kind.SPELLINGS}
"""The module by each keyword of scene files."""


def pigment_kind(pigment: Pigment) -> PigmentKind[Any]:
    """The module for a pigment."""
    return PIGMENT_KINDS[type(pigment)]
