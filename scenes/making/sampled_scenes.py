"""The scenes in which something is random."""

import math
from collections.abc import Callable

from making.bodies import cone, cylinder, ellipsoid, rod, turned_box
from making.text import SKY, SceneText, ball, csg, half_spaces, number, numbers
from making.textures import mix, sky_at
from making.vectors import GOLDEN, Color, Vector, add, bottom, box, dot, scale, top, turned, unit


class SampledScene(SceneText):
    """A scene with lamps of a size, a lens, and bodies that move."""

    script = "sampled.py"

    def lens(self, aperture: float, focal: float) -> None:
        """Give the camera a lens of that radius; it is in focus at that distance along the view."""
        self._camera += f" {number(aperture)} {number(focal)}"

    def disc(self, position: Vector, color: Color, radius: float, attenuation: Vector = (1, 0, 0)) -> None:
        """Add a lamp, a disc of that radius."""
        self.light(position, color, attenuation)
        self._lights[-1] += f" {number(radius)}"

    def sky(self, name: str, radius: float) -> int:
        """Add the pigment of a sky."""
        return self.pigment(sky_at(name, radius).replace("textures/", "../textures/"))

    def moves(self, displacement: Vector) -> None:
        """Let the body that was added last move while the shutter is open."""
        self._objects[-1] += f" move {numbers(displacement)}"


def evening() -> SampledScene:
    """Soft shadows."""
    s = SampledScene(
        "A still life in evening light. The low sun is a disc: through a window out of the picture it draws the bars\n"
        "on the wall, softer than the shadows of what stands near it. A wide, pale lamp for the sky casts hardly any.",
        (0.35, 2.55, -10.5),
        (0.1, 1.5, 0),
        27,
        (0.75, 0.74, 0.92),
    )
    s.disc((-17, 8.2, -11), (1.50, 1.02, 0.55), 0.8)
    s.disc((7, 13, -12), (0.13, 0.17, 0.28), 5)
    wall = s.solid((0.86, 0.72, 0.60))
    table = s.solid((0.64, 0.42, 0.29))
    plaster = s.finish("0.16 0.74 0 1 0 0 0")
    wood = s.finish("0.14 0.74 0.10 30 0.07 0 0 4")
    glaze = s.finish("0.16 0.74 0.40 70 0.06 0 0")
    matte = s.finish("0.16 0.78 0.08 12 0 0 0")
    s.polyhedron(wall, plaster, [(0, 0, -1, 3.2)])
    s.polyhedron(table, wood, [top(0), (0, 0, -1, -3.0), (0, 0, 1, -3.3), bottom(-0.2)])
    low, high, near, far = 1.6, 5.15, -4.4, 1.0
    for (y0, y1), (z0, z1) in (
        ((-9, low), (-16, 9)),
        ((high, 16), (-16, 9)),
        ((low, high), (-16, near)),
        ((low, high), (far, 9)),
        ((3.62, 3.78), (near, far)),
        ((low, high), (-1.32, -1.16)),
    ):
        s.polyhedron(wall, plaster, box((-5.1, y0, z0), (-5, y1, z1)))

    white, blue, ochre, rose, sage, cream, plum = (
        s.solid(color)
        for color in (
            (0.95, 0.91, 0.84),
            (0.30, 0.45, 0.62),
            (0.93, 0.64, 0.20),
            (0.82, 0.42, 0.34),
            (0.54, 0.64, 0.46),
            (0.95, 0.86, 0.70),
            (0.44, 0.16, 0.28),
        )
    )

    def bottle(pigment: int, x: float, z: float, radius: float, shoulder: float, height: float) -> None:
        s.body(pigment, glaze, cylinder(x, z, radius, 0.001, shoulder))
        s.body(pigment, glaze, ellipsoid((x, shoulder, z), (radius, 0.85 * radius, radius)))
        s.body(pigment, glaze, cylinder(x, z, 0.3 * radius, shoulder, height))
        s.body(pigment, glaze, cylinder(x, z, 0.4 * radius, height - 0.12, height))

    bottle(white, -0.25, 0.95, 0.46, 1.55, 3.15)
    bottle(blue, 0.80, 1.25, 0.40, 1.10, 2.35)
    s.polyhedron(rose, matte, [*turned_box((-1.35, 0.55, 0.85), (0.42, 0.55, 0.36), 18), bottom(0.001)])
    s.body(
        sage,
        glaze,
        csg(
            f"+ {ellipsoid((1.95, 0.62, 0.75), (0.66, 0.78, 0.66))}",
            f"- {ellipsoid((1.95, 0.72, 0.75), (0.60, 0.74, 0.60))}",
            f"& {half_spaces([top(1.12), bottom(0.001)])}",
        ),
    )
    s.body(
        cream,
        glaze,
        csg(
            f"+ {cone(-2.25, 0.05, (0.001, 0.62), (0.26, 0.52))}",
            f"- {cone(-2.25, 0.05, (0.06, 0.70), (0.22, 0.52))}",
        ),
    )
    s.body(ochre, matte, ellipsoid((0.62, 0.27, -0.55), (0.36, 0.27, 0.28)))
    s.body(ochre, matte, ellipsoid((1.28, 0.26, -0.25), (0.27, 0.26, 0.34)))
    s.sphere(plum, glaze, (-0.62, 0.25, -0.35), 0.25)
    return s


