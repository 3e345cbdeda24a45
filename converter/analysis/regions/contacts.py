"""Surfaces that are nearly one, or nearly touch."""

from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np

from converter.analysis.regions.region import Finding, Region, worst
from converter.analysis.regions.situation import Floats, Situation
from converter.renderers.methods import Arithmetic
from converter.scene.model import Csg
from converter.shapes.csg_gaps import Gap, smallest_gap

NEIGHBORS = 8
"""Planes that a plane is compared with, at most: those that come next to it in an order in which planes that are
nearly the same come together."""
MOST_BALLS = 512
"""Transparent balls that are compared with one another."""
_EMBREE: Mapping[Arithmetic, float] = dict.fromkeys(("mesh", "offset", "ulp"), 1.5e-5)
_PROBE = np.array((0.5377, 0.7393, 0.4057, 0.3119))


def _planes(s: Situation, limit: float, facing: float, what: str) -> Iterator[Finding]:
    """Parallel planes of two bodies; `facing` is -1 for faces that look at each other, 1 for such as look one way."""
    planes = s.planes
    if len(planes.offset) < 2:
        return
    scale = max(float(np.abs(planes.offset).max()), s.reach) or 1.0
    rows = np.column_stack([planes.normal, planes.offset / scale])
    sign = np.where(rows[:, :3] @ _PROBE[:3] < 0, -1.0, 1.0)
    rows *= sign[:, None]
    order = np.argsort(rows @ _PROBE)
    found: tuple[float, int, int] | None = None
    count = 0
    for step in range(1, min(NEIGHBORS, len(order) - 1) + 1):
        one, other = order[:-step], order[step:]
        gap = np.abs(rows[one, 3] - rows[other, 3]) * scale
        reach = np.maximum(np.maximum(np.abs(planes.offset[one]), np.abs(planes.offset[other])), s.reach)
        near = (gap > 0) & (gap < limit * reach) & (sign[one] * sign[other] == facing)
        near &= planes.object[one] != planes.object[other]
        near &= np.abs(rows[one, :3] - rows[other, :3]).max(axis=1) <= limit
        for k in np.flatnonzero(near):
            i, j = sorted((int(one[k]), int(other[k])))
            if s.overlap(planes.object[i], planes.object[j]):
                count += 1
                found = min(found or (np.inf, 0, 0), (float(gap[k] / reach[k]), i, j))
    if found is not None:
        share, i, j = found
        a, b = int(planes.object[i]), int(planes.object[j])
        text = f"plane {planes.plane[i]} of object {a} is {what} plane {planes.plane[j]} of object {b} by {share:.2g}"
        more = f"; so are {count - 1} other pairs" if count > 1 else ""
        line = s.scene.objects[a].line
        yield Finding(line, f"{text} of the numbers that they are made of (less than {limit:.2g}{more})")


def _gaps(s: Situation, limit: float) -> Iterator[Finding]:
    return _planes(s, limit, -1.0, "apart from")


def _near_coplanar(s: Situation, limit: float) -> Iterator[Finding]:
    return _planes(s, limit, 1.0, "above or below")


def _glass_balls(s: Situation, limit: float) -> Iterator[Finding]:
    """Two balls of which one fills the other, or which share no more than a lens."""
    balls = [k for k in np.flatnonzero(s.bodies.is_ball) if s.finish(s.bodies.object[k]).kt > 0][:MOST_BALLS]
    best: tuple[float, int, int] | None = None
    for i, j in combinations(balls, 2):
        share = _closeness(s.bodies.center[i], s.bodies.center[j], s.bodies.radius[i], s.bodies.radius[j])
        if share < limit:
            best = min(best or (np.inf, 0, 0), (share, int(s.bodies.object[i]), int(s.bodies.object[j])))
    if best is not None:
        share, a, b = best
        text = f"object {a} comes as near to object {b} as {share:.2g} of its radius, and both are transparent"
        yield Finding(s.scene.objects[a].line, f"{text} (less than {limit:.2g})")


def _operands(s: Situation, limit: float) -> Iterator[Finding]:
    yield from _near_operands(s, limit, glass=False)


def _glass_operands(s: Situation, limit: float) -> Iterator[Finding]:
    yield from _near_operands(s, limit, glass=True)


def _near_operands(s: Situation, limit: float, glass: bool) -> Iterator[Finding]:
    """Csgs of which two leaves have surfaces that are nearly one; or of those the transparent ones."""
    shares = np.full(len(s.scene.objects), np.inf)
    gaps: dict[int, Gap] = {}
    for i, o in enumerate(s.scene.objects):
        if isinstance(o.shape, Csg) and (not glass or s.finish(i).kt > 0):
            gap = smallest_gap(o.shape, s.reach)
            if gap is not None:
                gaps[i], shares[i] = gap, gap.share
    for i, more in worst(shares, limit):
        text = f"surfaces of the leaves {gaps[i].first} and {gaps[i].second} of object {i}, a csg"
        if glass:
            text += ", which is transparent"
        text += f", are {shares[i]:.2g} of their coordinates apart (less than {limit:.2g}{more})"
        yield Finding(s.scene.objects[i].line, text)


def _closeness(p: Floats, q: Floats, r: float, t: float) -> float:
    distance = float(np.linalg.norm(p - q))
    gaps = [abs(abs(r - t) - distance), abs(r + t - distance)]
    return min((gap for gap in gaps if gap > 0), default=np.inf) / max(r, t)


REGIONS = (
    Region(("gap",), {"double": 3e-13, "float": 2e-6, "mesh": 2e-6}, _gaps),
    Region(("nearly-coplanar",), {"double": 1e-14, "float": 2e-7, **_EMBREE}, _near_coplanar),
    Region(
        ("nested-glass", "bubble", "overlapping-glass"), {"double": 3e-12, "float": 3e-5, "mesh": 3e-6}, _glass_balls
    ),
    Region(("bowls", "flush", "crescents"), {"double": 5e-14, "float": 5e-7}, _operands),
    Region(("glass-shells",), {"float": 1e-5, "mesh": 1e-3}, _glass_operands),
)
