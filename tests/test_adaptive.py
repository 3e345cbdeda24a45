"""Adaptive sampling: which pixels are refined, the same in both renderers, and what comes out."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from csgs import csg
from variant import VARIANT

import native_tracer
from converter.renderers.adaptive import Adapting, Spread, halves_needed
from converter.renderers.base import Interrupted
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer, build_scene
from converter.scene.model import Camera, Checker, Finish, Light, Object, Polyhedron, Quadric, Scene, Solid, Sphere
from converter.scene.needs import scene_needs
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.scene.writer import write_scene
from native_tracer.passes import passes

SCENES = Path(__file__).parent.parent / "scenes"
SETTINGS = Settings(width=64, height=48, samples=16)
FLAT = Finish(ka=1, kd=0, ks=0, alpha=1, kr=0, kt=0, ior=1)
MATTE = Finish(ka=0, kd=1, ks=0, alpha=1, kr=0, kt=0, ior=1)


class Kept(Adapting):
    """Keeps what it was asked and has said, too."""

    def halves(self, signatures, colors):
        self.signatures, self.wanted = signatures.copy(), super().halves(signatures, colors)
        return self.wanted


def drawn(renderer, scene, limit=8, settings=SETTINGS):
    """The picture, how many halves of a pass each pixel has, and the signatures."""
    kept = Kept(limit, settings.samples)
    picture = np.asarray(renderer.render_adaptively(scene, settings, kept).pixels)
    return picture, kept.wanted, kept.signatures


# ---- Which pixels


def test_neighbours_are_compared():
    """Colours weigh more than signatures."""
    signatures = np.zeros((4, 5), np.uint32)
    signatures[1, 2] = 1
    colors = np.zeros((4, 5, 3), np.float32)
    near = np.zeros((4, 5), int)
    near[1, 1:4] = near[0:3, 2] = 1
    assert np.array_equal(halves_needed(signatures, colors, 0), near)
    colors[1, 2, 1] = 3 / 255
    assert np.array_equal(halves_needed(signatures, colors, 2.9), 2 * near)
    assert np.array_equal(halves_needed(signatures, colors, 3), near)
    signatures[3, 2] = 1
    assert halves_needed(signatures, colors, 2.9)[2:].tolist() == [[0, 0, 2, 0, 0], [0, 1, 1, 1, 0]]
    signatures[:] = 0
    assert not halves_needed(signatures, colors, 3).any()
    colors[1, 2, 1], colors[3, 4] = np.nan, (7, 7, 7)  # black, and white
    assert np.argwhere(halves_needed(signatures, colors, 254)).tolist() == [[2, 4], [3, 3], [3, 4]]


@pytest.mark.parametrize(("samples", "least", "most"), [(4, 4, 4), (16, 16, 16), (25, 3, 5), (196, 7, 14)])
def test_samples_are_told(samples, least, most):
    chosen = Adapting(2, samples)
    chosen.halves(np.array([[0, 0, 0, 1, 1]], np.uint32), np.array([[[0] * 3, [1] * 3] + [[1] * 3] * 3], np.float32))
    assert chosen.samples.tolist() == [[1 + most, 1 + most, 1 + least, 1 + least, 1]]
    assert chosen.statistics()["refined_pixels"] == (2 if least < most else 4)


WHITE = (Solid((1, 1, 1)),)


def scene_of(*objects, finishes=(FLAT,), pigments=WHITE, lights=()):
    camera = Camera((0, 0, 10), (0, 0, 0), (0, 1, 0), 40)
    return Scene(camera, (0.5, 0.5, 0.5), lights, pigments, finishes, objects)


BOX = Polyhedron(((1, 0, 0, -2), (-1, 0, 0, -2), (0, 1, 0, -2), (0, -1, 0, -2), (0, 0, 1, -2), (0, 0, -1, -2)))
FLOOR = Polyhedron(((0, 0, 1, 0),))
PLAIN = {
    "an object": scene_of(Object(0, 0, Sphere((0, 0, 0), 2))),
    "nothing": scene_of(Object(0, 0, Sphere((0, 0, 900), 2))),
    "two of one colour": scene_of(Object(0, 0, Sphere((0, 0, 0), 2)), Object(0, 0, Sphere((0, 0, -50), 40))),
    "an edge": replace(scene_of(Object(0, 0, BOX)), camera=Camera((6, 7, 8), (0, 0, 0), (0, 1, 0), 40)),
    "a csg's leaves": replace(
        scene_of(Object(0, 0, csg("+", BOX, "-", Quadric((1, 0, 1, 0, 0, 0, 0, 0, 0, -1)), "-", Sphere((2, 2, 2), 1)))),
        camera=Camera((6, 7, 8), (0, 0, 0), (0, 1, 0), 40),
    ),
    "cells of one colour": scene_of(Object(0, 0, FLOOR), pigments=(Checker((1, 1, 1), (1, 1, 1), 1),)),
    "a shadow": scene_of(
        Object(0, 0, FLOOR),
        Object(0, 0, Sphere((0, 0, 30), 1)),
        finishes=(MATTE,),
        lights=(Light((0, 0, 60), (1e-9, 0, 0), (1, 0, 0)),),
    ),
    "what a mirror shows": scene_of(
        Object(0, 1, FLOOR),
        Object(0, 0, Sphere((0, 0, 20), 3)),
        finishes=(FLAT, replace(FLAT, ka=0.5, kr=0.5)),
    ),
    "total reflection": scene_of(
        Object(0, 0, BOX),
        finishes=(Finish(ka=0.5, kd=0, ks=0, alpha=1, kr=0, kt=0.5, ior=1.5),),
    ),
}
"""Scenes of one colour, all of whose pixels are alike but for what is named, or nearly."""


@pytest.mark.parametrize("name", PLAIN)
def test_what_no_colour_tells(mi, name):
    """Edges are found where both sides have the same colour; each renderer finds the same."""
    found = {}
    for renderer in (NativeRenderer(), NativeRenderer("float"), MitsubaRenderer(VARIANT)):
        _, wanted, signatures = drawn(renderer, PLAIN[name], limit=100)
        found[str(renderer)] = wanted, signatures
    (wanted, signatures), (single, _), (other, words) = found.values()
    assert np.array_equal(wanted, other)
    assert np.array_equal(signatures, words)
    assert np.mean(wanted != single) < 0.02
    assert wanted.any() == (name != "nothing")
    assert not wanted.all()


def test_what_weighs_less_than_the_limit_is_not_signed(mi):
    """What a mirror shows of weight 1/2, and the shadow on a mirror's floor of weight 1/2 * 1/2."""
    half = replace(FLAT, ka=0.5, kr=0.5)
    dim = Finish(ka=0.5, kd=0.5, ks=0, alpha=1, kr=0, kt=0, ior=1)
    ceiling = Polyhedron(((0, 0, -1, 30),))
    shown = PLAIN["what a mirror shows"]
    light = Light((0, 0, 10), (1e-9, 0, 0), (1, 0, 0))
    shadowed = scene_of(
        Object(0, 0, FLOOR),
        Object(0, 1, ceiling),
        Object(0, 1, Sphere((0, 0, 20), 3)),
        finishes=(half, dim),
        lights=(light,),
    )
    for scene, least, most in ((shown, 0.499, 0.501), (shadowed, 0.249, 0.251)):
        for renderer in (NativeRenderer(), MitsubaRenderer(VARIANT)):
            words = [drawn(renderer, scene, limit=255 * share)[2] for share in (0, least, most, 1)]
            assert np.array_equal(words[0], words[1])
            assert not np.array_equal(words[1], words[2])


