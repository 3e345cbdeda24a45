"""The words of a scene file as its entries are read from them, and what is found wrong with them."""

from array import array
from collections import defaultdict
from math import isfinite
from pathlib import Path

from converter.pigments.table import PIGMENT_WORDS
from converter.scene.errors import shown
from converter.scene.fields import MOVE, Lost, Numbers
from converter.scene.tokens import (
    COMMENT_HINT,
    HUGE,
    NOT_FINITE,
    SEPARATOR_HINT,
    Words,
    found,
    hint,
    number,
    whole,
    why_no_number,
)
from converter.shapes.csg_program import OPERATIONS
from converter.shapes.readers import SHAPE_READERS

MOST_NOTED = 1000
"""Problems that are kept, so that a large file of nothing else takes little room: those told are the first of them."""
PIGMENT_INDEX, FINISH_INDEX = "the pigment index", "the finish index"
KEYWORDS = frozenset([*PIGMENT_WORDS, *SHAPE_READERS, MOVE])
"""Words of the format that mean something by themselves."""
_NO_NUMBERS = KEYWORDS.union(OPERATIONS)
"""Words that never stand where a number belongs: a number that is missing before one is noticed there."""

_DIGITS = {sign + str(k): float(sign + str(k)) for sign in ("", "-") for k in range(10)}
"""Numbers that scenes are full of: each is one object, wherever it stands."""


