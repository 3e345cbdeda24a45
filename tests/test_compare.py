"""Comparisons: the figures against values worked out by hand, the FLIP map, the picture, and two ray trees."""

import copy
import math

import numpy as np
import pytest

from converter.compare.figure import NOT_FINITE, Panel, draw_figure, side_by_side
from converter.compare.flip import flip_map
from converter.compare.metrics import LIMIT, SizeMismatch, absolute_difference, clamped, compare_pixels
from converter.compare.ray_listing import WIDTH, list_rays
from converter.compare.rays import first_unequal, pair_trees, walk
from converter.compare.report import Pictures, Timing, difference_rows, make_report, timing_rows, to_json, verdict
from converter.images.texture import read_texture
from converter.renderers.native import NativeRenderer
from converter.scene.settings import Settings

NAN, INF = math.nan, math.inf


def picture(*rows):
    """Grey pixels: a number each, three of them where the channels differ."""
    return np.array([[np.broadcast_to(pixel, 3) for pixel in row] for row in rows], dtype=np.float32)


# ---- Figures


def test_equal_pictures_do_not_differ():
    a = picture([0, 0.5, 1.5])
    found = compare_pixels(a, a.copy())
    assert (found.width, found.height, found.pixels) == (3, 1, 3)
    assert (found.disagreeing, found.not_finite, found.mean, found.rms) == (0, 0, 0, 0)
    assert found.largest.difference == 0


def test_figures_by_hand():
    reference = picture([0, 0], [0, 0])
    test = picture([(0.5, 0, 0), 0], [(0, -0.25, 0), 1 / 256])
    found = compare_pixels(reference, test)
    assert found.disagreeing == 2
    assert found.disagreeing_percent == 50
    assert found.mean == pytest.approx((0.5 + 0.25 + 3 / 256) / 12)
    assert found.rms == pytest.approx(math.sqrt((0.25 + 0.0625 + 3 / 256**2) / 12))
    largest = found.largest
    assert (largest.x, largest.y, largest.channel, largest.difference) == (0, 0, 0, 0.5)
    assert largest.reference == (0, 0, 0)
    assert largest.test == (0.5, 0, 0)


def test_x_counts_columns_and_y_rows():
    reference, test = np.zeros((2, 3, 5, 3), dtype=np.float32)
    test[1, 4, 2] = 1
    largest = compare_pixels(reference, test).largest
    assert (largest.x, largest.y, largest.channel) == (4, 1, 2)


def test_neighbouring_levels_of_8_bits_agree_and_others_do_not():
    levels = (np.arange(256, dtype=np.float64) / 255).astype(np.float32).reshape(1, 256, 1).repeat(3, axis=2)
    assert compare_pixels(levels[:, :-1], levels[:, 1:]).disagreeing == 0
    assert compare_pixels(levels[:, :-2], levels[:, 2:]).disagreeing == 254
    assert pytest.approx(1 / 255, rel=1e-4) == LIMIT


@pytest.mark.parametrize(("one", "other"), [(NAN, 0.5), (0.5, NAN), (NAN, NAN), (INF, 0.5), (INF, INF), (INF, -INF)])
def test_what_is_not_finite_disagrees_and_is_the_largest(one, other):
    reference, test = picture([0.5, 0.5, one]), picture([0.5, 0.7, other])
    found = compare_pixels(reference, test)
    assert found.disagreeing == 2
    assert found.not_finite == 1
    assert found.largest.x == 2
    assert found.largest.difference == INF
    assert found.mean == pytest.approx(0.1)  # of the finite ones
    assert found.rms == pytest.approx(0.2 / math.sqrt(2))


def test_nothing_finite_at_all():
    found = compare_pixels(picture([NAN]), picture([NAN]))
    assert (found.disagreeing, found.mean, found.rms) == (1, 0, 0)


def test_clamping_makes_overexposed_pixels_equal_and_keeps_nan():
    reference, test = picture([3.0, INF, NAN, -1]), picture([3.1, INF, NAN, -2])
    assert compare_pixels(reference, test).disagreeing == 4
    assert compare_pixels(clamped(reference), clamped(test)).disagreeing == 1


def test_sizes_are_compared_first():
    with pytest.raises(SizeMismatch, match="the sizes differ: 4 x 2 and 2 x 4 pixels"):
        compare_pixels(np.zeros((2, 4, 3), np.float32), np.zeros((4, 2, 3), np.float32))
    with pytest.raises(SizeMismatch):
        flip_map(np.zeros((2, 4, 3), np.float32), np.zeros((2, 5, 3), np.float32))


def test_difference_is_nan_only_where_a_value_is_not_finite():
    difference = absolute_difference(picture([INF, 0.25]), picture([INF, 0.5]))
    assert np.isnan(difference[0, 0]).all()
    assert (difference[0, 1] == 0.25).all()


