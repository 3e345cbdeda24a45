"""Where a section went wrong, told from its lines.

The format's words may stand on any lines, so a number missing from one entry is taken from the next, and the words stop
making sense only much later. People write an entry a line, though. Where reading word after word has failed, the
section is read here once more, entry by entry as its lines suggest: the entry that is too short or too long is named,
and the others are still read.
"""

from collections.abc import Callable
from typing import Any

from converter.scene.entries import CAMERA, FOVY, LENS, lens
from converter.scene.errors import shown
from converter.scene.fields import MOVE, Lost, Numbers
from converter.scene.reader import Reader, has_digits
from converter.scene.sections import (
    SECTIONS,
    Line,
    Section,
    count_planes,
    is_alone,
    leftover,
    miscounted,
    read_count,
)
from converter.scene.tokens import COMMENT_HINT, HUGE, LONG_LINE, SEPARATOR_HINT, found, hint, whole
from converter.shapes.polyhedron import PLANE, announced


def has_lines(reader: Reader) -> bool:
    """Whether the scene is written in lines: at least three of its first four are as long as the camera's should be."""
    at, alike = 0, 0
    for part in CAMERA:
        line = reader.text.on_line(at)
        alike += len(line) - _has_label(line) == len(part.fields)
        at += len(line)  # a line too long is none of these, wherever it ends
    return alike >= 3


def _has_label(line: Line) -> bool:
    """Whether a name stands before the numbers of a line, which the format has not."""
    return len(line) > 1 and not has_digits(line[0]) and has_digits(line[1])


def read_camera_by_lines(reader: Reader) -> int:
    """Note which of the camera's lines is wrong; gives the index after them.

    Raises:
        Lost: there are lines too many.
    """
    at = 0
    for part in CAMERA:
        line = reader.text.on_line(at)
        while line and hint(line[0]) == COMMENT_HINT:
            reader.misreads(at, f"expected {part.owner}'s {part.fields[0]}, {found(line[0])}")
            at = reader.text.line_end(at)
            line = reader.text.on_line(at)
        if line and hint(line[0]) == SEPARATOR_HINT:
            raise Lost(at, f"expected {part.owner}'s {part.fields[0]}, {found(line[0])}")
        if part is FOVY and len(line) > 1 and not _has_label(line) and not _may_have_lens(reader, at):
            raise Lost(at, f"expected fovy alone on its line, found {shown(line[0])} and more{hint(line[1])}")
        if part is FOVY and _counts_lights(reader, at):
            reader.misreads(
                at, f"expected fovy, the angle of view, before the number of lights, found {shown(line[0])}"
            )
            continue
        if is_alone(line) and part is not FOVY:  # its line is missing, and this one is fovy's
            reader.misreads(at, f"expected {part.owner}, {len(part.fields)} numbers, found {shown(line[0])} alone")
            continue
        end = reader.text.line_end(at)
        _read_entry(reader, at, end, _reads(part), part.owner)
        at = end
    return at


def _may_have_lens(reader: Reader, at: int) -> bool:
    """Whether the line may be fovy's, with an aperture and a focal distance, and is no vector too many."""
    line = reader.text.on_line(at)
    count = reader.text.on_line(at + len(line))
    fits = 1 < len(line) <= len(FOVY.fields + LENS.fields)
    return fits and is_alone(count) and not is_alone(reader.text.on_line(at + len(line) + 1))


def _counts_lights(reader: Reader, at: int) -> bool:
    """Whether the line is the number of lights rather than fovy: so many lights follow it."""
    line, lights = reader.text.on_line(at), SECTIONS[0]
    count = (is_alone(line) and whole(line[0])) or 0
    for k in range(count + 1):
        at = reader.text.line_end(at)
        if not lights.opens(reader.text.on_line(at)):
            return k == count > 0
    return False


def read_section_by_lines(
    reader: Reader, at: int, section: Section, following: Section | None
) -> tuple[list[Any], int]:
    """The section's entries, None for each that cannot be read, and the index after them; notes what is wrong.

    Raises:
        Lost: this is no such section.
    """
    head = at
    count, at = _read_head(reader, at, section)
    found: list[Any] = []
    intact = reader.misread
    while reader.text.has(at):
        line = reader.text.on_line(at)
        if following and (
            is_alone(line) or ((count is None or len(found) >= count) and _begins(reader, at, following))
        ):
            break
        closes = following is None and count is not None and len(found) + 1 >= count
        if closes and count_planes(reader, at, found):
            break  # to be ignored
        end = _entry_end(reader, at, section)
        if closes and len(found) + 1 == count:
            end = _last_end(reader, at, end, section, len(found))
        misread = reader.misread
        entry = _read_entry(reader, at, end, lambda r, a: section.read(r, a, len(found)), f"the {section.singular}")
        if following is None and count is not None and len(found) >= count and reader.misread > misread:
            # Not one object more, but something else.
            reader.problems[-1:] = [(at, leftover(line[0], count))]
            return found, HUGE
        found.append(entry)
        if entry is None and "csg" in reader.text.cut(at, min(end - at, LONG_LINE)):  # whose operands look like objects
            return found, HUGE
        at = end
    surplus = following is None and len(found) >= (count or 0)  # of objects, which are ignored
    if count is not None and len(found) != count and reader.misread == intact and not surplus:
        message = miscounted(reader, head, section, len(found))
        if not found:
            raise Lost(head, message)
        reader.misreads(head, message)
    return found, at


