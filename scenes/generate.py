"""Writes the textures and the computed scenes of this folder, and draws the pictures of its README.

    python scenes/generate.py               rewrite textures and computed scenes
    python scenes/generate.py --pictures    draw every scene (or those named) into pictures/, and rewrite nothing else

The other scenes are written by hand. What this script writes is the same on every machine, byte by byte: it uses the
standard library alone, and numbers are rounded before they are written.
"""

import argparse
import math
import struct
import zlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parent

Vector = tuple[float, float, float]
Color = tuple[float, float, float]
Plane = tuple[float, float, float, float]
Stops = Sequence[tuple[float, Color]]

GOLDEN = (math.sqrt(5) - 1) / 2

# ---- Textures --------------------------------------------------------------------------------------------------------


def ppm(rows: Iterable[Iterable[Color]]) -> bytes:
    """A P6 image, top row first."""
    raster = [[tuple(round(255 * min(max(c, 0), 1)) for c in color) for color in row] for row in rows]
    data = bytes(c for row in raster for color in row for c in color)
    return f"P6\n{len(raster[0])} {len(raster)}\n255\n".encode() + data


def mix(a: Color, b: Color, t: float) -> Color:
    """The colour that lies at t between a (0) and b (1)."""
    return (a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t)


def ramp(stops: Stops, at: float) -> Color:
    """The colour at a place on a ramp of stops; between two of them it changes smoothly, without a crease at either."""
    if at <= stops[0][0]:
        return stops[0][1]
    for (low, a), (high, b) in pairwise(stops):
        if at <= high:
            t = (at - low) / (high - low)
            return mix(a, b, t * t * (3 - 2 * t))
    return stops[-1][1]


def rainbow1() -> bytes:
    """The hues of figure1.in's sky along 576 columns, pale and even, the last running into the first.

    The sky reads s = 0.001 y + 0.12. Behind the floor's far edge y is -110 (s = 0.01, column 5), at the horizon 30
    (column 86), at the top of the picture 150 (column 155); the balls mirror what lies higher, up to y = 600 (column
    414), and lower, where s is negative and columns count from the right. So the first 15 % go from salmon to yellow,
    and pale green follows at 27 %.
    """
    stops = [
        (0.00, (0.98, 0.60, 0.54)),  # salmon
        (0.15, (0.99, 0.93, 0.56)),  # yellow
        (0.30, (0.66, 0.96, 0.66)),  # pale green
        (0.46, (0.58, 0.92, 0.93)),  # turquoise
        (0.62, (0.58, 0.73, 0.98)),  # sky blue
        (0.78, (0.78, 0.64, 0.96)),  # lavender
        (0.90, (0.97, 0.62, 0.82)),  # pink
        (1.00, (0.98, 0.60, 0.54)),
    ]
    return ppm([[ramp(stops, column / 576) for column in range(576)]] * 5)


SKIES: dict[str, Stops] = {
    # Stops go by the sine of the height above the horizon: -1 straight down, 1 straight up.
    "day": [
        (-1.0, (0.06, 0.22, 0.36)),
        (-0.15, (0.20, 0.46, 0.60)),
        (-0.001, (0.42, 0.66, 0.74)),  # the sea
        (0.001, (0.88, 0.95, 0.98)),
        (0.25, (0.50, 0.74, 0.95)),
        (1.0, (0.12, 0.33, 0.74)),
    ],
    "sunset": [
        (-1.0, (0.16, 0.08, 0.18)),
        (-0.20, (0.34, 0.18, 0.30)),
        (-0.001, (0.66, 0.36, 0.34)),
        (0.001, (1.00, 0.78, 0.46)),
        (0.12, (0.99, 0.55, 0.40)),
        (0.32, (0.68, 0.36, 0.52)),
        (0.60, (0.30, 0.26, 0.52)),
        (1.0, (0.10, 0.12, 0.32)),
    ],
    "night": [
        (-1.0, (0.02, 0.03, 0.05)),
        (-0.05, (0.03, 0.06, 0.09)),
        (0.00, (0.13, 0.30, 0.36)),
        (0.20, (0.07, 0.15, 0.28)),
        (1.0, (0.02, 0.03, 0.10)),
    ],
    "studio": [
        (-1.0, (0.36, 0.35, 0.36)),
        (-0.10, (0.80, 0.79, 0.77)),
        (0.10, (0.93, 0.92, 0.90)),
        (0.45, (0.60, 0.64, 0.70)),
        (0.75, (0.40, 0.44, 0.52)),
        (0.85, (0.98, 0.98, 0.98)),  # a lamp overhead
        (1.0, (0.98, 0.98, 0.98)),
    ],
    "desert": [
        (-1.0, (0.45, 0.32, 0.22)),
        (-0.001, (0.86, 0.68, 0.46)),
        (0.001, (0.99, 0.90, 0.72)),
        (0.15, (0.97, 0.80, 0.62)),
        (0.40, (0.62, 0.74, 0.80)),
        (1.0, (0.20, 0.46, 0.66)),
    ],
    "mint": [
        (-1.0, (0.66, 0.52, 0.42)),
        (-0.001, (0.93, 0.80, 0.68)),
        (0.00, (0.94, 0.92, 0.82)),
        (0.25, (0.62, 0.84, 0.80)),
        (0.60, (0.36, 0.66, 0.68)),
        (1.0, (0.95, 0.97, 0.96)),
    ],
    "plum": [
        (-1.0, (0.10, 0.06, 0.14)),
        (-0.10, (0.24, 0.16, 0.30)),
        (0.00, (0.62, 0.46, 0.62)),
        (0.20, (0.40, 0.30, 0.52)),
        (0.55, (0.20, 0.16, 0.34)),
        (0.80, (0.12, 0.10, 0.24)),
        (0.90, (0.95, 0.90, 0.96)),
        (1.0, (0.95, 0.90, 0.96)),
    ],
    "poster": [
        (-1.0, (0.99, 0.87, 0.68)),
        (0.00, (0.99, 0.87, 0.68)),
        (0.18, (0.98, 0.72, 0.56)),
        (0.38, (0.86, 0.50, 0.52)),
        (0.65, (0.52, 0.34, 0.52)),
        (1.0, (0.24, 0.22, 0.42)),
    ],
}


