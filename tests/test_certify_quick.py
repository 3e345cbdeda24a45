"""What spares the certifying tracer intervals, or digits: it leaves out nothing that matters, and pixels stay the same.

Rays are made to come as near to a decision as doubles can, and their truth is told with fractions. The tracer is given
such a ray itself, or only that it is within some width.
"""

import math
import random
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import certified_tracer
from certified_tracer._certified import meets_box, misses_ball, sift
from converter.certify.numbers import Number
from converter.certify.scene import certified_scene
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

SCENES = Path(__file__).parent.parent / "scenes"
WIDTHS = (0.0, 1e-14, 1e-9)
Point = list[float]


def _exactly(values: Sequence[float]) -> list[Number]:
    return [([x], 0.0) for x in values]


def _about(rng: random.Random, values: Sequence[float], width: float, toward: Sequence[float]) -> list[Number]:
    """Numbers that hold the true values, and have their middles as far off toward a side as they can."""
    if width == 0:
        return _exactly(values)
    shares = [math.copysign(rng.choice((0.5, 0.99)) * width, t) for t in toward]
    return [([x + share], width) for x, share in zip(values, shares, strict=True)]


def _random(rng: random.Random, size: float = 1.0) -> Point:
    return [rng.uniform(-size, size) for _ in range(3)]


def _fractions(values: Sequence[float]) -> list[Fraction]:
    return [Fraction(x) for x in values]


def _dot(a: Sequence[Fraction], b: Sequence[Fraction]) -> Fraction:
    return sum((x * y for x, y in zip(a, b, strict=True)), Fraction(0))


def _root(value: Fraction) -> float:
    """A double that is just not below the root."""
    root = math.sqrt(value)
    while Fraction(root) ** 2 < value:
        root = math.nextafter(root, math.inf)
    return root


# ---- Balls -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("far", [1.0, 300.0])
def test_a_ball_that_a_ray_touches_is_not_missed(width: float, far: float) -> None:
    rng = random.Random(f"{width} {far}")
    judged = 0
    for _ in range(300):
        center, origin, direction = _random(rng, far), _random(rng), _random(rng, far)
        arm = [o - c for o, c in zip(_fractions(origin), _fractions(center), strict=True)]
        d = _fractions(direction)
        if _dot(arm, d) > 0:
            direction, d = [-x for x in direction], [-x for x in d]
        closest = _dot(arm, arm) - _dot(arm, d) ** 2 / _dot(d, d)
        radius = _root(closest)
        beside = [float(a - x * _dot(arm, d) / _dot(d, d)) for a, x in zip(arm, d, strict=True)]
        given = [_exactly(center), _exactly(origin), _exactly(direction)]
        about = [
            _about(rng, center, width, [-x for x in beside]),
            *(_about(rng, x, width, beside) for x in (origin, direction)),
        ]
        for k in range(3):  # one of them is known but roughly
            center_, *ray = [about[i] if i == k else given[i] for i in range(3)]
            assert not misses_ball(center_, ([radius], 0.0), *ray, math.inf)
        asked = about[1:]
        if (smaller := radius - (1e-12 + 1e3 * width) * far) > 0 and math.hypot(*direction) > 0.3:
            judged += 1
            assert misses_ball(_exactly(center), ([smaller], 0.0), *asked, math.inf)
    assert judged > 200


@pytest.mark.parametrize("width", WIDTHS)
def test_a_ball_that_a_ray_leaves_is_not_behind_it(width: float) -> None:
    rng = random.Random(width)
    for _ in range(300):
        center, origin = _random(rng), _random(rng)
        arm = [o - c for o, c in zip(_fractions(origin), _fractions(center), strict=True)]
        radius, outward = _root(_dot(arm, arm)), [float(x) for x in arm]  # it starts within, or on it
        across = _random(rng, 0.5 * radius)
        direction = [a + rng.choice((1e-3, 1.0)) * x for a, x in zip(outward, across, strict=True)]
        asked = (_about(rng, origin, width, outward), _about(rng, direction, width, outward))
        assert not misses_ball(_exactly(center), ([radius], 0.0), *asked, math.inf)
        assert misses_ball(_exactly(center), ([radius * (1 - 1e-12) - 100 * width], 0.0), *asked, math.inf)


