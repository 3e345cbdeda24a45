"""`whitted pixel`: every ray behind one pixel, in both renderers, and where they first differ."""

import argparse
from array import array
from pathlib import Path
from typing import TYPE_CHECKING, Any

from converter.commands.exits import OK, UsageError
from converter.commands.method_options import add_method_options, check_variant, choose, native_instead
from converter.commands.options import Parser, add_reading_options, add_size, position, settings_from
from converter.commands.results import TextResult
from converter.descriptors import STANDARD_OUTPUT

if TYPE_CHECKING:
    from converter.compare.ray_listing import Line
    from converter.compare.rays import Pair
    from converter.scene.model import Scene


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted pixel",
        "SCENE X Y [WIDTH HEIGHT] [options]",
        "Lists the rays behind a pixel by two methods: what each hits, which lights reach it, what follows it.\n"
        "Where they differ there is a line for each; > marks the first difference, told in full at the end.",
        "whitted pixel figure1.in 400 300\n  whitted pixel figure1.in 400 300 --method native",
    )
    result.add_argument("scene", type=Path, metavar="SCENE", help="the scene file")
    result.add_argument("x", type=position, metavar="X", help="the pixel's column, 0 is the leftmost")
    result.add_argument("y", type=position, metavar="Y", help="the pixel's row, 0 is the top one")
    add_size(result)
    group = result.add_argument_group("what is told")
    group.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write the ray trees; - is the standard output, without the list",
    )
    group.add_argument("-q", "--quiet", action="store_true", help="no notes")
    add_reading_options(result)
    add_method_options(result, "what the rays to be trusted are traced by; the same as --method: only this one")
    return result


def run(arguments: argparse.Namespace) -> int:
    """Trace the pixel, and tell."""
    settings = settings_from(arguments)
    x, y = arguments.x, arguments.y
    if x >= settings.width or y >= settings.height:
        raise UsageError(f"pixel ({x}, {y}) lies outside the picture of {settings.width} x {settings.height} pixels")
    methods = list(dict.fromkeys((arguments.reference, arguments.method)))
    check_variant(arguments, methods)
    chosen = [choose(method, arguments) for method in methods]
    tracers: dict[str, Any] = {c.name: getattr(c.renderer, "trace_pixel", None) for c in chosen}
    for name, tracer in tracers.items():
        if tracer is None:
            raise UsageError(f"{name} does not tell its rays")

    from converter.commands.json_out import check_json, write_json
    from converter.commands.notes import load_with_notices

    check_json(arguments.json, [arguments.scene])
    scene = load_with_notices(arguments.scene, settings, arguments.quiet)
    traced: dict[str, dict[str, Any]] = {}
    for name, _, changed in chosen:
        with native_instead(name):
            traced[name] = tracers[name](scene, changed, x, y)
    if arguments.json != STANDARD_OUTPUT:
        print(f"{arguments.scene} at {settings.width} x {settings.height}, pixel ({x}, {y}): {' | '.join(traced)}\n")
        _list(scene, traced)
    write_json(arguments.json, traced)
    return OK


def _list(scene: "Scene", traced: dict[str, dict[str, Any]]) -> None:
    from converter.compare.ray_listing import list_rays
    from converter.compare.rays import first_unequal, pair_trees
    from native_tracer import quantize

    names, trees = list(traced), [tree["rays"] for tree in traced.values()]
    pairs = pair_trees(trees[0], trees[-1])
    first = first_unequal(pairs)
    letters = (names[0][0], names[-1][0])
    for line in list_rays(pairs, scene, letters if letters[0] != letters[1] else ("1", "2"), first):
        _print_line(line)
    print()
    width = max(map(len, names))
    for name, tree in traced.items():
        color = tree["color"]
        quantized = quantize(array("f", color))
        levels = " ".join(
            f"{b:3}" if channel == channel else "NaN" for b, channel in zip(quantized, color, strict=True)
        )
        print(f"colour  {name:{width}}  {'  '.join(f'{channel:.8f}' for channel in color)}   of 255: {levels}")
    if len(names) == 2:
        _print_difference(first, scene, names)


def _print_difference(first: "Pair | None", scene: "Scene", names: list[str]) -> None:
    from converter.commands.tables import print_table
    from converter.compare.ray_listing import object_name, shown

    print()
    if first is None:
        print("no difference")
        return
    rows = []
    for unequal in first.unequal:
        values = [unequal.reference, unequal.test]
        if unequal.what == "object hit" or unequal.what.endswith("shadowed by"):
            values = ["nothing" if value is None else object_name(scene, value) for value in values]
        rows.append((unequal.what, *map(shown, values)))
    ray = first.either
    title = f"first difference: the {ray['kind']} ray at depth {ray['depth']} of weight {ray['weight']:.3g}"
    print_table(rows, ("", *names), title=title)


def _print_line(line: "Line") -> None:
    """By rich on a terminal, where lines on which the renderers differ are coloured."""
    import sys

    if sys.stdout is None or not sys.stdout.isatty():
        print(line.text)
        return
    from rich.console import Console
    from rich.text import Text

    style = {"both": "", "reference": "green", "test": "red"}[line.side] + (" bold" if line.first else "")
    Console(soft_wrap=True).print(Text(line.text, style=style.strip()))
