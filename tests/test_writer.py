"""What is written reads back the same."""

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import scenes, with_effects

from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere, Texmap
from converter.scene.parser import parse_scene
from converter.scene.writer import write_scene

FOLDER = Path("somewhere")
TEXTURES = [FOLDER / "sky.ppm", FOLDER / "maps" / "céu.png", FOLDER / ".." / "up.exr", Path("/textures/wood.jpg")]

SCENE = Scene(
    camera=Camera((0, 30, -200), (0, 10, -100), (0, 1, 0), 40),
    ambient=(1, 1, 1),
    lights=(Light((60, 160, -200), (1, 0.5, 1), (1, 0, 1e-7)),),
    pigments=(Texmap(Path("sky.ppm"), (0, 0.001, 0, 0.12), (0, 0, 0, 0)), Solid((1 / 3, 1, 1))),
    finishes=(Finish(0.8, 0, 0, 1, 0, 0, 0),),
    objects=(Object(0, 0, Sphere((0, 0, 0), 600)), Object(1, 0, Polyhedron(((0, 1, 0, 60), (1, 0, 0, -300))))),
)


@settings(max_examples=60, deadline=None)
@given(scenes(TEXTURES, FOLDER / "scene.in").flatmap(with_effects))
def test_a_scene_survives_writing_and_reading(scene: Scene) -> None:
    again = parse_scene(write_scene(scene), scene.file)
    assert again == scene
    assert write_scene(again) == write_scene(scene)


@settings(max_examples=60, deadline=None)
@given(scenes(), st.integers(0, 6))
def test_a_lowered_count_leaves_out_the_last_objects(scene: Scene, count: int) -> None:
    text, count = write_scene(scene), min(count, len(scene.objects))
    head, _, objects = text.rpartition(f"\n\n{len(scene.objects)}\n")
    fewer = parse_scene(f"{head}\n\n{count}\n{objects}")
    assert fewer == replace(scene, objects=scene.objects[:count])
    assert len(fewer.warnings) == (count < len(scene.objects))


@settings(max_examples=50, deadline=None)
@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_finite_number_survives(x: float) -> None:
    scene = replace(SCENE, pigments=(Solid((x, -x, x)),), objects=())
    assert parse_scene(write_scene(scene)) == scene
    assert str(parse_scene(write_scene(scene)).pigments) == str(scene.pigments)  # the sign of zero too


@settings(max_examples=30, deadline=None)
@given(scenes(), st.data())
def test_numbers_of_effects_that_are_0_are_the_plain_scene(scene: Scene, data: st.DataObject) -> None:
    text = write_scene(scene).splitlines()
    at = 5
    for count, extra in ((1 + len(scene.lights), " 0"), (len(scene.pigments), ""), (len(scene.finishes), " -0")):
        assert text[at] == str(count)
        if extra:
            k = data.draw(st.sampled_from([*range(count), None]))
            lines = range(count) if k is None else [k]
            for i in lines:
                text[at + 1 + i] += extra
        at += 2 + count + (0 if extra else sum(isinstance(p, Texmap) for p in scene.pigments))
    text[3] += data.draw(st.sampled_from(["", " 0 0", " 0 7"]))
    text[-1] += " move 0 0 -0" if scene.objects else ""
    found = parse_scene("\n".join(text))
    assert replace(found, camera=replace(found.camera, focal=0.0)) == scene


def test_the_layout_of_optional_numbers() -> None:
    scene = replace(
        SCENE,
        camera=replace(SCENE.camera, aperture=2.5, focal=100),
        lights=(replace(SCENE.lights[0], radius=12),),
        finishes=(replace(SCENE.finishes[0], cone=5),),
        objects=tuple(replace(o, move=(1, 0, -0.5)) for o in SCENE.objects),
    )
    assert write_scene(scene) == (
        "0 30 -200\n0 10 -100\n0 1 0\n40 2.5 100\n\n"
        "2\n0 0 0 1 1 1 1 0 0\n60 160 -200 1 0.5 1 1 0 1e-07 12\n\n"
        "2\ntexmap sky.ppm\n0 0.001 0 0.12\n0 0 0 0\nsolid 0.3333333333333333 1 1\n\n"
        "1\n0.8 0 0 1 0 0 0 5\n\n"
        "2\n0 0 sphere 0 0 0 600 move 1 0 -0.5\n1 0 polyhedron 2\n0 1 0 60\n1 0 0 -300 move 1 0 -0.5\n"
    )


def test_the_layout_is_the_statements() -> None:
    assert write_scene(SCENE) == (
        "0 30 -200\n0 10 -100\n0 1 0\n40\n\n"
        "2\n0 0 0 1 1 1 1 0 0\n60 160 -200 1 0.5 1 1 0 1e-07\n\n"
        "2\ntexmap sky.ppm\n0 0.001 0 0.12\n0 0 0 0\nsolid 0.3333333333333333 1 1\n\n"
        "1\n0.8 0 0 1 0 0 0\n\n"
        "2\n0 0 sphere 0 0 0 600\n1 0 polyhedron 2\n0 1 0 60\n1 0 0 -300\n"
    )


@pytest.mark.parametrize(
    ("file", "texture", "name"),
    [
        ("a/s.in", "a/t.ppm", "t.ppm"),
        ("a/s.in", "a/../t.ppm", "../t.ppm"),
        ("a/s.in", "b/t.ppm", "../b/t.ppm"),
        ("/a/s.in", "/b/t.ppm", "/b/t.ppm"),
        ("s.in", "t.ppm", "t.ppm"),
        (None, "b/t.ppm", "b/t.ppm"),
    ],
)
def test_textures_are_named_from_the_scenes_folder(file: str | None, texture: str, name: str) -> None:
    pigment = Texmap(Path(texture), (0, 0, 0, 0), (0, 0, 0, 0))
    text = write_scene(replace(SCENE, pigments=(pigment,), objects=(), file=None if file is None else Path(file)))
    assert f"texmap {name}\n" in text


@pytest.mark.parametrize("name", ["my sky.ppm", "sky#1.ppm", "a\tb", "sky\u00a0blue.ppm"])
def test_a_texture_that_the_format_cannot_name_is_refused(name: str) -> None:
    pigment = Texmap(Path(name), (0, 0, 0, 0), (0, 0, 0, 0))
    with pytest.raises(ValueError, match="cannot name the texture"):
        write_scene(replace(SCENE, pigments=(pigment,), objects=()))


@pytest.mark.parametrize("x", [float("nan"), float("inf"), float("-inf")])
def test_a_number_that_the_format_cannot_hold_is_refused(x: float) -> None:
    with pytest.raises(ValueError, match="cannot hold the number"):
        write_scene(replace(SCENE, ambient=(x, 0, 0)))
