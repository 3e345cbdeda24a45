"""The tracer without rounding: what it draws where nothing ties, and how it decides where something does."""

from dataclasses import replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tie_scenes import (
    BLUE,
    CLEAR,
    CUBE,
    GREEN,
    MIRROR,
    RED,
    SETTINGS,
    TIE_SCENES,
    checker,
    mirrored_room,
    texmap,
    traced,
    view,
    wall,
)

from converter.renderers.native import NativeRenderer
from converter.scene.model import Csg, Operand, Polyhedron
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.studies.exact.arithmetic import Decimals, Fractions, Undecided
from converter.studies.exact.ties import TIES
from converter.studies.exact.tracer import ExactTracer, exact_picture
from converter.studies.families.scenes import GLOW, MATTE, WHITE, box, floor, light, scene, sphere

SCENES = Path(__file__).resolve().parent.parent / "scenes"
ONE = Settings(2, 2, pixel="corner", background=(0.0, 0.0, 0.0), cutoff=0.0, max_depth=4)
"""The ray of pixel 1, 1 goes through the middle of the picture."""


def middle(made, settings=ONE):
    return ExactTracer(made, settings).pixel(1, 1)


# ---- Numbers


def test_numbers_are_the_file_s():
    assert Fractions().number(0.3) == Fraction(3, 10)
    assert Decimals().number(1e-3) == Decimal("0.001")
    assert Fractions().number(-1.5e300) == Fraction(-15 * 10**299)


def test_signs_of_decimals_are_certain_or_refused():
    numbers = Decimals()
    with numbers.context():
        third = Decimal(1) / 3
        assert numbers.sign(1 - 3 * third) == 0
        assert numbers.sign(numbers.root(Decimal(2)) ** 2 - 2) == 0
        assert [numbers.sign(Decimal(x)) for x in ("1e-30", "-1e-70", "0")] == [1, -1, 0]
        with pytest.raises(Undecided):
            numbers.sign(Decimal("1e-90"))


def test_tangents():
    numbers = Decimals()
    with numbers.context():
        assert numbers.sign(numbers.tangent(Decimal(90)) - 1) == 0
        assert numbers.sign(3 * numbers.tangent(Decimal(60)) ** 2 - 1) == 0
        assert numbers.sign(numbers.tangent(Decimal(30)) + numbers.root(Decimal(3)) - 2) == 0
        assert numbers.sign(numbers.tangent(Decimal(150)) - numbers.root(Decimal(3)) - 2) == 0
    assert Fractions().tangent(Fraction(90)) == 1
    with pytest.raises(Undecided):
        Fractions().tangent(Fraction(60))


def test_roots_of_fractions_are_exact_or_refused():
    assert Fractions().root(Fraction(49, 4)) == Fraction(7, 2)
    with pytest.raises(Undecided):
        Fractions().root(Fraction(2))


# ---- Pictures


@pytest.mark.parametrize("name", ["tiles", "room", "prisms", "bubble", "solids", "highlights", "poster"])
def test_pictures_of_scenes_without_ties_are_those_of_long_double(name):
    made, settings = load_scene(SCENES / f"{name}.in"), Settings(14, 10, pixel="center", cutoff=1 / 16)
    picture = np.asarray(NativeRenderer("long double").render(made, settings).pixels)
    assert np.abs(exact_picture(made, settings) - picture).max() < 1e-6


@pytest.mark.parametrize(
    "changes", [{"specular": "blinn"}, {"ior": "ratio"}, {"max_depth": 1}, {"cutoff": 0.3}], ids=str
)
def test_settings_are_obeyed(small_scene, changes):
    settings = replace(Settings(16, 12, pixel="center", cutoff=1 / 16), **changes)
    picture = np.asarray(NativeRenderer("long double").render(small_scene, settings).pixels)
    assert np.abs(exact_picture(small_scene, settings) - picture).max() < 1e-5


