"""What each kind of pigment has to answer."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from converter.scene.fields import Numbers
from converter.scene.model import Color, Vector

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from converter.scene.reader import Reader
    from converter.to_povray.image_maps import Image

    Floats = NDArray[np.float64]

P = TypeVar("P")
Box = tuple[Vector, Vector]
"""A lower and an upper corner."""


class PigmentKind(Protocol[P]):
    """A module for the pigments of class `P`, of `scene.model`.

    Importing it loads neither NumPy nor a renderer: what needs one imports it when it is called.
    """

    @property
    def SPELLINGS(self) -> tuple[str, ...]:  # noqa: N802 - a module's constant
        """Its keywords in scene files; messages and listings use the first."""
        ...

    @property
    def WORDS(self) -> int:  # noqa: N802
        """How many words of an entry stand before its numbers, the keyword among them."""
        ...

    @property
    def NUMBERS(self) -> Numbers:  # noqa: N802
        """The numbers of an entry."""
        ...

    @property
    def TEXTURE(self) -> str:  # noqa: N802
        """The name of its Mitsuba plugin."""
        ...

    @property
    def REPEATS(self) -> str:  # noqa: N802
        """What repeats in space, in a message's words (plural); empty for a kind of one colour."""
        ...

    # ---- Scene files

    def read(self, reader: "Reader", at: int, k: int) -> tuple[P, int]:
        """The pigment number `k`, whose keyword is the word `at`, and the index after its last word.

        Complains to the reader of numbers that it may not have.

        Raises:
            Lost: words are missing, or stand where they cannot.
        """
        ...

    def write(self, pigment: P, folder: Path | None) -> list[str]:
        """The lines of an entry in a scene file that lies in `folder`.

        Raises:
            ValueError: the format cannot say it.
        """
        ...

    def files(self, pigment: P) -> tuple[Path, ...]:
        """The files that it is made from."""
        ...

    # ---- What it looks like

    def colors(self, pigment: P) -> tuple[Color, ...]:
        """The colours that the scene file writes for it."""
        ...

    def largest(self, pigment: P) -> Color:
        """The largest absolute value that each channel has anywhere.

        Raises:
            TextureError: a file cannot be read.
        """
        ...

    def period(self, pigment: P, far: "Floats") -> float:
        """How large what repeats is, as a share of the coordinates `far` (3,), none below 0; infinite if nothing is."""
        ...

    def edge_margin(self, pigment: P, p: "Floats") -> float:
        """How far a point (3,) is from where the colour changes, in scene units; infinite if it nowhere does.

        Raises:
            TextureError: a file cannot be read.
        """
        ...

    def facts(self, pigment: P) -> dict[str, Any]:
        """What `whitted inspect --json` tells of it besides its kind."""
        ...

    def summary(self, facts: dict[str, Any]) -> str:
        """The same in a line."""
        ...

    def scaled(self, pigment: P, factor: float) -> P:
        """What it is in a scene whose lengths are `factor` times as large."""
        ...

    # ---- Renderers

    def add_to(self, native: Any, pigment: P) -> int:
        """Add it to a `native_tracer.Scene`; its index there.

        Raises:
            TextureError: a file cannot be read.
        """
        ...

    def texture(self, pigment: P) -> dict[str, Any]:
        """Mitsuba's dictionary for it, of type `TEXTURE`; an image of ours may be in it as "data".

        Raises:
            TextureError: a file cannot be read.
        """
        ...

    def povray_image(self, pigment: P, name: str) -> "Image | None":
        """The image that POV-Ray needs for it, whose file's name begins with `name`; None if it needs none.

        Raises:
            TextureError: a file cannot be read.
        """
        ...

    def povray(self, pigment: P, transmitted: float, image: "Image | None", boxes: Sequence[Box] | None) -> str:
        """What is inside POV-Ray's `pigment` block.

        Args:
            pigment: the pigment.
            transmitted: how much of the light that comes from behind it lets through.
            image: as `povray_image` has it.
            boxes: what has this pigment lies in them; None where it has no bounds.

        Raises:
            ExportError: POV-Ray cannot express it.
        """
        ...
