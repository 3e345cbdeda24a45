# make render   draw a scene with Mitsuba and compare it with the native tracer
# make test     run the tests
# make check    run the linters, the type checker, the compiler with warnings as errors, and make docs
# make figures  print the figures of docs/figures.md, put its tables into it, and draw its charts
# make format   draw the pictures of docs/format.md
# make films    draw the films of docs/films.md
# make stability  find where each method fails, and write docs/stability.md
# make mutants  plant mistakes, and tell which of them the tests do not notice
# make fuzz     look for inputs that fail, for SECONDS; what it finds is left in out/fuzz
# make wheel    build the sdist and, from it, a wheel, and try that in an environment of its own
# make workflows  check the files of .github/workflows by actionlint, which Go fetches
# make docs     build the pages of docs/ as a site, with every link checked
# make sanitize run the tests of the native tracer with what finds bad memory and undefined behaviour
# make coverage run TESTS, all by default, and tell which lines of Python and C++ they do not reach
# make profile  tell where the native tracer's time goes on SCENES, all of the gallery by default, by Linux's perf
#
# Each sets up .venv first, where it is missing or older than what it was made from.

PYTHON ?= python3
SCENE ?= scenes/figure1.in
OUT ?= out/$(basename $(notdir $(SCENE))).ppm
WIDTH ?= 800
HEIGHT ?= 600
SECONDS ?= 60
NATIVE_TESTS := $(wildcard tests/test_native_*.py tests/test_bvh.py tests/test_halfspaces.py tests/test_student.py)
TESTS ?= tests

# Packages in C++, and their modules.
TRACERS := native:_core student:_student certified:_certified

