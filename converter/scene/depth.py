"""How many bounces a ray is followed for, worked out from finishes and the cut-off.

The cut-off alone is meant to end a tree of rays. Two limits guard against scenes in which it never does: `MAX_DEPTH`
bounces, and, where rays branch, fewer than `MOST_RAYS` rays for one primary ray. The most that there can be is

    R(w, n) = 1 + max over finishes of  sum over k in {kr, kt}, k > 0 and w k >= cutoff, of  R(w k, n - 1),

n being the bounces that are left, R(w, 0) = 1. While the mirrored ray is followed first, the transmitted one waits; so
many wait at once at most:

    W(w, n) = max over finishes of  max(W(w kr, n - 1) + 1, W(w kt, n - 1)) where both are followed, else W of the one.

Both grow with w. They are worked out for weights rounded up to powers of a number near 1.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from converter.scene.model import Finish
from converter.scene.settings import Settings

MAX_DEPTH = 1000
"""Most bounces that are followed, also where `--max-depth` sets their number."""
MOST_RAYS = 1 << 16
"""Where rays branch, a primary ray has fewer, itself among them, as deep as the default is."""
STEPS = 1024
"""Weights that are told apart between the cut-off and 1."""
SLACK = 1e-6
"""By how much the logarithm, to base 2, of a coefficient may grow where it is rounded to single precision."""

Rule = Literal["none", "set", "cutoff", "bounces", "rays"]


@dataclass(frozen=True, slots=True)
class DepthLimit:
    """How deep rays are followed.

    Attributes:
        bounces: after the primary ray.
        rule: what made it so: no ray is followed at all, `--max-depth` says so, the cut-off ends all trees before,
            `MAX_DEPTH`, or `MOST_RAYS`.
        needed: bounces after which the cut-off has ended every tree; None where it may never do.
        waiting: most rays of a tree that wait at once, if of two successors the mirrored one is followed first.

    """

    bounces: int
    rule: Rule
    needed: int | None
    waiting: int

    @property
    def acts(self) -> bool:
        """Whether it may drop a ray that the cut-off would keep."""
        return self.needed is None or self.bounces < self.needed


def depth_limit(finishes: list[Finish], settings: Settings) -> DepthLimit:
    """The limit where objects have these finishes."""
    cutoff = settings.cutoff
    needed = _needed(max((max(f.kr, f.kt) for f in finishes), default=0.0), cutoff)
    if needed == 0:
        return DepthLimit(0, "none", 0, 0)
    limit, rule = MAX_DEPTH, "bounces"
    if settings.max_depth is not None:
        limit, rule = settings.max_depth, "set"
    if needed is not None and needed <= limit:
        limit, rule = needed, "cutoff"
    if not any(can_branch(f, cutoff) for f in finishes):
        return DepthLimit(limit, rule, needed, 0)  # type: ignore[arg-type]
    pairs = frozenset((f.kr, f.kt) for f in finishes)
    depth, waiting = _bounded(pairs, cutoff, limit, math.inf if settings.max_depth is not None else MOST_RAYS)
    return DepthLimit(depth, rule if depth == limit else "rays", needed, waiting)  # type: ignore[arg-type]


def can_branch(finish: Finish, cutoff: float) -> bool:
    """Whether a ray that meets this finish may have two successors."""
    weaker = min(finish.kr, finish.kt)
    return weaker > 0 and (weaker >= cutoff or max(finish.kr, finish.kt) > 1)


def _needed(largest: float, cutoff: float) -> int | None:
    """Bounces until every product of coefficients up to `largest` is below the cut-off; None: it may never be."""
    if largest == 0 or largest < cutoff:
        return 0
    if largest >= 1 or cutoff == 0:
        return None
    return math.ceil(math.log(cutoff) / math.log(largest))


@lru_cache(maxsize=64)
def _bounded(pairs: frozenset[tuple[float, float]], cutoff: float, limit: int, most: float) -> tuple[int, int]:
    """The greatest depth up to `limit` with fewer than `most` rays, and how many rays may wait there.

    A weight is told by how many steps it may still lose until it is below the cut-off; -1: it never is.
    """
    start, step = -1, 1.0
    if 0 < cutoff < 1:
        start, step = STEPS, -math.log2(cutoff) / STEPS

    def cost(coefficient: float) -> int | None:
        """Steps that a factor takes at least; None: no ray is followed, -1: weights may grow."""
        if coefficient == 0:
            return None
        lost = -math.log2(coefficient) - SLACK
        return math.floor(max(lost, 0.0) / step) if coefficient <= 1 else -1

    def after(left: int, lost: int | None) -> int | None:
        if lost is None:
            return None
        if left == -1 or lost == -1:
            return -1
        return left - lost if left >= lost else None

    costs = {(cost(kr), cost(kt)) for kr, kt in pairs}
    successors: dict[int, set[tuple[int | None, int | None]]] = {}
    pending = [start]
    while pending:
        left = pending.pop()
        if left not in successors:
            successors[left] = {(after(left, r), after(left, t)) for r, t in costs}
            pending += [state for pair in successors[left] for state in pair if state is not None]
    rays: dict[int | None, int] = {None: 0, **dict.fromkeys(successors, 1)}
    waiting: dict[int | None, int] = {None: 0, **dict.fromkeys(successors, 0)}
    for depth in range(limit):
        more: dict[int | None, int] = {None: 0}
        wait: dict[int | None, int] = {None: 0}
        for left, pairs_left in successors.items():
            more[left] = 1 + max(rays[r] + rays[t] for r, t in pairs_left)
            wait[left] = max(max(waiting[r] + (r is not None and t is not None), waiting[t]) for r, t in pairs_left)
        if more[start] >= most:
            return depth, waiting[start]
        if more == rays and wait == waiting:
            break
        rays, waiting = more, wait
    return limit, waiting[start]
