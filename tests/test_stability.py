"""The stability study: where a method holds, the worker that draws, the table, the figure and the page."""

import json
import math
import os
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from variant import VARIANT

from converter.commands.main import main
from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.geometry import check_geometry
from converter.scene.needs import scene_needs
from converter.studies import worker as worker_module
from converter.studies.families import FAMILIES
from converter.studies.families.scenes import GLOW, WHITE, camera, scaled, scene, settings, sphere
from converter.studies.family import Case, Family
from converter.studies.stability import TRUTH, easiest, study_family
from converter.studies.stability_figure import draw_stability, lines, spread, stability_figure
from converter.studies.stability_page import write_page
from converter.studies.stability_pictures import SEEN
from converter.studies.stability_report import failures, number, silences, table_header, table_rows, to_json
from converter.studies.svg import compact
from converter.studies.worker import CERTIFICATE, DrawingFailed, TookTooLong, Worker

SMALL = settings(4, 2)
BALL = scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0)), [(sphere((0.0, 0.0, 0.0), 1.0), WHITE, GLOW)])
NATIVE, FLOAT, MESH = METHODS["native"], METHODS["native-float"], METHODS["mitsuba-mesh"]


def family(values=(1.0, 10.0, 100.0, 1000.0), truth=None, allowed=0.0, both_ways=False):
    black = np.zeros((2, 4, 3)) if truth is None else truth
    return Family(
        "made-up",
        "Nothing.",
        "number",
        values,
        lambda v: Case(replace(BALL, ambient=(v, v, v)), SMALL, black, allowed),
        both_ways,
    )


class Fake:
    """Draws black, with the first pixels white from a method's limit on, or fails."""

    def __init__(self, wrong, above=100.0, below=0.0, failing=None):
        self.wrong, self.above, self.below, self.failing, self.asked = wrong, above, below, failing, []

    def render(self, method, variant, scene, settings, seconds):
        value = scene.ambient[0]
        self.asked.append((method, value))
        if self.failing is not None and value >= self.above and method != "native":
            raise self.failing
        picture = np.zeros((2, 4, 3), np.float32)
        if method != "native" and (value >= self.above or value <= self.below):
            picture.reshape(-1, 3)[: self.wrong] = np.nan if self.wrong == 7 else 1.0
        return picture


def row(study):
    return table_rows([study])[0][1:]


@pytest.mark.parametrize("wrong", [1, 7])
def test_a_method_holds_up_to_its_first_wrong_picture(wrong):
    study = study_family(family(), [NATIVE, FLOAT], Fake(wrong))
    assert row(study) == ("all", "10")
    assert table_header([study]) == ("", "native", "native-float")
    assert study.first_failures("native") == []
    assert study.first_failures("native-float") == [2]
    assert [outcome.share for outcome in study.outcomes["native-float"]] == [0, 0, wrong / 8, wrong / 8]
    # Only a picture that fails first is kept.
    assert [outcome.pixels is not None for outcome in study.outcomes["native-float"]] == [False, False, True, False]


def test_what_may_differ_may_differ():
    assert row(study_family(family(allowed=0.125), [FLOAT], Fake(1))) == ("all",)
    assert row(study_family(family(allowed=0.125), [FLOAT], Fake(2))) == ("10",)


def test_a_method_may_fail_from_the_start():
    assert row(study_family(family(), [FLOAT], Fake(1, above=0.0))) == ("none",)


@pytest.mark.parametrize(
    ("above", "below", "held"),
    [
        (1e3, 0.0, "0.01 ... 10"),
        (1e9, 1e-2, "1 ... 1e+04"),
        (1e3, 1e-2, "1 ... 10"),
        (1.0, 0.0, "none"),
        (1e9, 0, "all"),
    ],
)
def test_a_method_may_fail_on_either_side(above, below, held):
    values = (1e-2, 1.0, 10.0, 1e3, 1e4)
    study = study_family(family(values, both_ways=True), [FLOAT], Fake(1, above, below))
    assert row(study) == (held,)


def test_the_easiest_value_is_the_first_or_nearest_one():
    assert easiest(family(), (5.0, 1.0)) == 0
    assert easiest(family(both_ways=True), (1e-6, 0.3, 40.0)) == 1


