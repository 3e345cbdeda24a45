"""Writes the scenes of `sampled/`, and draws their pictures: soft shadows, glossy rays, depth of field, motion.

    python scenes/sampled.py               rewrite the scenes
    python scenes/sampled.py --pictures    draw them (or those named) into sampled/pictures/, and all onto one sheet

Drawing needs the installed project. What is written is the same on every machine, byte by byte; see `generate.py`.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from making.png import palette_png
from making.sampled_scenes import SCENES

FOLDER = Path(__file__).resolve().parent / "sampled"

PICTURE, SAMPLES = (640, 480), 64
"""Size of a picture in pixels, and its rays a pixel."""
TILE, TILE_SAMPLES = (272, 204), 144
"""The same of those on the sheet."""
COLUMNS, GAP = 3, 4
"""How many stand side by side, and the white between them, in pixels."""
NOISE = 4.0
"""Of 255 levels."""


def generated() -> dict[str, bytes]:
    """Every scene, by its file's name."""
    return {f"{name}.in": str(make()).encode() for name, make in SCENES.items()}


def drawn(name: str, width: int, height: int, samples: int) -> Any:
    """The picture of a scene: (height, width, 3), 0 to 255."""
    import numpy as np

    from converter.renderers.native import NativeRenderer
    from converter.scene.parser import load_scene
    from converter.scene.settings import Settings

    settings = Settings(width, height, samples=samples)
    rendering = NativeRenderer().render(load_scene(FOLDER / f"{name}.in"), settings)
    return np.rint(255 * np.clip(np.asarray(rendering.pixels, dtype=float), 0, 1))


def sheet(pictures: Sequence[Any]) -> Any:
    """Pictures of one size side by side, row by row, on white."""
    import numpy as np

    height, width, _ = pictures[0].shape
    rows = -(-len(pictures) // COLUMNS)
    whole = np.full((rows * (height + GAP) - GAP, COLUMNS * (width + GAP) - GAP, 3), 255.0)
    for k, picture in enumerate(pictures):
        y, x = k // COLUMNS * (height + GAP), k % COLUMNS * (width + GAP)
        whole[y : y + height, x : x + width] = picture
    return whole


def dithered(picture: Any) -> Any:
    """A picture with a little noise, so that 256 colours leave no steps in its gradients."""
    import numpy as np

    noise = np.random.default_rng(0).uniform(-NOISE, NOISE, picture.shape[:2])
    return np.rint(np.clip(picture + noise[..., None], 0, 255))


def draw_pictures(names: Sequence[str]) -> None:
    """Draw scenes into pictures/; all of them, and the sheet, if none is named."""
    (FOLDER / "pictures").mkdir(exist_ok=True)
    for name in names or SCENES:
        (FOLDER / "pictures" / f"{name}.png").write_bytes(palette_png(dithered(drawn(name, *PICTURE, SAMPLES))))
    if not names:
        tiles = [drawn(name, *TILE, TILE_SAMPLES) for name in SCENES]
        (FOLDER / "pictures" / "sheet.png").write_bytes(palette_png(dithered(sheet(tiles))))


def main() -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(description="Write the sampled scenes, or draw their pictures.")
    parser.add_argument(
        "--pictures", nargs="*", metavar="NAME", help="draw these scenes, or all and a sheet, and write nothing else"
    )
    pictures = parser.parse_args().pictures
    if pictures is not None:
        draw_pictures(pictures)
        return
    FOLDER.mkdir(exist_ok=True)
    for name, data in generated().items():
        (FOLDER / name).write_bytes(data)


if __name__ == "__main__":
    main()
