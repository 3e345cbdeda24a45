"""Csgs whose operands nearly coincide, are nearly of one size, or are deep in one another."""

from collections.abc import Sequence
from functools import reduce
from operator import xor

import numpy as np

from converter.scene.model import Checker, Csg, Operand, Polyhedron, Shape, Sphere, Vector
from converter.studies.families.closed_forms import Long, checkered, directions, dot, long
from converter.studies.families.scenes import (
    ALONG,
    ASIDE,
    GLASS,
    GLOW,
    MATTE,
    NORMAL,
    WHITE,
    camera,
    light,
    on_slope,
    scene,
    settings,
    slope,
)
from converter.studies.families.solids import Inside, Masks, lit_solid
from converter.studies.family import Case, Family

_SETTINGS = settings()
Body = Sphere | Polyhedron
CENTER: Vector = (0.125, -0.0625, 0.1875)
_HAIRS = tuple(10.0**-power for power in (*range(1, 9), 10, 12, 13, 14))
"""1e-1 to 1e-14; a little less, and by the rule of roundings there is no difference at all."""


def _minus(first: Shape, *others: Shape) -> Csg:
    return Csg((Operand("+", first), *(Operand("-", other) for other in others)))


def _without(masks: Sequence[Masks]) -> Masks:
    """The first without the others."""
    return masks[0] & ~reduce(np.logical_or, masks[1:])


def _drawn(shape: Csg, bodies: Sequence[Body], inside: Inside, eye: Vector, look_at: Vector, lamp: Vector) -> Case:
    """A white matte csg before black, with its picture in long double."""
    view = camera(eye, look_at, 40.0, NORMAL)
    truth = lit_solid(bodies, inside, eye, directions(view, _SETTINGS), lamp, MATTE)
    return Case(scene(view, [(shape, WHITE, MATTE)], [light(lamp)]), _SETTINGS, truth)


# ---- Thin shells


def _bowl(wall: float) -> Case:
    """A ball without a smaller one and without what is above a slanting plane; light falls into it from above."""
    x, y, z = CENTER
    bodies: list[Body] = [Sphere(CENTER, 1.0), Sphere(CENTER, 1.0 - wall), Polyhedron(((-2.0, -3.0, -6.0, 0.5),))]
    eye, lamp = (x + 2.0, y + 3.0, z + 1.5), (x + 3.0, y + 1.0, z + 4.0)
    return _drawn(_minus(*bodies), bodies, _without, eye, CENTER, lamp)


def _glass_shell(wall: float) -> Case:
    """Before a checkered wall.

    About the centre, a ray's plane and its n r sin(angle) stay: `off` in air, that over n in glass. So all rays leave
    as far from the centre as they came, turned by a sum of angles: those of the outer surface both ways, and those of
    the inner one, or what they turn by if they are reflected there.
    """
    n, outer, inner = np.longdouble(1.5), np.longdouble(1.0), np.longdouble(1.0 - wall)
    eye, pattern = (0.5, 0.75, 5.0), Checker((0.9, 0.8, 0.7), (0.2, 0.3, 0.4), 0.875)
    view = camera(eye, CENTER, 30.0)
    d = directions(view, _SETTINGS)
    f = long(eye) - long(CENTER)
    nearest = f - dot(f, d)[..., None] * d
    off = np.sqrt(dot(nearest, nearest))

    def angle(sine: Long) -> Long:
        return np.asarray(np.arcsin(np.minimum(sine, 1)))

    turn = 2 * (angle(off / outer) - angle(off / outer / n))
    through, mirrored = off < inner, (off >= inner) & (off < n * inner)
    turn = turn - np.where(through, 2 * (angle(off / inner) - angle(off / inner / n)), 0)
    turn = turn - np.where(mirrored, np.pi - 2 * angle(off / inner / n), 0)
    turn = np.where(off < outer, turn, 0)
    # Towards the centre.
    side = nearest / off[..., None]
    sine, cosine = np.sin(turn)[..., None], np.cos(turn)[..., None]
    out = cosine * d - sine * side
    p = long(CENTER) + off[..., None] * (cosine * side + sine * d)
    t = (-3 - p[..., 2]) / out[..., 2]
    seen = out[..., 2] < 0
    p = p + np.where(seen, t, 0)[..., None] * out
    truth = np.where(seen[..., None], checkered(pattern, np.where([False, False, True], long((0, 0, -3)), p)), 0.0)
    shell = _minus(Sphere(CENTER, 1.0), Sphere(CENTER, 1.0 - wall))
    made = scene(view, [(shell, (0.0, 0.0, 0.0), GLASS), (Polyhedron(((0.0, 0.0, 1.0, 3.0),)), pattern, GLOW)])
    return Case(made, settings(max_depth=6), truth)