def frosted() -> SampledScene:
    """Glossy reflection and refraction."""
    s = SampledScene(
        "Brushed metal and frosted glass: finishes with a cone. Balls of copper, gold and steel spread what they\n"
        "mirror by 12, 5 and 2 degrees; the pane blurs what stands far behind it, and hardly what touches it; and the\n"
        "floor mirrors what is near more sharply than what is high.",
        (-0.4, 2.9, -11.5),
        (0.1, 1.25, 0.3),
        27,
    )
    s.disc((-9, 13, -9), (0.62, 0.58, 0.52), 2.2)
    s.disc((8, 14, 9), (0.50, 0.52, 0.60), 2.0)
    sky = s.sky("sunset", 300)
    shine = s.finish(SKY)
    ground = s.finish("0.20 0.30 0 1 0.42 0 0 4", "a dull floor")
    pane = s.finish("0.02 0 0.25 60 0.05 0.92 1.5 5", "frosted glass")
    clear = s.finish("0.02 0 0.50 300 0.08 0.90 1.5", "glass")
    metal = [s.finish(f"0.16 0.30 0.6 {alpha} 0.62 0 0 {degrees}") for alpha, degrees in ((12, 12), (40, 5), (90, 2))]
    gloss = s.finish("0.42 0.62 0.35 60 0.06 0 0")
    s.sphere(sky, shine, (0, 0, 0), 300)
    s.polyhedron(s.solid((0.50, 0.40, 0.46)), ground, [top(0)])
    s.polyhedron(s.solid((0.90, 1.00, 0.96)), pane, box((-0.35, 0.002, 1.2), (3.6, 3.1, 1.32)))
    for color, finish, (x, z), radius in (
        ((0.95, 0.58, 0.40), metal[0], (1.95, -0.9), 0.92),
        ((0.98, 0.78, 0.36), metal[1], (-0.1, -1.5), 0.80),
        ((0.86, 0.89, 0.92), metal[2], (-1.75, -0.7), 0.70),
    ):
        s.sphere(s.solid(color), finish, (x, radius, z), radius)
    s.sphere(s.solid((0.9, 0.95, 1.0)), clear, (0.95, 0.36, -2.3), 0.36)
    # Columns behind the pane, ever farther from it, and past its edge.
    colors = [(0.86, 0.20, 0.22), (0.95, 0.56, 0.12), (0.95, 0.80, 0.25), (0.30, 0.62, 0.36), (0.10, 0.46, 0.62)]
    for k, (color, x) in enumerate(zip(colors, (3.05, 2.15, 1.2, 0.15, -1.2), strict=True)):
        z = (1.75, 2.3, 3.1, 4.1, 2.4)[k]
        s.body(s.solid(color), gloss, cylinder(x, z, 0.27, 0.001, 2.2 + 0.18 * k))
        s.sphere(s.solid(mix(color, (1, 1, 1), 0.25)), gloss, (x, 2.45 + 0.18 * k, z), 0.34)
    s.sphere(s.solid((0.48, 0.30, 0.58)), gloss, (-2.55, 0.75, 2.2), 0.75)
    s.sphere(s.solid((0.90, 0.42, 0.48)), gloss, (-3.5, 0.42, 0.6), 0.42)
    return s


