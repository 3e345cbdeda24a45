"""Vectors, and the half-spaces of bodies."""

import math
from collections.abc import Iterable, Sequence

Vector = tuple[float, float, float]
Color = tuple[float, float, float]
Plane = tuple[float, float, float, float]

GOLDEN = (math.sqrt(5) - 1) / 2


def add(a: Vector, b: Vector) -> Vector:
    """The sum of two vectors."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def scale(a: Vector, s: float) -> Vector:
    """A vector s times as long."""
    return (s * a[0], s * a[1], s * a[2])


def dot(a: Vector, b: Vector) -> float:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(a: Vector) -> Vector:
    """The vector of length 1 in the same direction."""
    return scale(a, 1 / math.sqrt(dot(a, a)))


def turned(a: Vector, axis: int, degrees: float) -> Vector:
    """A vector turned about a coordinate axis (0, 1, 2), counterclockwise seen from its tip."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    result = list(a)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    result[i], result[j] = c * a[i] - s * a[j], s * a[i] + c * a[j]
    return (result[0], result[1], result[2])


def turned_down(normals: Sequence[Vector], degrees: float) -> list[Vector]:
    """Normals turned together so that the first points straight down, then by some degrees about the vertical."""
    x, y, z = unit(normals[0])
    azimuth = math.degrees(math.atan2(z, x))
    tilt = math.degrees(math.acos(y))
    # To the plane z = 0 first, where turning about z takes it down.
    return [turned(turned(turned(n, 1, azimuth), 2, 180 - tilt), 1, degrees) for n in normals]


def around(normals: Iterable[Vector], center: Vector, distance: float) -> list[Plane]:
    """Half-spaces with the given outward normals, at one distance from a centre."""
    return [(*n, -dot(n, center) - distance) for n in map(unit, normals)]


def box(low: Vector, high: Vector) -> list[Plane]:
    """A block with faces across the axes."""
    return [
        (1, 0, 0, -high[0]),
        (-1, 0, 0, low[0]),
        (0, 1, 0, -high[1]),
        (0, -1, 0, low[1]),
        (0, 0, 1, -high[2]),
        (0, 0, -1, low[2]),
    ]


def column(sides: int, x: float, z: float, inradius: float, degrees: float = 0) -> list[Plane]:
    """An upright column without ends; the first side faces x, turned by some degrees about the vertical."""
    return around((turned((1, 0, 0), 1, degrees + 360 * k / sides) for k in range(sides)), (x, 0, z), inradius)


def pyramid(x: float, z: float, apex: float, slope: float, degrees: float = 0, sides: int = 4) -> list[Plane]:
    """An upright pyramid without a base; `slope` is the rise of its faces over their run."""
    normals = (turned((slope, 1, 0), 1, degrees + 360 * k / sides) for k in range(sides))
    return around(normals, (x, apex, z), 0)


def top(y: float) -> Plane:
    """What is below a height."""
    return (0, 1, 0, -y)


def bottom(y: float) -> Plane:
    """What is above a height."""
    return (0, -1, 0, y)


PHI = (1 + math.sqrt(5)) / 2


def signs(a: float, b: float, c: float) -> list[Vector]:
    """A vector with its coordinates' signs in all ways."""
    return sorted({(i * a, j * b, k * c) for i in (1, -1) for j in (1, -1) for k in (1, -1)})


def cyclic(vectors: Iterable[Vector]) -> list[Vector]:
    """Vectors with their coordinates moved round."""
    return [v for x, y, z in vectors for v in ((x, y, z), (y, z, x), (z, x, y))]


TETRAHEDRON: list[Vector] = [(-1, -1, -1), (1, 1, -1), (1, -1, 1), (-1, 1, 1)]
CUBE = cyclic([(1, 0, 0), (-1, 0, 0)])
OCTAHEDRON = signs(1, 1, 1)
DODECAHEDRON = cyclic(signs(0, 1, PHI))  # its faces look where an icosahedron has vertices, and the other way round
ICOSAHEDRON = signs(1, 1, 1) + cyclic(signs(0, PHI, 1 / PHI))
