"""What the format means, and everything found in real files that is to be read without complaint."""

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import scenes

from converter.scene.errors import SceneError
from converter.scene.model import Camera, Checker, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere, Texmap
from converter.scene.parser import load_scene, parse_scene
from converter.scene.writer import write_scene

TEXT = """\
0 30 -200
0 10 -100
0 1 0
40
2
5 6 7 1 .9 1. 0 0 0
60.0 160.0 -200.0 1 1 1 1 0.5 +1e-3
3
texmap sky.ppm
0 .001 0 0.12
0 0 0 -1
checker .08 .25 .20 .93 .83 .82 40
solid 1 1 1
2
0.80 0.00 0.00 1 0.0 0 0
0.11 0.11 0.30 1000 0.7 0.1 1.5

3
0 0 sphere 0 0 0 600
2 1 sphere -5.98 32.7 0 20
1 0 polyhedron 2
0 1 0 60
0 0 -10 -300
"""
SCENE = Scene(
    camera=Camera((0, 30, -200), (0, 10, -100), (0, 1, 0), 40),
    ambient=(1, 0.9, 1),
    lights=(Light((60, 160, -200), (1, 1, 1), (1, 0.5, 0.001)),),
    pigments=(
        Texmap(Path("sky.ppm"), (0, 0.001, 0, 0.12), (0, 0, 0, -1)),
        Checker((0.08, 0.25, 0.2), (0.93, 0.83, 0.82), 40),
        Solid((1, 1, 1)),
    ),
    finishes=(Finish(0.8, 0, 0, 1, 0, 0, 0), Finish(0.11, 0.11, 0.3, 1000, 0.7, 0.1, 1.5)),
    objects=(
        Object(0, 0, Sphere((0, 0, 0), 600)),
        Object(2, 1, Sphere((-5.98, 32.7, 0), 20)),
        Object(1, 0, Polyhedron(((0, 1, 0, 60), (0, 0, -10, -300)))),
    ),
)


def test_every_number_comes_to_its_place() -> None:
    assert parse_scene(TEXT) == SCENE


def test_lines_are_kept_for_later_messages() -> None:
    scene = parse_scene(TEXT, Path("a/scene.in"))
    assert scene.file == Path("a/scene.in")
    assert scene.finish_lines == (15, 16)
    assert [o.line for o in scene.objects] == [19, 20, 21]
    assert scene.pigments[0] == Texmap(Path("a/sky.ppm"), (0, 0.001, 0, 0.12), (0, 0, 0, -1))


def test_the_model_holds_floats_and_tuples() -> None:
    scene = parse_scene(TEXT)
    assert all(type(x) is float for x in (*scene.camera.eye, scene.camera.fovy, scene.finishes[0].alpha))
    assert type(scene.objects) is tuple and type(scene.objects[0].pigment) is int


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(lambda t: t.replace("\n", "\r\n"), id="CRLF"),
        pytest.param(lambda t: t.replace("\n", "\r"), id="CR"),
        pytest.param(lambda t: t.replace(" ", "\t"), id="tabs"),
        pytest.param(lambda t: t.replace(" ", " \t  "), id="wide gaps"),
        pytest.param(lambda t: t.replace("\n", "\n  \t"), id="leading blanks"),
        pytest.param(lambda t: t.replace("\n", "  \t \n"), id="trailing blanks"),
        pytest.param(lambda t: t.replace("\n", "\n\n \n"), id="blank lines"),
        pytest.param(lambda t: t.rstrip("\n"), id="no newline at the end"),
        pytest.param(lambda t: t + "\n\n\n", id="blank lines at the end"),
        pytest.param(lambda t: "\ufeff" + t, id="byte-order mark"),
        pytest.param(lambda t: t + "\x1a", id="end of a DOS file"),
        pytest.param(lambda t: t.rstrip() + "\x1a\x1a\n", id="padded end of a DOS file"),
        pytest.param(lambda t: t.replace("texmap", "textmap"), id="textmap"),
        pytest.param(lambda t: " ".join(t.split()), id="all on one line"),
        pytest.param(lambda t: "\n".join(t.split()), id="one word a line"),
        pytest.param(lambda t: t.replace("sky.ppm\n", "sky.ppm "), id="texmap and P0 on a line"),
        pytest.param(lambda t: t.replace("0.12\n", "0.12 "), id="P0 and P1 on a line"),
        pytest.param(lambda t: t.replace("60.0 160.0 -200.0 ", "60.0 160.0 -200.0\n"), id="a light on two lines"),
        pytest.param(lambda t: t.replace("polyhedron 2\n", "polyhedron 2 "), id="first plane on the object's line"),
        pytest.param(lambda t: t.replace("40\n2\n", "40 2\n"), id="fovy and count on a line"),
        pytest.param(lambda t: t.replace("\n", " # why: 1 2 3 sphere\n"), id="comments"),
        pytest.param(lambda t: "# a scene\n" + t.replace("40\n", "40# degrees\n"), id="comment next to a number"),
        pytest.param(lambda t: t.replace("0 0 0 -1", "-0 +0 0e7 -1.0E+00"), id="other ways to write numbers"),
        pytest.param(lambda t: t.replace("\n3\n0 0 s", "\n+3\n00 0 s"), id="signed count, index with zeros"),
        pytest.param(lambda t: t.replace("600", "6" + "0" * 2), id="as it is"),
    ],
)
def test_layouts_that_mean_the_same(change: Callable[[str], str]) -> None:
    text = change(TEXT)
    assert parse_scene(text) == SCENE
    assert parse_scene(text.encode()) == SCENE


