"""The sections after the camera: a count, then that many entries. Read here as the format says it, word after word."""

from collections.abc import Callable
from typing import Any, NamedTuple

from converter.scene import entries
from converter.scene.entries import FINISH, LIGHT, PIGMENTS, Lost, Reader, is_name
from converter.scene.errors import shown
from converter.scene.tokens import number, whole, why_no_number

Line = list[str]


class Section(NamedTuple):
    """One section: what it holds, how an entry is read, and how its lines look, which tells where a broken one ends.

    Attributes:
        plural, singular: names of what it holds.
        least: the smallest count.
        read: reads the entry with the given number at the given word, and gives it and the index after it.
        opens: whether a line (its words) is how people write an entry, or the beginning of one.
        goes_on: whether an entry that begins with this word and has so many words so far goes on with this next line.
        extra: what one number more on an entry's line would mean; empty if nothing.
    """

    plural: str
    singular: str
    least: int
    read: Callable[[Reader, int, int], tuple[Any, int]]
    opens: Callable[[Line], bool]
    goes_on: Callable[[str, int, Line], bool]
    extra: str = ""


def is_alone(line: Line) -> bool:
    """Whether a line is how people write a section's count: one word, and no name."""
    return len(line) == 1 and not is_name(line[0])


def _is_numeric(line: Line) -> bool:
    return len(line) > 1 and not any(map(is_name, line[:3]))


def _pigment_goes_on(first: str, size: int, line: Line) -> bool:
    kind = PIGMENTS.get(first)
    unfinished = size < kind.before + len(kind.numbers.fields) if kind else len(line) != len(FINISH.fields)
    return unfinished and _is_numeric(line)


def _opens_object(line: Line) -> bool:
    return any(map(is_name, line[:3]))


SECTIONS = (
    Section(
        "lights",
        "light",
        1,
        entries.light,
        lambda line: _is_numeric(line) and len(line) == len(LIGHT.fields),
        lambda first, size, line: _is_numeric(line) and size + len(line) <= len(LIGHT.fields),
        "a light's 10th number (its radius, for soft shadows)",
    ),
    Section("pigments", "pigment", 0, entries.pigment, lambda line: bool(line) and is_name(line[0]), _pigment_goes_on),
    Section(
        "finishes",
        "finish",
        0,
        entries.finish,
        lambda line: _is_numeric(line) and len(line) == len(FINISH.fields),
        lambda first, size, line: _is_numeric(line) and size + len(line) <= len(FINISH.fields),
        "a finish's 8th number (its cone's angle, for glossy rays)",
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
        if at >= reader.limit:
            raise Lost(head, miscounted(reader, head, section, len(found)))
        entry, at = section.read(reader, at, len(found))
        found.append(entry)
    return found, at


def miscounted(reader: Reader, at: int, section: Section, found: int) -> str:
    """The message for a section whose count, at the word `at`, is not what follows."""
    told = f"the number of {section.plural} is given as {shown(reader.words[at])[1:-1]}"
    return f"{told}, but {found or 'none'} {'follows' if found == 1 else 'follow'}"
