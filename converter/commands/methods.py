"""`whitted methods`: what `--method` can be, and when to use which."""

import argparse
from itertools import groupby

from converter.commands.exits import OK
from converter.commands.options import Parser
from converter.commands.results import TextResult
from converter.commands.tables import print_table
from converter.descriptors import STANDARD_OUTPUT


def parser() -> Parser:
    """The command's arguments."""
    result = Parser(
        "whitted methods",
        "[options]",
        "Lists the methods by which a scene can be drawn, and when to use each. One that cannot run on this machine\n"
        "has a dash before it, and why behind it.",
        "whitted methods",
    )
    result.add_argument(
        "--json",
        action=TextResult,
        metavar="FILE",
        help="write them as JSON; - is the standard output, without the list",
    )
    return result


def run(arguments: argparse.Namespace) -> int:
    """List them."""
    from converter.commands.json_out import check_json, write_json
    from converter.renderers.methods import METHODS

    check_json(arguments.json)
    missing = {name: method.missing() for name, method in METHODS.items()}
    if arguments.json != STANDARD_OUTPUT:
        width = max(map(len, METHODS))
        for group, methods in groupby(METHODS.values(), lambda method: method.group):
            rows = []
            for method in methods:
                reason = missing[method.name]
                mark, note = ("-", f"; not here: {reason}") if reason else (" ", "")
                rows.append((mark, method.name.ljust(width), method.use + note))
            print_table(rows, title=group)
            print()
        print("whitted render SCENE OUT --method NAME draws by one; whitted chart SCENE -o chart.svg compares them.")
    listed = [
        {
            "name": method.name,
            "group": method.group,
            "use": method.use,
            "renderer": method.family,
            "options": method.options,
            "settings": method.changes,
            "missing": missing[method.name],
        }
        for method in METHODS.values()
    ]
    write_json(arguments.json, listed)
    return OK
