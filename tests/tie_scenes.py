"""Small scenes of ties: each meets those of its kind, and most of them at slanting numbers, too."""

import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

from converter.scene.model import Checker, Csg, Finish, Operand, Polyhedron, Quadric, Scene, Shape, Texmap, Vector
from converter.scene.settings import Settings
from converter.studies.exact.tracer import ExactTracer, Pixel
from converter.studies.families.scenes import GLASS, GLOW, MATTE, WHITE, Body, box, camera, floor, light, scene, sphere

RED, GREEN, BLUE = (0.9, 0.2, 0.1), (0.1, 0.8, 0.2), (0.1, 0.2, 0.9)
MIRROR = Finish(0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
CLEAR = Finish(0.2, 0.0, 0.0, 1.0, 0.0, 0.7, 1.0)
"""Bends nothing, and adds a little at every surface."""
DENSE = Finish(0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.6)
"""Its critical angle has the sine 3/5, the cosine 4/5."""
LEVEL: Vector = (0.0, 0.0, -1.0)
UP: Vector = (0.0, 1.0, 0.0)
SLANTING: Vector = (3.0, 0.0, -4.0)
"""Of length 5: its frame is rational, and no double."""
ACROSS: Vector = (4.0, 0.0, 3.0)
SETTINGS = Settings(32, 24, pixel="corner", background=(0.0, 0.0, 0.3), cutoff=0.0, max_depth=4)
TEXELS = "P3 4 4 255" + "".join(
    f" {40 * c + 60} {60 * r + 20} {255 * ((c + r) % 2)}" for r in range(4) for c in range(4)
)


def view(eye: Vector, along: Vector = LEVEL, up: Vector = (0.0, 1.0, 0.0), fovy: float = 90.0):
    return camera(eye, tuple(round(e + a, 6) for e, a in zip(eye, along, strict=True)), fovy, up)


def checker(size: float) -> Checker:
    return Checker(WHITE, (0.1, 0.1, 0.1), size)


def wall(normal: Vector, offset: float) -> Polyhedron:
    return Polyhedron(((*normal, offset),))


def slanting_box(near: float, far: float, left: float, right: float, low: float, high: float) -> Polyhedron:
    """Between distances along SLANTING, and along ACROSS; both in fifths."""
    (fx, _, fz), (ax, _, az) = SLANTING, ACROSS
    return Polyhedron(
        (
            (-fx, 0.0, -fz, near),
            (fx, 0.0, fz, -far),
            (-ax, 0.0, -az, left),
            (ax, 0.0, az, -right),
            (0.0, -1.0, 0.0, low),
            (0.0, 1.0, 0.0, -high),
        )
    )


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    """A folder with the texture, kept as long as the process runs."""
    folder = tempfile.TemporaryDirectory(prefix="whitted-")
    Path(folder.name, "texels.ppm").write_text(TEXELS, encoding="ascii")
    return folder


def texmap(p0: tuple[float, ...], p1: tuple[float, ...]) -> Texmap:
    return Texmap(Path(_folder().name, "texels.ppm"), p0, p1)


def _tiles(size: float, eye: Vector, along: Vector = LEVEL, height: float = 0.0):
    return lambda: scene(view(eye, along), [(floor(height), checker(size), GLOW)])


def _texels(eye: Vector, along: Vector, scale: float):
    def made() -> Scene:
        pigment = texmap((scale, 0.0, 0.0, 0.0), (0.0, 0.0, scale, 0.25))
        return scene(view(eye, along), [(floor(), pigment, GLOW)])

    return made


def _balls_tiles() -> Scene:
    """The ray through the middle meets the ball's front, where two coordinates are whole, and the third, too."""
    return scene(view((0.0, 0.0, 4.0)), [(sphere((0.0, 0.0, 0.0), 1.5), checker(0.3), GLOW)])


def _mirrored_tiles() -> Scene:
    bodies: list[Body] = [
        (wall((0.0, 1.0, 1.0), 3.0), WHITE, MIRROR),
        (wall((0.0, -1.0, 0.0), 0.9), checker(0.3), GLOW),
    ]
    return scene(view((0.0, 0.0, 0.3)), bodies)


def _mirrored_twice() -> Scene:
    bodies: list[Body] = [
        (wall((1.0, 0.0, 1.0), 1.2), WHITE, MIRROR),
        (wall((-1.0, 0.0, 0.0), -3.0), WHITE, MIRROR),
        (floor(-0.9), checker(0.3), GLOW),
    ]
    return scene(view((0.0, 0.0, 0.0)), bodies)


def _along(eye: Vector, along: Vector, *walls: tuple[Vector, float]):
    bodies: list[Body] = [(wall(*w), color, GLOW) for w, color in zip(walls, (RED, GREEN, BLUE), strict=False)]
    return lambda: scene(view(eye, along), bodies)


def _mirrored_along() -> Scene:
    """The middle row is mirrored to run level, above a floor and below a roof."""
    bodies: list[Body] = [
        (wall((0.0, 1.0, 1.0), 0.0), WHITE, MIRROR),
        (floor(-7.0), RED, GLOW),
        (wall((0.0, 0.0, 1.0), 7.0), GREEN, GLOW),
    ]
    return scene(view((0.0, 0.3, 0.9)), bodies)


def _in_top() -> Scene:
    return scene(view((0.1, 0.3, 3.0)), [(box((-2.0, -1.0, -1.0), (2.0, 0.3, 1.0)), RED, GLOW)])


def _in_slanting_side() -> Scene:
    return scene(view((0.0, 0.0, 0.0), SLANTING), [(slanting_box(5.0, 10.0, -3.0, 0.0, -2.0, 2.0), RED, GLOW)])


def _edges() -> Scene:
    """Silhouettes at the slopes 1/2 and 1/3."""
    front = [box((-1.5, -1.0, -1.0), (1.5, 1.0, 0.0)), box((2.0, -1.5, -3.0), (3.0, 1.5, -0.5))]
    return scene(view((0.0, 0.0, 3.0)), [(body, RED, GLOW) for body in front])


def _slanting_edges() -> Scene:
    bodies: list[Body] = [(slanting_box(15.0, 20.0, -7.5, 7.5, -1.0, 1.0), RED, GLOW)]
    return scene(view((0.0, 0.0, 0.0), SLANTING), bodies)


def _grid() -> Scene:
    """Boxes that share edges only, before black: no gap between them."""
    cells = [(-1, -1), (0, 0), (1, 1), (-1, 1), (1, -1)]
    bodies: list[Body] = [
        (box((x - 0.5, y - 0.5, -1.0), (x + 0.5, y + 0.5, 0.0)), color, GLOW)
        for (x, y), color in zip(cells, (RED, GREEN, BLUE, WHITE, RED), strict=True)
    ]
    return scene(view((0.0, 0.0, 3.0)), bodies)


def _seen_edge() -> Scene:
    """The wedge's edge is before the eye, one of its sides in light."""
    wedge = Polyhedron(((-1.0, 0.0, 1.0, 2.0), (1.0, 0.0, 1.0, 2.0), (0.0, 0.0, -1.0, -9.0)))
    return scene(view((0.0, 0.1, 0.3)), [(wedge, WHITE, MATTE)], [light((9.0, 0.5, 0.7))])


def _corner_of_room() -> Scene:
    """The room's far edges are seen from within; the light is bright on one wall only."""
    room = box((-2.0, -2.0, -2.0), (2.0, 2.0, 2.0))
    return scene(view((0.0, 0.0, 1.0), SLANTING), [(room, WHITE, MATTE)], [light((1.5, 0.7, 0.3))])


def _neighbours() -> Scene:
    bodies: list[Body] = [
        (box((0.0, -1.0, -1.0), (1.0, 0.0, 0.0)), RED, GLOW),
        (box((-1.0, -1.0, -1.0), (0.0, 0.0, 0.0)), GREEN, GLOW),
        (box((-1.0, 0.0, -1.0), (1.0, 1.0, 0.0)), BLUE, GLOW),
    ]
    return scene(view((0.0, 0.0, 1.5)), bodies)


def _floor_and_wall() -> Scene:
    """They meet in a line that a row of rays meets, and the wall is the second of the file."""
    bodies: list[Body] = [
        (floor(-1.0), RED, MATTE),
        (wall((0.0, 0.0, 1.0), 3.0), GREEN, MATTE),
        (wall((3.0, 0.0, 4.0), 12.0), BLUE, MATTE),
    ]
    return scene(view((0.0, 0.0, 0.0)), bodies, [light((1.0, 2.0, 1.0))])


def _balls_that_touch() -> Scene:
    bodies: list[Body] = [
        (floor(-1.0), RED, MATTE),
        (sphere((0.0, 0.0, -3.0), 1.0), GREEN, MATTE),
        (sphere((0.0, 0.0, -1.0), 1.0), BLUE, MATTE),
    ]
    return scene(view((2.0, 0.0, -2.0), (-1.0, 0.0, 0.0)), bodies, [light((5.0, 3.0, -2.0))])


def _light_in_planes() -> Scene:
    """In the floor, in a box's side, and in a slanting wall: dark, each, by its own light."""
    shiny = Finish(0.2, 0.5, 0.3, 0.0, 0.0, 0.0, 0.0)
    bodies: list[Body] = [
        (floor(0.3), RED, shiny),
        (wall((3.0, 0.0, 4.0), 12.0), BLUE, shiny),
        (box((-2.1, 0.3, -2.0), (-0.9, 1.3, -1.0)), GREEN, shiny),
    ]
    lights = [light((1.0, 0.3, 0.7)), light((-0.9, 2.0, 3.0)), light((0.8, 2.0, -3.6))]
    return scene(view((0.0, 1.3, 2.0)), bodies, lights)


def _lights_on_bodies() -> Scene:
    """In a ceiling, on a corner of a box, and on top of a ball."""
    bodies: list[Body] = [
        (floor(-1.0), WHITE, MATTE),
        (wall((0.0, -1.0, 0.0), 1.7), RED, MATTE),
        (box((-1.9, -1.0, -3.3), (-0.9, 0.1, -2.3)), GREEN, MATTE),
        (sphere((1.3, -0.3, -2.7), 0.7), BLUE, MATTE),
    ]
    return scene(
        view((0.0, 0.0, 1.0)), bodies, [light((0.3, 1.7, -1.1)), light((-0.9, 0.1, -2.3)), light((1.3, 0.4, -2.7))]
    )


def _shadow_edges() -> Scene:
    """Shadow rays through a box's edges, to places of the floor that rays meet; some begin at the box itself."""
    bodies: list[Body] = [(floor(0.0), WHITE, MATTE), (box((-1.0, 0.0, -1.0), (1.0, 1.0, 1.0)), RED, MATTE)]
    return scene(
        view((0.0, 4.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)),
        bodies,
        [light((0.0, 2.0, 0.0)), light((3.0, 1.0, 0.0))],
    )


def _slopes_in_one_plane() -> Scene:
    """Written in two ways, which are rounded apart, under a light so low that it would see any step between them."""
    bodies: list[Body] = [
        (wall((0.6, 0.9, 1.8), -14.7), RED, MATTE),
        (wall((2.0, 3.0, 6.0), -49.0), GREEN, MATTE),
    ]
    return scene(view((2.6, 3.9, 7.8)), bodies, [light((902.04, -596.94, 6.12))])


def _light_near_a_side() -> Scene:
    """Rays meet the floor in the plane of the box's side, in which the light is."""
    bodies: list[Body] = [(floor(0.3), WHITE, MATTE), (box((7.1, 0.3, 8.0), (7.6, 1.3, 8.1)), RED, MATTE)]
    return scene(view((4.1, 3.3, 6.7), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)), bodies, [light((7.1, 0.8, 8.2))])