# ---- FLIP


def test_flip_is_zero_for_equal_pictures_and_grows():
    rng = np.random.default_rng(1)
    a = rng.random((20, 30, 3), dtype=np.float32)
    small, large = (np.clip(a + amount, 0, 1).astype(np.float32) for amount in (0.02, 0.3))
    assert flip_map(a, a).max() < 1e-3
    assert 0 < flip_map(a, small).mean() < flip_map(a, large).mean() <= 1


def test_flip_of_black_and_white_is_nearly_one():
    black, white = np.zeros((8, 8, 3), np.float32), np.ones((8, 8, 3), np.float32)
    assert flip_map(black, white).mean() > 0.9


def test_flip_looks_at_clamped_pictures_and_counts_nan_as_wholly_wrong():
    a, b = picture([0.5, 3.0, NAN]), picture([0.5, 9.0, NAN])
    assert flip_map(a, b)[0, 2] == 1
    assert flip_map(a[:, :2], b[:, :2]).max() < 1e-3


# ---- Report


def report_of(reference, test, limit=0.1, timings=None):
    return make_report(Pictures("one", "other", reference, test, timings or {}), limit)


def test_they_agree_up_to_the_limit():
    reference, test = np.zeros((2, 10, 10, 3), np.float32)
    test[0, 0] = 1
    assert report_of(reference, test, 1.0).agrees
    assert not report_of(reference, test, 0.99).agrees
    assert verdict(report_of(reference, test, 0.5)) == "NO AGREEMENT: 1 % of the pixels disagree, up to 0.5 % may"


def test_rows_tell_of_clamping_where_it_matters():
    rows = dict(difference_rows(report_of(picture([0.5, 3.0]), picture([0.5, 4.0]))))
    assert rows["pixels that disagree"] == "1 of 2, 50 %"
    assert rows["  clamped to 0..1"] == "0"  # its largest difference, the row below that of the disagreeing ones
    assert "not finite" not in str(rows)
    plain = dict(difference_rows(report_of(picture([0.5, 1.0]), picture([0.5, 0.0]))))
    assert "  clamped to 0..1" not in plain
    assert plain["largest difference"] == "1 in red at (1, 0)"


def test_rows_tell_of_nan():
    rows = dict(difference_rows(report_of(picture([0.5, NAN]), picture([0.5, 0.0]))))
    assert rows["pixels not finite"] == "1"
    assert rows["largest difference"] == "not finite in red at (1, 0)"


def test_timing_table_and_json():
    timings = {"native-double": Timing(0.5, [0.1, 0.3, 0.2], {"build": 0.1}), "mitsuba": Timing(2.0)}
    header, rows = timing_rows(timings)
    assert header == ["", "first run", "warm (median of 3)", "stages of the first run"]
    assert rows[0] == ["native-double", "0.500 s", "0.200 s", "build 0.100"]
    found = to_json(report_of(picture([0, 1]), picture([0, 0]), timings=timings))
    assert found["seconds"]["native-double"] == {
        "cold": 0.5,
        "warm_median": 0.2,
        "warm": [0.1, 0.3, 0.2],
        "stages": {"build": 0.1},
    }
    assert found["seconds"]["mitsuba"]["warm_median"] is None
    assert found["disagreeing_percent"] == 50
    assert found["clamped"]["disagreeing"] == 1
    assert found["largest"]["x"] == 1
    assert found["agrees"] is False


# ---- Figure


def test_panels_lie_side_by_side_and_small_ones_are_enlarged():
    sheet = side_by_side((Panel("a", picture([1, 0])), Panel("b", picture([NAN, 5]))))
    width = 2 * 140
    assert sheet.shape == (28 + 140, 2 * width + 8, 3)
    assert (sheet[28:, :140] == 1).all()
    assert (sheet[28:, 140:280] == 0).all()
    assert (sheet[28:, 288:428] == 0).all()  # NaN is drawn black
    assert (sheet[28:, 428:] == 1).all()
    assert sheet[:28].max() > 0.8, "there is no label"


def test_figure_file(tmp_path):
    report = report_of(np.full((40, 300, 3), 0.5, np.float32), np.full((40, 300, 3), 0.52, np.float32))
    report.pictures.test_pixels[0, 0] = NAN
    draw_figure(report, tmp_path / "figure.png", 10)
    drawn = np.asarray(read_texture(tmp_path / "figure.png").texels)
    assert drawn.shape == (28 + 40, 4 * 308 - 8, 3)
    assert drawn[40, 10] == pytest.approx(128 / 255)
    assert drawn[40, 318] == pytest.approx(133 / 255)
    assert drawn[40, 700] == pytest.approx(51 / 255, abs=0.003)
    assert tuple(drawn[28, 616]) == NOT_FINITE


