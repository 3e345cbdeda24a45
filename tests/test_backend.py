"""Which LLVM library and which variant are chosen, and what is said where there is none."""

import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mitsuba_plugins
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
    ],
)
def test_version_of_a_library(name, version):
    assert backend._llvm_version(Path("/usr/lib") / name) == version


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
    with pytest.raises(mitsuba_plugins.BackendError, match="DRJIT_LIBLLVM_PATH is set"):
        backend._prepare_llvm.__wrapped__()


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