class Reader:
    """The words being read, and what has been found wrong with them.

    Attributes:
        text: the words with their places.
        folder: where texture files are looked for.
        limit: index after the last word that may be taken.
        extended: whether entries may have the optional numbers, which only the end of a line tells from what follows.
        aligned: an object has been read, so all numbers before it are what they were taken for.
        problems: address of a word and what is wrong with it, `MOST_NOTED` of them at most.
        unnoted: how many more there are.
        misread: how many of all these are about words that are missing or left over.
        notes, warnings: what the scene's reader should be told although nothing is wrong.
        textures: address of the name of each texmap's file, by the pigment's number.
        plane_lines: the line of each `plane`, which is another spelling of a polyhedron.
        light_lines, pigment_lines, finish_lines: the line of each light, pigment and finish.
        announced: the last count that was read, and is 0 if it was none.
        pigments, finishes: how many an object can choose from.
    """

    def __init__(self, text: Words) -> None:
        self.text = text
        self.folder = Path() if text.file is None else text.file.parent
        self.limit = HUGE
        self.extended = False
        self.aligned = False
        self.problems: list[tuple[int, str]] = []
        self.unnoted = 0
        self.misread = 0
        self.notes: list[str] = []
        self.warnings: list[str] = []
        self.textures: dict[int, int] = {}
        self.plane_lines = array("q")
        self.light_lines = array("q")
        self.pigment_lines = array("q")
        self.finish_lines = array("q")
        self.announced = 0
        self.pigments = 0
        self.finishes = 0
        self._indices: dict[str, dict[str, int]] = defaultdict(dict)  # those that were good: objects share them

    def attempt(self) -> "Reader":
        """A reader of the same words that has found nothing wrong yet."""
        return self._continued(Reader(self.text))

    def _continued(self, reader: "Reader") -> "Reader":
        """Another reader that goes on from here."""
        reader.pigments, reader.finishes, reader.extended = self.pigments, self.finishes, self.extended
        return reader

    def adopt(self, attempt: "Reader") -> None:
        """Take over what an attempt has found."""
        kept = MOST_NOTED - len(self.problems)
        self.unnoted += attempt.unnoted + max(0, len(attempt.problems) - kept)
        self.problems += attempt.problems[:kept]
        self.misread += attempt.misread
        self.aligned |= attempt.aligned
        self.notes += attempt.notes
        self.warnings += attempt.warnings
        self.textures.update(attempt.textures)
        self.plane_lines += attempt.plane_lines
        self.light_lines += attempt.light_lines
        self.pigment_lines += attempt.pigment_lines
        self.finish_lines += attempt.finish_lines
        self.announced = attempt.announced
        self._indices.update(attempt._indices)

    def complain(self, at: int, message: str) -> None:
        """Note that something is wrong with the word `at`."""
        if len(self.problems) < MOST_NOTED:
            self.problems.append((at, message))
        else:
            self.unnoted += 1

    def misreads(self, at: int, message: str) -> None:
        """Note that words are missing or left over at the word `at`."""
        self.misread += 1
        self.complain(at, message)

    @property
    def used_pigments(self) -> set[int]:
        """Numbers of the pigments that the objects read so far have."""
        return set(self._indices[PIGMENT_INDEX].values())

    def has(self, at: int) -> bool:
        """Whether there is a word `at` that may be taken."""
        return at < self.limit and self.text.has(at)

    def after(self, at: int, count: int) -> int:
        """Index after so many words, or of the last that may be taken."""
        return min(at + len(self.text.cut(at, count)), self.limit)

    def word(self, at: int, expected: str) -> str:
        """The word `at`, which must be there."""
        if at < self.limit and (word := self.text.peek(at)):
            return word
        last = at - 1 if self.text.has(at) else at  # not on the next line
        raise Lost(last, f"expected {expected}, found {self.ending(at)}")

    def ending(self, at: int) -> str:
        """What stands at the limit, in words for a message."""
        if not self.text.has(at):
            return "the end of the file"
        word = self.text[at]
        return shown(word) if is_name(word) or word in _NO_NUMBERS else "the end of the line"

    def numbers(self, at: int, wanted: Numbers, head: int) -> tuple[float, ...]:
        """The numbers from the word `at` on, NaN for each that is none; `head` is the word that asks for them."""
        return self.good_numbers(at, len(wanted.fields)) or self._faulty_numbers(at, wanted, head)

    def optional(self, head: int, at: int, wanted: Numbers) -> tuple[float, ...] | None:
        """The numbers, from the word `at` on, that may stand behind others on a line; None if there are none.

        There are if the entry from the word `head` on has a line of its own, and so many words are left on it; where
        the entry is known to end with the line, if any are.
        """
        if not self.extended or self.text.line_start(at - 1) != head:
            return None
        left = min(self.text.line_end(at - 1), self.limit) - at
        bounded = self.limit < HUGE
        return self.numbers(at, wanted, at) if left == len(wanted.fields) or (bounded and left > 0) else None

    def good_numbers(self, at: int, count: int) -> tuple[float, ...] | None:
        """So many numbers, if so many words follow from the word `at` on, and every one of them is a number."""
        words = self.text.cut(at, count)
        if len(words) < count or at + count > self.limit:
            return None
        try:
            values = tuple([_DIGITS[word] if word in _DIGITS else float(word) for word in words])
        except ValueError:
            return None
        plain = self.text.plain or not any("_" in word or not word.isascii() for word in words)  # see `number`
        return values if plain and isfinite(sum(values)) else None  # if the sum is finite, every term is

    def _faulty_numbers(self, at: int, wanted: Numbers, head: int) -> tuple[float, ...]:
        count = len(wanted.fields)
        words = self.text.cut(at, max(0, min(count, self.limit - at)))
        taken = next((i for i, word in enumerate(words) if word in _NO_NUMBERS), len(words))
        values = tuple(map(number, words[:taken]))
        bad = [i for i, value in enumerate(values) if value != value]
        for i in bad:
            if hint(words[i]) in (COMMENT_HINT, SEPARATOR_HINT):  # so the numbers behind it stand in the wrong places
                raise Lost(at + i, f"expected {wanted.owner}'s {wanted.fields[i]}, {found(words[i])}")
        if len(bad) * 2 > taken and not has_digits(words[bad[0]]):  # this is something else: one message will do
            raise Lost(at + bad[0], f"expected {wanted.owner}'s {wanted.fields[bad[0]]}, {found(words[bad[0]])}")
        if taken < count:
            plural = "" if count == 1 else "s"
            told = f"{wanted.owner} needs {count} number{plural} for {wanted.purpose}"
            raise Lost(head, f"{told}, found {taken} before {self.ending(at + taken)}")
        for i in bad:
            self.complain(at + i, f"{wanted.owner}'s {wanted.fields[i]} must be a number, {why_no_number(words[i])}")
        return values

    def several(self, at: int, expected: tuple[str, ...]) -> list[str]:
        """A word for each of those expected, the first at `at`; all must be there."""
        words = self.text.cut(at, len(expected))
        there = min(len(words), self.limit - at)
        return words if there == len(expected) else [self.word(at + k, what) for k, what in enumerate(expected)]

    def is_stray_name(self, word: str) -> bool:
        """Whether a word means to be a name, and is no keyword."""
        return is_name(word) and word not in KEYWORDS

    def begins_entry(self, at: int) -> bool:
        """Whether another entry, or nothing, begins at the word `at`, where a number belongs."""
        following = self.text.cut(at, max(0, min(3, self.limit - at)))
        return not following or following[0] in _NO_NUMBERS or (len(following) > 2 and following[2] in SHAPE_READERS)

    def index(self, at: int, word: str, what: str, count: int) -> int:
        """The index that the word `at` is, of one of `count` things; `what` is its name."""
        good = self._indices[what]
        if word in good:
            return good[word]
        value = whole(word)
        if value is None:
            if is_name(word) or hint(word) == COMMENT_HINT:
                raise Lost(at, f"expected {what}, {found(word)}")
            self.complain(at, f"{what} must be a whole number, {why_no_number(word)}")
            return 0
        if value >= count:
            there = f"there are {count}, counted from 0" if count > 1 else f"there is {'only 0' if count else 'none'}"
            self.complain(at, f"{what} {shown(word)[1:-1]} is out of range: {there}")
        else:
            good[word] = value
        return value


def is_name(word: str) -> bool:
    """Whether a word means to be a keyword or other name, not a number."""
    return word in KEYWORDS or (len(word) > 2 and word[0].isalpha() and word.lower() not in NOT_FINITE)


def has_digits(word: str) -> bool:
    """Whether a word may mean to be a number, however badly written."""
    return any(c.isdigit() for c in word) or word.lower().lstrip("+-") in NOT_FINITE
