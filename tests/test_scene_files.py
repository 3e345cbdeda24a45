"""Files that are no scenes, and scenes whose textures or shapes are not there."""

from pathlib import Path

import pytest
from test_scene_errors import TEXT

from converter.commands.main import main
from converter.scene.errors import Problem, SceneError
from converter.scene.model import Texmap
from converter.scene.parser import load_scene, parse_scene
from converter.scene.writer import write_scene

CAMERA = "0 1 -5\n0 0 0\n0 1 0\n40\n1\n0 0 0 1 1 1 1 0 0\n"


@pytest.mark.parametrize(
    ("data", "place", "message"),
    [
        (b"", (1, 1), "the scene is empty"),
        (b" \n\n\t\n", (1, 1), "the scene is empty"),
        (b"# only\n# comments\n", (1, 1), "the scene is empty"),
        (TEXT.encode("utf-16"), (0, 0), "UTF-16"),
        (TEXT.encode("utf-16-le"), (0, 0), "UTF-16"),
        (TEXT.encode("utf-16-be"), (0, 0), "UTF-16"),
        (TEXT.encode("utf-32"), (0, 0), "UTF-16 text or binary data"),
        (bytes(1000), (0, 0), "binary data"),
        (TEXT.replace("solid", "so\0lid").encode(), (14, 1), "a NUL byte"),
        (b"P6\n2 2\n255\n" + bytes(12), (0, 0), "an image, not a scene"),
        (b"P3 1 1 255 0 0 0", (0, 0), "an image, not a scene"),
        (b"\x89PNG\r\n\x1a\n" + bytes(20), (0, 0), "an image, not a scene"),
        (b"\xff\xd8\xff\xe0" + bytes(range(1, 200)), (0, 0), "an image, not a scene"),
        (b"<html><body>\nno scene\n</body></html>\n", (1, 1), "expected the eye's x, found '<html><body>'"),
        (b"Trabalho de ray tracing\n" * 50, (1, 1), "expected the eye's x, found 'Trabalho'"),
    ],
)
def test_what_is_no_scene_at_all(data: bytes, place: tuple[int, int], message: str, tmp_path: Path) -> None:
    file = tmp_path / "a.in"
    file.write_bytes(data)
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    (problem,) = caught.value.problems
    assert (problem.line, problem.column) == place
    assert message in problem.message
    assert str(caught.value).startswith(f"{file}:")


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match=r"missing\.in: there is no such file"):
        load_scene(tmp_path / "missing.in")
    with pytest.raises(SceneError, match="this is a folder, not a scene file"):
        load_scene(tmp_path)
    with pytest.raises(SceneError, match="there is no such file"):
        load_scene(tmp_path / "none" / "a.in")


def test_textures_are_looked_for_used_or_not(tmp_path: Path) -> None:
    (tmp_path / "Rainbow1.PPM").write_bytes(b"P6 1 1 255\n\x00\x00\x00")
    (tmp_path / "broken.ppm").write_bytes(b"P6 100 100 255\n\x00\x00\x00")
    (tmp_path / "text.ppm").write_text("no image")
    four = "texmap broken.ppm 0 0 0 0 0 0 0 0\ntexmap text.ppm 0 0 0 0 0 0 0 0\ntexmap . 0 0 0 0 0 0 0 0"
    file = tmp_path / "a.in"
    file.write_text(TEXT.replace("solid 1 1 1", f"solid 1 1 1\n{four}").replace("\n3\ntexmap", "\n6\ntexmap"))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    missing, broken, text, folder = caught.value.problems
    assert (missing.line, missing.column) == (10, 8)
    assert missing.message == f"texture {tmp_path}/rainbow1.ppm: no such file (did you mean 'Rainbow1.PPM'?)"
    assert (broken.line, broken.column) == (15, 8)
    assert "it is cut off: 100 x 100 pixels need 30000 bytes, 3 are there" in broken.message
    assert (text.line, text.column) == (16, 8)
    assert text.message.startswith(f"texture {tmp_path}/text.ppm: no image that can be read")
    assert (folder.line, folder.message) == (17, f"texture {tmp_path}: not a file")


