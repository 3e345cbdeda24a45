"""`whitted animate`: a film of a scene whose numbers change with time."""

import argparse
import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from converter.commands.cluster_options import add_cluster_options, check_cluster_options
from converter.commands.exits import OK, UsageError
from converter.commands.method_options import add_method_options, check_variant, choose, native_instead
from converter.commands.options import Parser, add_reading_options, add_running_options, add_size, whole
from converter.commands.parts import add_part_options, with_part
from converter.commands.results import Result
from converter.scene.settings import SAMPLES, Settings

if TYPE_CHECKING:
    from converter.films.script import Script

MOST_FRAMES = 1_000_000
FPS = 24
LEAST_FPS, MOST_FPS = Fraction(1, 1000), 1000


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted animate",
        "SCENE FILM [WIDTH HEIGHT] [options]",
        "Draws a film of a scene whose numbers change with time. The keyframes are in a\n"
        "TOML file beside it: a table for each number, or row of numbers, by its path,\n"
        "such as camera.eye, lights[1].color, objects[3].sphere.radius, or, where a\n"
        "comment at an entry has its name, NAME.sphere.center.",
        "whitted animate scenes/films/orbit.in orbit.mp4 --frames 96\n"
        "  whitted animate orbit.in 'frames/{frame:04}.png' --keys fast.toml --workers 4",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
    result.add_argument(
        "film",
        action=Result,
        metavar="FILM",
        help="a film (.mp4, .webm, .gif, .webp, .png), or pictures, such as 'frames/{frame:04}.png'; "
        "- is the standard output",
    )
    add_size(result)
    group = result.add_argument_group("the film")
    group.add_argument("--frames", type=_frames, metavar="N", help="pictures of it (as many as reach the last key)")
    group.add_argument("--fps", type=_fps, default=Fraction(FPS), metavar="F", help="pictures a second (%(default)s)")
    group.add_argument("--keys", type=Path, metavar="FILE", help="the keyframes (SCENE with the ending .toml)")
    group.add_argument(
        "--format", type=_ending, metavar="NAME", help="mp4, webm, gif, webp or png: whatever FILM ends in"
    )
    group.add_argument(
        "--anew", action="store_true", help="draw all pictures, also those that an earlier start has drawn"
    )
    group.add_argument(
        "--keep-frames", action="store_true", help="leave the pictures of a film in FILM.frames when it is whole"
    )
    group.add_argument("-q", "--quiet", action="store_true", help="no notes, no progress bar, no closing line")
    add_reading_options(result)
    add_part_options(result)
    add_running_options(result)
    add_cluster_options(result)
    add_method_options(result)
    return result


def _frames(text: str) -> int:
    return whole(text, 1, MOST_FRAMES)


def _fps(text: str) -> Fraction:
    try:
        value = Fraction(text)
    except (ValueError, ZeroDivisionError):
        raise argparse.ArgumentTypeError(f"must be a number or a fraction such as 30000/1001, found {text!r}") from None
    if not LEAST_FPS <= value <= MOST_FPS:
        raise argparse.ArgumentTypeError(f"must lie between {float(LEAST_FPS)} and {MOST_FPS}, found {text}")
    return value.limit_denominator(10_000)


def _ending(text: str) -> str:
    return f".{text.lower().removeprefix('.')}"


def run(arguments: argparse.Namespace) -> int:
    """Draw the film."""
    check_variant(arguments, [arguments.method])
    check_cluster_options(arguments)
    method = choose(arguments.method, arguments)
    method = method._replace(settings=with_part(method.settings, arguments))
    if arguments.quiet:
        import logging

        logging.getLogger("mitsuba_plugins").setLevel(logging.ERROR)

    from converter.commands.filming import Filming
    from converter.commands.notes import load_with_notices, say
    from converter.films.script import read_script
    from converter.scene.tokens import decode

    scene = load_with_notices(arguments.scene, method.settings, arguments.quiet, arguments.method)
    keys = arguments.keys or arguments.scene.with_suffix(".toml")
    script = read_script(keys, scene, decode(arguments.scene.read_bytes(), arguments.scene))
    count = arguments.frames or _frames_of(script, arguments.fps)
    method = method._replace(settings=_sampled(method.settings, script))
    filming = Filming(arguments, method, scene, script, keys, count)
    with native_instead(method.name):
        drawn, seconds = filming.run()
    size = "{} x {}".format(*method.settings.drawn_size)
    pictures = "1 picture" if count == 1 else f"{count} pictures"
    kept = "" if drawn == count else f", {count - drawn} of them were there"
    say(f"{arguments.film}: {pictures}{kept}, {size}, {method.name}, {seconds:.2f} s", arguments.quiet)
    return OK


def _frames_of(script: "Script", fps: Fraction) -> int:
    """As many pictures as reach the last key."""
    count = max(1, math.ceil(Fraction(script.seconds) * fps))
    if count > MOST_FRAMES:
        raise UsageError(
            f"the last key is at {script.seconds:g} s, which takes more than {MOST_FRAMES} frames: --frames or --fps "
            "can ask for fewer"
        )
    return count


def _sampled(settings: Settings, script: "Script") -> Settings:
    """The settings, with samples for all pictures of a film in which something is blurred: else those in which nothing
    moves would have one.
    """
    return replace(settings, samples=SAMPLES) if script.blurs and settings.samples is None else settings