def dew() -> SampledScene:
    """Depth of field."""
    s = SampledScene(
        "Dew, close by: a lens of a quarter of a unit, in focus six units away. Lights far behind the leaf become\n"
        "discs, each as large as the lens makes it; a drop shows all of them once more, upside down and sharper.",
        (0.3, 1.75, -6.1),
        (0.1, 0.42, 0),
        25,
        up=(0.30, 1, 0),
    )
    s.lens(0.20, 6.0)
    s.disc((6, 11, -5), (0.85, 0.82, 0.70), 2.5)
    s.disc((-7, 6, 10), (0.45, 0.50, 0.36), 2.5)
    shine = s.finish(SKY)
    glow = s.finish("2.4 0 0 1 0 0 0", "a sparkle")
    blade = s.finish("0.22 0.62 0.25 14 0.08 0 0 14", "a leaf")
    water = s.finish("0.01 0 1 200 0.10 0.92 1.33", "a drop")
    shell = s.finish("0.18 0.66 0.7 120 0.10 0 0", "a ladybird")
    green = s.solid((0.30, 0.58, 0.16))
    s.sphere(s.solid((0.34, 0.55, 0.36)), shine, (0, 0, 0), 60)
    for k in range(9):  # brighter and darker places in the wood
        x, y = (k * GOLDEN % 1 - 0.5) * 34, (k * 0.7548776662 % 1) * 16 - 6
        color = ((0.66, 0.80, 0.46), (0.16, 0.34, 0.24), (0.94, 0.95, 0.78))[k % 3]
        s.sphere(s.solid(color), shine, (x, y, 40), 3.0 + k % 4)
    lights = [(0.98, 0.90, 0.55), (0.70, 0.86, 0.40), (0.98, 0.76, 0.44), (0.55, 0.78, 0.52), (0.95, 0.96, 0.80)]
    pigments = [s.solid(color) for color in lights]
    for k in range(34):
        x = (k * GOLDEN % 1 - 0.5) * 17
        y = (k * 0.7548776662 % 1) * 8.5 - 3.5
        s.sphere(pigments[k % 5], glow, (x, y, 15 + 9 * (k * 0.5698402910 % 1)), 0.16 + 0.16 * (k % 4) / 3)
    for k in range(7):  # other leaves, far out of focus
        x = -7 + 2.3 * k
        s.body(
            s.solid(mix((0.16, 0.36, 0.12), (0.40, 0.60, 0.20), k % 3 / 2)),
            blade,
            ellipsoid((x, -1.2 - 0.8 * (k % 2), 5 + 1.5 * (k * 3 % 4)), (0.5, 2.2 + 0.4 * (k % 3), 0.2)),
        )
    long, thick, wide = 6.2, 0.10, 1.30
    s.body(green, blade, ellipsoid((0, 0, 0), (long, thick, wide)))
    s.body(s.solid((0.56, 0.74, 0.30)), blade, ellipsoid((0, 0.035, 0), (long, 0.09, 0.05)))

    def height(x: float, z: float) -> float:
        return thick * math.sqrt(max(0.0, 1 - (x / long) ** 2 - (z / wide) ** 2))

    drops: list[tuple[float, float, float]] = [(0.35, -0.35, 0.44), (-1.15, 0.25, 0.52)]  # and the ladybird's place
    for k in range(400):
        x, z = (k * GOLDEN % 1 - 0.5) * 8, (k * 0.7548776662 % 1 - 0.5) * 2.2
        r = 0.05 + 0.20 * (k * 0.5698402910 % 1) ** 3
        if (x / long) ** 2 + (z / wide) ** 2 < 0.8 and all(
            math.hypot(x - u, z - w) > 1.06 * (r + q) for u, w, q in drops
        ):
            drops.append((x, z, r))
        if len(drops) == 70:
            break
    clear = s.solid((0.9, 1.0, 0.95))
    for k, (x, z, r) in enumerate(drops):
        if k != 1:
            s.sphere(clear, water, (x, height(x, z) + 0.86 * r, z), r)
    x, z = drops[1][:2]
    y = height(x, z)
    red, black, white = s.solid((0.90, 0.10, 0.05)), s.solid((0.04, 0.03, 0.03)), s.solid((0.95, 0.95, 0.90))
    body = ellipsoid((x, y + 0.04, z), (0.44, 0.36, 0.36))
    s.body(red, shell, csg(f"+ {body}", f"& {half_spaces([bottom(y + 0.03)])}"))
    s.body(
        black,
        shell,
        csg(
            f"+ {ellipsoid((x, y + 0.04, z), (0.443, 0.363, 0.363))}",
            f"& {half_spaces([(0, 0, 1, -z - 0.012), (0, 0, -1, z - 0.012), bottom(y + 0.03)])}",
        ),
    )
    for u, v, size in (
        (-0.24, -0.16, 0.075),
        (0.0, -0.21, 0.09),
        (0.22, -0.15, 0.07),
        (-0.12, 0.2, 0.08),
        (0.18, 0.2, 0.07),
        (-0.05, -0.31, 0.06),
    ):
        up = 0.36 * math.sqrt(max(0.0, 1 - (u / 0.44) ** 2 - (v / 0.36) ** 2))
        s.sphere(black, shell, (x + u, y + 0.02 + up, z + v), size)
    s.body(black, shell, ellipsoid((x + 0.42, y + 0.13, z), (0.16, 0.15, 0.19)))
    for side in (-1, 1):
        s.sphere(white, shell, (x + 0.48, y + 0.19, z + 0.11 * side), 0.05)
    return s