def _ball_in_floor() -> Scene:
    """It stands upright on the floor, where rays meet both, and the lights above lean outward by a thousandth."""
    x, y, z = 122.76, 0.27, -166.1
    bodies: list[Body] = [(floor(y), WHITE, MATTE), (sphere((x, y, z), 5.0), RED, MATTE)]
    places = [(5.01, 0.0), (4.008, 3.006), (4.008, -3.006), (3.006, 4.008), (3.006, -4.008)]
    lights = [light((round(x + right, 3), round(y + 10, 3), round(z + near, 3))) for right, near in places]
    return scene(view((x + 10, round(y + 6, 2), z), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)), bodies, lights)


def _terminator() -> Scene:
    """Rays meet the ball where the way to a light only touches it."""
    shiny = Finish(0.2, 0.5, 0.3, 0.0, 0.0, 0.0, 0.0)
    bodies: list[Body] = [(sphere((0.1, 0.3, 0.2), 5.0), WHITE, shiny)]
    places = [(7.1, 0.3, 1.2), (-6.9, 0.3, 1.2), (0.1, 7.3, 1.2), (0.1, -6.7, 1.2)]
    places += [(3.1, 3.3, 4.2), (3.1, -2.7, 4.2), (-2.9, 3.3, 4.2), (-2.9, -2.7, 4.2)]
    places += [(-0.9, 0.3, 7.2), (1.1, 0.3, 7.2), (0.1, -0.7, 7.2), (0.1, 1.3, 7.2)]
    return scene(view((0.1, 0.3, 10.2)), bodies, [light(place) for place in places])