@pytest.mark.parametrize("name", ["checker", "figure1", "whitted", "solids", "quadrics"])
def test_both_renderers_refine_the_same_pixels(mi, name):
    scene = load_scene(SCENES / f"{name}.in")
    settings = replace(SETTINGS, samples=4, cutoff=1 / 64)
    native, wanted, signatures = drawn(NativeRenderer(), scene, settings=settings)
    other, same, words = drawn(MitsubaRenderer(VARIANT), scene, settings=settings)
    assert np.array_equal(signatures, words)
    assert np.array_equal(wanted, same)
    assert 0.01 < np.mean(wanted > 0) < 1
    assert other == pytest.approx(native, abs=1e-6)


@pytest.mark.parametrize("precision", ["float", "double", "long double"])
def test_threads_and_precisions(small_scene, precision):
    renderer = NativeRenderer(precision)
    first = drawn(renderer, small_scene, settings=replace(SETTINGS, threads=1))
    second = drawn(renderer, small_scene, settings=replace(SETTINGS, threads=3))
    assert all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))


# ---- What comes out


@pytest.fixture(params=["native", "mitsuba"])
def renderer(request):
    if request.param == "native":
        return NativeRenderer()
    request.getfixturevalue("mi")
    return MitsubaRenderer(VARIANT)


