"""Prints what extras of pyproject.toml require, a line each: what `pip install -r` reads.

    packaging/requirements.py EXTRA...

Installing `.[EXTRA]` would build the tracers once more.
"""

import re
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"


def requirements(names: Sequence[str], extras: Mapping[str, Sequence[str]], project: str) -> Iterator[str]:
    """What these extras require; an extra of the project itself, as `project[docs]`, stands for what that requires.

    Raises:
        KeyError: there is no such extra.

    """
    for name in names:
        for requirement in extras[name]:
            own = re.fullmatch(rf"{re.escape(project)}\[([\w,-]+)\]", requirement)
            if own:
                yield from requirements(own[1].split(","), extras, project)
            else:
                yield requirement


if __name__ == "__main__":
    told = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]
    print("\n".join(requirements(sys.argv[1:], told["optional-dependencies"], told["name"])))
