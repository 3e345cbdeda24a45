"""Puts tables that the benchmarks have printed into the pages of docs/, each between the comments with its name.

make figures | tee out/figures.txt
python benchmarks/put_tables.py out/figures.txt
"""

import sys
from pathlib import Path

from tables import END, begin

PAGES = sorted((Path(__file__).resolve().parent.parent / "docs").glob("*.md"))


def main() -> None:
    """Replace the tables that the files on the command line have; status 1 if no page has a place for one of them."""
    texts = {page: page.read_text(encoding="utf-8") for page in PAGES}
    for file in sys.argv[1:]:
        for name, table in tables(Path(file).read_text(encoding="utf-8")).items():
            page = next((page for page, text in texts.items() if begin(name) in text), None)
            if page is None:
                sys.exit(f"no page of docs/ has a place for the table {name!r} of {file}")
            texts[page] = replaced(texts[page], name, table)
    for page, text in texts.items():
        if text != page.read_text(encoding="utf-8"):
            page.write_text(text, encoding="utf-8")


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
