"""Arguments that several commands share, defined once, and how they become `Settings`."""

import argparse
import math
import os
import re
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from converter.commands.exits import UsageError
from converter.scene.depth import MAX_DEPTH
from converter.scene.model import Color
from converter.scene.settings import MAX_SAMPLES, MAX_SEED, MAX_SIZE, MOST_THREADS, SAMPLES, Settings

DEFAULTS = Settings()


class _HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Finds the terminal's width by itself: argparse asks `shutil`, which takes longer to import than argparse."""

    def __init__(self, prog: str) -> None:
        try:
            columns = int(os.environ.get("COLUMNS") or os.get_terminal_size().columns)
        except (OSError, ValueError):
            columns = 80
        super().__init__(prog, max_help_position=28, width=max(40, min(columns, 120) - 2))


class Parser(argparse.ArgumentParser):
    """An argument parser that raises `UsageError`, takes no abbreviations, and shows an example."""

    def __init__(self, program: str, usage: str, description: str, example: str) -> None:
        super().__init__(
            prog=program,
            usage="\n       ".join(f"{program} {line}" for line in usage.splitlines()),
            description=description,
            epilog=f"example:\n  {example}",
            formatter_class=_HelpFormatter,
            allow_abbrev=False,
        )
        # argparse takes -1 for a number, and -1,0,2,2 for an option that it does not know.
        self._negative_number_matcher = re.compile(r"-\.?\d")

    def parse_intermixed_args(self, args: Sequence[str] | None = None, namespace: Any = None) -> argparse.Namespace:  # type: ignore[override]
        """Parse words, of which those behind -- are files, be their first letter a hyphen: argparse forgets the --."""
        words = list(sys.argv[1:] if args is None else args)
        if "--" in words:
            k = words.index("--")
            words[k:] = [f"./{word}" if word[:1] == "-" != word else word for word in words[k + 1 :]]
        result: argparse.Namespace = super().parse_intermixed_args(words, namespace)
        return result

    def error(self, message: str) -> NoReturn:
        """Raise `UsageError`."""
        raise UsageError(message)


# ------------------------------------------------------------------------------------------------------------- values


def whole(text: str, least: int, most: int) -> int:
    """The whole number in `text`, from `least` to `most`."""
    try:
        value = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a whole number, found {text!r}") from None
    if not least <= value <= most:
        raise argparse.ArgumentTypeError(f"must lie between {least} and {most}, found {text}")
    return value


def pixels(text: str) -> int:
    """A picture's width or height."""
    return whole(text, 1, MAX_SIZE)


def position(text: str) -> int:
    """A pixel's column or row."""
    return whole(text, 0, MAX_SIZE - 1)


def finite(text: str) -> float:
    """A finite number."""
    try:
        value = float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"must be a number, found {text!r}") from None
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"must be finite, found {text!r}")
    return value


def not_negative(text: str) -> float:
    """A finite number that is not negative."""
    value = finite(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"must not be negative, found {text}")
    return value


def _color(text: str) -> Color:
    parts = text.split(",")
    if len(parts) != 3:
        raise argparse.ArgumentTypeError(f"must be three numbers with commas between them, found {text!r}")
    red, green, blue = map(finite, parts)
    return (red, green, blue)


def _samples(text: str) -> int:
    count = whole(text, 1, MAX_SAMPLES)
    root = math.isqrt(count)
    if root * root != count:
        raise argparse.ArgumentTypeError(
            f"must be a square number such as {root**2} or {(root + 1) ** 2}, found {text}"
        )
    return count


def _depth(text: str) -> int:
    return whole(text, 0, MAX_DEPTH)


def _seed(text: str) -> int:
    return whole(text, 0, MAX_SEED)


def _threads(text: str) -> int:
    return whole(text, 0, MOST_THREADS)


def size(text: str) -> tuple[int, int]:
    """A picture's size, such as 800x600."""
    width, x, height = text.partition("x")
    if not x:
        raise argparse.ArgumentTypeError(f"must be WIDTHxHEIGHT, such as 800x600, found {text!r}")
    return pixels(width), pixels(height)


