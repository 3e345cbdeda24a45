"""Whole pictures: the same bytes however they are made, pixels explained, and renderings watched and stopped."""

import math
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from native_scenes import (
    BLACK,
    CONSTANT,
    PRECISIONS,
    WHITE,
    add_finish,
    box,
    draw,
    gallery,
    look,
    new_scene,
)

import native_tracer


def pixels(image):
    return np.asarray(image.pixels)


def share_that_differs(a, b, limit=1 / 255):
    difference = np.abs(a - b)
    return np.mean(~(difference <= limit).all(axis=2))


def endless():
    """A scene that cannot be finished: at every hit between two half-mirrors the ray splits, down to depth 60."""
    scene = new_scene()
    pigment = scene.add_solid(WHITE)
    half = add_finish(scene, kr=1, kt=1)
    scene.add_polyhedron(pigment, half, [(0, 0, 1, 1), (0, 0, -1, -2)])
    scene.add_sphere(pigment, half, BLACK, 100)
    look(scene, BLACK, (0, 0, -1))
    return scene


# ---- The same bytes --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("samples", [1, 4])
def test_bytes_do_not_depend_on_the_number_of_threads(precision, samples):
    pictures = [
        bytes(draw(gallery(), 75, 50, precision=precision, samples=samples, threads=n).pixels) for n in (1, 2, 3, 7)
    ]
    assert len(set(pictures)) == 1


@pytest.mark.parametrize("instructions", ["avx2", "avx512"])
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("samples", [1, 4])
def test_bytes_do_not_depend_on_the_instruction_set(precision, samples, instructions):
    options = {"precision": precision, "samples": samples}
    plain = draw(gallery(), 75, 50, instructions="baseline", **options)
    try:
        other = draw(gallery(), 75, 50, instructions=instructions, **options)
    except ValueError as error:
        pytest.skip(str(error))
    assert bytes(plain.pixels) == bytes(other.pixels)
    assert plain.statistics == other.statistics


def test_unknown_instructions_are_refused():
    with pytest.raises(ValueError, match="mmx"):
        draw(gallery(), instructions="mmx")


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("exponent", [-10, 10])
def test_scaling_by_a_power_of_two_changes_no_byte(precision, exponent):
    # Nothing is compared with an absolute length.
    reference = draw(gallery(), precision=precision)
    scaled = draw(gallery(scale=2.0**exponent), precision=precision)
    assert bytes(reference.pixels) == bytes(scaled.pixels)


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, BLACK), (1e3, BLACK), (1.0, (100, 200, -300)), (0.3, (-7, 1, 3))])
def test_a_scene_moved_and_scaled_is_the_same_picture(scale, shift):
    # What moves with the scene but not exactly so: checkers are bound to the origin, so shifts are whole cells.
    cells = 1.4 * scale
    shift = tuple(round(s / cells) * cells for s in shift)
    assert share_that_differs(pixels(draw(gallery())), pixels(draw(gallery(scale, shift)))) < 0.002


@pytest.mark.parametrize("precision", PRECISIONS)
def test_planes_in_any_order_and_of_any_length_are_the_same_picture(precision):
    planes = box((-1, -1, -1), (1, 1, 1))

    def picture(planes):
        scene = new_scene(WHITE, (0.1, 0.2, 0.3))
        scene.add_light((3, 5, 4), WHITE, CONSTANT)
        glass = add_finish(scene, ka=0.1, kd=0.4, ks=0.4, alpha=20, kr=0.3, kt=0.6, eta=0.7)
        scene.add_polyhedron(scene.add_solid((1, 0.5, 0.2)), glass, planes)
        scene.set_camera((2.1, 1.7, 3.3), BLACK, (0, 1, 0), 50)
        return pixels(draw(scene, precision=precision))

    reference = picture(planes)
    assert np.array_equal(picture(planes[::-1]), reference)
    assert np.array_equal(picture([tuple(2.0**i * c for c in p) for i, p in enumerate(planes)]), reference)
    assert share_that_differs(picture([tuple((0.3 + i) * c for c in p) for i, p in enumerate(planes)]), reference) == 0


