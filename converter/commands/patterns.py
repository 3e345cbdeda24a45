"""Names of many pictures, from a pattern such as `pictures/{name}.png`."""

import re
from pathlib import Path
from string import Formatter
from typing import Any

from converter.commands.exits import UsageError


def fields_of(option: str, pattern: str, known: tuple[str, ...]) -> set[str]:
    """The fields that a pattern has.

    Raises:
        UsageError: it is no pattern, or has a field that is not known.

    """
    try:
        parts = [(name, form) for _, name, form, _ in Formatter().parse(pattern) if name is not None]
        found = {name for name, _ in parts}
        for _, form in parts:
            if re.search(r"\d{4}", form or ""):
                raise UsageError(f"{option}: {pattern!r} asks for a name of more than 999 characters")
        for name in found:
            if name not in known:
                there = " and ".join(f"{{{each}}}" for each in known)
                raise UsageError(f"{option}: there is no {{{name}}}: a pattern may have {there}")
    except ValueError as error:
        raise UsageError(f"{option}: {pattern!r} is no pattern: {error}") from None
    return found


def named(option: str, pattern: str, **values: Any) -> Path:
    """The file that the pattern names for these values.

    Raises:
        UsageError: a number is to be written in a way that there is not.

    """
    try:
        return Path(pattern.format(**values))
    except (ValueError, IndexError, KeyError, AttributeError, TypeError) as error:
        raise UsageError(f"{option}: {pattern!r} is no pattern: {error}") from None


def has_fields(pattern: str) -> bool:
    """Whether a file's name is a pattern, be it one whose bracket is not closed."""
    return re.search(r"(?<!\{)\{([a-z]*(:[^{}]*)?\}|frame\b)", pattern) is not None
