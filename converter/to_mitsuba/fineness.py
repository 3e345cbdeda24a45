"""How far meshes may be off the surfaces that they stand for."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Fineness:
    """What the meshes of curved surfaces may be off by.

    Attributes:
        spheres: as a share of their radius; None: spheres are no meshes.
        pixels: those of quadrics and csgs, in pixels, as seen from the eye.

    """

    spheres: float | None = None
    pixels: float = 1 / 32


USUAL = Fineness()
