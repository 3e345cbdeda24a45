"""`whitted grade`: a class of programs, each with its mistakes, is run, judged and reported."""

import csv
import json
import os
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from converter.certify.certificate import undetermined
from converter.commands import main
from converter.grade.judge import Verdict, judge_picture, mistakes
from converter.grade.naming import consistent
from converter.grade.pictures import NoPicture, decode, take
from converter.grade.programs import NoProgram, build, read_programs
from converter.grade.report.tables import _plain
from converter.grade.rubric import Part, Rubric, RubricError, marks, read_rubric
from converter.grade.run import Limits, Runner
from converter.grade.sandbox import Walls
from converter.grade.tasks import NoTask, read_tasks
from converter.grade.undecided import draw, undecided
from converter.images.write import write_image
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.why.student import UnknownToStudent, make_student

LADDER = Path(__file__).resolve().parents[1] / "scenes" / "ladder"
WIDTH, HEIGHT = 96, 72
SETTINGS = Settings(width=WIDTH, height=HEIGHT)
CORES = sorted(os.sched_getaffinity(0))[:1]
RUNNER = Runner(Walls(None, "for a test"))
LIMITS = Limits(seconds=5)
SCENES = ("02_camera", "03_lamp", "08_shadow", "10_checker")


@cache
def drawn(name, *causes, width=WIDTH, height=HEIGHT):
    """The picture of a scene by a student with these mistakes, as far as they show."""
    student = make_student(load_scene(LADDER / f"{name}.in"), Settings(width=width, height=height))
    ys, xs = np.divmod(np.arange(width * height), width)
    shown = frozenset(causes) & {d.name for d in student.candidates()}
    return student.drawn(np.stack((xs, ys), axis=1).astype(np.int32), shown).reshape(height, width, 3)


def save(file, levels):
    write_image(file, np.divide(levels, 255, dtype=np.float32), levels.shape[1], levels.shape[0])


def program(folder, script):
    """A folder with a program of some lines of shell."""
    folder.mkdir(parents=True)
    file = folder / "raytrace"
    file.write_text(f'#!/bin/sh\nhere=$(dirname "$0")\nname=$(basename "$1" .in)\n{script}\n')
    file.chmod(0o755)
    return folder


def student(folder, *causes, ending=".ppm", script='cp "$here/$name{ending}" "$2"'):
    """A program that knows the pictures that a student's would draw."""
    program(folder, script.format(ending=ending))
    for name in SCENES:
        save(folder / f"{name}{ending}", drawn(name, *causes))
    return folder