def _light_where_a_ray_ends() -> Scene:
    return scene(view((0.0, 1.0, 1.0)), [(floor(0.0), WHITE, MATTE)], [light((0.0, 0.0, -1.0)), light((0.5, 2.0, 0.0))])


def _tangent() -> Scene:
    """Rays at the slope 3/4 touch it."""
    return scene(view((0.0, 0.0, 5.0)), [(sphere((0.0, 0.0, 0.0), 3.0), RED, GLOW), (wall(LEVEL, -5.0), GREEN, GLOW)])


def _small_tangent() -> Scene:
    return scene(view((0.1, 0.3, 0.5)), [(sphere((0.1, 0.3, 0.0), 0.3), RED, GLOW)])


def _tangent_shadow() -> Scene:
    """The shadow of the ball has the radius 7.5, which rays meet at 4.5, 6."""
    bodies: list[Body] = [(floor(0.0), WHITE, MATTE), (sphere((0.0, 5.0, 0.0), 3.0), RED, MATTE)]
    return scene(view((6.0, 6.0, 4.5), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)), bodies, [light((0.0, 10.0, 0.0))])


def _critical() -> Scene:
    """From within glass, upward: the cone with the slope 3/4 runs along the surface, and meets no bottom."""
    bodies: list[Body] = [(floor(0.3), WHITE, DENSE), (floor(-4.0), RED, GLOW)]
    return scene(view((0.1, -0.9, 0.2), (0.0, 1.0, 0.0), (0.0, 0.0, -1.0)), bodies)