def test_precisions_agree():
    pictures = {p: pixels(draw(gallery(), 160, 120, precision=p)) for p in PRECISIONS}
    assert share_that_differs(pictures["double"], pictures["long double"]) == 0
    assert share_that_differs(pictures["double"], pictures["float"]) < 0.002


def test_several_samples_average_the_rays_of_a_finer_picture():
    scene = gallery()
    fine = pixels(draw(scene, 80, 60, corner=False)).reshape(30, 2, 40, 2, 3)
    coarse = pixels(draw(scene, 40, 30, samples=4, corner=False))
    assert np.allclose(coarse, fine.mean(axis=(1, 3)), rtol=0, atol=1e-6)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_no_pixel_is_ever_nan(precision):
    scene = gallery()
    scene.add_light((-2.2, 0.2, -1), WHITE, (0, 0, 1))  # a ball's centre
    scene.set_camera((0.3, 0, 2.5), (0.3, 0, -1), (0, 1, 0), 120)  # on the glass ball
    assert np.isfinite(pixels(draw(scene, precision=precision))).all()
    scene.set_camera((5, 8, 6), BLACK, (0, 1, 0), 60)  # at the light
    assert np.isfinite(pixels(draw(scene, precision=precision))).all()


def test_an_empty_scene_is_background():
    scene = new_scene(WHITE, (0.25, 0.5, 2))
    scene.set_camera(BLACK, (0, 0, -1), (0, 1, 0), 40)
    image = draw(scene, 5, 3)
    assert image.pixels.shape == (3, 5, 3)
    assert (pixels(image) == (0.25, 0.5, 2)).all()


# ---- One pixel, explained --------------------------------------------------------------------------------------------


def total(ray):
    """A ray's radiance, added up from its tree."""
    factors = [child["weight"] / ray["weight"] for child in ray["children"]]
    parts = [total(child) for child in ray["children"]]
    return tuple(ray["local"][i] + sum(f * part[i] for f, part in zip(factors, parts, strict=True)) for i in range(3))


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("samples", [1, 4])
def test_the_ray_tree_of_a_pixel_makes_its_colour(precision, samples):
    scene = gallery()
    options = {"precision": precision, "samples": samples, "cutoff": 1 / 64, "max_depth": 8}
    image = pixels(draw(scene, 20, 15, **options))
    for y in range(15):
        for x in range(20):
            tree = native_tracer.trace_pixel(scene, 20, 15, x, y, **options)
            assert np.array_equal(np.float32(tree["color"]), image[y, x])
            assert len(tree["rays"]) == samples
            sums = [ray["radiance"] for ray in tree["rays"]]
            assert np.allclose(np.mean(sums, axis=0), image[y, x], rtol=1e-5)
            assert all(np.allclose(total(ray), ray["radiance"], rtol=1e-6) for ray in tree["rays"])


def test_pixels_outside_the_picture_are_refused():
    with pytest.raises(IndexError):
        native_tracer.trace_pixel(gallery(), 20, 15, 20, 0, cutoff=0, max_depth=0)


def test_a_tree_that_nobody_could_read_is_refused():
    with pytest.raises(ValueError, match="more than 1048576 rays"):
        native_tracer.trace_pixel(endless(), 20, 15, 10, 7, cutoff=0, max_depth=60)


# ---- Watching and stopping -------------------------------------------------------------------------------------------


def test_progress_ends_with_1_and_never_falls():
    seen = []
    draw(gallery(), 640, 480, samples=16, progress=seen.append)
    assert seen[-1] == 1
    assert seen == sorted(seen) and all(0 <= share <= 1 for share in seen)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_an_exception_out_of_progress_stops_at_once(precision):
    class StopDrawingError(Exception):
        pass

    stopped = []

    def progress(share):
        stopped.append(time.perf_counter())
        raise StopDrawingError

    image = native_tracer.Image(200, 200)
    with pytest.raises(StopDrawingError):
        native_tracer.render(
            endless(), image, cutoff=0, max_depth=60, precision=precision, threads=2, progress=progress
        )
    # Mid-tile, for no tile of this scene is ever finished. Ten seconds leave room for a busy machine.
    assert time.perf_counter() - stopped[0] < 10
    assert len(stopped) == 1
    assert image.statistics["primary"] > 0
    assert not pixels(image).any()


