"""The chart: its parts from made-up figures."""

import csv
import io
import json
from dataclasses import replace
from itertools import combinations
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from studies_fakes import crowded_study, measured, study

from converter.renderers.methods import METHODS
from converter.studies.chart_figure import chart, draw_chart, error_scale, percent
from converter.studies.chart_report import (
    ERROR_ALIGN,
    ERROR_HEADER,
    PROCESS_ALIGN,
    PROCESS_HEADER,
    about_reference,
    error_rows,
    front_names,
    left_out_methods,
    process_rows,
    to_csv,
    to_json,
)
from converter.studies.labels import Crowd, leader, place_labels
from converter.studies.pareto import pareto_front
from converter.studies.reference import LeftOut

# ---- The Pareto front


@pytest.mark.parametrize(
    ("points", "front"),
    [
        ([], []),
        ([(1, 1)], [0]),
        ([(1, 3), (2, 2), (3, 1)], [0, 1, 2]),
        ([(3, 1), (1, 3), (2, 4)], [1, 0]),
        ([(1, 2), (1, 1), (2, 1)], [1]),
        ([(1, 1), (1, 1)], [0]),
        ([(2, 0), (1, 0), (3, 0)], [1]),
    ],
)
def test_pareto_front(points, front):
    assert pareto_front(points) == front


def test_pareto_front_by_its_definition():
    points = [tuple(map(float, p)) for p in np.random.default_rng(1).integers(0, 12, (200, 2))]
    front = {points[i] for i in pareto_front(points)}
    beaten = {p for p in points for q in points if q != p and q[0] <= p[0] and q[1] <= p[1]}
    assert front == set(points) - beaten


# ---- Names


def overlapping(boxes):
    return [
        (i, j)
        for (i, a), (j, b) in combinations(enumerate(boxes), 2)
        if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]
    ]


def test_names_do_not_overlap_and_stay_inside():
    """Thirty marks, half of them in one row a mark apart."""
    random = np.random.default_rng(3)
    anchors = np.concatenate(
        [np.stack([np.linspace(200, 320, 15), np.full(15, 150.0)], 1), random.uniform(20, 580, (15, 2))]
    )
    sizes = np.stack([random.uniform(40, 110, 30), np.full(30, 9.0)], 1)
    floor = (480.0, 20.0, 596.0, 30.0)
    boxes = place_labels(Crowd(anchors, 3.0, (0.0, 0.0, 600.0, 600.0), [floor]), sizes)
    assert not overlapping([*boxes, floor])
    assert (boxes[:, 2:] - boxes[:, :2]) == pytest.approx(sizes)
    assert boxes.min() >= 0
    assert boxes.max() <= 600
    for x, y in anchors:
        inside = (boxes[:, 0] < x) & (x < boxes[:, 2]) & (boxes[:, 1] < y) & (y < boxes[:, 3])
        assert not inside.any()


def test_a_name_alone_stands_beside_its_mark():
    crowd = Crowd(np.array([[50.0, 50.0]]), 3.0, (0.0, 0.0, 100.0, 100.0))
    (box,) = place_labels(crowd, np.array([[20.0, 8.0]]))
    x0, y0, x1, y1 = leader(crowd.anchors[0], box)
    assert (x0, y0) == (50, 50)
    assert 3 <= np.hypot(x1 - x0, y1 - y0) < 6


def test_no_names():
    assert place_labels(Crowd(np.zeros((0, 2)), 3.0, (0.0, 0.0, 1.0, 1.0)), np.zeros((0, 2))).shape == (0, 4)


# ---- The axis of errors


def test_a_logarithmic_axis_has_a_place_for_zero():
    scale = error_scale([1e-2, 3e-5, 0.0], [2e-9])
    assert (scale.low, scale.high) == (pytest.approx(1e-9), pytest.approx(1e-1))
    assert scale.bottom < scale.zero < scale.low
    assert scale.place(0.0) == scale.zero
    assert scale.place(3e-5) == 3e-5


def test_the_axis_has_no_zero_where_nothing_is():
    scale = error_scale([1e-2, 3e-5], [2e-9, 1e-5])
    assert scale.zero is None
    assert scale.bottom == scale.low
    assert error_scale([1e-2], [0.0]).zero is not None


def test_the_axis_of_nothing_but_zeros_and_of_what_is_no_number():
    scale = error_scale([0.0, 0.0], [0.0])
    assert scale.bottom < scale.place(0.0) < scale.low < scale.high
    assert error_scale([float("inf"), 1e-3], [1e-9]).place(float("inf")) == pytest.approx(1e-2)