def _shared_glass() -> Scene:
    bodies: list[Body] = [
        (box((x, -1.0, -1.0), (x + 1.0, 1.0, 1.0)), color, CLEAR)
        for x, color in zip((-1.0, 0.0, 1.0), (RED, GREEN, BLUE), strict=True)
    ]
    bodies.append((wall((0.0, 0.0, 1.0), 5.0), checker(0.5), GLOW))
    return scene(view((0.0, 0.0, 3.0)), bodies)


def _eye(eye: Vector, along: Vector = LEVEL):
    """In or on two boxes that share a face, above a floor."""
    bodies: list[Body] = [
        (floor(-1.0), checker(0.5), GLOW),
        (box((-1.0, -1.0, -1.0), (0.0, 1.0, 1.0)), RED, GLOW),
        (box((0.0, -1.0, -1.0), (1.0, 1.0, 1.0)), GREEN, GLOW),
    ]
    return lambda: scene(view(eye, along), bodies)


def _eye_in_csg(eye: Vector, along: Vector, up: Vector, *steps: tuple[str, Shape]):
    """On leaves of a csg, before walls."""
    body = Csg(tuple(Operand(sign, shape) for sign, shape in steps))
    bodies: list[Body] = [
        (body, RED, GLOW),
        (wall((0.0, 0.0, 1.0), 9.0), checker(0.5), GLOW),
        (wall((0.0, 0.0, -1.0), 9.0), GREEN, GLOW),
        (wall((-1.0, 0.0, 0.0), 9.0), BLUE, GLOW),
    ]
    return lambda: scene(view(eye, along, up), bodies)


