"""`--crop` and `--rows`: a part of a picture is drawn, as it is in the whole."""

import argparse
from dataclasses import replace

from converter.commands.exits import UsageError
from converter.commands.options import whole
from converter.scene.settings import MAX_SIZE, Crop, Settings


def add_part_options(parser: argparse.ArgumentParser) -> None:
    """`--crop` and `--rows`."""
    group = parser.add_argument_group(
        "a part of the picture, with the pixels of the whole"
    ).add_mutually_exclusive_group()
    group.add_argument(
        "--crop",
        type=_crop,
        metavar="X0,Y0,X1,Y1",
        help="draw columns X0 to X1 and rows Y0 to Y1, without X1 and Y1, counted from the top left corner",
    )
    group.add_argument("--rows", type=_rows, metavar="A:B", help="draw rows A to B, without B; either may be left out")


def with_part(settings: Settings, arguments: argparse.Namespace) -> Settings:
    """The settings with the part that the arguments ask for, if they do.

    Raises:
        UsageError: it is none of the picture.

    """
    if arguments.crop is not None:
        option, part = "--crop", arguments.crop
        found, wanted = ",".join(map(str, part)), "X0 < X1 and Y0 < Y1 within"
    elif arguments.rows is not None:
        first, end = arguments.rows
        option, part = "--rows", (0, first, settings.width, settings.height if end is None else end)
        found, wanted = f"{part[1]}:{part[3]}", "A < B within"
    else:
        return settings
    left, top, right, bottom = part
    if not (left < right <= settings.width and top < bottom <= settings.height):
        size = f"{settings.width} x {settings.height}"
        raise UsageError(f"{option}: a part has {wanted} a picture of {size} pixels, found {found}")
    return replace(settings, crop=part)


def _crop(text: str) -> Crop:
    parts = text.split(",")
    if len(parts) != 4:
        raise argparse.ArgumentTypeError(f"must be four numbers with commas between them, found {text!r}")
    left, top, right, bottom = (whole(part, 0, MAX_SIZE) for part in parts)
    return (left, top, right, bottom)


def _rows(text: str) -> tuple[int, int | None]:
    first, colon, end = text.partition(":")
    if not colon:
        raise argparse.ArgumentTypeError(f"must be FIRST:END, such as 0:100, found {text!r}")
    return whole(first or "0", 0, MAX_SIZE), whole(end, 0, MAX_SIZE) if end else None