def sky_at(name: str, radius: float) -> str:
    """The texmap of a sky of the given radius about the origin: its column in skies.ppm, rows going down with y."""
    column = (list(SKIES).index(name) + 0.5) / len(SKIES)
    return f"texmap textures/skies.ppm\n0 0 0 {number(column)}\n0 {number(-0.499 / radius)} 0 0.5"


def skies() -> bytes:
    """One sky a column, from straight up in the top row to straight down in the bottom one."""
    rows = 512
    return ppm([ramp(stops, 1 - 2 * (row + 0.5) / rows) for stops in SKIES.values()] for row in range(rows))


def softboxes() -> bytes:
    """What a cut stone has to glitter: a dark room with bright panels and a few coloured ones."""
    size = 96
    panels = [  # left, top, width, height, in hundredths of the picture; colour
        (8, 20, 9, 30, (1.00, 0.97, 0.92)),
        (24, 8, 20, 6, (1.00, 0.98, 0.95)),
        (30, 24, 6, 22, (0.60, 0.80, 1.00)),
        (44, 18, 5, 34, (1.00, 1.00, 1.00)),
        (58, 8, 16, 5, (1.00, 0.98, 0.95)),
        (60, 26, 5, 20, (1.00, 0.70, 0.40)),
        (74, 20, 12, 8, (1.00, 0.98, 0.95)),
        (80, 38, 8, 20, (0.95, 0.97, 1.00)),
        (20, 62, 10, 6, (0.45, 0.60, 0.95)),
        (50, 60, 14, 4, (1.00, 0.85, 0.65)),
        (70, 66, 8, 8, (0.90, 0.45, 0.60)),
        (12, 56, 5, 5, (1.00, 0.80, 0.20)),
        (18, 12, 4, 4, (0.20, 0.90, 0.85)),
        (38, 10, 4, 8, (0.95, 0.40, 0.75)),
        (40, 56, 5, 5, (0.30, 0.85, 0.60)),
        (52, 30, 4, 6, (0.55, 0.50, 1.00)),
        (68, 40, 5, 5, (0.20, 0.85, 1.00)),
        (76, 10, 5, 5, (1.00, 0.55, 0.25)),
        (90, 30, 4, 6, (1.00, 0.75, 0.30)),
    ]
    wall = [(0.0, (0.20, 0.24, 0.34)), (0.5, (0.15, 0.14, 0.24)), (1.0, (0.03, 0.03, 0.06))]

    def color(column: int, row: int) -> Color:
        x, y = 100 * (column + 0.5) / size, 100 * (row + 0.5) / size
        for left, top, width, height, panel in panels:
            if left <= x < left + width and top <= y < top + height:
                return panel
        return ramp(wall, y / 100)

    return ppm([color(column, row) for column in range(size)] for row in range(size))


def azulejo() -> bytes:
    """A glazed tile: blue on white, the same turned and mirrored, so that tiles join into stars."""
    size = 96
    white, pale, blue, deep, gold = (
        (0.95, 0.96, 0.96),
        (0.62, 0.76, 0.90),
        (0.20, 0.42, 0.76),
        (0.07, 0.18, 0.46),
        (0.96, 0.74, 0.22),
    )

    def color(column: int, row: int) -> Color:
        x, y = abs(2 * (column + 0.5) / size - 1), abs(2 * (row + 0.5) / size - 1)  # 0 in the middle, 1 at the rim
        r, angle = math.hypot(x, y), math.atan2(y, x)
        corner = math.hypot(1 - x, 1 - y)
        if max(x, y) > 0.965:
            return pale
        if corner < 0.16:
            return gold
        if corner < 0.40:
            return blue if corner > 0.34 or corner < 0.22 else white
        if corner < 0.52:
            return pale if corner > 0.46 else white
        if r < 0.12:
            return gold
        petal = abs(math.cos(4 * angle))
        if r < 0.20 + 0.36 * petal:
            return deep if r < 0.12 + 0.22 * petal else blue
        if r < 0.26 + 0.40 * petal:
            return white
        if abs(x + y - 0.92) < 0.05:
            return deep
        return pale if x + y < 0.87 else white

    return ppm([color(column, row) for column in range(size)] for row in range(size))


def room() -> bytes:
    """The walls of room.in, which are one body with one pigment: columns go from the left wall to the right one, rows
    from the ceiling to the floor, and the outermost of them are those walls themselves.
    """
    width, height = 64, 48

    def color(column: int, row: int) -> Color:
        if row == 0:
            return (0.96, 0.95, 0.92)  # ceiling
        if row == height - 1:
            return (0.66, 0.46, 0.30) if column // 3 % 2 else (0.60, 0.41, 0.26)  # boards
        panel = row >= 32
        rail = row in (31, 45, 46)
        if column == 0:
            return (0.92, 0.90, 0.86) if rail else (0.62, 0.16, 0.13) if panel else (0.74, 0.24, 0.19)
        if column == width - 1:
            return (0.92, 0.90, 0.86) if rail else (0.08, 0.32, 0.34) if panel else (0.12, 0.46, 0.48)
        if rail:
            return (0.92, 0.90, 0.86)
        if panel:
            return (0.74, 0.70, 0.62)
        return (0.94, 0.90, 0.80) if (column + 1) // 3 % 2 else (0.88, 0.82, 0.70)  # striped paper

    return ppm([color(column, row) for column in range(width)] for row in range(height))


