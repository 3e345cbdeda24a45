"""Writes scenes of any number of objects, to see how time and memory grow with it.

    python scenes/large.py sphereflake 4 balls.in    7381 balls over a floor: Haines's `balls` at level 4
    python scenes/large.py gallery 10000 stones.in   10,000 small polyhedra on a floor

What is written is the same on every machine, byte by byte; see `generate.py`, which writes the small scenes. Every
picture of one kind shows about the same, whatever the number, only finer, so that rays of all of them have as much to
do but for the search of what they meet.
"""

import argparse
import math
from collections.abc import Callable
from pathlib import Path

from making.bodies import flake
from making.text import SceneText
from making.textures import Stops, ramp
from making.vectors import (
    CUBE,
    GOLDEN,
    OCTAHEDRON,
    TETRAHEDRON,
    Plane,
    Vector,
    around,
    bottom,
    box,
    column,
    top,
    turned,
    turned_down,
)

MOST_LEVELS = 7
"""Five million balls; half a gigabyte of text."""
RADIUS = 243
"""Of the largest ball, so that those of the fifth generation after it have radius 1, and few digits suffice."""


class LargeScene(SceneText):
    """A scene that this script writes."""

    script = "large.py"


def sphereflake(level: int) -> SceneText:
    """A ball with `level` generations on it, (9^(level + 1) - 1) / 8 in all, and a floor.

    Camera, lights and sizes are those of `balls` in Haines's Standard Procedural Databases, its z axis turned to y and
    its unit taken as 486; the largest ball stands on the floor. Balls dim what they mirror by half.
    """
    unit = 2 * RADIUS
    s = LargeScene(
        f"Eric Haines's sphereflake, level {level}: every ball carries nine of a third of its size.",
        (2.1 * unit, 1.7 * unit, -1.3 * unit),
        (0, 0, 0),
        45,
        (0.078, 0.361, 0.753),
    )
    for x, y, z in ((4, 2, -3), (1, 4, 4), (-3, 5, -1)):
        s.light((x * unit, y * unit, z * unit), (0.58, 0.58, 0.58))
    floor = s.solid((1, 0.75, 0.33))
    ball = s.solid((1, 0.9, 0.7))
    ground = s.finish("0.1 0.9 0 1 0 0 0")
    mirror = s.finish("0.1 0.5 0.4 60 0.5 0 0")
    s.polyhedron(floor, ground, [*column(4, 0, 0, 6 * unit), top(-RADIUS)])
    for _, center, radius in flake((0, 0, 0), RADIUS, (0, 1, 0), level + 1):
        s.sphere(ball, mirror, center, radius)
    return s


def gallery(count: int) -> SceneText:
    """`count` blocks, solids, columns and gems on a round floor, some of them mirrors, a few of glass.

    They stand as the seeds of a sunflower do, which leaves each the same room: the k-th at the angle of k golden
    sections (Vogel, "A better way to construct the sunflower head", Mathematical Biosciences 44, 1979).
    """
    rim = 100.0
    s = LargeScene(
        f"{count} small polyhedra on a floor.",
        (0, 78, -140),
        (0, -14, -12),
        50,
        (0.80, 0.88, 0.95),
    )
    s.light((-180, 260, -160), (0.62, 0.60, 0.55))
    s.light((150, 120, -120), (0.26, 0.28, 0.34))
    floor = s.pigment("checker 0.93 0.90 0.86 0.80 0.76 0.74 12")
    stops: Stops = [
        (0.00, (0.97, 0.80, 0.30)),
        (0.30, (0.95, 0.45, 0.28)),
        (0.55, (0.78, 0.25, 0.42)),
        (0.80, (0.32, 0.28, 0.60)),
        (1.00, (0.16, 0.52, 0.62)),
    ]
    colors = [s.solid(ramp(stops, k / 11)) for k in range(12)]
    ground = s.finish("0.40 0.50 0 1 0.10 0 0")
    matte = s.finish("0.36 0.60 0 1 0 0 0")
    polished = s.finish("0.30 0.55 0.4 60 0.10 0 0")
    mirror = s.finish("0.08 0.15 0.6 200 0.70 0 0")
    glass = s.finish("0.05 0.05 0.5 200 0.10 0.80 1.5")
    s.polyhedron(floor, ground, [*column(24, 0, 0, 1.12 * rim), top(0)])
    room = rim * math.sqrt(math.pi / count)  # each body's is as large as a square with this edge
    for k in range(count):
        distance = rim * math.sqrt((k + 0.5) / count)
        angle = 2 * math.pi * GOLDEN * k
        place = (distance * math.cos(angle), 0.0, distance * math.sin(angle))
        planes = BODIES[k % len(BODIES)](place, 0.36 * room, 360 * GOLDEN * k % 90)
        pigment = colors[int(len(colors) * distance / rim) % len(colors)]
        finish = glass if k % 29 == 11 else mirror if k % 7 == 3 else polished if k % 3 == 0 else matte
        s.polyhedron(pigment, finish, planes)
    return s


