"""Writes scenes of round numbers, in which rays meet edges, planes and tiles exactly.

    python scenes/round_numbers.py 17 seventeen.in    the 17th of any number of them, and its texture beside it

What is written is the same on every machine, byte by byte; see `generate.py`. Scenes are made for one size of pictures,
with sides that are multiples of 8, and for rays through the corners or the centres of the pixels, as their first line
says. There are few casts of bodies, and scenes of one cast differ in numbers only.
"""

import argparse
import random
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from making.text import SceneText, numbers
from making.vectors import Plane, Vector, add, box, scale

TEXTURE = "squares.ppm"
"""The name of the texture of all scenes, in their folder."""
SQUARES = "P3 4 4 255" + "".join(
    f" {60 + 60 * column} {40 + 70 * row} {255 * ((column + row) % 2)}" for row in range(4) for column in range(4)
)
"""What is in it: 4 x 4 texels, of which no two are alike."""

_GLASS = 3
"""The first body that is of glass, where some are."""

Pixel = Literal["corner", "center"]


class RoundScene(SceneText):
    """A scene that this script writes; `pixel` tells where in the pixels its rays pass."""

    script = "round_numbers.py"

    def __init__(self, pixel: Pixel, comment: str, eye: Vector, look_at: Vector, up: Vector, fovy: float) -> None:
        super().__init__(f"{comment}; --pixel {pixel}", eye, look_at, fovy, (0.3, 0.3, 0.3), up)
        self.pixel = pixel


# ---- Bodies ----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Block:
    """A box, by its lower and its upper corner."""

    low: Vector
    high: Vector


@dataclass(frozen=True)
class Ball:
    """A ball."""

    center: Vector
    radius: float


@dataclass(frozen=True)
class Bar:
    """A bar without ends, whose sides lie at 45 degrees."""

    planes: tuple[Plane, ...]


Body = Block | Ball | Bar


@dataclass(frozen=True)
class Cast:
    """How many bodies of each kind a scene has, and which finishes they may have.

    Attributes:
        name: for the scene's first line.
        room: all is in a box that is seen from within; else there is a floor.
        wall: there is a wall at the back.
        blocks, balls, bars: how many of each.
        mirrors, glass: some are.

    """

    name: str
    blocks: int = 0
    balls: int = 0
    bars: int = 0
    room: bool = False
    wall: bool = False
    mirrors: bool = False
    glass: bool = False


CASTS = (
    Cast("boxes", blocks=8),
    Cast("mirror boxes", blocks=6, bars=2, mirrors=True),
    Cast("glass boxes", blocks=4, balls=1, mirrors=True, glass=True),
    Cast("balls", balls=7, mirrors=True),
    Cast("balls on boxes", blocks=3, balls=4, wall=True),
    Cast("room", blocks=4, balls=2, room=True, mirrors=True),
    Cast("bars", balls=2, bars=5, wall=True, mirrors=True),
    Cast("boxes before a wall", blocks=7, balls=1, wall=True, mirrors=True, glass=True),
)

AXES: tuple[Vector, ...] = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
STEPS: tuple[Vector, ...] = (
    *AXES,
    *((a, b, 0) for a in (1, -1) for b in (1, -1)),
    *((a, 0, b) for a in (1, -1) for b in (1, -1)),
    (1, 1, 1),
    (-1, 1, -1),
)
"""From a cell to one that shares a face, an edge or a corner."""
SLANTS: tuple[Vector, ...] = (*AXES, (0.6, 0, 0.8), (-0.8, 0, 0.6), (0.6, 0.8, 0), (0, 0.8, -0.6))
"""Of length 1."""


def round_scene(seed: int) -> RoundScene:
    """The scene with this number."""
    return _Maker(seed).scene()


