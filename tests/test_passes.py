"""Pictures in passes of samples: what a pass is, and what is kept of a picture that is stopped."""

import json
import zlib
from dataclasses import replace
from math import gcd, isqrt

import numpy as np
import pytest
from variant import VARIANT

from converter.renderers.base import Interrupted, ResumeError
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.renderers.partial import read_partial, write_partial
from converter.scene.settings import Settings
from converter.scene.writer import write_scene
from native_tracer.passes import ONE_PASS, passes

SETTINGS = Settings(width=24, height=18, samples=64, cutoff=1 / 16)


class Stop:
    """A `Progress` that is Ctrl-C from a share on."""

    def __init__(self, share):
        self.share = share
        self.told = []

    def __call__(self, share):
        self.told.append(share)
        if share >= self.share:
            raise KeyboardInterrupt


def stopped(renderer, scene, share=0.5, settings=SETTINGS):
    with pytest.raises(Interrupted) as caught:
        renderer.render(scene, settings, Stop(share))
    return caught.value.partial


@pytest.fixture(params=["native", "mitsuba"])
def renderer(request, monkeypatch):
    if request.param == "native":
        return NativeRenderer()
    request.getfixturevalue("mi")
    from mitsuba_plugins.integrators.pace import Pace

    monkeypatch.setattr(Pace, "rows", lambda self, width: 7)
    monkeypatch.setattr(Pace, "passes", lambda self, rays: 3)
    return MitsubaRenderer(VARIANT)


# ---- What a pass is


