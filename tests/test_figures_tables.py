"""The tables of the pages in docs/ are those that the benchmarks print."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "benchmarks"))

import put_tables  # noqa: E402
from tables import print_table  # noqa: E402


def test_every_table_that_is_printed_has_its_place_in_one_page() -> None:
    programs = "".join(file.read_text(encoding="utf-8") for file in (ROOT / "benchmarks").glob("*.py"))
    printed = set(re.findall(r'print_table\("(\w+)"', programs))
    assert printed
    places = [name for page in put_tables.PAGES for name in put_tables.tables(page.read_text(encoding="utf-8"))]
    assert sorted(printed) == sorted(places)


def test_a_table_takes_its_place_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    print("before")
    print_table("one", ["", "a"], [["x", "1"], ["y", ""]])
    print_table("other", ["b"], [["2"]])
    printed = capsys.readouterr().out + "<!-- table: broken -->\n| never ended"
    found = put_tables.tables(printed)
    assert set(found) == {"one", "other"}
    assert found["one"].splitlines()[1:-1] == ["| | a |", "|---|---|", "| x | 1 |", "| y | |"]
    text = "A\n<!-- table: other -->\nold\n<!-- end of table -->\nB\n"
    assert put_tables.replaced(text, "other", found["other"]) == f"A\n{found['other']}\nB\n"
    with pytest.raises(ValueError):
        put_tables.replaced(text, "one", found["one"])
