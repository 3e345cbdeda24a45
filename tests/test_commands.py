"""The programs, through `main(argv)`: options, messages, exit statuses, and files that appear whole or not at all."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from array import array
from pathlib import Path

import pytest
from variant import VARIANT

from converter.commands import exits, main, raytrace
from converter.renderers.base import Interrupted, RendererUnavailable, Rendering
from converter.renderers.native import NativeRenderer

SCENE = """\
0 0 -10
0 0 0
0 1 0
40
2
0 0 0 1 1 1 1 0 0
5 5 -9 .8 .8 .8 1 0 0
3
solid 1 .5 .2
checker .1 .2 .3 .9 .8 .7 1
solid 0 0 1
3
.2 .6 .3 20 .2 0 0
.3 .5 0 1 0 0 0
.1 .1 .3 100 .1 .8 1.5
3
0 0 sphere 0 0 0 1
0 2 sphere 1.5 0 -2 .7
1 1 sphere 0 -101.5 0 100
"""
ON_VARIANT = ("--variant", VARIANT)


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "small.in"
    file.write_text(SCENE)
    return file


@pytest.fixture
def bad_scene(tmp_path):
    file = tmp_path / "bad.in"
    file.write_text(SCENE.replace("solid 1 .5 .2", "sollid 1 .5 .2"))
    return file


def rendering_of(width, height, value=0.5):
    pixels = memoryview(array("f", [value] * (3 * width * height))).cast("B").cast("f", (height, width, 3))
    return Rendering(pixels, width, height, {"render": 0.0})


def ppm_pixels(file):
    """Width, height and bytes of a P6 file."""
    data = file.read_bytes()
    magic, width, height, maxval = data.split(maxsplit=4)[:4]
    assert (magic, maxval) == (b"P6", b"255")
    return int(width), int(height), data[-3 * int(width) * int(height) :]


# ---- The programs themselves


def test_help_names_every_command(whitted):
    status, out, err = whitted("--help")
    assert (status, err) == (0, "")
    assert all(f"  {name} " in out for name in main.COMMANDS)


@pytest.mark.parametrize("name", main.COMMANDS)
def test_each_command_has_help_with_an_example(whitted, name):
    status, out, _ = whitted(name, "--help")
    assert status == 0
    assert out.startswith(f"usage: whitted {name} ")
    assert f"example:\n  whitted {name}" in out
    assert max(map(len, out.splitlines())) <= 120
    assert whitted("help", name) == (0, out, "")


def test_without_a_command_help_goes_to_stderr(whitted):
    status, out, err = whitted()
    assert (status, out) == (2, "")
    assert "commands:" in err


def test_unknown_command(whitted):
    assert whitted("rendr") == (
        2,
        "",
        "whitted: there is no command 'rendr' (did you mean 'render'?)\nTry 'whitted --help'.\n",
    )


def test_version(whitted, capsys):
    assert whitted("--version")[1].startswith("whitted ")
    assert raytrace.main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("raytrace ")


def test_light_start(tmp_path):
    """Nothing heavy is imported for help, nor for the course's program as long as its textures are PPM files."""
    code = """if True:
        import sys
        from converter.commands import main, raytrace
        main.main(["--help"]); raytrace.main(sys.argv[1:])
        heavy = {"numpy", "mitsuba", "drjit", "rich", "OpenImageIO", "shutil", "matplotlib"} & set(sys.modules)
        assert not heavy, heavy
    """
    figure1 = Path(__file__).parents[1] / "scenes" / "figure1.in"
    child = subprocess.run(
        [sys.executable, "-c", code, str(figure1), str(tmp_path / "a.ppm")], capture_output=True, text=True
    )
    assert "AssertionError" not in child.stderr, child.stderr


# ---- raytrace


def test_raytrace_draws_800_by_600(scene, tmp_path, capsys):
    assert raytrace.main([str(scene), str(tmp_path / "a.ppm")]) == 0
    assert ppm_pixels(tmp_path / "a.ppm")[:2] == (800, 600)
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("name", ["picture", "picture.dat", "picture.ppm"])
def test_raytrace_writes_ppm_whatever_the_name(scene, tmp_path, name):
    assert raytrace.main([str(scene), str(tmp_path / name), "40", "30"]) == 0
    assert ppm_pixels(tmp_path / name)[:2] == (40, 30)
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted([name, "small.in"])


