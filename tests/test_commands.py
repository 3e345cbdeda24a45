"""The programs, through `main(argv)`: options, messages, exit statuses, and files that appear whole or not at all."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from command_scenes import SCENE, rendering_of
from variant import VARIANT

from converter.commands import exits, main, raytrace
from converter.renderers.base import Interrupted, RendererUnavailable
from converter.renderers.native import NativeRenderer

ON_VARIANT = ("--variant", VARIANT)


@pytest.fixture
def bad_scene(tmp_path):
    file = tmp_path / "bad.in"
    file.write_text(SCENE.replace("solid 1 .5 .2", "sollid 1 .5 .2"))
    return file


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
