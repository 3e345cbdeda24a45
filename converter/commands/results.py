"""Arguments that say where a result goes. One of them may be the standard output: `-`, /dev/stdout, /dev/fd/1."""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from converter.commands.exits import UsageError
from converter.descriptors import STANDARD_OUTPUT, is_standard_output, standard_output_for_a_result


class Result(argparse.Action):
    """An argument that keeps the path of a result, for `-` that of the standard output.

    Of one that goes there its name and whether it is text are noted in `to_stdout` of the namespace, for
    `standard_output_shared`.
    """

    is_text = False

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, values: Any, option: str | None = None
    ) -> None:
        """Keep it."""
        path = STANDARD_OUTPUT if values == "-" else Path(values)
        taken = {**getattr(namespace, "to_stdout", {})}
        taken.pop(self.dest, None)
        if is_standard_output(path):
            taken[self.dest] = (option or str(self.metavar), self.is_text)
            if self.is_text:
                path = STANDARD_OUTPUT
        namespace.to_stdout = taken
        setattr(namespace, self.dest, path)


class TextResult(Result):
    """A result that is printed on the standard output in place of the table; its path is `STANDARD_OUTPUT` then."""

    is_text = True


@contextmanager
def standard_output_shared(arguments: argparse.Namespace) -> Iterator[None]:
    """Within it, what is printed goes to stderr if the standard output takes a picture.

    Raises:
        UsageError: it is to take two results.

    """
    taken = list(getattr(arguments, "to_stdout", {}).values())
    if len(taken) > 1:
        raise UsageError(f"{' and '.join(name for name, _ in taken)}: only one result can go to the standard output")
    if all(is_text for _, is_text in taken):
        yield
    else:
        with standard_output_for_a_result():
            yield


def chart_ending(out: Path) -> str:
    """The ending that says what kind of file a chart is: its name's, `.svg` for a pipe or the like that has none.

    Raises:
        UsageError: it is the name of something else.

    """
    from converter.files import is_special
    from converter.studies.chart_figure import ENDINGS

    ending = out.suffix.lower() or (".svg" if is_special(out) else "")
    if ending not in ENDINGS:
        raise UsageError(f"argument -o/--out: must end in {' or '.join(ENDINGS)}, found {str(out)!r}")
    return ending
