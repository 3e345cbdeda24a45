"""Mirrors: many bounces, and what each of them makes of the errors before."""

from collections.abc import Iterator
from dataclasses import replace
from decimal import ROUND_FLOOR, Decimal, localcontext
from functools import cache

import numpy as np

from converter.scene.model import Camera, Checker, Color, Finish, Pigment, Polyhedron, Shape, Sphere, Vector
from converter.scene.settings import Settings
from converter.studies.families.closed_forms import Long, checkered, directions, long
from converter.studies.families.scenes import MIRROR, WHITE, box, camera, scene, settings, sphere
from converter.studies.family import Case, Family, Truth

TILES = Checker((0.9, 0.8, 0.7), (0.2, 0.3, 0.4), 1.0)
"""Mirrors of a room are at multiples of its size and a half or a quarter, so that none lies on a boundary."""


def _mirror(bounces: int, kr: float = 1.0) -> Finish:
    """A mirror of which each of so many images adds as much."""
    return Finish(1 / (bounces + 1), 0.0, 0.0, 1.0, kr, 0.0, 0.0)


# ---- Between plane mirrors -------------------------------------------------------------------------------------------


def _facing(bounces: float) -> Case:
    """The unfolded ray goes straight on, from image to image."""
    n = round(bounces)
    view, drawn = camera((0.3, 0.4, 5.25), (0.55, 0.4, 3.25)), settings(max_depth=n)
    mirror = _mirror(n)
    walls = [
        (Polyhedron(((0.0, 0.0, 1.0, -0.25),)), TILES, mirror),
        (Polyhedron(((0.0, 0.0, -1.0, 16.25),)), TILES, mirror),
    ]
    d, eye = directions(view, drawn), long(view.eye)
    truth = np.zeros(d.shape)
    for k in range(n + 1):
        p = eye + (5 + 16 * k) / np.abs(d[..., 2:]) * d
        p[..., 2] = np.longdouble(0.25 if k % 2 == 0 else 16.25)
        truth += mirror.ka * checkered(TILES, p)
    return Case(scene(view, walls), drawn, truth)


def _series(bounces: float) -> Case:
    """As many images, each dimmer than the one before."""
    n = round(bounces)
    view, drawn = camera((0.3, 0.4, 5.25), (0.55, 0.4, 3.25)), settings(max_depth=n)
    finish = Finish(0.125, 0.0, 0.0, 1.0, 0.875, 0.0, 0.0)
    walls = [
        (Polyhedron(((0.0, 0.0, 1.0, -0.25),)), WHITE, finish),
        (Polyhedron(((0.0, 0.0, -1.0, 16.25),)), WHITE, finish),
    ]
    total = 1 - 0.875 ** (n + 1)
    return Case(scene(view, walls), drawn, np.full((drawn.height, drawn.width, 3), total))


HALF = 2.5
"""Of the mirror box's size."""


