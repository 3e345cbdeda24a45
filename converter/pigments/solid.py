"""One colour everywhere."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.pigments.kind import Box
from converter.scene.fields import RGB, Numbers
from converter.scene.model import Color, Solid
from converter.scene.numerals import numerals
from converter.to_mitsuba.lights import color
from converter.to_povray.text import transmitting

if TYPE_CHECKING:
    from converter.pigments.kind import Floats
    from converter.scene.reader import Reader
    from converter.to_povray.image_maps import Image

SPELLINGS = ("solid",)
WORDS = 1
NUMBERS = Numbers("solid", "its colour", RGB)
TEXTURE = "solid"
REPEATS = ""


def read(reader: "Reader", at: int, k: int) -> tuple[Solid, int]:
    """Three numbers."""
    red, green, blue = reader.numbers(at + 1, NUMBERS, at)
    return Solid((red, green, blue)), at + 4


def write(pigment: Solid, folder: Path | None) -> list[str]:
    """`solid r g b`."""
    return [f"solid {numerals(*pigment.color)}"]


def files(pigment: Solid) -> tuple[Path, ...]:
    """None."""
    return ()


def colors(pigment: Solid) -> tuple[Color, ...]:
    """The one."""
    return (pigment.color,)


def largest(pigment: Solid) -> Color:
    """The colour, without signs."""
    red, green, blue = map(abs, pigment.color)
    return red, green, blue


def period(pigment: Solid, far: "Floats") -> float:
    """Nothing repeats."""
    return math.inf


def edge_margin(pigment: Solid, p: "Floats") -> float:
    """The colour never changes."""
    return math.inf


def facts(pigment: Solid) -> dict[str, Any]:
    """Its colour."""
    return {"color": pigment.color}


def summary(facts: dict[str, Any]) -> str:
    """Its colour."""
    return " ".join(f"{value:g}" for value in facts["color"])


def scaled(pigment: Solid, factor: float) -> Solid:
    """It has no lengths."""
    return pigment


def add_to(native: Any, pigment: Solid) -> int:
    """A solid."""
    return int(native.add_solid(pigment.color))


def texture(pigment: Solid) -> dict[str, Any]:
    """A `solid` texture."""
    return {"type": TEXTURE, "color": color(pigment.color)}


def povray_image(pigment: Solid, name: str) -> "Image | None":
    """None."""
    return None


def povray(pigment: Solid, transmitted: float, image: "Image | None", boxes: Sequence[Box] | None) -> str:
    """A colour."""
    return transmitting(pigment.color, transmitted)
