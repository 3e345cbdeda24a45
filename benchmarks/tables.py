"""Tables as docs/figures.md has them: Markdown between two comments with the table's name."""

from collections.abc import Iterable, Sequence


def begin(name: str) -> str:
    """The line before a table."""
    return f"<!-- table: {name} -->"


END = "<!-- end of table -->"


def print_table(name: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table, row by row as they come; `benchmarks/put_tables.py` puts it in its place of that name."""
    print(f"{begin(name)}\n{_row(heads)}\n|{'---|' * len(heads)}")
    for row in rows:
        print(_row(row), flush=True)
    print(END)


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |".replace("|  |", "| |").replace("|  |", "| |")