@pytest.mark.parametrize(
    ("old", "new"),
    [
        pytest.param("5 6 7 1 .9 1. 0 0 0", "5 6 7 1 .9 1. 0 0 0", id="ambient light with attenuation 0 0 0"),
        pytest.param("5 6 7 1 .9 1. 0 0 0", "5 6 7 1 .9 1. -1 -1 -1", id="ambient light with negative attenuation"),
        pytest.param("0.80 0.00 0.00 1 0.0 0 0", "0.80 0 0 1 0.0 0 -3", id="any ior where kt is 0"),
        pytest.param("0 0 -10 -300", "0 0 -1e-7 -300", id="short normal"),
        pytest.param("0 0 -10 -300", "0 3e8 -1e9 -300", id="long normal"),
        pytest.param("solid 1 1 1", "solid 1.5 -1 300", id="colours beyond 0..1"),
        pytest.param("1 1 1 1 0.5 +1e-3", "1 1 1 -1 0.5 0", id="attenuation positive far away"),
        pytest.param("1 1 1 1 0.5 +1e-3", "1 1 1 -1 3 -2", id="attenuation positive between two distances"),
        pytest.param("1 1 1 1 0.5 +1e-3", "1 1 1 0 0 1", id="attenuation only quadratic"),
        pytest.param("\n3\n0 0 s", "\n3 # how many\n0 0 s", id="comment after a count"),
        pytest.param("0 1 0\n40", "0 1e300 0\n40", id="a very long up vector"),
        pytest.param("0 10 -100", "0 30 -200.0000001", id="look-at very near the eye"),
        pytest.param("600", "1e-300", id="a tiny radius"),
    ],
)
def test_values_that_are_allowed(old: str, new: str) -> None:
    assert old in TEXT
    parse_scene(TEXT.replace(old, new))


@pytest.mark.parametrize("count", [0, 1, 2])
def test_objects_after_the_last_one_are_ignored(count: int) -> None:
    scene = parse_scene(TEXT.replace("\n3\n0 0 s", f"\n{count}\n0 0 s"), Path("a.in"))
    assert scene == replace(SCENE, pigments=scene.pigments, objects=SCENE.objects[:count])
    ignored = "the last one is" if count == 2 else f"the last {3 - count} are"
    assert scene.warnings == (f"a.in:18: the number of objects is given as {count}, but 3 follow; {ignored} ignored",)
    assert parse_scene(" ".join(TEXT.split()).replace(" 3 0 0 s", f" {count} 0 0 s")).objects == SCENE.objects[:count]


def test_planes_after_the_last_one_are_ignored() -> None:
    scene = parse_scene(TEXT.replace("polyhedron 2", "polyhedron 1"), Path("a.in"))
    assert scene.objects[2].shape == Polyhedron(((0, 1, 0, 60),))
    assert scene.warnings == ("a.in:21: 1 plane is announced, but 2 follow; the last one is ignored",)
    assert parse_scene(TEXT + "1 0 0 -300\n\n-1 0 0 -300").warnings == (
        "scene:21: 2 planes are announced, but 4 follow; the last 2 are ignored",
    )


@pytest.mark.parametrize("more", ["5 200", "1 0 0 -5\n5 200", "1 0 0\n-5", "1 0 0 -5\n0 0 sphere 0 0 0 1", "end"])
def test_what_is_no_whole_object_or_plane_is_not_ignored(more: str) -> None:
    with pytest.raises(SceneError):
        parse_scene(f"{TEXT}{more}\n")


def test_a_plane_is_a_polyhedron() -> None:
    scene = parse_scene(TEXT.replace("polyhedron 2\n0 1 0 60\n0 0 -10 -300", "plane 0 1 0 60"), Path("a.in"))
    assert scene.objects[2].shape == Polyhedron(((0, 1, 0, 60),))
    assert scene.notes == ("a.in:21: 'plane' is read as 'polyhedron 1'",)
    assert "1 0 polyhedron 1\n0 1 0 60\n" in write_scene(scene)
    assert parse_scene(write_scene(scene)).notes == ()
    two = TEXT.replace("sphere 0 0 0 600", "plane 0 1 0 2").replace("sphere -5.98 32.7 0 20", "plane 1 0 0 2")
    assert parse_scene(two).notes == ("scene:19: 'plane' is read as 'polyhedron 1', here and once more",)


