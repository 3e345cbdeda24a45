"""`whitted compare`, `convert` and `doctor`, and file names that are no text."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from command_scenes import rendering_of
from variant import VARIANT

from converter.commands import raytrace

ON_VARIANT = ("--variant", VARIANT)


# ---- compare


def test_compare_both_renderers(whitted, scene, tmp_path, mi):
    png, file = tmp_path / "a.png", tmp_path / "a.json"
    status, out, _ = whitted("compare", scene, 40, 30, "--repeat", 2, "--png", png, "--json", file, *ON_VARIANT)
    assert status == 0
    assert "pixels that disagree  0 of 1200, 0 %" in out
    assert "warm (median of 2)" in out
    assert out.splitlines()[-1].startswith("agreement: ")
    assert png.read_bytes().startswith(b"\x89PNG")
    found = json.loads(file.read_text())
    assert found["disagreeing_percent"] == 0
    assert found["agrees"] is True
    assert list(found["seconds"]) == ["native", "mitsuba"]
    assert all(len(times["warm"]) == 2 for times in found["seconds"].values())


def test_compare_other_methods(whitted, scene):
    status, out, _ = whitted(
        "compare", scene, 40, 30, "--method", "native:max_depth=1", "--reference", "native:cutoff=0"
    )
    assert status == 1
    assert out.splitlines()[:2] == [
        "reference: native:cutoff=0, which is trusted",
        "candidate: native:max_depth=1, 40 x 30 pixels",
    ]


@pytest.fixture
def images(tmp_path):
    from converter.images.write import write_image

    for name, size, value in (("a.exr", 8, 0.5), ("b.ppm", 8, 0.5), ("c.png", 8, 0.9), ("d.exr", 4, 0.5)):
        write_image(tmp_path / name, rendering_of(size, 6, value).pixels, size, 6)
    return tmp_path


def test_compare_images_that_agree(whitted, images):
    status, out, err = whitted("compare", images / "a.exr", images / "b.ppm")
    assert (status, err) == (0, f"note: {images}/b.ppm holds no colours beyond 0..1: both are clamped\n")
    assert out.splitlines()[:2] == [
        f"reference: {images}/a.exr, which is trusted",
        f"candidate: {images}/b.ppm, 8 x 6 pixels",
    ]
    assert "seconds" not in out


def test_compare_images_that_do_not(whitted, images):
    status, out, _ = whitted("compare", images / "a.exr", images / "c.png", "--json", "-")
    assert status == 1
    assert json.loads(out)["disagreeing_percent"] == 100
    assert whitted("compare", images / "a.exr", images / "c.png", "--limit", "100")[0] == 0


def test_an_image_that_cannot_hold_more_than_white_is_compared_with_the_other_clamped(whitted, images):
    from converter.images.write import write_image

    for name in ("white.exr", "white.png"):
        write_image(images / name, rendering_of(8, 6, 3.0).pixels, 8, 6)
    assert whitted("compare", images / "white.exr", images / "white.png", "-q")[0] == 0


def test_compare_images_of_different_sizes(whitted, images):
    status, _, err = whitted("compare", images / "a.exr", images / "d.exr")
    assert (status, err) == (2, "whitted compare: the sizes differ: 8 x 6 and 4 x 6 pixels\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["a.png", "missing.png"], "missing.png: no such file"),
        (["small.in", "8"], "perhaps a picture and perhaps WIDTH HEIGHT, or two images, found 2 arguments"),
        (["small.in", "8", "6", "4"], "found 4 arguments"),
        (["small.in", "8", "x"], "WIDTH and HEIGHT: each must be a whole number, found 'x'"),
        (["small.in", "--limit", "-1"], "argument --limit: must not be negative"),
        (["small.in", "--method", "native"], "--reference and --method are both native: nothing to compare"),
        (["small.in", "--reference", "nativ"], "argument --reference: there is no method 'nativ'"),
        (["small.in", "--reference", "native:cutoff=0", "--cutoff", "1"], "--cutoff: the method native:cutoff=0 has"),
        (
            ["small.in", "--method", "native-float", "--variant", "auto"],
            "for Mitsuba, and native and native-float draw",
        ),
        (["small.in", "--png", "nowhere/a.png"], "there is no folder"),
        (["small.in", "--json", "nowhere/a.json"], "there is no folder"),
    ],
)
def test_compare_usage(whitted, images, scene, monkeypatch, words, message):
    monkeypatch.chdir(images)
    (images / "a.png").write_bytes((images / "c.png").read_bytes())
    status, _, err = whitted("compare", *words)
    assert status == 2
    assert message in err


# ---- convert, doctor


def test_convert(whitted, scene, tmp_path, mi):
    folder = tmp_path / "out"
    status, out, err = whitted("convert", scene, folder, 40, 30, "--quiet")
    assert (status, out, err) == (0, "", "")
    status, out, _ = whitted("convert", scene, folder, 40, 30)
    assert status == 0
    assert f"{folder}/scene.xml\n" in out
    python = out[out.index("import mitsuba") :]
    assert len(python.splitlines()) == 4
    assert python.splitlines()[-1] == 'mitsuba_plugins.write_image("picture.png", image)'
    assert f"load_file('{folder}/scene.xml')" in python
    assert mi.load_file(str(folder / "scene.xml")).sensors()[0].film().crop_size()[0] == 40


def test_convert_makes_no_thousands_of_shapes(whitted, tmp_path, mi):
    """Each would be a plugin of its own; the integrator draws the scene without them."""
    import numpy as np

    from converter.renderers.mitsuba import MitsubaRenderer
    from converter.scene.parser import load_scene
    from converter.scene.settings import Settings

    file = tmp_path / "large.in"
    program = Path(__file__).parent.parent / "scenes" / "large.py"
    subprocess.run([sys.executable, program, "sphereflake", "4", file], check=True)
    status, _, err = whitted("convert", file, tmp_path / "out", 80, 60)
    assert status == 0
    assert "the `whitted` integrator alone sees them" in err
    assert "<shape" not in (tmp_path / "out" / "scene.xml").read_text()
    exported = np.asarray(mi.render(mi.load_file(str(tmp_path / "out" / "scene.xml"))))
    rendered = MitsubaRenderer(VARIANT).render(load_scene(file), Settings(width=80, height=60))
    assert np.array_equal(exported, rendered.pixels)


def test_convert_refuses_a_folder_of_others(whitted, scene, tmp_path):
    status, _, err = whitted("convert", scene, tmp_path, "-q")
    assert status == 2
    assert err.startswith(f"whitted convert: {tmp_path} holds files")


def test_doctor(whitted):
    status, out, _ = whitted("doctor")
    assert status in (0, 3)
    for word in (
        "whitted",
        "Python",
        "mitsuba",
        "numpy",
        "native tracer",
        "LLVM library",
        "llvm_ad_rgb",
        "kernel cache",
    ):
        assert word in out


def test_doctor_survives_what_aborts_its_child(monkeypatch):
    from mitsuba_plugins import trial

    def dies(command, **_):
        return subprocess.CompletedProcess(command, -signal.SIGABRT, "", "LLVM ERROR: Cannot select\n")

    monkeypatch.setattr(subprocess, "run", dies)
    assert trial.try_variant("llvm_ad_rgb") == trial.Trial(
        False, "the process dies of SIGABRT: LLVM ERROR: Cannot select"
    )


# ---- Names that are no UTF-8


@pytest.fixture
def oddly_named(scene):
    r"""A scene, n\xff.in, in a folder of a name like that."""
    folder = scene.parent / os.fsdecode(b"f\xff")
    folder.mkdir()
    return scene.rename(folder / os.fsdecode(b"n\xff.in"))


def test_a_name_that_is_no_utf_8_is_drawn_into_charts_and_figures(whitted, oddly_named, tmp_path):
    csv = tmp_path / "chart.csv"
    options = ("-o", tmp_path / "chart.svg", "--csv", csv, "--size", "4x3", "--methods", "native", "--runs", 2)
    assert whitted("chart", oddly_named, *options, "-q")[0] == 0
    assert "n\ufffd.in" in csv.read_text()
    images = [oddly_named.with_suffix(suffix) for suffix in (".ppm", ".a.ppm")]
    for image in images:
        assert raytrace.main([str(oddly_named), str(image), "8", "6"]) == 0
    assert whitted("compare", *images, "--png", tmp_path / "difference.png")[0] == 0


def test_what_takes_no_such_name_says_so(whitted, oddly_named, tmp_path):
    status, _, err = whitted("render", oddly_named, oddly_named.with_suffix(".png"), 4, 3, "--method", "native", "-q")
    assert status == 2
    assert "need folders whose names are UTF-8" in err
    oddly_named.with_suffix(".png").write_bytes(b"\x89PNG\r\n\x1a\n")
    status, _, err = whitted("compare", oddly_named.with_suffix(".png"), oddly_named.with_suffix(".png"))
    assert status == 2
    assert "its name or its folder's is not UTF-8" in err
