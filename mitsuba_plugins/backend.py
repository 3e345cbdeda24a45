"""Which Mitsuba variant runs on this machine, with which LLVM library, and the table of our plugins."""

import ctypes.util
import functools
import importlib
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

VARIANTS = ("llvm_ad_rgb", "cuda_ad_rgb")
"""Variants that the plugins run in. Python plugins do not work in Mitsuba's scalar variants."""

PLUGINS = (
    "mitsuba_plugins.textures.solid",
    "mitsuba_plugins.textures.solid_checker",
    "mitsuba_plugins.textures.projected_bitmap",
    "mitsuba_plugins.bsdfs.phong",
    "mitsuba_plugins.emitters.attenuated_point",
    "mitsuba_plugins.sensors.pinhole",
    "mitsuba_plugins.integrators.whitted",
)
"""Modules with one plugin each, which they register with Mitsuba when they are imported under a variant."""

MINIMUM_LLVM = 19
"""Dr.Jit 1.5 calls LLVM 14 and older missing, and aborts the process in code generation with 15 and 16."""

HOW_TO_GET_LLVM = (
    "On x86-64 Linux: pip install karellen-llvm-core. Elsewhere your system's (Debian: apt install "
    f"llvm-{MINIMUM_LLVM} libatomic1; macOS: brew install llvm)"
)
"""libatomic1 is Dr.Jit's own wish on arm64, which minimal systems lack."""

NOT_INSTALLED = "Mitsuba is not installed: pip install mitsuba (there is none for macOS on Intel)"

_FOLDERS = ("/usr/lib", "/usr/lib64", "/usr/local/lib", "/usr/local/opt", "/opt/homebrew/opt", "/opt/local/libexec")
"""Linux's, and what Homebrew (on Intel and on Apple's own processors) and MacPorts use."""
_PATTERNS = ("libLLVM*.so*", "*-linux-gnu/libLLVM*.so*", "llvm*/lib/libLLVM*.so*", "llvm*/lib/libLLVM*.dylib")

_ASK_VERSION = """
import ctypes, sys
try:
    library = ctypes.CDLL(sys.argv[1])
except OSError as error:
    sys.exit(f"it cannot be loaded ({str(error).removeprefix(sys.argv[1] + ': ')})")
if not hasattr(library, "LLVMContextCreate"):
    sys.exit("it is no LLVM library")
if not hasattr(library, "LLVMGetVersion"):  # which came with 16
    sys.exit("it is older than LLVM 16")
numbers = [ctypes.c_uint() for _ in range(3)]
library.LLVMGetVersion(*map(ctypes.byref, numbers))
print(numbers[0].value)
"""
_PATIENCE = 60  # seconds; loading takes a tenth

_BY_USER = "DRJIT_LIBLLVM_PATH is set"
_registered: set[str] = set()
_named: "LlvmLibrary | None" = None


class BackendError(Exception):
    """No Mitsuba variant that the plugins need can run here; the message says what to install."""


@dataclass(frozen=True, slots=True)
class LlvmLibrary:
    """An LLVM shared library, and why it was chosen."""

    path: Path
    reason: str

    @property
    def by_user(self) -> bool:
        """Whether DRJIT_LIBLLVM_PATH names it."""
        return self.reason == _BY_USER


def find_llvm() -> LlvmLibrary | None:
    """Choose the LLVM library for Dr.Jit: DRJIT_LIBLLVM_PATH, else the wheel's, else the newest of the system's."""
    chosen = os.environ.get("DRJIT_LIBLLVM_PATH")
    if _named is not None and chosen == str(_named.path):
        return _named
    if chosen:
        return LlvmLibrary(Path(chosen), _BY_USER)
    wheel = _wheel_llvm()
    if wheel is not None:
        return LlvmLibrary(wheel, "the karellen-llvm-core package of this Python environment")
    system = max(_system_llvm(), key=_llvm_version, default=None)
    if system is not None and _llvm_version(system) >= MINIMUM_LLVM:
        return LlvmLibrary(system, f"newest LLVM of the system, at least version {MINIMUM_LLVM}")
    return None


