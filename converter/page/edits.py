"""Changes to a scene's text that touch a few words of it and leave all else: blanks, comments, other numbers."""

from collections.abc import Mapping
from itertools import islice

from converter.scene.model import Vector
from converter.scene.numerals import numerals
from converter.scene.tokens import word_spans


def with_eye(text: str, eye: Vector) -> str:
    """A scene's text with another eye; its coordinates are the first three words."""
    return with_words(text, {k: numerals(value) for k, value in enumerate(eye)})


def with_words(text: str, words: Mapping[int, str]) -> str:
    """A text with some words, by their number from 0, replaced.

    Raises:
        IndexError: there are not so many words.

    """
    spans = list(islice(word_spans(text), max(words, default=-1) + 1))
    for k in sorted(words, reverse=True):
        start, end = spans[k]
        text = text[:start] + words[k] + text[end:]
    return text
