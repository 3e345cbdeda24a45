"""Which LLVM library and which variant are chosen, and what is said where there is none."""

import logging
import signal
import subprocess
import sys
from pathlib import Path
from shutil import which

import numpy as np
import pytest

import mitsuba_plugins
from converter.grade import sandbox
from converter.renderers.methods import METHODS
from mitsuba_plugins import backend, trial


@pytest.fixture
def environment(monkeypatch, tmp_path):
    """A Python environment and a system of our own making."""
    (tmp_path / "venv" / "lib").mkdir(parents=True)
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(backend.sys, "prefix", str(tmp_path / "venv"))
    system: list[Path] = []
    monkeypatch.setattr(backend, "_system_llvm", lambda: iter(system))
    return tmp_path, system


@pytest.mark.parametrize(
    ("name", "version"),
    [
        ("libLLVM.so.23.1", 23),
        ("libLLVM-19.so", 19),
        ("libLLVM-14.so.1", 14),
        ("libLLVM.so", 0),
        ("libLLVM-21.dylib", 21),
        ("llvm@19/lib/libLLVM.dylib", 19),
        ("llvm-20/lib/libLLVM.dylib", 20),
        ("Cellar/llvm/21.1.0/lib/libLLVM.dylib", 21),
        ("llvm@19/lib/libLLVM-C.dylib", 0),
    ],
)
def test_version_of_a_library(name, version):
    assert backend._llvm_version(Path("/usr/lib") / name) == version


@pytest.mark.parametrize("prefix", ["/opt/homebrew/opt", "/usr/local/opt"])
def test_homebrew_is_looked_into(monkeypatch, tmp_path, prefix):
    """As it has them: opt/llvm is a link to a folder that is named by the version."""
    assert prefix in backend._FOLDERS
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(backend.sys, "prefix", str(tmp_path))
    monkeypatch.setattr(backend, "_FOLDERS", (str(tmp_path / "opt"),))
    assert backend.find_llvm() is None
    for name in ("llvm", "llvm@19", "llvm@14"):
        version = {"llvm": "21.1.0"}.get(name, f"{name[5:]}.1.7")
        cellar = tmp_path / "Cellar" / name / version / "lib"
        cellar.mkdir(parents=True)
        (cellar / "libLLVM.dylib").touch()
        (cellar / "libLLVM-C.dylib").touch()
        (tmp_path / "opt").mkdir(exist_ok=True)
        (tmp_path / "opt" / name).symlink_to(cellar.parent)
    assert backend.find_llvm().path == tmp_path / "opt" / "llvm" / "lib" / "libLLVM.dylib"


def test_users_choice_comes_first(environment, monkeypatch):
    folder, _ = environment
    (folder / "venv" / "lib" / "libLLVM.so.23.1").touch()
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/opt/llvm/libLLVM.so")
    assert backend.find_llvm().path == Path("/opt/llvm/libLLVM.so")


def test_wheel_before_system(environment):
    folder, system = environment
    wheel = folder / "venv" / "lib" / "libLLVM.so.23.1"
    wheel.touch()
    system.append(Path("/usr/lib/libLLVM-30.so"))
    assert backend.find_llvm().path == wheel


def test_newest_of_the_system(environment):
    _, system = environment
    system.extend(map(Path, ["/usr/lib/libLLVM-14.so.1", "/usr/lib/libLLVM-20.so", "/usr/lib/libLLVM-19.so"]))
    assert backend.find_llvm().path == Path("/usr/lib/libLLVM-20.so")


def test_never_one_that_aborts_the_process(environment):
    """Dr.Jit finds LLVM 15 and 16 good, and then aborts while it compiles."""
    _, system = environment
    system.extend(map(Path, ["/usr/lib/libLLVM-15.so.1", "/usr/lib/libLLVM-16.so.1"]))
    assert backend.find_llvm() is None
    with pytest.raises(mitsuba_plugins.BackendError, match="pip install karellen-llvm-core"):
        backend._prepare_llvm.__wrapped__()


