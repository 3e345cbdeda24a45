"""Which of many methods are the best for some time or some error."""

from collections.abc import Sequence


def pareto_front(points: Sequence[tuple[float, float]]) -> list[int]:
    """Indices of the points (time, error) that no other beats: none is faster and as exact, or more exact and as fast.

    They come from the fastest to the most exact; of equal points the first.
    """
    front: list[int] = []
    for i in sorted(range(len(points)), key=lambda i: (points[i], i)):
        if not front or points[i][1] < points[front[-1]][1]:
            front.append(i)
    return front