# ---- Operands that nearly coincide


def _block(low: tuple[float, float, float], high: tuple[float, float, float]) -> Polyhedron:
    """A slanting box, between heights above `slope(0)` and multiples of `ALONG` and `ASIDE`."""
    planes = [slope(high[0]), slope(low[0], -1.0)]
    for k, way in ((1, ALONG), (2, ASIDE)):
        square = sum(x * x for x in way)
        planes.append((*way, -high[k] * square))
        planes.append((-way[0], -way[1], -way[2], low[k] * square))
    return Polyhedron(tuple(planes))


def _flush(gap: float) -> Case:
    """A block less two: one ends above its upper side, and makes a pit, one below it, and leaves a lid."""
    block = _block((5.0, -1.0, -0.25), (7.0, 1.0, 0.25))
    pit = _block((5.5, -0.75, -0.1875), (7.0 + 7 * gap, -0.125, 0.1875))
    cave = _block((5.5, 0.125, -0.1875), (7.0 - 7 * gap, 0.75, 0.1875))
    bodies = [block, pit, cave]
    eye, lamp = on_slope(20.0, -1.0, 0.5), on_slope(21.0, 0.5, 0.75)
    return _drawn(_minus(*bodies), bodies, _without, eye, on_slope(6.5), lamp)


def _crescents(off: float) -> Case:
    """Of two equal balls, moved apart a little, each without the other: one shows its back, one its hollow side."""
    shift = tuple(off * x / 7 for x in NORMAL)
    left, right = (-1.25, 0.0, 0.5), (1.25, 0.25, -0.5)

    def moved(center: Vector) -> Vector:
        x, y, z = (c + s for c, s in zip(center, shift, strict=True))
        return (x, y, z)

    bodies = [Sphere(left, 1.0), Sphere(moved(left), 1.0), Sphere(moved(right), 1.0), Sphere(right, 1.0)]

    def inside(masks: Sequence[Masks]) -> Masks:
        return np.asarray((masks[0] & ~masks[1]) | (masks[2] & ~masks[3]))

    shape = Csg((Operand("+", _minus(*bodies[:2])), Operand("+", _minus(*bodies[2:]))))
    return _drawn(shape, bodies, inside, (1.5, 3.5, 6.0), (0.0, 0.0, 0.0), (6.0, 3.0, 3.0))


# ---- Deep nesting


def _onion(levels: float) -> Case:
    """Balls in one another, each without all that is in it, and without what is above a slanting plane."""
    count = round(levels)
    balls = [Sphere(CENTER, 1 - k / (count + 1)) for k in range(count)]
    cut = Polyhedron(((-2.0, -3.0, -6.0, 0.5),))
    inner: Shape = balls[-1]
    for ball in reversed(balls[:-1]):
        inner = _minus(ball, inner)

    def inside(masks: Sequence[Masks]) -> Masks:
        return np.asarray(reduce(xor, masks[:-1]) & ~masks[-1])

    x, y, z = CENTER
    eye, lamp = (x + 1.5, y + 1.75, z + 3.5), (x + 3.0, y + 1.0, z + 4.0)
    return _drawn(_minus(inner, cut), [*balls, cut], inside, eye, CENTER, lamp)


FAMILIES: tuple[Family, ...] = (
    Family(
        "bowls",
        "An open bowl, a ball less one that is nearly as large, gets an ever thinner wall: its shadows stay.",
        "thickness of the wall over the radius",
        _HAIRS,
        _bowl,
    ),
    Family(
        "glass-shells",
        "A hollow ball of glass gets an ever thinner wall, until there is hardly any glass.",
        "thickness of the wall over the radius",
        _HAIRS,
        _glass_shell,
    ),
    Family(
        "flush",
        "Of a block two others are taken away, one nearly to its surface, and one hardly beyond it: a lid stays, and "
        "none.",
        "distance of the faces over their distance from the origin",
        _HAIRS,
        _flush,
    ),
    Family(
        "crescents",
        "Of two equal balls, nearly in one place, each less the other: what is left is ever thinner.",
        "distance of the centres in radii",
        _HAIRS,
        _crescents,
    ),
    Family(
        "onions",
        "Halves of balls in one another, each less all that is in it: ever more csgs are inside of one another.",
        "balls",
        (1.0, 4.0, 12.0, 32.0),
        _onion,
    ),
)