def test_a_method_that_takes_too_long_is_not_asked_for_more():
    fake = Fake(1, failing=TookTooLong("no picture within 40 s of CPU time"))
    study = study_family(family(), [NATIVE, FLOAT], fake)
    assert row(study) == ("all", "10")
    assert ("native-float", 100.0) in fake.asked
    assert ("native-float", 1000.0) not in fake.asked
    assert failures([study]) == [
        "no picture: made-up, native-float at 100: no picture within 40 s of CPU time",
        "no picture: made-up, native-float at 1000: not asked, for an easier one took too long",
    ]


def test_a_method_that_fails_is_asked_again():
    fake = Fake(1, failing=DrawingFailed("ValueError: no"))
    study = study_family(family(), [FLOAT], fake)
    assert fake.asked[-1] == ("native-float", 1000.0)
    assert [outcome.share for outcome in study.outcomes["native-float"]] == [0, 0, 1, 1]


def test_what_is_proven_is_the_truth_and_what_is_drawn_where_nothing_is():
    class Proves(Fake):
        def render(self, method, variant, scene, settings, seconds):
            if method == CERTIFICATE:
                proven = np.full((2, 4, 3), 1.0, np.float32)
                proven[:, int(scene.ambient[0]) :] = np.nan
                return proven
            if method == TRUTH:
                self.asked.append((method, scene.ambient[0]))
                return np.full((2, 4, 3), 0.5, np.float32)
            return super().render(method, variant, scene, settings, seconds)

    made, fake = family((1.0, 3.0, 4.0)), Proves(0)
    unknown = replace(made, case=lambda value: replace(made.case(value), truth=None))
    study = study_family(unknown, [NATIVE], fake)
    kept = next(outcome for outcome in study.outcomes["native"] if outcome.truth is not None)
    assert kept.truth[:, :, 0].tolist() == [[1.0, 0.5, 0.5, 0.5]] * 2
    assert [value for method, value in fake.asked if method == TRUTH] == [1.0, 3.0]


def test_without_a_truth_there_is_no_outcome():
    class Broken(Fake):
        def render(self, method, variant, scene, settings, seconds):
            if method in (TRUTH, CERTIFICATE):
                raise DrawingFailed("not enough memory")
            return super().render(method, variant, scene, settings, seconds)

    made = family()
    unknown = replace(made, case=lambda value: replace(made.case(value), truth=None))
    study = study_family(unknown, [NATIVE], Broken(0))
    assert study.outcomes["native"] == ()
    assert row(study) == ("",)
    assert failures([study]) == ["no picture: made-up, all methods at 1, 10, 100, 1000: no truth: not enough memory"]
    assert json.loads(json.dumps(to_json([study])))["families"][0]["broken"][0]["value"] == 1.0
    stability_figure([study])


def test_every_figure_is_told():
    study = study_family(family(), [NATIVE, FLOAT], Fake(2))
    told = json.loads(json.dumps(to_json([study])))["families"][0]
    assert told["family"] == "made-up"
    method = told["methods"][1]
    assert (method["method"], method["holds"], method["held"]) == ("native-float", "10", [1.0, 10.0])
    assert [outcome["share"] for outcome in method["outcomes"]] == [0, 0, 0.25, 0.25]
    assert method["outcomes"][2]["difference"]["disagreeing"] == 2


@pytest.mark.parametrize(("value", "told"), [(1e-6, "1e-06"), (0.001, "0.001"), (179.99, "179.99"), (1e6, "1e+06")])
def test_numbers_are_short(value, told):
    assert number(value) == told


# ---- The worker


def test_a_worker_draws_what_the_method_draws():
    with Worker() as worker:
        drawn = worker.render("native", None, BALL, SMALL, 60.0)
        assert (drawn == np.asarray(NativeRenderer().render(BALL, SMALL).pixels)).all()
        with pytest.raises(DrawingFailed, match="ValueError"):
            worker.render("native", None, BALL, replace(SMALL, samples=3), 60.0)
        # It lives on.
        assert (worker.render("native", None, BALL, SMALL, 60.0) == drawn).all()
        assert np.allclose(worker.render(CERTIFICATE, None, BALL, SMALL, 60.0), drawn, atol=1e-6)


