"""The student's tracer: right without a mistake, and another with each."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import student_tracer
from converter.compare.metrics import compare_pixels
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Light, Polyhedron, Scene, Sphere
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import Settings
from converter.why.first_light import first_light
from converter.why.student import LEVELS, UnknownToStudent, deviations, make_student, to_levels

GALLERY = sorted((Path(__file__).parent.parent / "scenes").glob("*.in"))


def of_the_statement(file):
    """Whether a scene holds nothing but the statement's own shapes."""
    return all(isinstance(o.shape, Sphere | Polyhedron) for o in load_scene(file).objects)


SCENES = [*filter(of_the_statement, GALLERY)]
SETTINGS = Settings(width=200, height=150)
NOTHING = frozenset()


def places(width, height):
    ys, xs = np.divmod(np.arange(width * height), width)
    return np.stack((xs, ys), axis=1).astype(np.int32)


@pytest.fixture
def odd_scene(small_scene):
    """What the gallery has not: a background in sight, a leaning camera, long normals, lamps that brighten."""
    floor, *others = small_scene.objects
    return replace(
        small_scene,
        camera=Camera((0.0, 3.0, -9.0), (0.0, 0.9, 0.0), (0.4, 1.0, 0.0), 60.0),
        lights=(Light((0.9, 2.5, -0.9), (2.5, 0.8, 0.7), (0.2, 0.0, 0.01)), *small_scene.lights),
        objects=(replace(floor, shape=Polyhedron(((0.0, 2.0, 0.0, 0.02),))), *others),
    )


# ---- Without a mistake -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("file", sorted({*GALLERY} - {*SCENES}), ids=lambda file: file.stem)
def test_other_shapes_are_unknown_to_it(file):
    with pytest.raises(UnknownToStudent, match=r"csg|quadric"):
        make_student(load_scene(file), SETTINGS)


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_it_agrees_with_the_reference(file):
    scene = load_scene(file)
    reference = np.asarray(NativeRenderer().render(scene, SETTINGS).pixels)
    drawn = make_student(scene, SETTINGS).colors(places(200, 150), [NOTHING])[0].reshape(150, 200, 3)
    difference = compare_pixels(reference, drawn)
    assert difference.disagreeing == 0, difference.largest
    assert np.array_equal(to_levels(reference.reshape(-1, 3)), to_levels(drawn.reshape(-1, 3)))


@pytest.mark.parametrize(
    "changes", [{"pixel": "center"}, {"specular": "blinn"}, {"ior": "ratio"}, {"background": (0.1, 0.9, 0.3)}], ids=str
)
def test_it_obeys_the_settings(odd_scene, changes):
    settings = replace(SETTINGS, **changes)
    reference = np.asarray(NativeRenderer().render(odd_scene, settings).pixels)
    drawn = make_student(odd_scene, settings).colors(places(200, 150), [NOTHING])[0].reshape(150, 200, 3)
    assert compare_pixels(reference, drawn).disagreeing == 0


def test_a_pixel_is_the_sum_of_its_rays(odd_scene):
    student = make_student(odd_scene, SETTINGS)

    def total(ray):
        brought = sum((child.throughput / ray.throughput * total(child) for child in ray.children), np.zeros(3))
        return np.array(ray.local) + brought

    for x, y in ((60, 80), (110, 90), (150, 100), (5, 5)):
        color = student.colors(np.array([[x, y]], np.int32), [NOTHING])[0, 0]
        traced = student.trace_pixel(x, y, NOTHING)
        assert traced.color == pytest.approx(color, abs=1e-6)
        assert total(traced.rays[0]) == pytest.approx(color, abs=1e-6)


@pytest.mark.parametrize("name", ["underwater", "whitted"])
def test_it_tells_of_rays_what_the_reference_does(name):
    """Of total reflection in the first, and in the second of rays that are dropped."""
    scene, settings = load_scene(SCENES[0].with_name(f"{name}.in")), replace(SETTINGS, max_depth=1)
    student = make_student(scene, settings)

    def family(ray):
        hit = ray.hit
        told = None if hit is None else (hit.object, hit.plane, hit.total_reflection)
        yield ray.kind, told, tuple(sorted(ray.dropped.items()))
        for child in ray.children:
            yield from family(child)

    pixels = [(x, y) for x in range(5, 200, 40) for y in range(5, 150, 24)]
    found = set()
    for record, (x, y) in zip(NativeRenderer().trace_pixels(scene, settings, pixels), pixels, strict=True):
        traced = student.trace_pixel(x, y, NOTHING)
        assert [*family(traced.rays[0])] == [*family(record.rays[0])]
        assert student.trace_pixel(x, y, {"single_precision"}).color == pytest.approx(traced.color, abs=1e-3)
        found |= {(told is not None and told[2], dropped) for _, told, dropped in family(traced.rays[0])}
    dropped = {"underwater": (), "whitted": (("reflected", "depth"), ("transmitted", "depth"))}[name]
    assert (name == "underwater", dropped) in found


def test_threads_change_nothing(odd_scene):
    one = make_student(odd_scene, replace(SETTINGS, threads=1)).colors(places(200, 150), [NOTHING, {"blinn"}])
    four = make_student(odd_scene, replace(SETTINGS, threads=4)).colors(places(200, 150), [NOTHING, {"blinn"}])
    assert np.array_equal(one, four)


# ---- Each mistake ----------------------------------------------------------------------------------------------------