@pytest.mark.parametrize("width", WIDTHS)
def test_a_ball_is_met_where_its_surface_is_nearest(width: float) -> None:
    rng = random.Random(width)
    for _ in range(300):
        center, origin = _random(rng), _random(rng)
        direction = [o - c for o, c in zip(origin, center, strict=True)]
        arm = [o - c for o, c in zip(_fractions(origin), _fractions(center), strict=True)]
        d = _fractions(direction)
        within = rng.random() < 0.5
        share = Fraction(rng.uniform(0.01, 2) if within else -rng.uniform(0.01, 0.99))  # of the arm, further out
        place = [a + share * x for a, x in zip(arm, d, strict=True)]
        radius = _root(_dot(place, place))
        end = float(abs(share)) * (1 + 1e-13) + (1e-13 if within else 0) + 1e-15
        way = direction if within else [-x for x in direction]
        asked = (_about(rng, origin, width, [-x for x in way]), _exactly(way))
        assert not misses_ball(_exactly(center), ([radius], 0.0), *asked, end)
        assert misses_ball(_exactly(center), ([radius], 0.0), *asked, end * (1 - 1e-9) - 100 * width)


# ---- Planes ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("far", [1.0, 1000.0])
def test_planes_where_a_ray_enters_or_leaves_are_left(width: float, far: float) -> None:
    rng = random.Random(f"{width} {far}")
    judged = [0, 0]
    for _ in range(300):
        origin, direction = _random(rng, far), _random(rng)
        o, d = _fractions(origin), _fractions(direction)
        enters = rng.uniform(1, 3)
        leaves = enters + rng.choice((0.0, 0.0, rng.uniform(-0.3, 1)))
        planes = []
        for _ in range(rng.randrange(3, 12)):  # all through two places, or through one
            normal = _random(rng)
            if rng.random() < 0.3:  # the ray runs nearly along it
                share = float(_dot(_fractions(normal), d) / _dot(d, d)) * (1 - rng.choice((1e-3, 1e-7, 1e-12)))
                normal = [n - share * x for n, x in zip(normal, direction, strict=True)]
            n = _fractions(normal)
            height = _dot(n, o) + Fraction(enters if _dot(n, d) < 0 else leaves) * _dot(n, d)
            planes.append([*normal, -float(height)])
        exact = []
        for plane in planes:
            *n, offset = _fractions(plane)
            slope = _dot(n, d)
            exact.append((-(_dot(n, o) + offset) / slope, slope))
        entry = max((t for t, slope in exact if slope < 0), default=None)
        exit_ = min((t for t, slope in exact if slope > 0), default=None)
        start, way = rng.choice(((width, 0.0), (0.0, width)))
        asked = (_about(rng, origin, start, _random(rng)), _about(rng, direction, way, _random(rng)))
        end = rng.choice((math.inf, enters))
        left = sift([_exactly(plane) for plane in planes], *asked, True, end)
        missed = exit_ is not None and (exit_ < 0 or (entry is not None and exit_ < entry))
        judged[missed] += 1
        beyond = entry is not None and end < entry
        if not missed and not beyond:
            assert left is not None
        if left is not None and not missed:
            assert all(k in left for k, (t, slope) in enumerate(exact) if t == (entry if slope < 0 else exit_))
        leaving = sift([_exactly(plane) for plane in planes], *asked, False, math.inf)
        assert leaving is not None
        assert all(k in leaving for k, (t, slope) in enumerate(exact) if slope > 0 and t == exit_)
    assert min(judged) > 30


