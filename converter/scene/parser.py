"""Reads course scenes.

    parse_scene(text)        text -> Scene, without a look at any file
    load_scene(path)         file -> Scene, whose textures are there and whose shapes exist
    load_text(text, path)    the same for a text that may once stand in that file

Reading is first by words (`sections`), as the format says, and again by lines (`lines`) where that fails, to tell why.
"""

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from converter.frozen import replace
from converter.scene import entries
from converter.scene.errors import Problem, SceneError, place, shown
from converter.scene.fields import Lost
from converter.scene.geometry import check_geometry
from converter.scene.lines import has_lines, read_camera_by_lines, read_section_by_lines
from converter.scene.model import Camera, Scene, Texmap
from converter.scene.reader import Reader
from converter.scene.sections import SECTIONS, Section, is_alone, pass_over_surplus, read_by_count
from converter.scene.tokens import COMMENT_HINT, SEPARATOR_HINT, Words, decode, number, whole
from converter.uncollected import uncollected

_Read = TypeVar("_Read")
MOST_PROBLEMS = 20
"""Problems that are told; who has more mends these first."""
BLOCK = 1 << 16
LONGEST = 1 << 28
"""Bytes of a file: a pipe may never end."""
LONGEST_BY_LINES = 1 << 22
"""Characters up to which a second reading, by lines, takes seconds at most."""


def parse_scene(text: str | bytes, file: Path | None = None) -> Scene:
    """The scene that `text` describes; `file` is where it comes from, for messages and for its textures' folder.

    Opens no file: a texture that is missing is not noticed.

    Raises:
        SceneError: the text is no scene; says everything that is wrong with it.
    """
    scene, reader = read_words(Words(decode(text, file), file))
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
    return _loaded(Words(decode(data, file), file))


def load_text(text: str, file: Path) -> Scene:
    """The scene that `text` is, as `load_scene` would read it from `file`, but for textures outside the file's folder.

    These are refused and not looked at: the text need not come from whoever may read those files.

    Raises:
        SceneError: the text is no such scene; says everything that is wrong with it.
    """
    return _loaded(Words(decode(text, file), file), confined=True)


def _loaded(text: Words, confined: bool = False) -> Scene:
    scene, reader = read_words(text)
    scene = _find_textures(scene, reader, confined)
    problems: list[Problem] = []
    if scene:
        with uncollected():
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


def read_words(text: Words, start: Callable[[Words], Reader] = Reader) -> tuple[Scene | None, Reader]:
    """The scene, if nothing is wrong, and the reader, which has noted what is wrong otherwise; `start` makes it.

    What is a scene without the optional numbers is read as one: those that only its lines tell are looked for later.
    """
    reader = start(text)
    if not text.has(0):
        reader.complain(0, "the scene is empty")
        return None, reader
    with uncollected():
        scene = _read_scene(reader, in_lines=False)
        if reader.misread and not reader.aligned:
            extended = start(text)
            extended.extended = True
            scene = _read_scene(extended, in_lines=False)
            if not extended.misread:
                return scene, extended
        if reader.misread and text.size < LONGEST_BY_LINES and has_lines(reader):
            reader = start(text)
            reader.extended = True
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
        if not reader.misread or reader.text.has(lost.at):  # that the end comes too soon is no news then
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
        light_lines=tuple(reader.light_lines[1:]),
        pigment_lines=tuple(reader.pigment_lines),
        finish_lines=tuple(reader.finish_lines),
    )


def _read_camera(reader: Reader, in_lines: bool) -> tuple[Camera | None, int]:
    """The camera and the index after it."""

    def by_words(attempt: Reader) -> tuple[Camera | None, int]:
        return entries.camera(attempt, 0)

    def by_lines(attempt: Reader) -> tuple[Camera | None, int]:
        return None, read_camera_by_lines(attempt)

    return _read(reader, by_words, by_lines if in_lines else None, SECTIONS[0])


def _read_section(reader: Reader, at: int, which: int, in_lines: bool) -> tuple[list[Any], int]:
    """The section's entries and the index after them."""
    section = SECTIONS[which]
    following = SECTIONS[which + 1] if which + 1 < len(SECTIONS) else None

    def by_words(attempt: Reader) -> tuple[list[Any], int]:
        found, end = read_by_count(attempt, at, section)
        if following is None and reader.text.has(end):
            pass_over_surplus(attempt, at, end, found)
        return found, end

    def by_lines(attempt: Reader) -> tuple[list[Any], int]:
        return read_section_by_lines(attempt, at, section, following)

    begins_line = in_lines and reader.text.has(at) and reader.text.line_start(at) == at
    return _read(reader, by_words, by_lines if begins_line else None, following)


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
    found, failure = None, None
    try:
        found = by_words(attempt)
    except Lost as lost:
        failure = lost.at, lost.message  # the error itself would keep all that has been read
    if by_lines and (found is None or not _starts_well(reader, found[1], following)):
        found = None  # so that there is room for as much once more
        second = reader.attempt()
        try:
            again = by_lines(second)
        except Lost:
            reader.adopt(second)
            raise
        if second.misread:
            reader.adopt(second)
            return again
        del again
    if failure is None and found is None:
        attempt = reader.attempt()
        found = by_words(attempt)
    reader.adopt(attempt)
    if found is None:
        assert failure
        raise Lost(*failure)
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


