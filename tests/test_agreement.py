"""Both renderers on every scene of the gallery: what one draws the other draws."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

from converter.compare.metrics import compare_pixels
from converter.images.write import write_image
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import Settings

sys.path.insert(0, str(Path(__file__).parent.parent / "scenes"))

from random_scenes import random_scene
from round_numbers import SQUARES, TEXTURE

SCENES = sorted((Path(__file__).parent.parent / "scenes").glob("*.in"))
SETTINGS = Settings(width=200, height=150)
MOST_THROUGH_EMBREE = 3
"""Pixels of 30,000 that may disagree: Embree decides in single precision on which side of an edge a ray passes."""


def agree(scene, settings, renderer, tmp_path, most=0):
    """Compare a renderer's picture with the native tracer's, and leave both where a failure's message says.

    Returns both.
    """
    reference = np.asarray(NativeRenderer().render(scene, settings).pixels)
    result = np.asarray(renderer.render(scene, settings).pixels)
    difference = compare_pixels(reference, result)
    for name, image in (("reference", reference), ("result", result), ("difference", np.abs(reference - result))):
        np.save(tmp_path / f"{name}.npy", image)
    assert difference.disagreeing <= most, f"{difference.largest}; pictures: {tmp_path}"
    return reference, result


def same_files(scene, settings, tmp_path):
    """Draw a scene with both renderers, and compare the pictures and the .ppm files, byte by byte."""
    files = [tmp_path / "native.ppm", tmp_path / "mitsuba.ppm"]
    pictures = agree(scene, settings, MitsubaRenderer(VARIANT), tmp_path)
    for file, picture in zip(files, pictures, strict=True):
        write_image(file, picture, settings.width, settings.height)
    first, second = (np.frombuffer(file.read_bytes(), np.uint8) for file in files)
    assert len(first) == len(second)
    assert np.count_nonzero(first != second) == 0


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_both_renderers_write_the_same_bytes(mi, file, tmp_path):
    same_files(load_scene(file), SETTINGS, tmp_path)


def test_random_scenes_make_the_same_bytes(mi, tmp_path):
    (tmp_path / TEXTURE).write_text(SQUARES, encoding="ascii")
    for seed in range(34, 58):
        scene = parse_scene(str(random_scene(seed)), tmp_path / "random.in")
        same_files(scene, Settings(width=160, height=120), tmp_path)


def test_light_is_added_up_in_double_precision(mi, tmp_path):
    """Of hundreds of dim lights, whose sum in single precision would be off by some of its last digits."""
    scene = load_scene(next(file for file in SCENES if file.stem == "figure1"))
    light = replace(scene.lights[0], color=(0.0017, 0.0013, 0.0011))
    scene = replace(scene, lights=(light,) * 300)
    settings = Settings(width=80, height=60, samples=4)
    pictures = [np.asarray(r.render(scene, settings).pixels) for r in (NativeRenderer(), MitsubaRenderer(VARIANT))]
    assert np.count_nonzero(pictures[0] != pictures[1]) <= 2


@pytest.mark.parametrize("name", ["figure1", "bubble", "solids", "endless", "room", "nested"])
def test_meshes_agree(mi, name, tmp_path):
    """The way through Embree."""
    file = next(file for file in SCENES if file.stem == name)
    agree(load_scene(file), SETTINGS, MitsubaRenderer(VARIANT, "mesh"), tmp_path, MOST_THROUGH_EMBREE)


@pytest.mark.parametrize(
    "changes",
    [
        {"pixel": "center"},
        {"specular": "blinn"},
        {"background": (0.1, 0.2, 2.0)},
        {"samples": 4},
        {"cutoff": 0.1},
        {"max_depth": 1},
        {"max_depth": 0},
        {"ior": "ratio"},
    ],
    ids=str,
)
def test_every_setting_agrees(mi, small_scene, changes, tmp_path):
    settings = Settings(**({"width": 120, "height": 90} | changes))
    agree(small_scene, settings, MitsubaRenderer(VARIANT), tmp_path)


def test_textures_agree_where_they_begin_again(mi, tmp_path):
    """Rows of rays that meet whole repeats of an image: 49 / 49 is not 49 times its reciprocal."""
    (tmp_path / "t49.ppm").write_bytes(b"P6 49 1 255\n" + b"\xff\0\0" + b"\xff" * 144)
    scene = "0 0 10 0 0 0 0 1 0 30 1 0 0 0 1 1 1 1 0 0 1 texmap t49.ppm 1 0 0 0 0 0 0 0 1 1 0 0 1 0 0 0 1 0 0 "
    scene += "polyhedron 1 0 0 1 0"
    (tmp_path / "t49.in").write_text(scene)
    agree(load_scene(tmp_path / "t49.in"), SETTINGS, MitsubaRenderer(VARIANT), tmp_path)


def test_pictures_larger_than_one_band_agree(mi, small_scene, tmp_path):
    agree(small_scene, Settings(width=700, height=500), MitsubaRenderer(VARIANT), tmp_path)


@pytest.mark.parametrize("intersections", ["analytic", "bvh", "mesh"])
def test_pixel_trees_agree(mi, small_scene, intersections):
    """Ray by ray: the same objects, planes and shadows, and the colours that the pictures have."""
    settings = Settings(width=40, height=30)
    renderer = MitsubaRenderer(VARIANT, intersections)
    picture = np.asarray(renderer.render(small_scene, settings).pixels)
    for x, y in ((27, 18), (13, 15), (22, 12), (20, 29)):
        native = NativeRenderer().trace_pixel(small_scene, settings, x, y)
        mitsuba = renderer.trace_pixel(small_scene, settings, x, y)
        assert mitsuba.color == pytest.approx(picture[y, x], abs=1e-5)
        assert mitsuba.color == pytest.approx(native.color, abs=1e-5)
        assert [*map(_skeleton, mitsuba.rays)] == [*map(_skeleton, native.rays)]


def _skeleton(ray):
    """What of a ray and those below it has no digits."""
    hit = ray.hit
    met = hit and (hit.object, hit.plane, hit.entering, hit.total_reflection)
    shadows = hit and [(light.light, light.cosine > 0, light.shadowed_by is None) for light in hit.lights]
    return ray.kind, ray.depth, met, shadows, ray.dropped, [*map(_skeleton, ray.children)]