def billiards() -> SampledScene:
    """Motion."""
    s = SampledScene(
        "Billiards, a moment after the shot, after Thomas Porter's picture of 1984: the cue ball has met the 4, which\n"
        "runs into the 9 and the 8; the 1 has not been touched. What moves is blurred, with its number and its shadow.",
        (0.2, 8.2, -9.6),
        (0.1, 0.55, 0.35),
        31,
    )
    s.disc((-4.5, 11, 1.5), (0.78, 0.72, 0.58), 1.3)
    s.disc((5.0, 11, 2.5), (0.58, 0.56, 0.52), 1.3)
    night = s.sky("plum", 200)
    shine = s.finish(SKY)
    felt = s.finish("0.22 0.62 0 1 0 0 0")
    wood = s.finish("0.20 0.55 0.3 40 0.10 0 0 3")
    resin = s.finish("0.20 0.62 0.8 160 0.13 0 0")
    s.sphere(night, shine, (0, 0, 0), 200)
    s.polyhedron(s.solid((0.10, 0.46, 0.30)), felt, [top(0)])
    s.polyhedron(s.solid((0.08, 0.38, 0.25)), felt, [top(0.8), (0, 0.35, -1, 4.6), bottom(-0.1)])
    s.polyhedron(s.solid((0.46, 0.22, 0.10)), wood, [top(1.0), (0, 0, -1, 5.1), bottom(-0.1)])
    for k in range(5):
        s.body(s.solid((0.95, 0.92, 0.84)), resin, ellipsoid((-6.4 + 3.2 * k, 1.0, 6.0), (0.13, 0.02, 0.13)))

    def numbered(digit: str, center: Vector, face: Vector, roll: float) -> int:
        """The pigment of a ball whose number looks toward `face`, turned about that way."""
        forward = unit(face)
        right = unit((forward[2], 0, -forward[0]))
        upward = (
            forward[2] * right[1] - forward[1] * right[2],
            forward[0] * right[2] - forward[2] * right[0],
            forward[1] * right[0] - forward[0] * right[1],
        )
        c, q = math.cos(math.radians(roll)), math.sin(math.radians(roll))
        across = add(scale(right, c), scale(upward, q))
        down = add(scale(upward, c), scale(right, -q))
        column = ("1489".index(digit) + 0.5) / 4 - dot(center, scale(across, 0.124))
        row = 0.5 - dot(center, scale(down, 0.49))
        vectors = f"{numbers(scale(across, 0.124))} {number(column)}\n{numbers(scale(down, 0.49))} {number(row)}"
        return s.pigment(f"texmap ../textures/pool.ppm\n{vectors}")

    for digit, place, face, roll, displacement in (
        ("1", (-3.05, 1.5), (0.5, 0.9, -0.7), 16, None),
        ("9", (0.55, 3.05), (-0.25, 1, -0.75), -14, (-0.60, 0, 0.28)),
        ("8", (2.55, 1.75), (-0.35, 1, -0.9), 22, (0.80, 0, 0.12)),
        ("4", (-0.15, 0.25), (0.1, 1, -0.6), -8, (0.36, 0, 0.68)),
    ):
        center = (place[0], 1.0, place[1])
        s.sphere(numbered(digit, center, face, roll), resin, center, 1.0)
        if displacement:
            s.moves(displacement)
    s.sphere(s.solid((0.96, 0.94, 0.88)), resin, (-1.35, 1.0, -2.15), 1.0)
    s.moves((0.34, 0, 0.50))
    return s


