"""Ties: numbers that decide something and are equal but for their roundings, which grow from value to value.

A scene of decimal numbers, as files have them, stands farther and farther from the origin, and its picture stays. The
truth is computed without rounding, once a family, near the origin.
"""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from typing import assert_never

from converter.scene.model import (
    Camera,
    Checker,
    Csg,
    Pigment,
    Plane,
    Polyhedron,
    Quadric,
    Scene,
    Shape,
    Solid,
    Sphere,
    Texmap,
    Vector,
)
from converter.scene.settings import Settings
from converter.shapes import quadric_form
from converter.studies.exact.tracer import exact_picture
from converter.studies.families.coincidence import BLUE, RED, texture_file
from converter.studies.families.scenes import (
    GLASS,
    GLOW,
    MATTE,
    MIRROR,
    WHITE,
    Body,
    box,
    camera,
    floor,
    light,
    scene,
    sphere,
)
from converter.studies.family import Case, Family, Truth

GREEN = (0.1, 0.8, 0.2)
LEVEL: Vector = (0.0, 0.0, -1.0)
SLANTING: Vector = (3.0, 0.0, -4.0)
"""Of length 5: with it the rays through pixels have rational directions, but none that doubles hold."""
ACROSS: Vector = (4.0, 0.0, 3.0)
_SETTINGS = Settings(32, 24, background=(0.0, 0.0, 0.3), cutoff=0.0, max_depth=2)
"""Rays through the pixels' corners, the middle row and column among them."""
_ROUND = replace(_SETTINGS, width=40, height=40)
"""With pixels whose distances from the middle, in half heights, are 3/5 and 4/5 of 3/4."""
_DISTANCES = tuple(10.0**power for power in range(0, 13, 2))
_UNIT = Fraction(2, 5)
"""Of length: with it no coordinate is a double, and all are decimal numbers of few digits."""
_STEP: Vector = (12.0, 4.0, 8.0)
"""By which scenes are moved, in units: whole numbers of tiles, an even one, and of images."""


# ---- The scenes, near the origin


def _view(eye: Vector, along: Vector = LEVEL, up: Vector = (0.0, 1.0, 0.0)) -> Camera:
    return camera(eye, (eye[0] + along[0], eye[1] + along[1], eye[2] + along[2]), 90.0, up)


def _half_space(normal: Vector, offset: float) -> Polyhedron:
    return Polyhedron(((*normal, offset),))


def _slanting_box(left: float, right: float, high: float) -> Polyhedron:
    """Two units before the eye, and two deep; from left to right in fifths along `ACROSS`."""
    (fx, _, fz), (ax, _, az) = SLANTING, ACROSS
    sides = ((-fx, 0.0, -fz, 10.0), (fx, 0.0, fz, -20.0), (-ax, 0.0, -az, left), (ax, 0.0, az, -right))
    return Polyhedron((*sides, (0.0, -1.0, 0.0, -1.0), (0.0, 1.0, 0.0, -high)))


def _tiles() -> Scene:
    """Every row of pixels that is 2 / n below the horizon, n whole, lies on tiles' edges."""
    return scene(_view((0.0, 1.0, 0.0)), [(floor(), Checker(RED, BLUE, 0.5), GLOW)])


def _texels() -> Scene:
    """From above: texels are a unit wide, and every third row and column of pixels lies on their edges."""
    pigment = Texmap(texture_file(), (0.5, 0.0, 0.0, 0.0), (0.0, 0.0, 0.5, 0.0))
    return scene(_view((16.0, 4.0, 16.0), (0.0, -1.0, 0.0), LEVEL), [(floor(), pigment, GLOW)])


def _along() -> Scene:
    """The middle column runs along two walls, each a unit away: inside of one, and outside of the other."""
    bodies: list[Body] = [(_half_space(ACROSS, -5.0), RED, GLOW), (_half_space(ACROSS, 5.0), BLUE, GLOW)]
    return scene(_view((0.0, 0.0, 0.0), SLANTING), bodies)


def _in_plane() -> Scene:
    """The middle column runs in a side of one box, the middle row in the top of the other."""
    bodies: list[Body] = [(_slanting_box(-5.0, 0.0, 1.0), RED, GLOW), (_slanting_box(5.0, 10.0, 0.0), BLUE, GLOW)]
    return scene(_view((0.0, 0.0, 0.0), SLANTING), bodies)


def _edge() -> Scene:
    """Rays touch the edges of the box's front."""
    return scene(_view((0.0, 0.0, 0.0), SLANTING), [(_slanting_box(-5.0, 5.0, 1.0), RED, GLOW)])


def _bodies() -> Scene:
    """A floor meets two walls in lines that rays meet, and from which the light is seen."""
    bodies: list[Body] = [
        (floor(-1.0), WHITE, MATTE),
        (_half_space((0.0, 0.0, 1.0), 3.0), GREEN, MATTE),
        (_half_space((3.0, 0.0, 4.0), 12.0), BLUE, MATTE),
    ]
    return scene(_view((0.0, 0.0, 0.0)), bodies, [light((1.0, 2.0, 1.0))])


def _shadow() -> Scene:
    """From above: shadow rays leave the floor where a box stands on it, or touch the edges of the box's top."""
    bodies: list[Body] = [(floor(), WHITE, MATTE), (box((-1.0, 0.0, -1.0), (1.0, 1.0, 1.0)), RED, MATTE)]
    lights = [light((0.0, 2.0, 0.0)), light((4.0, 2.0, 0.0))]
    return scene(_view((4.0, 4.0, 0.0), (0.0, -1.0, 0.0), LEVEL), bodies, lights)


