"""Reads course scenes.

    parse_scene(text)   text -> Scene, without a look at any file
    load_scene(path)    file -> Scene, whose textures are there and whose shapes exist

Reading is first by words (`sections`), as the format says, and again by lines (`lines`) where that fails, to tell why.
"""

import errno
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from converter.scene import entries
from converter.scene.entries import Lost, Reader
from converter.scene.errors import Problem, SceneError, shown
from converter.scene.lines import has_lines, read_camera_by_lines, read_section_by_lines
from converter.scene.model import Camera, Polyhedron, Scene
from converter.scene.sections import SECTIONS, Section, is_alone, read_by_count
from converter.scene.tokens import Words, decode, number, whole

_Read = TypeVar("_Read")
MOST_PROBLEMS = 20
"""Problems that are told; who has more mends these first."""
BLOCK = 1 << 16
LONGEST = 1 << 28
"""Bytes of a file, far more than whose words find room: a pipe may never end."""


def parse_scene(text: str | bytes, file: Path | None = None) -> Scene:
    """The scene that `text` describes; `file` is where it comes from, for messages and for its textures' folder.

    Opens no file: a texture that is missing is not noticed.

    Raises:
        SceneError: the text is no scene; says everything that is wrong with it.
    """
    scene, reader = _read_text(Words(decode(text, file), file))
    return _checked(scene, reader, [])


def load_scene(path: str | Path) -> Scene:
    """The scene in the file `path`, with textures that can be opened and half-spaces that meet.

    Raises:
        SceneError: the file cannot be read, or is no such scene; says everything that is wrong with it.
    """
    file = Path(path)
    try:
        data = _read_bytes(file)
    except OSError as error:
        raise SceneError([Problem(file, 0, 0, _why_unreadable(error))]) from error
    scene, reader = _read_text(Words(decode(data, file), file))
    _check_textures(reader)
    problems: list[Problem] = []
    if scene and any(isinstance(o.shape, Polyhedron) for o in scene.objects):
        from converter.scene.geometry import check_geometry

        problems = check_geometry(scene)
    return _checked(scene, reader, problems)


def _read_bytes(file: Path) -> bytes:
    """What is in a file; of what is no text only the beginning, since there are devices that never end.

    Raises:
        OSError: it cannot be read, or goes on for longer than any scene.
    """
    blocks: list[bytes] = []
    with file.open("rb") as opened:
        while block := opened.read(BLOCK):
            blocks.append(block)
            if b"\0" in block:
                break
            if len(blocks) * BLOCK > LONGEST:
                raise OSError(errno.EFBIG, "this is longer than any scene")
    return b"".join(blocks)


def _read_text(text: Words) -> tuple[Scene | None, Reader]:
    """The scene, if nothing is wrong, and the reader, which has noted what is wrong otherwise."""
    reader = Reader(text)
    if not text.words:
        reader.complain(0, "the scene is empty")
        return None, reader
    scene = _read_scene(reader, in_lines=False)
    if reader.misread and has_lines(reader):
        reader = Reader(text)
        _read_scene(reader, in_lines=True)
    return scene, reader


def _read_scene(reader: Reader, in_lines: bool) -> Scene | None:
    """The scene, if nothing is wrong; `in_lines`: consult the lines where the words lead nowhere."""
    try:
        camera, at = _read_camera(reader, in_lines)
        lights, at = _read_section(reader, at, 0, in_lines)
        pigments, at = _read_section(reader, at, 1, in_lines)
        reader.pigments = max(len(pigments), reader.announced)
        finishes, at = _read_section(reader, at, 2, in_lines)
        reader.finishes = max(len(finishes), reader.announced)
        objects, at = _read_section(reader, at, 3, in_lines)
    except Lost as lost:
        if not reader.misread or lost.at < len(reader.words):  # that the end comes too soon is no news then
            reader.misreads(lost.at, lost.message)
    if reader.problems or camera is None:
        return None
    return Scene(
        camera=camera,
        ambient=lights[0].color,
        lights=tuple(lights[1:]),
        pigments=tuple(pigments),
        finishes=tuple(finishes),
        objects=tuple(objects),
        file=reader.text.file,
        light_lines=tuple(reader.light_lines[k] for k in range(1, len(lights))),
        pigment_lines=tuple(reader.pigment_lines[k] for k in range(len(pigments))),
        finish_lines=tuple(reader.finish_lines[k] for k in range(len(finishes))),
    )


