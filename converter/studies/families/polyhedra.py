"""Polyhedra that are hardly any, or that go on for ever."""

import math
from collections.abc import Sequence

import numpy as np

from converter.scene.model import Checker, Color, Finish, Pigment, Plane, Polyhedron, Shape, Vector
from converter.studies.families.closed_forms import checkered, directions, first_hit, lit, long
from converter.studies.families.scenes import GLOW, MATTE, WHITE, box, camera, floor, light, scene, settings
from converter.studies.family import Case, Family

Body = tuple[Shape, Pigment | Color, Finish]
DECADES = tuple(10.0**-k for k in range(13))
"""1 to 1e-12."""
HAIRS = tuple(10.0**-k for k in range(1, 16))
"""1e-1 to 1e-15."""
EYE: Vector = (2.0, 3.0, 4.0)
LIGHT: Vector = (3.0, 7.0, 5.0)
BOX = (
    (1.0, 0.0, 0.0, -1.0),
    (-1.0, 0.0, 0.0, -1.0),
    (0.0, 1.0, 0.0, -1.0),
    (0.0, -1.0, 0.0, -1.0),
    (0.0, 0.0, 1.0, -1.0),
    (0.0, 0.0, -1.0, -1.0),
)


def _body(planes: Sequence[Plane], eye: Vector = EYE, look_at: Vector = (0.0, 0.0, 0.0), fovy: float = 40.0) -> Case:
    """A matte body before black, with its picture in long double."""
    view, drawn = camera(eye, look_at, fovy), settings()
    truth = lit(planes, eye, directions(view, drawn), LIGHT, MATTE.ka, MATTE.kd)
    return Case(scene(view, [(Polyhedron(tuple(planes)), WHITE, MATTE)], [light(LIGHT)]), drawn, truth)


def _sliver(slope: float) -> Case:
    """A wedge of glass above a checkered floor, which it shades."""
    top = (-slope, 1.0, 0.0, -slope)
    wedge = Polyhedron(
        (top, (0.0, -1.0, 0.0, 0.0), (1.0, 0.0, 0.0, -1.0), (0.0, 0.0, 1.0, -1.0), (0.0, 0.0, -1.0, -1.0))
    )
    glass = Finish(0.1, 0.4, 0.0, 1.0, 0.2, 0.6, 1.5)
    ground = Checker((0.9, 0.8, 0.7), (0.2, 0.3, 0.4), 0.5)
    bodies: list[Body] = [(wedge, WHITE, glass), (floor(-0.75), ground, MATTE)]
    return Case(scene(camera((1.0, 4.0, 3.0), (0.0, 0.0, 0.0)), bodies, [light(LIGHT)]), settings(), None)


def _spike(length: float) -> Case:
    """A pyramid on a square whose tip is far behind it."""
    taper = 0.5 / length
    sides = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)]
    planes = [(x, y, -taper, -0.5) for x, y in sides] + [(0.0, 0.0, 1.0, 0.0)]
    return _body(planes, (1.5, 1.0, 2.0), (0.0, 0.0, -2.0), 60.0)


def _thread(width: float) -> Case:
    """A long prism, seen through a lens that makes it as wide as ever."""
    sides = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
    planes = [(x, y, 0.0, -width) for x, y in sides] + [(0.0, 0.0, 1.0, -1.0), (0.0, 0.0, -1.0, -1.0)]
    return _body(planes, (4.0, 0.0, 0.25), (0.0, 0.0, 0.25), 40.0 * width)


def _near_copies(tilt: float) -> Case:
    """A box of which each face is four planes."""
    planes: list[Plane] = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            for other in ((axis + 1) % 3, (axis + 2) % 3):
                for lean in (tilt, -tilt):
                    normal = [0.0, 0.0, 0.0]
                    normal[axis], normal[other] = sign, lean
                    planes.append((normal[0], normal[1], normal[2], -1.0))
    return _body(planes, (3.0, 4.0, 5.0))


def _touching(depth: float) -> Case:
    """A box with a corner, an edge and a face cut."""
    cuts = [(1.0, 1.0, 1.0, depth - 3.0), (1.0, 1.0, 0.0, depth - 2.0), (0.0, 0.0, 1.0, depth - 1.0)]
    return _body((*BOX, *cuts))


def _normals(length: float) -> Case:
    turned = [(0.6, 0.8, 0.0, -0.9), (-0.8, 0.6, 0.0, -0.8), (0.0, -1.0, 0.0, -0.7), (0.36, 0.48, 0.8, -1.0)]
    planes = [(a * length, b * length, c * length, d * length) for a, b, c, d in (*turned, *BOX)]
    return _body(planes)


