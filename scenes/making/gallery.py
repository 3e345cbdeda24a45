"""The computed scenes of the gallery."""

import math
from collections.abc import Callable

from making.bodies import brilliant_planes, die, flake
from making.text import SKY, SceneText, number, numbers
from making.textures import Stops, mix, ramp, sky_at
from making.vectors import (
    CUBE,
    DODECAHEDRON,
    GOLDEN,
    ICOSAHEDRON,
    OCTAHEDRON,
    TETRAHEDRON,
    Color,
    Vector,
    add,
    around,
    bottom,
    box,
    column,
    dot,
    pyramid,
    scale,
    top,
    turned,
    turned_down,
    unit,
)


def solids() -> SceneText:
    """The five regular solids."""
    s = SceneText(
        "The five regular solids: 4, 6, 8, 12 and 20 half-spaces, each resting on a face, which is sunk a little into\n"
        "the floor, so that no two faces coincide. Sixteen lamps side by side soften the shadows.",
        (0.0, 5.4, -10.6),
        (0, 0.5, 0.1),
        32.5,
    )
    s.lamp((-70, 90, -20), (14, 0, 6), (4, 12, -9), (0.80, 0.74, 0.64), 4)
    s.light((90, 70, -80), (0.14, 0.16, 0.24))
    sky = s.pigment(sky_at("mint", 400))
    floor = s.solid((0.98, 0.90, 0.80))
    colors = [(0.98, 0.22, 0.20), (1.00, 0.64, 0.10), (0.36, 0.76, 0.24), (0.08, 0.62, 0.80), (0.58, 0.36, 0.90)]
    shine = s.finish(SKY)
    ground = s.finish("0.40 0.58 0 1 0.08 0 0", "a polished floor")
    matte = s.finish("0.34 0.70 0.20 40 0.06 0 0")
    s.sphere(sky, shine, (0, 0, 0), 400)
    s.polyhedron(floor, ground, [top(-0.2)])
    places = [
        (TETRAHEDRON, (-2.2, -1.55), 0.56, 10),
        (CUBE, (0.05, -2.1), 0.68, 28),
        (OCTAHEDRON, (2.3, -1.3), 0.84, 15),
        (DODECAHEDRON, (-1.5, 1.5), 1.10, 8),
        (ICOSAHEDRON, (1.6, 1.7), 1.15, 40),
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


def thrown(lamp: Vector, mirror: Vector, normal: Vector, z: float) -> tuple[Vector, float] | None:
    """Where a small mirror throws a lamp's light on the plane at a z before it, and how long the way there is; None if
    it does not, or nearly along itself or along the plane.
    """
    ray = unit(add(mirror, scale(lamp, -1)))
    facing = -dot(ray, normal)
    out = add(ray, scale(normal, 2 * facing))
    if facing < 0.2 or out[2] < 0.3:
        return None
    way = (z - mirror[2]) / out[2]
    return add(mirror, scale(out, way)), way


def mirror_ball() -> SceneText:
    """A ball of hundreds of mirrors."""
    center, inradius = (0.0, 3.25, 0.0), 1.9
    normals: list[Vector] = []
    rings = 19
    for ring in range(rings):
        latitude = math.pi * (ring + 0.5) / rings
        count = max(4, round(2 * rings * math.sin(latitude)))
        for k in range(count):
            normals.append(turned((math.sin(latitude), math.cos(latitude), 0), 1, 360 * k / count + 3))
    s = SceneText(
        f"A mirror ball: one polyhedron of {len(normals)} planes, all at one distance from its centre. A spot glows\n"
        "on the wall wherever one of its mirrors throws the light of one of four lamps, which are not drawn.",
        (0, 1.15, -9.2),
        (0, 2.72, 0),
        37,
    )
    s.light((0, 11, -4), (0.42, 0.40, 0.38), (0.5, 0.03, 0.004))
    for position, color, attenuation in (
        ((-5.6, 4.6, 5.2), (1.00, 0.10, 0.50), (0.45, 0.10, 0.08)),
        ((5.6, 4.6, 5.2), (0.05, 0.50, 1.00), (0.45, 0.10, 0.08)),
        ((0, 0.9, 5.6), (0.50, 0.12, 0.95), (0.7, 0.20, 0.12)),
    ):
        s.light(position, color, attenuation)  # close to the wall, each a pool of its colour on it
    hall = s.pigment("texmap textures/spotlights.ppm\n0.0584 0 0 0.43\n0 -0.0584 0 0.11")
    tiles = s.pigment("texmap textures/dance_floor.ppm\n0.1 0 0 0.5\n0 0 0.1 0")
    plaster = s.solid((0.70, 0.66, 0.80))
    silver = s.solid((0.90, 0.92, 0.95))
    brass = s.solid((0.86, 0.66, 0.36))
    cord = s.solid((0.30, 0.26, 0.40))
    shine = s.finish(SKY)
    mirror = s.finish("0.02 0.12 0.6 60 0.86 0 0")
    matte = s.finish("0.04 0.60 0 1 0 0 0")
    glowing = s.finish("0.80 0.10 0 1 0.14 0 0", "tiles of glass over lamps")
    metal = s.finish("0.12 0.30 0.6 40 0.2 0 0")
    wall = 7.0
    s.sphere(hall, shine, (0, 0, 0), 40)
    s.polyhedron(tiles, glowing, [top(0)])
    s.polyhedron(plaster, matte, [(0, 0, -1, wall)])
    s.polyhedron(silver, mirror, around(normals, center, inradius))
    s.polyhedron(brass, metal, [*column(12, 0, 0, 0.30), bottom(5.0), top(5.28)])
    s.polyhedron(cord, matte, [*column(6, 0, 0, 0.018, 10), bottom(5.2)])
    lamps: list[tuple[Vector, Color]] = [
        ((-9, 6, 3), (1.00, 0.45, 0.75)),
        ((9, 6, 3), (0.45, 0.80, 1.00)),
        ((-5, 10, 1), (1.00, 0.85, 0.55)),
        ((5, 10, 1), (0.75, 0.60, 1.00)),
    ]
    for lamp, color in lamps:
        pigment = s.solid(color)
        for n in normals:
            found = thrown(lamp, add(center, scale(n, inradius)), n, wall)
            if found is None:
                continue
            (x, y, _), way = found
            if abs(x) < 7.2 and 0.3 < y < 8:  # in the picture
                radius = 0.035 + 0.005 * way
                # A ball that looks out of the wall by a disc of that radius.
                s.sphere(pigment, shine, (x, y, wall + math.sqrt(0.25 - radius**2)), 0.5)
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


def sphereflake() -> SceneText:
    """Balls on balls."""
    s = SceneText(
        "Eric Haines's sphereflake: every ball carries nine of a third of its size, in three generations: 91 mirrors.",
        (-2.7, 3.1, -4.6),
        (0.0, 0.27, 0),
        38.5,
    )
    s.light((-30, 60, -30), (0.74, 0.69, 0.60))
    s.light((8, 6, -8), (0.16, 0.18, 0.26))
    sky = s.pigment(sky_at("mint", 800))
    floor = s.solid((0.04, 0.31, 0.36))
    shine = s.finish(SKY)
    ground = s.finish("0.47 0.58 0 1 0.10 0 0")
    mirror = s.finish("0.13 0.36 0.7 120 0.56 0 0")
    pigments = [s.solid(color) for color in ((1.00, 0.66, 0.16), (0.98, 0.26, 0.22), (0.30, 0.70, 0.85))]
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
