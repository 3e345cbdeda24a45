"""Which LLVM library and which variant are chosen, and what is said where there is none."""

import subprocess
import sys
from pathlib import Path

import pytest

import mitsuba_plugins
from mitsuba_plugins import backend


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