@pytest.mark.parametrize("n", range(1, 33))
def test_a_pass_has_a_cell_of_each_column_and_row(n):
    found = passes(n * n)
    assert sorted(cell for cells in found for cell in cells) == list(range(n * n))
    if n * n <= ONE_PASS:
        assert found == [list(range(n * n))]
        return
    for cells in found:
        assert {cell % n for cell in cells} == {cell // n for cell in cells} == set(range(n))
    step = (found[0][1] - found[0][0]) // n % n
    assert gcd(step, n) == 1


def test_no_number_of_passes_for_no_square_number():
    for samples in (0, -4, 17, 63):
        with pytest.raises(ValueError, match="square"):
            passes(samples)


def test_what_is_drawn_is_fair_after_every_pass(small_scene):
    """The mean of the passes so far is nearer to the whole than a picture with as many samples as the first has."""
    settings = replace(SETTINGS, samples=256)
    whole = np.asarray(NativeRenderer().render(small_scene, settings).pixels)
    one = np.asarray(NativeRenderer().render(small_scene, replace(settings, samples=9)).pixels)
    for share in (0.05, 0.3, 0.6):
        partial = stopped(NativeRenderer(), small_scene, share, settings)
        error = np.sqrt(np.mean((np.asarray(partial.pixels) - whole) ** 2))
        assert error < np.sqrt(np.mean((one - whole) ** 2)) < 0.05


# ---- Stopping, and going on


def test_a_picture_goes_on_from_its_passes(renderer, small_scene):
    whole = renderer.render(small_scene, SETTINGS)
    partial = stopped(renderer, small_scene)
    assert 0 < partial.passes.done < partial.passes.total == 8
    assert np.asarray(partial.pixels).all()
    told = []
    again = renderer.render(small_scene, SETTINGS, told.append, partial.passes)
    assert np.array_equal(np.asarray(again.pixels), np.asarray(whole.pixels))
    assert partial.passes.done / 8 < told[0] <= told[-1] == 1
    assert told == sorted(told)
    assert again.passes.done == whole.passes.done == 8
    assert again.statistics == whole.statistics


def test_what_is_kept_is_shown(renderer, small_scene):
    """A picture that is stopped before it goes on is what it was."""
    kept = stopped(renderer, small_scene).passes
    with pytest.raises(Interrupted) as caught:
        renderer.render(small_scene, SETTINGS, Stop(0), kept)
    shown, again = np.asarray(caught.value.partial.pixels), caught.value.partial.passes
    mean = np.asarray(kept.colors) / (8 * kept.done)
    if again.done == kept.done:  # Mitsuba is stopped within a pass
        assert np.array_equal(shown[-4:], mean.astype(np.float32)[-4:])
        assert np.array_equal(np.asarray(again.colors), np.asarray(kept.colors))
    assert np.sqrt(np.mean((shown - mean) ** 2)) < 0.02


def test_both_renderers_keep_the_same_sums(mi, small_scene, monkeypatch):
    from mitsuba_plugins.integrators.pace import Pace

    monkeypatch.setattr(Pace, "passes", lambda self, rays: 1)
    kept = {}
    for renderer, share in ((NativeRenderer(), 0.5), (MitsubaRenderer(VARIANT), 0.55)):
        partial = stopped(renderer, small_scene, share)
        kept[type(renderer)] = partial.passes.done, np.asarray(partial.passes.colors)
    (a, first), (b, second) = kept.values()
    assert a == b == 4
    assert first == pytest.approx(second, rel=1e-9)


def test_pixels_too_deep_are_counted_once(renderer, small_scene):
    settings = replace(SETTINGS, cutoff=0, max_depth=2)
    whole = renderer.render(small_scene, settings)
    few = renderer.render(small_scene, replace(settings, samples=16))
    partial = stopped(renderer, small_scene, 0.5, settings)
    again = renderer.render(small_scene, settings, None, partial.passes)
    counts = [r.statistics["pixels_too_deep"] for r in (few, whole, again)]
    assert 0 < counts[0] <= counts[1] == counts[2] <= 24 * 18
    everywhere = replace(partial.passes, too_deep=np.ones((18, 24), np.uint8))
    assert renderer.render(small_scene, settings, None, everywhere).statistics["pixels_too_deep"] == 24 * 18


def test_few_samples_are_one_pass(renderer, small_scene):
    settings = replace(SETTINGS, samples=16)
    with pytest.raises(Interrupted) as caught:
        renderer.render(small_scene, settings, Stop(0))
    assert caught.value.partial.passes is None


def test_an_error_that_dr_jit_makes_of_ctrl_c(mi, small_scene, monkeypatch):
    from mitsuba_plugins.integrators import launches

    def trace(*_):
        raise RuntimeError("encountered an exception") from KeyboardInterrupt()

    monkeypatch.setattr(launches, "trace", trace)
    with pytest.raises(Interrupted):
        MitsubaRenderer(VARIANT).render(small_scene, SETTINGS)


# ---- The file


@pytest.fixture
def kept(tmp_path, small_scene):
    partial = stopped(NativeRenderer(), small_scene)
    file = tmp_path / "a.ppm.partial"
    write_partial(file, partial.passes, small_scene, SETTINGS, "native")
    return file, partial.passes


def test_a_file_has_the_passes(kept, small_scene, tmp_path):
    file, passes_ = kept
    found = read_partial(file, small_scene, replace(SETTINGS, threads=3), "native")
    assert (found.done, found.total, found.notes) == (passes_.done, passes_.total, passes_.notes)
    for part in ("colors", "too_deep"):
        assert bytes(getattr(found, part)) == bytes(memoryview(getattr(passes_, part)).cast("B"))
    assert list(tmp_path.iterdir()) == [file]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"width": 25}, "with size 24 x 18, and not 25 x 18"),
        ({"samples": 49}, "with --samples 64, and not 49"),
        ({"seed": 1}, "with --seed 0, and not 1"),
        ({"cutoff": 0.5}, "with --cutoff 0.0625, and not 0.5"),
        ({"specular": "blinn"}, "with --specular phong, and not blinn"),
        ({"background": (1, 0, 0)}, "with --background .* and not"),
    ],
)
def test_other_settings_are_refused(kept, small_scene, change, message):
    with pytest.raises(ResumeError, match=f"a.ppm.partial: it was drawn {message}.*drawn anew"):
        read_partial(kept[0], small_scene, replace(SETTINGS, **change), "native")


def test_another_method_is_refused(kept, small_scene):
    with pytest.raises(ResumeError, match="with method native, and not mitsuba"):
        read_partial(kept[0], small_scene, SETTINGS, "mitsuba")


def test_another_scene_is_refused(kept, small_scene):
    camera = replace(small_scene.camera, fovy=small_scene.camera.fovy + 1e-9)
    with pytest.raises(ResumeError, match="the scene or a texture of it has changed"):
        read_partial(kept[0], replace(small_scene, camera=camera), SETTINGS, "native")


def test_damaged_files_are_refused(kept, small_scene):
    file, _ = kept
    whole = file.read_bytes()
    first, header, body = whole.split(b"\n", 2)
    other = json.loads(header) | {"done": 7}
    for content, message in (
        (b"", "no partial picture"),
        (b"P6\n24 18\n255\n", "no partial picture"),
        (first + b"\n", "header is damaged"),
        (first + b"\n{}\n", "header is damaged"),
        (first + b"\n[3]\n", "header is damaged"),
        (b"\n".join((first, json.dumps(other).encode(), body)), "damaged, or was cut short"),
        (whole[:-1], "damaged, or was cut short"),
        (whole[:-100], "damaged, or was cut short"),
        (whole + b"x", "damaged, or was cut short"),
        (whole[:-500] + bytes([whole[-500] ^ 1]) + whole[-499:], "damaged, or was cut short"),
    ):
        file.write_bytes(content)
        with pytest.raises(ResumeError, match=message):
            read_partial(file, small_scene, SETTINGS, "native")
    assert body.endswith(b"%08x\n" % zlib.crc32(header + b"\n" + body[:-9]))
    assert isqrt(SETTINGS.samples) == other["total"]


