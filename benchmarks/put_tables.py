"""Puts tables that the benchmarks have printed into docs/figures.md, each between the comments with its name.

make figures | tee out/figures.txt
python benchmarks/put_tables.py out/figures.txt
"""

import sys
from pathlib import Path

from tables import END, begin

FIGURES = Path(__file__).resolve().parent.parent / "docs" / "figures.md"


def main() -> None:
    """Replace the tables of the page that the files on the command line have; status 1 if it has none of a name."""
    text = FIGURES.read_text(encoding="utf-8")
    for file in sys.argv[1:]:
        for name, table in tables(Path(file).read_text(encoding="utf-8")).items():
            try:
                text = replaced(text, name, table)
            except ValueError:
                sys.exit(f"{FIGURES.name} has no place for the table {name!r} of {file}")
    FIGURES.write_text(text, encoding="utf-8")


def tables(printed: str) -> dict[str, str]:
    """The tables in a text, by name, each with its comments."""
    found = {}
    for part in printed.split(begin("")[: -len(" -->")])[1:]:
        name, body = part.split(" -->\n", 1)
        if END in body:  # else it was not printed to its end
            found[name] = f"{begin(name)}\n{body[: body.index(END)]}{END}"
    return found


def replaced(text: str, name: str, table: str) -> str:
    """A text with another table of that name; `ValueError` if it has none."""
    start = text.index(begin(name))
    return text[:start] + table + text[text.index(END, start) + len(END) :]


if __name__ == "__main__":
    main()