def _eye_on_quadric(eye: Vector, along: Vector, up: Vector, *numbers: float):
    a, b, c, d, e, f, g, h, i, j = map(float, numbers)
    body = Quadric((a, b, c, d, e, f, g, h, i, j))
    return _eye_in_csg(eye, along, up, ("+", body), ("&", sphere((0.25, 0.125, -0.25), 3.0)))


CUBE = box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))


def _mirrored_room(*steps: tuple[str, Shape]):
    """From within, where rays meet edges, and go on inside."""
    body = Csg(tuple(Operand(sign, shape) for sign, shape in steps))
    return lambda: mirrored_room(body)


def mirrored_room(shape: Shape) -> Scene:
    """With the eye in a cube, before a wall."""
    bodies: list[Body] = [
        (shape, checker(0.5), Finish(0.3, 0.0, 0.0, 1.0, 0.7, 0.0, 1.0)),
        (wall((0.0, 0.0, 1.0), 9.0), BLUE, GLOW),
    ]
    return scene(view((0.0, 0.0, 0.0), (1.0, 0.0, -1.0)), bodies)


# ---- Of one ray each


def _row_of_glass(eye: Vector, along: Vector, balls: int) -> Scene:
    """The ray meets every ball's centre, where an error of its direction grows more than tenfold, and then a tile's
    corner.
    """

    def at(t: float) -> Vector:
        x, y, z = (round(e + t * a, 6) for e, a in zip(eye, along, strict=True))
        return x, y, z

    bodies: list[Body] = [(sphere(at(2.0 * k), 0.1), WHITE, GLASS) for k in range(1, balls + 1)]
    bodies.append((wall((0.0, 0.0, 1.0), -at(2.0 * balls + 2.0)[2]), checker(0.02), GLOW))
    return scene(view(eye, along), bodies)


def _sunk(body: Callable[[Vector, float], Shape], center: Vector, side: tuple[float, float], lean: float) -> Scene:
    """A body of clear glass stands in a mirror, which the ray meets at the body's edge: it goes on inside of that,
    leaning inward so little that a rounding error would be a way.
    """
    (x, z), radius = side, 0.7
    along = (-z - lean * x, -1.0, x - lean * z)
    edge = (center[0] + radius * x, center[1], center[2] + radius * z)
    a, b, c = (round(e - way, 8) for e, way in zip(edge, along, strict=True))
    return scene(view((a, b, c), along), [(floor(center[1]), WHITE, MIRROR), (body(center, radius), RED, CLEAR)])


def _beside(body: Callable[[Vector, float], Shape], center: Vector, side: tuple[float, float], lean: float) -> Scene:
    """The body stands on a floor, whose point at its edge has light that comes from above, and from beside the body by
    so little.
    """
    (x, z), radius = side, 0.7
    edge = (center[0] + radius * x, center[1], center[2] + radius * z)

    def at(out: float, up: float) -> Vector:
        a, b, c = (round(e + way, 8) for e, way in zip(edge, (out * x, up, out * z), strict=True))
        return a, b, c

    bodies = [(floor(center[1]), WHITE, MATTE), (body(center, radius), RED, GLOW)]
    return scene(view(at(2.0, 1.0), (-2.0 * x, -1.0, -2.0 * z)), bodies, [light(at(10 * lean, 10.0))])