def test_a_worker_that_takes_too_long_or_dies_is_replaced():
    with Worker() as worker:
        huge = replace(SMALL, width=16384, height=16384)
        with pytest.raises(TookTooLong, match=r"^no picture within 0\.5 s of CPU time$"):
            worker.render("native-long-double", None, BALL, huge, 0.5)
        worker.render("native", None, BALL, SMALL, 60.0)
        os.kill(worker._process.pid, 9)
        with pytest.raises(DrawingFailed, match="its process ended: SIGKILL"):
            worker.render("native", None, BALL, SMALL, 60.0)
        assert worker.render("native", None, BALL, SMALL, 60.0).shape == (2, 4, 3)
    assert worker._process is None


def test_a_worker_may_wait_longer_than_it_may_work_but_not_for_ever(monkeypatch):
    """A stopped process takes no CPU time, as one that has to wait for others."""
    with Worker() as worker:
        worker.render("native", None, BALL, SMALL, 60.0)
        process = worker._process.pid
        os.kill(process, signal.SIGSTOP)
        waiting = threading.Timer(1.5, os.kill, (process, signal.SIGCONT))
        waiting.start()
        assert worker.render("native", None, BALL, SMALL, 1.0).shape == (2, 4, 3)
        waiting.join()
        os.kill(process, signal.SIGSTOP)
        monkeypatch.setattr(worker_module, "PATIENCE", 0.5)
        with pytest.raises(TookTooLong, match=r"^no picture within 0\.25 s$"):
            worker.render("native", None, BALL, SMALL, 0.5)
        assert worker.render("native", None, BALL, SMALL, 60.0).shape == (2, 4, 3)


def test_what_a_method_starts_takes_time_too():
    class Starts:
        def render(self, scene, settings):
            subprocess.run([sys.executable, "-c", "import time\nwhile time.process_time() < 0.6: pass"], check=True)
            return NativeRenderer().render(scene, settings)

    def drawn(seconds):
        return worker_module._draw({("povray", None): Starts()}, "povray", None, BALL, SMALL, seconds)

    assert isinstance(drawn(0.5), TookTooLong)
    assert drawn(60.0).shape == (2, 4, 3)


# ---- The families


PLANES_COME_AND_GO = {"faces", "near-copies", "touching-planes"}
"""Families that are about how many faces there are."""
NO_FILE = {"empty"}
"""Families of scenes that a file may not hold."""
CHAOTIC = {"trapped-ray": 40.0}
"""Families without decades, with the last value up to which the digits of double precision suffice."""


@pytest.mark.parametrize("made", FAMILIES.values(), ids=list(FAMILIES))
def test_a_family_makes_sense(made):
    """Its scenes are scenes, of one structure, and its true pictures have as many pixels as they say."""
    assert made.about.endswith(".")
    rising, falling = sorted(made.values), sorted(made.values, reverse=True)
    assert list(made.values) in ([rising] if made.both_ways else [rising, falling])
    structures = set()
    for value in made.values:
        case = made.case(value)
        assert bool(check_geometry(case.scene)) == (made.name in NO_FILE)
        needs = scene_needs(case.scene, case.settings)
        planes = None if made.name in PLANES_COME_AND_GO else needs.planes
        structures.add((needs.reflects, needs.refracts, needs.branches, needs.lit, needs.glossy, planes))
        assert case.truth is None or case.truth.shape == (case.settings.height, case.settings.width, 3)
        assert case.settings.width * case.settings.height <= 10000
    assert len(structures) == 1


@cache
def case_of(name, value):
    """A family's case with its truth, which several tests compare with."""
    case = FAMILIES[name].case(value)
    if case.truth is not None:
        return case
    return replace(case, truth=np.asarray(NativeRenderer("long double").render(case.scene, case.settings).pixels))


def wrong_share(case, renderer):
    """Share of the pixels that a renderer draws wrong."""
    drawn = np.asarray(renderer.render(case.scene, case.settings).pixels)
    return (~(np.abs(drawn - case.truth) <= LIMIT).all(axis=2)).mean()


