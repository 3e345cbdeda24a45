"""Plants mistakes into the program, one after the other, and tells which of them the tests notice.

    benchmarks/mutants.py [NAME...]

Each mutant of `mutants.toml`, or each one named, replaces a text that stands once in its file; then the tests that
could notice are run until the first fails, and the file is restored. C++ is built in `build/mutants`, for the plainest
processor, and put in the place of the installed module until the end. Status 1: some survive, or do not apply.
"""

import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "mutants"
LONGEST = 300
"""Seconds of the tests of one mutant: some make them go on for ever."""


def build() -> bool:
    """Build the native module and install it; whether it compiles."""
    import native_tracer._core

    scripts = Path(sys.executable).parent
    if not (BUILD / "build.ninja").exists():
        nanobind = subprocess.check_output([sys.executable, "-m", "nanobind", "--cmake_dir"], text=True).strip()
        configure = [scripts / "cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", f"-Dnanobind_DIR={nanobind}"]
        configure += ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1", "-DWHITTED_X86_VARIANTS=OFF"]
        configure += [f"-DCMAKE_MAKE_PROGRAM={scripts / 'ninja'}", f"-DPython_EXECUTABLE={sys.executable}"]
        subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    if subprocess.run([scripts / "cmake", "--build", BUILD], capture_output=True).returncode:
        return False
    module = Path(native_tracer._core.__file__)
    shutil.copy(BUILD / module.name, module.with_suffix(".new"))
    module.with_suffix(".new").replace(module)  # one that is loaded is not written into
    return True


def noticed(tests: str) -> str:
    """The first test that fails; empty if none does."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *shlex.split(tests)]
    try:
        run = subprocess.run(
            command,
            cwd=ROOT,
            capture_output=True,
            text=True,
            timeout=LONGEST,
            env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        )
    except subprocess.TimeoutExpired:
        return "they never end"
    if run.returncode == 0:
        return ""
    failed = re.search(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.MULTILINE)
    return failed[1] if failed else f"pytest's status {run.returncode}"


def fate(mutant: dict[str, Any], tests: str) -> str:
    """What becomes of a mutant, in words."""
    file = ROOT / mutant["file"]
    text = file.read_text(encoding="utf-8")
    if (count := text.count(mutant["find"])) != 1:
        return f"does not apply: its text stands {count} times in the file"
    compiled = file.suffix in (".h", ".cpp")
    try:
        file.write_text(text.replace(mutant["find"], mutant["replace"]), encoding="utf-8")
        if compiled and not build():
            return "does not apply: it does not compile"
        failed = noticed(tests)
    finally:
        file.write_text(text, encoding="utf-8")
    if failed:
        return f"killed by {failed}"
    return f"equivalent: {mutant['equivalent']}" if "equivalent" in mutant else "survived"


def main(names: list[str]) -> int:
    """Tell the fate of the mutants of these names, or of all."""
    table = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    chosen = [mutant for mutant in table["mutants"] if not names or mutant["name"] in names]
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # not without restoring the file
    fates = []
    try:
        build()
        for tests in dict.fromkeys(table["tests"][mutant["tests"]] for mutant in chosen):
            if failed := noticed(tests):
                print(f"without any mutant {failed} fails", file=sys.stderr)
                return 1
        for mutant in chosen:
            fates.append(fate(mutant, table["tests"][mutant["tests"]]))
            print(f"{mutant['name']}, {mutant['file']}: {fates[-1]}", flush=True)
    finally:
        build()
    killed, equivalent = (sum(f.startswith(word) for f in fates) for word in ("killed", "equivalent"))
    print(f"{len(fates)} mutants: {killed} killed, {equivalent} equivalent, {len(fates) - killed - equivalent} not")
    return 0 if killed + equivalent == len(fates) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
