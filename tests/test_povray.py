"""Scenes in POV-Ray's language: what the text says. Whether POV-Ray draws it well: see `test_povray_pictures`."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.commands import main
from converter.errors import ExportError
from converter.scene.model import Finish, Object, Polyhedron, Scene, Sphere, Texmap
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.scene.writer import write_scene
from converter.shapes.table import shape_kind
from converter.to_povray.export import export_povray
from converter.to_povray.finishes import finish, transmission
from converter.to_povray.interiors import Interior, Relation, interiors, relation
from converter.to_povray.lights import fades
from converter.to_povray.scale import scaled, suitable_scale
from converter.to_povray.scene import povray_scene

CUBE = ((1, 0, 0, -1), (-1, 0, 0, -1), (0, 1, 0, -1), (0, -1, 0, -1), (0, 0, 1, -1), (0, 0, -1, -1))


@pytest.fixture
def textured(small_scene: Scene, tmp_path: Path) -> Scene:
    file = tmp_path / "steps.ppm"
    file.write_bytes(b"P6 3 2 255\n" + bytes(range(0, 180, 10)))
    texmap = Texmap(file, (0.7, 0.1, 0.0, 0.2), (0.0, 0.9, 0.3, 0.0))
    return replace(small_scene, pigments=(texmap, *small_scene.pigments[1:]))


# ---- the scene


def test_numbers_keep_all_their_digits(small_scene: Scene) -> None:
    text = povray_scene(small_scene, Settings()).text
    needs = scene_needs(small_scene, Settings())
    factor = suitable_scale(small_scene, needs)
    assert f"sphere {{ <{-1.6 * factor!r}, {1.1 * factor!r}, {0.6 * factor!r}>, {1.1 * factor!r}" in text
    assert "ambient_light rgb <0.7, 0.8, 1>" in text and "background { rgb <0.7, 0.8, 1> }" in text
    assert f"max_trace_level {needs.max_depth + 1}\n  adc_bailout 0.001953125" in text


def test_only_what_is_seen(small_scene: Scene) -> None:
    one = replace(small_scene, objects=small_scene.objects[:1], finishes=(Finish(1, 0, 0, 1, 0, 0, 0),))
    text = povray_scene(one, Settings()).text
    assert "light_source" not in text and "max_trace_level 1\n" in text
    assert text.count("#declare") == 1 and "no_shadow" not in text


def test_omissions_name_their_place_and_stand_in_the_file(small_scene: Scene) -> None:
    finishes = (replace(small_scene.finishes[0], ks=0.5, alpha=0.0), *small_scene.finishes[1:])
    scene = replace(small_scene, finishes=finishes, finish_lines=(11, 12, 13, 14), light_lines=(4, 5))
    found = povray_scene(scene, Settings(max_depth=300, cutoff=1e-300))
    assert [text.split(":")[0] for text in found.omissions] == [
        "nothing is seen that is farther away than 3.91e+04",
        "rays are followed for 255 bounces, not 300",
        "light 2 (line 5)",
        "finish 0 (line 11)",
        "finish 3 (line 14)",
    ]
    assert all(f"//   {text}\n" in found.text for text in found.omissions)
    assert "max_trace_level 256" in found.text


def test_nothing_is_omitted_where_nothing_is_lost(small_scene: Scene) -> None:
    plain = replace(small_scene, lights=small_scene.lights[:1], objects=small_scene.objects[1:2])
    found = povray_scene(plain, Settings())
    assert found.omissions == () and "otherwise" not in found.text and found.textures == {}


def test_overlapping_glass_is_told(small_scene: Scene) -> None:
    balls = (Object(2, 3, Sphere((0, 0, 0), 1), 21), Object(2, 3, Sphere((1, 0, 0), 1), 22))
    found = povray_scene(replace(small_scene, objects=balls, lights=()), Settings(cutoff=0))
    assert len(found.omissions) == 1
    assert found.omissions[0].startswith("object 0 (line 21) and object 1 (line 22) are transparent and overlap")


def test_texture_files_say_all(textured: Scene, tmp_path: Path) -> None:
    """8 bits where they are enough, else 16, bottom row first; what no image file can hold is told."""
    found = povray_scene(textured, Settings(), "a")
    assert list(found.textures) == ["a_pigment_0.ppm"] and '"a_pigment_0.ppm" gamma 1.0' in found.text
    data = found.textures["a_pigment_0.ppm"]
    assert data.endswith(b"3 2\n255\n" + bytes([*range(90, 180, 10), *range(0, 90, 10)]))

    file = textured.pigments[0].file
    file.write_bytes(b"P6 1 1 255\n" + bytes([13, 10, 20]))
    assert povray_scene(textured, Settings()).textures["scene_pigment_0.ppm"].endswith(b"1 1\n255\r\r\n\x14")

    from converter.images.write import write_image

    fine = Texmap(tmp_path / "fine.exr", *textured.pigments[0].__getstate__()[1:])
    write_image(fine.file, np.array([[[0.1, 0.2, 0.3]], [[1.5, 0.5, 0.0]]], dtype=np.float32), 1, 2)
    found = povray_scene(replace(textured, pigments=(fine, *textured.pigments[1:]), pigment_lines=(7,)), Settings())
    assert found.textures["scene_pigment_0.ppm"].endswith(
        b"1 2\n65535\n" + np.array([65535, 32768, 0, 6554, 13107, 19661], ">u2").tobytes()
    )
    assert "pigment 0 (line 7): its texture's colours beyond 0..1 are clamped" in found.omissions


# ---- its parts


@pytest.mark.parametrize("law", [(2, 0, 0), (0.5, 0.25, 0), (0.5, 0, 0.01), (0.1, 0.8, 0.1), (0, 0.2, 0.1), (0, 0, 3)])
def test_fades_are_exact(law: tuple[float, float, float]) -> None:
    a, b, c = law
    found, error = fades(law, 100.0)
    d = np.geomspace(0.5, 1000, 50)
    total = sum(weight * (2 / (1 + (d / distance) ** power) if power else 1) for weight, power, distance in found)
    assert error == 0
    assert total == pytest.approx(1 / (a + b * d + c * d**2), rel=1e-6)


@pytest.mark.parametrize("law", [(1, 0.1, 0.2), (1, 2, 1), (2, 0.5, 3)])
def test_fades_come_near(law: tuple[float, float, float]) -> None:
    a, b, c = law
    found, error = fades(law, 100.0)
    d = np.linspace(0, 100, 5000)
    total = sum(weight * 2 / (1 + (d / distance) ** power) for weight, power, distance in found)
    largest = float(np.abs(total - 1 / (a + b * d + c * d**2)).max())
    assert 0 < largest <= 1.05 * error and error < 0.003 / a


@pytest.mark.parametrize(("kr", "kt"), [(0.1, 0.8), (0, 1), (0, 0.5), (0.3, 2)])
def test_transparent_finishes_lose_nothing(kr: float, kt: float) -> None:
    glass = Finish(0.2, 0.4, 0, 1, kr, kt, 1.5)
    transmitted, refraction = transmission(glass)
    assert transmitted * refraction == pytest.approx(kt, rel=1e-15)
    assert refraction == pytest.approx(kr + kt, rel=2e-5)
    numbers = dict(re.findall(r"(\w+) ([\d.e+-]+)", finish(glass, Settings())))
    assert float(numbers["ambient"]) * (1 - transmitted) == pytest.approx(0.2, rel=1e-10)
    assert float(numbers["diffuse"]) * (1 - transmitted) == pytest.approx(0.4, rel=1e-10)


def surface(scene: Scene, index: int) -> str:
    shape = scene.objects[index].shape
    return shape_kind(shape).povray(shape, scene_needs(scene, Settings()).facts[index])


def test_redundant_planes_are_left_out_and_bounds_given(small_scene: Scene) -> None:
    slab = replace(small_scene, objects=(Object(0, 0, Polyhedron(((0, 2, 0, -1), (0, 1, 0, -9)))),))
    assert surface(slab, 0) == "plane { <0, 1, 0>, 0.5 }"
    block = surface(small_scene, 3)
    assert block.count("plane {") == 6 and block.count("bounded_by") == 1


def cube(size: float, x: float = 0.0) -> Polyhedron:
    return Polyhedron(tuple((a, b, c, size * d - a * x) for a, b, c, d in CUBE))


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (Sphere((0, 0, 0), 1), Sphere((2, 0, 0), 1), Relation.APART),
        (Sphere((0, 0, 0), 1), Sphere((1.9, 0, 0), 1), Relation.OVERLAP),
        (Sphere((0, 0, 0), 1), Sphere((0.5, 0, 0), 1.5), Relation.FIRST_INSIDE),
        (Sphere((0, 0, 0), 1), cube(1), Relation.FIRST_INSIDE),
        (Sphere((0, 0, 0), 1.7), cube(1), Relation.OVERLAP),
        (Sphere((0, 0, 0), 1.74), cube(1), Relation.SECOND_INSIDE),
        (Sphere((2.5, 0, 0), 1.5), cube(1), Relation.APART),
        (cube(1), cube(0.9), Relation.SECOND_INSIDE),
        (cube(1), cube(1, 1.9), Relation.OVERLAP),
        (cube(1), cube(1, 2), Relation.APART),
        (cube(1), Polyhedron(((1, 1, 1, -2.9),)), Relation.OVERLAP),
        (cube(1), Polyhedron(((1, 1, 1, -3.1),)), Relation.FIRST_INSIDE),
        (cube(1), Polyhedron(((-1, -1, -1, 3.1),)), Relation.APART),
        (Polyhedron(((0, 1, 0, -2),)), Sphere((0, 0, 0), 1), Relation.SECOND_INSIDE),
    ],
)
def test_how_bodies_lie(small_scene: Scene, first: object, second: object, expected: Relation) -> None:
    mirrored = {Relation.FIRST_INSIDE: Relation.SECOND_INSIDE, Relation.SECOND_INSIDE: Relation.FIRST_INSIDE}
    for shapes, meant in (((first, second), expected), ((second, first), mirrored.get(expected, expected))):
        scene = replace(small_scene, objects=tuple(Object(2, 3, shape) for shape in shapes))
        assert relation(scene, scene_needs(scene, Settings()), 0, 1) is meant


def test_indices_of_bodies_without_bounds_multiply(small_scene: Scene) -> None:
    """A ball and what is below y = 9, the camera in both; glass above that, of which only the second is known."""
    ball, below = Sphere((0, 0, 0), 2), Polyhedron(((0, 1, 0, -9),))
    above = Polyhedron(((10, -1, 0, 0), (-1, 0, 0, 1), (0, 0, 1, -1), (0, 0, -1, -1)))
    scene = replace(
        small_scene,
        camera=replace(small_scene.camera, eye=(0.0, 0.0, 0.0)),
        finishes=(Finish(0, 0, 0, 1, 0, 1, 0.5),),
        objects=tuple(Object(2, 0, shape) for shape in (ball, above, below)),
    )
    found, overlaps = interiors(scene, scene_needs(scene, Settings()))
    assert found == {0: Interior(0.5, True), 1: Interior(0.5, False), 2: Interior(0.25, True)}
    assert overlaps == [(0, 1)]


def test_scaling_by_powers_of_two_gives_the_same_text(textured: Scene) -> None:
    text = povray_scene(textured, Settings()).text
    for factor in (2.0**-9, 2.0**20):
        other = povray_scene(scaled(textured, factor), Settings()).text
        lines = zip(text.splitlines(), other.splitlines(), strict=True)
        assert [a for a, b in lines if a != b and not a.startswith("//")] == []


# ---- files


def test_files_appear_beside_the_scene(textured: Scene, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    exported, files = export_povray(textured, Settings(), folder / 'my "scene".pov')
    assert sorted(files) == sorted(folder.iterdir())
    assert [file.name for file in files] == ['my "scene".pov', "my__scene__pigment_0.ppm"]
    assert files[0].read_text() == exported.text and '"my__scene__pigment_0.ppm"' in exported.text


def test_an_earlier_export_is_replaced(small_scene: Scene, textured: Scene, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    export_povray(textured, Settings(), folder / "a.pov")
    export_povray(textured, Settings(), folder / "a.pov")
    (folder / "a_pigment_9.ppm").write_bytes(b"P6 1 1 255\nabc")
    export_povray(small_scene, Settings(), folder / "a.pov")
    assert sorted(file.name for file in folder.iterdir()) == ["a.pov", "a_pigment_9.ppm"]


@pytest.mark.parametrize("name", ["a.pov", "a_pigment_0.ppm"])
def test_files_of_others_are_kept(textured: Scene, tmp_path: Path, name: str) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / name).write_text("years of work")
    with pytest.raises(ExportError, match=f"{name} is not of an exported scene: name another file"):
        export_povray(textured, Settings(), folder / "a.pov")
    assert [file.read_text() for file in folder.iterdir()] == ["years of work"]


def test_a_folder_is_no_file(small_scene: Scene, tmp_path: Path) -> None:
    (tmp_path / "a.pov").mkdir()
    with pytest.raises(ExportError, match="is a folder"):
        export_povray(small_scene, Settings(), tmp_path / "a.pov")


def test_convert(small_scene: Scene, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, out = tmp_path / "scene.in", tmp_path / "out.POV"
    scene.write_text(write_scene(small_scene))
    assert main.main(["convert", str(scene), str(out), "40", "30", "--samples", "4"]) == 0
    told = capsys.readouterr()
    assert told.out.splitlines()[0] == str(out) and "povray +Iout.POV +W80 +H60" in told.out
    light = [line for line in told.err.splitlines() if "light 2" in line]
    assert len(light) == 1 and light[0].startswith("note: POV-Ray: light 2 (line 9): 1 / (0.5 + 0.05 d + 0.003 d^2) is")
    assert light[0].removeprefix("note: POV-Ray: ") in out.read_text()

    assert main.main(["convert", str(scene), str(out), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    out.write_text("years of work")
    assert main.main(["convert", str(scene), str(out)]) == 2
    assert f"whitted convert: {out} is not of an exported scene" in capsys.readouterr().err
    assert main.main(["convert", str(scene), str(tmp_path / "nowhere" / "out.pov"), "-q"]) == 2
    assert "nowhere" in capsys.readouterr().err
