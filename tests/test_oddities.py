"""Notes on what is surely not meant: each where it belongs, and none in the gallery."""

from dataclasses import replace
from pathlib import Path

import pytest
from test_halfspaces import CUBE, OCTAHEDRON, PLATE, moved, prism

from converter.analysis.notices import ior_notices, scene_notices
from converter.analysis.oddities import oddity_notices
from converter.commands.readings import ior_notices_that_show
from converter.scene.model import Checker, Finish, Polyhedron, Solid
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import Settings
from converter.scene.writer import write_scene
from converter.studies.families.scenes import GLASS, MATTE, MIRROR, WHITE, camera, light, scene, sphere

GALLERY = sorted((Path(__file__).parents[1] / "scenes").glob("*.in"))
VIEW = camera((0.0, 0.0, 8.0), (0.0, 0.0, 0.0))
LAMP = light((3.0, 4.0, 5.0))
BALL = (sphere((0.0, 0.0, 0.0), 1.0), WHITE, MATTE)
SPLITTING = Finish(0.1, 0.2, 0.0, 1.0, 0.1, 0.9, 1.5)


def told(bodies=(BALL,), lamps=(LAMP,), view=VIEW):
    return oddity_notices(scene(view, bodies, lamps), Settings())


def turned(planes, k):
    return tuple(tuple(-x for x in plane) if i == k else plane for i, plane in enumerate(planes))


def body(planes, finish=MATTE):
    return (Polyhedron(tuple(planes)), WHITE, finish)


@pytest.mark.parametrize("file", GALLERY, ids=lambda file: file.stem)
def test_the_gallery_has_no_oddities(file):
    assert oddity_notices(load_scene(file), Settings()) == ()


def test_an_ordinary_scene_has_none():
    assert told() == ()


# ---- Shapes ----------------------------------------------------------------------------------------------------------

PYRAMID = [(1, 1, 0, -1), (-1, 1, 0, -1), (0, 1, 1, -1), (0, 1, -1, -1), (0, -1, 0, 0)]


@pytest.mark.parametrize("k", range(6))
@pytest.mark.parametrize("seed", [None, 1])
def test_a_turned_normal_of_a_box(k, seed):
    box = turned(CUBE if seed is None else moved(CUBE, seed), k)
    (notice,) = told([body(box)])
    assert f"object 0 goes on without end, and would not if the signs of its plane {k} were turned, to " in notice


@pytest.mark.parametrize("planes", [turned(PYRAMID, 4), turned([*prism(5), *CUBE[4:]], 5), turned(CUBE, 0)])
def test_turned_normals_of_other_shapes(planes):
    assert len(told([body(planes)])) == 1


@pytest.mark.parametrize(
    "planes",
    [
        CUBE,
        CUBE[:5],  # the statement's column
        CUBE[1:],
        CUBE[:4],
        CUBE[::2],
        prism(7),
        PYRAMID[:4],
        OCTAHEDRON[:4],
        [(0, 1, 0, 1)],
        PLATE,
        PLATE[:4],
        [(0, 1, 1, 1), (-1, -1, 1, 0), (1, 1, 1, 0), (-1, 1, 0, 0), (1, 0, 0, -3)],  # bounded by either of two turns
        turned(turned(CUBE, 0), 2),  # two slips
        moved(CUBE[:5], 3),
    ],
)
def test_bodies_that_may_be_meant(planes):
    assert not any("without end" in notice for notice in told([body(planes)]))


def test_the_file_tells_the_line_and_how_many():
    made = scene(VIEW, [BALL, body(turned(CUBE, 2)), body(turned(CUBE, 3)), body(turned(CUBE, 0))], [LAMP])
    read = parse_scene(write_scene(made), Path("a.in"))
    (notice,) = scene_notices(read, Settings())
    assert notice.startswith(f"a.in:{read.objects[1].line}: object 1 goes on")
    assert notice.endswith("plane 2 were turned, to 0 1 0 -1; so are 2 others")


def test_a_plate_is_told_with_its_planes():
    read = parse_scene(write_scene(scene(VIEW, [BALL, body(PLATE), body(PLATE)], [LAMP])), Path("a.in"))
    (notice,) = scene_notices(read, Settings())
    assert notice.startswith(f"a.in:{read.objects[1].line}: object 1 is a plate without thickness")
    assert notice.endswith("its planes 2 (0 1 0 0) and 3 (0 -1 0 0) touch; so is one other")


# ---- Colours ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pigment", "odd"),
    [
        (Solid((255.0, 128.0, 0.0)), "has the colour 255 128 0, where 1 is white"),
        (Checker((1.0, 1.0, 1.0), (0.0, 0.0, 200.0), 1.0), "has the colour 0 0 200, where 1 is white"),
        (Solid((0.5, -0.1, 0.0)), "has the colour 0.5 -0.1 0, which is below black"),
        (Solid((1.5, 1.0, 1.0)), ""),
        (Solid((2.0, 0.0, 0.0)), ""),
    ],
)
def test_colors_of_pigments(pigment, odd):
    made = replace(scene(VIEW, [BALL], [LAMP]), pigments=(pigment,), pigment_lines=(9,), file=Path("a.in"))
    found = oddity_notices(made, Settings())
    assert len(found) == bool(odd)
    assert all(notice.startswith(f"a.in:9: pigment 0 {odd}") for notice in found)


