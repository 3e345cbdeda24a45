"""The stability study as a page: chart, table, a sentence on each family, and what failures look like."""

from collections.abc import Sequence
from pathlib import Path

from converter.files import replacing
from converter.studies.stability import LONGEST, FamilyStudy
from converter.studies.stability_figure import draw_stability
from converter.studies.stability_pictures import Failure, draw_failures, failures_to_show
from converter.studies.stability_report import LEGEND, failures, silences, table_header, table_rows

PAGE, CHART, SHEET = "stability.md", "stability.svg", "stability-failures.png"


def write_page(studies: Sequence[FamilyStudy], folder: Path) -> None:
    """Write `PAGE` into a folder, with `CHART` and `SHEET` beside it.

    Raises:
        OSError: they cannot be written.

    """
    with replacing(folder / CHART) as temporary:
        draw_stability(studies, temporary)
    shown = list(failures_to_show(studies))
    if shown:
        with replacing(folder / SHEET) as temporary:
            draw_failures(shown, temporary)
    with replacing(folder / PAGE) as temporary:
        temporary.write_text(_page(studies, shown), encoding="utf-8")


def _page(studies: Sequence[FamilyStudy], shown: Sequence[Failure]) -> str:
    header = table_header(studies)
    table = [header, ("---",) * len(header), *table_rows(studies)]
    rows = "\n".join("| " + " | ".join(row) + " |" for row in table)
    families = "\n".join(f"| {s.family.name} | {s.family.stress} | {s.family.about} |" for s in studies)
    silent = ". ".join(silences(studies))
    legend = ". ".join(LEGEND.splitlines())
    return f"""# Where each method fails

Made by `make stability`: every method of the table draws every family's scenes, each of which pushes one number toward
trouble and has a true picture: by a closed form, by [certificates](certify.md), or, where those prove nothing and of
scenes that are sampled, by the native tracer in long double. A picture holds if no pixel differs from the truth by more
than 1/255, but for the few that the family allows. A method has {LONGEST:g} s of CPU time for a picture; where that is
not enough, it is not asked for harder ones.

Where `whitted render` and `whitted inspect` see that a scene enters a region in which a method is known to fail, they
say so, and name the method that holds; of POV-Ray nobody is warned. The study asks for these warnings, too:
{silent}.

## Up to where each holds

{legend[0].upper()}{legend[1:]}.

{rows}

![Share of wrong pixels over the stressed number, a panel a family, a line a method]({CHART})

A cross marks where a method fails first; methods that do the same share a line, which is drawn as the first of them.

## The families

| family | stressed | about |
| --- | --- | --- |
{families}
""" + "".join(section for section in (_pictures(shown), _missing(studies)) if section)


def _pictures(shown: Sequence[Failure]) -> str:
    if not shown:
        return ""
    rows = "\n".join(f"| {f.family} | {f.at} | {f.method} | {f.seen} |" for f in shown)
    return f"""
## What it looks like

The truth on the left, the method on the right, at the first value at which it fails plainly.

![Pairs of pictures, one for each family in which a method fails]({SHEET})

| family | at | method | what is to be seen |
| --- | --- | --- | --- |
{rows}
"""


def _missing(studies: Sequence[FamilyStudy]) -> str:
    lines = "\n".join(f"- {line}" for line in failures(studies))
    return f"\n## Pictures that there are not\n\n{lines}\n" if lines else ""