@pytest.mark.parametrize("name", TIE_SCENES)
def test_fractions_and_decimals_decide_alike(name):
    """As far as fractions go: not off balls."""
    _, make, settings = TIE_SCENES[name]
    tracer = ExactTracer(make(), settings, Fractions())
    compared = 0
    for x in range(0, settings.width, 2):
        for y in range(0, settings.height, 3):
            try:
                fractions = tracer.pixel(x, y)
            except Undecided:
                continue
            decimals = traced(name)[y][x]
            compared += 1
            assert fractions.ties == decimals.ties
            assert fractions.color == pytest.approx(decimals.color, abs=1e-12)
            assert (fractions.hit is None) == (decimals.hit is None)
            if fractions.hit is not None:
                assert (fractions.hit.object, fractions.hit.plane) == (decimals.hit.object, decimals.hit.plane)
    assert compared > 20


@pytest.mark.parametrize("name", TIE_SCENES)
def test_small_scenes_meet_their_ties(name):
    """Those of the kind that they are about, in pixels that show one colour beside another."""
    kind = TIE_SCENES[name][0]
    pixels = [pixel for row in traced(name) for pixel in row]
    assert sum(kind in pixel.ties for pixel in pixels) >= 4
    assert len({pixel.color for pixel in pixels}) > 1 or name == "in a slanting wall"
    assert {tie for pixel in pixels for tie in pixel.ties} <= set(TIES)


# ---- Rules


@pytest.mark.parametrize("apart", [False, True], ids=["one leaf", "a leaf for each plane"])
def test_a_box_keeps_rays_at_its_edges_as_a_csg_too(apart):
    planes = [Polyhedron((plane,)) for plane in CUBE.planes] if apart else [CUBE]
    body = Csg((Operand("+", planes[0]), *(Operand("&", plane) for plane in planes[1:])))
    settings = Settings(8, 6, pixel="corner", max_depth=4)
    truth = exact_picture(mirrored_room(CUBE), settings)
    assert np.array_equal(exact_picture(mirrored_room(body), settings), truth)


@pytest.mark.parametrize(
    ("z", "first"), [(-0.5, False), (-0.3, False), (0.0, True), (0.5, False), (0.7, False), (1.0, True)]
)
def test_a_tile_begins_at_its_whole_number(z, first):
    """The floor at 0 belongs to the tiles above it, and x = 0 to those beyond."""
    made = scene(view((0.0, 1.0, z), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)), [(floor(0.0), checker(0.5), GLOW)])
    pixel = middle(made)
    assert pixel.ties == {"tile"}
    assert (pixel.color == WHITE) == first


@pytest.mark.parametrize(("x", "column"), [(0.25, 1), (0.2, 0), (-0.2, 0), (-0.25, 3), (-0.3, 3), (-0.5, 2), (1.0, 0)])
def test_a_texel_is_truncated_toward_zero(x, column):
    pigment = texmap((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.1))
    made = scene(view((x, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)), [(floor(0.0), pigment, GLOW)])
    assert round(middle(made).color[0] * 255) == 40 * column + 60


def test_a_touched_edge_is_hit_where_it_is_entered():
    """Plane 0 is left there, and plane 1 is entered."""
    planes = replace(wall((1.0, 0.0, 0.0), 0.0), planes=((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0)))
    made = scene(view((-1.0, 0.0, 1.0), (1.0, 0.0, -1.0)), [(planes, RED, GLOW)])
    pixel = ExactTracer(made, replace(ONE)).pixel(1, 1)
    assert pixel.ties == {"touched edge"}
    assert pixel.hit is not None and (pixel.hit.plane, pixel.hit.inside) == (1, False)


def test_a_ray_in_a_plane_is_inside():
    top = box((-1.0, -1.0, -1.0), (1.0, 0.0, 1.0))
    assert middle(scene(view((0.0, 0.0, 3.0)), [(top, RED, GLOW)])).color == RED
    assert middle(scene(view((0.0, 0.1, 3.0)), [(top, RED, GLOW)])).color == ONE.background