class _Maker:
    """Makes one scene; all lengths are multiples of a unit or of a few parts of it."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.seed = seed
        self.cast = self.random.choice(CASTS)
        self.unit = self.random.choice((1, 1, 1, 0.5, 2, 0.3))
        self.ground: float = self._times(self.random.choice((0, 0, -1, 1, -2, 3)))
        self.bodies: list[Body] = []
        self.straight = False  # the eye has to look along an axis, with a tangent of 1, to meet what it is placed for

    def scene(self) -> RoundScene:
        if self.cast.room:
            self.bodies.append(Block(self._at((-4, 0, -4)), self._at((4, 6, 4))))
        self._add_blocks()
        self._add_balls()
        self._add_bars()
        eye = self._eye()
        look_at, up = self._view(eye)
        fovy = 90 if self.straight else self.random.choice((90, 90, 90, 90, 60, 45, 30))
        pixel: Pixel = self.random.choice(("corner", "corner", "center"))
        s = RoundScene(pixel, f"Round numbers {self.seed}: {self.cast.name}", eye, look_at, up, fovy)
        for color in ((0.7, 0.65, 0.6), (0.3, 0.35, 0.4)):
            s.light(self._light(), color, self.random.choice(((1, 0, 0), (1, 0, 0), (0.5, 0.1, 0))))
        self._write(s)
        return s

    # -- Numbers

    def _times(self, steps: float) -> float:
        """So many units, as a decimal number of few digits."""
        return round(steps * self.unit, 6)

    def _at(self, steps: Vector) -> Vector:
        """A place on the lattice, whose heights count from the ground."""
        x, y, z = steps
        return (self._times(x), round(self.ground + self._times(y), 6), self._times(z))

    def _any_place(self, reach: int = 4, height: int = 5) -> Vector:
        """On the lattice, or on that of half units."""
        part = self.random.choice((1, 1, 2))
        x, z = (self.random.randint(-reach * part, reach * part) / part for _ in range(2))
        return self._at((x, self.random.randint(0, height * part) / part, z))

    # -- Bodies

    def _add_blocks(self) -> None:
        """Boxes of whole cells, most of which share a face, an edge or a corner with the one before."""
        cell = self._any_cell()
        for _ in range(self.cast.blocks):
            sizes = (0.5, 1) if self.random.random() < 0.3 else (1, 1, 1, 2)
            width, height, depth = (self.random.choice(sizes) for _ in range(3))
            self.bodies.append(Block(self._at(cell), self._at(add(cell, (width, height, depth)))))
            cell = add(cell, self.random.choice(STEPS)) if self.random.random() < 0.8 else self._any_cell()
            cell = (cell[0], max(cell[1], 0), cell[2])

    def _any_cell(self) -> Vector:
        return (self.random.randint(-3, 2), self.random.choice((0, 0, 0, 1)), self.random.randint(-3, 1))

    def _add_balls(self) -> None:
        """Balls that touch the floor, a box's top or side, or the ball before."""
        for _ in range(self.cast.balls):
            radius = self._times(self.random.choice((0.5, 1, 1, 1.5, 3)))
            way = self.random.random()
            before = self.bodies[-1] if self.bodies else None
            if isinstance(before, Ball) and way < 0.5:
                center = add(before.center, scale(self.random.choice(SLANTS), before.radius + radius))
            elif isinstance(before, Block) and way < 0.6:
                x, y, z = self.random.choice((before.low, before.high))
                center = self.random.choice(((x, before.high[1] + radius, z), (before.high[0] + radius, y, z)))
            else:
                x, y, z = self._any_place(3, 2)
                center = (x, self.ground + radius if way < 0.9 else y, z)
            self.bodies.append(Ball(_rounded(center), radius))

    def _add_bars(self) -> None:
        """Bars of square section across the floor or upright, whose sides lie at 45 degrees."""
        for _ in range(self.cast.bars):
            x, y, z = self._any_place(3, 2)
            normals: tuple[Vector, Vector] = self.random.choice(
                (((1, 0, 1), (1, 0, -1)), ((1, 1, 0), (1, -1, 0)), ((0, 1, 1), (0, 1, -1)))
            )
            planes: list[Plane] = []
            for normal in normals:
                middle = normal[0] * x + normal[1] * y + normal[2] * z
                half = self._times(self.random.choice((0.5, 1, 1)))
                planes.append((*normal, round(-middle - half, 6)))
                planes.append((*scale(normal, -1), round(middle - half, 6)))
            self.bodies.append(Bar(tuple(planes)))

    # -- The eye and the lights

    def _special_place(self) -> Vector:
        """In the plane of a face, on the line of an edge, at a corner or on a ball, if there are such."""
        body = self.random.choice(self.bodies)
        place = list(self._any_place(5, 4))
        if isinstance(body, Block):
            for axis in self.random.sample(range(3), self.random.choice((1, 1, 2, 3))):
                place[axis] = self.random.choice((body.low, body.high))[axis]
        elif isinstance(body, Ball):
            place = list(add(body.center, scale(self.random.choice(SLANTS), body.radius)))
        return _rounded((place[0], place[1], place[2]))

    def _any_ball(self) -> Ball:
        return self.random.choice([body for body in self.bodies if isinstance(body, Ball)])

    def _above(self, ball: Ball, direction: Vector) -> Vector:
        """From where lines with a slope of 4/3, or of 3/4, touch the ball."""
        thirds = round(ball.radius / self.unit, 6) in (1.5, 3)
        distance = ball.radius * self.random.choice((1.25, 5 / 3 if thirds else 1.25))
        return _rounded(add(ball.center, scale(direction, distance)))

    def _eye(self) -> Vector:
        way = self.random.random()
        if self.cast.glass and way < 0.2:
            self.straight = True
            glass = self.bodies[_GLASS]
            assert isinstance(glass, Block)
            return _rounded(scale(add(glass.low, glass.high), 0.5))
        if self.cast.balls and way < 0.3:
            self.straight = True
            return self._above(self._any_ball(), (0, 0, 1))
        if self.cast.room:
            return self._any_place(3, 5) if self.random.random() < 0.7 else self._special_place()
        way = self.random.random()
        if way < 0.45:
            return self._at((self.random.randint(-4, 4), self.random.randint(1, 5), self.random.randint(4, 8)))
        if way < 0.6:
            return self._special_place()
        before = self._times(self.random.randint(3, 6))
        if way < 0.8:
            x, y, _ = self._special_place()
            return (x, y, before)
        if way < 0.9:
            return (self._times(self.random.randint(-3, 3)), self.ground, before)
        return self._at((self.random.randint(-2, 2), self.random.randint(5, 7), self.random.randint(-2, 2)))

    def _view(self, eye: Vector) -> tuple[Vector, Vector]:
        """Where the eye looks, and what is up: along an axis, or a diagonal, or at a place of the lattice."""
        upright: Vector = (0, 1, 0)
        if self.straight:
            return _rounded(add(eye, (0, 0, -self.unit))), upright
        high = eye[1] - self.ground >= 5 * self.unit
        if high and self.random.random() < 0.6:
            return _rounded(add(eye, (0, -1, 0))), self.random.choice(((0, 0, -1), (1, 0, 0), (1, 0, -1)))
        if self.random.random() < 0.25:
            x, y, z = self._at((self.random.randint(-1, 1), self.random.randint(0, 2), self.random.randint(-2, 0)))
            if abs(eye[0] - x) + abs(eye[2] - z) > 0:
                return (x, y, z), upright
        inward = -1 if eye[0] > 0 else 1
        views: tuple[Vector, ...] = (
            *((0, 0, -1), (0, 0, -1), (inward, 0, 0)),
            *((inward, 0, -1), (3 * inward, 0, -4), (0, -1, -1), (0, -3, -4)),
        )
        return _rounded(add(eye, scale(self.random.choice(views), self.unit))), upright

    def _light(self) -> Vector:
        way = self.random.random()
        if self.cast.balls and way < 0.1:
            return self._above(self._any_ball(), (0, 1, 0))
        if way < 0.4:
            return self._special_place()
        if way < 0.5:
            return self._any_place(4, 0)
        if self.cast.room:
            return self._any_place(4, 6)
        return self._at((self.random.randint(-5, 5), self.random.randint(2, 8), self.random.randint(-4, 6)))

    # -- The file

    def _write(self, s: RoundScene) -> None:
        choice = self.random.choice
        step = choice((0.25, 0.5, 1, 0.1, 2.5))
        offset = choice((0, 0.25, 0.5, -1))
        rows = choice(((0, 0, step, 0), (0, step, 0, 0.5), (0, step, step, 0)))
        pigments = [
            s.pigment(f"checker 0.9 0.85 0.8 0.25 0.2 0.3 {choice((0.3, 0.5, 1, 1, 1.4))}"),
            s.pigment(f"texmap {TEXTURE}\n{numbers((step, 0, 0, offset))}\n{numbers(rows)}"),
            s.pigment(f"checker 0.9 0.5 0.2 0.3 0.6 0.7 {choice((0.3, 0.5, 1, 1.4))}"),
            s.solid((0.8, 0.4, 0.3)),
        ]
        matte = s.finish("0.4 0.6 0 1 0 0 0")
        finishes = [matte, s.finish(f"0.3 0.5 0.3 {choice((5, 50))} 0 0 0")]
        if self.cast.mirrors:
            finishes.append(s.finish(f"0.1 0.2 0.2 100 {choice((0.3, 0.5, 0.7))} 0 0"))
        if self.cast.glass:
            ratio = choice((0.6, 0.8) if self.straight else (1, 1.5, 0.6, 0.8))
            finishes.append(s.finish(f"0.1 0.1 0.2 100 {choice((0, 0.1))} {choice((0.5, 0.7))} {ratio}"))
        y = round(self.ground, 6)
        if not self.cast.room:
            s.polyhedron(choice(pigments[:2]), choice((matte, finishes[-1])), [(0, 1, 0, -y)])
        if self.cast.wall:
            wall: Plane = choice(((0, 0, 1, self._times(4)), (1, 0, 1, self._times(6)), (3, 0, 4, self._times(20))))
            s.polyhedron(choice(pigments[:2]), matte, [wall])
        for k, body in enumerate(self.bodies):
            # All pigments and finishes are used: a kernel is made for those that are.
            pigment = pigments[k] if k < len(pigments) else choice(pigments)
            finish = finishes[k] if k < len(finishes) else choice(finishes)
            if isinstance(body, Ball):
                s.sphere(pigment, finish, body.center, body.radius)
            else:
                planes: Sequence[Plane] = box(body.low, body.high) if isinstance(body, Block) else body.planes
                s.polyhedron(pigment, finish, planes)


def _rounded(v: Vector) -> Vector:
    return (round(v[0], 6), round(v[1], 6), round(v[2], 6))


def main() -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description="Write a scene of round numbers, and its texture beside it.")
    parser.add_argument("seed", type=int, help="its number")
    parser.add_argument("file", type=Path, help="the scene file to write")
    arguments = parser.parse_args()
    try:
        arguments.file.write_text(str(round_scene(arguments.seed)), encoding="ascii")
        arguments.file.with_name(TEXTURE).write_text(SQUARES, encoding="ascii")
    except OSError as error:
        parser.error(f"{arguments.file}: {(error.strerror or str(error)).lower()}")


if __name__ == "__main__":
    main()
