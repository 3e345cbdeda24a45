"""A scene's text cut into words, and the way back from a word to its line and column.

Words are cut a block of lines at a time, where they are asked for, and only the last two blocks are kept: a file takes
little more room than its text, however many words and lines it has, and what is refused early is not read to its end.
"""

import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from itertools import accumulate, chain
from math import isfinite, nan
from pathlib import Path
from typing import NamedTuple

from converter.scene.errors import TAB, Problem, SceneError, did_you_mean, shown

HUGE = 10**18
"""Stands for every larger count: nothing that large is ever there, and Python refuses to convert very long ones."""
NOT_FINITE = ("nan", "inf", "infinity", "1.#inf", "1.#ind", "1.#qnan", "1.#snan")
"""What Python, C and old scenes may write for what is no finite number, in lower case and without a sign; with a `#`,
old Windows programs."""
BLOCK = 1 << 16
"""Characters that are cut at once, up to the end of the line."""
LONG_LINE = 64
"""Words of a line that are looked at to tell what it is: more than the longest entry has."""
END_OF_FILE = "\x1a"
"""Ctrl-Z, which DOS editors leave at the end of a text."""
_BLANK = re.compile(r"\s")
_WORD = re.compile(r"\S+")
_COMMENT = re.compile(r"#(?!(?<=1\.#)(?:INF|IND|QNAN|SNAN)).*")
_COMMENTS = ("//", "/*", ";", "%", "<!--")
COMMENT_HINT = ": a comment starts with '#'"
SEPARATOR_HINT = ": blanks separate numbers, and nothing else"
DECIMAL_HINT = ": decimals follow a point, not a comma"
_IMAGES = tuple(b"P%d%c" % (kind, space) for kind in range(1, 7) for space in b" \t\r\n")
_IMAGES += (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"v/1\x01")  # PNG, JPEG, GIF, OpenEXR
_DASHES = dict.fromkeys(map(ord, "\u2010\u2011\u2012\u2013\u2014\u2212\ufe63\uff0d"), "-")


class _Block(NamedTuple):
    """A piece of a text: its words, and for each of its lines the number of its first word."""

    words: list[str]
    starts: list[int]


