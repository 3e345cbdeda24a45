"""What the chart measures: the reference, pictures in turn, and processes."""

import subprocess
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from studies_fakes import difference

from converter.renderers.base import RendererUnavailable, Rendering
from converter.renderers.methods import METHODS, Method
from converter.scene.model import Camera, Finish, Object, Scene, Solid, Sphere
from converter.scene.settings import Settings
from converter.studies import measure, processes
from converter.studies import reference as references
from converter.studies.measure import measure_scene
from converter.studies.processes import Process, ProcessFailed, render_in_a_process
from converter.studies.reference import LeftOut, Reference, draw_reference, left_out

SMALL = Settings(width=16, height=12)


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
