"""The textures that are computed."""

import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

from making.text import number
from making.vectors import Color

Stops = Sequence[tuple[float, Color]]


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


def dance_floor() -> bytes:
    """A floor of eight by eight tiles of coloured light, with dark joints."""
    tiles, texels = 8, 12
    colors = [
        (0.95, 0.16, 0.52),
        (0.10, 0.62, 0.95),
        (0.46, 0.18, 0.90),
        (0.98, 0.62, 0.12),
        (0.08, 0.75, 0.62),
        (0.16, 0.16, 0.42),
    ]

    def color(column: int, row: int) -> Color:
        if column % texels == 0 or row % texels == 0:
            return (0.03, 0.03, 0.05)
        x, z = column // texels, row // texels
        return colors[(2 * x + 3 * z + x * z) % len(colors)]

    return ppm([color(column, row) for column in range(tiles * texels)] for row in range(tiles * texels))


def spotlights() -> bytes:
    """Lamps of a dark hall, four by four: white in the middle."""
    lamps, texels = 4, 24
    colors = [(1.00, 0.20, 0.55), (0.15, 0.65, 1.00), (1.00, 0.70, 0.20), (0.60, 0.30, 1.00), (0.20, 0.90, 0.70)]

    def color(column: int, row: int) -> Color:
        i, j = column // texels, row // texels
        x, y = (2 * (c % texels + 0.5) / texels - 1 for c in (column, row))
        tint = colors[(2 * i + 3 * j + i * j) % len(colors)]
        r = math.hypot(x, y)
        return (1, 1, 1) if r < 0.34 else tint if r < 0.72 else (0.05, 0.05, 0.11)

    return ppm([color(column, row) for column in range(lamps * texels)] for row in range(lamps * texels))


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
    "textures/dance_floor.ppm": dance_floor,
    "textures/pool.ppm": pool,
    "textures/room.ppm": room,
    "textures/skies.ppm": skies,
    "textures/softboxes.ppm": softboxes,
    "textures/spotlights.ppm": spotlights,
}