def test_raytrace_into_a_pipe(scene, tmp_path):
    """It stays one: /dev/null would be no more than a picture otherwise."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with os.fdopen(
        os.open(pipe, os.O_RDWR), "rb", buffering=0
    ) as reader:  # both ends, so that neither waits for the other
        assert raytrace.main([str(scene), str(pipe), "4", "3"]) == 0
        assert reader.read(11) == b"P6\n4 3\n255\n"
    assert pipe.is_fifo()


def test_raytrace_never_draws_over_the_scene(scene, tmp_path, capsys):
    text = scene.read_text()
    (tmp_path / "link").symlink_to(scene)
    for out in (scene, tmp_path / "link"):
        assert raytrace.main([str(scene), str(out), "4", "3"]) == 2
        told = f"raytrace: {out}: this is read, and the result would replace it\n"
        assert capsys.readouterr().err == told
    assert scene.read_text() == text


def test_no_result_takes_the_place_of_what_it_is_made_from(scene, whitted, tmp_path):
    """A scene, another image, a texture."""
    (tmp_path / "image.ppm").write_text("P3 1 1 255  255 0 0\n")
    scene.write_text(SCENE.replace("solid 0 0 1", "texmap image.ppm 0 1 0 0 0 0 0 0"))
    before = {file: file.read_bytes() for file in tmp_path.iterdir()}
    image = str(tmp_path / "image.ppm")
    named = tmp_path / "scene.svg"
    named.symlink_to(scene)
    other = str(tmp_path / "new.png")
    for words in (
        ["render", scene, image, "4", "3", "--method", "native"],
        ["render", scene, other, "4", "3", "--method", "native", "--json", scene],
        ["inspect", scene, "--json", scene],
        ["pixel", scene, "1", "1", "4", "3", "--json", scene],
        ["compare", scene, "4", "3", "--json", scene],
        ["compare", image, image, "--png", image],
        ["compare", image, image, "--json", image],
        ["chart", scene, "-o", named],
        ["chart", scene, "-o", str(tmp_path / "new.svg"), "--csv", scene],
        ["chart", scene, "-o", str(tmp_path / "new.svg"), "--json", scene],
    ):
        status, _, err = whitted(*map(str, words))
        assert status == 2, words
        assert "this is read, and the result would replace it" in err, words
    assert {file: file.read_bytes() for file in tmp_path.iterdir() if file != named} == before


def test_names_are_harmless_to_a_terminal(whitted, tmp_path):
    status, _, err = whitted("inspect", str(tmp_path / "a\x1b[31mb.in"))
    assert status == 2
    assert "a?[31mb.in" in err
    assert "\x1b" not in err


def test_raytrace_leaves_a_file_of_a_similar_name(scene, tmp_path):
    other = tmp_path / ".picture.ppm"
    other.write_text("another")
    assert raytrace.main([str(scene), str(tmp_path / "picture"), "4", "3"]) == 0
    assert other.read_text() == "another"


def test_raytrace_goes_by_a_known_ending(scene, tmp_path):
    assert raytrace.main([str(scene), str(tmp_path / "a.png"), "4", "3"]) == 0
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "required: SCENE, OUT"),
        (["a.in"], "required: OUT"),
        (["a.in", "a.ppm", "40"], "a WIDTH needs a HEIGHT after it"),
        (["a.in", "a.ppm", "40", "x"], "must be a whole number, found 'x'"),
        (["a.in", "a.ppm", "0", "3"], "must lie between 1 and 1000000, found 0"),
        (["a.in", "a.ppm", "3", "1000001"], "must lie between 1 and 1000000, found 1000001"),
        (["a.in", "a.ppm", "4", "3", "2"], "unrecognized arguments: 2"),
    ],
)
def test_raytrace_usage(words, message, capsys):
    assert raytrace.main(words) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert message in err
    assert err.startswith("raytrace: ")
    assert err.endswith("\nTry 'raytrace --help'.\n")
    assert len(err.splitlines()) == 2


def test_raytrace_of_a_bad_scene(bad_scene, tmp_path, capsys):
    assert raytrace.main([str(bad_scene), str(tmp_path / "a.ppm")]) == 2
    assert f"{bad_scene}:9:1: expected solid" in capsys.readouterr().err
    assert not (tmp_path / "a.ppm").exists()


def test_raytrace_into_a_folder(scene, tmp_path, capsys):
    assert raytrace.main([str(scene), str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"raytrace: {tmp_path}: this is a folder\n"


# ---- render


def test_render_with_the_native_tracer(whitted, scene, tmp_path):
    out_file = tmp_path / "a.ppm"
    status, out, err = whitted("render", scene, out_file, 40, 30, "--method", "native")
    assert (status, out) == (0, "")
    assert err.splitlines()[0].startswith(f"note: {scene}:15: finish 2: ior 1.5")
    assert err.splitlines()[1].startswith(f"{out_file}: 40 x 30, native, ")
    assert ppm_pixels(out_file)[:2] == (40, 30)


def test_size_may_follow_the_options(whitted, scene, tmp_path):
    assert whitted("render", "--method", "native", scene, tmp_path / "a.ppm", "--pixel", "center", 8, 6)[0] == 0
    assert ppm_pixels(tmp_path / "a.ppm")[:2] == (8, 6)


def test_quiet_says_nothing(whitted, scene, tmp_path):
    assert whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native", "--quiet") == (0, "", "")


def test_pixels_that_are_no_numbers_are_told(whitted, scene, tmp_path):
    """0 times infinity: a light beyond all numbers that has no blue."""
    scene.write_text(SCENE.replace("5 5 -9 .8 .8 .8 1 0 0", "5 5 -9 .8 .8 0 5e-324 0 0"))
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native")
    assert status == 0
    assert re.search(r"a\.ppm: \d+ of 48 pixels are NaN: the colours there exceed all numbers", err)
    assert "NaN" not in whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native", "--quiet")[2]


def test_stats_go_to_stdout(whitted, scene, tmp_path):
    _, out, _ = whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native", "--stats")
    rows = dict(line.split(maxsplit=1) for line in out.splitlines())
    assert rows["primary"] == "48"
    assert rows["memory"].endswith("MiB")
    assert {"read", "build", "render", "write", "all", "rays"} <= rows.keys()


def test_stats_as_json(whitted, scene, tmp_path):
    _, out, _ = whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native", "--json", "-", "-q")
    found = json.loads(out)
    assert found["method"] == "native"
    assert list(found["seconds"]) == ["read", "build", "render", "write"]
    assert found["statistics"]["primary"] == 48


@pytest.mark.parametrize(
    ("options", "settings"),
    [
        ([], {}),
        (["--pixel", "center"], {"pixel": "center"}),
        (["--specular", "blinn"], {"specular": "blinn"}),
        (["--ior", "ratio"], {"ior": "ratio"}),
        (["--background", "0,.5,1e3"], {"background": (0.0, 0.5, 1000.0)}),
        (["--background=-1,0,0"], {"background": (-1.0, 0.0, 0.0)}),
        (["--cutoff", "0"], {"cutoff": 0.0}),
        (["--max-depth", "3"], {"max_depth": 3}),
        (["--samples", "9"], {"samples": 9}),
        (["--seed", "7"], {"seed": 7}),
        (["--threads", "1"], {"threads": 1}),
    ],
)
def test_options_become_settings(whitted, scene, tmp_path, monkeypatch, options, settings):
    from converter.scene.settings import Settings

    seen = []

    def render(self, scene, given, progress=None):
        seen.append(given)
        return rendering_of(8, 6)

    monkeypatch.setattr(NativeRenderer, "render", render)
    assert whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native", *options)[0] == 0
    assert seen == [Settings(width=8, height=6, **settings)]


@pytest.mark.parametrize(
    ("method", "precision", "settings"),
    [
        ("native", "double", {}),
        ("native-float", "float", {}),
        ("native-long-double", "long double", {}),
        ("native:cutoff=1/64", "double", {"cutoff": 1 / 64}),
        ("native:max_depth=3", "double", {"max_depth": 3}),
        ("native:threads=1", "double", {"threads": 1}),
    ],
)
def test_a_method_is_a_renderer_with_settings(whitted, scene, tmp_path, monkeypatch, method, precision, settings):
    from converter.scene.settings import Settings

    seen = []

    def render(self, scene, given, progress=None):
        seen.append((self.precision, given))
        return rendering_of(4, 3)

    monkeypatch.setattr(NativeRenderer, "render", render)
    _, _, err = whitted("render", scene, tmp_path / "a.ppm", 4, 3, "--method", method)
    assert seen == [(precision, Settings(width=4, height=3, **settings))]
    assert f", {method}, " in err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["8"], "a WIDTH needs a HEIGHT after it"),
        (["--samples", "8"], "argument --samples: must be a square number such as 4 or 9, found 8"),
        (["--samples", "0"], "argument --samples: must lie between 1 and 65536, found 0"),
        (["--cutoff", "-1"], "argument --cutoff: must not be negative, found -1"),
        (["--cutoff", "nan"], "argument --cutoff: must be finite, found 'nan'"),
        (["--background", "1,2"], "argument --background: must be three numbers with commas between them, found '1,2'"),
        (["--background", "1,2,inf"], "argument --background: must be finite, found 'inf'"),
        (["--max-depth", "-1"], "argument --max-depth: must lie between 0 and 1000, found -1"),
        (["--max-depth", "many"], "argument --max-depth: must be a whole number, found 'many'"),
        (["--seed", "-1"], "argument --seed: must lie between 0 and 4294967295, found -1"),
        (["--pixel", "middle"], "argument --pixel: invalid choice: 'middle'"),
        (["--pix", "center"], "unrecognized arguments: --pix"),
        (["--method", "nativ"], "argument --method: there is no method 'nativ' (did you mean 'native'?)"),
        (["--method", "native", "--variant", "auto"], "--variant is for Mitsuba, and native draws"),
        (["--method", "mitsuba-cuda", "--variant", "auto"], "--variant: the method mitsuba-cuda has its own"),
        (["--method", "native:cutoff=1/64", "--cutoff", "0"], "--cutoff: the method native:cutoff=1/64 has its own"),
        (
            ["--method", "native:max_depth=2", "--max-depth", "2"],
            "--max-depth: the method native:max_depth=2 has its own",
        ),
        (["--method", "native:threads=1", "--threads", "1"], "--threads: the method native:threads=1 has its own"),
    ],
)
def test_render_usage(whitted, scene, tmp_path, options, message):
    status, out, err = whitted("render", scene, tmp_path / "a.ppm", *options)
    assert (status, out) == (2, "")
    assert err.startswith(f"whitted render: {message}")
    assert err.endswith("\nTry 'whitted render --help'.\n")
    assert not (tmp_path / "a.ppm").exists()


def test_the_output_is_checked_before_anything_is_read(whitted, tmp_path):
    status, _, err = whitted("render", tmp_path / "missing.in", tmp_path / "nowhere" / "a.ppm")
    assert status == 2
    assert "there is no folder" in err
    status, _, err = whitted("render", tmp_path / "missing.in", tmp_path / "a.ppm")
    assert (status, err) == (2, f"{tmp_path}/missing.in: there is no such file\n")


def test_a_missing_texture(whitted, tmp_path):
    file = tmp_path / "a.in"
    file.write_text(SCENE.replace("solid 1 .5 .2", "texmap nix.ppm 1 0 0 0 0 1 0 0"))
    status, _, err = whitted("render", file, tmp_path / "a.ppm", "--method", "native")
    assert status == 2
    assert f"{file}:9:8: " in err
    assert "nix.ppm: no such file" in err


def test_a_renderer_that_is_not_there(whitted, scene, tmp_path, monkeypatch):
    def render(self, *_):
        raise RendererUnavailable("the native tracer is not built; run make")

    monkeypatch.setattr(NativeRenderer, "render", render)
    assert whitted("render", scene, tmp_path / "a.ppm", "--method", "native", "-q") == (
        3,
        "",
        "whitted render: the native tracer is not built; run make\n",
    )


@pytest.mark.parametrize(
    ("error", "status"), [(MemoryError(), 2), (OSError(28, "No space left on device", "x.ppm"), 2)]
)
def test_errors_that_users_can_mend_are_told_without_a_traceback(whitted, scene, tmp_path, monkeypatch, error, status):
    def render(self, *_):
        raise error

    monkeypatch.setattr(NativeRenderer, "render", render)
    found, _, err = whitted("render", scene, tmp_path / "a.ppm", "--method", "native", "-q")
    assert found == status
    assert err.startswith("whitted render: ")
    assert len(err.splitlines()) == 1
    assert not (tmp_path / "a.ppm").exists()


def test_bugs_keep_their_traceback(scene, tmp_path, monkeypatch):
    def render(self, *_):
        raise ZeroDivisionError

    monkeypatch.setattr(NativeRenderer, "render", render)
    with pytest.raises(ZeroDivisionError):
        main.main(["render", str(scene), str(tmp_path / "a.ppm"), "--method", "native"])


# ---- Ctrl-C


@pytest.fixture
def interrupted(monkeypatch):
    def render(self, *_):
        raise Interrupted(rendering_of(8, 6, 1.0))

    monkeypatch.setattr(NativeRenderer, "render", render)


def test_ctrl_c_leaves_no_file(whitted, scene, tmp_path, interrupted):
    (tmp_path / "a.ppm").write_text("older")
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native", "-q")
    assert (status, err) == (130, "whitted render: interrupted\n")
    assert (tmp_path / "a.ppm").read_text() == "older"
    assert len(list(tmp_path.iterdir())) == 2


def test_ctrl_c_with_keep_partial_writes_what_is_there(whitted, scene, tmp_path, interrupted):
    status, _, err = whitted("render", scene, tmp_path / "a.ppm", 8, 6, "--method", "native", "--keep-partial")
    assert status == 130
    assert f"{tmp_path}/a.ppm: only a part of the picture" in err
    assert ppm_pixels(tmp_path / "a.ppm") == (8, 6, b"\xff" * 144)


def test_ctrl_c_anywhere_else(whitted, scene, tmp_path, monkeypatch):
    def render(self, *_):
        raise KeyboardInterrupt

    monkeypatch.setattr(NativeRenderer, "render", render)
    assert whitted("render", scene, tmp_path / "a.ppm", "--method", "native")[0] == 130


def test_an_error_that_ctrl_c_turned_into(whitted, scene, tmp_path, monkeypatch):
    def render(self, *_):
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(5)
        except KeyboardInterrupt as error:
            raise RuntimeError("encountered an exception") from error

    monkeypatch.setattr(NativeRenderer, "render", render)
    assert whitted("render", scene, tmp_path / "a.ppm", "--method", "native")[0] == 130
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_sigterm_leaves_no_file(scene, tmp_path, monkeypatch, capsys):
    def write(path, *_):
        path.write_text("half")
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(5)

    (tmp_path / "a.ppm").write_text("older")
    monkeypatch.setattr("converter.images.write._write_ppm", write)
    assert raytrace.main([str(scene), str(tmp_path / "a.ppm"), "8", "6"]) == 143
    assert capsys.readouterr().err.endswith("raytrace: interrupted\n")
    assert (tmp_path / "a.ppm").read_text() == "older"
    assert len(list(tmp_path.iterdir())) == 2
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def test_ctrl_c_during_an_import_ends_the_process_at_once(tmp_path):
    """Else a compiled module that is half loaded may abort it."""
    (tmp_path / "slow.py").write_text(
        "import time\ntry:\n    print('loading', flush=True)\n    time.sleep(30)\nexcept KeyboardInterrupt:\n    pass\n"
    )
    code = "import importlib, sys; from converter.commands.exits import run\n"
    code += "sys.exit(run('program', lambda: importlib.import_module('slow') and 0))"
    paths = [str(tmp_path), str(Path(__file__).parents[1])]
    child = subprocess.Popen(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert child.stdout.readline() == "loading\n"
    child.send_signal(signal.SIGINT)
    _, err = child.communicate(timeout=20)
    assert (child.returncode, err) == (130, "program: interrupted\n")


# ---- Terminals and pipes


def test_no_progress_bar_in_a_pipe(whitted, scene, tmp_path, monkeypatch):
    monkeypatch.setattr("converter.commands.progress.PATIENCE", 0.0)
    assert whitted("render", scene, tmp_path / "a.ppm", 40, 30, "--method", "native", "-q") == (0, "", "")


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_progress_bar_on_a_terminal(monkeypatch):
    from converter.commands import progress

    monkeypatch.setenv("TERM", "xterm")
    terminal = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    with progress.ProgressBar("a [b].ppm") as quick:
        quick(0.5)
    assert terminal.getvalue() == ""
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    with progress.ProgressBar("a.ppm", quiet=True) as quiet:
        quiet(0.5)
    assert terminal.getvalue() == ""
    with progress.ProgressBar("a [b].ppm") as shown:
        shown(0.5)
        shown(1.0)
    assert "a [b].ppm" in terminal.getvalue()


def test_tables_on_a_terminal(monkeypatch):
    from converter.commands.tables import print_table

    terminal = Terminal()
    monkeypatch.setattr(sys, "stdout", terminal)
    monkeypatch.setenv("TERM", "dumb")
    print_table([("[red]", "1")], ("name", "count"), "lr", "title [b]")
    assert "title [b]" in terminal.getvalue()
    assert "[red]" in terminal.getvalue()


def test_a_pipe_that_is_closed_ends_silently(scene):
    command = f"{sys.executable} -m converter.commands.main inspect {scene} | exec true; exit ${{PIPESTATUS[0]}}"
    child = subprocess.run(
        ["bash", "-c", f"sleep 0; {command}"],
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])},
        capture_output=True,
        text=True,
    )
    assert child.stderr == ""
    assert child.returncode in (0, exits.BROKEN_PIPE)  # 0 where it had written all before the pipe was closed


def test_a_closed_stderr_does_not_spill_into_stdout(monkeypatch, capsys):
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stderr", None)
        assert main.main(["rendr"]) == 2
    assert capsys.readouterr() == ("", "")


def test_a_file_name_that_is_no_text(whitted, tmp_path):
    name = os.fsdecode(b"caf\xe9.in")
    (tmp_path / name).write_text(SCENE)
    status, out, _ = whitted("inspect", tmp_path / name)
    assert status == 0
    assert "caf\\udce9.in" in out


# ---- inspect


def test_inspect(whitted, scene):
    status, out, err = whitted("inspect", scene)
    assert (status, err) == (0, "")
    assert out.splitlines()[0] == str(scene)
    assert "3 spheres" in out
    assert "shadows, highlights, reflection, refraction" in out
    assert "rays split in two" in out
    assert "unused pigments  2" in out
    assert "note: " in out


def test_inspect_json(whitted, scene, tmp_path):
    status, out, _ = whitted("inspect", scene, "--json", "-", "--max-depth", "5")
    found = json.loads(out)
    assert status == 0
    assert found["objects"] == {
        "count": 3,
        "kinds": {"sphere": 3},
        "planes": 0,
        "redundant_planes": 0,
        "unbounded": 0,
    }
    assert found["needs"]["max_depth"] == 5
    assert found["unused"] == {"pigments": [2], "finishes": []}
    assert found["finishes"][2]["ior_read_as"] == "n2/n1"
    assert found["finishes"][0]["ior_read_as"] is None
    assert [pigment["objects"] for pigment in found["pigments"]] == [2, 1, 0]
    assert 0 < found["cutoff"]["bound"] < 1
    assert len(found["notices"]) == 1
    whitted("inspect", scene, "--json", tmp_path / "a.json", "--max-depth", "5")
    assert json.loads((tmp_path / "a.json").read_text()) == found


@pytest.mark.parametrize(
    ("old", "new", "cutoff", "told"),
    [
        (".1 .1 .3 100 .1 .8 1.5", "1 0 0 1 0 0 0", 1 / 512, "1/512: no channel is off by more than 0.00"),
        (".1 .1 .3 100 .1 .8 1.5", "1 0 0 1 0 0 0", 0, "0: drops no ray"),
        (
            ".2 .6 .3 20 .2 0 0",
            "1 0 0 1 0 0 0",
            0.3,
            "0.3: the bound is loose here; whitted compare --reference native:cutoff=1/4096",
        ),
        (
            "5 5 -9 .8 .8 .8 1 0 0",
            "1 0 0 .8 .8 .8 0 1 0",
            1 / 512,
            "light 1's attenuation may be 0 on object 0 (line 17)",
        ),
    ],
)
def test_inspect_tells_what_the_cut_off_costs(whitted, tmp_path, old, new, cutoff, told):
    file = tmp_path / "a.in"
    file.write_text(SCENE.replace(old, new))
    status, out, _ = whitted("inspect", file, "--cutoff", cutoff)
    (line,) = [line for line in out.splitlines() if line.startswith("cut-off")]
    assert status == 0
    assert told in line


def test_inspect_names_the_methods_that_fail_in_one_line(whitted, scene):
    scene.write_text(SCENE.replace("0 0 sphere 0 0 0 1", "0 0 sphere 0 0 1e7 1"))
    _, out, _ = whitted("inspect", scene)
    told = [line for line in out.splitlines() if "known to fail" in line]
    assert len(told) == 1
    assert told[0].startswith("note: other methods are known to fail here: native-float, ")
    assert len(json.loads(whitted("inspect", scene, "--json", "-")[1])["warnings"]) > 2
    scene.write_text(SCENE.replace("0 0 sphere 0 0 0 1", "0 0 sphere 0 0 1e15 1"))
    assert "\nwarning: " in whitted("inspect", scene)[1]  # the default fails, too


def test_inspect_finds_planes_that_cut_nothing(whitted, tmp_path):
    file = tmp_path / "a.in"
    cube = "0 0 polyhedron 7 1 0 0 -1 -1 0 0 -1 0 1 0 -1 0 -1 0 -1 0 0 1 -1 0 0 -1 -1 1 0 0 -5"
    slab = "0 0 polyhedron 2 0 1 0 3 0 -1 0 -4"
    file.write_text(SCENE.replace("\n3\n0 0 sphere 0 0 0 1\n", f"\n5\n{cube}\n{slab}\n0 0 sphere 0 0 0 1\n"))
    _, out, _ = whitted("inspect", file, "--json", "-")
    found = json.loads(out)
    assert found["objects"]["redundant_planes"] == 1
    assert found["objects"]["unbounded"] == 1
    assert [(p["redundant_planes"], p["bounded"]) for p in found["polyhedra"]] == [([6], True), ([], False)]
    _, out, _ = whitted("inspect", file)
    assert "9, redundant: 1" in out
    assert "unbounded" in out and " 1 object\n" in out


def test_inspect_names_quadrics(whitted, tmp_path):
    file = tmp_path / "a.in"
    cone, slab = "0 0 quadric 1 1 -1 0 0 0 0 0 0 0", "0 0 quadric 1 0 0 0 0 0 0 0 0 -1"
    ball, outside = "0 0 quadric 1 1 1 0 0 0 0 0 0 -1", "0 0 quadric -1 -1 -1 0 0 0 0 0 0 1"
    file.write_text(SCENE.replace("\n3\n0 0 sphere", f"\n7\n{cone}\n{slab}\n{ball}\n{outside}\n0 0 sphere"))
    _, out, _ = whitted("inspect", file, "--json", "-")
    found = json.loads(out)
    assert found["objects"]["kinds"] == {"quadric": 4, "sphere": 3}
    assert found["objects"]["unbounded"] == 3
    assert [(q["kind"], q["drawn_as"], q["bounded"]) for q in found["quadrics"]] == [
        ("cone", "quadric", False),
        ("parallel planes", "polyhedron", False),
        ("ellipsoid", "sphere", True),
        ("complement of an ellipsoid", "quadric", False),
    ]
    _, out, _ = whitted("inspect", file)
    assert "unbounded" in out and " 3 objects\n" in out
    assert "complement of an ellipsoid" in out


def test_json_into_no_folder(whitted, scene, tmp_path):
    status, _, err = whitted("inspect", scene, "--json", tmp_path / "nowhere" / "a.json")
    assert status == 2
    assert err == f"whitted inspect: {tmp_path}/nowhere/a.json: there is no folder '{tmp_path}/nowhere'\n"


# ---- pixel


def test_pixel_of_one_renderer(whitted, scene):
    status, out, err = whitted("pixel", scene, 20, 14, 40, 30, "--method", "native", "-q")
    assert (status, err) == (0, "")
    lines = out.splitlines()
    assert lines[0] == f"{scene} at 40 x 30, pixel (20, 14): native"
    assert "#0 sphere (17)" in lines[3]
    assert "light 1 adds" in lines[4]
    assert lines[-1].startswith("colour  native  ")


def test_pixel_by_two_methods_of_one_initial(whitted, scene, monkeypatch):
    right = NativeRenderer.trace_pixel

    def wrong(self, *arguments):
        tree = right(self, *arguments)
        tree.rays[0].hit.t += 0.25 if self.precision == "float" else 0.0
        return tree

    monkeypatch.setattr(NativeRenderer, "trace_pixel", wrong)
    _, out, _ = whitted("pixel", scene, 20, 14, 40, 30, "--method", "native-float", "-q")
    assert "pixel (20, 14): native | native-float\n" in out
    assert [line[:11] for line in out.splitlines() if line.startswith(">")][::2] == [">1 primary ", ">2 primary "]


def test_pixel_by_a_method_that_does_not_tell_its_rays(whitted, scene, monkeypatch):
    monkeypatch.delattr(NativeRenderer, "trace_pixel")
    status, _, err = whitted("pixel", scene, 20, 14, 40, 30, "--method", "native")
    assert (status, err.splitlines()[0]) == (2, "whitted pixel: native does not tell its rays")


@pytest.mark.parametrize(("x", "y"), [(40, 0), (0, 30)])
def test_pixel_outside_the_picture(whitted, scene, x, y):
    status, _, err = whitted("pixel", scene, x, y, 40, 30)
    assert status == 2
    assert f"pixel ({x}, {y}) lies outside the picture of 40 x 30 pixels" in err


def test_pixel_in_both_renderers(whitted, scene, mi):
    status, out, _ = whitted("pixel", scene, 20, 14, 40, 30, *ON_VARIANT)
    assert status == 0
    assert "\nno difference\n" in out
    _, out, _ = whitted("pixel", scene, 20, 14, 40, 30, "--json", "-", "-q", *ON_VARIANT)
    trees = json.loads(out)
    assert list(trees) == ["native", "mitsuba"]
    assert all(tree["rays"][0]["hit"]["object"] == 0 for tree in trees.values())


def test_pixel_marks_and_tells_the_first_difference(whitted, scene, monkeypatch):
    from converter.renderers.mitsuba import MitsubaRenderer

    def wrong(self, scene, settings, x, y):
        tree = NativeRenderer().trace_pixel(scene, settings, x, y)
        tree.rays[0].hit.t += 0.25
        return tree

    monkeypatch.setattr(MitsubaRenderer, "trace_pixel", wrong)
    _, out, _ = whitted("pixel", scene, 20, 14, 40, 30, "-q")
    marked = [line for line in out.splitlines() if line.startswith(">")]
    assert marked[0].startswith(">n primary")
    assert any(line.startswith(">m primary") for line in marked)
    assert "first difference: the primary ray at depth 0 of throughput 1\n" in out
    assert out.splitlines()[-1].startswith("t ")


# ---- compare


def test_compare_both_renderers(whitted, scene, tmp_path, mi):
    png, file = tmp_path / "a.png", tmp_path / "a.json"
    status, out, _ = whitted("compare", scene, 40, 30, "--repeat", 2, "--png", png, "--json", file, *ON_VARIANT)
    assert status == 0
    assert "pixels that disagree  0 of 1200, 0 %" in out
    assert "warm (median of 2)" in out
    assert out.splitlines()[-1].startswith("agreement: ")
    assert png.read_bytes().startswith(b"\x89PNG")
    found = json.loads(file.read_text())
    assert found["disagreeing_percent"] == 0
    assert found["agrees"] is True
    assert list(found["seconds"]) == ["native", "mitsuba"]
    assert all(len(times["warm"]) == 2 for times in found["seconds"].values())


def test_compare_other_methods(whitted, scene):
    status, out, _ = whitted(
        "compare", scene, 40, 30, "--method", "native:max_depth=1", "--reference", "native:cutoff=0"
    )
    assert status == 1
    assert out.splitlines()[:2] == [
        "reference: native:cutoff=0, which is trusted",
        "candidate: native:max_depth=1, 40 x 30 pixels",
    ]


@pytest.fixture
def images(tmp_path):
    from converter.images.write import write_image

    for name, size, value in (("a.exr", 8, 0.5), ("b.ppm", 8, 0.5), ("c.png", 8, 0.9), ("d.exr", 4, 0.5)):
        write_image(tmp_path / name, rendering_of(size, 6, value).pixels, size, 6)
    return tmp_path


def test_compare_images_that_agree(whitted, images):
    status, out, err = whitted("compare", images / "a.exr", images / "b.ppm")
    assert (status, err) == (0, f"note: {images}/b.ppm holds no colours beyond 0..1: both are clamped\n")
    assert out.splitlines()[:2] == [
        f"reference: {images}/a.exr, which is trusted",
        f"candidate: {images}/b.ppm, 8 x 6 pixels",
    ]
    assert "seconds" not in out


def test_compare_images_that_do_not(whitted, images):
    status, out, _ = whitted("compare", images / "a.exr", images / "c.png", "--json", "-")
    assert status == 1
    assert json.loads(out)["disagreeing_percent"] == 100
    assert whitted("compare", images / "a.exr", images / "c.png", "--limit", "100")[0] == 0


def test_an_image_that_cannot_hold_more_than_white_is_compared_with_the_other_clamped(whitted, images):
    from converter.images.write import write_image

    for name in ("white.exr", "white.png"):
        write_image(images / name, rendering_of(8, 6, 3.0).pixels, 8, 6)
    assert whitted("compare", images / "white.exr", images / "white.png", "-q")[0] == 0


def test_compare_images_of_different_sizes(whitted, images):
    status, _, err = whitted("compare", images / "a.exr", images / "d.exr")
    assert (status, err) == (2, "whitted compare: the sizes differ: 8 x 6 and 4 x 6 pixels\n")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["a.png", "missing.png"], "missing.png: no such file"),
        (["small.in", "8"], "perhaps a picture and perhaps WIDTH HEIGHT, or two images, found 2 arguments"),
        (["small.in", "8", "6", "4"], "found 4 arguments"),
        (["small.in", "8", "x"], "WIDTH and HEIGHT: each must be a whole number, found 'x'"),
        (["small.in", "--limit", "-1"], "argument --limit: must not be negative"),
        (["small.in", "--method", "native"], "--reference and --method are both native: nothing to compare"),
        (["small.in", "--reference", "nativ"], "argument --reference: there is no method 'nativ'"),
        (["small.in", "--reference", "native:cutoff=0", "--cutoff", "1"], "--cutoff: the method native:cutoff=0 has"),
        (
            ["small.in", "--method", "native-float", "--variant", "auto"],
            "for Mitsuba, and native and native-float draw",
        ),
        (["small.in", "--png", "nowhere/a.png"], "there is no folder"),
        (["small.in", "--json", "nowhere/a.json"], "there is no folder"),
    ],
)
def test_compare_usage(whitted, images, scene, monkeypatch, words, message):
    monkeypatch.chdir(images)
    (images / "a.png").write_bytes((images / "c.png").read_bytes())
    status, _, err = whitted("compare", *words)
    assert status == 2
    assert message in err


# ---- convert, doctor


def test_convert(whitted, scene, tmp_path, mi):
    folder = tmp_path / "out"
    status, out, err = whitted("convert", scene, folder, 40, 30, "--quiet")
    assert (status, out, err) == (0, "", "")
    status, out, _ = whitted("convert", scene, folder, 40, 30)
    assert status == 0
    assert f"{folder}/scene.xml\n" in out
    python = out[out.index("import mitsuba") :]
    assert len(python.splitlines()) == 4
    assert python.splitlines()[-1] == 'mitsuba_plugins.write_image("picture.png", image)'
    assert f"load_file('{folder}/scene.xml')" in python
    assert mi.load_file(str(folder / "scene.xml")).sensors()[0].film().crop_size()[0] == 40


def test_convert_makes_no_thousands_of_shapes(whitted, tmp_path, mi):
    """Each would be a plugin of its own; the integrator draws the scene without them."""
    import numpy as np

    from converter.renderers.mitsuba import MitsubaRenderer
    from converter.scene.parser import load_scene
    from converter.scene.settings import Settings

    file = tmp_path / "large.in"
    program = Path(__file__).parent.parent / "scenes" / "large.py"
    subprocess.run([sys.executable, program, "sphereflake", "4", file], check=True)
    status, _, err = whitted("convert", file, tmp_path / "out", 80, 60)
    assert status == 0
    assert "the `whitted` integrator alone sees them" in err
    assert "<shape" not in (tmp_path / "out" / "scene.xml").read_text()
    exported = np.asarray(mi.render(mi.load_file(str(tmp_path / "out" / "scene.xml"))))
    rendered = MitsubaRenderer(VARIANT).render(load_scene(file), Settings(width=80, height=60))
    assert np.array_equal(exported, rendered.pixels)


def test_convert_refuses_a_folder_of_others(whitted, scene, tmp_path):
    status, _, err = whitted("convert", scene, tmp_path, "-q")
    assert status == 2
    assert err.startswith(f"whitted convert: {tmp_path} holds files")


def test_doctor(whitted):
    status, out, _ = whitted("doctor")
    assert status in (0, 3)
    for word in (
        "whitted",
        "Python",
        "mitsuba",
        "numpy",
        "native tracer",
        "LLVM library",
        "llvm_ad_rgb",
        "kernel cache",
    ):
        assert word in out


def test_doctor_survives_what_aborts_its_child(monkeypatch):
    from mitsuba_plugins import trial

    def dies(command, **_):
        return subprocess.CompletedProcess(command, -signal.SIGABRT, "", "LLVM ERROR: Cannot select\n")

    monkeypatch.setattr(subprocess, "run", dies)
    assert trial.try_variant("llvm_ad_rgb") == trial.Trial(
        False, "the process dies of SIGABRT: LLVM ERROR: Cannot select"
    )


# ---- Names that are no UTF-8


@pytest.fixture
def oddly_named(scene):
    r"""A scene, n\xff.in, in a folder of a name like that."""
    folder = scene.parent / os.fsdecode(b"f\xff")
    folder.mkdir()
    return scene.rename(folder / os.fsdecode(b"n\xff.in"))


def test_a_name_that_is_no_utf_8_is_drawn_into_charts_and_figures(whitted, oddly_named, tmp_path):
    csv = tmp_path / "chart.csv"
    options = ("-o", tmp_path / "chart.svg", "--csv", csv, "--size", "4x3", "--methods", "native", "--runs", 2)
    assert whitted("chart", oddly_named, *options, "-q")[0] == 0
    assert "n\ufffd.in" in csv.read_text()
    images = [oddly_named.with_suffix(suffix) for suffix in (".ppm", ".a.ppm")]
    for image in images:
        assert raytrace.main([str(oddly_named), str(image), "8", "6"]) == 0
    assert whitted("compare", *images, "--png", tmp_path / "difference.png")[0] == 0


def test_what_takes_no_such_name_says_so(whitted, oddly_named, tmp_path):
    status, _, err = whitted("render", oddly_named, oddly_named.with_suffix(".png"), 4, 3, "--method", "native", "-q")
    assert status == 2
    assert "need folders whose names are UTF-8" in err
    oddly_named.with_suffix(".png").write_bytes(b"\x89PNG\r\n\x1a\n")
    status, _, err = whitted("compare", oddly_named.with_suffix(".png"), oddly_named.with_suffix(".png"))
    assert status == 2
    assert "its name or its folder's is not UTF-8" in err