def name_llvm() -> None:
    """Name the LLVM library in the environment, where Dr.Jit looks when it is first imported."""
    global _named
    library = find_llvm()
    if library is not None:
        _named = library
        os.environ["DRJIT_LIBLLVM_PATH"] = str(library.path)


def _llvm_version(library: Path) -> int:
    """Major version in a library's file name: libLLVM.so.23.1, libLLVM-19.so, libLLVM-19.so.1; 0 if it names none.

    macOS has it in a folder's name, that of the file itself or of one that is linked to it: llvm@19/lib/libLLVM.dylib,
    Cellar/llvm/21.1.0/lib/libLLVM.dylib.
    """
    match = re.search(r"libLLVM[-.](?:so\.)?(\d+)", library.name)
    if match is None and library.name == "libLLVM.dylib":
        paths = map(str, (library, library.resolve()))
        match = next(filter(None, (re.search(r"/llvm[-@/](\d+)", path) for path in paths)), None)
    return int(match[1]) if match else 0


def _wheel_llvm() -> Path | None:
    """The LLVM library of this Python environment, if it is new enough."""
    wheel = max(Path(sys.prefix, "lib").glob("libLLVM.so.*"), key=_llvm_version, default=None)
    return wheel if wheel is not None and _llvm_version(wheel) >= MINIMUM_LLVM else None


def _system_llvm() -> Iterator[Path]:
    for folder in _FOLDERS:
        for pattern in _PATTERNS:
            yield from Path(folder).glob(pattern)


def llvm_complaint() -> str | None:
    """What is wrong with the library that DRJIT_LIBLLVM_PATH names; None where nothing is, or it names none."""
    library = find_llvm()
    if library is None or not library.by_user or library.path == _wheel_llvm():
        return None
    return _complaint_about(library.path)


@functools.cache
def _complaint_about(library: Path) -> str | None:
    """What is wrong with an LLVM library; None where nothing is.

    A process of its own asks it: a library that does not fit can end the process that loads it.
    """
    import signal
    import subprocess

    command = [sys.executable, "-I", "-S", "-c", _ASK_VERSION, str(library)]
    try:
        child = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=_PATIENCE)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"it cannot be tried: {error}"
    if child.returncode < 0:
        return f"a process that loads it dies of {signal.Signals(-child.returncode).name}"
    if child.returncode != 0:
        return (child.stderr.strip().splitlines() or ["it cannot be loaded"])[-1]
    version = int(child.stdout)
    return None if version >= MINIMUM_LLVM else f"it is LLVM {version}"


def set_variant(variant: str = "auto") -> str:
    """Choose a variant, load Mitsuba in it, register our plugins, and return the variant's name.

    Args:
        variant: "llvm_ad_rgb", "cuda_ad_rgb", or "auto": CUDA where a device answers and passes a trial, which takes
            some seconds once; else LLVM.

    Raises:
        BackendError: the variant cannot run here, or is none that the plugins work in.

    """
    if variant not in (*VARIANTS, "auto"):
        raise BackendError(f"variant '{variant}' is not supported: expected one of {', '.join(VARIANTS)}, auto")
    if find_spec("mitsuba") is None:
        raise BackendError(NOT_INSTALLED)
    if variant == "auto":
        variant = _automatic_variant()
    if variant == "llvm_ad_rgb":
        _prepare_llvm()
    elif not has_cuda():
        raise BackendError("cuda_ad_rgb: no CUDA device answers on this machine; use --variant llvm_ad_rgb")
    mitsuba = _import_mitsuba()
    if variant == "llvm_ad_rgb":
        _check_llvm()
    if mitsuba.variant() != variant:
        mitsuba.set_variant(variant)
    if variant == "cuda_ad_rgb":
        _mind_ptxas()
    _start_worker()
    register()
    return variant