def letter() -> bytes:
    """An F, which shows how a texture lies: turned, mirrored or with rows for columns it is another picture."""
    paper, ink = (250 / 255, 240 / 255, 200 / 255), (200 / 255, 40 / 255, 40 / 255)
    rows = ("......", ".####.", ".#....", ".#....", ".###..", ".#....", ".#....", "......")
    return ppm([ink if mark == "#" else paper for mark in row] for row in rows)


DIGITS = {
    "1": "..#.. .##.. #.#.. ..#.. ..#.. ..#.. #####",
    "4": "...#. ..##. .#.#. #..#. ##### ...#. ...#.",
    "8": ".###. #...# #...# .###. #...# #...# .###.",
    "9": ".###. #...# #...# .#### ....# ...#. .##..",
}


def pool() -> bytes:
    """The fronts of four balls of pool, side by side: 1, 4, 8, and 9, which is striped."""
    size = 60
    colors = {"1": (0.97, 0.74, 0.10), "4": (0.40, 0.16, 0.52), "8": (0.05, 0.05, 0.06), "9": (0.97, 0.74, 0.10)}
    ivory = (0.96, 0.94, 0.88)

    def color(column: int, row: int) -> Color:
        digit = "1489"[column // size]
        x, y = 2 * (column % size + 0.5) / size - 1, 2 * (row + 0.5) / size - 1
        if math.hypot(x, y) < 0.42:
            across, down = math.floor(x / 0.10 + 2.5), math.floor(y / 0.075 + 3.5)
            inked = 0 <= across < 5 and 0 <= down < 7 and DIGITS[digit].split()[down][across] == "#"
            return (0.06, 0.06, 0.07) if inked else ivory
        return ivory if digit == "9" and abs(y) > 0.58 else colors[digit]

    return ppm([color(column, row) for column in range(4 * size)] for row in range(size))


TEXTURES: dict[str, Callable[[], bytes]] = {
    "ladder/letter.ppm": letter,
    "rainbow1.ppm": rainbow1,
    "textures/azulejo.ppm": azulejo,
    "textures/pool.ppm": pool,
    "textures/room.ppm": room,
    "textures/skies.ppm": skies,
    "textures/softboxes.ppm": softboxes,
}

# ---- Scenes as text --------------------------------------------------------------------------------------------------


def number(x: float) -> str:
    """A number as short as six digits after the point let it be."""
    text = f"{x:.6f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def numbers(values: Iterable[float]) -> str:
    """Numbers with a blank between them."""
    return " ".join(number(x) for x in values)


class SceneText:
    """A scene that is being written. Pigments and finishes are added before they are used, and known by their index."""

    script = "generate.py"

    def __init__(
        self,
        comment: str,
        eye: Vector,
        look_at: Vector,
        fovy: float,
        ambient: Color = (1, 1, 1),
        up: Vector = (0, 1, 0),
    ) -> None:
        self.comment = comment
        self._camera = f"{numbers(eye)}\n{numbers(look_at)}\n{numbers(up)}\n{number(fovy)}"
        self._lights = [f"0 0 0 {numbers(ambient)} 1 0 0"]
        self._pigments: list[str] = []
        self._finishes: list[str] = []
        self._objects: list[str] = []

    def light(self, position: Vector, color: Color, attenuation: Vector = (1, 0, 0)) -> None:
        """Add a point light."""
        self._lights.append(f"{numbers(position)} {numbers(color)} {numbers(attenuation)}")

    def lamp(self, center: Vector, u: Vector, v: Vector, color: Color, count: int) -> None:
        """Add a panel of count x count lights that spans -u..u and -v..v, so that shadows have soft edges."""
        for i in range(count):
            for j in range(count):
                s, t = (2 * i + 1) / count - 1, (2 * j + 1) / count - 1
                position = add(center, add(scale(u, s), scale(v, t)))
                self.light(position, scale(color, 1 / count**2))

    def pigment(self, text: str) -> int:
        """Add a pigment, written as in the file."""
        self._pigments.append(text)
        return len(self._pigments) - 1

    def solid(self, color: Color) -> int:
        """Add a pigment of one colour."""
        return self.pigment(f"solid {numbers(color)}")

    def finish(self, text: str, note: str = "") -> int:
        """Add a finish, written as in the file."""
        self._finishes.append(f"{text}  # {note}" if note else text)
        return len(self._finishes) - 1

    def sphere(self, pigment: int, finish: int, center: Vector, radius: float) -> None:
        """Add a ball."""
        self._objects.append(f"{pigment} {finish} sphere {numbers((*center, radius))}")

    def polyhedron(self, pigment: int, finish: int, planes: Sequence[Plane]) -> None:
        """Add an intersection of half-spaces."""
        faces = "\n".join(numbers(plane) for plane in planes)
        self._objects.append(f"{pigment} {finish} polyhedron {len(planes)}\n{faces}")

    def body(self, pigment: int, finish: int, text: str) -> None:
        """Add an object, its shape written as in the file."""
        self._objects.append(f"{pigment} {finish} {text}")

    def __str__(self) -> str:
        comment = "\n".join(f"# {line}".rstrip() for line in self.comment.strip().splitlines())
        parts = [f"{comment}\n# Computed by {self.script}.\n{self._camera}"]
        for entries in (self._lights, self._pigments, self._finishes, self._objects):
            parts.append("\n".join([str(len(entries)), *entries]))
        return "\n\n".join(parts) + "\n"


# ---- Shapes, as they are written -------------------------------------------------------------------------------------


def ball(center: Vector, radius: float) -> str:
    """A ball."""
    return f"sphere {numbers((*center, radius))}"


def half_spaces(planes: Sequence[Plane]) -> str:
    """What half-spaces have in common."""
    return "\n".join([f"polyhedron {len(planes)}", *map(numbers, planes)])


def quadric(coefficients: Sequence[float]) -> str:
    """A surface of second degree, by its ten numbers."""
    return f"quadric {numbers(coefficients)}"


def csg(*operands: str) -> str:
    """Operands, each its sign, a blank, and a shape: `csg("+ sphere 0 0 0 1", "- sphere 1 0 0 1")`."""
    lines = [f"csg {len(operands)}"]
    for operand in operands:
        sign, shape = operand.split(" ", 1)
        first, *others = shape.splitlines()
        lines += [f"  {sign} 0 0 {first}", *(f"    {line}" for line in others)]
    return "\n".join(lines)


# ---- Vectors and bodies ----------------------------------------------------------------------------------------------


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

# ---- Scenes ----------------------------------------------------------------------------------------------------------

SKY = "1 0 0 1 0 0 0"
"""A finish that shines by itself, and takes neither light nor shadow."""


def solids() -> SceneText:
    """The five regular solids."""
    s = SceneText(
        "The five regular solids: 4, 6, 8, 12 and 20 half-spaces, each resting on a face, which is sunk a little into\n"
        "the floor, so that no two faces coincide. Sixteen lamps side by side soften the shadows.",
        (0, 3.3, -11.5),
        (0, 1.0, 0.1),
        33,
    )
    s.lamp((-60, 110, -60), (14, 0, 6), (4, 12, -9), (0.68, 0.65, 0.60), 4)
    s.light((90, 70, -80), (0.20, 0.22, 0.28))
    sky = s.pigment(sky_at("mint", 400))
    floor = s.solid((0.99, 0.94, 0.86))
    colors = [(0.92, 0.27, 0.22), (0.96, 0.62, 0.14), (0.40, 0.66, 0.26), (0.12, 0.55, 0.66), (0.42, 0.32, 0.66)]
    shine = s.finish(SKY)
    ground = s.finish("0.42 0.56 0 1 0.08 0 0", "a polished floor")
    matte = s.finish("0.40 0.62 0.20 40 0.06 0 0")
    s.sphere(sky, shine, (0, 0, 0), 400)
    s.polyhedron(floor, ground, [top(-0.2)])
    places = [
        (TETRAHEDRON, (-2.6, -1.9), 0.52, 10),
        (CUBE, (0.05, -2.2), 0.62, 28),
        (OCTAHEDRON, (2.6, -1.6), 0.80, 15),
        (DODECAHEDRON, (-1.6, 1.3), 1.10, 8),
        (ICOSAHEDRON, (1.7, 1.7), 1.15, 40),
    ]
    for color, (normals, (x, z), inradius, degrees) in zip(colors, places, strict=True):
        center = (x, -0.2 + inradius - 0.01, z)
        s.polyhedron(s.solid(color), matte, around(turned_down(normals, degrees), center, inradius))
    return s


def highlights() -> SceneText:
    """Exponents of the highlight."""
    s = SceneText(
        "Highlights: alpha is 1, 4, 16, 64, 256, 1024, 4096 from left to right; from top to bottom kd falls and ks\n"
        "grows. Phong's highlight is white on every colour, and goes out where the light does not reach.",
        (0, 0, -40),
        (0, 0, 0),
        9.9,
    )
    s.light((-30, 34, -40), (0.80, 0.79, 0.76))
    s.light((36, -10, -34), (0.22, 0.25, 0.34))
    wall = s.solid((0.13, 0.15, 0.20))
    shine = s.finish(SKY)
    s.polyhedron(wall, shine, [(0, 0, -1, 2.5)])
    rows = [(0.70, 0.20), (0.62, 0.40), (0.54, 0.60), (0.46, 0.80), (0.38, 1.0)]
    stops: Stops = [
        (0.0, (0.95, 0.28, 0.26)),
        (0.2, (0.98, 0.56, 0.14)),
        (0.4, (0.88, 0.78, 0.20)),
        (0.6, (0.26, 0.70, 0.42)),
        (0.8, (0.14, 0.56, 0.84)),
        (1.0, (0.56, 0.32, 0.80)),
    ]
    for across in range(7):
        pigment = s.solid(ramp(stops, across / 6))
        for down, (kd, ks) in enumerate(rows):
            finish = s.finish(f"0.24 {number(kd)} {number(ks)} {4**across} 0 0 0")
            s.sphere(pigment, finish, (3.9 - 1.3 * across, 2.6 - 1.3 * down, 0), 0.58)
    return s


def lanterns() -> SceneText:
    """Coloured, attenuated lights."""
    s = SceneText(
        "A colonnade at night. Each lantern is a ball that shines by itself (ka 1 under white ambient light), and\n"
        "just below it is a light of its colour, dimmed by 1 + 0.1 d + 0.2 d^2: it reaches a few columns, no more.",
        (0, 1.9, -6.6),
        (0, 2.0, 4),
        50,
    )
    sky = s.pigment(sky_at("night", 1000))
    stone = s.solid((0.92, 0.89, 0.84))
    floor = s.pigment("checker 0.86 0.84 0.80 0.42 0.40 0.42 1.5")
    shine = s.finish(SKY)
    wall = s.finish("0.06 0.80 0.1 20 0 0 0")
    polished = s.finish("0.05 0.70 0 1 0.25 0 0")
    s.sphere(sky, shine, (0, 0, 0), 1000)
    s.sphere(s.solid((0.98, 0.95, 0.86)), shine, (45, 235, 720), 52)  # the moon
    s.polyhedron(floor, polished, [top(-0.1)])
    colors = [(1.0, 0.62, 0.22), (1.0, 0.30, 0.40), (0.72, 0.38, 1.0), (0.22, 0.60, 1.0), (0.15, 0.90, 0.65)]
    for k in range(5):
        z = 4.5 * k - 1.0
        for side in (-1, 1):
            x = 2.6 * side
            s.polyhedron(stone, wall, [*column(8, x, z, 0.40, 22.5), top(4.6), bottom(-0.11)])
            s.polyhedron(stone, wall, box((x - 0.6, -0.12, z - 0.6), (x + 0.6, 0.25, z + 0.6)))
            s.polyhedron(stone, wall, box((x - 0.6, 4.0, z - 0.6), (x + 0.6, 4.35, z + 0.6)))
        lantern = s.solid(mix(colors[k], (1, 1, 1), 0.5))
        for side in (-1, 1):
            s.sphere(lantern, shine, (2.6 * side, 2.5, z - 2.25), 0.2)
            s.light((2.6 * side, 2.25, z - 2.25), scale(colors[k], 1.4), (1, 0.1, 0.2))
    for side in (-1, 1):  # beams on the columns, without end
        s.polyhedron(stone, wall, [(1, 0, 0, -2.6 * side - 0.5), (-1, 0, 0, 2.6 * side - 0.5), bottom(4.3), top(5.0)])
    return s


def endless() -> SceneText:
    """Open polyhedra."""
    s = SceneText(
        "Bodies without end: stairs, each step two half-spaces; pillars of eight, six, four and three planes that no\n"
        "plane closes above or below; a floor of one.",
        (0.9, 2.6, -13),
        (0, 3.6, 0),
        40,
    )
    s.light((90, 120, -130), (0.62, 0.54, 0.42))
    s.light((-60, 40, -90), (0.12, 0.15, 0.22))
    sky = s.pigment(sky_at("desert", 300))
    stone = s.solid((0.96, 0.90, 0.80))
    gold = s.solid((0.98, 0.76, 0.30))
    shine = s.finish(SKY)
    matte = s.finish("0.42 0.62 0 1 0 0 0")
    shiny = s.finish("0.20 0.40 0.6 80 0.40 0 0")
    s.sphere(sky, shine, (0, 0, 0), 300)
    s.polyhedron(stone, matte, [top(-0.2)])
    for k in range(9):
        s.polyhedron(stone, matte, [top(0.45 + 0.65 * k), (0, 0, -1, 2.4 * k - 2.5)])
    colors = [(0.90, 0.42, 0.32), (0.22, 0.52, 0.58), (0.95, 0.68, 0.28), (0.46, 0.38, 0.60)]
    for k, (color, sides) in enumerate(zip(colors, (8, 6, 4, 3), strict=True)):
        pigment = s.solid(color)
        for side in (-1, 1):
            s.polyhedron(pigment, matte, column(sides, 3.9 * side, 4.8 * k - 0.4, 0.7 if sides > 3 else 0.5, 10 * side))
    s.sphere(gold, shiny, (0, 7.5, 18), 1.85)
    s.sphere(gold, shiny, (1.4, 1.0, -1.5), 0.55)
    return s


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


def brilliant() -> SceneText:
    """A cut diamond and two coloured stones."""
    s = SceneText(
        "Brilliants of 73 facets, as they are cut from diamond: most light that enters through the crown is reflected\n"
        "totally by the pavilion, twice, and comes out again. Inside a stone a ray meets facet after facet, and its\n"
        "finish's ka adds a little of the stone's colour each time.",
        (0, 5.0, -9.5),
        (0, 0.85, 0),
        30,
    )
    s.light((-5, 9, -5), (0.50, 0.48, 0.45))
    s.light((6, 7, -6), (0.20, 0.22, 0.28))
    room_pigment = s.pigment("texmap textures/softboxes.ppm\n0.0124 0 0 0.5\n0 -0.0124 0 0.5")
    velvet = s.solid((0.32, 0.22, 0.42))
    clear = s.solid((0.90, 0.94, 1.00))
    ruby = s.solid((1.00, 0.05, 0.16))
    sapphire = s.solid((0.06, 0.22, 1.00))
    shine = s.finish(SKY)
    cloth = s.finish("0.40 0.60 0 1 0.12 0 0")
    diamond = s.finish("0.015 0 0.4 400 0.04 0.90 2.42", "kr 0.04: two of them weigh less than the cut-off")
    colored = s.finish("0.065 0 0.4 400 0.04 0.85 1.77")
    s.sphere(room_pigment, shine, (0, 0, 0), 40)
    s.polyhedron(velvet, cloth, [top(-0.1)])

    def pose(tilt: float, azimuth: float) -> Callable[[Vector], Vector]:
        return lambda n: turned(turned(turned(n, 1, 7), 0, tilt), 1, azimuth)

    s.polyhedron(clear, diamond, brilliant_planes((0, 1.193, 0), 1.7, pose(-32, 8)))
    s.polyhedron(ruby, colored, brilliant_planes((-2.55, 0.523, -0.4), 0.9, pose(-40, -30)))
    s.polyhedron(sapphire, colored, brilliant_planes((2.55, 0.523, -0.4), 0.9, pose(-40, 34)))
    return s


def mirror_ball() -> SceneText:
    """A ball of hundreds of mirrors."""
    s = SceneText("", (0, 0.4, -9), (0, 0.25, 0), 34)
    rainbow = s.pigment("texmap rainbow1.ppm\n0.0024 0.0017 0 0.62\n0 0 0 0")
    silver = s.solid((0.90, 0.92, 0.95))
    shine = s.finish("0.85 0 0 1 0 0 0")
    mirror = s.finish("0.02 0.12 0.6 60 0.86 0 0")
    s.sphere(rainbow, shine, (0, 0, 0), 200)
    normals: list[Vector] = []
    rings = 19
    for ring in range(rings):
        latitude = math.pi * (ring + 0.5) / rings
        count = max(4, round(2 * rings * math.sin(latitude)))
        for k in range(count):
            normals.append(turned((math.sin(latitude), math.cos(latitude), 0), 1, 360 * k / count + 3))
    s.comment = f"A mirror ball: one polyhedron of {len(normals)} planes, all at the same distance from its centre."
    s.polyhedron(silver, mirror, around(normals, (0, 0.2, 0), 1.9))
    s.polyhedron(
        s.solid((0.30, 0.26, 0.40)), s.finish("0.6 0.5 0.4 30 0 0 0"), [*column(6, 0, 0, 0.04, 10), bottom(2.05)]
    )
    s.light((-6, 9, -8), (0.45, 0.43, 0.40))
    s.light((8, 4, -8), (0.20, 0.22, 0.28))
    return s


def infinity() -> SceneText:
    """A room of mirrors."""
    s = SceneText(
        "A room whose six walls are mirrors (kr 0.82), with rods along its edges and lamps that shine by themselves.\n"
        "Each ray goes from wall to wall until its weight has fallen below 1/512: after 32 of them.",
        (-1.9, 0.55, -2.5),
        (0.75, -0.1, 1.2),
        64,
    )
    glass = s.solid((0.10, 0.22, 0.34))
    shine = s.finish(SKY)
    mirror = s.finish("0.04 0 0 1 0.82 0 0")
    gold = s.finish("0.55 0.40 0.3 30 0 0 0")
    s.light((0, 1.2, 0), (0.9, 0.85, 0.75))
    half = (3, 2, 3)
    s.polyhedron(glass, mirror, box((-3, -2, -3), half))
    brass = s.solid((0.86, 0.62, 0.28))
    for axis in range(3):
        # Each direction's rods are a little thinner than the last one's, and all end inside those they meet.
        thickness = 0.080 - 0.006 * axis
        for i in (-1, 1):
            for j in (-1, 1):
                low, high = [0.05 - h for h in half], [h - 0.05 for h in half]
                for other, side in (((axis + 1) % 3, i), ((axis + 2) % 3, j)):
                    low[other] = side * (half[other] - 0.05) - thickness / 2
                    high[other] = low[other] + thickness
                s.polyhedron(brass, gold, box((low[0], low[1], low[2]), (high[0], high[1], high[2])))
    stops: Stops = [
        (0.0, (1.00, 0.30, 0.25)),
        (0.25, (1.00, 0.72, 0.20)),
        (0.5, (0.30, 0.90, 0.60)),
        (0.75, (0.25, 0.60, 1.00)),
        (1.0, (0.85, 0.35, 0.95)),
    ]
    for k in range(9):
        x, _, z = turned((1.35, 0, 0), 1, 75 * k)
        s.sphere(s.solid(ramp(stops, k / 8)), shine, (x, -1.5 + 3 * k / 8, z), 0.22)
    return s


def poster() -> SceneText:
    """Nothing but ambient light."""
    s = SceneText(
        "A landscape cut from paper: every finish is ka alone. With no kd and no ks no light matters and nothing is\n"
        "in shadow, with no kr and no kt nothing is traced beyond the first hit: a pixel is one ray.",
        (0, 6, -40),
        (0, 11, 0),
        40,
    )
    sky = s.pigment(sky_at("poster", 400))
    paper = s.finish(SKY)
    s.sphere(sky, paper, (0, 0, 0), 400)
    s.sphere(s.solid((1.0, 0.94, 0.76)), paper, (-34, 62, 300), 27)
    ranges = [  # distance, colour, snow's colour, peaks as (x, apex, slope)
        (
            190,
            (0.74, 0.46, 0.52),
            (0.98, 0.84, 0.74),
            [(-150, 52, 0.9), (-95, 70, 1.1), (-30, 50, 0.9), (40, 84, 1.15), (105, 60, 1.0), (165, 66, 1.0)],
        ),
        (
            120,
            (0.52, 0.32, 0.46),
            (0.95, 0.76, 0.70),
            [(-100, 34, 0.9), (-58, 46, 1.1), (-8, 30, 0.8), (34, 26, 0.8), (78, 44, 1.05), (120, 30, 0.9)],
        ),
        (60, (0.34, 0.22, 0.38), None, [(-60, 18, 0.7), (-30, 13, 0.6), (10, 10, 0.5), (40, 16, 0.6), (70, 20, 0.7)]),
    ]
    for distance, color, snow, peaks in ranges:
        rock = s.solid(color)
        for k, (x, apex, slope) in enumerate(peaks):
            s.polyhedron(rock, paper, pyramid(x, distance, apex, slope, 38 + 11 * k))
        if snow:
            white = s.solid(snow)
            for k, (x, apex, slope) in enumerate(peaks):
                tilt = 0.2 - 0.1 * (k % 3)
                line = (tilt, -1, 0, 0.78 * apex - tilt * x)  # where the snow ends
                s.polyhedron(white, paper, [*pyramid(x, distance, apex + 0.3, slope, 38 + 11 * k), line])
    s.sphere(s.solid((0.22, 0.18, 0.32)), paper, (-30, -300, 40), 300.5)
    s.sphere(s.solid((0.15, 0.14, 0.27)), paper, (26, -200, 8), 200.5)
    trees = [s.solid((0.20, 0.17, 0.31)), s.solid((0.11, 0.12, 0.23)), s.solid((0.07, 0.09, 0.18))]
    for k in range(34):
        z = 30 - 52 * k / 33
        x_tree = (k * GOLDEN % 1 - 0.5) * (44 + 1.1 * z)
        x_tree += 5 if x_tree > 0 else -5  # a clearing in the middle
        height = 5.5 + 3 * (k * 0.7548776662 % 1)
        foot = -1.2 - 0.002 * x_tree * x_tree
        pine = trees[0 if z > 14 else 1 if z > -8 else 2]
        for tier in range(3):
            sides = pyramid(x_tree, z, foot + height * (0.55 + 0.225 * tier), 2.2, 20 + 13 * k)
            s.polyhedron(pine, paper, [*sides, bottom(foot + height * (0.12 + 0.25 * tier))])
    return s


def checker() -> SceneText:
    """Solid checkerboards."""
    s = SceneText(
        "Checker is a pattern of cubes in space, and bodies are cut from it: a ball shows it in rings, a cube on its\n"
        "corner in triangles and hexagons. The pattern's own faces lie off those of the bodies.",
        (1.5, 3.0, -10.7),
        (0.1, 1.2, 0),
        29,
    )
    s.lamp((-60, 150, -80), (12, 0, 6), (2, 9, -9), (0.56, 0.54, 0.50), 3)
    s.light((80, 70, -80), (0.16, 0.18, 0.24))
    sky = s.pigment(sky_at("desert", 300))
    shine = s.finish(SKY)
    ground = s.finish("0.42 0.54 0 1 0.06 0 0")
    matte = s.finish("0.40 0.60 0.3 50 0.03 0 0")
    s.sphere(sky, shine, (0, 0, 0), 300)
    s.polyhedron(s.solid((0.99, 0.86, 0.70)), ground, [top(-0.2)])

    def checkered(first: Color, second: Color, size: float) -> int:
        return s.pigment(f"checker {numbers((*first, *second))} {number(size)}")

    cream = (0.97, 0.91, 0.80)
    red = checkered((0.90, 0.26, 0.20), cream, 0.55)
    teal = checkered((0.08, 0.40, 0.44), cream, 0.42)
    amber = checkered((0.97, 0.68, 0.18), (0.46, 0.22, 0.16), 0.40)
    violet = checkered((0.36, 0.28, 0.56), (0.92, 0.86, 0.88), 0.36)
    s.sphere(red, matte, (0.15, 1.4, 1.3), 1.6)
    on_corner = [turned(turned(n, 1, 45), 0, 54.735610) for n in CUBE]
    s.polyhedron(teal, matte, around([turned(n, 1, 12) for n in on_corner], (-2.2, 1.15, -0.2), 0.8))
    s.polyhedron(amber, matte, [*column(4, 2.55, -0.4, 0.75, 24), bottom(-0.21), top(1.12)])
    s.sphere(violet, matte, (-0.35, 0.45, -2.0), 0.65)
    s.polyhedron(violet, matte, [*pyramid(3.3, 3.2, 3.2, 2.1, 20), bottom(-0.21)])
    s.sphere(amber, matte, (-3.1, 0.5, 2.4), 0.7)
    return s


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


def sphereflake() -> SceneText:
    """Balls on balls."""
    s = SceneText(
        "Eric Haines's sphereflake: every ball carries nine of a third of its size, in three generations: 91 mirrors.",
        (-2.9, 1.7, -5.2),
        (0, 0.55, 0),
        32,
    )
    s.light((-40, 60, -40), (0.55, 0.50, 0.45))
    s.light((8, 6, -8), (0.22, 0.24, 0.30))
    sky = s.pigment(sky_at("sunset", 800))
    floor = s.solid((0.72, 0.46, 0.54))
    shine = s.finish(SKY)
    ground = s.finish("0.45 0.55 0 1 0.15 0 0")
    mirror = s.finish("0.14 0.32 0.6 80 0.56 0 0")
    colors = [(0.98, 0.74, 0.40), (0.94, 0.46, 0.40), (0.66, 0.42, 0.72), (0.40, 0.40, 0.75)]
    pigments = [s.solid(color) for color in colors[:3]]
    s.sphere(sky, shine, (0, 0, 0), 800)
    s.polyhedron(floor, ground, [top(-0.72)])

    for generation, center, radius in flake((0, 0.3, 0), 1, unit((0.25, 1, -0.2)), 3):
        s.sphere(pigments[generation], mirror, center, radius)
    return s


def prisms() -> SceneText:
    """Total internal reflection in glass."""
    s = SceneText(
        "Glass columns with three, four and six sides before coloured posts. Light that has entered one may meet its\n"
        "next side at more than 41.8 degrees from the normal; it cannot leave there, and goes on as from a mirror.\n"
        "So posts appear a second time, the other way round.",
        (0, 2.4, -11),
        (0, 1.3, 0),
        27,
    )
    s.light((-40, 90, -80), (0.66, 0.64, 0.60))
    s.light((50, 60, -90), (0.30, 0.32, 0.36))
    sky = s.pigment(sky_at("night", 200))
    floor = s.solid((0.92, 0.93, 0.95))
    glass_pigment = s.solid((0.85, 0.95, 0.93))
    shine = s.finish(SKY)
    ground = s.finish("0.40 0.50 0 1 0.08 0 0")
    matte = s.finish("0.46 0.66 0.2 40 0 0 0")
    glass = s.finish("0.02 0 0.5 250 0.04 0.93 1.5")
    s.sphere(sky, shine, (0, 0, 0), 200)
    s.polyhedron(floor, ground, [top(-0.2)])
    stops: Stops = [
        (0.0, (0.90, 0.22, 0.24)),
        (0.2, (0.97, 0.55, 0.13)),
        (0.4, (0.97, 0.84, 0.24)),
        (0.6, (0.25, 0.65, 0.36)),
        (0.8, (0.13, 0.47, 0.74)),
        (1.0, (0.45, 0.26, 0.62)),
    ]
    for k in range(13):
        x = 0.64 * (6 - k)
        z = 1.3
        side = column(4, x, z, 0.22, 11 * k)
        s.polyhedron(s.solid(ramp(stops, k / 12)), matte, [*side, bottom(-0.21), top(2.9 + 0.45 * math.cos(k * 0.9))])
    for sides, x, z, inradius, degrees, height in (
        (3, 2.1, -0.9, 0.5, 90, 2.0),
        (4, 0, -0.7, 0.72, 38, 2.5),
        (6, -2.1, -0.9, 0.75, 12, 1.8),
    ):
        s.polyhedron(glass_pigment, glass, [*column(sides, x, z, inradius, degrees), bottom(-0.18), top(height)])
    return s


def dice() -> SceneText:
    """Cubes that a ball rounds and that balls are drilled into."""
    s = SceneText(
        "Dice: what a cube and a ball have in common, less 21 balls for the eyes. One is of glass.",
        (1.2, 4.6, -9.5),
        (0.1, 0.75, 0),
        27,
    )
    s.light((-30, 50, -30), (0.62, 0.60, 0.56))
    s.light((20, 30, -40), (0.26, 0.27, 0.30))
    sky = s.pigment(sky_at("sunset", 300))
    felt = s.pigment("checker 0.10 0.40 0.26 0.08 0.34 0.22 0.9")
    colors = [(0.95, 0.92, 0.84), (0.80, 0.10, 0.12), (0.88, 0.95, 0.98)]
    ivory, red, clear = (s.solid(color) for color in colors)
    shine = s.finish(SKY)
    cloth = s.finish("0.35 0.60 0 1 0 0 0")
    lacquer = s.finish("0.26 0.62 0.5 120 0.06 0 0")
    glass = s.finish("0.02 0.03 0.8 300 0.08 0.88 1.5")
    s.sphere(sky, shine, (0, 0, 0), 300)
    s.polyhedron(felt, cloth, [top(0)])
    s.body(ivory, lacquer, die((-1.55, 1, 0.9), 32))
    s.body(red, lacquer, die((1.6, 1, 1.2), -18))
    s.body(clear, glass, die((0.35, 1.001, -2.1), 9))
    return s


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


SCENES: dict[str, Callable[[], SceneText]] = {
    "dice": dice,
    "brilliant": brilliant,
    "checker": checker,
    "endless": endless,
    "highlights": highlights,
    "infinity": infinity,
    "lanterns": lanterns,
    "mirror_ball": mirror_ball,
    "poster": poster,
    "prisms": prisms,
    "solids": solids,
    "sphereflake": sphereflake,
}

# ---- Writing and drawing ---------------------------------------------------------------------------------------------

PICTURE = (240, 180)
"""Size of a picture in pixels."""

OPTIONS: dict[str, dict[str, str]] = {"bubble": {"ior": "ratio"}}
"""Settings that scenes are to be drawn with, where these are not the default ones."""


def generated() -> dict[str, bytes]:
    """Every file that this script writes without --pictures, by its path in this folder."""
    files = {name: make() for name, make in TEXTURES.items()}
    files |= {f"{name}.in": str(make()).encode() for name, make in SCENES.items()}
    return files


def palette_png(pixels: Any) -> bytes:
    """A PNG file of at most 256 colours, a third as large as one of all.

    The colours are found by median cut (Heckbert, "Color image quantization for frame buffer display", 1982).

    Args:
        pixels: (height, width, 3) array, 0 to 255.
    """
    import numpy as np

    height, width, _ = pixels.shape
    colors = pixels.reshape(-1, 3)
    boxes = [np.arange(len(colors))]
    spreads = [1.0]
    while len(boxes) < 256 and max(spreads) > 0:
        # The box that is widest for the number of its pixels is cut in two, across its widest channel.
        widest = int(np.argmax(spreads))
        box = boxes.pop(widest)
        spreads.pop(widest)
        values = colors[box, np.argmax(np.ptp(colors[box], axis=0))]
        low = values <= (values.min() + values.max()) / 2
        for part in (box[low], box[~low]):
            if len(part) > 0:
                boxes.append(part)
                spreads.append(float(np.ptp(colors[part], axis=0).max()) * len(part) ** 0.4)
    indices = np.zeros(len(colors), np.uint8)
    for k, box in enumerate(boxes):
        indices[box] = k
    palette = np.array([np.rint(colors[box].mean(axis=0)) for box in boxes], np.uint8)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = np.insert(indices.reshape(height, width), 0, 0, axis=1)  # each row begins with its filter: none
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
        + chunk(b"PLTE", palette.tobytes())
        + chunk(b"IDAT", zlib.compress(rows.tobytes(), 9))
        + chunk(b"IEND", b"")
    )


