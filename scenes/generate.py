"""Writes the textures and the computed scenes of this folder, and draws the pictures of its README.

    python scenes/generate.py               rewrite textures and computed scenes
    python scenes/generate.py --pictures    draw every scene (or those named) into pictures/, and rewrite nothing else

The other scenes are written by hand. What this script writes is the same on every machine, byte by byte: it uses the
standard library alone, and numbers are rounded before they are written.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

from making.gallery import SCENES
from making.textures import TEXTURES

FOLDER = Path(__file__).resolve().parent

PICTURE = (640, 480)
"""Size of a picture in pixels."""

OPTIONS: dict[str, dict[str, str]] = {"bubble": {"ior": "ratio"}}
"""Settings that scenes are to be drawn with, where these are not the default ones."""


def generated() -> dict[str, bytes]:
    """Every file that this script writes without --pictures, by its path in this folder."""
    files = {name: make() for name, make in TEXTURES.items()}
    files |= {f"{name}.in": str(make()).encode() for name, make in SCENES.items()}
    return files


def draw_pictures(names: Sequence[str]) -> None:
    """Draw scenes into pictures/, each with nine rays a pixel; all of them if none is named."""
    from converter.images.write import write_image
    from converter.renderers.native import NativeRenderer
    from converter.scene.parser import load_scene
    from converter.scene.settings import Settings

    (FOLDER / "pictures").mkdir(exist_ok=True)
    for name in names or sorted(file.stem for file in FOLDER.glob("*.in")):
        settings = Settings(*PICTURE, samples=9, **OPTIONS.get(name, {}))  # type: ignore[arg-type]
        rendering = NativeRenderer().render(load_scene(FOLDER / f"{name}.in"), settings)
        write_image(FOLDER / "pictures" / f"{name}.png", rendering.pixels, *PICTURE)


def main() -> None:
    """Run the script."""
    parser = argparse.ArgumentParser(
        description="Write the textures and computed scenes, or draw the scenes' pictures."
    )
    parser.add_argument(
        "--pictures", nargs="*", metavar="NAME", help="draw these scenes, or all, and write nothing else"
    )
    pictures = parser.parse_args().pictures
    if pictures is not None:
        draw_pictures(pictures)
        return
    for name, data in generated().items():
        path = FOLDER / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)


if __name__ == "__main__":
    main()
