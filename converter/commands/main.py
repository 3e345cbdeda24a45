"""`whitted`, the program with the sub-commands. Imports only the one that is asked for."""

import sys
from collections.abc import Sequence

COMMANDS = {
    "render": "draw a scene into an image file",
    "animate": "draw a film of a scene whose numbers change with time",
    "convert": "write a scene as files that Mitsuba 3 or POV-Ray loads",
    "compare": "draw a scene by two methods, or take two images, and tell the differences",
    "certify": "prove each pixel, or say why not, and name those that methods get wrong",
    "why": "name the mistakes that lead from a scene to a picture",
    "grade": "run programs of students on scenes, and name their mistakes",
    "serve": "open a page for writing a scene beside its picture",
    "inspect": "say what a scene file holds and what it needs",
    "pixel": "show the rays behind one pixel, by two methods",
    "methods": "list the methods, and when to use each",
    "chart": "draw the error of every method against its time",
    "stability": "find where each method fails",
    "doctor": "say what works on this machine, and what to install where something does not",
}
"""Every sub-command, a module of this package with `parser() -> Parser` and `run(arguments) -> int`."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run `whitted` with these arguments, the process's own by default; return its exit status."""
    from converter.commands.exits import run
    from converter.commands.garbage import collect_seldom

    if argv is None:
        collect_seldom()
    words = list(sys.argv[1:] if argv is None else argv)
    name = words[0] if words else ""
    return run(f"whitted {name}" if name in COMMANDS else "whitted", lambda: _dispatch(words))


def _dispatch(words: list[str]) -> int:
    from converter.commands.exits import OK, USAGE, UsageError, tell

    match words:
        case []:
            tell(_help())
            return USAGE
        case ["-h" | "--help" | "help"]:
            print(_help())
            return OK
        case ["--version" | "-V"]:
            from converter.commands.version import version

            print(f"whitted {version()}")
            return OK
        case ["help", name]:
            return _dispatch([name, "--help"])
        case [name, *_] if name not in COMMANDS:
            from converter.scene.errors import did_you_mean

            raise UsageError(f"there is no command {name!r}{did_you_mean(name, tuple(COMMANDS))}")
    from importlib import import_module

    from converter.commands.options import given_options
    from converter.commands.results import standard_output_shared

    command = import_module(f"converter.commands.{words[0]}")
    arguments = command.parser().parse_intermixed_args(words[1:])
    arguments.given = given_options(words[1:])
    with standard_output_shared(arguments):
        return int(command.run(arguments))


def _help() -> str:
    listed = "\n".join(f"  {name:11}{summary}" for name, summary in COMMANDS.items())
    return f"""usage: whitted COMMAND ...

Draws the course's ray tracing scenes with Mitsuba 3 and with a native tracer, and checks one against the other.

commands:
{listed}

options:
  -h, --help     show this text; after a command, that command's options
  -V, --version  show the version

example:
  whitted render scene.in picture.png 800 600"""


if __name__ == "__main__":
    sys.exit(main())
