"""A scene's text as the page has it, and the file that it comes from.

In the page lines end with a line feed, whatever they end with in the file; saving puts back what the file had.
"""

import shutil
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from converter.files import replacing
from converter.scene.errors import Problem, SceneError
from converter.scene.tokens import decode

MOST_CHARACTERS = 1 << 20
"""Of a text in the page: a larger one is no longer read while somebody types."""
_MARK = "\ufeff"


class ChangedElsewhereError(Exception):
    """The file is not what it was when it was last read or written here."""


@dataclass(frozen=True, slots=True)
class Document:
    """What is in a file.

    Attributes:
        data: its bytes.
        text: its text, whose lines end with a line feed.
        encoding: "utf-8" or "latin-1".
        marked: whether it begins with a byte-order mark.
        newline: how its lines end.

    """

    data: bytes
    text: str
    encoding: str
    marked: bool
    newline: str


def read_document(file: Path) -> Document:
    """What is in `file`.

    Raises:
        OSError: it cannot be read.
        SceneError: it is no text, or longer than the page bears.

    """
    with file.open("rb") as opened:
        data = opened.read(4 * MOST_CHARACTERS + 1)
    text = decode(data, file)
    if len(text) > MOST_CHARACTERS:
        raise SceneError([Problem(file, 0, 0, f"the page bears {MOST_CHARACTERS:,} characters, and there are more")])
    try:
        data.decode()
        encoding = "utf-8"
    except UnicodeDecodeError:
        encoding = "latin-1"
    newline = "\r\n" if "\r\n" in text else "\n"
    plain = text.removeprefix(_MARK).replace("\r\n", "\n").replace("\r", "\n")
    return Document(data, plain, encoding, text.startswith(_MARK), newline)


def encoded(text: str, like: Document) -> bytes:
    """The bytes of a text in a file like that; what Latin-1 has no room for makes it UTF-8."""
    written = (_MARK if like.marked else "") + text.replace("\n", like.newline)
    with suppress(UnicodeEncodeError):
        return written.encode(like.encoding)
    return written.encode("utf-8", "replace")


def save(file: Path, text: str, like: Document, over: bool = False) -> Document:
    """Write a text into `file`, which changes as a whole or not at all; returns what is in it then.

    Args:
        file: the scene's file.
        text: the page's.
        like: what was last read from the file or written to it.
        over: write even if it is not what is in the file now.

    Raises:
        ChangedElsewhereError: it is not, and not `over`.
        OSError: the file cannot be written.

    """
    try:
        found: bytes | None = file.read_bytes()
    except FileNotFoundError:
        found = None
    data = encoded(text, like)
    if not over and found not in (None, like.data, data):
        raise ChangedElsewhereError
    with replacing(file) as temporary:
        temporary.write_bytes(data)
        with suppress(FileNotFoundError):
            shutil.copymode(file, temporary)
    return Document(data, text, like.encoding, like.marked, like.newline)
