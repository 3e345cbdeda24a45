"""Bodies that scenes are made of: what half-spaces, quadrics and csgs are put together to."""

import math
from collections.abc import Callable, Iterator

from making.text import ball, csg, half_spaces, quadric
from making.vectors import Plane, Vector, add, bottom, dot, scale, top, turned, unit


def turned_box(center: Vector, half: Vector, degrees: float) -> list[Plane]:
    """A block about a centre, turned about the vertical."""
    planes = []
    for axis in range(3):
        for sign in (1, -1):
            normal = [0.0, 0.0, 0.0]
            normal[axis] = sign
            n = turned((normal[0], normal[1], normal[2]), 1, degrees)
            planes.append((*n, -sum(a * b for a, b in zip(n, center, strict=True)) - half[axis]))
    return planes


def ellipsoid(center: Vector, radii: Vector) -> str:
    """An ellipsoid along the axes."""
    (x, y, z), (a, b, c) = center, (1 / r**2 for r in radii)
    constant = a * x * x + b * y * y + c * z * z - 1
    return quadric((a, b, c, 0, 0, 0, -2 * a * x, -2 * b * y, -2 * c * z, constant))


def cylinder(x: float, z: float, radius: float, low: float, high: float) -> str:
    """An upright cylinder."""
    side = quadric((1, 0, 1, 0, 0, 0, -2 * x, 0, -2 * z, x * x + z * z - radius**2))
    return csg(f"+ {side}", f"& {half_spaces([bottom(low), top(high)])}")


def cone(x: float, z: float, ends: tuple[float, float], radii: tuple[float, float]) -> str:
    """A piece of an upright cone between two heights, with its radii there."""
    (low, high), (first, last) = ends, radii
    slope = (last - first) / (high - low)
    apex = low - first / slope
    k = slope**2
    side = quadric((1, -k, 1, 0, 0, 0, -2 * x, 2 * k * apex, -2 * z, x * x + z * z - k * apex * apex))
    return csg(f"+ {side}", f"& {half_spaces([bottom(low), top(high)])}")


def rod(start: Vector, end: Vector, radius: float) -> str:
    """A round rod from one point to another."""
    along = unit(add(end, scale(start, -1)))
    (x, y, z), (a, b, c), height = start, along, dot(start, along)
    squares = (1 - a * a, 1 - b * b, 1 - c * c, -2 * a * b, -2 * a * c, -2 * b * c)
    linear = (2 * (a * height - x), 2 * (b * height - y), 2 * (c * height - z))
    side = quadric((*squares, *linear, dot(start, start) - height**2 - radius**2))
    ends = half_spaces([(-a, -b, -c, height), (a, b, c, -dot(end, along))])
    return csg(f"+ {side}", f"& {ends}")


def brilliant_planes(center: Vector, size: float, pose: Callable[[Vector], Vector]) -> list[Plane]:
    """A round brilliant of the given girdle radius: table, 8 star, 8 bezel and 16 upper girdle facets, a girdle of 16,
    16 lower girdle and 8 pavilion main facets. `pose` turns its normals.
    """

    def facet(azimuth: float, slope: float, through: tuple[float, float]) -> Plane:
        """A facet whose normal is `slope` degrees from the axis (beyond 90: it looks down), through a point (r, y)."""
        normal = turned((math.sin(math.radians(slope)), math.cos(math.radians(slope)), 0), 1, azimuth)
        offset = math.sin(math.radians(slope)) * through[0] + math.cos(math.radians(slope)) * through[1]
        return (*normal, offset)

    edge = math.cos(math.radians(11.25))  # the girdle has 16 sides, and vertices at radius 1
    girdle, table_radius = 0.03, 0.56
    table = girdle + (1 - table_radius) * math.tan(math.radians(34.5))
    facets = [facet(0, 0, (0, table))]
    for k in range(8):
        facets.append(facet(45 * k, 34.5, (1, girdle)))
        facets.append(facet(45 * k + 22.5, 22, (table_radius * math.cos(math.radians(22.5)), table)))
        facets.append(facet(45 * k, 180 - 40.8, (1, -girdle)))
    for k in range(16):
        azimuth = 22.5 * k + 11.25
        facets.append(facet(azimuth, 41, (edge, girdle)))
        facets.append(facet(azimuth, 90, (edge, 0)))
        facets.append(facet(azimuth, 180 - 42.3, (edge, -girdle)))
    planes = []
    for *normal, offset in facets:
        n = pose((normal[0], normal[1], normal[2]))
        planes.append((*n, -dot(n, center) - size * offset))
    return planes


def flake(
    center: Vector, radius: float, up: Vector, generations: int, generation: int = 0
) -> Iterator[tuple[int, Vector, float]]:
    """Generation, centre and radius of each ball of a sphereflake: a ball, and on it, about `up`, nine smaller flakes.

    Six stand around its equator, three on its northern half, each a third of its size. So does `balls` of Haines,
    "A Proposal for Standard Graphics Environments", IEEE Computer Graphics and Applications 7(11), 1987.
    """
    yield generation, center, radius
    if generation + 1 == generations:
        return
    tilt = math.degrees(math.acos(up[1]))
    azimuth = math.degrees(math.atan2(-up[2], up[0]))
    for count, latitude, start in ((6, 0.0, 0.0), (3, 54.735610, 30.0)):
        for k in range(count):
            direction = turned(turned((1, 0, 0), 2, latitude), 1, start + 360 * k / count)
            # From about the y axis to about `up`.
            direction = turned(turned(direction, 2, -tilt), 1, azimuth)
            apart = scale(direction, radius * 4 / 3)
            yield from flake(add(center, apart), radius / 3, direction, generations, generation + 1)


EYES: dict[int, tuple[tuple[float, float], ...]] = {
    1: ((0, 0),),
    2: ((-1, -1), (1, 1)),
    3: ((-1, -1), (0, 0), (1, 1)),
    4: ((-1, -1), (-1, 1), (1, -1), (1, 1)),
    5: ((-1, -1), (-1, 1), (0, 0), (1, -1), (1, 1)),
    6: ((-1, -1), (-1, 0), (-1, 1), (1, -1), (1, 0), (1, 1)),
}
"""Where a die's eyes are on each of its faces."""


def die(center: Vector, degrees: float) -> str:
    """A die, its edges 2 long, turned about the vertical; opposite faces have seven eyes."""
    x, y, z = (turned(axis, 1, degrees) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    faces: list[Plane] = []
    eyes = []
    for (up, right, ahead), count in zip(((x, y, z), (y, z, x), (z, x, y)), (3, 5, 1), strict=True):
        for normal, number_of_eyes in ((up, count), (scale(up, -1), 7 - count)):
            faces.append((*normal, -dot(normal, center) - 1))
            for p, q in EYES[number_of_eyes]:
                middle = add(add(scale(normal, 1.06), scale(right, 0.5 * p)), scale(ahead, 0.5 * q))
                eyes.append(f"- {ball(add(center, middle), 0.21)}")
    return csg(f"+ {half_spaces(faces)}", f"& {ball(center, 1.46)}", *eyes)
