"""Pictures into the standard output, pipes and other descriptors, as shells make them, and text beside them."""

import json
import os
import pty
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from converter.commands import exits
from converter.descriptors import STANDARD_OUTPUT, is_standard_output, named_descriptor

ROOT = Path(__file__).parents[1]
SCENE = """\
0 0 -10   0 0 0   0 1 0   40
2
0 0 0     1 1 1     1 0 0
5 5 -9    .8 .8 .8  1 0 0
1   solid 1 .5 .2
1   .2 .6 .3 20 .2 0 0
1   0 0 sphere 0 0 0 1
"""
NAMES = ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]
NATIVE = "--method native"


@pytest.fixture
def shell(tmp_path):
    """Runs a line of bash in a folder with the scene s.in; `raytrace` and `whitted` are there."""
    (tmp_path / "s.in").write_text(SCENE)
    programs = "\n".join(
        f'{name}() {{ "{sys.executable}" -m converter.commands.{module} "$@"; }}'
        for name, module in (("raytrace", "raytrace"), ("whitted", "main"))
    )

    def run(line, **options):
        options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        return subprocess.run(
            ["bash", "-c", f"{programs}\n{line}"], cwd=tmp_path, env=environment, timeout=120, **options
        )

    return run


@pytest.fixture
def expected(shell, tmp_path):
    """The picture as raytrace writes it into a file, 8 x 6 pixels."""
    assert shell("raytrace s.in expected.ppm 8 6").returncode == 0
    return (tmp_path / "expected.ppm").read_bytes()


def files(folder):
    return sorted(file.name for file in folder.iterdir())


# ---- Where pictures go


@pytest.mark.parametrize("name", NAMES)
def test_into_a_pipe(shell, expected, tmp_path, name):
    child = shell(f"raytrace s.in {name} 8 6 | cat; exit ${{PIPESTATUS[0]}}")
    assert (child.returncode, child.stdout, child.stderr) == (0, expected, b"")
    assert shell(f"whitted render s.in {name} 8 6 {NATIVE} | cat").stdout == expected
    assert files(tmp_path) == ["expected.ppm", "s.in"]


@pytest.mark.parametrize("name", NAMES)
def test_a_file_behind_it_is_written_into_and_not_replaced(shell, expected, tmp_path, name):
    child = shell(
        f"{{ printf head; raytrace s.in {name} 8 6; printf tail; }} > a.ppm; raytrace s.in {name} 8 6 >> a.ppm"
    )
    assert child.stderr == b""
    assert (tmp_path / "a.ppm").read_bytes() == b"head" + expected + b"tail" + expected
    assert files(tmp_path) == ["a.ppm", "expected.ppm", "s.in"]


def test_into_what_a_shell_substitutes(shell, expected, tmp_path):
    child = shell("raytrace s.in >(cat > a.ppm) 8 6; wait $!")
    assert (child.returncode, child.stderr) == (0, b"")
    assert (tmp_path / "a.ppm").read_bytes() == expected


def test_into_another_descriptor(shell, expected, tmp_path):
    child = shell(f"whitted render s.in /dev/fd/3 8 6 {NATIVE} -q --stats 3> a.ppm")
    assert child.returncode == 0
    assert b"all" in child.stdout
    assert (tmp_path / "a.ppm").read_bytes() == expected


def test_into_a_socket(shell, expected):
    """Which no name of it can open again."""
    ours, theirs = socket.socketpair()
    with ours, theirs:
        assert shell("raytrace s.in - 8 6", stdout=theirs).returncode == 0
        assert ours.recv(len(expected) + 1) == expected


@pytest.mark.parametrize("name", ["link", "link.png"])
def test_a_link_to_it(shell, expected, tmp_path, name):
    (tmp_path / name).symlink_to("/dev/stdout")
    child = shell(f"raytrace s.in {name} 8 6")
    assert (child.returncode, child.stderr) == (0, b"")
    assert child.stdout.startswith(b"\x89PNG") if name.endswith("png") else child.stdout == expected
    assert (tmp_path / name).is_symlink()


@pytest.mark.parametrize("name", ["png", ".png", "PNG"])
def test_another_format(shell, tmp_path, name):
    shell(f"whitted render s.in a.png 8 6 {NATIVE}")
    assert shell(f"whitted render s.in - 8 6 {NATIVE} --format {name}").stdout == (tmp_path / "a.png").read_bytes()
    shell(f"whitted render s.in b 8 6 {NATIVE} --format {name}")
    assert (tmp_path / "b").read_bytes() == (tmp_path / "a.png").read_bytes()


def test_an_unknown_format(shell):
    child = shell(f"whitted render s.in - 8 6 {NATIVE} --format gold")
    assert (child.returncode, child.stdout) == (2, b"")
    assert child.stderr.startswith(b"whitted render: /dev/stdout: unknown picture format '.gold'; use one of .ppm")


def test_dev_null(shell):
    child = shell(f"raytrace s.in /dev/null 8 6 && whitted render s.in /dev/null 8 6 -q {NATIVE}")
    assert (child.returncode, child.stdout, child.stderr) == (0, b"", b"")
    assert not Path("/dev/null").is_file()


# ---- Text beside them


def test_what_is_printed_goes_to_stderr(shell, expected):
    child = shell(f"whitted render s.in - 8 6 {NATIVE} --stats")
    assert (child.returncode, child.stdout) == (0, expected)
    assert b"memory peak" in child.stderr
    assert b"/dev/stdout: 8 x 6, native" in child.stderr