def _read_camera(reader: Reader, in_lines: bool) -> tuple[Camera | None, int]:
    """The camera and the index after it."""

    def by_words(attempt: Reader) -> tuple[Camera | None, int]:
        return entries.camera(attempt, (0, 3, 6, 9)), 10

    def by_lines(attempt: Reader) -> tuple[Camera | None, int]:
        return None, read_camera_by_lines(attempt)

    return _read(reader, by_words, by_lines if in_lines else None, SECTIONS[0])


def _read_section(reader: Reader, at: int, which: int, in_lines: bool) -> tuple[list[Any], int]:
    """The section's entries and the index after them."""
    section = SECTIONS[which]
    following = SECTIONS[which + 1] if which + 1 < len(SECTIONS) else None

    def by_words(attempt: Reader) -> tuple[list[Any], int]:
        found, end = read_by_count(attempt, at, section)
        if following is None and end < len(reader.words):
            raise Lost(end, f"unexpected {shown(reader.words[end])} after the last of {len(found)} objects")
        return found, end

    def by_lines(attempt: Reader) -> tuple[list[Any], int]:
        return read_section_by_lines(attempt, at, section, following)

    begins_line = at < len(reader.words) and reader.text.line_start(at) == at
    return _read(reader, by_words, by_lines if in_lines and begins_line else None, following)


def _read(
    reader: Reader,
    by_words: Callable[[Reader], tuple[_Read, int]],
    by_lines: Callable[[Reader], tuple[_Read, int]] | None,
    following: Section | None,
) -> tuple[_Read, int]:
    """Read by words; if that fails, or ends where the next section cannot start, by lines, if these tell what is wrong.

    Raises:
        Lost: neither gets to the end.
    """
    attempt = reader.attempt()
    failure = None
    try:
        found = by_words(attempt)
    except Lost as lost:
        failure = lost
    if by_lines and (failure or not _starts_well(reader, found[1], following)):
        second = reader.attempt()
        try:
            again = by_lines(second)
        except Lost:
            reader.adopt(second)
            raise
        if second.misread:
            reader.adopt(second)
            return again
    reader.adopt(attempt)
    if failure:
        raise failure
    return found


def _starts_well(reader: Reader, at: int, section: Section | None) -> bool:
    """Whether the section may start at the word `at`, in a scene that is written in lines; None is the end."""
    line = reader.text.on_line(at)
    if section is None or not line:
        return section is None and not line
    if is_alone(line):
        empty = whole(line[0]) == 0 and reader.text.line_start(at) == at
        return empty or section.opens(reader.text.on_line(at + 1))
    return whole(line[0]) is not None and section.opens(line[1:]) and not section.opens(line)


def _check_textures(reader: Reader) -> None:
    """Complain of every texture that cannot be opened, used or not: its pixels are read only if it is."""
    if not reader.textures:
        return
    from converter.images.texture import TextureError, probe_texture

    for at, file in reader.textures.items():
        if reader.misread and number(reader.words[at]) == number(reader.words[at]):
            continue  # the name is what is missing
        try:
            probe_texture(file, hint=len(reader.problems) < MOST_PROBLEMS)
        except TextureError as error:
            reader.complain(at, f"texture {error}")


def _checked(scene: Scene | None, reader: Reader, more: list[Problem]) -> Scene:
    """The scene if nothing is wrong.

    Raises:
        SceneError: with what the reader has noted and `more`, in the file's order.
    """
    if scene is not None and not reader.problems and not more:
        return scene
    noted = sorted(reader.problems, key=lambda problem: problem[0])
    told = [reader.text.problem(at, message) for at, message in noted[:MOST_PROBLEMS]]
    lines = reader.text.lines
    for problem in more:
        source = lines[problem.line - 1] if 0 < problem.line <= len(lines) else ""
        told.append(replace(problem, source_line=problem.source_line or source))
    told.sort(key=lambda problem: (problem.line, problem.column))
    raise SceneError(told[:MOST_PROBLEMS], len(noted) + len(more) - len(told[:MOST_PROBLEMS]))


def _why_unreadable(error: OSError) -> str:
    if isinstance(error, FileNotFoundError):
        return "there is no such file"
    if isinstance(error, IsADirectoryError):
        return "this is a folder, not a scene file"
    return (error.strerror or str(error)).lower()