def draw_pictures(names: Sequence[str]) -> None:
    """Draw scenes into pictures/, each with nine rays a pixel; all of them if none is named."""
    import numpy as np

    from converter.renderers.native import NativeRenderer
    from converter.scene.parser import load_scene
    from converter.scene.settings import Settings

    (FOLDER / "pictures").mkdir(exist_ok=True)
    for name in names or sorted(file.stem for file in FOLDER.glob("*.in")):
        settings = Settings(*PICTURE, samples=9, **OPTIONS.get(name, {}))  # type: ignore[arg-type]
        rendering = NativeRenderer().render(load_scene(FOLDER / f"{name}.in"), settings)
        colors = np.clip(np.asarray(rendering.pixels, dtype=float), 0, 1)
        (FOLDER / "pictures" / f"{name}.png").write_bytes(palette_png(np.rint(255 * colors)))


def main() -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(
        description="Write the textures and computed scenes, or draw the scenes' pictures."
    )
    parser.add_argument(
        "--pictures", nargs="*", metavar="NAME", help="draw these scenes, or all, and write nothing else"
    )
    pictures = parser.parse_args().pictures
    if pictures is not None:
        draw_pictures(pictures)
        return
    for name, data in generated().items():
        path = FOLDER / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)


if __name__ == "__main__":
    main()
