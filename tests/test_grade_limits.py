"""Programs that hang, fork, fill and pry: each ends, tells why, and leaves nothing behind.

None of them does lasting harm where a limit fails: each ends by itself, or has little to go on with.
"""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from converter.grade.run import Limits, Runner, Stopped, told
from converter.grade.sandbox import Walls, find_walls

LIMITS = Limits(seconds=0.5, memory=150, output=4, tasks=40)
NONE = Walls(None, "for a test")
CORES = sorted(os.sched_getaffinity(0))[:1]
ONCE = os.getpid()
"""In the names of what is looked for, so that nobody else's is found who runs these tests at the same time."""

needs_walls = pytest.mark.skipif(not find_walls().bubblewrap, reason=find_walls().why_not or "bubblewrap works")
walls = pytest.mark.parametrize(
    "walls", [pytest.param(NONE, id="none"), pytest.param(find_walls(), id="bubblewrap", marks=needs_walls)]
)


def run(script, folder, walls=NONE, limits=LIMITS, seen=()):
    return Runner(walls).run(["/bin/bash", "-c", script], folder, seen, limits, CORES)


@pytest.fixture
def patient(monkeypatch):
    """Whoever has to wait for a busy machine is not ended for it."""
    monkeypatch.setattr("converter.grade.run.CLOCK", 100.0)


@walls
@pytest.mark.usefixtures("patient")
@pytest.mark.parametrize(
    ("script", "expected"),
    [
        ("true", ""),
        ("exit 3", "ended with status 3"),
        ("kill -SEGV $$", "crashed: SIGSEGV"),
        ("timeout 20 sh -c 'while :; do :; done'", "ended after 0.5 s of processor time"),
        ("for k in 1 2; do timeout 20 sh -c 'while :; do :; done' & done; wait", "ended after 0.5 s of processor time"),
        ("timeout 20 yes", "4 MiB of output"),
        ("yes | head -c 100000000 > out.ppm", "4 MiB of output"),
        ("for k in 1 2 3 4; do yes | head -c 3000000 > $k & done; wait; sleep 1", "4 MiB of output"),
    ],
    ids=["well", "status", "crash", "loop", "loops", "talk", "file", "files"],
)
def test_endings_are_told(script, expected, walls, tmp_path):
    ending = run(script, tmp_path, walls)
    assert expected in told(ending, LIMITS)
    assert (told(ending, LIMITS) == "") == (expected == "")


@walls
def test_what_only_waits_is_ended_by_the_clock(walls, tmp_path):
    ending = run("trap '' TERM INT HUP; sleep 60 & wait; sleep 60", tmp_path, walls)
    assert "did not end itself" in told(ending, LIMITS)
    assert ending.clock < LIMITS.clock_seconds + 10


@walls
def test_too_much_memory_is_told(walls, tmp_path):
    limits = replace(LIMITS, seconds=20)  # to fill it takes some time on a machine that is busy
    script = "head -c 600000000 /dev/zero | tail -n 1 | sleep 20"  # tail keeps it, for nobody takes it
    ending = run(script, tmp_path, walls, limits)
    assert "150 MiB of memory" in told(ending, limits)


BOMB = "b() { [ $1 = 0 ] || { b $(($1 - 1)) & b $(($1 - 1)) & }; sleep 5; }; b 7"


@walls
def test_too_many_processes_are_told(walls, tmp_path):
    limits = replace(LIMITS, seconds=20)  # to start them takes some time, too
    assert told(run(BOMB, tmp_path, walls, limits), limits) == "ended at more than 40 processes and threads"


def test_looks_that_have_to_wait_are_not_rarer(tmp_path):
    order = {"command": ["/bin/sleep", "2"], "folder": str(tmp_path), "environment": {}, "cores": CORES}
    order |= {"seconds": 20, "clock_seconds": 60, "memory": 1 << 30, "tasks": 40, "files": 100, "output": 1 << 20}
    script = (
        "import time; from converter.grade import warden\n"
        "looks = []\n"
        "warden._Watch._look = lambda *_: looks.append(time.sleep(0.1)) or ''\n"
        f"warden.run(warden.Order(**{order}))\n"
        "print(len(looks))"
    )
    looks = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert int(looks) > 3  # one, if a look's cost were the time that it waits


def test_times_are_those_of_the_program_and_its_children(tmp_path):
    work = f"{sys.executable} -I -S -c 'import time\nwhile time.process_time() < 0.3: pass'"
    ending = run(f"({work}); sleep 0.2", tmp_path, limits=replace(LIMITS, seconds=20))
    assert ending.clock > 0.4
    assert 0.25 < ending.cpu < 0.45


def test_what_a_program_says_is_cut_in_its_middle(tmp_path):
    said = run("echo first; seq 100000; echo last", tmp_path).told
    assert said.startswith("first\n")
    assert said.endswith("last\n")
    assert "[...]" in said
    assert len(said) < 20000