def carousel() -> SampledScene:
    """Motion, all around."""
    s = SampledScene(
        "A chair swing at night, which turns by a twentieth while the shutter is open: every chair, chain and bulb\n"
        "moves along its own tangent. The pavement is wet, a mirror with a cone.",
        (0, 1.7, -15.5),
        (0, 3.5, 0),
        34,
    )
    night = s.sky("night", 400)
    shine = s.finish(SKY)
    bulb = s.finish("2.2 0 0 1 0 0 0", "a bulb")
    wet = s.finish("0.16 0.30 0 1 0.52 0 0 3", "wet pavement")
    paint = s.finish("0.34 0.66 0.3 30 0 0 0")
    s.sphere(night, shine, (0, 0, 0), 400)
    s.sphere(s.solid((0.96, 0.92, 0.80)), shine, (-98, 128, 330), 15)  # the moon
    s.disc((0, 3.6, -9), (1.15, 0.84, 0.55), 1.2, (1, 0.02, 0.006))
    s.disc((-9, 14, -16), (0.36, 0.38, 0.52), 2)
    s.polyhedron(s.solid((0.34, 0.36, 0.42)), wet, [top(0)])
    cream, red, teal, gold = (
        s.solid(c) for c in ((0.97, 0.90, 0.74), (0.84, 0.16, 0.16), (0.08, 0.46, 0.48), (0.95, 0.68, 0.22))
    )
    # The mast, and the roof: a cone of twenty segments, every second one red.
    for k in range(6):
        s.body((cream, red)[k % 2], paint, cylinder(0, 0, 0.55, 0.9 * k, 0.9 * k + 0.9))
    s.body(gold, paint, cylinder(0, 0, 1.5, 0, 0.35))
    segments = 20
    for k in range(segments):
        a, b = (2 * math.pi * (k + e) / segments for e in (-0.5, 0.5))
        wedge = half_spaces([(math.sin(a), 0, -math.cos(a), 0), (-math.sin(b), 0, math.cos(b), 0)])
        s.body((cream, red)[k % 2], paint, csg(f"+ {cone(0, 0, (5.75, 7.6), (3.5, 0.01))}", f"& {wedge}"))
        s.body((teal, gold)[k % 2], paint, csg(f"+ {cylinder(0, 0, 3.55, 5.35, 5.8)}", f"& {wedge}"))
    s.sphere(gold, bulb, (0, 7.75, 0), 0.22)
    lamps = [s.solid(c) for c in ((1.0, 0.80, 0.42), (1.0, 0.50, 0.36), (0.55, 0.85, 1.0))]
    turn = 2 * math.pi / 20  # while the shutter is open

    def tangent(x: float, z: float) -> Vector:
        """Around the mast, counterclockwise seen from above, from half a turn before to half a turn after."""
        return (turn * z, 0, -turn * x)

    for k in range(40):
        x, _, z = turned((3.6, 0, 0), 1, 9 * k)
        s.sphere(lamps[k % 3], bulb, (x - 0.2 * turn * z, 5.36, z + 0.2 * turn * x), 0.07)
        s.moves(scale(tangent(x, z), 0.45))
    chairs = [
        s.solid(c)
        for c in ((0.92, 0.26, 0.22), (0.98, 0.66, 0.16), (0.20, 0.62, 0.52), (0.26, 0.44, 0.82), (0.80, 0.36, 0.62))
    ]
    steel = s.solid((0.62, 0.64, 0.70))
    for k in range(15):
        hx, _, hz = turned((3.1, 0, 0), 1, 24 * k + 7)
        x, _, z = turned((4.9, 0, 0), 1, 24 * k + 7)
        way = scale(tangent(x, z), 0.36)
        start = scale(way, -0.5)
        top_end, seat = add((hx, 5.4, hz), scale(start, 0.65)), add((x, 2.75, z), start)
        s.body(steel, paint, rod(top_end, add(seat, (0, 0.3, 0)), 0.022))
        s.moves(scale(way, 0.8))
        outward = unit((x, -0.6, z))
        s.body(
            chairs[k % 5],
            paint,
            csg(f"+ {ball(seat, 0.42)}", f"& {half_spaces([(*outward, -dot(outward, seat) - 0.16)])}"),
        )
        s.moves(way)
        s.sphere(s.solid((0.90, 0.68, 0.52)), paint, add(seat, (0, 0.42, 0)), 0.17)
        s.moves(way)
    return s


