"""Makes one site of docs/ and the pages that lie elsewhere: mkdocs knows one folder only.

The site has docs/ at its root, the README as its first page, and the scenes in a folder beside them; links are turned
to where that puts things.
"""

import re
from os.path import relpath
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
FIRST = "index.md"
PAGES = ("README.md", "LEIAME.md", "CONTRIBUTING.md", "CHANGELOG.md")
SCENES = ("*.md", "*.in", "*.toml", "*.png", "*.svg")
"""What pages show, link to or are, in the folder of scenes."""


def on_files(files: Files, config: Any) -> Files:
    """Add what lies outside docs/."""
    for page in PAGES:
        files.append(File.generated(config, _site(page), abs_src_path=str(ROOT / page)))
    for pattern in SCENES:
        for found in sorted((ROOT / "scenes").rglob(pattern)):
            files.append(File.generated(config, found.relative_to(ROOT).as_posix(), abs_src_path=str(found)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Turn a page's links from where its file is to where the site has it."""
    uri = page.file.src_uri
    own = Path(page.file.abs_src_path).parent
    folder = (ROOT / "site" / uri).parent

    def turned(match: re.Match[str]) -> str:
        name, mark, anchor = match[1].partition("#")
        if not name or re.match(r"[a-z]+:", name):
            return match[0]
        target = (own / name).resolve()
        if not target.is_relative_to(ROOT):
            return match[0]
        there = ROOT / "site" / _site(target.relative_to(ROOT).as_posix())
        return f"]({relpath(there, folder)}{mark}{anchor})"

    return re.sub(r"\]\(([^)\s]+)\)", turned, markdown)


def _site(name: str) -> str:
    """Where the site has a file of the project."""
    return FIRST if name == "README.md" else name.removeprefix("docs/")
