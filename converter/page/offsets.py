"""Places in a text as Python and as browsers count them: by characters, and by units of UTF-16."""

from converter.scene.errors import TAB


def to_browser(text: str, at: int) -> int:
    """The place before character `at`, as JavaScript's strings count."""
    return at if text.isascii() else at + sum(character > "\uffff" for character in text[:at])


def from_browser(text: str, at: int) -> int:
    """The number of the character at that place of a browser; that of the last one's end where it lies beyond."""
    if text.isascii():
        return min(max(at, 0), len(text))
    for number, character in enumerate(text):
        if at <= 0:
            return number
        at -= 2 if character > "\uffff" else 1
    return len(text)


def at_column(line: str, column: int) -> int:
    """The number of a line's character in a column, from 1, by tab stops as messages count them."""
    reached = 1
    for number, character in enumerate(line):
        if reached >= column:
            return number
        reached += TAB - (reached - 1) % TAB if character == "\t" else 1
    return len(line)
