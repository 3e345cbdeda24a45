"""The chart: its parts from made-up figures, and what little rendering it takes to see them joined."""

import csv
import io
import json
import os
import subprocess
from dataclasses import replace
from itertools import combinations
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from studies_fakes import crowded_study, difference, measured, study

from converter.commands import chart as command
from converter.files import check_target, replacing
from converter.renderers.base import RendererUnavailable, Rendering
from converter.renderers.methods import METHODS, Method
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Finish, Object, Scene, Solid, Sphere
from converter.scene.settings import Settings
from converter.studies import measure, processes
from converter.studies import reference as references
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
from converter.studies.measure import measure_scene
from converter.studies.pareto import pareto_front
from converter.studies.processes import Process, ProcessFailed, render_in_a_process
from converter.studies.reference import LeftOut, Reference, draw_reference, left_out

SMALL = Settings(width=16, height=12)

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


# ---- The reference


def facing_mirrors(kr, kt=0.0):
    """A camera in a mirrored ball: every ray bounces for ever."""
    return Scene(
        camera=Camera((0.0, 0.0, 0.5), (0.0, 0.1, -1.0), (0.0, 1.0, 0.0), 40.0),
        ambient=(1.0, 1.0, 1.0),
        lights=(),
        pigments=(Solid((0.5, 0.5, 0.5)),),
        finishes=(Finish(1.0, 0.0, 0.0, 1.0, kr, kt, 1.0),),
        objects=(Object(0, 0, Sphere((0.0, 0.0, 0.0), 2.0)),),
    )


@pytest.mark.parametrize(("depth", "cutoff"), [(0, 0.0), (3, 0.0), (64, 0.3)])
def test_what_a_series_of_mirrors_leaves_out(depth, cutoff):
    """The weights 1, kr, kr^2, ... times 1 - kr: kr^n is missing after n terms."""
    followed = depth if cutoff == 0 else 1  # 0.5 is above 0.3, 0.25 is not
    lost = left_out(facing_mirrors(0.5), replace(SMALL, max_depth=depth, cutoff=cutoff))
    assert lost.largest == lost.rms == 0.5 ** (followed + 1)


def test_what_has_no_bound():
    assert left_out(facing_mirrors(0.8, 0.3), SMALL) is None


def test_the_reference_has_no_cutoff_where_rays_do_not_split():
    reference = draw_reference(facing_mirrors(0.5), SMALL)
    assert reference.precision == "long double"
    assert (reference.settings.cutoff, reference.settings.max_depth) == (0, 64)
    assert reference.left_out.largest == 0
    assert np.asarray(reference.pixels) == pytest.approx(1.0, abs=1e-7)  # 0.5 / (1 - 0.5)


def test_the_reference_has_a_small_cutoff_where_rays_split():
    """kr and kt on a ball that a mirrored room surrounds: without a cut-off 2^64 rays a pixel."""
    scene = facing_mirrors(0.4)
    glass = Finish(0.1, 0.0, 0.0, 1.0, 0.2, 0.2, 1.0)
    scene = replace(
        scene,
        finishes=(*scene.finishes, glass),
        objects=(*scene.objects, Object(0, 1, Sphere((0.0, 0.0, -1.0), 0.4))),
    )
    reference = draw_reference(scene, SMALL)
    assert reference.settings.cutoff in references.CUTOFFS
    assert reference.left_out.rms <= references.NEGLIGIBLE


def test_a_reference_that_cannot_be_afforded_in_long_double_is_drawn_in_double(monkeypatch):
    tried = []

    def affordable(scene, settings, precision):
        tried.append(precision)
        cutoff, lost = (1 / 16, 0.01) if precision == "long double" else (1 / 256, 0.001)
        return replace(settings, cutoff=cutoff), LeftOut(lost, lost)

    monkeypatch.setattr(references, "_affordable", affordable)
    reference = draw_reference(facing_mirrors(0.4, 0.4), SMALL)
    assert tried == ["long double", "double"]
    assert (reference.precision, reference.settings.cutoff) == ("double", 1 / 256)


# ---- Measuring


