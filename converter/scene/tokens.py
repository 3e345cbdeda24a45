"""A scene's text cut into words, and the way back from a word to its line and column.

Only the words and the number of the first word of each line are kept: a column is found again when an error needs it,
so that a scene of half a million words is cut in a fraction of a second.
"""

import re
from bisect import bisect_right
from math import isfinite, nan
from pathlib import Path

from converter.scene.errors import TAB, Problem, SceneError, shown

HUGE = 10**18
"""Stands for every larger count: nothing that large is ever there, and Python refuses to convert very long ones."""
NOT_FINITE = ("nan", "inf", "infinity", "1.#inf", "1.#ind", "1.#qnan", "1.#snan")
"""What Python, C and old scenes may write for what is no finite number, in lower case and without a sign; with a `#`,
old Windows programs."""
_COMMENT = re.compile(r"#(?!(?<=1\.#)(?:INF|IND|QNAN|SNAN)).*")
_IMAGES = tuple(b"P%d%c" % (kind, space) for kind in range(1, 7) for space in b" \t\r\n")
_IMAGES += (b"\x89PNG", b"\xff\xd8\xff", b"GIF8", b"v/1\x01")  # PNG, JPEG, GIF, OpenEXR
_DASHES = dict.fromkeys(map(ord, "\u2010\u2011\u2012\u2013\u2014\u2212\ufe63\uff0d"), "-")


class Words:
    """The words of a text.

    Attributes:
        file: where the text comes from, for messages.
        lines: the text's lines, comments and all.
        words: every word outside comments, in order; a word's index is its address in all of the parser.
        plain: no word holds what `float` takes and the format does not: see `number`.
    """

    def __init__(self, text: str, file: Path | None = None) -> None:
        self.file = file
        self.lines = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n").split("\n")
        self.words: list[str] = []
        self._starts: list[int] = []  # per line, the index of its first word
        commented = "#" in text
        self.plain = "_" not in text and text.isascii()
        for line in self.lines:
            self._starts.append(len(self.words))
            self.words += (_COMMENT.sub("", line) if commented else line).split()

    def line(self, at: int) -> int:
        """Number, from 1, of the line that the word stands on."""
        return bisect_right(self._starts, at)

    def line_start(self, at: int) -> int:
        """Index of the first word on the word's line."""
        return self._starts[self.line(at) - 1]

    def line_end(self, at: int) -> int:
        """Index after the last word on the word's line."""
        following = self.line(at)
        return self._starts[following] if following < len(self._starts) else len(self.words)

    def on_line(self, at: int) -> list[str]:
        """The word and those behind it on its line; none at the end of the text."""
        return self.words[at : self.line_end(at)] if at < len(self.words) else []

    def problem(self, at: int, message: str) -> Problem:
        """A problem with the word `at`; the number of words stands for the end of the text."""
        if not self.words:
            return Problem(self.file, 1, 1, message)
        last = min(at, len(self.words) - 1)
        line = self.line(last)
        source = self.lines[line - 1]
        offset = end = 0
        for word in self.words[self._starts[line - 1] : last + 1]:
            offset = source.index(word, end)
            end = offset + len(word)
        before = source[: offset if at == last else end]
        return Problem(self.file, line, len(before.expandtabs(TAB)) + 1, message, source)


def decode(text: str | bytes, file: Path | None) -> str:
    """The text of a scene file: UTF-8, or Latin-1 where it is not (old files have accents in their comments).

    Raises:
        SceneError: it is no text, or in an encoding of two bytes a character.
    """
    if isinstance(text, bytes) and text.startswith(_IMAGES):
        raise SceneError([Problem(file, 0, 0, "this is an image, not a scene: are input and output swapped?")])
    decoded = _decode(text, file) if isinstance(text, bytes) else text
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


def why_no_number(word: str) -> str:
    """`found 'x'`, with a hint where the mistake is a known one, for a word that `number` does not take."""
    plain = word.translate(_DASHES)
    if plain != word and number(plain) == number(plain):
        return f"found {shown(word)}, whose minus sign is not the plain '-'"
    if word.count(",") == 1 and number(word.replace(",", ".")) == number(word.replace(",", ".")):
        return f"found {shown(word)}: decimals follow a point, not a comma"
    if word.lower().lstrip("+-").rstrip("0") in NOT_FINITE:
        return f"found {shown(word)}, which is not finite"
    if word.isascii() and word.lower().lstrip("+-")[:1] in tuple(".0123456789") and _overflows(word):
        return f"found {shown(word)}, which is too large"
    return f"found {shown(word)}"


def _overflows(word: str) -> bool:
    try:
        return not isfinite(float(word))
    except ValueError:
        return False