Body = Callable[[Vector, float, float], list[Plane]]
"""Of the given half width, on the floor at a place and a little sunk into it, turned by some degrees."""


def _solid(normals: list[Vector], inradius: float) -> Body:
    """A regular solid on one of its faces; `inradius` in half widths."""
    down = turned_down(normals, 0)

    def body(place: Vector, size: float, degrees: float) -> list[Plane]:
        center = (place[0], 0.95 * inradius * size, place[2])
        return around((turned(n, 1, degrees) for n in down), center, inradius * size)

    return body


def _column(sides: int, height: float) -> Body:
    """An upright column; `height` in half widths."""

    def body(place: Vector, size: float, degrees: float) -> list[Plane]:
        side = column(sides, place[0], place[2], size * math.cos(math.pi / sides), degrees)
        return [*side, bottom(-0.05 * size), top(height * size)]

    return body


def _block(place: Vector, size: float, degrees: float) -> list[Plane]:
    """A flat block along the axes."""
    x, _, z = place
    return box((x - size, -0.05 * size, z - 0.7 * size), (x + size, 0.6 * size, z + 0.7 * size))


def _gem(place: Vector, size: float, degrees: float) -> list[Plane]:
    """A gem on its point: a table, and eight faces each above and below the girdle."""
    normals = [turned((0.62, 0.78, 0), 1, degrees + 45 * k) for k in range(8)]
    normals += [turned((0.66, -0.75, 0), 1, degrees + 45 * k) for k in range(8)]
    center = (place[0], 0.82 * size, place[2])
    return [*around(normals, center, 0.62 * size), top(1.22 * size)]


BODIES: list[Body] = [
    _block,
    _solid(OCTAHEDRON, 0.75),
    _column(6, 2.2),
    _solid(TETRAHEDRON, 0.5),
    _gem,
    _column(3, 1.5),
    _solid(CUBE, 0.7),
    _column(5, 1.1),
]

KINDS: dict[str, tuple[Callable[[int], SceneText], range]] = {
    "sphereflake": (sphereflake, range(MOST_LEVELS + 1)),
    "gallery": (gallery, range(1, 10**6 + 1)),
}


def main() -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description="Write a scene of many objects.")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("size", type=int, help="the sphereflake's level, or the gallery's number of polyhedra")
    parser.add_argument("file", type=Path, help="the scene file to write")
    arguments = parser.parse_args()
    make, sizes = KINDS[arguments.kind]
    if arguments.size not in sizes:
        parser.error(f"the size of a {arguments.kind} lies between {sizes[0]} and {sizes[-1]}")
    try:
        arguments.file.write_text(str(make(arguments.size)), encoding="ascii")
    except OSError as error:
        parser.error(f"{arguments.file}: {(error.strerror or str(error)).lower()}")


if __name__ == "__main__":
    main()
