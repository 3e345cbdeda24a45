"""Writes scenes of random numbers, of all that the format has.

    python scenes/random_scenes.py 17 seventeen.in    the 17th of any number of them, and its texture beside it

What is written is the same on every machine, byte by byte; see `generate.py`. Colours and coefficients are decimal
numbers of two digits, as people write them; bodies, eyes and lights lie anywhere.
"""

import argparse
import random
from pathlib import Path

from making.text import SceneText, numbers
from making.vectors import Color, Plane, Vector
from round_numbers import SQUARES, TEXTURE


class RandomScene(SceneText):
    """A scene that this script writes."""

    script = "random_scenes.py"


def random_scene(seed: int) -> RandomScene:
    """The scene with this number."""
    return _Maker(seed).scene()


class _Maker:
    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.seed = seed

    def scene(self) -> RandomScene:
        between, choice = self._between, self.random.choice
        eye = (between(-4, 4), between(0.5, 5), between(6, 10))
        look_at = (between(-1, 1), between(0, 1.5), between(-1, 1))
        s = RandomScene(f"Random numbers {self.seed}", eye, look_at, between(25, 70), self._color())
        for _ in range(choice((1, 2, 2, 3))):
            fading = choice(((1, 0, 0), (self._decimal(1), 0.1, 0), (self._decimal(1), 0.05, 0.01)))
            s.light((between(-8, 8), between(2, 9), between(-3, 9)), self._color(), fading)
        size = choice((0.4, 0.75, 1.3))
        pigments = [
            s.pigment(f"checker {numbers(self._color())} {numbers(self._color())} {numbers((size,))}"),
            s.pigment(f"texmap {TEXTURE}\n{numbers(self._projection())}\n{numbers(self._projection())}"),
            *(s.solid(self._color()) for _ in range(3)),
        ]
        finishes = [s.finish(self._finish(kind)) for kind in ("matte", "glossy", choice(("mirror", "glass", "glossy")))]
        s.polyhedron(choice(pigments[:2]), choice(finishes[:2]), [self._tilted((0, 1, 0), 0)])
        for k in range(self.random.randint(3, 9)):
            pigment, finish = choice(pigments), finishes[k] if k < len(finishes) else choice(finishes)
            center = (between(-3.5, 3.5), between(0.3, 2), between(-4, 3))
            if self.random.random() < 0.6:
                s.sphere(pigment, finish, center, between(0.3, 1.2))
            else:
                s.polyhedron(pigment, finish, self._block(center))
        return s

    def _between(self, low: float, high: float) -> float:
        return round(self.random.uniform(low, high), 6)

    def _decimal(self, most: float) -> float:
        """A number of two digits after the point, above 0."""
        return round(self.random.uniform(0.01, most), 2)

    def _color(self) -> Color:
        return (self._decimal(1), self._decimal(1), self._decimal(1))

    def _finish(self, kind: str) -> str:
        shading = (self._decimal(0.5), self._decimal(0.8), 0 if kind == "matte" else self._decimal(0.8))
        alpha = self.random.choice((1, 2, 5, 12.5, 50, 300))
        kr = self._decimal(0.6) if kind in ("mirror", "glass") else 0
        kt, ior = (self._decimal(0.8), self.random.choice((1.5, 1.33, 0.66))) if kind == "glass" else (0, 0)
        return numbers((*shading, alpha, kr, kt, ior))

    def _projection(self) -> tuple[float, float, float, float]:
        a, b, c, d = (self._between(-0.6, 0.6) for _ in range(4))
        return (a, b, c, d)

    def _block(self, center: Vector) -> list[Plane]:
        """A box with skewed sides."""
        return [
            self._tilted(normal, -sum(n * x for n, x in zip(normal, center, strict=True)) - self._between(0.3, 0.9))
            for axis in range(3)
            for side in (1.0, -1.0)
            for normal in [tuple(side if k == axis else 0.0 for k in range(3))]
        ]

    def _tilted(self, normal: tuple[float, ...], offset: float) -> Plane:
        a, b, c = (round(n + self._between(-0.05, 0.05), 6) for n in normal)
        return (a, b, c, round(offset, 6))


def main() -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description="Write a scene of random numbers, and its texture beside it.")
    parser.add_argument("seed", type=int, help="its number")
    parser.add_argument("file", type=Path, help="the scene file to write")
    arguments = parser.parse_args()
    try:
        arguments.file.write_text(str(random_scene(arguments.seed)), encoding="ascii")
        arguments.file.with_name(TEXTURE).write_text(SQUARES, encoding="ascii")
    except OSError as error:
        parser.error(f"{arguments.file}: {(error.strerror or str(error)).lower()}")


if __name__ == "__main__":
    main()