# ------------------------------------------------------------------------------------------------------------- groups


def add_size(parser: argparse.ArgumentParser, width: int = DEFAULTS.width, height: int = DEFAULTS.height) -> None:
    """WIDTH and HEIGHT, at the end of the line; the help tells what they are where they are not given."""
    parser.add_argument("width", nargs="?", type=pixels, metavar="WIDTH", help=f"columns of the picture ({width})")
    parser.add_argument("height", nargs="?", type=pixels, metavar="HEIGHT", help=f"rows of the picture ({height})")


def add_reading_options(parser: argparse.ArgumentParser, picture: bool = True, bounces: bool = True) -> None:
    """Options that say how a scene is read, without those that matter only to a `picture` of it or its `bounces`."""
    group = parser.add_argument_group("how the scene is read")
    if picture:
        _add_picture_options(group)
    group.add_argument(
        "--ior",
        choices=("auto", "ratio", "index"),
        default=DEFAULTS.ior,
        help="what a finish's ior is: n1/n2, as the statement says, n2/n1, or n2/n1 where it is above 1 (%(default)s)",
    )
    group.add_argument(
        "--background", type=_color, metavar="R,G,B", help="colour of rays that hit nothing (the ambient light's)"
    )
    if bounces:
        _add_bounce_options(group)


def _add_bounce_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--cutoff",
        type=not_negative,
        metavar="W",
        help="drop rays that weigh less, the product of their kr and kt (1/512)",
    )
    group.add_argument(
        "--max-depth",
        type=_depth,
        metavar="N",
        help="follow a ray for at most N bounces (as many as --cutoff asks for, within the limits that inspect tells)",
    )


def _add_picture_options(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        "--pixel",
        choices=("corner", "center"),
        default=DEFAULTS.pixel,
        help="where in a pixel its ray passes: its top-left corner or its centre (%(default)s)",
    )
    group.add_argument(
        "--specular",
        choices=("phong", "blinn"),
        default=DEFAULTS.specular,
        help="highlights by the mirror direction or by the half vector (%(default)s)",
    )
    group.add_argument(
        "--samples",
        type=_samples,
        metavar="N",
        help=f"rays a pixel, a square number (1, and {SAMPLES} where something is random)",
    )


def add_running_options(parser: argparse.ArgumentParser) -> None:
    """Options that say how the machine is used."""
    group = parser.add_argument_group("how it is drawn")
    group.add_argument("--threads", type=_threads, metavar="N", help="worker threads (one a core)")
    group.add_argument(
        "--seed",
        type=_seed,
        default=DEFAULTS.seed,
        metavar="N",
        help="start of the random numbers, in scenes that use any (%(default)s)",
    )


def given_options(words: Sequence[str]) -> frozenset[str]:
    """The long options among a command's words."""
    before = words[: words.index("--")] if "--" in words else words
    return frozenset(word.partition("=")[0] for word in before if word.startswith("--"))


def reading_words(settings: Settings) -> list[str]:
    """The options of `add_reading_options` that ask for `settings`."""
    words = []
    for name in ("pixel", "specular", "samples", "ior", "background", "cutoff", "max_depth"):
        value = getattr(settings, name)
        if value != getattr(DEFAULTS, name):
            option = f"--{name.replace('_', '-')}"
            text = ",".join(map(repr, value)) if isinstance(value, tuple) else str(value)
            words += [f"{option}={text}"] if text.startswith("-") else [option, text]
    return words


def settings_from(arguments: argparse.Namespace) -> Settings:
    """The settings that the arguments ask for; what a command has no argument for keeps its default.

    Raises:
        UsageError: a width without a height.

    """
    given = vars(arguments)
    if (given.get("width") is None) != (given.get("height") is None):
        raise UsageError("a WIDTH needs a HEIGHT after it")
    known = Settings.__match_args__
    return Settings(**{name: value for name, value in given.items() if name in known and value is not None})