@pytest.fixture(scope="module")
def scenes(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scenes")
    for name in SCENES:
        (folder / f"{name}.in").write_bytes((LADDER / f"{name}.in").read_bytes())
    (folder / "rubric.toml").write_text(
        'tolerate = ["pixel_center"]\n[scenes.08_shadow]\npoints = 3\nfeature = "shadow"\n'
    )
    return folder


@pytest.fixture(scope="module")
def report(scenes, tmp_path_factory):
    """The report of a small class, and what the command said."""
    root, out = tmp_path_factory.mktemp("class"), tmp_path_factory.mktemp("out") / "report"
    programs = [
        student(root / "right"),
        student(root / "centre", "pixel_center", ending=".png"),
        student(root / "two", "bgr", "shadows_missing"),
        student(root / "lossy", ending=".jpg"),
        student(root / "fails", script='cp "$here/$name{ending}" "$2"; echo "<b>=no&"; exit 5'),
        student(root / "named", script='cp "$here/$name{ending}" mine{ending}'),
        program(root / "link", 'ln -s "$here/../right/$name.ppm" "$2"'),
        program(root / "half", 'printf "P6\\n96 72\\n255\\nabc" > "$2"'),
        program(root / "nothing", "true"),
        program(root / "loop", "timeout 20 sh -c 'while :; do :; done'"),
        program(root / "spares", '[ "$name" = 03_lamp ] && cp "$here/../right/$name.ppm" "$2" || kill -SEGV $$'),
    ]
    words = ["grade", *map(str, programs), "--scenes", str(scenes), "-o", str(out), "--size", f"{WIDTH}x{HEIGHT}"]
    words += ["--time", "0.5", "--walls", "none", "-q"]
    assert main.main(words) == 0
    return out, words


def found(out):
    data = json.loads((out / "report.json").read_text(encoding="utf-8"))
    return {p["name"]: {s["scene"]: s for s in p["scenes"]} for p in data["programs"]}


# ---- The whole -------------------------------------------------------------------------------------------------------


def test_each_program_gets_what_it_has_earned(report):
    programs = found(report[0])
    points = {name: [round(s["points"], 2) for s in scenes.values()] for name, scenes in programs.items()}
    assert points["right"] == points["centre"] == points["lossy"] == [1, 1, 3, 1]
    assert points["two"][0] < 0.5  # red and blue exchanged
    assert points["two"][1] == 1  # the same, which costs once
    assert 1.2 < points["two"][2] < 1.5  # no shadows; the colours cost nothing more
    assert points["two"][3] == 1
    assert points["fails"] == points["named"] == [0.5, 1, 3, 1]
    assert points["link"] == points["half"] == points["nothing"] == points["loop"] == [0, 0, 0, 0]
    assert points["spares"] == [0, 1, 0, 0]


def test_mistakes_are_named(report):
    programs = found(report[0])
    kinds = {name: [s["found"] for s in scenes.values()] for name, scenes in programs.items()}
    assert kinds["right"] == kinds["lossy"] == ["right"] * 4
    assert kinds["centre"] == ["forgiven"] * 4
    named = {name: [s.get("mistakes") for s in scenes.values()] for name, scenes in programs.items()}
    assert named["centre"] == [["pixel_center"]] * 4
    assert [set(causes) for causes in named["two"]] == [{"bgr"}, {"bgr"}, *[{"bgr", "shadows_missing"}] * 2]
    assert named["fails"] == [["status"]] * 4
    assert named["named"] == [["name"]] * 4


def test_what_went_wrong_is_told(report):
    told = {name: scenes["08_shadow"]["trouble"] for name, scenes in found(report[0]).items()}
    assert told["right"] == ""
    assert told["fails"] == "ended with status 5"
    assert told["named"] == "its picture is called mine.ppm"
    assert told["link"] == "its picture is a link to something else"
    assert "cut off" in told["half"]
    assert told["nothing"] == "it writes no picture"
    assert told["loop"].startswith("ended after")
    assert told["spares"] == "crashed: SIGSEGV (segmentation fault), and it writes no picture"


def test_tables_and_results(report):
    out, _ = report
    with (out / "marks.csv").open(encoding="utf-8") as file:
        rows = {row["program"]: row for row in csv.DictReader(file)}
    assert (rows["right"]["points"], rows["right"]["of"], rows["right"]["shadow"]) == ("6", "6", "3")
    with (out / "pictures.csv").open(encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == len(rows) * len(SCENES)
    with (out / "mistakes.csv").open(encoding="utf-8") as file:
        assert {row["mistake"]: row["who"] for row in csv.DictReader(file)} == {
            "pixel_center": "centre",
            "bgr": "two",
            "shadows_missing": "two",
            "status": "fails",
            "name": "named",
        }
    results = json.loads((out / "results" / "two.json").read_text(encoding="utf-8"))
    assert [test["max_score"] for test in results["tests"]] == [1, 1, 3, 1]
    assert [test["status"] for test in results["tests"]] == ["failed", "passed", "failed", "passed"]
    assert "Look at the loop over the lights" in results["tests"][2]["output"]


def test_pages_hold_all_in_themselves(report):
    out, _ = report
    pages = [out / "index.html", *(out / "students").iterdir()]
    assert len(pages) == 12
    for page in pages:
        text = page.read_text(encoding="utf-8")
        assert not re.findall(r"""(?:src|href)=['"](?!data:|students/|[#])|url\((?!data:)|<b>=no""", text)
        assert "default-src 'none'" in text
    assert "&lt;b&gt;=no&amp;" in (out / "students" / "fails.html").read_text(encoding="utf-8")
    assert "ran without walls" in pages[0].read_text(encoding="utf-8")


def test_the_same_command_runs_nothing_again(report):
    out, words = report
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    attempt = out / "runs" / "right" / "03_lamp.json"
    seen = attempt.stat().st_mtime_ns
    assert main.main(words) == 0
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before
    assert attempt.stat().st_mtime_ns == seen


def test_a_program_that_has_changed_is_run_again(scenes, tmp_path):
    folder = student(tmp_path / "a")
    words = ["grade", str(folder), "--scenes", str(scenes / "03_lamp.in"), "-o", str(tmp_path / "r"), "-q"]
    words += ["--size", f"{WIDTH}x{HEIGHT}", "--walls", "none"]
    assert main.main(words) == 0
    assert found(tmp_path / "r")["a"]["03_lamp"]["found"] == "right"
    save(folder / "03_lamp.ppm", drawn("03_lamp", "upside_down"))
    assert main.main(words) == 0
    assert found(tmp_path / "r")["a"]["03_lamp"]["mistakes"] == ["upside_down"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["none", "--scenes", "S"], "none: no such program or folder"),
        (["true {scene}", "--scenes", "S"], "there is no {out} in it"),
        (["surely_no_program {scene} {out}", "--scenes", "S"], "there is no program 'surely_no_program'"),
        (["'open {scene}", "--scenes", "S"], "no closing quotation"),
        (["true {scene} {out}", "--scenes", "/dev"], "there are no scenes (*.in) in it"),
        (["true {scene} {out}", "--scenes", "S", "--jobs", "4000"], "cores"),
        (["true {scene} {out}", "--scenes", "S", "--cores", "4000"], "--cores: this process has"),
        (
            ["true {scene} {out}", "--scenes", "S", "--samples", "4"],
            "--samples: pictures of one ray a pixel are graded",
        ),
        (["true {scene} {out}", "--scenes", "S", "--time", "0"], "must lie between 0.1 and 36000, found 0"),
        (["true {scene} {out}", "--scenes", "S", "--picture", "../a"], "must be a file's name"),
        (["true {scene} {out}", "--scenes", "S", "--rubric", "R"], "R: there is no 'point' in a rubric"),
        (["true {scene} {out}", "--scenes", "S", "--run", "./rt"], "--run: {scene} and {out} must stand in it"),
    ],
    ids=str,
)
def test_commands_that_make_no_sense(words, told, scenes, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("R").write_text("point = 1\n")
    words = [str(scenes) if word == "S" else word for word in words]
    assert main.main(["grade", *words, "-o", "out"]) == 2
    assert told in capsys.readouterr().err


# ---- Programs --------------------------------------------------------------------------------------------------------


def made(folder, tmp_path, call=None, make=None):
    (one,) = read_programs([str(folder)], call)
    return build(one, tmp_path / "work", make, LIMITS, RUNNER, CORES)


def test_a_folder_is_built_in_a_copy(tmp_path):
    folder = tmp_path / "ada"
    folder.mkdir()
    (folder / "rt.sh").write_text("#!/bin/sh\nexit 0\n")
    (folder / "Makefile").write_text("tracer: rt.sh\n\tcp rt.sh tracer\n\tcp rt.sh other\n\tchmod +x tracer other\n")
    built = made(folder, tmp_path)
    copy = tmp_path / "work" / "ada"
    assert built.call == f"{copy}/tracer {{scene}} {{out}} {{width}} {{height}}"
    assert built.command(Path("a b.in"), "o.ppm", 3, 4) == [f"{copy}/tracer", "a b.in", "o.ppm", "3", "4"]
    assert sorted(path.name for path in folder.iterdir()) == ["Makefile", "rt.sh"]
    called = made(folder, tmp_path, "sh rt.sh -o {out} {scene}")
    assert called.command(Path("a.in"), "o.ppm", 3, 4) == ["sh", f"{copy}/rt.sh", "-o", "o.ppm", "a.in"]


@pytest.mark.parametrize(
    ("makefile", "trouble"),
    [
        ("all:\n\techo some sense; false\n", "its build ended with status 2"),
        ("all:\n\ttrue\n", "its build makes no program"),
        (
            "all:\n\tfor n in ab cd; do echo '#!/bin/sh' > $$n; chmod +x $$n; done\n",
            "it is not clear which of ab, cd",
        ),
        (None, "there is no Makefile and no program"),
    ],
)
def test_builds_that_fail(makefile, trouble, tmp_path):
    folder = tmp_path / "ada"
    folder.mkdir()
    if makefile is not None:
        (folder / "Makefile").write_text(makefile)
    built = made(folder, tmp_path)
    assert built.trouble.startswith(trouble)
    assert ("some sense" in built.said) == ("status" in trouble)


def test_names_are_told_apart(tmp_path):
    for folder in ("a/x", "b/x", "c/we?rd <n>"):
        (tmp_path / folder).mkdir(parents=True)
    words = [str(tmp_path / "a" / "x"), str(tmp_path / "b" / "x"), str(tmp_path / "c" / "we?rd <n>")]
    programs = read_programs([*words, "x=true {scene} {out}", "true {scene} {out}"])
    assert [one.name for one in programs] == ["x", "x-2", "we_rd_n_", "x-3", "true"]
    with pytest.raises(NoProgram, match="not executable"):
        read_programs([__file__])


def test_textures_go_with_scenes(tmp_path):
    (task,) = read_tasks(LADDER / "13_tiles.in")
    copy = task.copy_to(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["13_tiles.in", "letter.ppm"]
    assert load_scene(copy).objects
    folder = tmp_path / "below"
    folder.mkdir()
    (folder / "a.in").write_text(copy.read_text().replace("letter.ppm", "../letter.ppm"))
    with pytest.raises(NoTask, match="lies outside"):
        read_tasks(folder)


# ---- Pictures --------------------------------------------------------------------------------------------------------


def test_pictures_that_are_not_taken(tmp_path):
    (tmp_path / "other").write_bytes(b"P6 1 1 255\nabc")
    (tmp_path / "link.ppm").symlink_to("other")
    (tmp_path / "hard.ppm").hardlink_to(tmp_path / "other")
    (tmp_path / "folder.ppm").mkdir()
    (tmp_path / "empty.ppm").touch()
    (tmp_path / "large.ppm").write_bytes(bytes(2000))
    os.mkfifo(tmp_path / "pipe.ppm")
    told = {
        "link": "a link",
        "hard": "a link",
        "folder": "is no file",
        "empty": "is empty",
        "large": "has more than",
        "pipe": "is no file",
        "none": "writes no picture",
    }
    for name, why in told.items():
        with pytest.raises(NoPicture, match=why):
            take(tmp_path, f"{name}.ppm", [], 1000)


def test_the_only_picture_is_taken_under_another_name(tmp_path):
    (tmp_path / "was.png").write_bytes(b"before")
    (tmp_path / "log.txt").write_bytes(b"text")
    (tmp_path / "mine.PPM").write_bytes(b"mine")
    left = take(tmp_path, "out.ppm", ["was.png"], 100)
    assert (left.name, left.data) == ("mine.PPM", b"mine")
    (tmp_path / "b.ppm").write_bytes(b"b")
    with pytest.raises(NoPicture):
        take(tmp_path, "out.ppm", ["was.png"], 100)


@pytest.mark.parametrize("ending", [".ppm", ".png", ".bmp", ".tif"])
def test_pictures_are_read_as_they_are(ending, tmp_path):
    file = tmp_path / f"a{ending}"
    save(file, drawn("08_shadow"))
    file = file.rename(tmp_path / "a.ppm")  # what a file holds counts, and not its name
    theirs = decode(file, RUNNER, CORES)
    assert (theirs.levels == drawn("08_shadow")).all()
    assert not theirs.lossy


@pytest.mark.parametrize("data", [b"no picture", b"\x89PNG\r\n\x1a\n" + bytes(40), b"P6\n60000 60000\n255\n"])
def test_broken_pictures(data, tmp_path):
    (tmp_path / "a.ppm").write_bytes(data)
    with pytest.raises(NoPicture):
        decode(tmp_path / "a.ppm", RUNNER, CORES)


# ---- Verdicts and marks ----------------------------------------------------------------------------------------------


def test_a_picture_of_another_size():
    verdict = judge_picture(LADDER / "08_shadow.in", drawn("08_shadow", width=60, height=50), False, SETTINGS)
    assert (verdict.right, verdict.wrong, verdict.causes) == (False, 0, ("size",))
    assert verdict.sentence.startswith("The picture has 60 x 50 pixels, not 96 x 72. The picture is right")


def test_pixels_that_single_precision_cannot_decide_do_not_count():
    scene = load_scene(LADDER / "15_mirrors.in")
    settings = Settings(width=320, height=240)
    spared = undecided(scene, settings)
    assert 0 < spared.mean() < 0.05
    levels = draw(scene, settings)
    levels[spared] = (255, 0, 255)
    assert judge_picture(LADDER / "15_mirrors.in", levels, False, settings).wrong == 0
    levels[100:110, 100:110] = (255, 0, 255)
    verdict = judge_picture(LADDER / "15_mirrors.in", levels, False, settings)
    assert 0.0012 < verdict.wrong < 0.0014
    assert not verdict.right


def test_pixels_that_the_scene_cannot_decide_do_not_count(monkeypatch):
    scene = load_scene(LADDER / "20_nested.in")
    settings = Settings(width=160, height=120)
    left_open = undetermined(scene, settings, ulps=1.0)
    assert 0 < left_open.mean() < 0.01
    assert undecided(scene, settings)[left_open].all()
    monkeypatch.setattr("converter.grade.undecided.MOST_RAYS", 1000)
    assert not undecided(scene, settings)[left_open].all()


def test_scenes_in_which_no_mistakes_are_looked_for_are_compared(monkeypatch):
    def refuse(*_, **__):
        raise UnknownToStudent("there is a cloud in it")

    monkeypatch.setattr("converter.grade.judge.judge", refuse)
    file = LADDER / "02_camera.in"
    right = drawn("02_camera")
    assert judge_picture(file, right, False, SETTINGS).right
    wrong = judge_picture(file, right[::-1] // 2, False, SETTINGS)
    assert (wrong.wrong, wrong.right) == (1, False)
    assert "there is a cloud in it" in wrong.sentence


def verdict(*causes, wrong=0.4, left=0.0, **alternatives):
    spoiled = dict.fromkeys(causes, wrong)
    return Verdict(WIDTH, HEIGHT, not causes and not left, wrong, left, causes, spoiled, alternatives, "It is.")


def points(rubric, **verdicts):
    return [round(mark.points, 3) for mark in marks(rubric, list(verdicts), verdicts).values()]


def test_a_mistake_costs_once_or_always():
    made = {"a": verdict("bgr"), "b": verdict("bgr"), "c": verdict("bgr", "gamma_2"), "d": None, "e": verdict(wrong=0)}
    assert points(Rubric(), **made) == [0.3, 1, 0.3, 0, 1]
    assert points(Rubric(once=False), **made) == [0.3, 0.3, 0.3, 0, 1]
    assert points(Rubric(tolerate=frozenset({"bgr"})), **made) == [1, 1, 0.3, 0, 1]
    assert points(Rubric({"b": Part(4, "", frozenset({"bgr"}))}, once=False, partial=0.1), **made)[:2] == [0.06, 4]


def test_what_is_left_beside_forgiven_mistakes_costs():
    rubric = Rubric(tolerate=frozenset({"bgr"}))
    assert points(rubric, a=verdict("bgr", left=0.2), b=verdict(left=0.2)) == [0.4, 0.4]


def test_of_mistakes_that_look_the_same_the_cheapest_counts():
    rubric = Rubric(tolerate=frozenset({"pixel_center"}))
    assert points(rubric, a=verdict("pixel_ends", pixel_ends=("pixel_center",))) == [1]


def test_a_mistake_has_one_name():
    upside = {"a": verdict("pixel_bottom_left", pixel_bottom_left=("upside_down",)), "b": verdict("upside_down")}
    told = consistent({**upside, "c": None})
    assert [told["a"].causes, told["b"].causes, told["c"]] == [("upside_down",), ("upside_down",), None]
    assert told["a"].alternatives == {"upside_down": ("pixel_bottom_left",)}
    both = {"a": verdict("bgr", "grey", bgr=("grey",), grey=("bgr",)), "b": verdict("grey")}
    assert set(consistent(both)["a"].causes) == {"bgr", "grey"}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("charge = 1", 'charge must be "once" or "always", found 1'),
        ("partial = 2", "partial must lie between 0 and 1, found 2"),
        ("tolerate = 'bgr'", "tolerate must be a list of names"),
        ("tolerate = ['bgrr']", "there is no mistake 'bgrr' (did you mean"),
        ("[scenes.b]", "there is no scene 'b'"),
        ("[scenes.a]\npoints = true", "scenes.a: points must be a number"),
        ("[scenes.a]\npoints = -1", "scenes.a: points must be a number that is not negative, found -1"),
        ("[scenes.a]\nfeature = 3", "scenes.a: feature must be a text"),
        ("[scenes.a]\npoint = 3", "scenes.a: there is no 'point' in a rubric"),
        ("scenes = 3", "scenes must be tables"),
        ("scenes.a = 3", "scenes.a must be a table"),
        ("[", "rubric.toml: "),
    ],
)
def test_rubrics_that_are_refused(text, told, tmp_path):
    file = tmp_path / "rubric.toml"
    file.write_text(text)
    with pytest.raises(RubricError) as error:
        read_rubric(file, ["a"])
    assert told in str(error.value)


def test_no_spreadsheet_takes_a_text_for_a_formula():
    assert [_plain(text) for text in ("=1+1", "@a", "-1", "a=b", "")] == ["'=1+1", "'@a", "'-1", "a=b", ""]


def test_mistakes_of_programs_have_names_of_their_own():
    assert len(mistakes()) == len({name.lower() for name in mistakes()})
