"""Eyes and lights that lie on surfaces: no ray decides by a rounding error on which side they are."""

from dataclasses import replace

import numpy as np
import pytest
from variant import VARIANT

from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.scene.model import Finish, Polyhedron
from converter.studies.families.closed_forms import directions
from converter.studies.families.scenes import (
    GLOW,
    MATTE,
    NORMAL,
    WHITE,
    box,
    camera,
    floor,
    light,
    on_slope,
    scene,
    settings,
    slope,
    sphere,
)
from native_tracer.incidence import surfaces_at

RED = (0.9, 0.2, 0.1)
SETTINGS = settings(24, 18, background=(0.2, 0.2, 0.2))
EXACT = ("native", "native-float", "native-long-double", "native-bvh", "mitsuba-analytic", "mitsuba-bvh")
EXACT += ("mitsuba-analytic-float", "mitsuba-mesh")


def drawn(made, method, chosen=SETTINGS):
    return np.asarray(METHODS[method].renderer(VARIANT).render(made, chosen).pixels)


# ---- What lies on what


def on_plane(point, plane):
    return surfaces_at(point, [plane], [False]) == [0]


def on_sphere(point, center, radius):
    return surfaces_at(point, [(*center, radius)], [True]) == [0]


@pytest.mark.parametrize("factor", [1.0, 1e-300, 0.1, -7.0, 1e300])
def test_points_of_decimal_numbers_lie_on_planes(factor):
    """2 x 2.9 + 3 x 2.4 + 6 x 6.0 = 49, of which only 6.0 and 49 are doubles."""
    assert on_plane((2.9, 2.4, 6.0), [factor * c for c in (2.0, 3.0, 6.0, -49.0)])
    assert not on_plane((2.9, 2.4, 6.0 + 4e-15), [factor * c for c in (2.0, 3.0, 6.0, -49.0)])
    assert not on_plane((2.9, 2.4, 6.0 - 4e-15), [factor * c for c in (2.0, 3.0, 6.0, -49.0)])


@pytest.mark.parametrize("size", [1e-200, 0.1, 1.0, 1e150])
def test_points_of_decimal_numbers_lie_on_spheres(size):
    center, point = (0.1, 0.1, 0.1), (2.1, 3.1, 6.1)
    scaled = [[size * c for c in v] for v in (point, center)]
    assert on_sphere(*scaled, 7.0 * size)
    assert not on_sphere(*scaled, 7.0 * size * (1 + 1e-15))
    assert not on_sphere(*scaled, 7.0 * size * (1 - 1e-15))


def test_the_bound_is_that_of_three_roundings():
    """A number that is off by its own rounding counts, and one that is off by twice as much does not."""
    assert on_plane((1.0, 0.0, 0.0), (1.0, 0.0, 0.0, -1.0 - 2.0**-52))
    assert not on_plane((1.0, 0.0, 0.0), (1.0, 0.0, 0.0, -1.0 - 2.0**-51))
    assert on_sphere((3.0, 0.0, 0.0), (1.0, 0.0, 0.0), 2.0 + 2.0**-51)
    assert not on_sphere((3.0, 0.0, 0.0), (1.0, 0.0, 0.0), 2.0 + 2.0**-50)


def test_nothing_lies_on_a_sphere_that_is_smaller_than_roundings():
    center = (0.0, 0.0, 1e20)
    assert not on_sphere(center, center, 1.0)
    assert not on_sphere((0.0, 0.0, 0.0), center, 1.0)
    assert on_sphere((0.0, 0.0, 0.0), center, 1e20)


def test_every_surface_is_found():
    rows = [(0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, -1.0), (5.0, 0.0, 0.0, 4.0)]
    assert surfaces_at((1.0, 0.0, 0.0), rows, [False, True, False, True]) == [0, 1, 2, 3]
    assert surfaces_at((1.0, 0.0, 0.5), rows, [False, True, False, True]) == [0, 2]
    assert surfaces_at((1.0, 0.0, 0.0), np.zeros((0, 4)), []) == []
    with pytest.raises(ValueError, match="a flag for every row"):
        surfaces_at((1.0, 0.0, 0.0), rows, [True])


# ---- The eye


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("step", range(4))
def test_an_eye_in_a_floor_sees_nothing_of_it(mi, method, step):
    eye = on_slope(7.0, step, 0.5 * step)
    view = camera(eye, tuple(e + a for e, a in zip(eye, (3.0, -2.0, 0.5), strict=True)), 60.0, NORMAL)
    made = scene(view, [(Polyhedron((slope(),)), RED, GLOW)])
    assert np.allclose(drawn(made, method), 0.2)


@pytest.mark.parametrize("method", EXACT)
def test_an_eye_on_an_edge_of_a_body_sees_its_far_sides_from_within(mi, method):
    """A wedge of two slanting planes whose edge goes through the eye, closed by a wall."""
    planes = ((0.6, 0.8, 0.0, -1.0), (-0.8, 0.6, 0.0, 0.2), (0.0, 0.0, -1.0, -5.0))
    eye = (0.76, 0.68, 0.0)
    assert all(on_plane(eye, plane) for plane in planes[:2])
    view = camera(eye, (0.7, 0.2, -1.0), 90.0)
    d = directions(view, SETTINGS)
    inside = (d @ np.array(planes[0][:3]) < 0) & (d @ np.array(planes[1][:3]) < 0) & (d[..., 2] < 0)
    assert 0.1 < inside.mean() < 0.9
    expected = np.where(inside[..., None], RED, 0.2)
    assert np.allclose(drawn(scene(view, [(Polyhedron(planes), RED, GLOW)]), method), expected)


