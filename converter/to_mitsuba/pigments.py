"""Pigments as textures."""

from typing import Any

from converter.images.texture import read_texture
from converter.scene.model import Checker, Pigment, Solid
from converter.to_mitsuba.lights import color


def texture(pigment: Pigment) -> dict[str, Any]:
    """A `solid`, `solid_checker` or `projected_bitmap` texture; the latter's `data` is a `Texture` of ours.

    Raises:
        TextureError: the image of a texmap cannot be read.

    """
    if isinstance(pigment, Solid):
        return {"type": "solid", "color": color(pigment.color)}
    if isinstance(pigment, Checker):
        return {
            "type": "solid_checker",
            "first": color(pigment.first),
            "second": color(pigment.second),
            "size": pigment.size,
        }
    return {
        "type": "projected_bitmap",
        "data": read_texture(pigment.file, pigment.place),
        "to_s": " ".join(map(repr, pigment.p0)),
        "to_r": " ".join(map(repr, pigment.p1)),
    }