def _touched(body: Callable[[Vector, float], Shape], center: Vector, side: tuple[float, float], lean: float) -> Scene:
    """The ray touches the body, and passes."""
    (x, z), radius = side, 0.7
    along = (-z, 10 * lean, x)
    edge = (center[0] + radius * x, center[1], center[2] + radius * z)
    a, b, c = (round(e - way, 8) for e, way in zip(edge, along, strict=True))
    return scene(view((a, b, c), along), [(body(center, radius), RED, GLOW)])


def _ellipsoid(center: Vector, radius: float) -> Quadric:
    """Half as high as a ball, but for a root."""
    x, y, z = center
    g, h, i = (round(-2 * factor * c, 9) for factor, c in zip((1, 2, 1), center, strict=True))
    return Quadric((1.0, 2.0, 1.0, 0.0, 0.0, 0.0, g, h, i, round(x * x + 2 * y * y + z * z - radius * radius, 9)))


def _cylinder(center: Vector, radius: float) -> Quadric:
    """Upright."""
    x, _, z = center
    return Quadric(
        (
            1.0,
            0.0,
            1.0,
            0.0,
            0.0,
            0.0,
            round(-2 * x, 9),
            0.0,
            round(-2 * z, 9),
            round(x * x + z * z - radius * radius, 9),
        )
    )


def _at_edges(
    made: Callable[[Callable[[Vector, float], Shape], Vector, tuple[float, float], float], Scene],
    body: Callable[[Vector, float], Shape],
) -> list[Scene]:
    """Bodies whose numbers are rounded up, and such whose are rounded down."""
    return [
        made(body, center, side, lean)
        for center in ((33.3, 1.7, 5.9), (12.1, 0.3, -6.7), (1.3, 0.1, 7.7), (122.76, 0.27, -166.1))
        for side in ((0.6, 0.8), (-0.6, 0.8), (-0.8, 0.6))
        for lean in (0.01, 0.001)
    ]


def _cut_off(ball_first: bool, edge: tuple[float, float]) -> Scene:
    """The ray meets a ball where a plane cuts it off: the first of both in the file."""
    x, y = edge
    parts: list[Shape] = [sphere((0.0, 0.0, 0.0), 1.0), wall((0.0, 0.0, 1.0), -0.6)]
    first, second = parts if ball_first else parts[::-1]
    body = Csg((Operand("+", first), Operand("&", second)))
    return scene(view((2 * x, 2 * y, 1.4), (-x, -y, -0.8)), [(body, RED, MATTE)], [light((0.3, 0.2, 9.0))])


ONE_RAY = replace(SETTINGS, width=1, height=1, pixel="center", max_depth=12)
RAYS: dict[str, Callable[[], list[Scene]]] = {
    "through a row of glass": lambda: [
        _row_of_glass(eye, along, balls)
        for eye in ((0.1, 0.3, 0.2), (12.1, 3.3, 7.2))
        for along in ((0.6, 0.0, -0.8), (0.48, 0.6, -0.64), (0.36, 0.48, -0.8))
        for balls in (3, 4)
    ],
    "into a ball in a mirror": lambda: _at_edges(_sunk, sphere),
    "into an ellipsoid in a mirror": lambda: _at_edges(_sunk, _ellipsoid),
    "into a cylinder in a mirror": lambda: _at_edges(_sunk, _cylinder),
    "out beside a ball": lambda: _at_edges(_beside, sphere),
    "out beside an ellipsoid": lambda: _at_edges(_beside, _ellipsoid),
    "at the edge of a ball cut off": lambda: [
        _cut_off(ball_first, edge)
        for ball_first in (True, False)
        for edge in ((0.8, 0.0), (0.48, 0.64), (-0.64, 0.48), (-0.768, 0.224), (0.0, -0.8))
    ],
    "touching a ball": lambda: _at_edges(_touched, sphere),
    "touching an ellipsoid": lambda: _at_edges(_touched, _ellipsoid),
    "touching a cylinder": lambda: _at_edges(_touched, _cylinder),
}
"""By a name: scenes of which one ray each is followed. Of errors by chance not all are too small to be seen."""

