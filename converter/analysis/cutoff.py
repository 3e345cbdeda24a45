"""How far off a picture can be because rays that weigh little are not followed: a bound that holds for every pixel.

A pixel is the sum over its tree of rays of weight times local colour, a ray's weight being the product of the kr and kt
on the way to it. With a cut-off e, a ray that weighs less than e is dropped, and with it all that would follow from it;
so the picture lacks, in each pixel,

    sum over dropped rays of  weight * what a ray can bring with the bounces that are left to it.

**What a ray can bring.** One that hits nothing brings the background. One that hits an object brings at most

    L = ka |ambient| C + sum over lights of |light| / min |a + b d + c d^2| * (kd C + ks)

since cosines and highlights are at most 1; C is the largest value of the object's pigment, and the smallest divisor is
taken over all distances d that a point of its surface can have from the light. These are at least | |l - c| - r | and
at most |l - c| + r for a ball, and for a polyhedron at least the distance from the nearest plane where the light is
inside, and from the plane that it is farthest outside of where it is not. If the divisor can vanish (a = 0, and a light
that touches a surface), there is no bound. With n bounces left, a ray brings at most

    B(0) = max(background, L),    B(n) = max(background, L + (kr + kt) B(n - 1)),

the maxima being over the objects, each with its own finish: a geometric sum, finite as the number of bounces is, also
where kr + kt >= 1. Beyond the critical angle the transmitted ray follows the mirror direction, still with weight kt.

**Which rays are dropped.** A tree's worst case is found from its leaves up: a ray of weight w at depth j that is
followed loses at most

    E(w, j) = max over finishes of  sum over k in {kr, kt} of  (w k B(D - j - 1) if w k < e, else E(w k, j + 1)),

D being what `--max-depth` says, else the most bounces that are ever followed. Where the limit for e, which may be
lower, ends a path before the cut-off does, what lies below is lost in the same way. Only weights that a product of
coefficients can have are looked at; where these are very many, near ones are taken together, as intervals, each of
which counts with its worse end.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from converter.analysis.attenuation import least_divisor
from converter.pigments.table import pigment_kind
from converter.scene.depth import MAX_DEPTH, depth_limit
from converter.scene.model import Color, Scene
from converter.scene.needs import SceneNeeds, scene_needs
from converter.scene.settings import Settings

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

MOST_WEIGHTS = 512
"""Intervals of weights that are told apart at one depth, ..."""
MOST_PRODUCTS = 1 << 22
"""... fewer where there are so many products of them and the coefficients at all depths: it takes a second or two."""
ROUNDING = 2.0**-20
"""Part of the brightest colour by which two pictures may differ because their pixels are rounded to single precision,
and by which a highlight may exceed 1."""


@dataclass(frozen=True, slots=True)
class CutoffBound:
    """How far apart a picture with the cut-off and one without, its `--cutoff 0`, can be.

    Attributes:
        cutoff: the weight below which rays are dropped.
        bound: largest difference in any channel of any pixel, 1 being white; infinite if there is none.
        dropped: largest sum of the weights of the rays dropped in one pixel.
        brightest: largest channel of the colour that one ray can bring, with all that follow from it.
        unbounded_by: why there is no bound; empty if there is one.

    """

    cutoff: float
    bound: float
    dropped: float
    brightest: float
    unbounded_by: str = ""


def cutoff_bound(scene: Scene, settings: Settings) -> CutoffBound:
    """The bound for `scene`, drawn with `settings`, derived above.

    It holds where weights are products in double precision, of kr and kt in double or in single precision: for Mitsuba
    and for the native tracer, but for its single precision, which may put a weight on the other side of the cut-off.

    Raises:
        ValueError: a texture cannot be read.

    """
    needs = scene_needs(scene, settings)
    used = [scene.finishes[i] for i in needs.finishes]
    weights = np.array([(f.kr, f.kt) for f in used], dtype=np.float64).reshape(-1, 2)
    everything = replace(settings, cutoff=0, max_depth=MAX_DEPTH if settings.max_depth is None else settings.max_depth)
    full_depth = depth_limit(used, everything).bounces
    with np.errstate(over="ignore", invalid="ignore"):  # numbers may be as large as they like
        dropped = _worst_loss(weights, settings.cutoff, needs.max_depth, np.ones(full_depth + 1))
        local, unbounded_by = _local_colors(scene, needs)
        brightest = _brightest(local, weights, np.abs(needs.background), full_depth)
        bound = _worst_loss(weights, settings.cutoff, needs.max_depth, brightest) + ROUNDING * float(brightest[-1])
    if dropped == 0:
        bound, unbounded_by = 0.0, ""
    elif not math.isfinite(bound):
        bound, unbounded_by = math.inf, unbounded_by or "colours may exceed all numbers"
    return CutoffBound(settings.cutoff, bound, dropped, float(brightest[-1]), unbounded_by)


# ---- What a ray can bring ------------------------------------------------------------------------------------------


def _brightest(local: Floats, weights: Floats, background: Floats, depth: int) -> Floats:
    """The largest channel of the colour that a ray can bring with 0, 1, ... `depth` bounces left: B in the derivation.

    Args:
        local: (n, 3) largest local colour of each finish.
        weights: (n, 2) its kr and kt.
        background: (3,) the background's colour.
        depth: D in the derivation.

    """
    result = []
    color = np.zeros(3)
    share = weights.sum(axis=1, keepdims=True)
    for _ in range(depth + 1):
        followed = np.multiply(share, color, out=np.zeros_like(local), where=share > 0)  # 0 of infinity is 0
        with_more = np.max([*(local + followed), background], axis=0)
        result.append(np.max(with_more))
        if np.array_equal(with_more, color):  # further bounces are too dark to add anything
            break
        color = with_more
    return np.pad(result, (0, depth + 1 - len(result)), mode="edge")


def _local_colors(scene: Scene, needs: SceneNeeds) -> tuple[Floats, str]:
    """The largest local colour of each finish that is used, (n, 3), and what keeps one from being finite."""
    pigments = {
        i: np.array(pigment_kind(p).largest(p), dtype=np.float64) for i in needs.pigments for p in (scene.pigments[i],)
    }
    rows = {finish: row for row, finish in enumerate(needs.finishes)}
    result = np.zeros((len(rows), 3))
    received: dict[tuple[int, int], Color] = {}  # the most that an object of some finish and pigment receives
    unbounded_by = ""
    for i, o in enumerate(scene.objects):
        finish = scene.finishes[o.finish]
        red = green = blue = 0.0
        for k, light in enumerate(scene.lights if finish.kd > 0 or finish.ks > 0 else (), start=1):
            divisor = least_divisor(light, o, needs, i)
            if divisor == 0:  # a black light is no better: 0 / 0 is no colour
                line = f" (line {o.line})" if o.line else ""
                unbounded_by = unbounded_by or f"light {k}'s attenuation may be 0 on object {i}{line}"
                red = green = blue = math.inf
                break
            r, g, b = light.color
            red, green, blue = red + abs(r) / divisor, green + abs(g) / divisor, blue + abs(b) / divisor
        most = received.get((o.finish, o.pigment), (0.0, 0.0, 0.0))
        received[o.finish, o.pigment] = (max(most[0], red), max(most[1], green), max(most[2], blue))
    for (finish_index, pigment), most in received.items():
        finish, color = scene.finishes[finish_index], pigments[pigment]
        local = finish.ka * np.abs(scene.ambient) * color
        answer = finish.kd * color + finish.ks
        local += np.multiply(answer, most, out=np.zeros(3), where=answer > 0)
        result[rows[finish_index]] = np.maximum(result[rows[finish_index]], local)
    return result, unbounded_by


# ---- Which rays are dropped ----------------------------------------------------------------------------------------


class _Level(NamedTuple):
    """The rays that may follow at one depth from rays that are followed there.

    Attributes:
        low, high: (n, m) bounds of their weights, for n intervals of the weight before and m coefficients.
        successor: (n, m) index of the interval that holds them at the next depth; -1 where none of them is followed.

    """

    low: Floats
    high: Floats
    successor: Indices


def _worst_loss(weights: Floats, cutoff: float, depth: int, brings: Floats) -> float:
    """The largest sum of weight times what it brings over the rays that one pixel can lack: E(1, 0) in the derivation.

    Args:
        weights: (n, 2) kr and kt of each finish.
        cutoff: rays that weigh less are dropped.
        depth: bounces that are followed.
        brings: (D + 1,) what a ray brings with 0, 1, ... D bounces left, D >= `depth`.

    """
    full_depth = len(brings) - 1
    coefficients, pairs = np.unique(weights, return_inverse=True)
    pairs = pairs.reshape(-1, 2)
    levels = list(_levels(coefficients, cutoff, min(depth + 1, full_depth)))
    losses = np.zeros(MOST_WEIGHTS)  # after D bounces nothing is left to be lost
    for before, level in reversed(list(enumerate(levels))):
        left = brings[full_depth - before - 1]
        followed = level.successor >= 0
        if before == depth:  # the limit drops whatever the cut-off does not
            lost = level.high * left
        else:
            kept = np.where(followed, losses[level.successor], 0)
            lost = np.maximum(kept, np.where(level.low < cutoff, np.minimum(level.high, cutoff) * left, 0))
        losses = (lost[:, pairs[:, 0]] + lost[:, pairs[:, 1]]).max(axis=1)
    return float(losses[0]) if levels else 0.0


def _levels(coefficients: Floats, cutoff: float, depth: int) -> Iterator[_Level]:
    """What may follow from rays at depth 0, 1, ... as long as any are followed."""
    single = coefficients.astype(np.float32).astype(np.float64)
    least, most = np.minimum(coefficients, single), np.maximum(coefficients, single)
    low = high = np.ones(1)
    step = 2.0**-40  # equal but for rounding: the same coefficients in another order
    count = min(MOST_WEIGHTS, max(MOST_PRODUCTS // (len(coefficients) * depth), 8)) if depth else 0
    for _ in range(depth):
        if not len(low):
            return
        lows, highs = np.outer(low, least), np.outer(high, most)
        followed = (highs >= cutoff) & (highs > 0)
        successor = np.full(followed.shape, -1)
        low, high, successor[followed], step = _merged(np.maximum(lows[followed], cutoff), highs[followed], step, count)
        yield _Level(lows, highs, successor)


def _merged(low: Floats, high: Floats, step: float, most: int) -> tuple[Floats, Floats, Indices, float]:
    """At most so many intervals that hold the given ones, and for each of these the index of the one that it is in.

    They hold what lies between two multiples of `step` in log2 of `low`; a larger one is taken, and returned, if that
    leaves too many.
    """
    logarithms = np.log2(low, out=np.full(low.shape, -1100.0), where=low > 0)
    while True:
        _, index = np.unique(np.floor(logarithms / step), return_inverse=True)
        count = int(index.max(initial=-1)) + 1
        if count <= most:
            break
        step *= 2
    lows, highs = np.full(count, np.inf), np.zeros(count)
    np.minimum.at(lows, index, low)
    np.maximum.at(highs, index, high)
    return lows, highs, index, step