def test_planes_that_do_not_matter_are_not_left() -> None:
    cube = [[s * (k == axis) for k in range(3)] + [-1.0] for axis in range(3) for s in (1.0, -1.0)]
    planes = [_exactly(plane) for plane in cube]
    origin, direction = _exactly([-3.0, 0.1, 0.2]), _exactly([1.0, 0.01, -0.02])
    assert sift(planes, origin, direction, True, math.inf) == [0, 1]
    assert sift(planes, origin, direction, False, math.inf) == [0]
    assert sift(planes, origin, direction, True, 1.9) is None
    assert sift(planes, origin, _exactly([-1.0, 0.01, -0.02]), True, math.inf) is None
    assert sift(planes, _exactly([-3.0, 1.5, 0.0]), direction, True, math.inf) is None
    along = sift(planes, origin, _exactly([1.0, 0.0, 0.0]), True, math.inf)
    assert along == [0, 1, 2, 3, 4, 5]  # beside which it runs, is told with intervals


# ---- Boxes -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("width", WIDTHS)
def test_a_box_that_a_ray_grazes_is_not_missed(width: float) -> None:
    rng = random.Random(width)
    hits = 0
    for _ in range(400):
        origin, direction, time = _random(rng, 2), _random(rng), rng.uniform(0.5, 3)
        corner = [x + time * y for x, y in zip(origin, direction, strict=True)]
        size = [rng.uniform(0.1, 2) * rng.choice((1, -1)) for _ in range(3)]
        low, high = ([f(c, c + s) for c, s in zip(corner, size, strict=True)] for f in (min, max))
        enter, leave = Fraction(0), Fraction(10**9)
        for x, y, a, b in zip(*map(_fractions, (origin, direction, low, high)), strict=True):
            first, last = sorted(((a - x) / y, (b - x) / y))
            enter, leave = max(enter, first), min(leave, last)
        near = meets_box(low, high, _about(rng, origin, width, size), _about(rng, direction, width, size), math.inf)
        if enter <= leave:
            hits += 1
            assert near is not None and near <= enter
        end = float(enter) * (1 - 1e-9) - 1000 * width
        if width < 1e-9 and end > 0 and min(map(abs, direction)) > 0.01:
            assert meets_box(low, high, _exactly(origin), _exactly(direction), end) is None
    assert hits > 100


def test_an_axis_along_which_nothing_moves() -> None:
    low, high, away = [-1.0] * 3, [1.0] * 3, _exactly([1.0, 0.0, 0.0])
    assert meets_box(low, high, _exactly([-3.0, 0.0, 0.0]), away, math.inf) == 2
    assert meets_box(low, high, _exactly([-3.0, 1.5, 0.0]), away, math.inf) is None
    unsure: list[Number] = [([1.0], 0.0), ([0.0], 1e-300), ([0.0], 0.0)]
    assert meets_box(low, high, _exactly([-3.0, 1.5, 0.0]), unsure, math.inf) is not None


# ---- Pixels ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name",
    ["arcade", "brilliant", "dice", "figure1", "infinity", "nested", "prisms", "quadrics", "solids", "wine_glass"],
)
@pytest.mark.parametrize("rung", [0, 1])
def test_pixels_are_those_of_intervals_alone(name: str, rung: int) -> None:
    scene = load_scene(SCENES / f"{name}.in")
    wide, high = (14, 10) if rung == 0 else (7, 5)
    built = certified_scene(scene, Settings(width=wide, height=high, max_depth=8))
    rows, columns = np.mgrid[:high, :wide]
    pixels = np.stack([columns, rows], axis=-1).reshape(-1, 2).astype(np.int32)
    quick, readable = (certified_tracer.certify(built, pixels, rung, rung, 1, None, q) for q in (True, False))
    decided = readable["reason"] == 0
    assert (quick["reason"][decided] == 0).all()
    assert (quick["low"][decided] == readable["low"][decided]).all()
    assert (quick["high"][decided] == readable["high"][decided]).all()
    assert decided.mean() > 0.5