@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_few_planes_that_close_no_volume(count: int) -> None:
    planes = ["0 1 0 60", "1 0 0 -300", "-1 0 0 -300", "0 0 -1 -300", "0 0 1 -300"][:count]
    head, _, _ = TEXT.rpartition("polyhedron")
    shape = parse_scene(head + f"polyhedron {count}\n" + "\n".join(planes)).objects[2].shape
    assert isinstance(shape, Polyhedron)
    assert len(shape.planes) == count


def test_sections_may_be_empty_but_for_the_lights() -> None:
    scene = parse_scene("0 0 0\n0 0 1\n0 1 0\n40\n1\n0 0 0 .1 .2 .3 0 0 0\n0\n0\n0\n")
    assert scene.ambient == (0.1, 0.2, 0.3)
    assert (scene.lights, scene.pigments, scene.finishes, scene.objects) == ((), (), (), ())


def test_a_number_at_the_end_of_a_line_may_still_be_a_count() -> None:
    """What is a scene without optional numbers stays that one, wherever its lines end."""
    head = "0 0 0\n0 0 1\n0 1 0\n40 1\n0 0 0 .1 .2 .3 0 0 0 0\n"
    assert parse_scene(f"{head}0 0\n") == parse_scene(" ".join(f"{head}0 0".split()))
    scene = parse_scene(f"{head[:-2]}1\nsolid 1 1 1 1\n1 0 0 1 0 0 0 1\n0 0 sphere 0 0 0 1\n")
    assert scene.finishes[0].cone == 0
    assert len(scene.objects) == 1


def test_a_csg_moves_as_a_whole() -> None:
    text = TEXT.replace("\n3\n0 0 s", "\n4\n0 0 csg 2\n+ 0 0 sphere 0 0 0 2\n- 0 0 sphere 1 0 0 2 move 3 4 5\n0 0 s")
    assert parse_scene(text).objects[0].move == (3, 4, 5)
    assert parse_scene(text.replace(" move", "\nmove")) == parse_scene(text)


def test_comments_may_be_in_another_encoding() -> None:
    text = ("# cena com esferas e chão\n" + TEXT).encode("latin-1")
    assert parse_scene(text) == SCENE


def test_a_texture_may_have_accents_in_either_encoding() -> None:
    text = TEXT.replace("sky.ppm", "céu.ppm")
    for data in (text.encode(), text.encode("latin-1"), text):
        pigment = parse_scene(data).pigments[0]
        assert isinstance(pigment, Texmap)
        assert pigment.file == Path("céu.ppm")


@settings(max_examples=25, deadline=None)
@given(scenes([Path("sky.ppm")]), st.randoms())
def test_any_white_space_will_do(scene: Scene, random: "st.random.Random") -> None:  # type: ignore[name-defined]
    words = write_scene(scene).split()
    text = "".join(word + random.choice([" ", "\n", "\t", "\r\n", "  ", "\n\n", "\f"]) for word in words)
    assert parse_scene(text) == scene


def test_loading_looks_for_textures_beside_the_scene(tmp_path: Path) -> None:
    (tmp_path / "sky.ppm").write_bytes(b"P6 1 1 255\n\x00\x00\x00")
    file = tmp_path / "scene.in"
    file.write_text(TEXT)
    pigment = load_scene(file).pigments[0]
    assert isinstance(pigment, Texmap)
    assert pigment.file == tmp_path / "sky.ppm"
    assert load_scene(str(file)) == load_scene(file)


def test_parsing_opens_no_file() -> None:
    assert parse_scene(TEXT, Path("nowhere") / "scene.in").pigments


def many_spheres(count: int) -> str:
    head, _, _ = TEXT.partition("\n3\n0 0 s")
    balls = "".join(f"2 1 sphere {i % 256}.125 {i // 256}.5 {-i}.0625 0.5\n" for i in range(count))
    return f"{head}\n{count}\n{balls}"


def test_many_spheres_are_read_in_no_time() -> None:
    text = many_spheres(66430)
    start = time.process_time()
    scene = parse_scene(text)
    assert len(scene.objects) == 66430
    assert time.process_time() - start < 3  # 0.4 s where nothing else runs


def test_a_count_is_believed_only_as_far_as_the_file_goes() -> None:
    start = time.process_time()
    with pytest.raises(SceneError, match="is given as 999999999999, but 3 follow"):
        parse_scene(TEXT.replace("\n3\n0 0 s", "\n999999999999\n0 0 s"))
    with pytest.raises(SceneError, match="99999999999999999999999999 planes are announced, but 2 follow"):
        parse_scene(TEXT.replace("polyhedron 2", "polyhedron 99999999999999999999999999"))
    assert time.process_time() - start < 1