@pytest.mark.parametrize(("share", "told"), [(1, "100 %"), (0.01, "1 %"), (0.001, "0.1 %"), (1e-5, "0.001 %")])
def test_percent(share, told):
    assert percent(share) == told


# ---- The picture


def names_in(axes):
    return {text.get_text(): text for text in axes.texts if text.get_text() in METHODS}


def test_every_method_is_named_in_each_panel_and_no_name_covers_another():
    crowded = crowded_study()
    figure = chart([crowded])
    share, rms, whole = figure.axes
    figure.draw_without_rendering()
    for axes in (share, rms):
        names = names_in(axes)
        assert set(names) == {m.method.name for m in crowded.measured}
        assert not overlapping([text.get_window_extent().extents for text in names.values()])
        frame = axes.bbox.extents
        for text in names.values():
            x0, y0, x1, y1 = text.get_window_extent().extents
            assert frame[0] <= x0 < x1 <= frame[2]
            assert frame[1] <= y0 < y1 <= frame[3]
    assert {label.get_text() for label in whole.get_yticklabels()} == set(METHODS)


def test_nothing_is_told_by_colour_alone():
    figure = chart([study(measured("native"), measured("mitsuba", rms=1e-3), measured("povray", rms=1e-2))])
    marks = [line for line in figure.axes[1].lines if line.get_marker() not in ("None", "none", "", None)]
    assert len({line.get_marker() for line in marks}) == 3
    assert len({str(line.get_markerfacecolor()) for line in marks}) == 3
    for axes in figure.axes:
        for artist in (*axes.lines, *axes.texts):
            red, green, blue = to_rgb(artist.get_color())
            assert red == green == blue
        assert axes.get_legend() is None


def test_zeros_are_drawn_in_a_row_of_their_own():
    axes = chart([study(measured("native"), measured("native-float", disagreeing=48, rms=1e-3))]).axes[0]
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels[0] == "0"
    assert "0.01 %" in labels
    heights = [line.get_ydata()[0] for line in axes.lines if line.get_marker() == "o"]
    assert heights == [axes.get_yticks()[0], pytest.approx(1e-4)]


def test_certified_pixels_take_the_place_of_the_reference():
    methods = [measured("native", disagreeing=9), measured("native-float", disagreeing=480)]
    for m, missed in zip(methods, (0, 30), strict=True):
        m.missed = missed
    found = replace(study(*methods), certified=300_000)
    axes = chart([found]).axes[0]
    assert axes.get_ylabel() == "certified pixels that are wrong"
    heights = [line.get_ydata()[0] for line in axes.lines if line.get_marker() == "o"]
    assert heights == [axes.get_yticks()[0], pytest.approx(1e-4)]
    assert not [text for text in axes.texts if "floor" in text.get_text()]
    assert [row[1] for row in error_rows(found)] == ["0", "30"]
    lines = list(csv.DictReader(io.StringIO(to_csv([found]))))
    assert [(line["certified"], line["certified_wrong"]) for line in lines] == [("300000", "0"), ("300000", "30")]


@pytest.mark.parametrize(("lost", "drawn"), [(1e-3, True), (1e-10, False)])
def test_what_the_reference_leaves_out_is_a_floor_too(lost, drawn):
    texts = [text.get_text() for text in chart([study(measured("native"), left_out=LeftOut(0.1, lost))]).axes[1].texts]
    assert "floor: double against long double" in texts
    assert ("weight that the reference leaves out" in texts) is drawn


def test_a_column_for_each_scene():
    figure = chart([study(measured("native")), study(measured("native"), file="other.in")])
    assert [axes.get_title().split(",")[0] for axes in figure.axes[:2]] == ["figure1.in", "other.in"]


def test_svg_holds_text_and_is_the_same_each_time(tmp_path):
    for name in ("a.svg", "b.svg"):
        draw_chart([study(measured("native"), measured("mitsuba-mesh", disagreeing=3, rms=1e-6))], tmp_path / name)
    svg = (tmp_path / "a.svg").read_bytes()
    assert svg == (tmp_path / "b.svg").read_bytes()
    texts = [
        "".join(e.itertext()).strip() for e in ElementTree.fromstring(svg).iter("{http://www.w3.org/2000/svg}text")
    ]
    assert texts.count("mitsuba-mesh") == 3
    assert "seconds to render, warm" in texts