@pytest.mark.parametrize("made", FAMILIES.values(), ids=list(FAMILIES))
def test_the_native_tracer_in_double_holds_for_six_decades_at_least(made):
    """From the easiest value on, or over all of a family that is shorter."""
    start = easiest(made, made.values)
    for value in made.values:
        decades = 1e-6 * made.values[start] <= value <= 1e6 * made.values[start]
        if (decades or value == 0) and value <= CHAOTIC.get(made.name, value):
            case = case_of(made.name, value)
            assert wrong_share(case, NativeRenderer()) <= case.allowed, f"{made.name} {value:g}"


@pytest.mark.parametrize("intersections", ["auto", "bvh"])
@pytest.mark.parametrize("made", FAMILIES.values(), ids=list(FAMILIES))
def test_mitsuba_in_double_holds_for_three_decades_at_least(made, intersections):
    renderer = MitsubaRenderer(VARIANT, intersections)
    start = easiest(made, made.values)
    for value in made.values:
        decades = 1e-3 * made.values[start] <= value <= 1e3 * made.values[start]
        if (decades or value == 0) and value <= CHAOTIC.get(made.name, value):
            case = case_of(made.name, value)
            assert wrong_share(case, renderer) <= case.allowed, f"{made.name} {value:g}"


def sized(case, power):
    """A case 2^power times as large, which is the same to the last bit."""
    return replace(case, scene=scaled(case.scene, 2.0**power))


@pytest.mark.parametrize("made", FAMILIES.values(), ids=list(FAMILIES))
def test_a_family_holds_at_every_size(mi, made):
    """The easiest scene, and the hardest ones that have to hold: native from 1e-6 to 1e6, Mitsuba from 1e-3 to 1e3."""
    start = easiest(made, made.values)
    for renderer, decades, powers in (
        (NativeRenderer(), 1e6, (-20, 20)),
        (MitsubaRenderer(VARIANT), 1e3, (-10, 10)),
    ):
        last = CHAOTIC.get(made.name, math.inf)
        held = [v for v in made.values if made.values[start] / decades <= v <= min(made.values[start] * decades, last)]
        for value in {made.values[start], held[0], held[-1]}:
            for power in powers:
                case = sized(case_of(made.name, value), power)
                assert wrong_share(case, renderer) <= case.allowed, f"{made.name} {value:g} times 2^{power}"


# ---- The figure and the page


def made_studies():
    fakes = [Fake(1), Fake(2, above=10.0), Fake(3, failing=DrawingFailed("no"))]
    return [
        replace_name(study_family(family(), [NATIVE, METHODS["mitsuba"], FLOAT], fake), k)
        for k, fake in enumerate(fakes)
    ]


def replace_name(study, k):
    return replace(study, family=replace(study.family, name=f"made-up-{k}"))


def test_methods_that_do_the_same_share_a_line():
    study = study_family(family(), [NATIVE, FLOAT, MESH], Fake(1))
    assert [(line.names, line.first_failures) for line in lines(study)] == [
        (("native",), ()),
        (("native-float", "mitsuba-mesh"), (2,)),
    ]


def test_every_family_has_a_panel_and_every_method_a_name_that_covers_no_other():
    studies = made_studies()
    figure = stability_figure(studies)
    figure.draw_without_rendering()
    assert [axes.get_title(loc="left") for axes in figure.axes] == [study.family.name for study in studies]
    for axes, study in zip(figure.axes, studies, strict=True):
        names = [text for text in axes.texts if text.get_position()[0] > 1]
        assert {n.strip() for text in names for n in text.get_text().split(",")} == set(study.outcomes)
        extents = sorted(text.get_window_extent().extents.tolist() for text in names)
        assert all(a[3] <= b[1] or b[3] <= a[1] for a, b in pairwise(extents))
        crosses = [line.get_xdata().tolist() for line in axes.lines if line.get_marker() == "x"]
        failing = [study.family.values[i] for method in ("native-float",) for i in study.first_failures(method)]
        assert failing in crosses