def test_another_variant_is_refused(mi, small_scene):
    partial = stopped(NativeRenderer(), small_scene).passes
    with pytest.raises(ResumeError, match="begun in elsewhere"):
        MitsubaRenderer(VARIANT).render(
            small_scene, SETTINGS, None, replace(partial, notes={"variant": "elsewhere", "samples": 8})
        )


# ---- The command


@pytest.fixture
def scene(tmp_path, small_scene):
    file = tmp_path / "small.in"
    file.write_text(write_scene(small_scene))
    return file


@pytest.fixture
def stop_at(monkeypatch):
    """Let the native tracer be stopped at a share of the picture."""
    usual = NativeRenderer.render

    def stop(share):
        monkeypatch.setattr(
            NativeRenderer,
            "render",
            lambda self, scene, settings, _, start=None: usual(
                self, scene, settings, None if share is None else Stop(share), start
            ),
        )

    return stop


def test_render_goes_on(whitted, scene, tmp_path, stop_at):
    size = (24, 18, "--samples", 64, "--method", "native")
    whitted("render", scene, tmp_path / "whole.ppm", *size)
    stop_at(0.4)
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", *size, "--keep-partial")
    assert status == 130
    assert f"a.ppm: only a part of the picture: 4 of 8 passes; --resume goes on from {tmp_path}/a.ppm.partial" in err
    assert (tmp_path / "a.ppm").exists()
    stop_at(0.8)
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", *size, "--resume")
    assert status == 130
    assert "4 of 8 passes are drawn already" in err
    assert "7 of 8 passes; --resume" in err
    assert (
        whitted("render", scene, tmp_path / "a.ppm", 24, 18, "--samples", 49, "--method", "native", "--resume")[0] == 2
    )
    stop_at(None)
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", *size, "--resume")
    assert status == 0
    assert (tmp_path / "a.ppm").read_bytes() == (tmp_path / "whole.ppm").read_bytes()
    assert not (tmp_path / "a.ppm.partial").exists()
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", *size, "--resume")
    assert status == 0
    assert "there is no" in err


def test_what_cannot_go_on(whitted, scene, tmp_path):
    status, _, err = whitted("render", scene, "-", "--resume")
    assert (status, "--resume: OUT must be a file" in err) == (2, True)
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", "--method", "povray", "--resume")
    assert (status, "--resume: povray draws a picture in one go" in err) == (2, True)


# ---- In which order pixels are drawn


@pytest.mark.parametrize(("width", "rows"), [(1, 1), (7, 3), (16, 4), (33, 10), (640, 9)])
def test_pixels_are_drawn_in_tiles(mi, width, rows):
    from mitsuba_plugins.integrators.pixels import in_tiles, place_in_tiles

    first = 11
    order = np.array(in_tiles(width, first, rows)).astype(int) - first * width
    assert sorted(order) == list(range(width * rows))
    assert np.array_equal(order[np.array(place_in_tiles(width, rows))], np.arange(width * rows))
    row, column = np.divmod(order[: 4 * width * (rows // 4)].reshape(-1, 4), width)
    assert (np.diff(row, axis=1) == 1).all()
    assert (np.diff(column, axis=1) == 0).all()
    assert set(np.diff(column[:, 0])) <= {1, 1 - width}


def test_whole_numbers_are_divided_exactly(mi):
    from mitsuba_plugins.integrators.pixels import divided

    numbers = np.random.default_rng(1).integers(0, 2**32, 4000, dtype=np.uint32)
    divisors = np.concatenate([numbers[::-1] | 1, np.array([1, 2, 3, 2**32 - 1], np.uint32)])
    multiples = (numbers[: len(divisors) // 2] // 977 * 977).astype(np.uint32)
    a = np.concatenate([numbers, multiples[:4]])
    assert np.array_equal(np.array(divided(mi.UInt32(a), mi.UInt32(divisors))), a // divisors)
    exact = mi.UInt32(multiples), mi.UInt32(np.full(len(multiples), 977, np.uint32))
    assert np.array_equal(np.array(divided(*exact)), multiples // 977)
