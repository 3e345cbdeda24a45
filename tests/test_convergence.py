"""The chart of sampled scenes: how errors fall with the number of samples, and that stratified points are worth it."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from converter.renderers.base import EffectUnavailable
from converter.renderers.methods import METHODS, find_method
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere
from converter.scene.settings import Settings
from converter.scene.writer import write_scene
from converter.studies import convergence
from converter.studies.convergence import (
    ConvergenceStudy,
    Curve,
    Point,
    Truth,
    measure_convergence,
    numbers_of_samples,
)
from converter.studies.convergence_figure import convergence_chart, draw_convergence
from converter.studies.convergence_report import ALIGN, HEADER, rows, to_csv, to_json

PENUMBRA = Scene(
    Camera((0, 2, 0), (0, 0, 0), (0, 0, 1), 40),
    (0.1, 0.2, 0.3),
    (Light((0, 8, 0), (1, 1, 1), (1, 0, 0), radius=1.5),),
    (Solid((1, 0.8, 0.6)),),
    (Finish(0.2, 0.8, 0, 1, 0, 0, 0),),
    (Object(0, 0, Polyhedron(((0, 1, 0, 0),))), Object(0, 0, Sphere((0.5, 4, 0), 0.6))),
)
"""The floor below the camera, with no edges but of shadows: all errors are those of random points."""
SMALL = Settings(width=24, height=18)


def curve(name, *errors, skipped=None):
    points = [Point(4**k, error, [0.1 * 4**k, 0.12 * 4**k]) for k, error in enumerate(errors)]
    return Curve(find_method(name), skipped, points)


def study(*curves):
    return ConvergenceStudy(
        Path("a.in"), SMALL, Truth(np.zeros((18, 24, 3), np.float32), 4096, 1e-5, 3.0), list(curves)
    )


@pytest.mark.parametrize(
    ("most", "numbers"), [(1, [1]), (3, [1]), (4, [1, 4]), (100, [1, 4, 16, 64]), (256, [1, 4, 16, 64, 256])]
)
def test_numbers_of_samples(most, numbers):
    assert numbers_of_samples(most) == numbers


@pytest.mark.parametrize("power", [0.5, 0.75, 1.0])
def test_the_slope_is_the_power_with_which_errors_fall(power):
    errors = [0.3 * n**-power for n in (1, 4, 16, 64)]
    assert curve("native", *errors).slope == pytest.approx(power)
    assert curve("native", 99, *errors[1:]).slope == pytest.approx(power)  # one sample has no strata
    assert curve("native", *errors[:2]).slope is None
    assert curve("native", *errors[:3], 0.0).slope == pytest.approx(power)


def test_errors_are_those_of_the_pictures():
    methods = [find_method(name) for name in convergence.CURVES[:2]]
    told = []
    measured = measure_convergence(
        Path("a.in"),
        PENUMBRA,
        replace(SMALL, samples=64),
        methods,
        2,
        tell=lambda what, share: told.append(share),
    )
    assert [[point.samples for point in c.points] for c in measured.curves] == [[1, 4, 16, 64]] * 2
    assert measured.truth.samples == 256
    assert 0 < measured.truth.error < measured.curves[0].points[-1].rms
    picture = np.asarray(NativeRenderer().render(PENUMBRA, replace(SMALL, samples=4)).pixels, float)
    error = np.sqrt(np.square(picture - measured.truth.pixels).mean())
    assert measured.curves[0].points[1].rms == pytest.approx(np.sqrt(error**2 - measured.truth.error**2), rel=1e-5)
    assert measured.curves[0].slope > measured.curves[1].slope + 0.1
    assert measured.curves[1].slope == pytest.approx(0.5, abs=0.1)
    assert told == sorted(told)


def test_a_curve_ends_where_a_picture_would_take_too_long(monkeypatch):
    monkeypatch.setattr(convergence, "LONGEST", 0.0)
    measured = measure_convergence(Path("a.in"), PENUMBRA, replace(SMALL, samples=64), [METHODS["native"]], 2)
    assert [point.samples for point in measured.curves[0].points] == [1, 4]


def test_a_method_that_cannot_draw_a_scene_has_no_curve(monkeypatch):
    class Refuses:
        def render(self, *_):
            raise EffectUnavailable("it has a radius")

    monkeypatch.setattr(type(METHODS["native"]), "renderer", lambda self, variant: Refuses())
    measured = measure_convergence(Path("a.in"), PENUMBRA, replace(SMALL, samples=4), [METHODS["native"]], 2)
    assert [c.skipped for c in measured.curves] == ["it has a radius"]
    assert measured.drawn == []


def made_up():
    return study(
        curve("native", 0.1, 0.03, 0.01),
        curve("native:points=independent", 0.1, 0.05, 0.025),
        curve("mitsuba", skipped="no"),
    )


def test_a_row_for_every_picture():
    made = rows(made_up())
    assert len(HEADER) == len(ALIGN)
    assert made[0] == ("native", "1", "1.0e-01", "0.110", "n^-0.79")
    assert made[1] == ("", "4", "3.0e-02", "0.440", "")
    assert made[3] == ("native:points=independent", "1", "1.0e-01", "0.110", "n^-0.50")
    assert len(made) == 6


def test_csv_and_json():
    lines = list(csv.DictReader(to_csv([made_up()]).splitlines()))
    assert [(line["method"], line["samples"], line["rms"]) for line in lines[2:4]] == [
        ("native", "16", "0.01"),
        ("native:points=independent", "1", "0.1"),
    ]
    assert (lines[-1]["method"], lines[-1]["skipped"], lines[-1]["rms"]) == ("mitsuba", "no", "")
    told = json.loads(json.dumps(to_json([made_up()])))["scenes"][0]
    assert told["methods"][0]["points"][0] == {"samples": 1, "rms": 0.1, "seconds": [0.1, 0.12]}
    assert told["truth"] == {"samples": 4096, "error": 1e-5, "seconds": 3.0}


def test_the_picture_has_a_curve_a_method(tmp_path):
    over_time, over_samples = convergence_chart([made_up()]).axes
    for axes, places in ((over_time, [0.11, 0.44, 1.76]), (over_samples, [1, 4, 16])):
        drawn = {line.get_label(): line for line in axes.lines if not line.get_label().startswith("_")}
        assert [label.split(": ")[0] for label in drawn] == ["native", "native:points=independent"]
        assert list(next(iter(drawn.values())).get_xdata()) == pytest.approx(places)
        assert len({line.get_linestyle() for line in drawn.values()}) == 2
    files = [tmp_path / name for name in ("a.svg", "b.svg", "a.png")]
    for file in files:
        draw_convergence([made_up()], file)
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[2].read_bytes().startswith(b"\x89PNG")


def test_chart_of_a_sampled_scene(whitted, tmp_path):
    scene = tmp_path / "soft.in"
    scene.write_text(write_scene(PENUMBRA))
    options = ("--size", "24x18", "--samples", 16, "--methods", "native,native:points=independent", "--runs", 2)
    status, out, err = whitted("chart", scene, "-o", tmp_path / "a.svg", *options)
    assert (status, err) == (0, "")
    assert out.splitlines()[0] == f"{scene}, 24 x 18 pixels"
    assert "against native, the mean of two pictures of 64 samples with other seeds" in out
    assert (tmp_path / "a.svg").read_bytes().startswith(b"<?xml")


def test_sampled_and_plain_scenes_have_a_chart_each(whitted, scene, tmp_path):
    soft = tmp_path / "soft.in"
    soft.write_text(write_scene(PENUMBRA))
    status, _, err = whitted("chart", soft, scene, "-o", tmp_path / "a.svg")
    assert status == 2
    assert "soft.in is sampled and " in err
    assert "these need a chart each" in err
