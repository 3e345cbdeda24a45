"""How entries of a scene file are made of words, and the error where they are not."""

from typing import NamedTuple


class Lost(Exception):  # noqa: N818 - no error of the program
    """From the word `at` on, nothing says which word belongs to which entry."""

    def __init__(self, at: int, message: str) -> None:
        super().__init__(message)
        self.at = at
        self.message = message


class Numbers(NamedTuple):
    """A run of numbers: whose, what for, and the name of each."""

    owner: str
    purpose: str
    fields: tuple[str, ...]


RGB = ("red", "green", "blue")
"""Names of a colour's numbers."""
MOVE = "move"
"""What an object's displacement follows."""
