"""`--workers` and `--scheduler`: who draws, if not this process."""

import argparse

from converter.commands.exits import UsageError
from converter.commands.options import whole

MOST_WORKERS = 1024


def add_cluster_options(parser: argparse.ArgumentParser) -> None:
    """Both."""
    group = parser.add_argument_group("who draws, if not this process alone; docs/cluster.md")
    group.add_argument("--workers", type=_workers, metavar="N", help="so many processes on this machine")
    group.add_argument(
        "--scheduler", metavar="ADDRESS", help="the workers of a Dask scheduler, such as tcp://10.0.0.1:8786"
    )


def check_cluster_options(arguments: argparse.Namespace) -> None:
    """Refuse both at once.

    Raises:
        UsageError: they are.

    """
    if arguments.workers is not None and arguments.scheduler is not None:
        raise UsageError("--workers and --scheduler: the scheduler has its own workers")


def wants_cluster(arguments: argparse.Namespace) -> bool:
    """Whether others draw."""
    return arguments.workers is not None or arguments.scheduler is not None


def _workers(text: str) -> int:
    return whole(text, 1, MOST_WORKERS)
