"""A solid checkerboard of cubes."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.frozen import replace
from converter.pigments.kind import Box
from converter.scene.errors import shown
from converter.scene.fields import RGB, Numbers
from converter.scene.model import Checker, Color
from converter.scene.numerals import numerals
from converter.to_mitsuba.lights import color
from converter.to_povray.text import number, transmitting

if TYPE_CHECKING:
    from converter.pigments.kind import Floats
    from converter.scene.reader import Reader
    from converter.to_povray.image_maps import Image

SPELLINGS = ("checker",)
WORDS = 1
NUMBERS = Numbers("checker", "two colours and a size", (*RGB, *RGB, "size"))
TEXTURE = "solid_checker"
REPEATS = "tiles"


def read(reader: "Reader", at: int, k: int) -> tuple[Checker, int]:
    """Two colours, and a size above 0."""
    r, g, b, red, green, blue, size = reader.numbers(at + 1, NUMBERS, at)
    if size <= 0:
        reader.complain(at + 7, f"the checker's size must be above 0, found {shown(reader.text[at + 7])}")
    return Checker((r, g, b), (red, green, blue), size), at + 8


def write(pigment: Checker, folder: Path | None) -> list[str]:
    """`checker r g b r g b size`."""
    return [f"checker {numerals(*pigment.first, *pigment.second, pigment.size)}"]


def files(pigment: Checker) -> tuple[Path, ...]:
    """None."""
    return ()


def colors(pigment: Checker) -> tuple[Color, ...]:
    """Both."""
    return pigment.first, pigment.second


def largest(pigment: Checker) -> Color:
    """That of both colours, channel by channel."""
    red, green, blue = (max(abs(a), abs(b)) for a, b in zip(pigment.first, pigment.second, strict=True))
    return red, green, blue


def period(pigment: Checker, far: "Floats") -> float:
    """A cube's edge, over the largest coordinate."""
    return float(pigment.size / far.max())


def edge_margin(pigment: Checker, p: "Floats") -> float:
    """To the nearest side of a cube."""
    cells = p / pigment.size
    return float(abs(cells - cells.round()).min()) * pigment.size


def facts(pigment: Checker) -> dict[str, Any]:
    """Its colours and size."""
    return {"first": pigment.first, "second": pigment.second, "size": pigment.size}


def summary(facts: dict[str, Any]) -> str:
    """E.g. `1 1 1 and 0 0 0, size 2`."""
    first, second = (" ".join(f"{value:g}" for value in facts[name]) for name in ("first", "second"))
    return f"{first} and {second}, size {facts['size']:g}"


def scaled(pigment: Checker, factor: float) -> Checker:
    """Larger cubes."""
    return replace(pigment, size=factor * pigment.size)


def add_to(native: Any, pigment: Checker) -> int:
    """A checker."""
    return int(native.add_checker(pigment.first, pigment.second, pigment.size))


def texture(pigment: Checker) -> dict[str, Any]:
    """A `solid_checker` texture."""
    return {"type": TEXTURE, "first": color(pigment.first), "second": color(pigment.second), "size": pigment.size}


def povray_image(pigment: Checker, name: str) -> "Image | None":
    """None."""
    return None


def povray(pigment: Checker, transmitted: float, image: "Image | None", boxes: Sequence[Box] | None) -> str:
    """A `checker`."""
    first, second = transmitting(pigment.first, transmitted), transmitting(pigment.second, transmitted)
    return f"checker {first}, {second} scale {number(pigment.size)}"
