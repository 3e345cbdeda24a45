"""Writes the scenes of `sampled/`, and draws their pictures: soft shadows, glossy rays, depth of field, motion.

    python scenes/sampled.py               rewrite the scenes
    python scenes/sampled.py --pictures    draw them (or those named) into sampled/pictures/, and all onto one sheet

Drawing needs the installed project. What is written is the same on every machine, byte by byte; see `generate.py`.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from making.sampled_scenes import SCENES

FOLDER = Path(__file__).resolve().parent / "sampled"

PICTURE, SAMPLES = (560, 420), 576
"""Size of a picture in pixels, and its rays a pixel: with few, noise makes files larger."""
TILE, TILE_SAMPLES = (224, 168), 1024
"""The same of those on the sheet."""
COLUMNS, GAP = 3, 4
"""How many stand side by side, and the white between them, in pixels."""


def generated() -> dict[str, bytes]:
    """Every scene, by its file's name."""
    return {f"{name}.in": str(make()).encode() for name, make in SCENES.items()}


def drawn(name: str, width: int, height: int, samples: int) -> Any:
    """The picture of a scene: (height, width, 3) float32, linear RGB."""
    import numpy as np

    from converter.renderers.native import NativeRenderer
    from converter.scene.parser import load_scene
    from converter.scene.settings import Settings

    settings = Settings(width, height, samples=samples)
    return np.asarray(NativeRenderer().render(load_scene(FOLDER / f"{name}.in"), settings).pixels)


def sheet(pictures: Sequence[Any]) -> Any:
    """Pictures of one size side by side, row by row, on white."""
    import numpy as np

    height, width, _ = pictures[0].shape
    rows = -(-len(pictures) // COLUMNS)
    whole = np.ones((rows * (height + GAP) - GAP, COLUMNS * (width + GAP) - GAP, 3), np.float32)
    for k, picture in enumerate(pictures):
        y, x = k // COLUMNS * (height + GAP), k % COLUMNS * (width + GAP)
        whole[y : y + height, x : x + width] = picture
    return whole


def write_picture(name: str, picture: Any) -> None:
    """Write pictures/NAME.png."""
    from converter.images.write import write_image

    height, width, _ = picture.shape
    write_image(FOLDER / "pictures" / f"{name}.png", picture, width, height)


def draw_pictures(names: Sequence[str]) -> None:
    """Draw scenes into pictures/; all of them, and the sheet, if none is named."""
    (FOLDER / "pictures").mkdir(exist_ok=True)
    for name in names or SCENES:
        write_picture(name, drawn(name, *PICTURE, SAMPLES))
    if not names:
        write_picture("sheet", sheet([drawn(name, *TILE, TILE_SAMPLES) for name in SCENES]))


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
