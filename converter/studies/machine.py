"""The machine and the programs that figures come from, for whoever reads the figures elsewhere."""

import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from converter.renderers.native import available_cores

PACKAGES = ("whitted", "mitsuba", "drjit", "numpy")
_CPU_INFO = Path("/proc/cpuinfo")  # Linux only
_INSTRUCTIONS = (("avx512f", "AVX-512"), ("avx2", "AVX2"), ("avx", "AVX"), ("sse4_2", "SSE4.2"), ("asimd", "NEON"))


def machine() -> dict[str, Any]:
    """Cores that may be used, the processor's name, its widest vector instructions (None: unknown), the system."""
    told = _cpu_info()
    flags = (told.get("flags") or told.get("Features") or "").split()
    return {
        "processor": told.get("model name") or platform.processor() or platform.machine(),
        "cores": available_cores(),
        "instructions": next((name for flag, name in _INSTRUCTIONS if flag in flags), None),
        "system": f"{platform.system()} {platform.machine()}",
    }


def versions() -> dict[str, str | None]:
    """Python's and each package's; None for one that is not installed."""
    result: dict[str, str | None] = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            result[name] = version(name)
        except PackageNotFoundError:
            result[name] = None
    return result


def _cpu_info() -> dict[str, str]:
    """What the system says of the first processor."""
    try:
        first = _CPU_INFO.read_text(encoding="utf-8", errors="replace").split("\n\n")[0]
    except OSError:
        return {}
    pairs = (line.partition(":") for line in first.splitlines())
    return {name.strip(): value.strip() for name, _, value in pairs}