def test_library_that_cannot_be_loaded(environment, monkeypatch):
    folder, _ = environment
    broken = folder / "libLLVM-20.so"
    broken.write_text("no library")
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", str(broken))
    with pytest.raises(mitsuba_plugins.BackendError, match=r"DRJIT_LIBLLVM_PATH names .*: it cannot be loaded"):
        backend._prepare_llvm.__wrapped__()


# ---- What DRJIT_LIBLLVM_PATH names


@pytest.fixture
def named(tmp_path, monkeypatch):
    """Compiles a library from C, and has DRJIT_LIBLLVM_PATH name it; returns what is wrong with it."""
    compiler = which("cc") or which("gcc") or which("clang")
    if compiler is None:
        pytest.skip("there is no C compiler")

    def run(source, name="libLLVM.so"):
        library = tmp_path / name
        subprocess.run(
            [compiler, "-shared", "-fPIC", "-x", "c", "-", "-o", library], input=source, text=True, check=True
        )
        monkeypatch.setenv("DRJIT_LIBLLVM_PATH", str(library))
        return backend.llvm_complaint()

    return run


LLVM = "void LLVMContextCreate() {{}}"
VERSION = LLVM + " void LLVMGetVersion(unsigned *a, unsigned *b, unsigned *c) {{ *a = {}; *b = 1; *c = 0; }}"


@pytest.mark.parametrize(
    ("source", "complaint"),
    [
        ("int nothing;", "it is no LLVM library"),
        (LLVM.format(), "it is older than LLVM 16"),
        (VERSION.format(18), "it is LLVM 18"),
        (VERSION.format(19), None),
        (VERSION.format(23), None),
        (
            "#include <stdlib.h>\n__attribute__((constructor)) void start() { abort(); }",
            "a process that loads it dies of SIGABRT",
        ),
    ],
)
def test_the_library_is_asked(named, source, complaint):
    """In a process of its own, so that the last one ends no other."""
    assert named(source) == complaint


def test_the_users_library_that_is_too_old(named):
    named(VERSION.format(14), "libLLVM-30.so")
    with pytest.raises(mitsuba_plugins.BackendError) as told:
        backend._prepare_llvm.__wrapped__()
    assert "libLLVM-30.so: it is LLVM 14. Unset it, or let it name an LLVM library of version 19" in str(told.value)


@pytest.mark.parametrize("name", ["missing.so", "", "text"])
def test_the_users_library_is_none(tmp_path, monkeypatch, name):
    (tmp_path / "text").write_text("no library")
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", str(tmp_path / name))
    assert backend.llvm_complaint().startswith("it cannot be loaded (")
    assert str(tmp_path) not in backend.llvm_complaint()


def test_our_own_library_is_not_asked(environment, monkeypatch):
    """Nor in child processes, which find it named in the environment: they would start later by a tenth of a second."""
    folder, _ = environment
    (folder / "venv" / "lib" / "libLLVM.so.23.1").write_text("no library")
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", str(folder / "venv" / "lib" / "libLLVM.so.23.1"))
    assert backend.llvm_complaint() is None


@pytest.mark.parametrize(
    ("words", "instead"),
    [
        (["render", "SCENE", "a.ppm", "8", "6", "-q"], "native"),
        (["pixel", "SCENE", "1", "1", "8", "6", "-q"], "native"),
        (["compare", "SCENE", "8", "6", "-q"], "native-long-double"),
    ],
)
def test_without_mitsuba_commands_name_a_method_that_works(tmp_path, monkeypatch, words, instead):
    scene = str(Path(__file__).parents[1] / "scenes" / "figure1.in")
    words = [scene if word == "SCENE" else word for word in words]
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/nowhere/libLLVM.so")
    monkeypatch.setenv("CUDA_VISIBLE_DEVICES", "")
    program = [sys.executable, "-m", "converter.commands.main", *words]
    for options, status in ((["--variant", "llvm_ad_rgb"], 3), (["--method", instead], 0)):
        child = subprocess.run([*program, *options], capture_output=True, text=True, cwd=tmp_path)
        assert child.returncode == status, child.stderr
        assert child.stderr.endswith(f"\n--method {instead} draws without Mitsuba\n") == (status == 3)


