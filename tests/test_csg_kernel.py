"""Boolean expressions in Mitsuba's kernels: what is the same set of points is the same picture, byte for byte."""

import numpy as np
import pytest
from variant import VARIANT

from converter.renderers.mitsuba import MitsubaRenderer
from converter.scene.parser import parse_scene
from converter.scene.settings import Settings
from converter.shapes import sphere

SCENE = """\
1 2.3 -6.1   .1 .2 0   0 1 0   38
2   0 0 0 .6 .7 .8 1 0 0   4 6 -5 .8 .8 .7 1 0 0
2   checker .9 .8 .7  .1 .2 .6  .35   solid .8 .8 .9
3   .3 .6 .3 20 0 0 0   .2 .5 0 1 .4 0 0   .1 .1 .3 60 .2 .7 1.4
3
0 {finish} sphere 0 0 0 1.75
0 1 polyhedron 1 0 1 0 1.5
1 1 sphere 2.2 .4 1.9 .6
"""
"""In the place of its first ball tests have a csg. Finish 0 is matt, finish 2 glass."""
AROUND = [[-3, -3, -3], [3, 3, 3]]
UNION, DIFFERENCE, INTERSECTION = -1, -2, -3


def half_space(*plane):
    return {"planes": {"0": list(plane)}, "box": None}


def box(low, high):
    (a, b, c), (d, e, f) = low, high
    planes = [[1, 0, 0, -d], [-1, 0, 0, a], [0, 1, 0, -e], [0, -1, 0, b], [0, 0, 1, -f], [0, 0, -1, c]]
    return {"planes": {str(k): plane for k, plane in enumerate(planes)}, "box": [low, high]}


def csg(leaves, *program):
    return {"csg": {"leaves": leaves, "program": list(program)}, "box": AROUND}


BALL, BITE = {"sphere": [0, 0, 0, 1.2]}, {"sphere": [0.8, 0.3, -0.9, 0.9]}
BOX = box([-0.9, -1, -0.8], [0.7, 1.1, 0.9])
HOLE = {"quadric": [1, 1, -0.6, 0, 0, 0, 0, 0, 0, -0.3], "box": None}
NO_HOLE = {"quadric": [-x for x in HOLE["quadric"]], "box": None}
FACES = [half_space(*plane) for plane in BOX["planes"].values()]
FLUSH = box([-2, 0.3, -0.8], [-0.9, 1.1, 0.9])
"""It has four planes in common with the box, and lies beside it."""

STEP, WALL = box([-1, -1, -1], [1, -0.2, 0]), box([-1, -1, 0], [1, 1, 1])
"""The wall's front is seen above the step, whose back lies in the same plane."""

SAME = {
    "one": (BALL, csg([BALL], 0)),
    "a + a": (BALL, csg([BALL, BALL], 0, 1, UNION)),
    "a & a": (BOX, csg([BOX, BOX], 0, 1, INTERSECTION)),
    "half-spaces": (BOX, csg(FACES, 0, *(code for k in range(1, 6) for code in (k, INTERSECTION)))),
    "(a + b) - b": (csg([BOX, BITE], 0, 1, DIFFERENCE), csg([BOX, BITE, BITE], 0, 1, UNION, 2, DIFFERENCE)),
    "De Morgan": (
        csg([BALL, BITE, BOX], 0, 1, 2, UNION, DIFFERENCE),
        csg([BALL, BITE, BOX], 0, 1, DIFFERENCE, 2, DIFFERENCE),
    ),
    "complement": (csg([BALL, HOLE], 0, 1, DIFFERENCE), csg([BALL, NO_HOLE], 0, 1, INTERSECTION)),
    "reordered": (
        csg([BALL, BITE, BOX], 0, 1, UNION, 2, DIFFERENCE),
        csg([BOX, BALL, BITE], 2, 1, UNION, 0, DIFFERENCE),
    ),
    "back to front": (csg([WALL, STEP], 0, 1, UNION), csg([STEP, WALL], 0, 1, UNION)),
    "a - b beside it": (BOX, csg([BOX, FLUSH], 0, 1, DIFFERENCE)),
    "a - a": (csg([BALL, BALL], 0, 1, DIFFERENCE), csg([BALL, BOX, BOX], 0, 1, INTERSECTION, 2, DIFFERENCE)),
}


def draw(monkeypatch, body, glass: bool, intersections: str = "analytic"):
    """The scene with a body in the place of its first ball."""
    with monkeypatch.context() as patch:
        ball = sphere.geometry
        patch.setattr(
            sphere, "geometry", lambda shape, facts: body if shape.radius == 1.75 else ball(shape, facts), raising=True
        )
        scene = parse_scene(SCENE.format(finish=2 if glass else 0))
        settings = Settings(width=120, height=90, max_depth=6)
        return MitsubaRenderer(VARIANT, intersections).render(scene, settings).pixels


@pytest.mark.parametrize("glass", [False, True], ids=["matt", "glass"])
@pytest.mark.parametrize("name", SAME)
def test_the_same_set_is_the_same_picture(monkeypatch, name, glass):
    one, other = (draw(monkeypatch, body, glass) for body in SAME[name])
    assert np.array_equal(one, other)


@pytest.mark.parametrize("name", ["(a + b) - b", "complement"])
def test_csg_through_the_tree_of_boxes(monkeypatch, name):
    one, other = (draw(monkeypatch, SAME[name][1], True, way) for way in ("analytic", "bvh"))
    assert np.array_equal(one, other)


@pytest.mark.parametrize("name", ["De Morgan", "half-spaces", "a - b beside it", "complement", "back to front"])
def test_crossings_in_order_are_those_against_every_leaf(monkeypatch, name):
    from mitsuba_plugins.intersection import geometry

    unrolled = draw(monkeypatch, SAME[name][1], True)
    monkeypatch.setattr(geometry, "MOST_UNROLLED", 0)
    assert np.array_equal(draw(monkeypatch, SAME[name][1], True), unrolled)


def test_a_hole_is_seen_through(monkeypatch):
    """A ball with a hyperboloid taken away shows what is behind it in its middle, and its inner side around that."""
    drilled = draw(monkeypatch, csg([BALL, HOLE], 0, 1, DIFFERENCE), False)
    whole, nothing = (
        draw(monkeypatch, csg(leaves, 0, 1, DIFFERENCE), False) for leaves in ([BALL, BITE], [BALL, BALL])
    )
    differs = (drilled != nothing).any(axis=2)
    assert differs.any()
    ball_seen = (whole != nothing).any(axis=2)
    assert (ball_seen & ~differs).any()


def test_coincident_planes_have_one_sheet():
    from mitsuba_plugins.intersection.geometry import parse_geometry

    text = '{"o": {"material": "m", "csg": {"leaves": [%s], "program": [0, 1, -1]}, "box": null}}'
    (surface,) = parse_geometry(
        text % '{"planes": {"0": [0, 2, 0, -1]}, "box": null}, {"planes": {"4": [0, -4, 0, 2]}, "box": null}'
    ).surfaces
    assert [leaf.sheets for leaf in surface.solid.leaves] == [(0,), (0,)]
    assert [leaf.turned for leaf in surface.solid.leaves] == [(False,), (True,)]