def _tangent() -> Scene:
    """Rays with the slope 3/4 touch the ball, before a wall."""
    bodies: list[Body] = [(sphere((0.0, 0.0, 0.0), 3.0), RED, GLOW), (_half_space((0.0, 0.0, 1.0), 5.0), GREEN, GLOW)]
    return scene(_view((0.0, 0.0, 5.0)), bodies)


def _critical() -> Scene:
    """From within glass, upward: rays with the slope 3/4 run along its surface, those beyond see the ground."""
    glass = replace(GLASS, ior=0.6)
    return scene(_view((0.0, -1.0, 0.0), (0.0, 1.0, 0.0), LEVEL), [(floor(), WHITE, glass), (floor(-4.0), RED, GLOW)])


def _corridor(length: float) -> Scene:
    """Two mirrors, and a wall of tiles at their end."""
    bodies: list[Body] = [
        (_half_space((-1.0, 0.0, 0.0), -0.9), WHITE, MIRROR),
        (_half_space((1.0, 0.0, 0.0), -0.9), WHITE, MIRROR),
        (_half_space((0.0, 0.0, 1.0), length), Checker(RED, BLUE, 0.3), GLOW),
    ]
    return scene(_view((0.0, 0.0, 0.0)), bodies)


# ---- Far from it


def _moved(whole: Scene, times: float) -> Scene:
    """`whole` in its own unit, and so many times `_STEP` away; images move along, and tiles are where they were."""
    shift = [Fraction(times) * Fraction(step) for step in _STEP]

    def number(x: Fraction | float) -> float:
        return float(_UNIT * Fraction(x))

    def vector(v: Vector) -> Vector:
        x, y, z = (number(Fraction(c) + d) for c, d in zip(v, shift, strict=True))
        return (x, y, z)

    def plane(p: Plane) -> Plane:
        a, b, c, d = p
        return (a, b, c, number(Fraction(d) - sum(Fraction(n) * m for n, m in zip((a, b, c), shift, strict=True))))

    def shape(s: Shape) -> Shape:
        match s:
            case Sphere(center, radius):
                return Sphere(vector(center), number(radius))
            case Polyhedron(planes):
                return Polyhedron(tuple(map(plane, planes)))
            case Quadric():
                return quadric_form.moved(s, shift, _UNIT)
            case Csg(operands):
                return Csg(tuple(replace(operand, shape=shape(operand.shape)) for operand in operands))
        assert_never(s)

    def pigment(p: Pigment) -> Pigment:
        match p:
            case Checker():
                return replace(p, size=number(p.size))
            case Texmap():
                p0, p1 = ((*(float(Fraction(x) / _UNIT) for x in p[:3]), p[3]) for p in (p.p0, p.p1))
                return replace(p, p0=(p0[0], p0[1], p0[2], p0[3]), p1=(p1[0], p1[1], p1[2], p1[3]))
            case Solid():
                return p
        assert_never(p)

    view = whole.camera
    return replace(
        whole,
        camera=replace(view, eye=vector(view.eye), look_at=vector(view.look_at)),
        lights=tuple(replace(source, position=vector(source.position)) for source in whole.lights),
        pigments=tuple(map(pigment, whole.pigments)),
        objects=tuple(replace(o, shape=shape(o.shape)) for o in whole.objects),
    )


def _moving(make: Callable[[], Scene], settings: Settings = _SETTINGS) -> Callable[[float], Case]:
    """The family's case: the picture of the scene by the origin is that of all others."""

    @cache
    def truth() -> Truth:
        return exact_picture(_moved(make(), 0.0), settings)

    return lambda distance: Case(_moved(make(), distance), settings, truth())


@cache
def _mirrored(widths: float) -> Case:
    """All rays meet the edges of tiles, and neighbouring ones those of tiles of other colours."""
    made = _corridor(round(1.8 * widths, 6))
    settings = replace(_SETTINGS, max_depth=int(2 * widths) + 2)
    return Case(made, settings, exact_picture(made, settings))


def _family(name: str, about: str, make: Callable[[], Scene], settings: Settings = _SETTINGS) -> Family:
    return Family(name, about, "distance from the origin, in sizes of the picture", _DISTANCES, _moving(make, settings))


FAMILIES = (
    _family("tie-tile", "Rays meet the edges of tiles exactly: the tile beyond begins there.", _tiles),
    _family("tie-texel", "Rays meet the edges of texels exactly: the texel beyond begins there.", _texels),
    _family("tie-along", "Rays run along a slanting wall, inside of it, and do not leave it.", _along),
    _family("tie-in-plane", "Rays run in a side and in a top of slanting boxes: both are seen.", _in_plane),
    _family("tie-edge", "Rays touch the edges of a slanting box: it is seen.", _edge),
    _family("tie-bodies", "Rays meet two bodies where they meet: the first of the file is seen.", _bodies),
    _family(
        "tie-shadow", "Shadow rays touch the edges of a box, and are blocked, or start at it, and are not.", _shadow
    ),
    _family("tie-tangent", "Rays touch a ball, and pass by.", _tangent, _ROUND),
    _family("tie-critical", "Rays leave glass at the critical angle, and run along its surface.", _critical, _ROUND),
    Family(
        "tie-mirrored",
        "Rays are mirrored to and fro before they meet the edges of tiles exactly: the tile beyond begins there.",
        "length of the corridor in widths",
        (2.0, 6.0, 18.0, 54.0),
        _mirrored,
    ),
)
