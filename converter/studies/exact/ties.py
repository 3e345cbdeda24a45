"""What is decided by the signs of numbers, and the ties that are met: signs that are 0."""

from converter.scene.model import Vector
from converter.studies.exact.arithmetic import Arithmetic, Number
from converter.studies.exact.vectors import Vec

TIES = {
    "tile": "a coordinate is a whole number of tiles",
    "texel": "a position in an image is a whole number of texels",
    "along": "a ray runs along a plane, outside or inside of it",
    "in": "a ray runs in a plane",
    "touched edge": "a ray enters a polyhedron where it leaves it",
    "seen edge": "a ray enters, or leaves, a polyhedron through two of its planes at once",
    "bodies": "a ray meets two bodies at the same distance",
    "light in plane": "a light lies in the plane of what it might light",
    "at light": "a shadow ray meets a body at the light",
    "at start": "a ray meets another body where it starts",
    "tangent": "a ray touches a ball, or a quadric",
    "critical": "a ray leaves at the critical angle",
}
"""Every kind of tie."""


class Decisions:
    """The arithmetic that decides, and the kinds of `ties` that have been met since these were emptied last."""

    def __init__(self, arithmetic: Arithmetic) -> None:
        self.arithmetic = arithmetic
        self.ties: set[str] = set()
        self.number, self.sign, self.root = arithmetic.number, arithmetic.sign, arithmetic.root

    def note(self, tie: str) -> None:
        """Note a tie of that kind."""
        self.ties.add(tie)

    def vector(self, v: Vector) -> Vec:
        """The decimal numbers that a file has for these."""
        x, y, z = map(self.number, v)
        return (x, y, z)

    def whole(self, x: Number, tie: str, toward_zero: bool) -> int:
        """The whole number below x, or next to it on the way to 0; x itself if it is whole, which is a tie."""
        whole = self.arithmetic.nearest_whole(x)
        side = self.sign(x - whole)
        if side == 0:
            self.note(tie)
            return whole
        below = whole if side > 0 else whole - 1
        return below + 1 if toward_zero and self.sign(x) < 0 else below
