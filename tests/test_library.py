"""`import whitted`: it draws what the programs draw, shows it, tells how far it is, and stops when asked to."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import whitted
from converter.commands import main
from converter.images.texture import read_texture

ROOT = Path(__file__).resolve().parents[1]
FIGURE = ROOT / "scenes" / "figure1.in"
PNG = b"\x89PNG\r\n\x1a\n"


def test_every_name_is_there():
    assert [name for name in whitted.__all__ if getattr(whitted, name).__name__ != name] == []
    assert set(whitted.__all__) <= set(dir(whitted))
    with pytest.raises(AttributeError, match="no_such_name"):
        _ = whitted.no_such_name


def test_importing_loads_nothing_else():
    ask = "import sys, whitted; print(*sorted(m for m in sys.modules if m in ('numpy', 'mitsuba', 'native_tracer')))"
    told = subprocess.run([sys.executable, "-c", ask], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == ""


def test_saves_the_bytes_of_the_program(tmp_path):
    mine, theirs = tmp_path / "mine.ppm", tmp_path / "theirs.ppm"
    picture = whitted.render(whitted.load_scene(FIGURE), 64, 48, samples=4)
    picture.save(mine)
    options = ["--method", "native", "--samples", "4"]
    assert main.main(["render", str(FIGURE), str(theirs), "64", "48", *options]) == 0
    assert mine.read_bytes() == theirs.read_bytes()
    assert picture.statistics["rays"] > 64 * 48 * 4
    assert "64 x 48" in repr(picture)


def test_shows_itself(tmp_path):
    picture = whitted.render(whitted.load_scene(FIGURE), 64, 48)
    shown = tmp_path / "shown.png"
    shown.write_bytes(picture._repr_png_())
    levels = np.asarray(read_texture(shown).texels)
    assert np.abs(levels - np.clip(picture, 0, 1)).max() <= 0.51 / 255
    assert whitted.load_picture(shown).pixels.tobytes() == levels.tobytes()
    assert whitted.compare(picture, picture)._repr_png_().startswith(PNG)


def test_compares():
    scene = whitted.load_scene(FIGURE)
    picture = whitted.render(scene, 64, 48)
    same = whitted.compare(picture, whitted.render(scene, 64, 48, method="native-brute"))
    assert same.agrees
    assert same.difference.disagreeing == 0
    other = whitted.compare(picture, whitted.render(scene, 64, 48, pixel="center"))
    assert not other.agrees
    assert "NO AGREEMENT" in str(other)
    with pytest.raises(ValueError, match="sizes differ"):
        whitted.compare(picture, whitted.render(scene, 32, 24))


def test_certifies():
    scene = whitted.load_scene(FIGURE)
    certificate = whitted.certify(scene, 16, 12)
    assert certificate.certified.all()
    assert repr(certificate) == "<16 x 12 pixels, 192 certified>"
    levels = np.asarray(np.clip(whitted.render(scene, 16, 12), 0, 1) * 255 + 0.5).astype(np.uint8)
    assert not certificate.misses(levels).any()
    assert certificate.misses(levels ^ 4).all()


def test_tells_what_is_wrong():
    scene = whitted.load_scene(FIGURE)
    with pytest.raises(ValueError, match="there is no method 'natve'"):
        whitted.render(scene, method="natve")
    with pytest.raises(TypeError, match="colour"):
        whitted.render(scene, colour=1)
    with pytest.raises(whitted.SceneError, match=r"nowhere\.in"):
        whitted.load_scene("nowhere.in")
    assert "exact" in whitted.methods()["native"]


SIZES = [{"width": 0}, {"width": 1.5}, {"width": "8"}, {"height": True}, {"height": 10**9}]
NO_SETTINGS = [
    *[(given, "must be a whole number from 1 to 1000000, found") for given in SIZES],
    ({"samples": 3}, "samples must be a square number"),
    ({"samples": 4.0}, "samples must be a whole number from 1 to 65536, found 4.0"),
    ({"cutoff": -1}, "cutoff must be a finite number that is not negative, found -1"),
    ({"cutoff": float("nan")}, "cutoff must be a finite number"),
    ({"max_depth": 0.5}, "max_depth must be a whole number from 0 to"),
    ({"threads": -3}, "threads must be a whole number from 0 to 1024, found -3"),
    ({"seed": -1}, "seed must be a whole number"),
    ({"seed": None}, "seed must be a whole number"),
    ({"pixel": "centre"}, "pixel must be 'corner' or 'center', found 'centre'"),
    ({"background": "red"}, "background must be three finite numbers"),
    ({"background": (0, 0, float("inf"))}, "background must be three finite numbers"),
    ({"crop": (0, 0, 4)}, "crop must be four whole numbers"),
    ({"crop": (-1, 0, 4, 4)}, "crop must be a part of a picture of 8 x 6 pixels"),
    ({"crop": (3, 0, 3, 4)}, "crop must be a part of a picture"),
]


@pytest.mark.parametrize(("given", "message"), NO_SETTINGS)
def test_a_setting_that_makes_no_sense(given, message):
    scene = whitted.load_scene(FIGURE)
    for work in (whitted.render, whitted.certify):
        with pytest.raises(ValueError, match=message):
            work(scene, **{"width": 8, "height": 6, **given})


def test_numbers_of_numpy_are_numbers():
    scene = whitted.load_scene(FIGURE)
    picture = whitted.render(scene, np.int64(8), np.uint8(6), background=np.zeros(3), cutoff=np.float32(0.25))
    plain = whitted.render(scene, 8, 6, background=(0, 0, 0), cutoff=0.25)
    assert picture.pixels.tobytes() == plain.pixels.tobytes()


def test_what_is_no_scene_or_picture():
    scene = whitted.load_scene(FIGURE)
    picture = whitted.render(scene, 8, 6)
    for work in (whitted.render, whitted.certify):
        with pytest.raises(TypeError, match="a scene is expected, from load_scene or load_text, found str"):
            work("figure1.in", 8, 6)
        with pytest.raises(TypeError, match="progress must be a function"):
            work(scene, 8, 6, progress=5)
        with pytest.raises(TypeError, match=r"no setting 'sampels' \(did you mean 'samples'\?\)"):
            work(scene, 8, 6, sampels=4)
    with pytest.raises(TypeError, match="method must be a name"):
        whitted.render(scene, 8, 6, method=None)
    for pair in ((picture, picture.pixels), (None, picture)):
        with pytest.raises(TypeError, match="a picture is expected"):
            whitted.compare(*pair)
    with pytest.raises(ValueError, match="limit_percent must be"):
        whitted.compare(picture, picture, -1)
    with pytest.raises(ValueError, match="ulps must be a finite number"):
        whitted.certify(scene, 8, 6, ulps=-1)
    with pytest.raises(ValueError, match="a certificate is of all pixels"):
        whitted.certify(scene, 8, 6, crop=(0, 0, 4, 4))


class EnoughError(Exception):
    """What a caller raises who has seen enough."""


def test_tells_progress_and_is_stopped_by_what_that_raises():
    shares = []

    def tell(share):
        shares.append(share)
        raise EnoughError

    with pytest.raises(EnoughError):
        whitted.render(whitted.load_scene(FIGURE), 800, 600, samples=64, progress=tell)
    assert len(shares) == 1
    assert 0 <= shares[0] < 1


def test_ctrl_c_leaves_what_is_drawn():
    def interrupt(share):
        if share > 0.1:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(whitted.Stopped) as stopped:
        whitted.render(whitted.load_scene(FIGURE), 800, 600, samples=64, progress=interrupt)
    assert isinstance(stopped.value, KeyboardInterrupt)
    assert stopped.value.partial.pixels.shape == (600, 800, 3)
    assert stopped.value.partial.pixels.any()


def test_says_in_a_sentence_that_mitsuba_is_missing(monkeypatch):
    import mitsuba_plugins.backend as backend

    monkeypatch.setattr(backend, "find_spec", lambda name: None)
    with pytest.raises(whitted.RendererUnavailable, match="Mitsuba is not installed: pip install mitsuba"):
        whitted.render(whitted.load_scene(FIGURE), 8, 6, method="mitsuba")


def test_compares_where_flip_is_missing(monkeypatch):
    import converter.compare.report as report

    monkeypatch.setattr(report, "has_flip", lambda: False)
    picture = whitted.render(whitted.load_scene(FIGURE), 64, 48)
    found = whitted.compare(picture, picture)
    assert found.agrees
    assert "not measured: pip install flip-evaluator" in str(found)
    assert found._repr_png_().startswith(PNG)


def test_notebook_runs():
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    notebook = nbformat.read(ROOT / "docs" / "notebook.ipynb", as_version=4)
    kernel = nbclient.NotebookClient(
        notebook, timeout=60, kernel_name="python3", resources={"metadata": {"path": ROOT / "docs"}}
    )
    kernel.execute()
    shown = [set(output.get("data", {})) for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in kinds for kinds in shown) >= 3
