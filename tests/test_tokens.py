"""A text cut into words a block at a time gives the words, lines and columns of one that is cut at once."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.scene import tokens
from converter.scene.errors import TAB
from converter.scene.tokens import Words

PIECES = st.sampled_from(["a", "12", "1.#INF", "#", "# b c", " ", "  ", "\t", "\n", "\n\n", "\f", "\u2003", "word" * 5])
BLOCKS = [1, 7, tokens.BLOCK]


def cut_at_once(text: str) -> list[tuple[str, int, int]]:
    """Words outside comments with their lines and columns, both from 1."""
    found = []
    for number, line in enumerate(text.split("\n"), start=1):
        bare = re.sub(r"#(?!(?<=1\.#)INF).*", "", line)
        for match in re.finditer(r"\S+", bare):
            found.append((match[0], number, len(line[: match.start()].expandtabs(TAB)) + 1))
    return found


@pytest.mark.parametrize("block", BLOCKS)
@settings(max_examples=150, deadline=None)
@given(parts=st.lists(PIECES, max_size=40), order=st.randoms())
def test_words_lines_and_columns(block: int, parts: list[str], order: "st.random.Random") -> None:  # type: ignore[name-defined]
    text = "".join(parts)
    expected = cut_at_once(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tokens, "BLOCK", block)
        words = Words(text)
        addresses = list(range(len(expected)))
        order.shuffle(addresses)
        for at in addresses:
            word, line, column = expected[at]
            problem = words.problem(at, "")
            assert (words[at], words.line(at), problem.line, problem.column) == (word, line, line, column)
            assert problem.source_line == text.split("\n")[line - 1] == words.source_line(line)
            on_line = [k for k, (_, other, _) in enumerate(expected) if other == line]
            assert (words.line_start(at), words.line_end(at)) == (on_line[0], on_line[-1] + 1)
            assert words.on_line(at) == [expected[k][0] for k in on_line if k >= at]
        assert words.cut(0, len(expected) + 5) == [word for word, _, _ in expected]
        assert not words.has(len(expected))
        assert words.peek(len(expected)) == ""
        with pytest.raises(IndexError):
            words[len(expected)]


def test_a_text_is_cut_no_farther_than_needed() -> None:
    words = Words("1 2 3\n" * 1_000_000)
    assert words[5] == "3"
    assert len(words._offsets) == 2