class Words:
    """The words of a text outside comments; a word's number, from 0, is its address in all of the parser.

    Attributes:
        file: where the text comes from, for messages.
        size: characters of the text.
        plain: no word holds what `float` takes and the format does not: see `number`.
    """

    def __init__(self, text: str, file: Path | None = None) -> None:
        text = text.removeprefix("\ufeff")
        if "\r" in text:
            text = text.replace("\r\n", "\n").replace("\r", "\n")
        self.file = file
        self.plain = "_" not in text and text.isascii()
        self.size = len(text)
        self._text = text
        self._commented = "#" in text
        # Where each block begins: its first word, line and character. The last one is still to be cut, or the end.
        self._first_words, self._first_lines, self._offsets = [0], [1], [0]
        self._recent: dict[int, _Block] = {}
        self._shown = 0, ""  # the last line that was asked for
        # The block at hand.
        self._block = _Block([], [])
        self._words = self._block.words
        self._number = self._first = 0

    def __getitem__(self, at: int) -> str:
        """The word `at`; `IndexError` where the text ends before it."""
        if word := self.peek(at):
            return word
        raise IndexError(at)

    def peek(self, at: int) -> str:
        """The word `at`; empty where the text ends before it."""
        i = at - self._first
        if 0 <= i < len(self._words):
            return self._words[i]
        return self._words[at - self._first] if self._turn_to(at) else ""

    def has(self, at: int) -> bool:
        """Whether there is a word `at`."""
        return 0 <= at - self._first < len(self._words) or self._turn_to(at)

    def cut(self, at: int, count: int) -> list[str]:
        """The words from `at` on, `count` of them if there are so many."""
        i = at - self._first
        if 0 <= i <= len(self._words) - count:
            return self._words[i : i + count]
        found: list[str] = []
        while len(found) < count and self.has(at + len(found)):
            i = at + len(found) - self._first
            found += self._words[i : i + count - len(found)]
        return found

    def line(self, at: int) -> int:
        """Number, from 1, of the line that the word stands on; the last word's at the end of the text."""
        if not 0 <= at - self._first < len(self._words) and not self._turn_to(at):
            self._turn_to(self._first_words[-1] - 1)
        return self._first_lines[self._number] + bisect_right(self._block.starts, at) - 1

    def line_start(self, at: int) -> int:
        """Number of the first word on the word's line."""
        line = self.line(at)
        start = self._block.starts[line - self._first_lines[self._number]]
        return self.line_start(start - 1) if start and self.line(start - 1) == line else start

    def line_end(self, at: int) -> int:
        """Number of the word after the last one on the word's line."""
        line = self.line(at)
        following = line - self._first_lines[self._number] + 1
        starts = self._block.starts
        end = starts[following] if following < len(starts) else self._first + len(self._words)
        while self.has(end) and self.line(end) == line:  # in the next block
            end = self.line_end(end)
        return end

    def on_line(self, at: int) -> list[str]:
        """The word and those behind it on its line, `LONG_LINE` of them at most; none at the end of the text."""
        return self.cut(at, min(self.line_end(at) - at, LONG_LINE)) if self.has(at) else []

    def problem(self, at: int, message: str) -> Problem:
        """A problem with the word `at`; the number of words stands for the end of the text."""
        if not self.has(0):
            return Problem(self.file, 1, 1, message)
        last = at if self.has(at) else self._first_words[-1] - 1
        line = self.line(last)
        row = line - self._first_lines[self._number]
        text, offset = self._text, self._offsets[self._number]
        for _ in range(row):
            offset = text.index("\n", offset) + 1
        start, end = text.rfind("\n", 0, offset) + 1, offset
        for word in self._words[self._block.starts[row] - self._first : last - self._first + 1]:
            offset = text.index(word, end)
            end = offset + len(word)
        before = text[start : offset if at == last else end]
        return Problem(self.file, line, len(before.expandtabs(TAB)) + 1, message, self.source_line(line))

    def source_line(self, line: int) -> str:
        """The text of a line, counted from 1; empty if there is none."""
        if line != self._shown[0]:  # a line may be as long as the text, and have many mistakes
            k = bisect_right(self._first_lines, line) - 1
            start = self._text.rfind("\n", 0, self._offsets[k]) + 1
            for _ in range(line - self._first_lines[k]):
                start = self._text.find("\n", start) + 1 or len(self._text)
            end = self._text.find("\n", start)
            self._shown = line, self._text[start : end if end >= 0 else len(self._text)]
        return self._shown[1]

    def _turn_to(self, at: int) -> bool:
        """Take the block at hand that has the word `at`; False where the text ends before it."""
        k = bisect_right(self._first_words, at) - 1
        while self._offsets[k] < len(self._text):
            self._take(k)
            if at < self._first_words[k + 1]:
                return True
            k += 1
        return False

    def _take(self, k: int) -> None:
        """Make block `k` the one at hand. The one before is kept, too: an entry may begin in it."""
        if k not in self._recent:
            self._recent = {self._number: self._block, k: self._cut_block(k)}
        self._block, self._number, self._first = self._recent[k], k, self._first_words[k]
        self._words = self._block.words

    def _cut_block(self, k: int) -> "_Block":
        begin, known = self._offsets[k], k + 1 < len(self._offsets)
        end = self._offsets[k + 1] if known else self._block_end(begin)
        text = self._text[begin:end]
        if "#" in text:
            text = _COMMENT.sub("", text)
        words = [] if text.isspace() else [line.split() for line in text.removesuffix("\n").split("\n")]
        *starts, after = accumulate(map(len, words), initial=self._first_words[k])
        if not known:
            self._first_words.append(after)
            self._first_lines.append(self._first_lines[k] + text.count("\n"))
            self._offsets.append(end)
        return _Block(list(chain.from_iterable(words)), starts)

    def _block_end(self, begin: int) -> int:
        """Where the block that begins there ends: behind a line, or within a long one behind a word, if no comment."""
        text = self._text
        if end := text.find("\n", begin + BLOCK, begin + 2 * BLOCK) + 1:
            return end
        blank = _BLANK.search(text, begin + BLOCK)
        if blank is None:
            return len(text)
        if self._commented and _COMMENT.search(text, max(begin, text.rfind("\n", begin, blank.start())), blank.start()):
            return text.find("\n", blank.start()) + 1 or len(text)
        return blank.end()