def _import_mitsuba() -> ModuleType:
    """Mitsuba, or why it cannot be loaded: Dr.Jit 1.5 raises a NameError where a library of the system is missing."""
    try:
        import mitsuba
    except Exception as error:
        cause: BaseException = error
        while first := cause.__cause__ or cause.__context__:
            cause = first
        raise BackendError(f"Mitsuba cannot be loaded: {cause}") from error
    return mitsuba


@functools.cache
def _automatic_variant() -> str:
    """The variant that "auto" stands for; where a device answers, and is not used, the log says why."""
    if not has_cuda():
        return "llvm_ad_rgb"
    import logging

    from mitsuba_plugins.trial import cuda_trial

    trial = cuda_trial()
    if trial.works:
        return "cuda_ad_rgb"
    logging.getLogger("mitsuba_plugins").warning(
        "Mitsuba draws on the CPU, since CUDA failed its trial: %s (whitted doctor tries again)", trial.told
    )
    return "llvm_ad_rgb"


def _mind_ptxas() -> None:
    """Leave out of kernels what the driver's compiler does not take together with calls, and aborts the process.

    Dr.Jit keeps flags of its own for each thread.
    """
    import drjit

    drjit.set_flag(drjit.JitFlag.SpillToSharedMemory, False)


def on_gpu() -> bool:
    """Whether the variant that is set runs on a GPU."""
    import mitsuba

    return bool(mitsuba.variant() == "cuda_ad_rgb")


@functools.cache
def has_cuda() -> bool:
    """Whether the CUDA driver is installed and reports a device, asked without loading Dr.Jit."""
    name = ctypes.util.find_library("cuda")
    if name is None:
        return False
    try:
        driver = ctypes.CDLL(name)
        count = ctypes.c_int(0)
        return driver.cuInit(0) == 0 and driver.cuDeviceGetCount(ctypes.byref(count)) == 0 and count.value > 0
    except (OSError, AttributeError):
        return False


@functools.cache
def _start_worker() -> None:
    """Give Dr.Jit a worker thread on a machine of one core too.

    Without any, Mitsuba 3.9's `load_file` waits for ever for the scene that no one reads.
    """
    import drjit

    if drjit.thread_count() < 2:
        drjit.set_thread_count(2)


@functools.cache
def _prepare_llvm() -> None:
    """Check that there is an LLVM library, and name it."""
    library = find_llvm()
    if library is None:
        raise BackendError(
            f"Mitsuba's llvm_ad_rgb needs an LLVM library of version {MINIMUM_LLVM} or newer, and none was found. "
            f"{HOW_TO_GET_LLVM}; or set DRJIT_LIBLLVM_PATH to one."
        )
    if complaint := llvm_complaint():
        raise BackendError(
            f"DRJIT_LIBLLVM_PATH names {library.path}: {complaint}. Unset it, or let it name an LLVM library of "
            f"version {MINIMUM_LLVM} or newer."
        )
    try:
        ctypes.CDLL(str(library.path))
    except OSError as error:
        raise BackendError(f"the LLVM library {library.path} ({library.reason}) cannot be loaded: {error}") from error
    name_llvm()


@functools.cache
def _check_llvm() -> None:
    """Refuse an LLVM that would end the process: the system's, where Dr.Jit came first and saw no other named."""
    import drjit

    major = drjit.detail.llvm_version()[0]
    if 0 <= major < MINIMUM_LLVM:
        raise BackendError(
            f"Dr.Jit has loaded LLVM {major}, and needs {MINIMUM_LLVM} or newer: import mitsuba_plugins before mitsuba "
            "and drjit, or set DRJIT_LIBLLVM_PATH"
        )


def register() -> None:
    """Register every plugin for the variant that is set, once.

    Mitsuba's base classes differ from variant to variant, so that a module that was imported under another variant is
    loaded again.
    """
    import mitsuba

    variant = mitsuba.variant()
    if variant is None:
        raise BackendError("no Mitsuba variant is set: call mitsuba_plugins.set_variant() first")
    if variant in _registered:
        return
    for name in PLUGINS:
        _load(name)
    _registered.add(variant)


def _load(name: str) -> ModuleType:
    return importlib.reload(sys.modules[name]) if name in sys.modules else importlib.import_module(name)
