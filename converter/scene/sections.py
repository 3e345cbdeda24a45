"""The sections after the camera: a count, then that many entries. Read here as the format says it, word after word."""

from collections.abc import Callable
from typing import Any, NamedTuple

from converter.pigments.table import PIGMENT_WORDS
from converter.scene import entries
from converter.scene.entries import CONE, FINISH, LIGHT, RADIUS
from converter.scene.errors import place, shown
from converter.scene.fields import MOVE, Lost
from converter.scene.model import Object, Polyhedron
from converter.scene.reader import Reader, is_name
from converter.scene.tokens import HUGE, hint, number, whole, why_no_number
from converter.shapes.polyhedron import PLANE, announced

Line = list[str]


class Section(NamedTuple):
    """One section: what it holds, how an entry is read, and how its lines look, which tells where a broken one ends.

    Attributes:
        plural, singular: names of what it holds.
        least: the smallest count.
        read: reads the entry with the given number at the given word, and gives it and the index after it.
        opens: whether a line (its words) is how people write an entry, or the beginning of one.
        goes_on: whether an entry that begins with this word and has so many words so far goes on with this next line.
    """

    plural: str
    singular: str
    least: int
    read: Callable[[Reader, int, int], tuple[Any, int]]
    opens: Callable[[Line], bool]
    goes_on: Callable[[str, int, Line], bool]


def is_alone(line: Line) -> bool:
    """Whether a line is how people write a section's count: one word, and no name."""
    return len(line) == 1 and not is_name(line[0])


def _is_numeric(line: Line) -> bool:
    return len(line) > 1 and not any(map(is_name, line[:3]))


def _pigment_goes_on(first: str, size: int, line: Line) -> bool:
    kind = PIGMENT_WORDS.get(first)
    unfinished = size < kind.WORDS + len(kind.NUMBERS.fields) if kind else len(line) != len(FINISH.fields)
    return unfinished and _is_numeric(line)


def _opens_object(line: Line) -> bool:
    return any(is_name(word) and word != MOVE for word in line[:3])


SECTIONS = (
    Section(
        "lights",
        "light",
        1,
        entries.light,
        lambda line: _is_numeric(line) and 0 <= len(line) - len(LIGHT.fields) <= len(RADIUS.fields),
        lambda first, size, line: _is_numeric(line) and size + len(line) <= len(LIGHT.fields),
    ),
    Section("pigments", "pigment", 0, entries.pigment, lambda line: bool(line) and is_name(line[0]), _pigment_goes_on),
    Section(
        "finishes",
        "finish",
        0,
        entries.finish,
        lambda line: _is_numeric(line) and 0 <= len(line) - len(FINISH.fields) <= len(CONE.fields),
        lambda first, size, line: _is_numeric(line) and size + len(line) <= len(FINISH.fields),
    ),
    Section("objects", "object", 0, entries.object_, _opens_object, lambda first, size, line: not _opens_object(line)),
)


def read_count(reader: Reader, at: int, section: Section) -> int:
    """The section's count at the word `at`; `Lost` if it is none."""
    reader.announced = 0
    word = reader.word(at, f"the number of {section.plural}")
    count = whole(word)
    if count is None and number(word) != number(word):
        raise Lost(at, f"expected the number of {section.plural}, {why_no_number(word)}")
    if count is None or count < section.least:
        expected = f"a whole number from {section.least} on"
        raise Lost(at, f"the number of {section.plural} must be {expected}, found {shown(word)}")
    reader.announced = count
    return count


def read_by_count(reader: Reader, at: int, section: Section) -> tuple[list[Any], int]:
    """The section's entries, as many as its count at the word `at` says, and the index after them.

    Raises:
        Lost: a word stands where it cannot, or words are missing.
    """
    head = at
    count = read_count(reader, at, section)
    at += 1
    found: list[Any] = []
    while len(found) < count:
        try:
            entry, at = section.read(reader, at, len(found))
        except Lost:
            if reader.has(at):
                raise
            break
        found.append(entry)
    if len(found) < count:
        raise Lost(head, miscounted(reader, head, section, len(found)))
    return found, at


def miscounted(reader: Reader, at: int, section: Section, found: int) -> str:
    """The message for a section whose count, at the word `at`, is not what follows."""
    told = f"the number of {section.plural} is given as {shown(reader.text[at])[1:-1]}"
    return f"{told}, but {found or 'none'} {'follows' if found == 1 else 'follow'}"


def pass_over_surplus(reader: Reader, head: int, at: int, found: list[Object | None]) -> None:
    """Warn that what stands behind the last object is ignored; `head` is the number of objects, `at` what follows them.

    People lower a count to leave out the last objects, or the last planes of the last one.

    Raises:
        Lost: it is no whole objects, and no planes of the last one.
    """
    file = reader.text.file
    if planes := count_planes(reader, at, found):
        last = found[-1]
        assert last is not None and isinstance(last.shape, Polyhedron)
        count = len(last.shape.planes)
        told = f"{announced(str(count))}, but {count + planes} follow"
        reader.warnings.append(f"{place(file, last.line)}: {told}; {_ignored(planes)}")
        return
    attempt = reader.attempt()
    attempt.pigments = attempt.finishes = HUGE  # what is ignored may have any
    count, end = len(found), at
    while attempt.has(end):
        try:
            _, end = entries.object_(attempt, end, count)
        except Lost:
            break
        count += 1
    if attempt.has(end):
        raise Lost(at, leftover(reader.text[at], len(found)))
    told = miscounted(reader, head, SECTIONS[-1], count)
    if attempt.problems:
        raise Lost(head, told)
    reader.warnings.append(f"{place(file, reader.text.line(head))}: {told}; {_ignored(count - len(found))}")


def count_planes(reader: Reader, at: int, found: list[Object | None]) -> int:
    """How many planes, a line each, follow the last object to the end of the file; 0 if it has none, or others do."""
    last = found[-1] if found else None
    if last is None or not isinstance(last.shape, Polyhedron) or reader.text.line_start(at) != at:
        return 0
    count, size = 0, len(PLANE.fields)
    while reader.text.has(at):
        if reader.text.line_end(at) - at != size or not reader.good_numbers(at, size):
            return 0
        count += 1
        at += size
    return count


def leftover(word: str, count: int) -> str:
    """The message for a word behind the last of so many objects."""
    where = {0: "where no objects are announced", 1: "after the only object"}.get(
        count, f"after the last of {count} objects"
    )
    return f"unexpected {shown(word)} {where}{hint(word)}"


def _ignored(count: int) -> str:
    return "the last one is ignored" if count == 1 else f"the last {count} are ignored"
