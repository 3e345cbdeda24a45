"""Mistakes that the native tracer can make as well, when it is given another scene or other settings."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.compare.metrics import compare_pixels
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Light, Polyhedron, Sphere
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.student import deviations, make_student

SETTINGS = Settings(width=120, height=90)
FOLDER = Path(__file__).parent.parent / "scenes"


def finishes(**changes):
    """Finishes with numbers replaced; by a function of the finish where one is given."""
    return lambda scene: replace(
        scene,
        finishes=tuple(
            replace(f, **{name: new(f) if callable(new) else new for name, new in changes.items()})
            for f in scene.finishes
        ),
    )


def lights(change):
    return lambda scene: replace(scene, lights=tuple(change(scene.lights)))


def each_light(**changes):
    return lights(
        lambda row: [replace(x, **{k: new(x) if callable(new) else new for k, new in changes.items()}) for x in row]
    )


def camera(change):
    return lambda scene: replace(scene, camera=replace(scene.camera, **change(scene.camera)))


def planes(change):
    def changed(o):
        return replace(o, shape=Polyhedron(tuple(change(o.shape.planes)))) if isinstance(o.shape, Polyhedron) else o

    return lambda scene: replace(scene, objects=tuple(map(changed, scene.objects)))


def spheres(change):
    def changed(o):
        return replace(o, shape=Sphere(o.shape.center, change(o.shape.radius))) if isinstance(o.shape, Sphere) else o

    return lambda scene: replace(scene, objects=tuple(map(changed, scene.objects)))


def pigments(kind, **changes):
    def changed(p):
        return replace(p, **{k: new(p) for k, new in changes.items()}) if type(p).__name__ == kind else p

    return lambda scene: replace(scene, pigments=tuple(map(changed, scene.pigments)))


def without(shape):
    return lambda scene: replace(scene, objects=tuple(o for o in scene.objects if not isinstance(o.shape, shape)))


def settings(**changes):
    return changes


AS_ANOTHER = {
    "pixel_center": settings(pixel="center"),
    "blinn": settings(specular="blinn"),
    "ior_is_ratio": settings(ior="ratio"),
    "ior_is_index": settings(ior="index"),
    "background_black": settings(background=(0.0, 0.0, 0.0)),
    "background_white": settings(background=(1.0, 1.0, 1.0)),
    "background_grey": settings(background=(0.5, 0.5, 0.5)),
    "background_lamp": settings(background=(2.5, 0.8, 0.7)),
    **{f"depth_{depth}": settings(max_depth=depth, cutoff=0.0) for depth in range(7)},
    "cutoff_lower": settings(cutoff=1 / 512 / 16),
    "ambient_missing": finishes(ka=0.0),
    "ambient_without_ka": finishes(ka=1.0),
    "ambient_times_kd": finishes(ka=lambda f: f.ka * f.kd),
    "ambient_per_lamp": finishes(ka=lambda f: 3 * f.ka),
    "ambient_from_lamp": lambda scene: replace(scene, ambient=scene.lights[0].color),
    "ambient_is_lamp": lights(lambda row: [Light((3.0, 5.0, -2.0), (0.7, 0.8, 1.0), (1.0, 0.1, 0.0)), *row]),
    "diffuse_missing": finishes(kd=0.0),
    "highlight_missing": finishes(ks=0.0),
    "highlight_without_alpha": finishes(alpha=1.0),
    "lamp_color_ignored": each_light(color=(1.0, 1.0, 1.0)),
    "first_lamp_only": lights(lambda row: row[:1]),
    "last_lamp_missing": lights(lambda row: row[:-1]),
    "attenuation_missing": each_light(attenuation=(1.0, 0.0, 0.0)),
    "attenuation_quadratic_only": each_light(attenuation=lambda x: (0.0, 0.0, x.attenuation[2])),
    "attenuation_without_linear": each_light(attenuation=lambda x: (x.attenuation[0], 0.0, x.attenuation[2])),
    "attenuation_inverse_square": each_light(attenuation=(0.0, 0.0, 1.0)),
    "attenuation_reversed": each_light(attenuation=lambda x: x.attenuation[::-1]),
    "kr_ignored": finishes(kr=0.0),
    "kt_ignored": finishes(kt=0.0),
    "ior_ignored": finishes(ior=1.0),
    "up_is_point": camera(lambda c: {"up": tuple(np.subtract(c.up, c.eye).tolist())}),
    "up_ignored": camera(lambda c: {"up": (0.0, 1.0, 0.0)}),
    "look_at_is_direction": camera(lambda c: {"look_at": tuple(np.add(c.eye, c.look_at).tolist())}),
    "fovy_whole": camera(lambda c: {"fovy": 2 * c.fovy}),
    "fovy_quarter": camera(lambda c: {"fovy": c.fovy / 2}),
    "window_half": camera(lambda c: {"fovy": 2 * np.degrees(np.arctan(np.tan(np.radians(c.fovy / 2)) / 2))}),
    "fovy_sin": camera(lambda c: {"fovy": 2 * np.degrees(np.arctan(np.sin(np.radians(c.fovy / 2))))}),
    "fovy_arc": camera(lambda c: {"fovy": 2 * np.degrees(np.arctan(np.radians(c.fovy / 2)))}),
    "fovy_horizontal": camera(lambda c: {"fovy": 2 * np.degrees(np.arctan(np.tan(np.radians(c.fovy / 2)) * 0.75))}),
    "view_not_unit": camera(
        lambda c: {"fovy": 2 * np.degrees(np.arctan(np.tan(np.radians(c.fovy / 2)) / np.hypot(9.0, 2.1)))}
    ),
    "halfspaces_turned": planes(lambda row: [tuple(-x for x in plane) for plane in row]),
    "plane_offset_negated": planes(lambda row: [(*plane[:3], -plane[3]) for plane in row]),
    "last_face_missing": planes(lambda row: row[:-1] if len(row) > 1 else row),
    "first_face_missing": planes(lambda row: row[1:] if len(row) > 1 else row),
    "polyhedra_missing": without(Polyhedron),
    "spheres_missing": without(Sphere),
    "radius_is_diameter": spheres(lambda r: r / 2),
    "radius_not_squared": spheres(lambda r: r**0.5),
    "checker_swapped": pigments("Checker", first=lambda p: p.second, second=lambda p: p.first),
    "checker_size_ignored": pigments("Checker", size=lambda p: 1.0),
    "checker_multiplies": pigments("Checker", size=lambda p: 1 / p.size),
    "texture_exchanged": pigments("Texmap", p0=lambda p: p.p1, p1=lambda p: p.p0),
    "texture_without_offset": pigments("Texmap", p0=lambda p: (*p.p0[:3], 0.0), p1=lambda p: (*p.p1[:3], 0.0)),
}


@pytest.fixture
def scene(small_scene, tmp_path):
    """With what the mistakes need: long normals, a leaning eye, lamps that brighten, a texture, glass of both kinds."""
    picture = tmp_path / "texture.ppm"
    picture.write_text("P3 3 2 255 255 0 0 0 255 0 0 0 255 255 255 0 0 255 255 200 200 200")
    textured = load_scene(FOLDER / "tiles.in").pigments
    texture = next(p for p in textured if type(p).__name__ == "Texmap")
    texture = replace(texture, file=picture, p0=(0.31, 0.2, 0.0, 0.4), p1=(0.0, 0.43, 0.3, 0.3))
    floor, mirror, glass, block = small_scene.objects
    return replace(
        small_scene,
        camera=Camera((0.0, 3.0, -9.0), (0.0, 0.9, 0.0), (0.4, 1.0, 0.0), 45.0),
        lights=(
            Light((0.9, 2.5, -0.9), (2.5, 0.8, 0.7), (0.2, 0.0, 0.01)),
            replace(small_scene.lights[0], attenuation=(0.9, 0.0, 0.002)),
            small_scene.lights[1],
        ),
        pigments=(*small_scene.pigments, texture),
        finishes=(*small_scene.finishes, replace(small_scene.finishes[3], ior=0.7)),
        objects=(
            replace(floor, shape=Polyhedron(((0.0, 2.0, 0.0, 0.02),))),
            mirror,
            glass,
            replace(block, pigment=3),
            replace(glass, finish=4, shape=Sphere((-0.5, 0.6, -2.6), 0.55)),
        ),
    )


@pytest.mark.parametrize("name", AS_ANOTHER)
def test_a_mistake_draws_what_it_says(scene, name, monkeypatch):
    monkeypatch.setattr("converter.why.student.first_light", lambda file: ((3.0, 5.0, -2.0), (1.0, 0.1, 0.0)))
    made = replace(scene, file=FOLDER / "any.in")
    ys, xs = np.divmod(np.arange(120 * 90), 120)
    places = np.stack((xs, ys), axis=1)
    drawn = make_student(made, SETTINGS).colors(places, [frozenset((name,))])[0].reshape(90, 120, 3)
    right = np.asarray(NativeRenderer().render(scene, SETTINGS).pixels)
    assert compare_pixels(right, drawn).disagreeing > 5, "it shows nowhere"
    change, background = AS_ANOTHER[name], scene.ambient
    if isinstance(change, dict):
        expected = NativeRenderer().render(scene, replace(SETTINGS, **change))
    else:
        expected = NativeRenderer().render(change(scene), replace(SETTINGS, background=background))
    difference = compare_pixels(np.asarray(expected.pixels), drawn)
    assert difference.disagreeing == 0, difference.largest


def test_an_inverted_ior(scene):
    """Each read the other way: the one above 1 as n1/n2, the one below as n2/n1."""
    places = np.array([(x, y) for y in range(90) for x in range(120)], np.int32)
    drawn = make_student(scene, SETTINGS).colors(places, [frozenset(("ior_inverted",))])[0].reshape(90, 120, 3)
    changed = finishes(ior=lambda f: 1 / f.ior if 0 < f.ior < 1 else f.ior)(scene)
    expected = NativeRenderer().render(changed, replace(SETTINGS, ior="ratio"))
    assert compare_pixels(np.asarray(expected.pixels), drawn).disagreeing == 0


def test_the_names_exist():
    assert set(AS_ANOTHER) <= set(deviations())
