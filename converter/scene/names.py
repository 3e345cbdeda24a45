"""What each number of a scene's text is: whose, and its name."""

from converter.scene.fields import Numbers
from converter.scene.parser import read_words
from converter.scene.reader import Reader
from converter.scene.tokens import Words

Names = dict[int, tuple[Numbers, str]]
"""By the number's address: the run of numbers that it is one of, and its name there."""


def read_names(text: str) -> Names:
    """The names of a text's numbers; of a text that is no scene, of those that could be read."""
    names: Names = {}
    read_words(Words(text), lambda words: _NamingReader(words, names))
    return names


class _NamingReader(Reader):
    """Notes what is read."""

    def __init__(self, text: Words, names: Names) -> None:
        super().__init__(text)
        self._names = names

    def attempt(self) -> Reader:
        reader = _NamingReader(self.text, self._names)
        reader.pigments, reader.finishes = self.pigments, self.finishes
        return reader

    def numbers(self, at: int, wanted: Numbers, head: int) -> tuple[float, ...]:
        self._names.update((at + k, (wanted, field)) for k, field in enumerate(wanted.fields))
        return super().numbers(at, wanted, head)

    def good_numbers(self, at: int, count: int) -> tuple[float, ...] | None:
        """None for what may be several planes at once, so that they are read one by one, by `numbers`."""
        return super().good_numbers(at, count) if count % 4 else None