def test_a_texture_in_the_working_folder_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scenes").mkdir()
    (tmp_path / "rainbow1.ppm").write_bytes(b"P6 1 1 255\n\x00\x00\x00")
    file = Path("scenes", "a.in")
    (tmp_path / file).write_text(TEXT)
    with pytest.raises(SceneError, match=r"rainbow1\.ppm: no such file"):
        load_scene(tmp_path / file)
    monkeypatch.chdir(tmp_path)
    scene = load_scene(file)
    assert scene.pigments[0] == Texmap(Path("rainbow1.ppm"), (0, 0.001, 0, 0.12), (0, 0, 0, 0))
    assert scene.notes == (
        "scenes/a.in:10: texture rainbow1.ppm is not beside the scene, but read from the working folder",
    )
    assert "texmap ../rainbow1.ppm\n" in write_scene(scene)
    (tmp_path / "scenes" / "rainbow1.ppm").write_bytes(b"P6 1 1 255\n\x00\x00\x00")
    beside = load_scene(file)
    assert beside.pigments[0] == Texmap(Path("scenes", "rainbow1.ppm"), (0, 0.001, 0, 0.12), (0, 0, 0, 0))
    assert beside.notes == ()


def test_a_texture_that_nothing_needs_may_be_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = Path("a.in")
    file.write_text(TEXT.replace("0 0 sphere 0 0 0 600", "1 0 sphere 0 0 0 600"))
    told = "a.in:10: texture rainbow1.ppm: no such file; no object uses pigment 0"
    assert load_scene(file).warnings == (told,)
    assert main(["render", "a.in", "picture.ppm", "4", "3", "--method", "native"]) == 0
    for made in ("scene.pov", "folder"):
        assert main(["convert", "a.in", made]) == 0
        assert Path(made).exists()
    assert main(["inspect", "a.in"]) == 0
    file.write_text(TEXT.replace("0 0 sphere 0 0 0 600", "1 0 sphere 0 0 0 -600"))
    with pytest.raises(SceneError) as caught:  # which is not the texture's fault
        load_scene(file)
    assert [p.line for p in caught.value.problems] == [21]


def test_thousands_of_missing_textures_are_told_in_few_words(tmp_path: Path) -> None:
    file = tmp_path / "a.in"
    many = "texmap none.ppm 0 0 0 0 0 0 0 0\n" * 2000
    file.write_text(CAMERA + f"2001\nsolid 1 1 1\n{many}1\n1 0 0 1 0 0 0\n1\n0 0 sphere 0 0 0 1\n")
    warnings = load_scene(file).warnings
    assert len(warnings) == 21
    assert warnings[-1] == f"{file}: 1980 more textures that no object uses are missing"


@pytest.mark.parametrize(
    ("wanted", "there", "hint"),
    [
        ("quad.ppm", "wall.ppm", ""),
        ("t49.ppm", "t50.ppm", ""),
        ("quad.ppm", "readme.txt", ""),
        ("rainbow1.ppm", "RAINBOW1.PPM", "RAINBOW1.PPM"),
        ("rainbow.ppm", "rainbow1.ppm", "rainbow1.ppm"),
        ("sky.ppm", "sky.png", "sky.png"),
    ],
)
def test_a_missing_texture_is_answered_with_a_like_name(wanted: str, there: str, hint: str, tmp_path: Path) -> None:
    (tmp_path / there).write_bytes(b"P6 1 1 255\n\x00\x00\x00")
    file = tmp_path / "a.in"
    file.write_text(TEXT.replace("rainbow1.ppm", wanted))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    (problem,) = caught.value.problems
    asked = f" (did you mean {hint!r}?)" if hint else ""
    assert problem.message == f"texture {tmp_path / wanted}: no such file{asked}"


def test_a_fault_within_a_texture_is_told_with_the_scenes_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("rainbow1.ppm").write_text("P3 2 1 255 1 2 3 4 5 300\n")
    Path("a.in").write_text(TEXT)
    told = "a.in:10: texture rainbow1.ppm: it has the value 300 above its largest, 255\n"
    for words in (["render", "a.in", "a.ppm", "4", "3", "--method", "native"], ["convert", "a.in", "a.pov"]):
        capsys.readouterr()
        assert main(words) == 2
        assert capsys.readouterr().err.endswith(f"whitted {words[0]}: {told}")


def test_shapes_are_looked_at_once_the_rest_is_well(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from converter.scene import parser

    file = tmp_path / "a.in"
    text = TEXT.replace("texmap rainbow1.ppm\n0 0.001 0 .12\n0 0 0 0", "solid 1 0 0")
    file.write_text(text)
    complaint = "its half-spaces have no point in common"
    monkeypatch.setattr(
        parser, "check_geometry", lambda scene: [Problem(scene.file, scene.objects[2].line, 1, complaint)]
    )
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    assert str(caught.value) == f"{file}:21:1: {complaint}\n    1 1 polyhedron 5\n    ^"
    parse_scene(text)  # which looks at the text alone
