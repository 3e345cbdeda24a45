"""The stability study as a page: chart, table, a sentence on each family, and what failures look like."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from converter.compare.metrics import Pixels, clamped
from converter.files import replacing
from converter.images.write import write_image
from converter.studies.stability import FamilyStudy, Outcome
from converter.studies.stability_figure import draw_stability
from converter.studies.stability_report import LEGEND, failures, number, table_header, table_rows

PAGE, CHART = "stability.md", "stability.svg"
ENLARGED = 4
"""Dots to a pixel of the pictures."""
SHOWN = (
    ("size", "mitsuba-offset", "shadows and reflections are gone where the offset of rays is as large as the balls"),
    ("position", "native-float", "mirrors and glass show the sky, where coordinates have no digits left for the scene"),
    ("huge", "mitsuba-offset", "the large ball shades itself, for its surface is rounded by more than the offset"),
    ("distance", "mitsuba-ulp", "the ball shades itself in rings, for the hits of a far eye lie below its surface"),
    ("gap", "mitsuba-offset", "light falls into a closed gap, for shadow rays start beyond its roof"),
    ("nearly-coplanar", "mitsuba-mesh", "the lower of two floors is seen, for to Embree they are one"),
    ("checker-boundary", "mitsuba-offset", "cells of the layer below appear, for hits have fallen beneath the floor"),
)
"""Failures that the page shows: a family, a method, and what is to be seen there."""


def write_page(studies: Sequence[FamilyStudy], folder: Path) -> None:
    """Write `PAGE` into a folder, with `CHART` and `stability-FAMILY.png` beside it.

    Raises:
        OSError: they cannot be written.

    """
    with replacing(folder / CHART) as temporary:
        draw_stability(studies, temporary)
    shown = []
    by_name = {study.family.name: study for study in studies}
    for family, method, seen in SHOWN:
        outcome = _failing(by_name.get(family), method)
        if outcome is not None:
            file = f"stability-{family}.png"
            pair = side_by_side(outcome)
            write_image(folder / file, pair, pair.shape[1], pair.shape[0])
            told = f"`{family}` at {number(outcome.value)}, {method}: {seen}."
            shown.append(f"![{family}: the truth and {method}]({file})\n\n{told}")
    with replacing(folder / PAGE) as temporary:
        temporary.write_text(_page(studies, shown), encoding="utf-8")


def _failing(study: FamilyStudy | None, method: str) -> Outcome | None:
    """The picture that shows how a method fails, if it does."""
    outcomes = study.outcomes.get(method, ()) if study is not None else ()
    return next((outcome for outcome in outcomes if outcome.pixels is not None), None)


def side_by_side(outcome: Outcome) -> Pixels:
    """The truth and a picture, enlarged, a white strip between them."""
    assert outcome.pixels is not None
    assert outcome.truth is not None
    both = [clamped(picture.astype(np.float32)) for picture in (outcome.truth, outcome.pixels)]
    large = [np.kron(picture, np.ones((ENLARGED, ENLARGED, 1), np.float32)) for picture in both]
    strip = np.ones((large[0].shape[0], 2 * ENLARGED, 3), np.float32)
    result: Pixels = np.nan_to_num(np.concatenate([large[0], strip, large[1]], axis=1))
    return result


def _page(studies: Sequence[FamilyStudy], shown: Sequence[str]) -> str:
    header = table_header(studies)
    table = [header, ("---",) * len(header), *table_rows(studies)]
    rows = "\n".join("| " + " | ".join(row) + " |" for row in table)
    families = "\n".join(f"| {s.family.name} | {s.family.stress} | {s.family.about} |" for s in studies)
    missing = "\n".join(f"- {line}" for line in failures(studies))
    legend = ". ".join(LEGEND.splitlines())
    return f"""# Where each method fails

Made by `make stability`: every method of the table draws every family's scenes, each of which pushes one number toward
trouble and has a true picture: by a closed form, or by the native tracer in long double. A picture holds if no pixel
differs from the truth by more than 1/255, but for the few that the family allows.

Where `whitted render` and `whitted inspect` see that a scene enters a region in which a method is known to fail, they
say so, and name the method that holds.

## Up to where each holds

{legend[0].upper()}{legend[1:]}.

{rows}

![Share of wrong pixels over the stressed number, a panel a family, a line a method]({CHART})

A cross marks where a method fails first; methods that do the same share a line.

## The families

| family | stressed | about |
| --- | --- | --- |
{families}

## What it looks like

The truth on the left, the method on the right.

{(chr(10) * 2).join(shown)}
""" + (f"\n## Pictures that there are not\n\n{missing}\n" if missing else "")