@pytest.mark.parametrize("pixel", ["corner", "center"])
def test_refined_pixels_have_all_samples_and_others_one(renderer, small_scene, pixel):
    settings = replace(SETTINGS, pixel=pixel)
    many = np.asarray(renderer.render(small_scene, settings).pixels)
    one = np.asarray(renderer.render(small_scene, replace(settings, samples=1)).pixels)
    picture, wanted, _ = drawn(renderer, small_scene, settings=settings)
    assert set(np.unique(wanted)) == {0, 1, 2}
    assert np.array_equal(picture, np.where(wanted[..., None] > 0, many, one))


def test_of_many_samples_refined_pixels_have_halves_of_a_pass(renderer, small_scene):
    settings = replace(SETTINGS, samples=144)
    cells = passes(144)[0]
    picture, wanted, _ = drawn(renderer, small_scene, settings=settings)
    assert set(np.unique(wanted)) == {0, 1, 2}
    one = np.asarray(NativeRenderer().render(small_scene, replace(settings, samples=1)).pixels)
    half, whole = (of_cells(small_scene, settings, some) for some in ([k for k in cells if k % 2 == 0], cells))
    assert picture == pytest.approx(np.choose(wanted[..., None], (one, half, whole)), abs=1e-6)


def of_cells(scene, settings, cells):
    """The picture of some of the samples, in every pixel."""
    needs = scene_needs(scene, settings)
    image, sums = (kind(settings.width, settings.height) for kind in (native_tracer.Image, native_tracer.PassSums))
    limits = {"samples": settings.samples, "cutoff": settings.cutoff, "max_depth": needs.max_depth}
    native_tracer.render(build_scene(scene, needs), image, passes=[cells], sums=sums, **limits)
    return np.asarray(image.pixels)


def test_nothing_to_refine(renderer):
    picture, wanted, _ = drawn(renderer, PLAIN["nothing"])
    assert not wanted.any()
    assert (picture == 0.5).all()


def test_ctrl_c(renderer, small_scene):
    def stop(share):
        if share > 0.5:
            raise KeyboardInterrupt

    told = []
    chosen = Adapting(8, 16)
    with pytest.raises(Interrupted) as caught:
        renderer.render_adaptively(small_scene, SETTINGS, chosen, stop)
    assert np.asarray(caught.value.partial.pixels).all()
    renderer.render_adaptively(small_scene, SETTINGS, chosen, told.append)
    assert told == sorted(told)
    assert told[-1] == 1


def test_rays_are_counted(small_scene):
    chosen = Adapting(8, 16)
    found = NativeRenderer().render_adaptively(small_scene, SETTINGS, chosen).statistics
    assert found["primary"] == pytest.approx(64 * 48 * chosen.statistics()["rays_a_pixel"], rel=1e-3)
    assert found["rays"] == sum(found[kind] for kind in ("primary", "reflected", "transmitted", "shadow"))


# ---- Scenes that are sampled


def sampled(scene):
    """The scene with a wide light."""
    return replace(scene, lights=(replace(scene.lights[0], radius=1.0), *scene.lights[1:]))


class Limitless(Adapting):
    """Is never sure."""

    def unsure(self, sums, size, drawn):
        super().unsure(sums, size, drawn)
        return drawn


def test_both_renderers_are_sure_of_the_same_pixels(mi, small_scene):
    pictures, counts = [], []
    for renderer in (NativeRenderer(), MitsubaRenderer(VARIANT)):
        chosen = Adapting(4, 64)
        settings = replace(SETTINGS, samples=64)
        pictures.append(np.asarray(renderer.render_adaptively(sampled(small_scene), settings, chosen).pixels))
        counts.append(chosen.samples.copy())
    assert np.array_equal(*counts)
    assert pictures[0] == pytest.approx(pictures[1], abs=1e-6)
    assert set(np.unique(counts[0])) <= set(range(16, 65, 8))
    assert {16, 64} <= set(np.unique(counts[0]))