def test_many_files_are_too_many(tmp_path):
    limits = Limits(seconds=20, memory=150, output=100)
    script = "import os\nfor k in range(10**6): os.close(os.open(str(k), os.O_CREAT))"
    ending = Runner(NONE).run([sys.executable, "-S", "-c", script], tmp_path, [], limits, CORES)
    assert told(ending, limits) == "ended at more than 10000 files"


@walls
def test_daemons_do_not_outlive_the_program(walls, tmp_path):
    run(f"(setsid sleep 4242.{ONCE} >/dev/null 2>&1 &); exit 0", tmp_path, walls)
    assert not _running(f"4242.{ONCE}")


def test_a_program_that_is_none(tmp_path):
    ending = Runner(NONE).run([str(tmp_path / "none")], tmp_path, [], LIMITS, CORES)
    assert told(ending, LIMITS) == "could not be started: no such file or directory"


def test_stopping_ends_what_runs_and_begins_nothing(tmp_path):
    from threading import Timer

    runner = Runner(NONE)
    Timer(0.5, runner.stop).start()
    started = time.monotonic()
    with pytest.raises(Stopped):
        runner.run(["/bin/sleep", f"4343.{ONCE}"], tmp_path, [], Limits(seconds=60), CORES)
    assert time.monotonic() - started < 60
    assert not _running(f"4343.{ONCE}")
    with pytest.raises(Stopped):
        runner.run(["/bin/true"], tmp_path, [], LIMITS, CORES)


def test_programs_end_with_whoever_started_them(tmp_path):
    word = f"4444.{ONCE}"
    script = (
        "from pathlib import Path; from converter.grade.run import *; from converter.grade.sandbox import Walls\n"
        f"Runner(Walls(None)).run(['/bin/sleep', '{word}'], Path({str(tmp_path)!r}), [], Limits(seconds=60), {CORES})"
    )
    starter = subprocess.Popen([sys.executable, "-c", script])
    until = time.monotonic() + 60
    while not _running(word):
        assert starter.poll() is None and time.monotonic() < until
        time.sleep(0.05)
    starter.send_signal(signal.SIGKILL)
    starter.wait()
    while _running(word):
        assert time.monotonic() < until
        time.sleep(0.05)


# ---- Walls -----------------------------------------------------------------------------------------------------------


@needs_walls
def test_nothing_but_its_folder_is_seen_or_written(tmp_path):
    own, other, seen = tmp_path / "own", tmp_path / "other", tmp_path / "seen"
    for folder in (own, other, seen):
        folder.mkdir()
        (folder / "file").write_text(folder.name)
    script = f"cat {other}/file; cat {seen}/file; cat /etc/passwd; echo x > {seen}/new; echo x > /new; echo x > own.txt"
    ending = run(script, own, find_walls(), seen=[seen])
    assert "seen" in ending.told
    assert ending.told.count("No such file") == 2
    assert ending.told.count("Read-only file system") == 2
    assert (own / "own.txt").is_file()
    assert [path.name for path in seen.iterdir()] == ["file"]


@needs_walls
def test_what_is_written_to_tmp_counts_and_goes(tmp_path):
    name = f"4545-{ONCE}-$k"
    script = f"for k in 1 2 3 4; do yes > /tmp/{name} & yes > /dev/shm/{name} & done; wait"
    assert run(script, tmp_path, find_walls()).beyond == "output"
    assert not [*Path("/tmp").glob(f"4545-{ONCE}*"), *Path("/dev/shm").glob(f"4545-{ONCE}*")]


@needs_walls
def test_other_processes_are_out_of_reach(tmp_path):
    ending = run("kill -9 -1; ls -d /proc/[0-9]* | wc -l; echo alive", tmp_path, find_walls())
    assert ending.told.endswith("alive\n")
    assert ending.status == 0


@needs_walls
def test_there_is_no_network(tmp_path):
    import socket

    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        script = f"exec 3<>/dev/tcp/127.0.0.1/{port} && echo open"
        assert "open" in run(script, tmp_path).told
        assert "open" not in run(script, tmp_path, find_walls()).told


def test_walls_that_are_missing_are_told(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    find_walls.cache_clear()
    try:
        found = find_walls()
        assert found.bubblewrap is None
        assert "without walls" in found.told
        assert "not installed" in found.told
        broken = tmp_path / "bwrap"
        broken.write_text("#!/bin/sh\necho no name spaces here >&2\nexit 1\n")
        broken.chmod(0o755)
        find_walls.cache_clear()
        assert "does not work here: no name spaces here" in find_walls().told
    finally:
        find_walls.cache_clear()


def _running(word):
    for entry in Path("/proc").iterdir():
        try:
            if word.encode() in (entry / "cmdline").read_bytes().split(b"\0"):
                return True
        except OSError:
            continue
    return False
