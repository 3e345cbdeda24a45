"""Ray trees with two branches at every surface."""

from collections.abc import Sequence

import numpy as np

from converter.scene.model import Color, Finish
from converter.scene.settings import Settings
from converter.studies.families.scenes import camera, scene, sphere
from converter.studies.family import Case, Family

RADII = (1.0, 2.0, 4.0)
"""Of balls about the eye: every ray meets them at right angles, and stays on its line."""
COLORS: tuple[Color, ...] = ((0.9, 0.2, 0.1), (0.1, 0.8, 0.3), (0.2, 0.3, 0.9))


def _balls(kr: Sequence[float], kt: Sequence[float], depth: int) -> Case:
    """Balls about the eye, drawn to a depth, with the sum over all rays of the tree.

    All that counts of a ray is which ball it meets next and from which side, so that the 2^depth rays of a bounce are a
    few sums of weights.
    """
    drawn = Settings(8, 6, pixel="center", background=(0.0, 0.0, 0.0), cutoff=0.0, max_depth=depth)
    count = len(RADII)
    inner, outer = np.zeros(count), np.zeros(count)  # weights of the rays that are about to meet a ball, by side
    inner[0] = 1.0
    met = np.zeros(count)
    for _ in range(depth + 1):
        met += inner + outer
        outward = inner * kt + outer * kr
        inward = inner * kr + outer * kt
        inner, outer = np.concatenate([[inward[0]], outward[:-1]]), np.concatenate([inward[1:], [0.0]])
    # As bright as any picture, however many rays there are.
    ka = 0.75 / met.sum()
    bodies = [
        (sphere((0.0, 0.0, 0.0), RADII[i]), COLORS[i], Finish(ka, 0.0, 0.0, 1.0, kr[i], kt[i], 1.5))
        for i in range(count)
    ]
    truth = np.broadcast_to(ka * met @ np.array(COLORS), (drawn.height, drawn.width, 3))
    return Case(scene(camera((0.0, 0.0, 0.0), (1.0, 0.5, -2.0)), bodies), drawn, truth)


def _full_tree(depth: float) -> Case:
    return _balls([0.96875] * 3, [0.96875, 0.96875, 0.0], round(depth))


def _gain(gain: float) -> Case:
    return _balls([0.375 * gain, 0.5 * gain, gain], [0.625 * gain, 0.5 * gain, 0.0], 8)


FAMILIES: tuple[Family, ...] = (
    Family(
        "full-trees",
        "Three glass balls about the eye pass on nearly all light both ways: a ray has twice as many successors with "
        "every bounce.",
        "bounces",
        tuple(map(float, range(1, 17))),
        _full_tree,
    ),
    Family(
        "gain",
        "Balls about the eye pass on more light than they get, and no bounce is worth less than the one before.",
        "kr + kt",
        (0.5, 1.0, 1.25, 1.5, 2.0, 3.0, 4.0, 8.0),
        _gain,
    ),
)