def test_all_samples_are_the_uniform_picture(renderer, small_scene):
    scene = sampled(small_scene)
    whole = np.asarray(renderer.render(scene, SETTINGS).pixels)
    found = renderer.render_adaptively(scene, SETTINGS, Limitless(8, 16))
    assert np.asarray(found.pixels) == pytest.approx(whole, abs=1e-7)


def test_the_error_is_below_the_limit(small_scene):
    """Where it was sure, before all samples were drawn, and against many."""
    scene, settings = sampled(small_scene), replace(SETTINGS, samples=256)
    truth = np.asarray(NativeRenderer().render(scene, replace(settings, samples=1024, seed=5)).pixels)
    chosen = Adapting(2, 256)
    found = np.asarray(NativeRenderer().render_adaptively(scene, settings, chosen).pixels)
    sure = chosen.samples < 256
    assert 0.3 < sure.mean() < 1
    error = 255 * (found - truth).astype(float)[sure]
    assert np.sqrt(np.mean(error**2)) < 2


def test_a_spread_in_numbers():
    spread = Spread(limit=255 * 0.5)
    sums, everywhere = np.zeros((1, 3, 3)), np.ones((1, 3), bool)
    sums[0, 0] = 4, 4, 4
    assert spread.unsure(sums, 4, everywhere).all()  # of one pass nothing is known
    sums[0, 0, 1] += 12  # means 1 and 3: a variance of 2, and a standard error of 1
    assert spread.unsure(sums, 4, everywhere).tolist() == [[True, True, False]]
    sums[0, 0, 1] += 8  # 1, 3, 2: a variance of 1, an error of 0.577
    assert spread.unsure(sums, 4, np.array([[True, True, False]])).tolist() == [[True, True, False]]
    sums[0, 0, 1] += 8  # 1, 3, 2, 2: 2/3, 0.408
    assert not spread.unsure(sums, 4, np.array([[True, True, False]])).any()
    assert spread.samples.tolist() == [[16, 16, 8]]


# ---- The command


@pytest.fixture
def scene(tmp_path, small_scene):
    file = tmp_path / "small.in"
    file.write_text(write_scene(small_scene))
    return file


def test_the_command(whitted, scene, small_scene, tmp_path):
    out, where = tmp_path / "a.ppm", tmp_path / "where.ppm"
    options = ("--method", "native", "--adaptive", 8, "--adaptive-map", where, "--stats")
    status, printed, _ = whitted("render", scene, out, 64, 48, *options)
    assert status == 0
    _, wanted, _ = drawn(NativeRenderer(), small_scene)
    assert ["refined", "pixels", str(np.sum(wanted == 2))] in [line.split() for line in printed.splitlines()]
    gray = np.repeat(np.array([0, 128, 255], np.uint8)[wanted][..., None], 3, axis=2)
    assert where.read_bytes() == b"P6\n64 48\n255\n" + bytes(gray)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--adaptive", "8", "--method", "mitsuba-mesh"), "--adaptive: not with mitsuba-mesh: "),
        (("--adaptive", "8", "--method", "povray"), "--adaptive: povray draws all pixels alike"),
        (("--adaptive", "8", "--samples", "1"), "--samples 1 there is nothing to add"),
        (("--adaptive", "8", "--resume"), "--adaptive draws in no passes"),
        (("--adaptive", "-1"), "--adaptive: must not be negative"),
        (("--adaptive-map", "map.png"), "--adaptive-map: there is one with --adaptive only"),
    ],
)
def test_what_does_not_go_together(whitted, scene, tmp_path, options, message):
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", *options)
    assert status == 2
    assert message in err
    assert not (tmp_path / "a.ppm").exists()


def test_the_command_in_a_sampled_scene(whitted, small_scene, tmp_path):
    file, where = tmp_path / "soft.in", tmp_path / "where.ppm"
    file.write_text(write_scene(sampled(small_scene)))
    options = ("--method", "native", "--adaptive", 4, "--samples", 64, "--adaptive-map", where, "--stats")
    status, printed, _ = whitted("render", file, tmp_path / "a.ppm", 64, 48, *options)
    assert status == 0
    told = dict(line.rsplit(None, 1) for line in printed.splitlines() if line.strip())
    assert 16 < float(told["rays a pixel"]) < 64
    assert 3 <= len(set(where.read_bytes()[13:])) <= 7
