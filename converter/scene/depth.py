"""How many bounces a ray is followed for, worked out from finishes and the cut-off.

The cut-off alone is meant to end a tree of rays. Two limits guard against scenes in which it never does: `MAX_DEPTH`
bounces, and, where rays branch, fewer than `MOST_RAYS` rays for one primary ray. The most that there can be is

    R(w, n) = 1 + max over finishes of  sum over k in {kr, kt}, k > 0 and w k >= cutoff, of  R(w k, n - 1),

n being the bounces that are left, R(w, 0) = 1. It grows with w, and is worked out for weights rounded up to powers of a
number near 1, from the cut-off on.

While one of two successors is followed, the other waits. Where the lighter one is followed first, a ray has as many
below the one that waits as below itself, if not more, by that bound: so if W rays may wait, R >= 2^(W + 1) - 1.
"""

import math
from array import array
from collections.abc import Iterable
from typing import Literal

from converter.frozen import dataclass
from converter.scene.model import Finish
from converter.scene.settings import Settings

MAX_DEPTH = 1000
"""Most bounces that are followed, also where `--max-depth` sets their number."""
MOST_RAYS = 1 << 16
"""Where rays branch, a primary ray has fewer, itself among them, as deep as the default is."""
STEPS = 1024
"""Weights that are told apart between the cut-off and 1."""
SLACK = 1e-6
"""By how much the logarithm, to base 2, of a weight may grow where it is rounded to single precision."""

Rule = Literal["none", "set", "cutoff", "bounces", "rays"]
Costs = tuple[int, int]
"""Steps that a finish's coefficients take from a weight at least, the heavier one's first; more than there are: none
follows."""


@dataclass(frozen=True, slots=True)
class DepthLimit:
    """How deep rays are followed.

    Attributes:
        bounces: after the primary ray.
        rule: what made it so: no ray is followed at all, `--max-depth` says so, the cut-off ends all trees before,
            `MAX_DEPTH`, or `MOST_RAYS`.
        needed: bounces after which the cut-off has ended every tree; None where it may never do.
        waiting: most rays of a tree that wait at once, if of two successors the lighter one is followed first.

    """

    bounces: int
    rule: Rule
    needed: int | None
    waiting: int

    @property
    def acts(self) -> bool:
        """Whether it may drop a ray that the cut-off would keep."""
        return self.needed is None or self.bounces < self.needed


def depth_limit(finishes: Iterable[Finish], settings: Settings) -> DepthLimit:
    """The limit where objects have these finishes."""
    cutoff = settings.cutoff
    pairs = {(min(f.kr, f.kt), max(f.kr, f.kt)) for f in finishes}
    largest = max((heavier for _, heavier in pairs), default=0.0)
    needed = _needed(largest, cutoff)
    if needed == 0:
        return DepthLimit(0, "none", 0, 0)
    limit, rule = _unless_it_branches(needed, settings.max_depth)
    if not any(follows(lighter, largest, cutoff) for lighter, _ in pairs):
        return DepthLimit(limit, rule, needed, 0)
    start, costs = _in_steps(pairs, largest, cutoff)
    rays = _most_rays(start, costs)
    if settings.max_depth is None and rays >= MOST_RAYS:
        depth, rays = _deepest(start, costs, limit)
        if depth < limit:
            limit, rule = depth, "rays"
    waiting = limit if rays == math.inf else min(limit, (int(rays) + 1).bit_length() - 2)
    return DepthLimit(limit, rule, needed, waiting)


def follows(coefficient: float, largest: float, cutoff: float) -> bool:
    """Whether a ray may follow with this coefficient where the largest one of the scene is `largest`."""
    return coefficient > 0 and (coefficient >= cutoff or largest > 1)


def _needed(largest: float, cutoff: float) -> int | None:
    """Bounces until every product of coefficients up to `largest` is below the cut-off; None: it may never be."""
    if largest == 0 or largest < cutoff:
        return 0
    if largest >= 1 or cutoff == 0:
        return None
    return math.ceil(math.log(cutoff) / math.log(largest))


def _unless_it_branches(needed: int | None, max_depth: int | None) -> tuple[int, Rule]:
    limit = MAX_DEPTH if max_depth is None else max_depth
    if needed is not None and needed <= limit:
        return needed, "cutoff"
    return limit, "bounces" if max_depth is None else "set"


def _in_steps(pairs: Iterable[tuple[float, float]], largest: float, cutoff: float) -> tuple[int, list[Costs]]:
    """Steps that a weight of 1 may lose until it is below the cut-off, and the costs of finishes that may matter.

    Where the cut-off may never end a tree, nothing costs anything.
    """
    start, step = 0, math.inf
    if 0 < cutoff < 1 and largest <= 1:
        start, step = STEPS, -math.log2(cutoff) / STEPS

    def cost(coefficient: float) -> int:
        # Rounded, so that what is as heavy in single precision costs the same.
        rounded = array("f", [min(coefficient, 1.0)])[0]
        return math.floor(max(-math.log2(rounded or coefficient) - SLACK, 0.0) / step)

    costs: list[Costs] = []
    for heavy, light in sorted({(cost(b), cost(a) if a > 0 else start + 1) for a, b in pairs if b > 0}):
        if not costs or light < costs[-1][1]:  # else the one before costs less both ways
            costs.append((heavy, light))
    return start, costs


def _most_rays(start: int, costs: list[Costs]) -> float:
    """R for a weight of 1 and as many bounces as there may be."""
    if costs[0][0] == 0:
        return math.inf
    rays: list[float] = []
    for left in range(start + 1):
        below = ((rays[left - a] if a <= left else 0.0) + (rays[left - b] if b <= left else 0.0) for a, b in costs)
        rays.append(1.0 + max(below))
    return rays[start]


def _deepest(start: int, costs: list[Costs], limit: int) -> tuple[int, int]:
    """The greatest depth up to `limit` with fewer than `MOST_RAYS` rays, and R there."""
    import numpy as np

    rays = np.ones(start + 1, dtype=np.int64)
    for depth in range(limit):
        more = np.zeros_like(rays)
        for pair in costs:
            below = np.zeros_like(rays)
            for cost in pair:
                below[cost:] += rays[: max(start + 1 - cost, 0)]
            np.maximum(more, below, out=more)
        more += 1
        if more[start] >= MOST_RAYS:
            return depth, int(rays[start])
        rays = more
    return limit, int(rays[start])