def _mirror_box(bounces: float) -> Case:
    """Where an unfolded ray crosses the planes of a lattice, the real one is reflected by the box."""
    n = round(bounces)
    view, drawn = camera((0.3, 0.4, 0.55), (1.3, 0.9, -1.45)), settings(max_depth=n)
    mirror = _mirror(n)
    room = [(box((-HALF, -HALF, -HALF), (HALF, HALF, HALF)), TILES, mirror)]
    d, eye = directions(view, drawn), long(view.eye)
    crossings = []
    for axis in range(3):
        first = HALF - np.sign(d[..., axis]) * eye[axis]  # the way to the first plane along this axis
        planes = first[..., None] + 2 * np.longdouble(HALF) * np.arange(n + 1)
        crossings.append(planes / np.abs(d[..., axis])[..., None])
    times = np.concatenate(crossings, axis=-1)
    order = np.argsort(times, axis=-1)[..., : n + 1]
    truth = np.zeros(d.shape)
    for k in range(n + 1):
        which = order[..., k]
        t = np.take_along_axis(times, which[..., None], axis=-1)
        p = _folded(eye + t * d)
        # Exactly on the wall.
        on = np.arange(3) == (which // (n + 1))[..., None]
        wall: Long = np.copysign(np.longdouble(HALF), p)
        truth += mirror.ka * checkered(TILES, np.where(on, wall, p))
    return Case(scene(view, room), drawn, truth)


def _folded(p: Long) -> Long:
    """A point of the unfolded space in the box."""
    period = 4 * np.longdouble(HALF)
    q = (p + HALF) % period
    result: Long = np.where(q <= period / 2, q, period - q) - np.longdouble(HALF)
    return result


def _corner(zoom: float) -> Case:
    """Three mirrors of a corner send a ray back whichever it meets first; between them nothing may slip out."""
    view, drawn = (
        camera((3.0, 4.0, 2.5), (0.0, 0.0, 0.0), 40.0 / zoom),
        settings(background=(0.2, 0.2, 0.2), max_depth=8),
    )
    walls = [
        (Polyhedron(((float(i == 0), float(i == 1), float(i == 2), 0.0),)), color, _mirror(3)) for i, color in _TINTS
    ]
    d = directions(view, drawn)
    met = (d < 0)[..., None] * np.array([color for _, color in _TINTS])
    truth = 0.25 * met.sum(axis=-2) + 0.2
    return Case(scene(view, walls), drawn, truth)


_TINTS: tuple[tuple[int, Color], ...] = ((0, (0.9, 0.1, 0.2)), (1, (0.2, 0.9, 0.1)), (2, (0.1, 0.2, 0.9)))


# ---- Between balls ---------------------------------------------------------------------------------------------------

BALLS: tuple[Sphere, ...] = (
    sphere((0.0, 0.0, -2.5), 1.5),
    sphere((2.25, 0.0, 1.25), 1.5),
    sphere((-2.0, 0.5, 1.5), 1.5),
)
ROOM = sphere((0.0, 0.0, 0.0), 6.0)
"""A ball around all, so that no ray ends; its checkers show where rays are."""
CELLS = Checker((1.0, 0.9, 0.8), (0.0, 0.1, 0.2), 1.75)
DIGITS = 60
TRAPPED = (1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 20.0, 24.0, 28.0, 32.0, 40.0, 48.0, 64.0, 80.0)


def _trapped(bounces: float) -> Case:
    """Rays between three mirror balls in a fourth: each bounce makes an error several times as large."""
    n = round(bounces)
    view, drawn = camera((0.0, 0.0, 0.25), (0.0625, 0.0, -0.75), 90.0), settings(24, 18, max_depth=n)
    images = _images(view, replace(drawn, max_depth=None))
    room = _mirror(n)
    bodies: list[tuple[Shape, Pigment | Color, Finish]] = [(ROOM, CELLS, room)]
    bodies += [(ball, WHITE, MIRROR) for ball in BALLS]
    return Case(scene(view, bodies), drawn, room.ka * images[: n + 1].sum(axis=0))


@cache
def _images(view: Camera, drawn: Settings) -> Truth:
    """(bounces + 1, height, width, 3) colour of what each ray meets, in decimal digits that outlast all bounces."""
    result = np.zeros((round(TRAPPED[-1]) + 1, drawn.height * drawn.width, 3))
    with localcontext() as context:
        context.prec = DIGITS
        for pixel, d in enumerate(_decimal_directions(view, drawn)):
            _follow(_decimal(view.eye), d, result[:, pixel])
    return result.reshape(-1, drawn.height, drawn.width, 3)


_Triple = tuple[Decimal, Decimal, Decimal]


def _decimal(v: Vector) -> _Triple:
    x, y, z = map(Decimal, v)
    return x, y, z


def _dot(a: _Triple, b: _Triple) -> Decimal:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _along(p: _Triple, t: Decimal, d: _Triple) -> _Triple:
    return p[0] + t * d[0], p[1] + t * d[1], p[2] + t * d[2]


def _follow(p: _Triple, d: _Triple, colors: Truth) -> None:
    """Write down the colours, (bounces + 1, 3), that a ray meets."""
    cell = Decimal(CELLS.size)
    own: Sphere | None = None
    for color in colors:
        entries = ((_entry(p, d, ball), ball) for ball in BALLS if ball is not own)
        t, own = min(((t, ball) for t, ball in entries if t is not None), default=(None, ROOM), key=lambda hit: hit[0])
        p = _along(p, _exit(p, d, ROOM) if t is None else t, d)
        if own is ROOM:
            odd = sum(int((c / cell).to_integral_value(ROUND_FLOOR)) for c in p) % 2
            color[:] = CELLS.second if odd else CELLS.first
        n = _along(p, Decimal(-1), _decimal(own.center))
        d = _along(d, -2 * _dot(d, n) / _dot(n, n), n)


def _roots(p: _Triple, d: _Triple, ball: Sphere) -> tuple[Decimal, Decimal]:
    """Distance to where a ray passes the centre of a ball, and the square of half its way inside."""
    f = _along(p, Decimal(-1), _decimal(ball.center))
    b = _dot(f, d)
    return -b, b * b - _dot(d, d) * (_dot(f, f) - Decimal(ball.radius) ** 2)


def _entry(p: _Triple, d: _Triple, ball: Sphere) -> Decimal | None:
    middle, square = _roots(p, d, ball)
    return (middle - square.sqrt()) / _dot(d, d) if middle > 0 and square > 0 else None


def _exit(p: _Triple, d: _Triple, ball: Sphere) -> Decimal:
    middle, square = _roots(p, d, ball)
    return (middle + square.sqrt()) / _dot(d, d)


def _decimal_directions(view: Camera, drawn: Settings) -> Iterator[_Triple]:
    """Directions through the pixels' centres, of any length, in decimal digits throughout."""
    assert view.fovy == 90.0, "the tangent of half of it is 1"
    forward = _along(_decimal(view.look_at), Decimal(-1), _decimal(view.eye))
    right = _cross(forward, _decimal(view.up))
    up = _cross(right, forward)
    forward, right, up = (_along((Decimal(0),) * 3, 1 / _dot(v, v).sqrt(), v) for v in (forward, right, up))
    for row in range(drawn.height):
        for column in range(drawn.width):
            x = Decimal(2 * column + 1 - drawn.width) / drawn.height
            y = Decimal(drawn.height - 2 * row - 1) / drawn.height
            yield _along(_along(forward, x, right), y, up)


def _cross(a: _Triple, b: _Triple) -> _Triple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


FAMILIES: tuple[Family, ...] = (
    Family(
        "facing-mirrors",
        "Two checkered mirrors face each other; every image adds as much, and lies farther off than the one before.",
        "bounces",
        (1.0, 4.0, 16.0, 64.0, 256.0, 1024.0),
        _facing,
    ),
    Family(
        "geometric-series",
        "Between two mirrors that add an eighth and pass on seven, what is seen is the sum of a geometric series.",
        "bounces",
        (1.0, 4.0, 16.0, 64.0, 256.0, 1024.0),
        _series,
    ),
    Family(
        "mirror-box",
        "In a closed box of perfect mirrors no ray ever ends: edges and corners must leak none, and lose none.",
        "bounces",
        (1.0, 4.0, 16.0, 64.0, 256.0),
        _mirror_box,
    ),
    Family(
        "mirror-corner",
        "A lens comes ever closer to the corner of three mirrors, where a ray meets all three within a hair.",
        "magnification",
        tuple(10.0**k for k in range(13)),
        _corner,
    ),
    Family(
        "trapped-ray",
        "Three mirror balls in a larger one: each bounce makes every error larger, until the last digit decides where "
        "a ray goes.",
        "bounces",
        TRAPPED,
        _trapped,
    ),
)