def test_png(tmp_path):
    draw_chart([study(measured("native"))], tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


# ---- Tables, CSV, JSON

FIGURES = (
    measured("native", (0.1, 0.3, 0.2)),
    measured("native-float", (0.05, 0.05, 0.06), 48, 1e-3),
    measured("mitsuba", (0.4, 0.5, 0.6), 4, 1e-5),
    measured("mitsuba-cuda", skipped="no device"),
)


def test_rows_of_errors():
    assert error_rows(study(*FIGURES)) == [
        ("native", "0", "*", "0", "*", "0.200", "0.100", "0.300", "3"),
        ("native-float", "48", "*", "1.0e-03", "*", "0.050", "0.050", "0.060", "3"),
        ("mitsuba", "4", "", "1.0e-05", "", "0.500", "0.400", "0.600", "3"),
    ]
    assert len(ERROR_HEADER) == len(ERROR_ALIGN) == 9


def test_rows_of_processes():
    assert process_rows(study(*FIGURES)) == [
        ("native", "0.624", "0.300", "0.020", "0.000", "0.300", "0.004", ""),
        ("native-float", "0.574", "0.300", "0.020", "0.000", "0.250", "0.004", ""),
        ("mitsuba", "0.924", "0.300", "0.020", "0.100", "0.500", "0.004", "1.924"),
    ]
    assert len(PROCESS_HEADER) == len(PROCESS_ALIGN) == 8


def test_fronts():
    assert front_names(study(*FIGURES)) == {"share": {"native", "native-float"}, "rms": {"native", "native-float"}}


@pytest.mark.parametrize("name", ["native", "mitsuba"])
def test_stages_add_up_to_the_whole_process(name):
    m = measured(name, (0.1, 0.1, 0.1))
    assert sum(m.stages.values()) == pytest.approx(m.cold.whole)
    assert m.stages["start"] == pytest.approx(0.3)
    assert m.stages["build"] == pytest.approx(0.02)
    assert m.stages["compile"] == pytest.approx(0.2 if name == "mitsuba" else 0)
    assert m.stages["render"] == pytest.approx(0.1 if name == "mitsuba" else 0.3)


def test_left_out_methods_are_told_by_reason():
    skipped = [measured(name, skipped=why) for name, why in (("povray", "a"), ("mitsuba-cuda", "b"), ("mitsuba", "a"))]
    assert left_out_methods(study(*FIGURES[:1], *skipped)) == [
        "left out: povray, mitsuba: a",
        "left out: mitsuba-cuda: b",
    ]


@pytest.mark.parametrize(
    ("lost", "told"),
    [
        (LeftOut(0.0, 0.0), "what it leaves out is less than float32 shows"),
        (LeftOut(0.25, 1e-3), "what it leaves out weighs 1.0e-03 (RMS), at most 2.5e-01 in a pixel"),
        (None, "what it leaves out has no bound, for kr + kt > 1"),
    ],
)
def test_about_the_reference(lost, told):
    assert about_reference(study(left_out=lost)) == f"native in long double, no cut-off, depth 64; {told}"


def test_csv_has_a_line_for_every_method_on_every_scene():
    two = [study(*FIGURES), study(FIGURES[0], file="other.in")]
    lines = list(csv.DictReader(io.StringIO(to_csv(two))))
    assert [(line["scene"], line["method"]) for line in lines] == [
        *(("figure1.in", m.method.name) for m in FIGURES),
        ("other.in", "native"),
    ]
    native, single, mitsuba, cuda = lines[:4]
    assert float(native["warm"]) == 0.2
    assert (float(native["warm_least"]), float(native["warm_most"])) == (0.1, 0.3)
    assert single["disagreeing"] == "48"
    assert float(single["disagreeing_share"]) == 1e-4
    assert float(mitsuba["first_ever"]) == pytest.approx(FIGURES[2].bare.whole)
    assert float(mitsuba["cold_compile"]) == pytest.approx(0.1)
    assert native["first_ever"] == ""
    assert (cuda["skipped"], cuda["rms"], cuda["warm"]) == ("no device", "", "")


def test_json_has_every_run_and_what_it_comes_from():
    found = json.loads(json.dumps(to_json([study(*FIGURES)])))
    assert found["machine"]["cores"] >= 1
    assert {"python", "mitsuba", "whitted"} <= found["versions"].keys()
    (scene,) = found["scenes"]
    assert scene["settings"]["width"] == 800
    assert scene["reference"]["settings"]["max_depth"] == 64
    assert scene["floor"]["rms"] == 1.8e-9
    assert [m["skipped"] for m in scene["methods"]] == [None, None, None, "no device"]
    native = scene["methods"][0]
    assert [run["render"] for run in native["all_runs"]] == [0.1, 0.3, 0.2]
    assert native["cold_told"]["read"] == 0.005
    assert native["statistics"] == {"rays": 7}
