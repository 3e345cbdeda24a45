"""Prints how long `whitted serve` takes from a key to the new picture, in a real Chromium.

    python benchmarks/page.py                         Figure 1 at 480 x 360, 60 keys
    python benchmarks/page.py scenes/whitted.in --keys 200
    python benchmarks/page.py scenes/whitted.in --picture docs/page.png --pixel 184 202
    python benchmarks/page.py --mistake docs/page_mistake.png

A digit is typed after a number of the camera, and deleted again. Time runs from the key's event to the frame of the
browser after the one in which the whole picture was put on its canvas. Needs Debian's Chromium and the package's `test`
extra. `--picture` and `--mistake` draw the pictures of docs/serve.md instead.
"""

import argparse
import shutil
import statistics
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

from browser import CHROMIUM, chromium, open_page, served, wait_until

FIGURE_1 = Path(__file__).resolve().parent.parent / "scenes" / "figure1.in"
WIDTH, HEIGHT = 1200, 640
"""Of the browser's window."""
WARM = 5
"""Keys that are not counted."""
WATCH = """
() => {
  const canvas = document.querySelector("#native canvas");
  window.waits = [];
  let pressed = null;
  addEventListener("keydown", (event) => { pressed = event.timeStamp; }, true);
  new MutationObserver(() => {
    if (pressed === null || canvas.dataset.whole !== "true") return;
    const began = pressed;
    pressed = null;
    requestAnimationFrame(() => requestAnimationFrame((now) => window.waits.push(performance.now() - began)));
  }).observe(canvas, { attributes: true, attributeFilter: ["data-version"] });
}
"""


def main() -> int:
    """Type, and print; return the status."""
    parser = argparse.ArgumentParser(description="Time from a key to the picture in `whitted serve`.")
    parser.add_argument("scene", type=Path, nargs="?", default=FIGURE_1, help="(Figure 1)")
    parser.add_argument("--size", type=int, nargs=2, default=(480, 360), metavar=("WIDTH", "HEIGHT"))
    parser.add_argument("--keys", type=int, default=60, help="how many are timed (60)")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="draw the page with a pixel's rays instead")
    parser.add_argument("--pixel", type=int, nargs=2, default=(268, 334), metavar=("X", "Y"), help="whose rays")
    parser.add_argument("--mistake", type=Path, metavar="FILE", help="draw the page with a mistake instead")
    arguments = parser.parse_args()
    if CHROMIUM is None:
        print("there is no Chromium (Debian: apt install chromium)", file=sys.stderr)
        return 3
    with tempfile.TemporaryDirectory() as folder:
        scene = Path(shutil.copytree(arguments.scene.parent, Path(folder, "scenes")), arguments.scene.name)
        size = map(str, arguments.size)
        with served(scene, *size) as server, chromium() as browser:
            page = open_page(browser, server.address, WIDTH, HEIGHT)
            if arguments.picture:
                _show_rays(page, arguments.pixel, arguments.size, arguments.picture)
            if arguments.mistake:
                _show_mistake(page, scene, arguments.mistake)
            if arguments.picture or arguments.mistake:
                return 0
            waits = _type(page, arguments.keys)
    told = f"median {statistics.median(waits):.1f} ms, 95 % within {sorted(waits)[int(0.95 * len(waits))]:.1f} ms"
    width, height = arguments.size
    print(f"{arguments.scene.name} at {width} x {height}, from key to picture: {told}, {len(waits)} keys")
    return 0


def _type(page: Any, keys: int) -> list[float]:
    """Milliseconds of each key."""
    line = page.locator(".cm-line").filter(has_not_text="#").first
    line.click()
    page.keyboard.press("End")
    page.evaluate(WATCH)
    for k in range(keys + WARM):
        page.keyboard.press("Backspace" if k % 2 else "5")
        wait_until(page, f"window.waits.length > {k}")
        page.wait_for_timeout(30)
    waits: list[float] = page.evaluate("window.waits")
    return waits[WARM:]


def _show_rays(page: Any, pixel: tuple[int, int], size: tuple[int, int], file: Path) -> None:
    page.keyboard.press("Alt+m")
    page.wait_for_selector("#difference canvas[data-version]")
    box = page.locator("#native canvas").first.bounding_box()
    x, y = ((at + 0.5) / most for at, most in zip(pixel, size, strict=True))
    page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
    wait_until(page, "document.querySelector('#same').textContent.includes('trees')")
    page.screenshot(path=file)
    page.keyboard.press("Alt+m")
    page.keyboard.press("Escape")


def _show_mistake(page: Any, scene: Path, file: Path) -> None:
    scene.write_text(scene.read_text().replace("\nchecker", "\ncheker", 1))
    page.locator("#mistakes li").click()
    page.hover(".mistake")
    page.wait_for_selector(".told")
    page.screenshot(path=file)


if __name__ == "__main__":
    sys.exit(main())