def test_zero_is_a_decade_beyond_the_other_values():
    figure = stability_figure([study_family(family((1.0, 0.1, 0.01, 0.0)), [NATIVE], Fake(0))])
    (axes,) = figure.axes
    (line,) = [line for line in axes.lines if line.get_zorder() == 3]
    assert line.get_xdata().tolist() == [1.0, 0.1, 0.01, 0.001]
    assert axes.get_xticklabels()[-1].get_text() == "0"


def test_a_method_has_one_line_in_all_panels_and_none_is_like_another():
    figure = stability_figure(made_studies())
    (legend,) = figure.legends
    entries = dict(zip((text.get_text() for text in legend.get_texts()), legend.get_lines(), strict=True))
    assert list(entries) == ["native", "mitsuba", "native-float", "fails here first"]
    looks = {(line.get_color(), line.get_linestyle()): name for name, line in entries.items()}
    assert len(looks) == len(entries)
    for axes in figure.axes:
        drawn = [looks[line.get_color(), line.get_linestyle()] for line in axes.lines if line.get_zorder() == 3]
        named = [text for text in axes.texts if text.get_position()[0] > 1]
        assert sorted(drawn) == sorted(text.get_text().split(",")[0] for text in named)
        for text in named:
            assert text.get_color() == entries[text.get_text().split(",")[0]].get_color()


def test_dashes_lie_over_lines_without():
    figure = stability_figure([study_family(family(), [FLOAT, NATIVE], Fake(1))])
    (axes,) = figure.axes
    drawn = [line.get_linestyle() for line in axes.lines if line.get_zorder() == 3]
    assert drawn == ["-", "--"]


def test_axes_are_named_and_the_legend_covers_no_panel():
    for studies in (made_studies()[:1], made_studies()):
        figure = stability_figure(studies)
        figure.draw_without_rendering()
        (legend,) = figure.legends
        box = legend.get_window_extent()
        for axes, study in zip(figure.axes, studies, strict=True):
            assert (axes.get_xlabel(), axes.get_ylabel()) == (study.family.stress, "wrong pixels")
            assert axes.get_tightbbox().y1 <= box.y0
        assert 0 <= box.x0 < box.x1 <= figure.bbox.x1
        assert box.y1 <= figure.bbox.y1


@pytest.mark.parametrize(
    ("places", "sizes", "ceiling", "spread_out"),
    [
        ([10.0, 50.0], [10.0, 10.0], 100.0, [10.0, 50.0]),
        ([10.0, 10.0], [10.0, 10.0], 100.0, [5.0, 15.0]),
        ([100.0, 100.0], [10.0, 10.0], 100.0, [85.0, 95.0]),
        ([12.0, 10.0, 40.0], [10.0, 10.0, 10.0], 100.0, [16.0, 6.0, 40.0]),
        ([], [], 100.0, []),
    ],
)
def test_names_are_spread(places, sizes, ceiling, spread_out):
    assert spread(places, sizes, ceiling) == pytest.approx(spread_out)


