"""A page of `whitted serve` in a process of its own, and Debian's Chromium to look at it."""

import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from converter.files import replacing

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
PATIENCE = 60.0
"""Seconds that a process may take to end, and a page to show something, on a machine that is busy."""


class Served(NamedTuple):
    """A server: its process, its address, and the file that it serves."""

    process: "subprocess.Popen[str]"
    address: str
    scene: Path


@contextmanager
def served(scene: Path, *options: str) -> Iterator[Served]:
    """`whitted serve scene`, until the block ends."""
    command = [sys.executable, "-m", "converter.commands.main", "serve", str(scene), "--no-open", *options]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found, process.communicate()[1]
        yield Served(process, found[0], scene)
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(PATIENCE)
            finally:
                process.kill()
        process.communicate()


@contextmanager
def chromium() -> Iterator[Any]:
    """Chromium, headless, through Playwright."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


def open_page(browser: Any, address: str, width: int = 1400, height: int = 900) -> Any:
    """A window of its own with the page at `address`, whose first whole picture is there; errors in it are raised."""
    page = browser.new_context(viewport={"width": width, "height": height}).new_page()
    page.set_default_timeout(1000 * PATIENCE)
    page.errors = []
    page.on("pageerror", lambda error: page.errors.append(str(error)))
    page.on("console", lambda message: page.errors.append(message.text) if message.type == "error" else None)
    page.goto(address)
    settle(page)
    return page


def write(file: Path, text: str) -> None:
    """As a whole: the page may look at the file at any time."""
    with replacing(file) as temporary:
        temporary.write_text(text)


def settle(page: Any) -> None:
    """Wait until the whole picture of the text as it is now is shown."""
    canvas = "document.querySelector('#native canvas').dataset"
    wait_until(page, f"{canvas}.version === document.body.dataset.version && {canvas}.whole === 'true'")


def wait_until(page: Any, expression: str) -> None:
    """Wait for a JavaScript expression to be true. Playwright's own way needs `eval`, which the page forbids."""
    deadline = time.monotonic() + PATIENCE
    while not page.evaluate(expression):
        assert time.monotonic() < deadline, f"still not: {expression}"
        page.wait_for_timeout(5)