def test_what_is_finished_stays_in_the_picture():
    # The upper half shows the background, the lower half slabs between which rays split without end.
    scene = new_scene(background=(0.5, 0.5, 0.5))
    pigment, half = scene.add_solid(WHITE), add_finish(scene, kr=1, kt=1)
    scene.add_polyhedron(pigment, half, [(0, 1, 0, 1), (0, -1, 0, -1.5)])
    scene.add_polyhedron(pigment, half, [(0, 1, 0, 2), (0, -1, 0, -2.5)])
    scene.set_camera(BLACK, (0, 0, -1), (0, 1, 0), 90)
    image = native_tracer.Image(64, 64)

    def progress(share):
        if share >= 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        native_tracer.render(scene, image, cutoff=0, max_depth=60, threads=4, progress=progress)
    picture = pixels(image)
    assert (picture[:32] == 0.5).all()
    assert (picture[40:] == 0).all()


@pytest.mark.skipif(os.name != "posix", reason="sends a signal")
def test_ctrl_c_stops_a_rendering():
    timer = threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT))
    started = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        timer.start()
        draw(endless(), 200, 200, cutoff=0, max_depth=60)
    assert time.perf_counter() - started < 10
    timer.join()


def test_python_runs_while_a_picture_is_drawn():
    beats = []

    def progress(share):
        if len(beats) > 3:
            raise StopIteration

    def beat():
        for _ in range(5):
            beats.append(time.perf_counter())
            time.sleep(0.001)

    thread = threading.Timer(0.05, beat)
    thread.start()
    with pytest.raises(StopIteration):
        draw(endless(), 100, 100, cutoff=0, max_depth=60, progress=progress)
    thread.join()


def test_a_short_rendering_does_not_wait_for_the_clock():
    scene = new_scene()
    scene.set_camera(BLACK, (0, 0, -1), (0, 1, 0), 40)
    seconds = []
    for _ in range(20):
        started = time.perf_counter()
        draw(scene, 8, 8)
        seconds.append(time.perf_counter() - started)
    assert min(seconds) < 0.05  # others may have to wait for a busy machine


def test_a_tree_of_any_depth_needs_no_stack_of_the_system():
    scene = new_scene(WHITE)
    finish = add_finish(scene, ka=2.0**-20, kr=1)
    for z in (1, -1):
        scene.add_polyhedron(scene.add_solid(WHITE), finish, [(0, 0, z, 1)])
    look(scene, BLACK, (0, 0, -1))
    image = draw(scene, 1, 1, cutoff=0, max_depth=100_000)
    assert image.statistics["deepest"] == 100_000


# ---- What is refused, and bytes --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"samples": 3}, "square"),
        ({"samples": 0}, "square"),
        ({"samples": -4}, "square"),
        ({"cutoff": -1}, "cutoff"),
        ({"cutoff": math.nan}, "cutoff"),
        ({"max_depth": -1}, "max_depth"),
        ({"precision": "half"}, "precision"),
        ({"search": "grid"}, "search"),
        ({"picture": (0, 5)}, "a width and a height"),
        ({"picture": (64, 48), "first": (1, 0)}, "does not lie in the picture"),
        ({"picture": (64, 50), "first": (0, 3)}, "does not lie in the picture"),
        ({"first": (-1, 0)}, "does not lie in the picture"),
        ({"mask": np.ones((48, 64), np.uint8)}, "a mask goes with sums"),
        ({"signatures": np.zeros((64, 48), np.uint32)}, "the image's height and width"),
    ],
)
def test_settings_that_make_no_sense(options, message):
    with pytest.raises(ValueError, match=message):
        draw(gallery(), **options)


@pytest.mark.parametrize(
    ("size", "passes", "message"),
    [
        ((64, 48), [[0, 0]], "each sample once"),
        ((64, 48), [[0], [4]], "each sample once"),
        ((64, 48), [[0], []], "a pass has a sample"),
        ((48, 64), [[0], [1]], "the same size"),
    ],
)
def test_passes_that_make_no_sense(size, passes, message):
    with pytest.raises(ValueError, match=message):
        draw(gallery(), samples=4, sums=native_tracer.PassSums(*size), passes=passes)


def test_progress_that_is_no_function():
    with pytest.raises(TypeError, match="callable"):
        draw(gallery(), progress=1)