@pytest.mark.parametrize(
    ("color", "attenuation", "odd"),
    [
        ((255.0, 255.0, 200.0), (1.0, 0.0, 0.0), True),
        ((-0.2, 0.5, 0.5), (1.0, 0.0, 0.0), True),
        ((-0.2, 0.5, 0.5), (0.0, 0.0, 1.0), True),
        ((3.0, 3.0, 3.0), (1.0, 0.0, 0.0), False),
        ((255.0, 255.0, 255.0), (255.0, 0.0, 0.0), False),
        ((400.0, 400.0, 400.0), (0.0, 0.0, 1.0), False),
        ((1.0, 1.0, 1.0), (1e-9, 0.0, 0.0), False),
    ],
)
def test_colors_of_lights(color, attenuation, odd):
    found = told(lamps=[light((3.0, 4.0, 5.0), color, attenuation)])
    assert [notice.startswith("scene: light 1 has the colour ") for notice in found] == [True] * odd


def test_the_ambient_light_is_a_color_too():
    (notice,) = oddity_notices(replace(scene(VIEW, [BALL], [LAMP]), ambient=(51.0, 51.0, 51.0)), Settings())
    assert notice.startswith("scene: the ambient light has the colour 51 51 51")


@pytest.mark.parametrize(
    ("kr", "kt", "odd"),
    [
        (0.9, 0.0, ""),
        (1.0, 0.0, ""),
        (0.0, 1.0, ""),
        (0.1, 0.9, ""),
        (0.3, 0.9, ""),
        (1.2, 0.0, "1.2 times as bright"),
        (0.7, 0.9, "3.4 times as bright"),
        (1.0, 1.0, "brighter with every bounce"),
        (2.0, 1.0, "brighter with every bounce"),
    ],
)
def test_finishes_that_saturate(kr, kt, odd):
    found = told([(BALL[0], WHITE, Finish(0.1, 0.1, 0.0, 1.0, kr, kt, 1.5))])
    assert len(found) == bool(odd)
    assert all(odd in notice for notice in found)


def test_finishes_that_nothing_has_are_not_looked_at():
    made = scene(VIEW, [BALL], [LAMP])
    assert oddity_notices(replace(made, finishes=(*made.finishes, replace(MIRROR, kr=5.0))), Settings()) == ()


# ---- Lights and camera -----------------------------------------------------------------------------------------------


def test_a_light_that_is_too_weak():
    (notice,) = told(lamps=[LAMP, light((0.0, 400.0, 0.0), attenuation=(0.0, 0.0, 1.0))])
    assert notice.startswith("scene: light 2 is too weak to be seen")
    assert told(lamps=[light((0.0, 10.0, 0.0), attenuation=(0.0, 0.0, 1.0))]) == ()
    near = (sphere((0.0, 399.0, 0.0), 0.5), WHITE, MATTE)
    assert told([BALL, near], [light((0.0, 400.0, 0.0), attenuation=(0.0, 0.0, 1.0))]) == ()


def test_nothing_that_answers_to_light():
    black = replace(MATTE, ka=0.0, kd=0.0, ks=0.0)
    assert [notice.split(": ")[1] for notice in told([(BALL[0], WHITE, black)])] == [
        "object 0 is black, as all others are"
    ]
    assert told([(BALL[0], WHITE, MIRROR)]) == ()
    assert len(oddity_notices(replace(scene(VIEW, [BALL], []), ambient=(0.0, 0.0, 0.0)), Settings())) == 1


@pytest.mark.parametrize(
    ("look_at", "bodies", "where"),
    [
        ((0.0, 0.0, 0.0), [BALL], None),
        ((0.0, 0.0, 16.0), [BALL], "it is behind it"),
        ((0.0, 0.0, 16.0), [BALL, body(CUBE)], "all are behind it"),
        ((8.0, 0.0, 0.0), [BALL, body(CUBE)], "all are beside its picture"),
        ((8.0, 0.0, 0.0), [BALL, body([(0, 1, 0, 3)])], None),  # the ground, as far as the horizon
        ((0.0, 16.0, 8.0), [body([(0, 1, 0, 3)])], "it is behind it"),
        ((0.0, 0.0, 16.0), [BALL, (sphere((0.0, 0.0, 0.0), 100.0), WHITE, MATTE)], None),  # the sky
        ((0.0, 0.0, 16.0), [(sphere((1.8, 0.0, 10.0), 1.0), WHITE, MATTE)], None),
        ((4.0, 0.0, 0.0), [BALL], None),  # half of it
    ],
)
def test_a_camera_that_sees_nothing(look_at, bodies, where):
    view = camera((0.0, 0.1, 8.0), look_at, up=(0.0, 0.3, 1.0) if look_at[1] else (0.0, 1.0, 0.0))
    found = [notice for notice in told(bodies, view=view) if "camera" in notice]
    assert found == ([f"scene: the camera sees no object: {where}"] if where else [])


# ---- How ior is read -------------------------------------------------------------------------------------------------


def test_the_reading_of_ior_is_told_where_it_shows():
    glass = scene(VIEW, [(BALL[0], WHITE, GLASS), (sphere((1.0, 0.5, -5.0), 1.0), WHITE, MATTE)], [LAMP])
    assert len(ior_notices(glass, Settings())) == 1
    assert ior_notices_that_show(glass, Settings()) == ior_notices(glass, Settings())
    assert ior_notices_that_show(glass, Settings(max_depth=0)) == []
    assert ior_notices_that_show(glass, Settings(ior="index")) == []
    aside = replace(glass, camera=camera((0.0, 0.0, 8.0), (0.0, 0.0, 16.0)))
    assert ior_notices_that_show(aside, Settings()) == []
    alone = replace(glass, objects=glass.objects[:1], ambient=(0.0, 0.0, 0.0))
    assert ior_notices_that_show(alone, Settings()) == []
    assert len(ior_notices(alone, Settings())) == 1