def word_spans(text: str) -> Iterator[tuple[int, int]]:
    """Where each word of a text begins and ends, in the order of their addresses in `Words`."""
    uncommented = _COMMENT.sub(lambda comment: " " * len(comment[0]), text)
    return (word.span() for word in _WORD.finditer(uncommented))


def decode(text: str | bytes, file: Path | None) -> str:
    """The text of a scene file: UTF-8, or Latin-1 where it is not (old files have accents in their comments).

    Raises:
        SceneError: it is no text, or in an encoding of two bytes a character.
    """
    if isinstance(text, bytes) and text.startswith(_IMAGES):
        raise SceneError([Problem(file, 0, 0, "this is an image, not a scene: are input and output swapped?")])
    decoded = _decode(text, file) if isinstance(text, bytes) else text
    if decoded[-100:].rstrip().endswith(END_OF_FILE):
        decoded = decoded.rstrip().rstrip(END_OF_FILE)
    if "\0" in decoded:
        line = decoded.count("\n", 0, decoded.index("\0")) + 1
        raise SceneError([Problem(file, line, 1, "binary data (a NUL byte) where text was expected")])
    return decoded


def _decode(data: bytes, file: Path | None) -> str:
    if data[:2] in (b"\xff\xfe", b"\xfe\xff") or data[:64].count(b"\0") * 3 > len(data[:64]):
        raise SceneError([Problem(file, 0, 0, "this is UTF-16 text or binary data: save the scene as UTF-8 text")])
    try:
        return data.decode()
    except UnicodeDecodeError:
        return data.decode("latin-1")


def number(word: str) -> float:
    """The finite decimal number that `word` is; NaN if it is none (`1_000`, `0x10`, `inf` and `1e999` are not)."""
    if "_" in word or not word.isascii():  # Python would take 1_000, and digits of any script
        return nan
    try:
        value = float(word)
    except ValueError:
        return nan
    return value if isfinite(value) else nan


def whole(word: str) -> int | None:
    """The whole number that `word` is, `HUGE` if it is larger; None if it is none (`3.0`, `1e3`, `-1`)."""
    digits = word.removeprefix("+")
    if not (digits.isascii() and digits.isdigit()):
        return None
    return int(digits) if len(digits) <= 18 else min(HUGE, int(digits.lstrip("0")[:19] or "0"))


def found(word: str, names: Iterable[str] = ()) -> str:
    """`found 'x'`, with a hint where the mistake is a known one or the word is like one of the `names` expected."""
    return f"found {shown(word)}{hint(word) or did_you_mean(word, tuple(names))}"


def either(names: Iterable[str]) -> str:
    """E.g. `solid, checker or texmap`."""
    *others, last = names
    return f"{', '.join(others)} or {last}" if others else last


def hint(word: str) -> str:
    """`: a comment starts with '#'` and the like, for a word written as elsewhere; else nothing."""
    if word.startswith(_COMMENTS) or word == "--":
        return COMMENT_HINT
    if word.count(",") == 1 and number(word.replace(",", ".")) == number(word.replace(",", ".")) and word[-1] != ",":
        return DECIMAL_HINT
    parts = word.replace(";", ",").split(",")
    if len(parts) > 1 and all(not part or part.isalpha() or number(part) == number(part) for part in parts):
        return SEPARATOR_HINT
    return ""


def why_no_number(word: str) -> str:
    """`found 'x'`, with a hint where the mistake is a known one, for a word that `number` does not take."""
    plain = word.translate(_DASHES)
    if plain != word and number(plain) == number(plain):
        return f"found {shown(word)}, whose minus sign is not the plain '-'"
    if word.lower().lstrip("+-").rstrip("0") in NOT_FINITE:
        return f"found {shown(word)}, which is not finite"
    if word.isascii() and word.lower().lstrip("+-")[:1] in tuple(".0123456789") and _overflows(word):
        return f"found {shown(word)}, which is too large"
    return found(word)


def _overflows(word: str) -> bool:
    try:
        return not isfinite(float(word))
    except ValueError:
        return False
