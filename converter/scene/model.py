"""A course scene as plain, immutable data: what the file says, in the file's order, nothing derived from it.

Indices (`Object.pigment`, `Object.finish`) count from 0, as in the file. Lengths are in scene units, angles in
degrees, colours linear RGB that is meant to lie in 0..1 but is never clamped here.
"""

from pathlib import Path
from typing import Literal

from converter.frozen import dataclass, field

Vector = tuple[float, float, float]
Color = tuple[float, float, float]
Plane = tuple[float, float, float, float]
"""Coefficients of the half-space a x + b y + c z + d <= 0: the normal (a, b, c), of any length, points out."""


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera: `up` is a vector, `fovy` the full vertical angle in degrees.

    With an aperture, its lens's radius, what lies at the distance `focal` along the view direction is in focus; without
    one it is a pinhole camera.
    """

    eye: Vector
    look_at: Vector
    up: Vector
    fovy: float
    aperture: float = 0.0
    focal: float = 0.0


@dataclass(frozen=True, slots=True)
class Light:
    """A light of the given colour, dimmed by 1 / (a + b d + c d^2) at distance d, (a, b, c) its attenuation.

    It is a disc of that radius that faces the point being lit, without one a point.
    """

    position: Vector
    color: Color
    attenuation: Vector
    radius: float = 0.0


@dataclass(frozen=True, slots=True)
class Solid:
    """One colour everywhere."""

    color: Color


@dataclass(frozen=True, slots=True)
class Checker:
    """A solid checkerboard of cubes with the given edge length; the cube at the origin's positive corner is `first`."""

    first: Color
    second: Color
    size: float


@dataclass(frozen=True, slots=True)
class Texmap:
    """An image projected through space: a point's column is `p0 . (x, y, z, 1)`, its row `p1 . (x, y, z, 1)`."""

    file: Path  # as it can be opened: already relative to the scene's folder
    p0: tuple[float, float, float, float]
    p1: tuple[float, float, float, float]
    place: str = field(default="", compare=False)  # `scene.in:8`, where it is named; empty: made by a program


Pigment = Solid | Checker | Texmap


@dataclass(frozen=True, slots=True)
class Finish:
    """How a surface answers light; `ior` as written, see `needs.eta`.

    Mirrored and transmitted rays are spread in a cone, `cone` its half-angle in degrees.
    """

    ka: float
    kd: float
    ks: float
    alpha: float
    kr: float
    kt: float
    ior: float
    cone: float = 0.0


@dataclass(frozen=True, slots=True)
class Sphere:
    """A ball."""

    center: Vector
    radius: float


@dataclass(frozen=True, slots=True)
class Polyhedron:
    """The intersection of half-spaces, convex, bounded or not."""

    planes: tuple[Plane, ...]


@dataclass(frozen=True, slots=True)
class Quadric:
    """Where A x^2 + B y^2 + C z^2 + D xy + E xz + F yz + G x + H y + I z + J <= 0, the numbers in this order."""

    coefficients: tuple[float, float, float, float, float, float, float, float, float, float]


Primitive = Sphere | Polyhedron | Quadric
"""What a line enters and leaves at most once, or of which that is true for the complement."""


@dataclass(frozen=True, slots=True)
class Operand:
    """A step of a csg: union, difference or intersection of what there is so far and a shape."""

    operation: Literal["+", "-", "&"]
    shape: "Shape"


@dataclass(frozen=True, slots=True)
class Csg:
    """What its operands make, one after the other, starting from nothing."""

    operands: tuple[Operand, ...]


Shape = Primitive | Csg


@dataclass(frozen=True, slots=True)
class Object:
    """A shape with its pigment and finish, and the line of the file it starts on (0: made by a program).

    `move` is its displacement, and that of its pigment, while the shutter is open.
    """

    pigment: int
    finish: int
    shape: Shape
    line: int = field(default=0, compare=False)
    move: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, weakref_slot=True)
class Scene:
    """A whole scene. `ambient` is the file's first light, whose position and attenuation mean nothing.

    `notes` and `warnings` are what a reader should be told of how the file was read, each with its place.
    """

    camera: Camera
    ambient: Color
    lights: tuple[Light, ...]
    pigments: tuple[Pigment, ...]
    finishes: tuple[Finish, ...]
    objects: tuple[Object, ...]
    file: Path | None = field(default=None, compare=False)
    finish_lines: tuple[int, ...] = field(default=(), compare=False)
    light_lines: tuple[int, ...] = field(default=(), compare=False)
    pigment_lines: tuple[int, ...] = field(default=(), compare=False)
    notes: tuple[str, ...] = field(default=(), compare=False)
    warnings: tuple[str, ...] = field(default=(), compare=False)