@pytest.mark.parametrize("method", EXACT)
def test_a_ray_from_an_eye_on_a_glass_ball_is_bent_where_it_leaves_it_and_not_before(mi, method):
    """Straight through the middle: the ball adds its own light once."""
    glass = Finish(0.25, 0.0, 0.0, 1.0, 0.0, 1.0, 1.5)
    center = (0.1, 0.1, 0.1)
    view = camera((2.1, 3.1, 6.1), center, 1.0)
    made = scene(view, [(sphere(center, 7.0), WHITE, glass)])
    assert np.allclose(drawn(made, method, replace(SETTINGS, max_depth=4)), 0.45)


@pytest.mark.parametrize("method", EXACT)
def test_an_eye_in_the_plane_of_a_face_beside_it_sees_the_body(mi, method):
    """The face is seen from its edge, and the ones next to it as ever."""
    view = camera((2.1, 0.3, 6.1), (1.1, 0.0, 0.0), 40.0)
    picture = drawn(scene(view, [(box((0.1, -1.0, -1.0), (2.1, 1.0, 1.0)), RED, GLOW)]), method)
    beside = drawn(
        scene(replace(view, eye=(2.1 - 1e-9, 0.3, 6.1)), [(box((0.1, -1.0, -1.0), (2.1, 1.0, 1.0)), RED, GLOW)]),
        "native",
    )
    assert 0.1 < (picture == np.float32(RED)).all(axis=2).mean() < 0.9
    assert (picture == beside).all()


# ---- Lights

SHINY = Finish(0.2, 0.5, 0.25, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("method", EXACT)
def test_a_lamp_in_the_ceiling_of_a_room_lights_the_room(mi, method):
    """A room that is one body around the camera: the light shines along the ceiling, and down on all else."""
    low, high, eye = (-2.1, -1.3, -2.7), (2.3, 1.7, 2.9), (0.3, 0.2, 0.4)
    view = camera(eye, (1.0, 0.1, -1.0), 90.0)
    picture = drawn(scene(view, [(box(low, high), WHITE, SHINY)], [light((0.7, high[1], -0.9))]), method)
    dark = np.isclose(picture, 0.2).all(axis=2)
    d = directions(view, SETTINGS)
    t = (np.where(d > 0, high, low) - np.array(eye)) / d
    ceiling = (t.argmin(axis=-1) == 1) & (d[..., 1] > 0)
    assert 0.05 < ceiling.mean() < 0.95
    assert (dark == ceiling).all()
    assert (picture[~ceiling] > 0.2 + 0.25).all()


@pytest.mark.parametrize("method", EXACT)
@pytest.mark.parametrize("step", range(3))
def test_a_lamp_in_a_slope_does_not_light_it_however_near(mi, method, step):
    """Where the light is near, a height of a rounding error above the slope is a large angle."""
    place = on_slope(7.0, 11.0 + step, 0.7 * step)
    view = camera(tuple(p + 0.1 * n for p, n in zip(place, NORMAL, strict=True)), place, 1.0)
    picture = drawn(scene(view, [(Polyhedron((slope(),)), WHITE, SHINY)], [light(place)]), method)
    assert np.allclose(picture, 0.2)


@pytest.mark.parametrize("method", [m for m in EXACT if m != "mitsuba-mesh"])  # Embree misses what is hardly grazed
def test_a_lamp_on_the_far_side_of_a_body_is_hidden_by_it(mi, method):
    """What lies on a surface is not seen through the body."""
    bodies = [(floor(-1.0), WHITE, SHINY), (sphere((0.0, 2.0, 0.0), 1.0), WHITE, SHINY)]
    bodies.append((box((2.0, 0.5, -1.0), (4.0, 1.5, 1.0)), WHITE, SHINY))
    view = camera((1.0, 0.2, 6.0), (1.5, -1.0, 0.0), 20.0)
    picture = drawn(scene(view, bodies, [light((0.6, 2.8, 0.0)), light((3.2, 1.5, 0.1))]), method)
    # A hair above both bodies every shadow stays.
    hair = 1e-9
    above = [light((0.6 + 0.6 * hair, 2.8 + 0.8 * hair, 0.0)), light((3.2, 1.5 + hair, 0.1))]
    assert (np.abs(picture - drawn(scene(view, bodies, above), "native")) <= LIMIT).all()
    assert np.unique(picture.round(1)).size > 2  # there is light and shadow


@pytest.mark.parametrize("method", EXACT)
def test_lights_on_surfaces_and_others_do_not_mix(mi, method):
    """The second light lies on the second body; the first and the third lie on none."""
    bodies = [(floor(0.0), WHITE, MATTE), (sphere((0.1, 2.1, 0.1), 1.0), WHITE, MATTE)]
    places = [(5.0, 4.0, 3.0), (0.7, 2.9, 0.1), (-4.0, 3.0, 2.0)]
    view = camera((1.0, 5.0, 8.0), (0.0, 0.5, 0.0))
    together = drawn(scene(view, bodies, [light(place) for place in places]), method)
    apart = sum(drawn(scene(view, bodies, [light(place)]), method) for place in places)
    dark = drawn(scene(view, bodies), method)
    assert np.allclose(together - dark, apart - 3 * dark, atol=1e-6)