def test_mitsuba_that_cannot_be_loaded_is_told_in_a_sentence(tmp_path, monkeypatch):
    """As Dr.Jit 1.5 fails on arm64 without libatomic, which minimal systems lack."""
    mitsuba = tmp_path / "mitsuba" / "__init__.py"
    mitsuba.parent.mkdir()
    mitsuba.write_text("try:\n    raise ImportError('libatomic.so.1: no file')\nexcept ImportError:\n    _drjit_ext\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    scene = Path(__file__).parents[1] / "scenes" / "figure1.in"
    words = ["render", scene, "a.ppm", "8", "6", "-q", "--variant", "llvm_ad_rgb"]
    program = [sys.executable, "-m", "converter.commands.main", *words]
    child = subprocess.run(program, capture_output=True, text=True, cwd=tmp_path)
    assert child.returncode == 3
    assert child.stderr.splitlines() == [
        "whitted render: Mitsuba cannot be loaded: libatomic.so.1: no file",
        "--method native draws without Mitsuba",
    ]


def test_methods_that_the_users_library_rules_out_are_marked(monkeypatch):
    monkeypatch.setenv("DRJIT_LIBLLVM_PATH", "/nowhere/libLLVM.so")
    monkeypatch.setattr(backend, "has_cuda", lambda: False)
    assert "DRJIT_LIBLLVM_PATH names no library that will do: it cannot be loaded" in METHODS["mitsuba"].missing()


# ---- Variants


def test_unknown_variant():
    with pytest.raises(mitsuba_plugins.BackendError, match="scalar_rgb"):
        mitsuba_plugins.set_variant("scalar_rgb")


def test_missing_device(monkeypatch):
    monkeypatch.setattr(backend, "has_cuda", lambda: False)
    with pytest.raises(mitsuba_plugins.BackendError, match="no CUDA device"):
        mitsuba_plugins.set_variant("cuda_ad_rgb")


# ---- CUDA on trial, with no device at hand


@pytest.fixture
def device(monkeypatch, tmp_path):
    """A machine with a GPU, on which trials end as the list says, one after another."""
    outcomes: list[int] = []

    def run(command, **_):
        assert command[-2:] == ["converter.commands.doctor_probe", "cuda_ad_rgb"]
        return subprocess.CompletedProcess(command, outcomes.pop(0), "0.7 s\n", "ptxas error : C7800\nanother line\n")

    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(backend, "has_cuda", lambda: True)
    monkeypatch.setattr(trial, "cuda_device", lambda: "NVIDIA H100")
    monkeypatch.setattr(trial, "DRIVER", tmp_path / "driver")
    monkeypatch.setattr(trial.subprocess, "run", run)
    return outcomes


automatic_variant = backend._automatic_variant.__wrapped__


def test_auto_takes_a_device_that_passes_its_trial(device, caplog):
    device.append(0)
    assert [automatic_variant() for _ in range(3)] == ["cuda_ad_rgb"] * 3  # tried once, then remembered
    assert not device
    assert not caplog.text


@pytest.mark.parametrize(
    ("status", "reason"),
    [(-signal.SIGABRT, "the process dies of SIGABRT: ptxas error : C7800"), (1, "fails: ptxas error : C7800")],
)
def test_auto_takes_the_cpu_where_cuda_fails_and_says_so(device, caplog, status, reason):
    device.append(status)
    caplog.set_level(logging.WARNING, "mitsuba_plugins")  # --quiet, in tests before, has it at errors
    for _ in range(2):
        caplog.clear()
        assert automatic_variant() == "llvm_ad_rgb"
        assert caplog.messages == [
            f"Mitsuba draws on the CPU, since CUDA failed its trial: {reason} (whitted doctor tries again)"
        ]
    assert not device


def test_a_device_that_hangs_fails(device, monkeypatch):
    def run(command, timeout, **_):
        raise subprocess.TimeoutExpired(command, timeout)

    monkeypatch.setattr(trial.subprocess, "run", run)
    assert trial.cuda_trial() == trial.Trial(False, f"no answer within {trial.SECONDS} s")


def test_what_changes_is_tried_again(device, monkeypatch, tmp_path):
    device.extend([1, 0, 1, 0])
    works = [trial.cuda_trial().works]
    (tmp_path / "driver").write_text("580.95")
    works.append(trial.cuda_trial().works)
    monkeypatch.setattr(trial, "version", lambda package: "99")
    works.append(trial.cuda_trial().works)
    monkeypatch.setattr(trial, "cuda_device", lambda: "another")
    works.append(trial.cuda_trial().works)
    assert works == [False, True, False, True]


def test_the_trial_does_without_a_place_to_remember(device, tmp_path):
    (tmp_path / "cache").write_text("a file")
    device.extend([0, 0])
    assert [automatic_variant() for _ in range(2)] == ["cuda_ad_rgb"] * 2


@pytest.mark.parametrize("text", ["", "[]", "{", '{"machine": 1}'])
def test_a_memory_that_is_none_is_written_anew(device, tmp_path, text):
    file = tmp_path / "cache" / "whitted" / "cuda.json"
    file.parent.mkdir(parents=True)
    file.write_text(text)
    device.append(0)
    assert [trial.cuda_trial().works for _ in range(2)] == [True, True]


def test_doctor_tries_again(device, capsys, monkeypatch):
    from converter.commands import doctor

    monkeypatch.setattr(doctor, "_packages", lambda: [])
    monkeypatch.setattr(sandbox, "find_walls", lambda: sandbox.Walls(None, "none are looked for"))
    device.append(1)
    assert automatic_variant() == "llvm_ad_rgb"
    monkeypatch.setattr(trial, "try_variant", lambda variant: trial.Trial(True, f"{variant} works"))
    assert doctor.run(doctor.parser().parse_args([])) == 0
    assert automatic_variant() == "cuda_ad_rgb"
    monkeypatch.setattr(trial, "try_variant", lambda variant: trial.Trial(variant != "cuda_ad_rgb", "tried"))
    capsys.readouterr()
    assert doctor.run(doctor.parser().parse_args([])) == 0
    assert "CUDA failed its trial: --variant auto takes llvm_ad_rgb." in capsys.readouterr().out
    assert automatic_variant() == "llvm_ad_rgb"


def test_the_trial_finds_a_wrong_picture(monkeypatch, capsys):
    from dataclasses import replace

    from converter.commands import doctor_probe

    reference = doctor_probe._draw("native")
    monkeypatch.setattr(doctor_probe, "_draw", lambda what: reference)
    assert doctor_probe.main("cuda_ad_rgb") == 0
    pixels = np.array(reference.pixels)
    pixels[100, : doctor_probe.MOST_WRONG + 1] += 0.1
    spoilt = replace(reference, pixels=pixels)
    monkeypatch.setattr(doctor_probe, "_draw", lambda what: reference if what == "native" else spoilt)
    assert doctor_probe.main("cuda_ad_rgb") == 1
    assert "its picture is wrong: 31 of 307200 pixels" in capsys.readouterr().err


def test_registers_do_not_spill_to_shared_memory(mi, monkeypatch):
    """The driver's compiler aborts the process where a kernel with that pragma has calls."""
    import drjit as dr

    monkeypatch.setattr(backend, "has_cuda", lambda: True)
    monkeypatch.setattr(backend, "register", lambda: None)
    monkeypatch.setattr(mi, "variant", lambda: "cuda_ad_rgb")
    with dr.scoped_set_flag(dr.JitFlag.SpillToSharedMemory, True):
        backend.set_variant("cuda_ad_rgb")
        assert not dr.flag(dr.JitFlag.SpillToSharedMemory)


def test_refuses_an_llvm_that_dr_jit_took_by_itself(monkeypatch):
    """As happens where Dr.Jit is imported before `mitsuba_plugins` has named another."""
    drjit = pytest.importorskip("drjit")
    monkeypatch.setattr(drjit.detail, "llvm_version", lambda: (15, 0, 6))
    with pytest.raises(mitsuba_plugins.BackendError, match="import mitsuba_plugins before mitsuba"):
        backend._check_llvm.__wrapped__()


def test_names_the_library_before_dr_jit_looks():
    program = "import os, mitsuba_plugins, drjit; print(drjit.detail.llvm_version()[0])"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert int(found.stdout) >= backend.MINIMUM_LLVM
