"""Where a section went wrong, told from its lines.

The format's words may stand on any lines, so a number missing from one entry is taken from the next, and the words stop
making sense only much later. People write an entry a line, though. Where reading word after word has failed, the
section is read here once more, entry by entry as its lines suggest: the entry that is too short or too long is named,
and the others are still read.
"""

from collections.abc import Callable
from typing import Any

from converter.scene.entries import CAMERA, FOVY, NOT_YET, PLANE, Lost, Numbers, Reader
from converter.scene.errors import shown
from converter.scene.sections import Section, is_alone, miscounted, read_count
from converter.scene.tokens import number, whole


def has_lines(reader: Reader) -> bool:
    """Whether the scene is written in lines: at least three of its first four are as long as the camera's should be."""
    at, alike = 0, 0
    for part in CAMERA:
        line = reader.text.on_line(at)
        alike += len(line) == len(part.fields)
        at += len(line)
    return alike >= 3


def read_camera_by_lines(reader: Reader) -> int:
    """Note which of the camera's lines is wrong; gives the index after them.

    Raises:
        Lost: there are lines too many.
    """
    at = 0
    for part in CAMERA:
        line = reader.text.on_line(at)
        if part is FOVY and len(line) > 1 and not _may_have_lens(reader, at):
            raise Lost(at, f"expected fovy alone on its line, found {shown(line[0])} and more")
        if is_alone(line) and part is not FOVY:  # its line is missing, and this one is fovy's
            reader.misreads(at, f"expected {part.owner}, {len(part.fields)} numbers, found {shown(line[0])} alone")
            continue
        extra = "an aperture and a focal distance after fovy" if part is FOVY else ""
        _read_entry(reader, at, at + len(line), _reads(part), part.owner, extra)
        at += len(line)
    return at


def _may_have_lens(reader: Reader, at: int) -> bool:
    """Whether the line may be fovy's, with an aperture and a focal distance, and is no vector too many."""
    line = reader.text.on_line(at)
    count = reader.text.on_line(at + len(line))
    return len(line) == 3 and is_alone(count) and not is_alone(reader.text.on_line(at + len(line) + 1))


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
    while at < len(reader.words):
        line = reader.text.on_line(at)
        if following and (
            is_alone(line) or ((count is None or len(found) >= count) and _begins(reader, at, following))
        ):
            break
        end = _entry_end(reader, at, section)
        misread = reader.misread
        entry = _read_entry(
            reader, at, end, lambda r, a: section.read(r, a, len(found)), f"the {section.singular}", section.extra
        )
        if following is None and count is not None and len(found) >= count and reader.misread > misread:
            # Not one object more, but something else.
            reader.problems[-1] = (at, f"unexpected {shown(line[0])} after the last of {count} objects")
            return found, len(reader.words)
        found.append(entry)
        if entry is None and "csg" in reader.words[at:end]:  # whose operands look like objects
            return found, len(reader.words)
        at = end
    if count is not None and len(found) != count and reader.misread == intact:
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
        return None, at + len(line)
    if len(line) > 1 and not section.opens(line[1:]):
        reader.misreads(at + 1, f"unexpected {shown(line[1])} after the number of {section.plural}")
        return count, at + len(line)
    return count, at + 1


def _entry_end(reader: Reader, at: int, section: Section) -> int:
    """Index after the entry that begins at the word `at`, as far as the lines tell."""
    end = reader.text.line_end(at)
    while end < len(reader.words):
        line = reader.text.on_line(end)
        if not section.goes_on(reader.words[at], end - at, line):
            break
        end += len(line)
    return end


def _read_entry(
    reader: Reader, at: int, end: int, read: Callable[[Reader, int], tuple[Any, int]], owner: str, extra: str
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
        wrong = after, _unexpected(reader, after, owner, extra)
    finally:
        reader.limit = len(reader.words)
    del reader.problems[noted:]  # about numbers that stand in the wrong place
    reader.misreads(*(_wrong_planes(reader, at, end) or wrong))
    return None


def _unexpected(reader: Reader, at: int, owner: str, extra: str) -> str:
    """The message for a word behind an entry's last."""
    word = reader.words[at]
    if extra and number(word) == number(word):
        return f"{extra}: {NOT_YET}"
    if reader.text.line_start(at) == at:
        return f"unexpected {shown(word)} at the beginning of a line after {owner}"
    return f"unexpected {shown(word)} after the last number of {owner}"


def _reads(part: Numbers) -> Callable[[Reader, int], tuple[Any, int]]:
    return lambda reader, at: (reader.numbers(at, part, at), at + len(part.fields))


def _wrong_planes(reader: Reader, at: int, end: int) -> tuple[int, str] | None:
    """What is wrong with a polyhedron that has a line for each plane; None if it is something else, or nothing."""
    head = reader.words[at : reader.text.line_end(at)]
    if len(head) < 4 or head[2] != "polyhedron" or not whole(head[3]) or end <= at + 4:
        return None
    planes, rest = divmod(len(head) - 4, len(PLANE.fields))
    if rest:
        return at + 4, f"unexpected {shown(head[4])} after the number of planes"
    line_at = at + len(head)
    while line_at < end:
        line = reader.text.on_line(line_at)
        if len(line) != len(PLANE.fields):
            return line_at, f"{PLANE.owner} needs 4 numbers for {PLANE.purpose}, found {len(line)} on its line"
        planes += 1
        line_at += len(line)
    return at + 3, f"{shown(head[3])[1:-1]} planes are announced, but {planes} {'follows' if planes == 1 else 'follow'}"