@pytest.mark.parametrize("size", [(0, 5), (5, -1)])
def test_pictures_without_pixels_are_refused(size):
    with pytest.raises(ValueError, match="above 0"):
        native_tracer.Image(*size)


def test_pictures_that_do_not_fit_are_refused():
    with pytest.raises(MemoryError):
        native_tracer.Image(2**31 - 1, 2**31 - 1)


def test_the_builder_refuses_what_it_cannot_draw():
    scene = new_scene()
    pigment, finish = scene.add_solid(WHITE), add_finish(scene)
    with pytest.raises(IndexError, match="pigment 1"):
        scene.add_sphere(1, finish, BLACK, 1)
    with pytest.raises(IndexError, match="finish -1"):
        scene.add_polyhedron(pigment, -1, [(0, 0, 1, 0)])
    with pytest.raises(ValueError, match="radius"):
        scene.add_sphere(pigment, finish, BLACK, 0)
    with pytest.raises(ValueError, match="normal is zero"):
        scene.add_polyhedron(pigment, finish, [(0, 0, 0, 1)])
    with pytest.raises(ValueError, match="at least one"):
        scene.add_polyhedron(pigment, finish, [])
    with pytest.raises(ValueError, match="a plane needs 4 numbers"):
        scene.add_polyhedron(pigment, finish, np.zeros(5))
    with pytest.raises(ValueError, match=r"cone must lie in 0\.\.90"):
        add_finish(scene, cone=91)
    with pytest.raises(ValueError, match="must not be negative"):
        scene.add_light(BLACK, WHITE, CONSTANT, -1)
    with pytest.raises(ValueError, match="not finite"):
        scene.add_light((math.nan, 0, 0), WHITE, CONSTANT)
    with pytest.raises(ValueError, match="2 x 2"):
        scene.add_texmap(2, 2, np.zeros(11, np.float32), (0, 0, 0, 0), (0, 0, 0, 0))


def test_planes_may_come_as_a_buffer():
    pictures = []
    for convert in (list, lambda planes: np.array(planes, dtype=float), lambda planes: np.ravel(planes).astype(float)):
        scene = new_scene(WHITE)
        scene.add_polyhedron(
            scene.add_solid(WHITE), add_finish(scene, ka=1), convert(box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)))
        )
        scene.set_camera((3, 2, 4), BLACK, (0, 1, 0), 40)
        pictures.append(bytes(draw(scene).pixels))
    assert len(set(pictures)) == 1


def test_quantize_clamps_and_rounds_halves_up():
    values = np.array([0, 1, -3, 7, 0.5, 0.1, 0.3, math.nan, math.inf, -math.inf, 0.5 / 255, 0.49 / 255], np.float32)
    expected = bytes([0, 255, 0, 255, 128, 26, 77, 0, 255, 0, 1, 0])
    assert native_tracer.quantize(values) == expected
    # A half is a half also where roundings have left it a little below.
    below = np.array([178.5, 0.5, 254.5], np.float64) / 255
    assert native_tracer.quantize((below - 9e-5 / 255).astype(np.float32)) == bytes([179, 1, 255])
    assert native_tracer.quantize((below - 2e-4 / 255).astype(np.float32)) == bytes([178, 0, 254])
    every = np.arange(256, dtype=np.float32) / np.float32(255)
    assert native_tracer.quantize(memoryview(every)) == bytes(range(256))


def test_numpy_is_not_needed():
    code = """
import sys, native_tracer
from array import array
scene = native_tracer.Scene()
texture = scene.add_texmap(1, 1, array("f", [1, 0, 0]), (0, 0, 0, 0), (0, 0, 0, 0))
scene.add_sphere(texture, scene.add_finish(1, 0, 0, 1, 0, 0, 1), (0, 0, -5), 1)
image = native_tracer.Image(4, 4)
native_tracer.render(scene, image, cutoff=0, max_depth=0)
assert len(native_tracer.quantize(image.pixels)) == 48
assert native_tracer.trace_pixel(scene, 4, 4, 1, 1, cutoff=0, max_depth=0)
import converter.renderers.native
assert "numpy" not in sys.modules
"""
    subprocess.run([sys.executable, "-c", code], check=True)