def pinball() -> SampledScene:
    """All four."""
    s = SampledScene(
        "Pinball, all four in one: the lens is in focus on a ball of dull steel, which is hit as the shutter opens;\n"
        "lamps have a size, the playfield spreads what it mirrors, and the bulbs behind are discs of the lens.",
        (0.8, 3.1, -8.6),
        (0.15, 0.55, -0.4),
        30,
    )
    s.lens(0.13, 8.3)
    s.disc((-5, 9, -5), (0.80, 0.70, 0.56), 1.4)
    s.disc((6, 7, 2), (0.26, 0.34, 0.62), 1.6)
    s.sphere(s.sky("plum", 100), s.finish(SKY), (0, 0, 0), 100)
    bulb = s.finish("2.4 0 0 1 0 0 0", "a bulb")
    field = s.finish("0.16 0.44 0.2 30 0.30 0 0 4", "the playfield")
    steel = s.finish("0.24 0.30 1 40 0.62 0 0 3", "steel")
    gloss = s.finish("0.28 0.64 0.5 80 0 0 0")
    glass = s.finish("0.10 0.12 0.6 90 0 0.76 1.5 3", "a frosted cap")
    s.polyhedron(s.pigment("checker 0.10 0.16 0.36 0.12 0.24 0.46 1.3"), field, [top(0)])
    bodies = [(0.90, 0.22, 0.22), (0.98, 0.66, 0.14), (0.16, 0.62, 0.56), (0.72, 0.30, 0.66)]
    places = [
        (-1.9, 1.5, 0),
        (1.25, 2.2, 1),
        (-0.35, 5.0, 2),
        (3.2, 5.6, 3),
        (-3.9, 4.6, 1),
        (2.9, -1.3, 2),
        (-2.6, -2.6, 3),
    ]
    cream = s.solid((0.96, 0.92, 0.82))
    for x, z, k in places:
        color = s.solid(bodies[k])
        s.body(cream, gloss, cylinder(x, z, 0.62, 0.002, 0.16))
        s.body(color, gloss, cylinder(x, z, 0.44, 0.16, 0.62))
        s.body(cream, gloss, cylinder(x, z, 0.66, 0.62, 0.78))
        s.body(
            color, glass, csg(f"+ {ellipsoid((x, 0.79, z), (0.60, 0.34, 0.60))}", f"& {half_spaces([bottom(0.79)])}")
        )
        s.sphere(s.solid(mix(bodies[k], (1, 1, 1), 0.55)), bulb, (x, 0.93, z), 0.13)
    s.sphere(s.solid((0.88, 0.90, 0.94)), steel, (0.15, 0.42, -0.75), 0.42)
    s.moves((-0.50, 0, 0.36))
    s.sphere(s.solid((0.88, 0.90, 0.94)), steel, (1.35, 0.42, -3.2), 0.42)
    for k in range(26):
        x = (k * GOLDEN % 1 - 0.5) * 22
        s.sphere(
            s.solid(bodies[k % 4]), bulb, (x, 0.4 + 4.2 * (k * 0.7548776662 % 1), 13 + 6 * (k * 0.5698402910 % 1)), 0.16
        )
    rail = s.finish("0.14 0.20 0.8 80 0.60 0 0 2")
    s.body(s.solid((0.86, 0.70, 0.40)), rail, rod((-7, 0.5, 0.2), (-2.6, 0.5, 7.8), 0.09))
    s.body(s.solid((0.86, 0.70, 0.40)), rail, rod((7, 0.5, -0.5), (4.0, 0.5, 8.2), 0.09))
    return s


SCENES: dict[str, Callable[[], SampledScene]] = {
    "evening": evening,
    "frosted": frosted,
    "dew": dew,
    "billiards": billiards,
    "carousel": carousel,
    "pinball": pinball,
}
