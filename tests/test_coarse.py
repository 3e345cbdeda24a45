"""Single-precision tests of balls: by which rays may pass, compared with exact arithmetic."""

from fractions import Fraction

import numpy as np
import pytest

BALLS, RAYS = 12, 16
NEAR = 1e-10
"""How near, relatively, to the surface of a ball most rays pass, or start."""


def fractions(numbers):
    return [Fraction(float(x)) for x in numbers]


def meets(ball, o, d):
    """Whether a ray, `d` of any length, meets a ball (four numbers), in exact arithmetic."""
    *center, radius = fractions(ball)
    o, d = fractions(o), fractions(d)
    f = [a - b for a, b in zip(center, o, strict=True)]
    along, length2 = sum(a * b for a, b in zip(f, d, strict=True)), sum(x * x for x in d)
    distance2 = sum(x * x for x in f)
    if distance2 <= radius * radius:
        return True
    return along > 0 and distance2 * length2 - along * along <= radius * radius * length2


def grazing(rng, ball, away):
    """A ray that passes a ball's surface by a little, on either side of that."""
    *center, radius = ball
    d, across = rng.normal(size=(2, 3))
    d /= np.linalg.norm(d)
    across -= (across @ d) * d
    across /= np.linalg.norm(across)
    nearest = center + across * radius * (1 + rng.choice([-1, -0.5, 0, 1]) * NEAR)
    return nearest - d * away * rng.uniform(0.5, 2), d


def coarse(mi, balls, o, d):
    """The balls in a kernel, and rays (n, 3) as their tests take them."""
    from mitsuba_plugins.intersection.coarse import Balls
    from mitsuba_plugins.intersection.rays import real, start_ray

    tested = Balls(real("double"), balls)
    columns = (np.ascontiguousarray(np.array(v).T) for v in (o, d))
    ray = start_ray(real("double"), *(kind(v) for kind, v in zip((mi.Point3d, mi.Vector3d), columns, strict=True)))
    return tested, tested.ray(ray)


def random_balls(rng, scale):
    return [(*(rng.uniform(-1, 1, 3) * scale).tolist(), rng.uniform(0.01, 0.5) * scale) for _ in range(BALLS)]


@pytest.mark.parametrize(("scale", "away"), [(1, 1), (1, 1e3), (1, 1e9), (1e-300, 1), (1e290, 1e3)])
def test_roundings_make_no_ray_miss_a_ball(mi, scale, away):
    rng = np.random.default_rng(5)
    balls = random_balls(rng, scale)
    o, d = zip(*(grazing(rng, ball, away * scale) for ball in balls for _ in range(RAYS)), strict=True)
    tested, ray = coarse(mi, balls, o, d)
    met = found = 0
    for k, ball in enumerate(balls):
        may_meet = np.array(tested.may_meet(k, ray))
        truth = np.array([meets(ball, *line) for line in zip(o, d, strict=True)])
        assert not (truth & ~may_meet).any()
        met, found = met + truth.sum(), found + may_meet.sum()
    assert met > BALLS * RAYS / 2
    if away < 1e9:
        assert found - met < BALLS * RAYS * 0.6  # those that pass by a little


@pytest.mark.parametrize("scale", [1, 1e-300, 1e290])
def test_what_starts_within_a_ball_is_away_from_its_surface(mi, scale):
    rng = np.random.default_rng(6)
    balls = random_balls(rng, scale)
    directions = rng.normal(size=(BALLS * RAYS, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    share = rng.choice([0.2, 0.9, 1 - 1e-7, 1 + 1e-7], BALLS * RAYS)
    o = [np.array(balls[k // RAYS][:3]) + directions[k] * balls[k // RAYS][3] * share[k] for k in range(BALLS * RAYS)]
    tested, ray = coarse(mi, balls, o, directions)
    for k in range(BALLS):
        own = slice(k * RAYS, (k + 1) * RAYS)
        assert np.array_equal(np.array(tested.starts_within(k, ray))[own], share[own] < 0.95)


def test_lights_within_a_ball(mi):
    from mitsuba_plugins.intersection.contacts import Contacts, LightContacts
    from mitsuba_plugins.intersection.rays import real

    positions, radii = np.array([[0.0, 0, 0.5], [0, 0.75, 0]]), np.array([0.0, 0.125])
    lights = LightContacts(real("double"), Contacts([]), positions, radii)
    assert lights.all_within((0, 0, 0, 1.0))
    assert not lights.all_within((0, 0, 0, 0.875))
    assert not lights.all_within((0, 0, 0.75, 1.0))
