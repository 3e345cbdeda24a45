"""A chart's figures as rows of a table, as CSV and as JSON."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from converter.files import shown_name
from converter.studies.machine import machine, versions
from converter.studies.measure import Measured, SceneStudy
from converter.studies.pareto import pareto_front

STAGES = ("start", "build", "compile", "render", "write")
ERROR_HEADER = ("", "disagree", "", "RMS", "", "warm", "least", "most", "runs")
ERROR_ALIGN = "lrlrlrrrr"
ERROR_LEGEND = (
    "disagree: pixels that differ by more than 1/255; RMS: of the channels' differences, where white is 1\n"
    "warm: seconds to render, once all is loaded and compiled, the median; *: no method is both faster and nearer"
)
CERTIFIED_HEADER = ("", "wrong", *ERROR_HEADER[2:])
CERTIFIED_LEGEND = (
    "wrong: pixels whose bytes are not those that are proven" + ERROR_LEGEND[ERROR_LEGEND.index("; RMS") :]
)
PROCESS_HEADER = ("", "whole", *STAGES, "first ever")
PROCESS_ALIGN = "lrrrrrrr"
PROCESS_LEGEND = (
    "start: the interpreter and the libraries; compile: what it renders longer than a warm one, to fetch its kernels\n"
    "first ever: a process that has to compile its kernels, for nobody has drawn such a scene here before"
)


def front_names(study: SceneStudy) -> dict[str, set[str]]:
    """For "share" and "rms" the methods that nothing beats in both that error and time."""
    drawn = study.drawn
    errors = {"share": [study.share(m) for m in drawn], "rms": [_rms(m) for m in drawn]}
    return {
        name: {drawn[i].method.name for i in pareto_front([(m.warm, e) for m, e in zip(drawn, values, strict=True)])}
        for name, values in errors.items()
    }


def about_reference(study: SceneStudy) -> str:
    """What the errors are measured against, in a sentence."""
    reference = study.reference
    cutoff = reference.settings.cutoff
    told = f"native in {reference.precision}, {'no cut-off' if cutoff == 0 else f'cut-off {cutoff:.2g}'}, "
    told += f"depth {reference.settings.max_depth}; "
    if reference.left_out is None:
        return f"{told}what it leaves out has no bound, for kr + kt > 1"
    lost = reference.left_out
    if lost.largest == 0:
        return f"{told}what it leaves out is less than float32 shows"
    return f"{told}what it leaves out weighs {lost.rms:.1e} (RMS), at most {lost.largest:.1e} in a pixel"


def left_out_methods(study: SceneStudy) -> list[str]:
    """A line for every reason for which methods have no figures."""
    reasons: dict[str, list[str]] = {}
    for m in study.measured:
        if m.skipped is not None:
            reasons.setdefault(m.skipped, []).append(m.method.name)
    return [f"left out: {', '.join(names)}: {reason}" for reason, names in reasons.items()]


def error_rows(study: SceneStudy) -> list[tuple[str, ...]]:
    """A row for every method that was drawn, under `error_header`."""
    fronts = front_names(study)
    return [_error_row(m, fronts) for m in study.drawn]


def error_header(study: SceneStudy) -> tuple[str, ...]:
    """Their header."""
    return ERROR_HEADER if study.certified is None else CERTIFIED_HEADER


def error_legend(study: SceneStudy) -> str:
    """What it means."""
    return ERROR_LEGEND if study.certified is None else CERTIFIED_LEGEND


def _error_row(m: Measured, fronts: dict[str, set[str]]) -> tuple[str, ...]:
    assert m.difference is not None
    name, found = m.method.name, m.difference
    share, rms = ("*" if name in fronts[error] else "" for error in ("share", "rms"))
    seconds = map(_seconds, (m.warm, min(m.seconds), max(m.seconds)))
    wrong = found.disagreeing if m.missed is None else m.missed
    return (name, str(wrong), share, figure(found.rms), rms, *seconds, str(len(m.runs)))


def process_rows(study: SceneStudy) -> list[tuple[str, ...]]:
    """A row for every method that was drawn, under `PROCESS_HEADER`."""
    return [
        (
            m.method.name,
            _seconds(m.cold.whole if m.cold else None),
            *(_seconds(m.stages.get(stage)) for stage in STAGES),
            _seconds(m.bare.whole if m.bare else None),
        )
        for m in study.drawn
    ]


def figure(value: float) -> str:
    """An error, short."""
    return f"{value:.1e}" if value else "0"


def _seconds(value: float | None) -> str:
    if value is None:
        return ""
    return f"{value:.3f}" if value < 9.9995 else f"{value:.1f}"


def to_csv(studies: Sequence[SceneStudy]) -> str:
    """A line for every method on every scene; what it has no figure for is empty."""
    text = io.StringIO()
    records = [_record(study, m) for study in studies for m in study.measured]
    writer = csv.DictWriter(text, list(records[0]) if records else [], lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    return text.getvalue()


def _record(study: SceneStudy, m: Measured) -> dict[str, Any]:
    """Every figure of a method on a scene, by name; of a skipped one the figures are None."""
    settings, floor = m.method.settings(study.settings), study.reference.floor
    return {
        "scene": shown_name(study.file),
        "width": settings.width,
        "height": settings.height,
        "method": m.method.name,
        "renderer": m.method.family,
        "cutoff": settings.cutoff,
        "max_depth": settings.max_depth,
        "threads": settings.threads,
        "skipped": m.skipped,
        "floor_disagreeing": floor.disagreeing,
        "floor_rms": floor.rms,
        **(dict.fromkeys(_FIGURES) if m.skipped is not None else _figures(study, m)),
    }


_FIGURES = (
    *("disagreeing", "disagreeing_share", "rms", "mean", "largest", "front_share", "front_rms"),
    *("certified", "certified_wrong"),
    *("runs", "warm", "warm_least", "warm_most", "cold"),
    *(f"cold_{stage}" for stage in STAGES),
    *("first_ever", "first_ever_render"),
)


def _figures(study: SceneStudy, m: Measured) -> dict[str, Any]:
    assert m.difference is not None
    fronts, stages, found = front_names(study), m.stages, m.difference
    values = (
        *(found.disagreeing, found.disagreeing / found.pixels, found.rms, found.mean, found.largest.difference),
        *(m.method.name in fronts["share"], m.method.name in fronts["rms"]),
        *(study.certified, m.missed),
        *(len(m.runs), m.warm, min(m.seconds), max(m.seconds), m.cold.whole if m.cold else None),
        *(stages.get(stage) for stage in STAGES),
        *((m.bare.whole, m.bare.stages["render"]) if m.bare else (None, None)),
    )
    return dict(zip(_FIGURES, values, strict=True))


def to_json(studies: Sequence[SceneStudy]) -> dict[str, Any]:
    """Every figure, every run, and what they come from."""
    return {
        "machine": machine(),
        "versions": versions(),
        "scenes": [
            {
                "scene": shown_name(study.file),
                "settings": asdict(study.settings),
                "reference": {
                    "precision": study.reference.precision,
                    "settings": asdict(study.reference.settings),
                    "seconds": study.reference.seconds,
                    "left_out": asdict(study.reference.left_out) if study.reference.left_out else None,
                },
                "floor": asdict(study.reference.floor),
                "methods": [_full_record(study, m) for m in study.measured],
            }
            for study in studies
        ],
    }


def _full_record(study: SceneStudy, m: Measured) -> dict[str, Any]:
    return {
        **_record(study, m),
        "use": m.method.use,
        "options": m.method.options,
        "changes": m.method.changes,
        "difference": asdict(m.difference) if m.difference else None,
        "first_here": m.first,
        "all_runs": m.runs,
        "cold_told": m.cold.stages if m.cold else None,
        "first_ever_told": m.bare.stages if m.bare else None,
        "statistics": m.statistics,
    }


def _rms(m: Measured) -> float:
    assert m.difference is not None
    return m.difference.rms