def test_the_chart_is_small_the_same_each_time_and_holds_its_text(tmp_path):
    studies = made_studies()
    for name in ("a.svg", "b.svg"):
        draw_stability(studies, tmp_path / name)
    svg = (tmp_path / "a.svg").read_bytes()
    assert svg == (tmp_path / "b.svg").read_bytes()
    assert len(svg) < 6000 * len(studies)
    texts = ["".join(e.itertext()) for e in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")]
    assert "made-up-0" in texts
    assert "native" in texts
    draw_stability(studies, tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_compact_picture_has_its_styles_as_classes_and_no_groups_that_say_nothing():
    path = '<path d="M 1.23456 2" style="fill: none"/>'
    group = f'<g id="text_7">\n  {path}\n </g>\n <g id="line2d_3"/>'
    assert compact(f'<svg>\n <defs>\n </defs>\n <g id="a">\n {group}\n {path}\n </g>\n</svg>') == (
        '<svg>\n <style>.s0{fill: none}</style><defs>\n</defs>\n<g id="a">\n'
        '<path d="M 1.2 2" class="s0"/>\n<path d="M 1.2 2" class="s0"/>\n</g>\n</svg>'
    )


def test_the_page_has_chart_table_and_pictures(tmp_path):
    studies = made_studies()
    position = replace(studies[1], family=replace(studies[1].family, name="position"))
    write_page([*studies, position], tmp_path)
    page = (tmp_path / "stability.md").read_text()
    assert "| made-up-0 | all | 10 | 10 |" in page
    assert "A method has 40 s of CPU time for a picture" in page
    assert "](stability.svg)" in page
    assert "](stability-failures.png)" in page
    assert "| position | 10 | native-float | mirrors and glass show the sky" in page
    assert {file.name for file in tmp_path.iterdir()} == {"stability.md", "stability.svg", "stability-failures.png"}


def test_a_page_on_what_nothing_fails_in_has_no_pictures(tmp_path):
    write_page([study_family(family(), [NATIVE], Fake(0))], tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {"stability.md", "stability.svg"}
    assert "stability-failures" not in (tmp_path / "stability.md").read_text()


def test_failures_that_come_without_a_warning_are_told():
    fake = Fake(2, above=10.0)
    studies = [study_family(family(), [NATIVE, FLOAT], fake)]
    assert silences(studies) == ["no warning: made-up, native-float at 10, 100, 1000"]
    assert to_json(studies)["families"][0]["methods"][1]["outcomes"][1]["warned"] is False
    few = [study_family(family(allowed=0.25), [NATIVE, FLOAT], fake)]
    assert silences(few) == ["wherever a method gets more than 1% of the pixels wrong, a warning says so beforehand"]


UNSEEN = {"faces", "flight"}
"""Families that some methods refuse, and the others draw as they should."""


def test_the_page_of_the_project_shows_every_failure():
    """docs/stability.md: each family of the table in which some method fails is among the pictures, and no other."""
    page = (Path(__file__).parents[1] / "docs" / "stability.md").read_text()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.splitlines() if line.startswith("| ")]
    table = [row for row in rows if row[0] in FAMILIES and len(row) > 4]
    shown = [row[0] for row in rows if row[0] in SEEN and len(row) == 4]
    assert [row[0] for row in table] == list(FAMILIES)
    methods = next(row[1:] for row in rows if row[0] == "" and "native" in row)
    holds = {row[0]: dict(zip(methods, row[1:], strict=True)) for row in table}
    for family, limits in holds.items():
        # Where a method is not for a scene there is no picture of it; POV-Ray may be missing where the page is made.
        fails = any(limit != "all" for method, limit in limits.items() if method != "povray")
        assert family in SEEN or family in UNSEEN or not fails
    assert shown == [
        family for family in holds if family in SEEN and holds[family].get(SEEN[family][0], "all") != "all"
    ]


# ---- The command


def test_the_command_draws_tells_and_writes(tmp_path, capsys):
    chart, figures = tmp_path / "a.svg", tmp_path / "a.json"
    words = ["stability", "-o", str(chart), "--json", str(figures), "--methods", "native,native-float", "-q"]
    assert main([*words, "--families", "distance"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out.splitlines()[1].split() == ["distance", "all", "1e+05"]
    assert json.loads(figures.read_text())["families"][0]["family"] == "distance"
    assert chart.exists()


def test_the_command_lists_the_families(capsys):
    assert main(["stability", "--list"]) == 0
    assert {line.split()[0] for line in capsys.readouterr().out.splitlines()[1:]} == set(FAMILIES)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "the following arguments are required: -o/--out, or --docs"),
        (["-o", "a.pdf"], "must end in .svg or .png"),
        (["-o", "a.svg", "--families", "sise"], "there is no family 'sise'"),
        (["-o", "a.svg", "--methods", "natve"], "there is no method 'natve'"),
        (["-o", "nowhere/a.svg"], "there is no folder"),
        (["--docs", "nowhere"], "there is no folder"),
        (["-o", "a.svg", "--methods", "native", "--variant", "auto"], "--variant is for Mitsuba"),
    ],
)
def test_bad_arguments(words, message, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["stability", *words]) != 0
    assert message in capsys.readouterr().err
    assert not list(Path().iterdir())