class Fake:
    """A renderer that takes no time and says how much it took."""

    def __init__(self, value=0.5, seconds=0.25, error=None, first_share=1.0):
        self.calls = 0
        self.value, self.seconds, self.error, self.first_share = value, seconds, error, first_share

    def render(self, scene, settings, progress=None):
        self.calls += 1
        if self.error is not None:
            raise self.error
        if progress is not None:
            progress(self.first_share)
        pixels = np.full((settings.height, settings.width, 3), self.value, np.float32)
        spent = self.seconds if self.calls > 1 else self.seconds + 1
        return Rendering(pixels, settings.width, settings.height, {"build": 0.0, "render": spent}, {"rays": 1})


@pytest.fixture
def run(monkeypatch, tmp_path):
    """Measures fake renderers, the reference 0.5 everywhere."""
    zero = difference()
    pixels = np.full((SMALL.height, SMALL.width, 3), 0.5, np.float32)
    reference = Reference(pixels, "long double", SMALL, 0.0, LeftOut(0.0, 0.0), zero)
    monkeypatch.setattr(measure, "draw_reference", lambda *_: reference)
    monkeypatch.setattr(Method, "missing", lambda self: None)
    asked = []

    def in_a_process(method, file, settings, variant=None, empty_cache=False):
        asked.append((method, variant, empty_cache))
        return Process(1.0, {"read": 0.1, "build": 0.1, "render": 0.5, "write": 0.1})

    def measured_with(renderers, runs=3, process=in_a_process, tell=lambda what, share: None):
        monkeypatch.setattr(Method, "renderer", lambda self, variant=None: renderers[self.name])
        methods = [METHODS[name] for name in renderers]
        scene = facing_mirrors(0.5)
        return measure_scene(tmp_path / "a.in", scene, SMALL, methods, runs, "llvm_ad_rgb", tell, process)

    return SimpleNamespace(with_=measured_with, asked=asked)


def test_methods_take_turns(run):
    order = []
    renderers = {}
    for name in ("native", "native-float", "mitsuba"):
        renderers[name] = Fake()
        draw = renderers[name].render
        renderers[name].render = lambda *a, draw=draw, name=name: order.append(name) or draw(*a)
    found = run.with_(renderers)
    assert order == ["native", "native-float", "mitsuba"] * 4
    assert [m.seconds for m in found.measured] == [[0.25] * 3] * 3
    assert [m.first["render"] for m in found.measured] == [1.25] * 3


def test_errors_are_against_the_reference(run):
    found = run.with_({"native": Fake(0.5), "mitsuba": Fake(0.75)})
    assert [m.difference.disagreeing for m in found.measured] == [0, 16 * 12]
    assert [m.difference.rms for m in found.measured] == [0.0, 0.25]


def test_slow_methods_run_less(run):
    found = run.with_({"native": Fake(seconds=0.01), "native-float": Fake(seconds=0.9), "mitsuba": Fake(seconds=5)}, 7)
    assert [len(m.runs) for m in found.measured] == [7, 3, 1]


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (RendererUnavailable("no device"), "no device"),
        (ValueError("too many planes"), "too many planes"),
        (MemoryError(), "not enough memory"),
    ],
)
def test_a_method_that_cannot_draw_a_scene_is_skipped(run, error, reason):
    found = run.with_({"native": Fake(), "mitsuba": Fake(error=error)})
    assert [m.skipped for m in found.measured] == [None, reason]
    assert [m.method.name for m in found.drawn] == ["native"]
    assert {method for method, _, _ in run.asked} == {"native"}


def test_a_method_that_takes_too_long_is_skipped(run, monkeypatch):
    monkeypatch.setattr(measure, "LONGEST", -1.0)
    found = run.with_({"native": Fake(), "mitsuba": Fake()})
    assert [m.skipped for m in found.measured] == ["takes longer than -1 s"] * 2


def test_what_is_missing_is_not_tried(run, monkeypatch):
    monkeypatch.setattr(Method, "missing", lambda self: "no" if self.name == "mitsuba-cuda" else None)
    cuda = Fake()
    found = run.with_({"native": Fake(), "mitsuba-cuda": cuda})
    assert [m.skipped for m in found.measured] == [None, "no"]
    assert cuda.calls == 0


