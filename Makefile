# make render   draw a scene with Mitsuba and compare it with the native tracer
# make test     run the tests
# make check    run the linters, the type checker, and the compiler with warnings as errors
# make figures  print the figures of the README, and draw its chart
# make format   draw the pictures of docs/format.md
# make stability  find where each method fails, and write docs/stability.md
# make mutants  plant mistakes, and tell which of them the tests do not notice
# make fuzz     look for inputs that fail, for SECONDS; what it finds is left in out/fuzz
#
# Each sets up .venv first, where it is missing or older than what it was made from.

PYTHON ?= python3
SCENE ?= scenes/figure1.in
OUT ?= out/$(basename $(notdir $(SCENE))).ppm
WIDTH ?= 800
HEIGHT ?= 600
SECONDS ?= 60

BIN := .venv/bin
SOURCES := pyproject.toml CMakeLists.txt $(wildcard native_tracer/src/*.* native_tracer/src/*/* student_tracer/src/* certified_tracer/src/*)
CPP := $(wildcard native_tracer/src/*/*.cpp native_tracer/src/*/*.h student_tracer/src/*.cpp student_tracer/src/*.h certified_tracer/src/*.cpp certified_tracer/src/*.h)

.PHONY: render test check figures format stability mutants fuzz clean
.DELETE_ON_ERROR:

# Status 1 of the comparison says that the pictures differ, which is no failure to render.
render: .venv/.installed
	@mkdir -p $(dir $(OUT))
	$(BIN)/whitted render $(SCENE) $(OUT) $(WIDTH) $(HEIGHT)
	$(BIN)/whitted compare $(SCENE) $(WIDTH) $(HEIGHT) || [ $$? -eq 1 ]

test: .venv/.installed
	$(BIN)/python -m pytest -n logical --dist worksteal

check: .venv/.checkers
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/clang-format --dry-run --Werror $(CPP)
	$(BIN)/cmake -S . -B build/check -G Ninja -DCMAKE_BUILD_TYPE=Debug -DWHITTED_WARNINGS_AS_ERRORS=ON \
	    -DCMAKE_MAKE_PROGRAM=$(CURDIR)/$(BIN)/ninja -DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python \
	    -Dnanobind_DIR=$$($(BIN)/python -m nanobind --cmake_dir) >/dev/null
	$(BIN)/cmake --build build/check

figures: .venv/.installed
	$(BIN)/python benchmarks/figures.py
	$(BIN)/python benchmarks/growth.py
	$(BIN)/python benchmarks/planes.py
	$(BIN)/python benchmarks/refused.py
	$(BIN)/python benchmarks/why.py
	mkdir -p docs
	$(BIN)/whitted chart scenes/figure1.in -o docs/figure1.png

format: .venv/.installed
	for scene in docs/format/*.in; do \
	    $(BIN)/whitted render $$scene $${scene%.in}.png 240 180 --method native || exit; done

fuzz: .venv/.fuzzer
	$(BIN)/python fuzzing/fuzz_scenes.py $(SECONDS)

mutants: .venv/.checkers
	$(BIN)/python benchmarks/mutants.py

stability: .venv/.installed
	@mkdir -p docs
	$(BIN)/whitted stability --docs docs --methods all

clean:
	rm -rf build out .venv

.venv/.installed: $(SOURCES)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	    { echo "whitted needs Python 3.11 or newer; name it: make PYTHON=python3.12 ..." >&2; exit 1; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
	    { echo "Python's venv module is missing; install it (Debian, Ubuntu: apt install python3-venv)" >&2; exit 1; }
	@$(PYTHON) -c 'import os, sysconfig; p = os.path.join(sysconfig.get_path("include"), "Python.h"); raise SystemExit(not os.path.exists(p))' || \
	    { echo "Python's headers are missing; install them (Debian, Ubuntu: apt install python3-dev; Fedora: dnf install python3-devel)" >&2; exit 1; }
	@for compiler in "$$CXX" c++ g++ clang++; do \
	    [ -n "$$compiler" ] && command -v $$compiler >/dev/null && exit 0; done; \
	    echo "no C++ compiler; install one (Debian, Ubuntu: apt install g++; Fedora: dnf install gcc-c++)" >&2; exit 1
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@touch $@

.venv/.fuzzer: .venv/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[fuzz]'
	@touch $@

.venv/.checkers: .venv/.installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[check]'
	@touch $@