TIE_SCENES: dict[str, tuple[str, Callable[[], Scene], Settings]] = {
    name: (kind, made, replace(SETTINGS, **changes))
    for name, kind, made, changes in (
        ("tile rows", "tile", _tiles(0.5, (0.0, 1.0, 0.0)), {}),
        ("tiles of 0.3", "tile", _tiles(0.3, (0.3, 0.6, 0.9)), {}),
        ("tiles of 1.4", "tile", _tiles(1.4, (0.7, 1.4, 2.8)), {"pixel": "center"}),
        ("tiles, slanting view", "tile", _tiles(0.5, (0.5, 2.0, 1.0), SLANTING), {"width": 40, "height": 20}),
        ("tiles of a floor at 0.9", "tile", _tiles(0.3, (0.1, 1.8, 0.2), height=0.9), {}),
        ("tiles of a floor at -2.1", "tile", _tiles(0.7, (0.1, 1.4, 0.2), height=-2.1), {}),
        ("tiles on a ball", "tile", _balls_tiles, {}),
        ("tiles in a mirror", "tile", _mirrored_tiles, {}),
        ("tiles in two mirrors", "tile", _mirrored_twice, {}),
        ("texels", "texel", _texels((0.0, 2.0, 0.0), LEVEL, 0.25), {}),
        ("texels of 0.1", "texel", _texels((0.3, 0.6, 0.1), LEVEL, 2.5), {}),
        ("texels, slanting view", "texel", _texels((0.5, 2.0, 1.0), SLANTING, 0.5), {"width": 40, "height": 20}),
        ("above a floor", "along", _along((0.0, 1.0, 0.0), LEVEL, ((0.0, 1.0, 0.0), 0.3)), {}),
        ("under a floor", "along", _along((0.0, 0.1, 0.0), LEVEL, ((0.0, 1.0, 0.0), -0.3)), {}),
        ("along a slanting wall", "along", _along((0.1, 0.0, 0.2), SLANTING, (ACROSS, 4.0)), {}),
        ("inside a slanting wall", "along", _along((0.1, 0.0, 0.2), SLANTING, (ACROSS, -4.0)), {}),
        ("along planes, mirrored", "along", _mirrored_along, {}),
        ("in a box's top", "in", _in_top, {}),
        ("in a slanting box's side", "in", _in_slanting_side, {}),
        ("in a slanting wall", "in", _along((0.3, 0.0, 0.1), SLANTING, (ACROSS, -1.5)), {}),
        ("edges of boxes", "touched edge", _edges, {}),
        ("edges of a slanting box", "touched edge", _slanting_edges, {}),
        ("grid", "touched edge", _grid, {}),
        ("shadows of edges", "touched edge", _shadow_edges, {}),
        ("wedge", "seen edge", _seen_edge, {}),
        ("corner of a room", "seen edge", _corner_of_room, {}),
        ("neighbours", "bodies", _neighbours, {}),
        ("floor and wall", "bodies", _floor_and_wall, {}),
        ("balls that touch", "tangent", _balls_that_touch, {}),
        ("lights in planes", "light in plane", _light_in_planes, {}),
        ("lights on bodies", "at light", _lights_on_bodies, {}),
        ("light where a ray ends", "light in plane", _light_where_a_ray_ends, {}),
        ("slopes in one plane", "at start", _slopes_in_one_plane, {}),
        ("light near a side", "in", _light_near_a_side, {}),
        ("ball in a floor", "at start", _ball_in_floor, {}),
        ("terminator", "light in plane", _terminator, {}),
        ("tangent", "tangent", _tangent, {"width": 40, "height": 40}),
        ("small tangent", "tangent", _small_tangent, {"width": 40, "height": 40}),
        ("tangent shadow", "tangent", _tangent_shadow, {}),
        ("critical angle", "critical", _critical, {"width": 40, "height": 40}),
        ("shared faces of glass", "bodies", _shared_glass, {}),
        ("eye on a shared face", "at start", _eye((0.0, 0.3, 0.2)), {}),
        ("eye on a shared edge", "at start", _eye((0.0, 0.3, 1.0)), {}),
        ("eye on a corner", "at start", _eye((1.0, 1.0, 1.0), (-3.0, 0.0, -4.0)), {}),
        ("eye in the plane of faces", "in", _eye((0.0, 1.0, 3.0)), {}),
    )
}  # fmt: skip
"""By a name: the kind of tie that it is about, how its scene is made, and settings."""