BIN := .venv/bin
SOURCES := pyproject.toml CMakeLists.txt $(wildcard native_tracer/src/*.* native_tracer/src/*/* student_tracer/src/* certified_tracer/src/*)
CPP := $(wildcard native_tracer/src/*/*.cpp native_tracer/src/*/*.h student_tracer/src/*.cpp student_tracer/src/*.h certified_tracer/src/*.cpp certified_tracer/src/*.h)

.PHONY: render test check figures format films stability mutants fuzz wheel workflows docs sanitize coverage profile clean
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
	$(site)

figures: .venv/.installed
	@mkdir -p docs out
	for program in figures.py "growth.py --chart docs/growth.png" planes.py refused.py why.py peak.py; do \
	    $(BIN)/python benchmarks/$$program || exit; done >out/figures.txt
	cat out/figures.txt
	$(BIN)/python benchmarks/put_tables.py out/figures.txt
	$(BIN)/whitted chart scenes/figure1.in -o docs/figure1.png

format: .venv/.installed
	for scene in docs/format/*.in; do \
	    $(BIN)/whitted render $$scene $${scene%.in}.png 240 180 --method native || exit; done

fuzz: .venv/.fuzzer
	$(BIN)/python fuzzing/fuzz_scenes.py $(SECONDS)

films: .venv/.installed
	for film in orbit carving; do \
	    $(BIN)/whitted animate scenes/films/$$film.in docs/$$film.webp 160 120 --fps 12 --samples 9 --method native \
	    || exit 1; done

mutants: .venv/.checkers
	$(BIN)/python benchmarks/mutants.py

stability: .venv/.installed
	@mkdir -p docs
	$(BIN)/whitted stability --docs docs --methods all

# The sdist, a wheel from it, repaired so that it holds what it needs, and tried where nothing else is installed.
wheel: .venv/.packager
	rm -rf dist build/wheel
	$(BIN)/python -m build --outdir build/wheel .
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python packaging/repair_wheel.py build/wheel dist
	cp build/wheel/*.tar.gz dist
	$(BIN)/python -m venv build/wheel/venv
	build/wheel/venv/bin/python -m pip install --quiet --disable-pip-version-check dist/*.whl
	cd build/wheel && venv/bin/python $(CURDIR)/packaging/check_wheel.py $(CURDIR)/scenes

workflows:
	go run github.com/rhysd/actionlint/cmd/actionlint@v1.7.12

docs: .venv/.checkers
	$(site)

site = NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict

# A build of its own, tried without what `pip install` has left; the sanitizers have to be loaded before Python.
sanitize: .venv/.checkers
	$(call native_build,build/sanitize,None,-DCMAKE_CXX_FLAGS='-O1 -g1' -DWHITTED_SANITIZE=ON)
	$(call native_packages,build/sanitize)
	LD_PRELOAD="$$($(CXX) -print-file-name=libasan.so) $$($(CXX) -print-file-name=libubsan.so)" \
	    ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 \
	    $(call pytest_with,build/sanitize) $(NATIVE_TESTS)

coverage: .venv/.coverage
	$(call native_build,build/coverage,None,-DCMAKE_CXX_FLAGS='-O1 -g1' -DWHITTED_COVERAGE=ON)
	$(call native_packages,build/coverage)
	find build/coverage -name '*.gcda' -delete
	$(call pytest_with,build/coverage) -n logical --dist worksteal $(TESTS) \
	    $(addprefix --cov=,whitted converter mitsuba_plugins) --cov-report=term-missing:skip-covered; failed=$$?; \
	$(BIN)/gcovr --root . --filter '[a-z]*_tracer/src' build/coverage --merge-lines \
	    --merge-mode-functions=separate --gcov-suspicious-hits-threshold=0; exit $$failed

profile: .venv/.checkers
	$(call native_build,build/profile,None,-DCMAKE_CXX_FLAGS='-O3 -DNDEBUG -g1')
	$(call native_packages,build/profile)
	PYTHONPATH=$(CURDIR)/build/profile/packages:$(CURDIR) $(BIN)/python benchmarks/hotspots.py $(SCENES)

# The tracers built in a folder, as a kind of build, with an option.
define native_build
	$(BIN)/cmake -S . -B $(1) -G Ninja -DCMAKE_BUILD_TYPE=$(2) $(3) -DCMAKE_MAKE_PROGRAM=$(CURDIR)/$(BIN)/ninja \
	    -DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python -Dnanobind_DIR=$$($(BIN)/python -m nanobind --cmake_dir) >/dev/null
	$(BIN)/cmake --build $(1)
endef

# pytest, in which these come before what is installed, also in the processes that tests start.
pytest_with = PYTHONPATH=$(CURDIR)/$(1)/packages:$(CURDIR) $(BIN)/python -m pytest -q -p no:cacheprovider

# Packages of them.
define native_packages
	mkdir -p $(1)/packages
	cp packaging/sitecustomize.py $(1)/packages
	for tracer in $(TRACERS); do \
	    package=$(1)/packages/$${tracer%:*}_tracer; mkdir -p $$package; \
	    cp $${tracer%:*}_tracer/*.py* $$package; \
	    cp $(1)/$${tracer#*:}*.so $$package; done
endef

clean:
	rm -rf build dist out site .venv

.venv/.installed: $(SOURCES)
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { printf '%s\n' \
	    "whitted needs Python 3.11 or newer, and $(PYTHON) is older. Where a newer one is installed, name it:" \
	    "    make PYTHON=python3.12 ..." \
	    "Ubuntu 22.04, also in WSL:  sudo apt install python3.11 python3.11-venv python3.11-dev" \
	    "                            and then make PYTHON=python3.11 ..." \
	    "macOS:                      brew install python@3.12, and then make PYTHON=python3.12 ..." >&2; exit 1; }
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

# Each is a set of tools, by the extra of that name. They come without the project, which would be built once more.
.venv/.packager: EXTRA = wheel
.venv/.coverage: EXTRA = coverage
.venv/.fuzzer: EXTRA = fuzz
.venv/.checkers: EXTRA = check
.venv/.coverage: .venv/.checkers
.venv/.packager .venv/.coverage .venv/.fuzzer .venv/.checkers: .venv/.installed
	$(BIN)/python packaging/requirements.py $(EXTRA) >$@.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r $@.txt
	@touch $@
