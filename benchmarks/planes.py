"""Prints how long it takes to find out about a polyhedron of many planes: its faces, its box, which planes cut nothing.

    python benchmarks/planes.py [PLANES ...]

A stone whose planes touch a ball, one of which nine planes in ten cut nothing, a column without ends, and a cone
without end, with its tip at the origin and elsewhere, where every plane meets every other one in one point.
"""

import math
import sys
import time
from collections.abc import Callable, Sequence

from native_tracer.halfspaces import polyhedron_facts

Plane = tuple[float, float, float, float]
SIZES = (1_000, 10_000, 100_000)


def main() -> None:
    """Print a row for each kind of body, a column for each number of planes."""
    sizes = [int(word) for word in sys.argv[1:]] or SIZES
    print("seconds to work out the facts of one polyhedron, by its number of planes")
    print(f"{'':<26}{''.join(f'{size:>12,}' for size in sizes)}")
    bodies: dict[str, Callable[[int], Sequence[Plane]]] = {
        "stone": stone,
        "stone, 9 in 10 redundant": lambda count: stone(count, redundant=True),
        "column": lambda count: ring(count, 0.0, -1.0),
        "cone": lambda count: ring(count, 1.0, 0.0),
        "cone, tip off the origin": lambda count: ring(count, 1.0, -1.0),
    }
    for name, planes in bodies.items():
        print(f"{name:<26}{''.join(f'{_seconds(planes(size)):>12.2f}' for size in sizes)}", flush=True)


def stone(count: int, redundant: bool = False) -> list[Plane]:
    """Planes spread evenly about the unit ball, on a spiral."""
    turn = math.pi * (3 - math.sqrt(5))
    planes = []
    for k in range(count):
        y = 1 - (2 * k + 1) / count
        r = math.sqrt(1 - y * y)
        planes.append((r * math.cos(turn * k), y, r * math.sin(turn * k), -1.1 if redundant and k % 10 else -1.0))
    return planes


def ring(count: int, slope: float, offset: float) -> list[Plane]:
    """Planes about the y axis."""
    angles = (2 * math.pi * k / count for k in range(count))
    return [(math.cos(angle), slope, math.sin(angle), offset) for angle in angles]


def _seconds(planes: Sequence[Plane]) -> float:
    started = time.perf_counter()
    polyhedron_facts([planes])
    return time.perf_counter() - started


if __name__ == "__main__":
    main()
