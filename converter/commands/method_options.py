"""Which method draws, as the arguments say."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

from converter.commands.exits import UsageError
from converter.commands.options import settings_from

if TYPE_CHECKING:
    from converter.renderers.base import Renderer
    from converter.renderers.methods import Method
    from converter.scene.settings import Settings


METHOD, REFERENCE = "mitsuba", "native"
"""What draws, and what is trusted, where nobody says so."""


class Chosen(NamedTuple):
    """A method, made: its renderer, and the settings that it draws with."""

    name: str
    renderer: "Renderer"
    settings: "Settings"


def method_named(text: str) -> "Method":
    """The method of that name, as an argument's type."""
    from converter.renderers.methods import find_method

    try:
        return find_method(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def add_method_options(
    parser: argparse.ArgumentParser, reference: str | None = None, method: str = "what draws"
) -> None:
    """`--method` and `--variant`, and `--reference` where there is a picture to compare with; with their help."""
    group = parser.add_argument_group("the method; `whitted methods` lists them")
    group.add_argument("--method", type=method_named, default=METHOD, metavar="NAME", help=f"{method} (%(default)s)")
    if reference is not None:
        group.add_argument(
            "--reference", type=method_named, default=REFERENCE, metavar="NAME", help=f"{reference} (%(default)s)"
        )
    add_variant(group)


def method_words(reference: "Method", method: "Method", variant: str | None) -> list[str]:
    """The options of `add_method_options` that ask for these."""
    words = [] if variant is None else ["--variant", variant]
    for option, asked, usual in (("--method", method, METHOD), ("--reference", reference, REFERENCE)):
        if asked.name != usual:
            words = [option, asked.name, *words]
    return words


@contextmanager
def native_instead(name: str, instead: str = "--method native") -> Iterator[None]:
    """Within it, a method of Mitsuba that does not run here is told with an option `instead` that does without.

    Raises:
        RendererUnavailable: as within it, with more to say.

    """
    from converter.renderers.base import EffectUnavailable, RendererUnavailable
    from converter.renderers.methods import METHODS, find_method

    try:
        yield
    except EffectUnavailable:
        raise
    except RendererUnavailable as error:
        if find_method(name).family != "mitsuba" or METHODS[REFERENCE].missing() is not None:
            raise
        raise RendererUnavailable(f"{error}\n{instead} draws without Mitsuba") from error


def add_variant(group: argparse._ArgumentGroup, default: str = "auto: a GPU if any") -> None:
    """`--variant`."""
    group.add_argument(
        "--variant", choices=("auto", "llvm_ad_rgb", "cuda_ad_rgb"), help=f"what Mitsuba runs on ({default})"
    )


def check_variant(arguments: argparse.Namespace, methods: "list[Method]") -> None:
    """Refuse a `--variant` that none of the methods obeys.

    Raises:
        UsageError: it is given, and none does.

    """
    if arguments.variant is None or any(m.family == "mitsuba" and "variant" not in m.options for m in methods):
        return
    if any(m.family == "mitsuba" for m in methods):
        raise UsageError(f"--variant: the method {methods[0].name} has its own")
    draw = "draws" if len(methods) == 1 else "draw"
    raise UsageError(f"--variant is for Mitsuba, and {' and '.join(m.name for m in methods)} {draw}")


def choose(method: "Method", arguments: argparse.Namespace) -> Chosen:
    """The method with the settings that the arguments ask for.

    Raises:
        UsageError: an argument asks for a setting that is part of the method.

    """
    for setting in method.changes:
        if getattr(arguments, setting, None) is not None:
            raise UsageError(f"--{setting.replace('_', '-')}: the method {method.name} has its own")
    return Chosen(method.name, method.renderer(arguments.variant), method.settings(settings_from(arguments)))
