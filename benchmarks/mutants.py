"""Plants mistakes into the program, one after the other, and tells which of them the tests notice.

    benchmarks/mutants.py [NAME...]

Each mutant of `mutants.toml`, or each one named, replaces a text that stands once in its file; then the tests that it
names are run until the first fails. All of that is done in a copy of the project, `build/mutants/tree`, where C++ is
built for the plainest processor. Status 1: some mutants survive, or do not apply.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import nanobind

ROOT = Path(__file__).resolve().parent.parent
FOLDER = ROOT / "build" / "mutants"
TREE = FOLDER / "tree"
LEFT_OUT = shutil.ignore_patterns(".*", "build", "dist", "out", "__pycache__", "*.egg-info", "*.so")
LONGEST = 300
"""Seconds of the tests of one mutant: some make them go on for ever."""
BUILT = {"native_tracer": "_core", "certified_tracer": "_certified"}
"""The C++ module of each package that mutants are planted into."""


def copy_project() -> None:
    """Copy the project. What has not changed keeps its date, so that it is not built again."""

    def copy(source: str, target: str) -> None:
        if not Path(target).exists() or Path(source).read_bytes() != Path(target).read_bytes():
            shutil.copyfile(source, target)

    shutil.copytree(ROOT, TREE, ignore=LEFT_OUT, copy_function=copy, dirs_exist_ok=True)
    # Without it Python would find the modules of an editable installation in the project itself.
    shutil.copy(TREE / "packaging" / "sitecustomize.py", TREE)


def build() -> bool:
    """Build the C++ modules of the copy, if they are not what they were made from; whether they compile."""
    scripts, out = Path(sys.executable).parent, FOLDER / "build"
    if not (out / "build.ninja").exists():
        configure = [scripts / "cmake", "-S", TREE, "-B", out, "-G", "Ninja", f"-Dnanobind_DIR={nanobind.cmake_dir()}"]
        configure += ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1", "-DWHITTED_X86_VARIANTS=OFF"]
        configure += [f"-DCMAKE_MAKE_PROGRAM={scripts / 'ninja'}", f"-DPython_EXECUTABLE={sys.executable}"]
        subprocess.run(configure, check=True, stdout=subprocess.DEVNULL)
    targets = ["--target", *BUILT.values()]
    if subprocess.run([scripts / "cmake", "--build", out, *targets], stdout=subprocess.DEVNULL).returncode:
        return False
    for package, name in BUILT.items():
        (module,) = out.glob(f"{name}.*.so")
        shutil.copy(module, TREE / package)
    return True


def outcome(tests: str) -> str:
    """What becomes of a mutant by these tests: "killed by ...", "survived", or an error."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "--tb=no", "-p", "no:cacheprovider", *shlex.split(tests)]
    environment = {**os.environ, "PYTHONPATH": str(TREE), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        run = subprocess.run(command, cwd=TREE, env=environment, capture_output=True, text=True, timeout=LONGEST)
    except subprocess.TimeoutExpired:
        return "killed by the time"
    match run.returncode:
        case 0:
            return "survived"
        case 1:
            return "killed by " + re.search(r"^(?:FAILED|ERROR) (.*?)(?: - |$)", run.stdout, re.MULTILINE)[1]
        case status:  # no tests, or it crashes, which it may do at random
            return f"error: status {status} of pytest\n{run.stdout}{run.stderr}"


def fate(mutant: dict[str, Any], tests: str) -> str:
    """What becomes of a mutant by its tests."""
    file = TREE / mutant["file"]
    text = file.read_text(encoding="utf-8")
    if (count := text.count(mutant["find"])) != 1:
        return f"error: its text stands {count} times in the file"
    file.write_text(text.replace(mutant["find"], mutant["replace"]), encoding="utf-8")
    try:
        if not build():
            return "error: it does not compile"
        found = outcome(tests)
    finally:
        file.write_text(text, encoding="utf-8")
    return f"equivalent: {mutant['equivalent']}" if found == "survived" and "equivalent" in mutant else found


def main(names: list[str]) -> int:
    """Tell the fate of the mutants of these names, or of all."""
    table = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    mutants, tests = table["mutants"], table["tests"]
    if unknown := set(names) - {mutant["name"] for mutant in mutants}:
        print(f"no mutants: {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    chosen = [mutant for mutant in mutants if not names or mutant["name"] in names]
    copy_project()
    if not build():
        return 1
    for name in dict.fromkeys(mutant["tests"] for mutant in chosen):
        if (found := outcome(tests[name])) != "survived":
            print(f"without any mutant, {name}: {found}", file=sys.stderr)
            return 1
    fates: Counter[str] = Counter()
    for mutant in chosen:
        found = fate(mutant, tests[mutant["tests"]])
        fates[found.split()[0].rstrip(":")] += 1
        print(f"{mutant['name']}, {mutant['file']}: {found}", flush=True)
    print(f"{len(chosen)} mutants: " + ", ".join(f"{count} {fate}" for fate, count in fates.items()))
    return 0 if set(fates) <= {"killed", "equivalent"} else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
