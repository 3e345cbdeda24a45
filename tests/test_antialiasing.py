"""The chart of what anti-aliasing costs: errors, rays, and POV-Ray's own ways."""

import csv
import json
import shutil
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from converter.renderers.base import Rendering
from converter.renderers.methods import METHODS
from converter.renderers.native import NativeRenderer
from converter.renderers.povray import PovrayRenderer, Supersampling
from converter.scene.settings import Settings
from converter.studies.antialiasing import LIMITS, THRESHOLDS, AntialiasingStudy, Curve, Point, measure_antialiasing
from converter.studies.antialiasing_figure import antialiasing_chart
from converter.studies.antialiasing_report import ALIGN, HEADER, rows

SMALL = Settings(width=24, height=18)


def test_a_curve_a_way(small_scene, tmp_path):
    study = measure_antialiasing(tmp_path / "a.in", small_scene, SMALL, [METHODS["native"]], 2)
    uniform, adaptive = study.curves
    assert [point.rays for point in uniform.points] == [1, 4, 16, 64]
    assert [point.name for point in adaptive.points] == [str(limit) for limit in LIMITS]
    truth, found = (
        np.clip(np.asarray(NativeRenderer().render(small_scene, replace(SMALL, samples=n)).pixels, float), 0, 1)
        for n in (256, 4)
    )
    assert uniform.points[1].rms == pytest.approx(255 * np.sqrt(np.mean((found - truth) ** 2)))
    assert all(point.rms < uniform.points[1].rms for point in adaptive.points)
    assert all(1 < point.rays < 15 for point in adaptive.points)
    assert all(len(row) == len(HEADER) == len(ALIGN) for row in rows(study))


def test_povrays_ways(small_scene, tmp_path, monkeypatch):
    """Without the program: each way once, with its rays."""
    asked = []

    def render(self, scene, settings, progress=None):
        asked.append((self.supersampling, settings.samples))
        pixels = np.full((18, 24, 3), 0.5, np.float32)
        return Rendering(pixels, 24, 18, {"render": 0.1}, {"primary": 864})

    monkeypatch.setattr(PovrayRenderer, "render", render)
    monkeypatch.setattr(shutil, "which", lambda name: f"/bin/{name}")
    study = measure_antialiasing(tmp_path / "a.in", small_scene, SMALL, [METHODS["povray"]], 1)
    assert [len(curve.points) for curve in study.curves] == [4, len(THRESHOLDS), len(THRESHOLDS)]
    assert {point.rays for curve in study.curves[1:] for point in curve.points} == {2}
    assert asked[-1] == (Supersampling(2, THRESHOLDS[-1]), 1)


@pytest.mark.skipif(shutil.which("povray") is None, reason="POV-Ray is not installed")
def test_povray_supersamples(small_scene):
    one, more = (PovrayRenderer(how).render(small_scene, SMALL) for how in (None, Supersampling(1, 0.1)))
    assert one.statistics["primary"] == 24 * 18
    assert 24 * 18 < more.statistics["primary"] < 10 * 24 * 18
    truth = np.asarray(PovrayRenderer().render(small_scene, replace(SMALL, samples=64)).pixels)
    errors = [np.abs(np.asarray(each.pixels) - truth).mean() for each in (one, more)]
    assert errors[1] < 0.5 * errors[0]


def test_the_command(whitted, scene, tmp_path):
    out, table, data = (tmp_path / name for name in ("a.svg", "a.csv", "a.json"))
    options = ("--adaptive", "--size", "24x18", "--runs", 2, "--quiet", "--csv", table, "--json", data)
    status, printed, _ = whitted("chart", scene, "-o", out, *options)
    assert status == 0
    assert "native, --adaptive" in printed
    assert "native, in every pixel" in out.read_text()
    assert len(list(csv.DictReader(table.read_text().splitlines()))) == 4 + len(LIMITS)
    assert len(json.loads(data.read_text())["scenes"][0]["ways"]) == 2


def test_names_stand_beside_their_curves_and_every_axis_has_numbers(tmp_path):
    curves = [
        Curve("whole", "native", [Point("1", 1, 7.0, 0.02), Point("64", 64, 0.7, 0.4)]),
        Curve("first", "povray", [Point("+A0.3", 3.2, 3.45, 0.09), Point("+A0.01", 7.1, 3.2, 0.13)]),
        Curve("second", "povray", [Point("+A0.3", 3.7, 3.9, 0.1), Point("+A0.01", 10, 2.6, 0.24)]),
    ]
    figure = antialiasing_chart([AntialiasingStudy(tmp_path / "a.in", SMALL, curves, [])])
    figure.draw_without_rendering()
    for axes in figure.axes:
        names = [text.get_window_extent().extents.tolist() for text in axes.texts]
        assert len(names) == 2 * len(curves)
        marks = [at for line in axes.lines for at in axes.transData.transform(line.get_xydata()).tolist()]
        assert not [at for at in marks for a in names if a[0] <= at[0] <= a[2] and a[1] <= at[1] <= a[3]]
        assert not [
            (a, b) for a, b in combinations(names, 2) if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
        ]
        for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
            assert sum(limits[0] <= at <= limits[1] for at in axis.get_majorticklocs()) >= 3