def test_what_libraries_print_goes_to_stderr(shell, expected):
    """Mitsuba's log, for one, knows nothing of Python's streams, and C's are kept back until the process ends."""
    program = """if True:
        import ctypes, os, subprocess
        from converter.commands import main
        from converter.renderers.native import NativeRenderer
        render = NativeRenderer.render
        def talkative(*arguments):
            print("python")
            os.write(1, b"descriptor\\n")
            ctypes.CDLL(None).printf(b"library\\n")
            subprocess.run(["echo", "child"])
            return render(*arguments)
        NativeRenderer.render = talkative
        main.main("render s.in - 8 6 --method native -q".split())
        print("after")
    """
    child = shell(f"\"{sys.executable}\" -c '{program}'")
    assert child.stdout == expected + b"after\n"
    assert set(child.stderr.split()) == {b"python", b"descriptor", b"library", b"child"}


def test_the_figure_of_a_comparison(shell, tmp_path):
    words = "whitted compare s.in 8 6 --method native-float --png"
    child = shell(f"{words} -")
    assert child.returncode == 0
    assert b"pixels that disagree" in child.stderr
    assert shell(f"{words} a.png").stdout.startswith(b"reference: native")
    assert child.stdout == (tmp_path / "a.png").read_bytes()


def test_charts_and_their_figures(shell):
    words = "whitted chart s.in --size 4x3 --methods native --runs 2 -q"
    child = shell(f"{words} -o -")
    assert (child.returncode, child.stdout[:5]) == (0, b"<?xml")
    assert b"seconds of a whole process" in child.stderr
    child = shell(f"{words} -o /dev/null --csv -")
    assert child.returncode == 0
    assert child.stdout.startswith(b"scene,width,height")
    assert b"seconds of a whole process" not in child.stdout


@pytest.mark.parametrize("name", ["-", "/dev/stdout", "/dev/fd/1"])
def test_json_takes_the_place_of_the_table(shell, name):
    for command in (f"whitted render s.in a.ppm 8 6 {NATIVE} -q --stats", "whitted inspect s.in", "whitted methods"):
        child = shell(f"{command} --json {name} | cat")
        assert json.loads(child.stdout)


def test_only_one_result(shell):
    for more in ("--json -", "--json /dev/fd/1"):
        child = shell(f"whitted render s.in /dev/stdout 8 6 {more}")
        assert (child.returncode, child.stdout) == (2, b"")
        assert b"only one result can go to the standard output" in child.stderr
    assert shell(f"whitted render s.in - 8 6 {NATIVE} --json - --json a.json").returncode == 0


# ---- What cannot be written into


def test_a_reader_that_goes_away(shell, expected):
    child = shell("raytrace s.in - | head -c 3; exit ${PIPESTATUS[0]}")
    assert (child.returncode, child.stdout, child.stderr) == (exits.BROKEN_PIPE, expected[:3], b"")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("- >&-", "/dev/stdout: nothing is open there"),
        ("/dev/fd/9", "/dev/fd/9: nothing is open there"),
        ("/dev/fd/99999999999999999999", "nothing is open there"),
        ("/dev/stdin < /dev/null", "/dev/stdin: this is open for reading only"),
        ("<(cat s.in)", "this is open for reading only"),
        ("- > /dev/full", "/dev/stdout: no space left on device"),
    ],
)
def test_trouble_is_told(shell, words, message):
    child = shell(f"raytrace s.in {words}")
    assert (child.returncode, child.stdout) == (2, b"")
    assert child.stderr.decode().startswith("raytrace: ")
    assert message in child.stderr.decode()
    assert len(child.stderr.splitlines()) == 1


def test_json_where_nothing_is_open(shell):
    child = shell("whitted inspect s.in --json - >&-")
    assert (child.returncode, child.stderr) == (2, b"whitted inspect: /dev/stdout: nothing is open there\n")


def test_a_terminal_gets_no_picture(shell):
    ours, theirs = pty.openpty()
    try:
        child = shell("raytrace s.in - 8 6", stdout=theirs)
    finally:
        os.close(theirs)
        os.close(ours)
    assert child.returncode == 2
    assert b"this is a terminal, which shows no picture" in child.stderr


@pytest.mark.parametrize("name", ["-", "/dev/stdout", ">(cat)", "/dev/null"])
def test_a_conversion_is_a_folder(shell, tmp_path, name):
    child = shell(f"whitted convert s.in {name}")
    assert (child.returncode, child.stdout) == (2, b"")
    assert b"DIR|FILE.pov: must be a folder, or a file beside its textures, found" in child.stderr
    assert files(tmp_path) == ["s.in"]


# ---- Names


def test_names_of_descriptors(tmp_path):
    assert [named_descriptor(Path(name)) for name in NAMES[1:]] == [1, 1, 1]
    assert named_descriptor(Path("/dev/stderr")) == 2
    for name in ("/dev/null", "/dev/fd", "1", "/dev/fd/x", tmp_path / "1"):
        assert named_descriptor(Path(name)) is None
    loop = tmp_path / "loop"
    loop.symlink_to(loop)
    assert named_descriptor(loop) is None
    (tmp_path / "folder").symlink_to("/dev/fd")
    assert named_descriptor(tmp_path / "folder" / "7") == 7


def test_a_second_descriptor_of_the_standard_output(tmp_path):
    again = os.dup(1)
    try:
        assert is_standard_output(Path(f"/dev/fd/{again}"))
    finally:
        os.close(again)
    assert is_standard_output(STANDARD_OUTPUT)
    with (tmp_path / "a").open("w") as opened:
        assert not is_standard_output(Path(f"/dev/fd/{opened.fileno()}"))