@pytest.mark.parametrize("order", [1, -1])
def test_of_bodies_at_one_distance_the_first_is_seen(order):
    bodies = [(floor(-1.0), RED, GLOW), (wall((0.0, 0.0, 1.0), 1.0), GREEN, GLOW)][::order]
    pixel = middle(scene(view((0.0, 0.0, 0.0), (0.0, -1.0, -1.0)), bodies))
    assert "bodies" in pixel.ties
    assert pixel.color == (RED if order == 1 else GREEN)


def test_a_light_in_a_plane_does_not_light_it():
    made = scene(view((0.0, 1.0, 0.0), (0.0, -1.0, -1.0)), [(floor(0.0), WHITE, MATTE)], [light((3.0, 0.0, 0.0))])
    assert middle(made).color == (0.2, 0.2, 0.2)


@pytest.mark.parametrize(("height", "lit"), [(1.0, True), (1.1, False)])
def test_a_body_at_the_light_is_not_in_its_way(height, lit):
    """The roof begins at 1, where the first light is; the second is inside of it."""
    bodies = [(floor(0.0), WHITE, MATTE), (wall((0.0, -1.0, 0.0), 1.0), WHITE, MATTE)]
    made = scene(view((0.0, 0.5, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0)), bodies, [light((0.0, height, 0.0))])
    assert middle(made).color[0] == pytest.approx(0.9 if lit else 0.2)


@pytest.mark.parametrize(("x", "lit"), [(1.0, True), (-1.0, False)])
def test_a_body_at_the_start_is_in_the_way_only_if_it_is_left_later(x, lit):
    """The box on the floor begins at x = 0, which the ray meets; the floor is the first of the file."""
    bodies = [(floor(0.0), WHITE, MATTE), (box((-2.0, 0.0, -2.0), (0.0, 1.0, 2.0)), RED, MATTE)]
    made = scene(view((1.0, 1.0, 0.0), (-1.0, -1.0, 0.0)), bodies, [light((3.0 * x, 3.0, 0.0))])
    pixel = middle(made)
    assert {"bodies", "at start"} <= pixel.ties
    assert (pixel.color[0] > 0.3) == lit


def test_a_ray_that_touches_a_ball_passes_by():
    bodies = [(sphere((0.0, 1.0, 0.0), 1.0), RED, GLOW), (wall((0.0, 0.0, 1.0), 5.0), BLUE, GLOW)]
    pixel = middle(scene(view((0.0, 0.0, 3.0)), bodies))
    assert pixel.ties == {"tangent"}
    assert pixel.color == BLUE


def test_at_the_critical_angle_a_ray_runs_along_the_surface():
    """In glass, upward with the slope 4/3; the wall stands on the glass, and another below."""
    glass = replace(CLEAR, ka=0.0, kt=1.0, ior=0.6)
    bodies = [(floor(0.0), WHITE, glass), (box((5.0, 0.0, -9.0), (6.0, 9.0, 9.0)), GREEN, GLOW)]
    bodies.append((box((5.0, -9.0, -9.0), (6.0, -1.0, 9.0)), RED, GLOW))
    made = scene(view((0.0, -0.4, 0.0), (3.0, 4.0, 0.0)), bodies)
    pixel = middle(made)
    assert {"critical", "in"} <= pixel.ties
    assert pixel.color == GREEN


def test_a_corner_of_mirrors_is_met_twice():
    """A room of mirrors: the ray into an edge comes back on its way, and does not leave through the edge."""
    room = box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0))
    pixel = middle(scene(view((0.0, 0.0, 0.0), (1.0, 0.0, -1.0)), [(room, WHITE, replace(MIRROR, ka=0.25, kr=0.5))]))
    assert "seen edge" in pixel.ties
    assert pixel.color[0] == pytest.approx(0.25 * (1 + 0.5 + 0.25 + 0.125 + 0.0625))


def test_settings_of_small_scenes_say_all():
    assert SETTINGS.cutoff == 0.0 and SETTINGS.max_depth == 4