def _begins(reader: Reader, at: int, section: Section) -> bool:
    """Whether the line begins the section: with an entry where the count is missing, or with a count and more."""
    line = reader.text.on_line(at)
    return section.opens(line) or (whole(line[0]) is not None and section.opens(reader.text.on_line(at + len(line))))


def _read_head(reader: Reader, at: int, section: Section) -> tuple[int | None, int]:
    """The section's count, None if it is missing or wrong, and the index of the first entry."""
    line = reader.text.on_line(at)
    if section.opens(line):
        reader.misreads(at, f"expected the number of {section.plural} alone on a line, found {shown(line[0])}")
        return None, at
    try:
        count = read_count(reader, at, section)
    except Lost as lost:
        reader.misreads(lost.at, lost.message)
        return None, reader.text.line_end(at)
    if len(line) > 1 and not section.opens(line[1:]):
        message = f"unexpected {shown(line[1])} after the number of {section.plural}{hint(line[1])}"
        reader.misreads(at + 1, message)
        return count, reader.text.line_end(at)
    return count, at + 1


def _entry_end(reader: Reader, at: int, section: Section) -> int:
    """Index after the entry that begins at the word `at`, as far as the lines tell."""
    if "csg" in reader.text.cut(at, 3) and (by_words := _csg_end(reader, at, section)):
        return by_words
    end = reader.text.line_end(at)
    while reader.text.has(end):
        line = reader.text.on_line(end)
        if not section.goes_on(reader.text[at], end - at, line):
            break
        end = reader.text.line_end(end)
    return end


def _csg_end(reader: Reader, at: int, section: Section) -> int | None:
    """Of an entry whose lines may look like entries: where its last word ends a line; if it is not whole, that of the
    file; None where its words end within a line.
    """
    try:
        _, after = section.read(reader.attempt(), at, 0)
    except Lost:
        return HUGE
    return after if not reader.text.has(after) or reader.text.line_start(after) == after else None


def _last_end(reader: Reader, at: int, end: int, section: Section, k: int) -> int:
    """Index after the last entry of a file, where it is whole: lines behind it belong to nothing."""
    if reader.text.has(end):
        return end
    try:
        _, after = section.read(reader.attempt(), at, k)
    except Lost:
        return end
    return after if after < end and reader.text.line_start(after) == after else end


def _read_entry(
    reader: Reader, at: int, end: int, read: Callable[[Reader, int], tuple[Any, int]], owner: str
) -> Any | None:
    """Read the entry that the words from `at` to `end` should be; None, and a complaint, if they are not."""
    noted = len(reader.problems)
    reader.limit = end
    try:
        entry, after = read(reader, at)
    except Lost as lost:
        wrong = lost.at, lost.message
    else:
        if after == end:
            return entry
        strange = [problem for problem in reader.problems[noted:] if not has_digits(reader.text[problem[0]])]
        wrong = strange[0] if strange else (after, _unexpected(reader, after, owner))
    finally:
        reader.limit = HUGE
    del reader.problems[noted:]  # about numbers that stand in the wrong place
    reader.misreads(*(_wrong_planes(reader, at, end) or wrong))
    return None


def _unexpected(reader: Reader, at: int, owner: str) -> str:
    """The message for a word behind an entry's last."""
    word = reader.text[at]
    if reader.text.line_start(at) == at:
        return f"unexpected {shown(word)} at the beginning of a line after {owner}{hint(word)}"
    return f"unexpected {shown(word)} after the last number of {owner}{hint(word)}"


def _reads(part: Numbers) -> Callable[[Reader, int], tuple[Any, int]]:
    def read(reader: Reader, at: int) -> tuple[Any, int]:
        found, end = reader.numbers(at, part, at), at + len(part.fields)
        return (found, lens(reader, end)[1]) if part is FOVY else (found, end)

    return read


def _wrong_planes(reader: Reader, at: int, end: int) -> tuple[int, str] | None:
    """What is wrong with a polyhedron that has a line for each plane; None if it is something else, or nothing."""
    head, line_at = reader.text.cut(at, 5), reader.text.line_end(at)
    if line_at < at + 4 or head[2] != "polyhedron" or not whole(head[3]) or end <= at + 4:
        return None
    planes, rest = divmod(line_at - at - 4, len(PLANE.fields))
    if rest:
        return at + 4, f"unexpected {shown(head[4])} after the number of planes{hint(head[4])}"
    while line_at < end:
        line = reader.text.on_line(line_at)
        size = line.index(MOVE) if MOVE in line else len(line)
        if size != len(PLANE.fields):
            return line_at, f"{PLANE.owner} needs 4 numbers for {PLANE.purpose}, found {size} on its line"
        planes += 1
        line_at += len(line)
    if planes == whole(head[3]):
        return None
    return at + 3, f"{announced(head[3])}, but {planes} {'follows' if planes == 1 else 'follow'}"
