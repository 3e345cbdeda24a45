"""Tables on stdout: by rich on a terminal, in plain columns where a program or a file reads them."""

import sys
from collections.abc import Sequence


def print_table(rows: Sequence[Sequence[str]], header: Sequence[str] = (), align: str = "", title: str = "") -> None:
    """Print a table.

    Args:
        rows: cells, as many in each row.
        header: the columns' names, if they need any.
        align: a letter for each column, `l` or `r`; further columns are `l`.
        title: a line above it.

    """
    if not rows:
        return
    align = align.ljust(max(map(len, rows)), "l")
    if sys.stdout is not None and sys.stdout.isatty():
        _print_rich(rows, header, align, title)
    else:
        _print_plain(rows, header, align, title)


def _print_plain(rows: Sequence[Sequence[str]], header: Sequence[str], align: str, title: str) -> None:
    lines = [header, *rows] if header else list(rows)
    widths = [max(len(cell) for cell in column) for column in zip(*lines, strict=True)]
    if title:
        print(title)
    for line in lines:
        cells = (
            cell.rjust(width) if side == "r" else cell.ljust(width)
            for cell, width, side in zip(line, widths, align, strict=True)
        )
        print("  ".join(cells).rstrip())


def _print_rich(rows: Sequence[Sequence[str]], header: Sequence[str], align: str, title: str) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD if header else None, show_header=bool(header), show_edge=False, pad_edge=False)
    for k, side in enumerate(align):
        table.add_column(header[k] if header else "", justify="right" if side == "r" else "left", overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))  # as text: a cell's [brackets] are no markup
    console = Console()
    if title:
        console.print(Text(title, style="bold"))
    console.print(table)