def _find_textures(scene: Scene | None, reader: Reader, confined: bool) -> Scene | None:
    """The scene with every texture's file as it can be opened: beside the scene, else in the working folder, unless
    `confined` to the scene's.

    Complains of each that cannot be opened; of one that is missing, and that no object uses, it warns.
    """
    if not reader.textures:
        return scene
    from converter.images.texture import TextureError, probe_texture

    used = reader.used_pigments or set(reader.textures)  # all, where no objects were found
    if scene:
        used = {o.pigment for o in scene.objects}
    elsewhere: dict[int, Path] = {}
    missing = 0
    for k, at in reader.textures.items():
        name = reader.text[at]
        if reader.misread and number(name) == number(name):
            continue  # the name is what is missing
        file = reader.folder / name
        where = place(reader.text.file, reader.text.line(at))
        if confined and not _lies_in(file, reader.folder):
            reader.complain(at, f"texture {shown(name)} lies outside of the scene's folder, and is not read here")
            continue
        if not confined and not os.access(file, os.F_OK) and os.access(name, os.F_OK):
            elsewhere[k] = file = Path(name)
            reader.notes.append(f"{where}: texture {name} is not beside the scene, but read from the working folder")
        try:
            probe_texture(file, hint=max(len(reader.problems), missing) < MOST_PROBLEMS)
        except TextureError as error:
            if k in used or not isinstance(error.__cause__, FileNotFoundError):
                reader.complain(at, f"texture {error}")
                continue
            missing += 1
            if missing <= MOST_PROBLEMS:
                reader.warnings.append(f"{where}: texture {error}; no object uses pigment {k}")
    if missing > MOST_PROBLEMS:
        reader.warnings.append(
            f"{reader.text.file}: {missing - MOST_PROBLEMS} more textures that no object uses are missing"
        )
    if scene is None or not elsewhere:
        return scene
    pigments = list(scene.pigments)
    for k, file in elsewhere.items():
        pigment = pigments[k]
        assert isinstance(pigment, Texmap)
        pigments[k] = replace(pigment, file=file)
    return replace(scene, pigments=tuple(pigments))


def _lies_in(file: Path, folder: Path) -> bool:
    """Whether a file lies in a folder or below it, wherever links lead."""
    try:
        return file.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # links that lead to themselves
        return False


def _checked(scene: Scene | None, reader: Reader, more: list[Problem]) -> Scene:
    """The scene if nothing is wrong.

    Raises:
        SceneError: with what the reader has noted and `more`, in the file's order.
    """
    if scene is not None and not reader.problems and not more:
        notes = (*_reading_notes(reader), *reader.notes)
        return replace(scene, notes=notes, warnings=tuple(reader.warnings)) if notes or reader.warnings else scene
    noted = _without_repeats(sorted(reader.problems, key=lambda problem: problem[0]))
    told = [reader.text.problem(at, message) for at, message in noted[:MOST_PROBLEMS]]
    told += [replace(problem, source_line=reader.text.source_line(problem.line)) for problem in more]
    told.sort(key=lambda problem: (problem.line, problem.column))
    count = len(noted) + reader.unnoted + len(more)
    raise SceneError(told[:MOST_PROBLEMS], count - len(told[:MOST_PROBLEMS]))


def _without_repeats(problems: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """Problems without those that come of a habit, such as commas between all numbers, but for the first."""
    kept, seen = [], set()
    for at, message in problems:
        habit = next((hint for hint in (COMMENT_HINT, SEPARATOR_HINT) if message.endswith(hint)), None)
        if habit not in seen:
            kept.append((at, message))
        seen.update([habit] if habit else [])
    return kept


def _reading_notes(reader: Reader) -> list[str]:
    """A note on `plane`, where the scene has it."""
    if not reader.plane_lines:
        return []
    count = len(reader.plane_lines)
    where = "" if count == 1 else f", here and {count - 1} more times" if count > 2 else ", here and once more"
    return [f"{place(reader.text.file, reader.plane_lines[0])}: 'plane' is read as 'polyhedron 1'{where}"]


def _why_unreadable(error: OSError) -> str:
    if isinstance(error, FileNotFoundError):
        return "there is no such file"
    if isinstance(error, IsADirectoryError):
        return "this is a folder, not a scene file"
    return (error.strerror or str(error)).lower()