# ---- Ray trees


@pytest.fixture(scope="module")
def tree():
    from converter.scene.model import Camera, Finish, Light, Object, Scene, Solid, Sphere

    glass = Finish(0.1, 0.2, 0.3, 20, 0.2, 0.7, 1.5)
    scene = Scene(
        camera=Camera((0, 0, -9), (0, 0, 0), (0, 1, 0), 30),
        ambient=(1, 1, 1),
        lights=(Light((5, 5, -9), (1, 1, 1), (1, 0, 0)), Light((0, 0, 50), (1, 1, 1), (1, 0, 0))),
        pigments=(Solid((1, 0.5, 0.2)),),
        finishes=(glass,),
        objects=(Object(0, 0, Sphere((0, 0, 0), 1), line=12), Object(0, 0, Sphere((3, -3, -5), 1), line=13)),
    )
    return scene, NativeRenderer().trace_pixel(scene, Settings(40, 30, max_depth=3), 21, 14).rays


def test_a_tree_equals_itself(tree):
    pairs = pair_trees(tree[1], copy.deepcopy(tree[1]))
    assert first_unequal(pairs) is None
    assert sum(1 for _ in walk(pairs)) > 4


def test_float_noise_is_no_difference(tree):
    other = copy.deepcopy(tree[1])
    other[0].hit.t *= 1 + 1e-7
    other[0].local = [channel + 1e-6 for channel in other[0].local]
    other[0].radiance = [0, 0, 0]  # what a ray inherits does not count
    assert first_unequal(pair_trees(tree[1], other)) is None


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda ray: setattr(ray, "throughput", 0.5), "throughput"),
        (lambda ray: setattr(ray, "direction", [0, 0, 1]), "direction"),
        (lambda ray: setattr(ray, "hit", None), "object hit"),
        (lambda ray: setattr(ray.hit, "object", 1), "object hit"),
        (lambda ray: setattr(ray.hit, "t", ray.hit.t * 1.01), "t"),
        (lambda ray: setattr(ray.hit, "t", math.nan), "t"),
        (lambda ray: setattr(ray.hit, "entering", not ray.hit.entering), "entering"),
        (lambda ray: setattr(ray.hit, "pigment", [0, 0, 0]), "pigment"),
        (lambda ray: setattr(ray.hit, "total_reflection", True), "total reflection"),
        (lambda ray: setattr(ray.hit.lights[0], "diffuse", [9, 9, 9]), "light 1, diffuse"),
        (lambda ray: ray.hit.lights.pop(), "light 2"),
        (lambda ray: setattr(ray, "local", [0, 0, 0]), "local colour"),
        (lambda ray: setattr(ray, "dropped", {"reflected": "cutoff"}), "reflected ray dropped"),
    ],
)
def test_the_first_difference_is_found_and_named(tree, change, what):
    other = copy.deepcopy(tree[1])
    change(other[0].children[1])  # the transmitted ray; the reflected one comes first
    first = first_unequal(pair_trees(tree[1], other))
    assert first.reference.kind == "transmitted"
    assert first.unequal[0].what == what


def test_which_of_several_blockers_is_no_difference(tree):
    one, other = copy.deepcopy(tree[1]), copy.deepcopy(tree[1])
    for rays, blocker in ((one, 0), (other, 1)):
        light = rays[0].hit.lights[0]
        light.shadowed_by, light.cosine = blocker, 0.5
    assert first_unequal(pair_trees(one, other)) is None
    other[0].hit.lights[0].shadowed_by = None
    assert first_unequal(pair_trees(one, other)).unequal[0].what == "light 1, shadowed by"


def test_a_ray_that_only_one_traced(tree):
    other = copy.deepcopy(tree[1])
    del other[0].children[0]
    pairs = pair_trees(tree[1], other)
    first = first_unequal(pairs)
    assert (first.test, first.unequal[0].what) == (None, "traced")
    lines = list_rays(pairs, tree[0], ("n", "m"), first)
    assert sum(line.first for line in lines) >= 1
    assert next(line for line in lines if line.first).text.startswith(">n")


def test_listing(tree):
    scene, rays = tree
    lines = [line.text for line in list_rays(pair_trees(rays, rays), scene, ("n", "m"), None)]
    assert lines[0].split()[:3] == ["ray", "throughput", "hit"]
    assert "#0 sphere (12)" in lines[1]
    assert any("light 1 adds" in line for line in lines)
    assert any("light 2 behind" in line for line in lines)
    assert any("dropped: reflected (at the depth limit)" in line for line in lines)
    assert max(map(len, lines)) <= WIDTH
