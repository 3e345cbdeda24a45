"""Writes scenes with csgs of random leaves, many of whose faces coincide.

    python scenes/random_csg.py 17 seventeen.in    the 17th of any number of them

What is written is the same on every machine, byte by byte; see `generate.py`. A csg has 2 to 64 leaves, balls,
polyhedra and quadrics, some of them twice, up to five deep; they lie on a coarse grid, in a frame that may be turned,
and planes that are one are written with different factors.
"""

import argparse
import math
import random
from collections.abc import Sequence
from pathlib import Path

from making.text import SceneText, ball, csg, half_spaces, quadric
from making.vectors import Plane, Vector, add, dot, scale, unit

FRAMES: tuple[tuple[Vector, Vector, Vector], ...] = (
    ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    ((4, 0, 3), (0, 1, 0), (-3, 0, 4)),
    ((2, 2, 1), (-2, 1, 2), (1, -2, 2)),
)
"""Directions at right angles, whose lengths are whole numbers."""
STEP = 0.25
"""Of the grid."""
SQUARES = 225.0
"""Such that the numbers of quadrics have few digits: lengths of directions are divisors of its root."""
RADII = (0.5, 1.0, 1.25)
DEEPEST = 5
MOST_LEAVES = 64
BOUNDED, OPEN = ("ball", "box", "box", "ellipsoid"), ("cylinder", "cone")


class CsgScene(SceneText):
    """A scene that this script writes."""

    script = "random_csg.py"


def random_csg_scene(seed: int) -> CsgScene:
    """The scene with this number."""
    return _Maker(seed).scene()


class _Maker:
    def __init__(self, seed: int) -> None:
        self._random = random.Random(seed)
        self._seed = seed
        self._frame = self._random.choice(FRAMES)
        self._leaves: dict[str, list[str]] = {}

    def scene(self) -> CsgScene:
        uniform, choice = self._random.uniform, self._random.choice
        s = CsgScene(
            f"A csg of random leaves, number {self._seed}",
            (uniform(-4, 4), uniform(1, 5), uniform(5, 8)),
            (0, 0.2, 0),
            35,
            (0.6, 0.7, 0.8),
        )
        for _ in range(choice((1, 2))):
            s.light((uniform(-8, 8), uniform(4, 9), uniform(2, 9)), (0.9, 0.8, 0.7))
        tiles = s.pigment("checker .9 .8 .7 .2 .3 .5 .61")
        paint = s.solid((0.8, 0.5, 0.3))
        matte = s.finish(".3 .6 .3 20 0 0 0")
        special = s.finish(choice((".2 .5 .5 50 .4 0 0", ".05 .1 .4 80 .1 .8 1.5", ".3 .6 .3 20 0 0 0")))
        s.polyhedron(tiles, matte, [(0, 1, 0, 1.6)])
        s.body(choice((tiles, paint)), special, self._csg(choice((2, 3, 4, 5, 6, 8, 12, 20, 40, MOST_LEAVES))))
        return s

    def _csg(self, leaves: int) -> str:
        """With a ball that nothing takes away, so that it is never nothing."""
        rest = self._tree(leaves - 1, DEEPEST)
        return csg(f"+ {rest}", f"+ {ball(self._turned((1.9, 0, 0)), 0.3)}")

    def _tree(self, leaves: int, deepest: int) -> str:
        """Of so many leaves, the first of them bounded."""
        if leaves <= 1:
            return self._leaf(BOUNDED)
        parts = self._random.randint(2, min(leaves, 6)) if deepest > 1 else leaves
        counts = [1] * parts
        for _ in range(leaves - parts):
            counts[self._random.randrange(parts)] += 1
        operands = [f"+ {self._tree(counts[0], deepest - 1)}"]
        for count in counts[1:]:
            if count > 1:
                operands.append(f"{self._random.choice('++-')} {self._tree(count, deepest - 1)}")
            elif self._random.random() < 0.3:
                operands.append(f"& {self._leaf(('half-space', 'slab'))}")
            else:
                operands.append(f"{self._random.choice('++--')} {self._leaf((*BOUNDED, *OPEN))}")
        return csg(*operands)

    def _leaf(self, kinds: Sequence[str]) -> str:
        """A new one, or one again."""
        kind = self._random.choice(kinds)
        known = self._leaves.setdefault(kind, [])
        if known and self._random.random() < 0.25:
            return self._random.choice(known)
        known.append(self._made(kind))
        return known[-1]

    def _made(self, kind: str) -> str:
        grid = self._grid
        center = (grid(-4, 4), grid(-4, 4), grid(-4, 4))
        middle = self._turned(center)
        if kind == "ball":
            return ball(middle, grid(2, 6))
        if kind in ("box", "slab", "half-space"):
            planes: list[Plane] = []
            for axis in range(3) if kind == "box" else (self._random.randrange(3),):
                half = grid(2, 6)
                planes.append(self._plane(axis, 1, center[axis] + half))
                if kind != "half-space":
                    planes.append(self._plane(axis, -1, half - center[axis]))
            return half_spaces(planes)
        x, y, z = self._random.sample(self._frame, 3)
        a, b, c = (SQUARES / (r * r) for r in self._random.choices(RADII, k=3))
        if kind == "ellipsoid":
            return _quadric([(a, x), (b, y), (c, z)], middle, SQUARES)
        if kind == "cylinder":
            return _quadric([(a, x), (a, y)], middle, SQUARES)
        return _quadric([(SQUARES, x), (SQUARES, y), (-SQUARES * self._random.choice((0.25, 1)), z)], middle, 0)

    def _grid(self, low: int, high: int) -> float:
        return STEP * self._random.randint(low, high)

    def _turned(self, v: Vector) -> Vector:
        x, y, z = (scale(unit(axis), w) for axis, w in zip(self._frame, v, strict=True))
        return add(add(x, y), z)

    def _plane(self, axis: int, side: int, distance: float) -> Plane:
        """One at a distance from the origin; a plane is written with various factors."""
        factor = self._random.choice((1, 1, 3, 7, 0.5))
        a, b, c = scale(self._frame[axis], side * factor)
        return (a, b, c, -factor * distance * math.hypot(*self._frame[axis]))


def _quadric(squares: list[tuple[float, Vector]], middle: Vector, constant: float) -> str:
    """The sum of factors times squares of coordinates along axes, about its middle, less a constant."""
    parts = [(f / dot(n, n), n) for f, n in squares]
    matrix = [[sum(f * n[i] * n[j] for f, n in parts) for j in range(3)] for i in range(3)]
    moved = [sum(row[j] * middle[j] for j in range(3)) for row in matrix]
    j = sum(m * x for m, x in zip(moved, middle, strict=True)) - constant
    mixed = (2 * matrix[0][1], 2 * matrix[0][2], 2 * matrix[1][2])
    return quadric([*(matrix[k][k] for k in range(3)), *mixed, *(-2 * m for m in moved), j])


def main() -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description="Write a scene with a csg of random leaves.")
    parser.add_argument("seed", type=int, help="its number")
    parser.add_argument("file", type=Path, help="the scene file to write")
    arguments = parser.parse_args()
    try:
        arguments.file.write_text(str(random_csg_scene(arguments.seed)), encoding="ascii")
    except OSError as error:
        parser.error(f"{arguments.file}: {(error.strerror or str(error)).lower()}")


if __name__ == "__main__":
    main()