CSG_SCENES: dict[str, Callable[[], Scene]] = {
    "on a hollow": _eye_on_quadric((1, 0, 0), LEVEL, UP, -1, -2, -3, 0, 0, 0, 0, 0, 0, 1),
    "on a saddle": _eye_on_quadric((1, 0, 0), UP, ACROSS, 1, -1, 2, 0, 0, 0, 0, 0, 0, -1),
    "on a pipe": _eye_on_quadric((1, 0, 0.5), LEVEL, UP, 1, 2, 0, 0, 0, 0, 0, 0, 0, -1),
    "in a pipe's wall": _eye_on_quadric((1, 0, 0.5), LEVEL, UP, -1, -2, 0, 0, 0, 0, 0, 0, 0, 1),
    "on a cone": _eye_on_quadric((1, 0, 1), (-1, 0, -1), UP, 1, 2, -1, 0, 0, 0, 0, 0, 0, 0),
    "where a hole touches a wall": _eye_in_csg(
        (0, 0, 0), (1, 0, 0), UP, ("+", wall((1.0, 0.0, 0.0), 0.0)), ("-", sphere((-1.0, 0.0, 0.0), 1.0))
    ),
    "where a ball touches a cut": _eye_in_csg(
        (0, 0, 0), LEVEL, UP, ("+", sphere((0.0, -1.0, 0.0), 1.0)), ("-", box((-1.0, 0.0, -1.0), (1.0, 1.0, 1.0)))
    ),
    "where a ball touches its hole": _eye_in_csg(
        (0, 0, 0), UP, LEVEL, ("+", sphere((0.0, 1.0, 0.0), 1.0)), ("-", box((-0.5, 0.0, -0.5), (0.5, 0.5, 0.5)))
    ),
    "where a hollow touches a cut": _eye_in_csg(
        (0, 0, 0),
        (1, 1, 0),
        ACROSS,
        ("+", Quadric((-1.0, -2.0, -3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0))),
        ("&", sphere((0.25, 0.125, -0.25), 4.0)),
        ("-", wall((0.0, 0.0, 1.0), 0.0)),
    ),
    "in a mirrored box": _mirrored_room(("+", CUBE)),
    "in a mirrored box with a hole": _mirrored_room(("+", CUBE), ("-", sphere((0.0, 0.0, -1.0), 0.375))),
    "past a ball in a box": _eye_in_csg((0, 0, 3), LEVEL, UP, ("+", sphere((-2.0, 0.0, 0.0), 2.0)), ("&", CUBE)),
    "before a mirrored notch": lambda: scene(
        view((2.0, 0.25, 2.0), (-1.0, 0.0, -1.0)),
        [
            (
                Csg((Operand("+", CUBE), Operand("-", box((0.0, -2.0, 0.0), (2.0, 2.0, 2.0))))),
                checker(0.5),
                Finish(0.3, 0.0, 0.0, 1.0, 0.7, 0.0, 1.0),
            )
        ],
    ),
}
"""By a name: scenes with the eye on a csg, along whose leaf rays run, or of which leaves touch there, and with edges in
which it is mirrored.
"""
CSG_SETTINGS = replace(SETTINGS, width=16, height=12)


@cache
def traced(name: str) -> list[list[Pixel]]:
    """What is true of every pixel of one of them, by rows."""
    _, make, settings = TIE_SCENES[name]
    tracer = ExactTracer(make(), settings)
    return [[tracer.pixel(x, y) for x in range(settings.width)] for y in range(settings.height)]
