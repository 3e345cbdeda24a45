"""Things in the same place: faces in one plane, and faces where a pigment changes its colour."""

import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from converter.scene.model import Checker, Polyhedron, Texmap
from converter.studies.families.closed_forms import directions, long, two_colors
from converter.studies.families.scenes import GLOW, NORMAL, camera, floor, on_slope, scene, settings, slope
from converter.studies.family import Case, Family

_SETTINGS = settings()
RED, BLUE = (0.9, 0.2, 0.1), (0.1, 0.2, 0.9)


def _coplanar(length: float) -> Case:
    """Two bodies below one slanting plane, which the second one writes another way. The first of the file is seen."""
    view = camera((1.0, 5.0, 6.0), (0.0, 0.0, 0.0), 30.0)
    a, b, c, d = 1.0, 3.0, 2.0, -2.0
    first = Polyhedron(((a, b, c, d),))
    second = Polyhedron(((length * a, length * b, length * c, length * d),))
    made = scene(view, [(first, RED, GLOW), (second, BLUE, GLOW)])
    return Case(made, _SETTINGS, np.broadcast_to(np.array(RED), (_SETTINGS.height, _SETTINGS.width, 3)))


def _nearly_coplanar(apart: float) -> Case:
    """The plane that is higher by a hair comes second in the file."""
    view = camera(on_slope(14.0, 1.0, 0.25), on_slope(), 30.0, NORMAL)
    bodies = [(Polyhedron((slope(),)), BLUE, GLOW), (Polyhedron((slope(7 + apart),)), RED, GLOW)]
    return Case(scene(view, bodies), _SETTINGS, np.broadcast_to(np.array(RED), (_SETTINGS.height, _SETTINGS.width, 3)))


def _checker(cells: float) -> Case:
    """A floor at a whole number of cells, that belongs to the cells above it."""
    size = 0.5
    height = size * cells
    # The eye is at a place that doubles hold: its distance from the floor is the same for all.
    eye = (0.3125, height + 5.125, 2.25)
    view = camera(eye, (0.0, height, 0.0))
    d = directions(view, _SETTINGS)
    p = long((eye[0], 5.125, eye[2])) - d * (np.longdouble(5.125) / d[..., 1])[..., None]
    odd = (np.floor(p[..., 0] / size) + np.floor(p[..., 2] / size) + cells) % 2 != 0
    made = scene(view, [(floor(height), Checker(RED, BLUE, size), GLOW)])
    return Case(made, _SETTINGS, two_colors(odd, BLUE, RED))


@cache
def _folder() -> "tempfile.TemporaryDirectory[str]":
    """A folder that is kept as long as the process runs."""
    return tempfile.TemporaryDirectory(prefix="whitted-")


@cache
def texture_file() -> Path:
    """A file of 2 x 2 texels: red and green above, blue and white below."""
    file = Path(_folder().name, "texture.ppm")
    file.write_text("P3 2 2 255  255 0 0  0 255 0  0 0 255  255 255 255\n", encoding="ascii")
    return file


def _seam(repeats: float) -> Case:
    """A floor at a whole number of images, where the row changes; the columns run along x."""
    eye = (0.3125, repeats + 5.125, 2.25)
    view = camera(eye, (0.0, repeats, 0.0))
    d = directions(view, _SETTINGS)
    x = eye[0] - d[..., 0] * np.longdouble(5.125) / d[..., 1]
    column = np.trunc(2 * (x + 64)) % 2
    texels = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    pigment = Texmap(texture_file(), (1.0, 0.0, 0.0, 64.0), (0.0, 1.0, 0.0, 0.0))
    made = scene(view, [(floor(repeats), pigment, GLOW)])
    return Case(made, _SETTINGS, texels[column.astype(int)])


FAMILIES = (
    Family(
        "coplanar",
        "Two bodies end in one slanting plane, which the second writes with a longer normal: the first of the file is "
        "seen, everywhere.",
        "length of the second normal over the first's",
        (1.0, 3.0, 7.0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9),
        _coplanar,
    ),
    Family(
        "nearly-coplanar",
        "Two slanting floors nearer and nearer each other: the higher one is seen.",
        "distance of the floors, 7 from the origin",
        tuple(7 * 2.0**-power for power in range(3, 52, 3)),
        _nearly_coplanar,
    ),
    Family(
        "checker-boundary",
        "A checkered floor that is exactly a number of cells high, where the checker's colours change.",
        "height of the floor in cells",
        tuple(10.0**power for power in range(13)),
        _checker,
    ),
    Family(
        "texmap-seam",
        "A floor at the height where one copy of its image ends and the next begins.",
        "height of the floor in images",
        tuple(10.0**power for power in range(13)),
        _seam,
    ),
)
