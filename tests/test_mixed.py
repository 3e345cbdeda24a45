"""Mixed precision: single tells what it cannot decide, and what it does not tell is right."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

from converter.compare.metrics import compare_pixels
from converter.renderers.methods import find_method
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import Settings

SCENES = Path(__file__).parent.parent / "scenes"
MOST_IN_DOUBLE = 0.3
"""Of the pixels of a scene whose errors are bounded."""
OFF = 2.0**-14
"""How far rays are off at first, in the test that follows them: more than all roundings."""
BOUNCES = 4
WEIGHTS = ((0.9, 0.81), (0.94, 0.8836))
"""Numbers kr and cut-offs; single and double precision compare the square of the one with the other differently."""


def mixed(scene, settings):
    return find_method("mitsuba-mixed").renderer(VARIANT).render(scene, settings)


def wrong(scene, settings, picture):
    return compare_pixels(
        np.asarray(NativeRenderer().render(scene, settings).pixels), np.asarray(picture.pixels)
    ).disagreeing


@pytest.mark.parametrize("name", ["figure1", "tiles", "nested", "quadrics", "lanterns"])
def test_pictures_are_exact(mi, name):
    scene, settings = load_scene(SCENES / f"{name}.in"), Settings(width=160, height=120)
    picture = mixed(scene, settings)
    assert wrong(scene, settings, picture) == 0
    assert picture.statistics["drawn_in_double"] < MOST_IN_DOUBLE


@pytest.mark.parametrize("name", ["lens", "sampled/dew"])
def test_what_has_no_bounds_is_drawn_in_double(mi, name):
    """Csgs, and what is random."""
    scene, settings = load_scene(SCENES / f"{name}.in"), Settings(width=32, height=24, samples=1)
    assert mixed(scene, settings).statistics["drawn_in_double"] == 1


MADE = {
    # Glass just above a mirror: rays that leave the one start at the other.
    "sheets": "0 2 4 0 0 0 0 1 0 40 1 0 0 0 1 1 1 1 0 0 2 solid 1 0 0 solid 0 1 0 "
    "2 0.5 0.5 0 1 0 0.5 1.1 0.5 0 0 1 0.5 0 0 2 0 0 polyhedron 2 0 1 0 -1 0 -1 0 0.00015 1 1 polyhedron 1 0 1 0 0",
}
"""Scenes that press hard on some bounds."""


def test_highlights_that_are_too_sharp_are_undecided(mi, tmp_path):
    text = "0 1 -1 0 0 0 0 1 0 0.002 2 0 0 0 1 1 1 1 0 0 0 1 1 1 1 1 1 0 0 1 solid 1 1 1 1 0 0.2 0.8 1e11 0 0 0 "
    scene = parse_scene(f"{text} 1 0 0 polyhedron 1 0 1 0 0", tmp_path / "sharp.in")
    settings = Settings(width=48, height=48)
    assert wrong(scene, settings, mixed(scene, settings)) == 0


def test_weights_at_the_cutoff_are_undecided(mi, tmp_path):
    """Where single precision puts the product of two weights on the other side."""
    text = "0 1 0 0 0 1 0 1 0 60 1 0 0 0 1 1 1 1 0 0 2 solid 1 1 1 solid 1 0 0 1 0.4 0 0 1 KR 0 0 "
    text += "2 0 0 polyhedron 1 0 1 0 0 1 0 polyhedron 1 0 -1 0 3"
    for kr, cutoff in WEIGHTS:
        scene = parse_scene(text.replace("KR", str(kr)), tmp_path / "mirrors.in")
        settings = Settings(width=32, height=24, cutoff=cutoff)
        assert wrong(scene, settings, mixed(scene, settings)) == 0


def test_tiles_on_a_floor_that_is_a_border_of_them(mi, tmp_path):
    """Of numbers that single precision has it decides which they belong to; of others all is drawn in double."""
    for height, share in (("1", 0.5), ("0.1", 1)):
        text = f"0 0.5 0 0 -0.4 -3 0 1 0 60 1 0 0 0 1 1 1 1 0 0 1 checker 1 0 0 0 1 0 {height} 1 1 0 0 1 0 0 0 1 "
        scene = parse_scene(f"{text} 0 0 polyhedron 1 0 1 0 {height}", tmp_path / "floor.in")
        picture = mixed(scene, Settings(width=64, height=64))
        assert wrong(scene, Settings(width=64, height=64), picture) == 0
        assert picture.statistics["drawn_in_double"] <= share


@pytest.mark.parametrize("name", ["figure1", "quadrics", "prisms", *MADE])
def test_rays_stay_within_their_bounds(mi, name, tmp_path):
    """Two rays a little apart, one in single precision with bounds that know of it, one in double: where the first
    does not tell that it cannot decide, both meet the same, and distances, points, normals and directions are within
    the bounds.
    """
    import drjit as dr

    from mitsuba_plugins import sampler as samples
    from mitsuba_plugins.integrators.pixels import corners
    from mitsuba_plugins.integrators.primary_rays import primary_ray
    from mitsuba_plugins.integrators.secondary_rays import reflected, transmitted

    settings = Settings(width=96, height=72)
    file = SCENES / f"{name}.in"
    drawn = parse_scene(MADE[name], tmp_path / "made.in") if name in MADE else load_scene(file)
    loaded = MitsubaRenderer(VARIANT, precision="mixed")._load(drawn, settings)
    sensor = loaded.sensors()[0]
    count = settings.width * settings.height
    random = np.random.default_rng(5)
    precisions = loaded.integrator().prepared(loaded, sensor)
    double, single = precisions.deciding, precisions.single
    with dr.suspend_grad():
        sample = samples.Sample(mi.UInt32(0), mi.UInt32(0))
        position = corners(sensor.film(), dr.arange(mi.UInt32, count)) + mi.Point2d(0.5, 0.5)
        exact = primary_ray(double, position, sample)
        turned = np.asarray(exact.d).T + OFF * across(np.asarray(exact.d).T, random)
        turned /= np.linalg.norm(turned, axis=1)[:, None]
        moved = np.asarray(exact.o).T + OFF * across(turned, random)
        with single() as scene:
            ray = primary_ray(scene, position, sample)
            ray = replace(ray, t_min=ray.t_min + OFF, shift=ray.shift + OFF, spread=ray.spread + OFF)
        exact = replace(exact, o=mi.Point3d(moved.T), d=mi.Vector3d(turned.T))
        known = np.ones(count, np.bool_)
        with single() as scene:
            hit = scene.closest(ray, mi.Bool(known))
            found = crossing(scene, ray, hit.object, hit.valid)
        told = np.asarray(hit.valid & ~hit.undecided)
        true = crossing(double, exact, hit.object, hit.valid)
        apart = np.abs(np.asarray(found.t, np.float64)[told] - np.asarray(true.t)[told])
        assert np.all(apart <= np.asarray(found.error)[told])
        for bounce in range(BOUNCES):
            hits, rays = [], []
            for precision, each in (("single", ray), ("double", exact)):
                with single() if precision == "single" else nullcontext(double) as scene:
                    hit = scene.closest(each, mi.Bool(known))
                    finish, _ = scene.material(each, hit)
                    refracts = finish.kt > finish.kr
                    mirrored = reflected(scene, each, hit, finish, sample, None, mi.Bool(True))
                    through = transmitted(scene, each, hit, finish, sample, None, mi.Bool(True))[0]
                    following = dr.select(refracts, through, mirrored)
                    dr.eval(hit, following)
                    hits.append(hit)
                    rays.append(following)
            (hit, true), (ray, exact) = hits, rays
            known &= ~np.asarray(hit.undecided)
            assert np.array_equal(np.asarray(hit.valid)[known], np.asarray(true.valid)[known])
            known &= np.asarray(hit.valid)
            assert np.array_equal(np.asarray(hit.object)[known], np.asarray(true.object)[known])
            assert np.array_equal(np.asarray(hit.primitive)[known], np.asarray(true.primitive)[known])
            assert np.array_equal(np.asarray(hit.inside)[known], np.asarray(true.inside)[known])
            for a, b, bound in ((hit.p, true.p, hit.error), (hit.n, true.n, hit.lean), (ray.d, exact.d, ray.spread)):
                apart = np.linalg.norm(np.asarray(a, np.float64) - np.asarray(b), axis=0)
                assert np.all((apart <= np.asarray(bound))[known]), bounce
            assert known.any() or bounce > 0


@pytest.mark.parametrize("height", [1e-4, -1e-4])
@pytest.mark.parametrize("direction", [1, -1])
def test_rays_that_may_start_at_another_surface_are_undecided(mi, height, direction, tmp_path):
    """Just above a ball or just below, and farther from it or nearer than the origin may be off."""
    import drjit as dr

    from mitsuba_plugins.intersection.rays import real, start_ray

    text = "0 1 -4 0 0 0 0 1 0 60 1 0 0 0 1 1 1 1 0 0 1 solid 1 1 1 1 0.4 0.6 0 1 0 0 0 1 0 0 sphere 0 0 0 1"
    scene = parse_scene(text, tmp_path / "ball.in")
    loaded = MitsubaRenderer(VARIANT, precision="mixed")._load(scene, Settings(width=4, height=3))
    types = real("float")
    with dr.suspend_grad(), loaded.integrator().prepared(loaded).single() as prepared:
        for error, undecided in ((1e-3, True), (1e-6, False)):
            ray = start_ray(types, types.Point3(0, 0, 1 + height), types.Vector3(0, 0, direction), error)
            assert prepared.closest(ray, mi.Bool(True)).undecided == mi.Bool(undecided)


def crossing(scene, ray, index, active):
    """Where rays cross an object, and how far that may be off."""
    from mitsuba_plugins.intersection.rays import largest

    return scene.tracer.primitives.intersect(ray, index, active, largest(ray.o))


def across(d, random):
    """Vectors of random directions at right angles to unit vectors (n, 3), a little shorter than 1."""
    v = np.cross(d, random.normal(size=d.shape))
    return 0.99 * v / np.linalg.norm(v, axis=1)[:, None]