def test_processes_of_their_own(run):
    run.with_({"native": Fake(), "mitsuba": Fake(), "mitsuba-cuda": Fake()})
    assert run.asked == [
        ("native", None, False),
        ("mitsuba", "llvm_ad_rgb", False),
        ("mitsuba", "llvm_ad_rgb", True),
        ("mitsuba-cuda", None, False),
        ("mitsuba-cuda", None, True),
    ]


def test_a_process_that_fails_takes_its_method_along(run):
    def fails(*_, **__):
        raise ProcessFailed("no answer")

    (m,) = run.with_({"native": Fake()}, process=fails).measured
    assert m.skipped == "in a process of its own: no answer"


def test_progress_grows_to_the_end(run):
    told = []
    run.with_({"native": Fake(), "mitsuba": Fake()}, tell=lambda what, share: told.append((share, what)))
    shares = [share for share, _ in told]
    assert shares == sorted(shares)
    assert 0 <= shares[0] < shares[-1] < 1
    assert any("mitsuba, run 3" in what for _, what in told)


# ---- Processes

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
    file = tmp_path / "small.in"
    file.write_text(SCENE)
    return file


def test_a_process_tells_its_stages(scene):
    process = render_in_a_process("native", scene, replace(SMALL, background=(-1.0, 0.0, 0.5), pixel="center"))
    assert list(process.stages) == ["read", "build", "render", "write"]
    assert process.whole > sum(process.stages.values()) > 0
    assert [file.name for file in scene.parent.iterdir()] == ["small.in"]


def test_a_process_that_fails_says_why(tmp_path):
    with pytest.raises(ProcessFailed, match="there is no such file"):
        render_in_a_process("native", tmp_path / "none.in", SMALL)


def test_what_a_process_is_asked_for(monkeypatch, scene):
    asked = []

    def child(command, env, **_):
        asked.append((command[3:], env))
        return subprocess.CompletedProcess(command, 0, '{"seconds": {"render": 1.0}}', "")

    monkeypatch.setattr(subprocess, "run", child)
    settings = Settings(8, 6, "center", "blinn", "ratio", (0.0, 0.5, 1.0), samples=4, seed=3)
    render_in_a_process("mitsuba", scene, settings, "llvm_ad_rgb", empty_cache=True)
    words, environment = asked[0]
    assert words[:2] == ["render", str(scene)]
    assert " ".join(words[3:]) == (
        "8 6 --method mitsuba --quiet --json - --pixel center --specular blinn --ior ratio --samples 4 --seed 3 "
        "--background=0.0,0.5,1.0 --variant llvm_ad_rgb"
    )
    assert environment["DRJIT_CACHE_DIR"]
    render_in_a_process("native", scene, settings)
    assert asked[1][1] is None


def test_a_process_that_hangs(monkeypatch, scene):
    monkeypatch.setattr(processes, "PATIENCE", 0.01)
    with pytest.raises(ProcessFailed, match=r"no answer within 0\.01 s"):
        render_in_a_process("native", scene, SMALL)


# ---- The command


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


# ---- Files


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("older")
    with pytest.raises(KeyboardInterrupt), replacing(file) as temporary:
        temporary.write_text("half")
        raise KeyboardInterrupt
    assert file.read_text() == "older"
    with replacing(file) as temporary:
        temporary.write_text("newer")
    assert file.read_text() == "newer"
    assert list(tmp_path.iterdir()) == [file]


def test_a_link_stays_and_into_what_is_no_file_is_copied(tmp_path):
    (tmp_path / "link").symlink_to("file")
    with replacing(tmp_path / "link") as temporary:
        temporary.write_text("new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "file").read_text() == "new"
    os.mkfifo(tmp_path / "pipe")
    with os.fdopen(os.open(tmp_path / "pipe", os.O_RDWR), "rb", buffering=0) as reader:
        with replacing(tmp_path / "pipe", ".svg") as temporary:
            assert temporary.suffix == ".svg"
            temporary.write_text("new")
        assert reader.read(3) == b"new"
    assert (tmp_path / "pipe").is_fifo()


def test_a_target_that_cannot_be_written(tmp_path):
    check_target(tmp_path / "a")
    for path in (tmp_path, tmp_path / "nowhere" / "a"):
        with pytest.raises(OSError):
            check_target(path)
