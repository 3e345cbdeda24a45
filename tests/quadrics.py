"""A quadric of every kind, and the same elsewhere: turned, stretched and moved, by exact numbers."""

from fractions import Fraction

from converter.scene.model import Quadric

BODIES = {
    "ellipsoid": (1, 2, 3, 0, 0, 0, 0, 0, 0, -1),
    "hyperboloid of one sheet": (1, 2, -1, 0, 0, 0, 0, 0, 0, -1),
    "hyperboloid of two sheets": (1, 2, -1, 0, 0, 0, 0, 0, 0, 1),
    "cone": (1, 2, -1, 0, 0, 0, 0, 0, 0, 0),
    "elliptic paraboloid": (1, 2, 0, 0, 0, 0, 0, 0, -1, 0),
    "elliptic cylinder": (1, 2, 0, 0, 0, 0, 0, 0, 0, -1),
    "hyperbolic cylinder": (1, -2, 0, 0, 0, 0, 0, 0, 0, 1),
    "parabolic cylinder": (1, 0, 0, 0, 0, 0, 0, -1, 0, 0),
    "parallel planes": (1, 0, 0, 0, 0, 0, 0, 0, 0, -1),
}
"""By their names; the complement of each has all signs turned."""
BOTH = {
    "hyperbolic paraboloid": (1, -2, 0, 0, 0, 0, 0, 0, -1, 0),
    "crossing planes": (1, -2, 0, 0, 0, 0, 0, 0, 0, 0),
    "half-space": (0, 0, 0, 0, 0, 0, 1, 0, 0, -1),
}
"""Their complements are of the same kind."""


def _complement(name: str) -> str:
    article = "an " if name[0] == "e" else "" if name == "parallel planes" else "a "
    return f"complement of {article}{name}"


SURFACES = {
    **BODIES,
    **{_complement(name): tuple(-x for x in numbers) for name, numbers in BODIES.items()},
    **BOTH,
}
FLAWS = {
    "no point is inside": [
        (1, 2, 3, 0, 0, 0, 0, 0, 0, 1),
        (1, 2, 0, 0, 0, 0, 0, 0, 0, 1),
        (1, 0, 0, 0, 0, 0, 0, 0, 0, 1),
        (0, 0, 0, 0, 0, 0, 0, 0, 0, 1),
    ],
    "every point is inside": [
        (-1, -2, -3, 0, 0, 0, 0, 0, 0, -1),
        (-1, -2, -3, 0, 0, 0, 0, 0, 0, 0),
        (-1, -2, 0, 0, 0, 0, 0, 0, 0, -1),
        (-1, -2, 0, 0, 0, 0, 0, 0, 0, 0),
        (-1, 0, 0, 0, 0, 0, 0, 0, 0, -1),
        (-1, 0, 0, 0, 0, 0, 0, 0, 0, 0),
        (0, 0, 0, 0, 0, 0, 0, 0, 0, -1),
        (0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
    ],
    "only a point is inside, which has no volume": [(1, 2, 3, 0, 0, 0, 0, 0, 0, 0)],
    "only a line is inside, which has no volume": [(1, 2, 0, 0, 0, 0, 0, 0, 0, 0)],
    "only a plane is inside, which has no volume": [(1, 0, 0, 0, 0, 0, 0, 0, 0, 0)],
}
"""What has no surface, by the reason."""


def quadric(numbers) -> Quadric:
    """Of any ten numbers."""
    return Quadric(tuple(map(float, numbers)))


def substituted(numbers, matrix, shift):
    """The ten numbers, exact, of f(matrix p + shift)."""
    a, b, c, d, e, f, g, h, i, j = map(Fraction, numbers)
    rows = ((a, d / 2, e / 2, g / 2), (d / 2, b, f / 2, h / 2), (e / 2, f / 2, c, i / 2), (g / 2, h / 2, i / 2, j))
    change = [[*map(Fraction, row), Fraction(s)] for row, s in zip(matrix, shift, strict=True)] + [
        [0, 0, 0, Fraction(1)]
    ]

    def product(k, m):
        return sum(change[i][k] * rows[i][j] * change[j][m] for i in range(4) for j in range(4))

    squares = [product(k, k) for k in range(3)]
    mixed = [2 * product(k, m) for k, m in ((0, 1), (0, 2), (1, 2))]
    return (*squares, *mixed, *(2 * product(k, 3) for k in range(3)), product(3, 3))


_SCENE = """\
3 4 -9   0 .2 0   0 1 0   35
2   0 0 0 .4 .5 .6 1 0 0   4 6 -5 .9 .8 .7 1 0 0
2   checker .9 .8 .7 .2 .3 .7 .5   solid .8 .8 .9
3   .3 .6 .3 20 .3 0 0   .2 .5 0 1 .3 0 0   .1 .2 .3 60 .2 .7 1.3
3
0 {finish} quadric {numbers}
0 1 polyhedron 1 0 1 0 1.75
1 0 sphere 1.2 .4 -2.5 .6
"""
_TURN = ((1, Fraction(1, 4), 0), (Fraction(-1, 4), 1, Fraction(1, 8)), (0, Fraction(1, 8), 1))


def scene_with(numbers, glass=False) -> str:
    """A scene file with a quadric, turned a little, over a mirror and behind a ball."""
    turned = substituted(numbers, _TURN, (Fraction(1, 8), Fraction(-1, 16), 0))
    return _SCENE.format(finish=2 if glass else 0, numbers=" ".join(repr(float(x)) for x in turned))