def _gem(count: float) -> Case:
    """Planes that touch the unit ball, evenly."""
    golden = math.pi * (3 - math.sqrt(5))
    planes = []
    for k in range(round(count)):
        y = 1 - (2 * k + 1) / count
        ring = math.sqrt(1 - y * y)
        planes.append((ring * math.cos(golden * k), y, ring * math.sin(golden * k), -1.0))
    return _body(planes, fovy=20.0 if count > 4 else 60.0)


def _horizon(zoom: float) -> Case:
    """A quarter of space, its edge running to the horizon, with a checkerboard that is as large as it is far."""
    planes = ((0.0, 1.0, 0.0, -0.25), (1.0, 0.0, 0.0, -0.25))
    fovy = math.degrees(2 * math.atan(math.tan(math.radians(20)) / zoom))
    view, drawn = camera((1.03, 1.27, 0.5), (1.03, 1.27, -1.5), fovy), settings()
    pattern = Checker((0.9, 0.8, 0.7), (0.2, 0.3, 0.4), 3.9 * zoom)
    d = directions(view, drawn)
    t, n = first_hit(planes, view.eye, d)
    hit = np.isfinite(t)
    p = long(view.eye) + np.where(hit, t, 0)[..., None] * d
    # Exactly on the plane, as 0.25 is.
    p = np.where(n > 0.5, np.longdouble(0.25), p)
    truth = np.where(hit[..., None], checkered(pattern, p), 0.0)
    return Case(scene(view, [(Polyhedron(planes), pattern, GLOW)]), drawn, truth)


def _empty(gap: float) -> Case:
    """A box whose two sides have changed places, before another."""
    nothing = (*BOX[1:], (1.0, 0.0, 0.0, 1.0 + gap))
    behind = box((-2.0, -2.0, -4.0), (2.0, 2.0, -3.0))
    view, drawn = camera(EYE, (0.0, 0.0, 0.0)), settings()
    truth = lit(behind.planes, EYE, directions(view, drawn), LIGHT, MATTE.ka, MATTE.kd)
    bodies = [(Polyhedron(nothing), WHITE, MATTE), (behind, WHITE, MATTE)]
    return Case(scene(view, bodies, [light(LIGHT)]), drawn, truth)


def _plate(thickness: float) -> Case:
    """A standing plate, which shades a floor."""
    plate = box((1.0, 0.0, -1.0), (1.0 + thickness, 1.5, 1.0))
    bodies = [(plate, (0.9, 0.3, 0.2), MATTE), (floor(-0.125), WHITE, MATTE)]
    return Case(scene(camera((-2.0, 3.0, 4.0), (1.0, 0.5, 0.0)), bodies, [light((-3.0, 7.0, 1.0))]), settings(), None)


FAMILIES: tuple[Family, ...] = (
    Family(
        "slivers",
        "A wedge of glass above a floor is made ever flatter: its upper and its lower side are nearly one plane.",
        "slope of the upper side",
        DECADES,
        _sliver,
    ),
    Family(
        "plates",
        "A plate is made ever thinner: the sides that a ray enters and leaves by are hardly apart.",
        "thickness over distance from the origin",
        HAIRS[:13],
        _plate,
    ),
    Family(
        "spikes",
        "A pyramid is made ever longer: its four sides are nearly parallel and meet far away.",
        "length over width",
        tuple(10.0**k for k in range(13)),
        _spike,
    ),
    Family(
        "threads",
        "A prism is made ever thinner, and seen through an ever longer lens.",
        "width over length",
        DECADES,
        _thread,
    ),
    Family(
        "near-copies",
        "Each face of a box is four planes that lean against one another, ever less, and in the end coincide.",
        "lean, in radians",
        (*HAIRS, 1e-16, 1e-17),
        _near_copies,
    ),
    Family(
        "touching-planes",
        "Planes cut a corner, an edge and a face of a box, ever less, until they only touch.",
        "depth of the cut over the size of the box",
        (*HAIRS, 1e-16, 1e-17),
        _touching,
    ),
    Family(
        "normals",
        "The planes of a body are multiplied by a number, which changes nothing.",
        "length of the normals",
        tuple(10.0**k for k in range(-9, 10)),
        _normals,
        both_ways=True,
    ),
    Family(
        "faces",
        "A cut stone has ever more faces: they grow small, and each ray has to be compared with all of them.",
        "number of planes",
        (4.0, 10.0, 32.0, 100.0, 316.0, 1000.0, 2000.0),
        _gem,
    ),
    Family(
        "horizon",
        "A body without end is seen to its horizon through an ever longer lens, its tiles growing with the distance.",
        "distance of what is seen over the height of the eye",
        tuple(10.0**k for k in range(13)),
        _horizon,
    ),
    Family(
        "empty",
        "Two planes of a box exclude each other by a hair: there is nothing, and nothing may be seen.",
        "gap between the planes over their distance from the origin",
        HAIRS,
        _empty,
    ),
)
