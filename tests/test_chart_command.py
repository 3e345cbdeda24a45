"""`whitted chart`, with what little rendering it takes."""

import csv
import json

import pytest

from converter.commands import chart as command
from converter.renderers.methods import METHODS, Method
from converter.renderers.native import NativeRenderer

SCENE = """
0 0 5   0 0 0   0 1 0   40
1
0 0 0   1 1 1   1 0 0
1   solid 1 .5 .25
1   .3 .4 .3 20 .2 0 0
1
0 0 sphere 0 0 0 1
"""


@pytest.fixture
def scene(tmp_path):
    """A ball alone, whose mirror shows nothing."""
    file = tmp_path / "small.in"
    file.write_text(SCENE)
    return file


def test_chart(whitted, scene, tmp_path):
    svg, table, file = (tmp_path / name for name in ("a.svg", "a.csv", "a.json"))
    options = ("--methods", "native,native:max_depth=1", "--size", "40x30", "--runs", 2, "--csv", table, "--json", file)
    status, out, err = whitted("chart", scene, "-o", svg, *options)
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[0] == f"{scene}, 40 x 30 pixels"
    assert lines[2].split()[:2] == ["native", "0"]
    assert "seconds of a whole process" in lines
    assert any(line.startswith("against native in long double, no cut-off, depth 64") for line in lines)
    assert svg.read_bytes().startswith(b"<?xml")
    assert [line["method"] for line in csv.DictReader(table.open())] == ["native", "native:max_depth=1"]
    assert len(json.loads(file.read_text())["scenes"][0]["methods"][0]["all_runs"]) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "a.json", "a.svg", "small.in"]


def test_chart_of_certified_pixels(whitted, scene, tmp_path):
    options = ("--methods", "native,native:max_depth=0", "--size", "40x30", "--runs", 2, "--error", "certified")
    status, out, err = whitted("chart", scene, "-o", tmp_path / "a.svg", *options)
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[1].split()[:2] == ["wrong", "RMS"]
    assert lines[2].split()[:2] == ["native", "0"]
    assert int(lines[3].split()[1]) > 100
    assert "certified: 1200 pixels" in lines
    assert "certified pixels that are wrong" in (tmp_path / "a.svg").read_text()


def test_certified_pixels_are_of_scenes_that_are_not_sampled(whitted, scene, tmp_path):
    soft = tmp_path / "soft.in"
    text = scene.read_text().replace(
        "1\n0 0 0   1 1 1   1 0 0\n", "2\n0 0 0   1 1 1   1 0 0\n0 9 9   1 1 1   1 0 0   2\n"
    )
    soft.write_text(text)
    for words, message in (([soft], "of scenes that are not sampled"), ([scene, "--adaptive"], "not with --adaptive")):
        status, _, err = whitted("chart", *words, "-o", tmp_path / "a.svg", "--error", "certified", "-q")
        assert status == 2
        assert message in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "the following arguments are required: -o/--out"),
        (["-o", "a.svg"], "the following arguments are required: SCENE"),
        (["small.in", "-o", "a.pdf"], "argument -o/--out: must end in .svg or .png, found 'a.pdf'"),
        (["small.in", "-o", "nowhere/a.svg"], "nowhere/a.svg: there is no folder 'nowhere'"),
        (["small.in", "-o", "a.svg", "--csv", "nowhere/a.csv"], "nowhere/a.csv: there is no folder 'nowhere'"),
        (["small.in", "-o", "a.svg", "--json", "nowhere/a.json"], "nowhere/a.json: there is no folder 'nowhere'"),
        (
            ["small.in", "-o", "a.svg", "--size", "40"],
            "argument --size: must be WIDTHxHEIGHT, such as 800x600, found '40'",
        ),
        (["small.in", "-o", "a.svg", "--size", "0x3"], "argument --size: must lie between 1 and 1000000, found 0"),
        (["small.in", "-o", "a.svg", "--runs", "1"], "argument --runs: must lie between 2 and 1000, found 1"),
        (["small.in", "-o", "a.svg", "--methods", "native,nativ"], "argument --methods: there is no method 'nativ'"),
        (
            ["small.in", "-o", "a.svg", "--methods", "native", "--variant", "auto"],
            "--variant is for Mitsuba, and native",
        ),
        (["small.in", "-o", "a.svg", "--cutoff", "0"], "unrecognized arguments: --cutoff 0"),
        (["none.in", "-o", "a.svg"], "none.in: there is no such file"),
    ],
)
def test_chart_usage(whitted, scene, tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    status, out, err = whitted("chart", *words)
    assert (status, out) == (2, "")
    assert message in err
    assert [file.name for file in tmp_path.iterdir()] == ["small.in"]


def test_a_broken_scene_stops_the_chart_before_the_first_is_drawn(whitted, scene, tmp_path, monkeypatch):
    broken = tmp_path / "broken.in"
    broken.write_text(SCENE.replace("solid", "sollid"))
    monkeypatch.setattr(NativeRenderer, "render", None)
    status, _, err = whitted("chart", scene, broken, "-o", tmp_path / "a.svg")
    assert status == 2
    assert f"{broken}:5:5: " in err


def test_versus_povray_where_it_is_not(whitted, scene, tmp_path, monkeypatch):
    monkeypatch.setattr(Method, "missing", lambda self: "not installed: apt install povray")
    status, _, err = whitted("chart", scene, "-o", tmp_path / "a.svg", "--vs", "povray")
    assert (status, err) == (3, "whitted chart: --vs povray: not installed: apt install povray\n")


def chosen(*words):
    return [m.name for m in command._chosen(command.parser().parse_args(["a.in", "-o", "a.svg", *words]))]


def test_which_methods_are_charted(monkeypatch):
    monkeypatch.setattr(Method, "missing", lambda self: None)
    assert chosen() == [name for name in METHODS if name not in ("povray", "mitsuba-mixed")]
    assert chosen("--methods", "all") == [name for name in METHODS if name != "povray"]
    assert chosen("--methods", "mitsuba,native,mitsuba", "--vs", "povray") == ["mitsuba", "native", "povray"]


def test_ctrl_c_leaves_the_older_chart(whitted, scene, tmp_path, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("converter.studies.chart_figure.chart", stop)
    (tmp_path / "a.svg").write_text("older")
    options = ("--methods", "native", "--size", "8x6", "--runs", 2, "--csv", tmp_path / "a.csv")
    assert whitted("chart", scene, "-o", tmp_path / "a.svg", *options)[0] == 130
    assert (tmp_path / "a.svg").read_text() == "older"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.svg", "small.in"]


def test_none_of_the_methods_draws(whitted, scene, tmp_path, monkeypatch):
    monkeypatch.setattr(Method, "missing", lambda self: "not here")
    status, _, err = whitted("chart", scene, "-o", tmp_path / "a.svg", "--methods", "mitsuba", "--size", "8x6")
    assert status == 2
    assert f"no method draws {scene}; left out: mitsuba: not here" in err