def test_the_table():
    table = deviations()
    assert len(table) >= 60
    assert len({d.sentence for d in table.values()}) == len(table)
    for d in table.values():
        assert d.sentence
        assert d.hint
        assert not d.sentence.endswith(".")
        assert d.group


def test_each_changes_a_picture(odd_scene):
    """Of the gallery, or of a scene with what the gallery has not; and only those do that a scene can show."""
    left = set(deviations())
    settings = Settings(width=96, height=72)
    for scene in (odd_scene, *map(load_scene, SCENES)):
        student = make_student(scene, settings)
        right = student.drawn(places(96, 72), NOTHING)
        able = {d.name for d in student.candidates()}
        left -= {name for name in left & able if (student.drawn(places(96, 72), frozenset((name,))) != right).any()}
    assert not left


@pytest.mark.parametrize("scene", ["highlights", "poster", "underwater"])
def test_those_that_do_not_apply_change_nothing(scene):
    student = make_student(load_scene(SCENES[0].with_name(f"{scene}.in")), Settings(width=60, height=45))
    right = student.drawn(places(60, 45), NOTHING)
    able = {d.name for d in student.candidates()}
    for name in set(deviations()) - able:
        assert np.array_equal(student.drawn(places(60, 45), frozenset((name,))), right), name


def test_levels():
    colors = np.array([[0.5, 1.2, -0.3], [0.999, 0.25, 0.7]], np.float32)
    assert to_levels(colors).tolist() == [[128, 255, 0], [255, 64, 179]]
    assert to_levels(colors, {"truncated"}).tolist() == [[127, 255, 0], [254, 63, 178]]
    assert to_levels(colors, {"wrapped"}).tolist() == [[128, 306 % 256, -76 % 256], [255, 64, 179]]
    assert to_levels(colors, {"bgr"}).tolist() == [[0, 255, 128], [179, 64, 255]]
    assert to_levels(colors, {"gamma_2"}).tolist()[1] == [255, 128, 213]
    assert all(deviations()[name].part == LEVELS for name in ("truncated", "wrapped", "bgr", "gamma_2"))


def test_pictures_turned():
    """What lies where: the whole pictures are those that NumPy turns."""
    student = make_student(load_scene(SCENES[0]), Settings(width=40, height=30))
    tall = make_student(load_scene(SCENES[0]), Settings(width=30, height=40))
    right = student.drawn(places(40, 30), NOTHING).reshape(30, 40, 3)
    turned = {
        "mirrored": right[:, ::-1],
        "upside_down": right[::-1],
        "column_major": right.transpose(1, 0, 2).reshape(30, 40, 3),
    }
    for name, expected in turned.items():
        assert np.array_equal(student.drawn(places(40, 30), frozenset((name,))).reshape(30, 40, 3), expected), name
    assert np.array_equal(
        tall.drawn(places(30, 40), frozenset(("transposed",))), right.transpose(1, 0, 2).reshape(-1, 3)
    )
    assert np.array_equal(tall.drawn(places(30, 40), frozenset(("header_swapped",))), right.reshape(-1, 3))


# ---- What it is given ------------------------------------------------------------------------------------------------


def test_the_first_light(tmp_path):
    file = tmp_path / "a.in"
    text = "0 0 -10 0 0 0 0 1 0 40 # eye\n1\n1 2 3 .5 .5 .5 4 5 6\n1 solid 1 1 1 1 1 0 0 1 0 0 0 0\n"
    file.write_text(f"\ufeff{text}", encoding="utf-8")
    assert first_light(file) == ((1, 2, 3), (4, 5, 6))
    assert parse_scene(text, file).ambient == (0.5, 0.5, 0.5)
    assert first_light(tmp_path / "none.in") is None


def test_what_it_does_not_know_is_refused(odd_scene):
    class Torus:
        pass

    with pytest.raises(UnknownToStudent, match="one ray a pixel"):
        make_student(odd_scene, replace(SETTINGS, samples=4))
    objects = (replace(odd_scene.objects[0], shape=Torus(), line=7), *odd_scene.objects[1:])
    with pytest.raises(UnknownToStudent, match=r"object 0 \(line 7\) is a torus"):
        make_student(replace(odd_scene, objects=objects), SETTINGS)


def test_additions_are_refused(odd_scene, monkeypatch):
    """A number that the format gains is one that the tracer does not know."""
    from converter.why import student

    monkeypatch.setitem(student._KNOWN, Light, {"position", "color"})
    with pytest.raises(UnknownToStudent, match="scenes with attenuation, which light 2 has"):
        make_student(odd_scene, SETTINGS)


def test_nonsense_is_refused(odd_scene):
    student = make_student(odd_scene, SETTINGS)
    with pytest.raises(IndexError):
        student_tracer.levels(np.zeros((1, 3), np.float32), [len(deviations())])
    with pytest.raises(IndexError, match="outside the picture"):
        student.trace_pixel(200, 0, NOTHING)
    with pytest.raises(ValueError, match="a width and a height"):
        student_tracer.trace(student._scene, 0, 10, np.zeros((1, 2), np.int32), [[]])
    with pytest.raises(ValueError, match="a texture needs texels"):
        student._scene.add_texmap(np.zeros((0, 3, 3), np.float32), (0, 0, 0, 0), (0, 0, 0, 0))
    empty = Scene(odd_scene.camera, (1, 1, 1), (), (), (), ())
    assert make_student(empty, SETTINGS).drawn(places(3, 3), NOTHING).min() == 255
