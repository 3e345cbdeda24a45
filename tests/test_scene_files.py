"""Files that are no scenes, and scenes whose textures or shapes are not there."""

from pathlib import Path

import pytest
from test_scene_errors import TEXT

from converter.scene.errors import Problem, SceneError
from converter.scene.parser import load_scene, parse_scene


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


def test_shapes_are_looked_at_once_the_rest_is_well(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from converter.scene import geometry

    file = tmp_path / "a.in"
    text = TEXT.replace("texmap rainbow1.ppm\n0 0.001 0 .12\n0 0 0 0", "solid 1 0 0")
    file.write_text(text)
    complaint = "its half-spaces have no point in common"
    monkeypatch.setattr(
        geometry, "check_geometry", lambda scene: [Problem(scene.file, scene.objects[2].line, 1, complaint)]
    )
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    assert str(caught.value) == f"{file}:21:1: {complaint}\n    1 1 polyhedron 5\n    ^"
    parse_scene(text)  # which looks at the text alone
