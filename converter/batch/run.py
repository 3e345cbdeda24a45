"""Pictures drawn one after the other here, or by others."""

import argparse
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import NamedTuple

from converter.batch.pictures import Drawn, Job, Picture, draw_picture
from converter.renderers.base import Progress


class Wanted(NamedTuple):
    """A picture to be drawn, with a number that its result has, too."""

    number: int
    job: Job
    picture: Picture = Picture()


Result = tuple[int, Drawn | Exception]
"""A picture's number, and what became of it."""


@contextmanager
def draw_pictures(
    arguments: argparse.Namespace, wanted: Iterable[Wanted], count: int, progress: Progress
) -> Iterator[Iterator[Result]]:
    """The pictures, `count` of them, in the order in which they are finished, drawn by whom `--workers` and
    `--scheduler` say. They are asked for one by one, not long before they are drawn.

    `progress` is told what share of them is finished.
    """
    from converter.commands.cluster_options import wants_cluster

    if not wants_cluster(arguments):
        yield _drawn_here(wanted, count, progress)
        return
    from converter.batch.cluster import cluster, drawn_by

    with cluster(arguments.workers, arguments.scheduler, arguments.quiet) as found:
        yield drawn_by(found, wanted, count, progress)


def _drawn_here(wanted: Iterable[Wanted], count: int, progress: Progress) -> Iterator[Result]:
    for k, (number, job, picture) in enumerate(wanted):

        def told(share: float, k: int = k) -> None:
            progress((k + share) / count)

        try:
            result: Drawn | Exception = draw_picture(job, picture, told)
        except Exception as error:
            result = error
        told(1)
        yield number, result
