"""A chart's figures as rows of a table, as CSV and as JSON."""

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from converter.studies.machine import machine, versions
from converter.studies.measure import Measured, SceneStudy
from converter.studies.pareto import pareto_front

STAGES = ("start", "build", "compile", "render", "write")
HEADER = ("", "disagree", "RMS", "", "warm", "least-most", "cold", *STAGES, "first ever")
ALIGN = "lrrlrr" + "r" * 7
LEGEND = (
    "disagree: pixels that differ by more than 1/255; RMS: of all channels; * nothing is both faster and nearer\n"
    "warm: seconds to render once all is loaded and compiled, the median; cold: a whole process, which splits into\n"
    "start to write; first ever: a whole process that has to compile its kernels"
)


def front_names(study: SceneStudy) -> dict[str, set[str]]:
    """For "share" and "rms" the methods that nothing beats in both that error and time."""
    drawn = study.drawn
    errors = {"share": [_share(m) for m in drawn], "rms": [_rms(m) for m in drawn]}
    return {
        name: {drawn[i].method.name for i in pareto_front([(m.warm, e) for m, e in zip(drawn, values, strict=True)])}
        for name, values in errors.items()
    }


def about_reference(study: SceneStudy) -> str:
    """What the errors are measured against, in a sentence."""
    reference = study.reference
    cutoff = reference.settings.cutoff
    told = f"no cut-off, depth {reference.settings.max_depth}" if cutoff == 0 else f"cut-off {cutoff:.2g}"
    told = f"native in {reference.precision}, {told}"
    if reference.left_out is None:
        return f"{told}; kr + kt > 1, so that what it leaves out has no bound"
    lost = reference.left_out
    if lost.largest == 0:
        return f"{told}, which leaves out less weight than float32 shows"
    return f"{told}, which leaves out rays of weight {lost.rms:.1e} (RMS), at most {lost.largest:.1e} in a pixel"


def rows(study: SceneStudy) -> list[tuple[str, ...]]:
    """A row for every method that was drawn, under `HEADER`."""
    fronts = front_names(study)
    return [_row(m, fronts) for m in study.drawn]


def _row(m: Measured, fronts: dict[str, set[str]]) -> tuple[str, ...]:
    assert m.difference is not None
    name = m.method.name
    stars = ("*" if name in fronts["share"] else " ") + ("*" if name in fronts["rms"] else " ")
    stages = m.stages
    return (
        name,
        str(m.difference.disagreeing),
        f"{m.difference.rms:.1e}" if m.difference.rms else "0",
        stars,
        _seconds(m.warm),
        f"{_seconds(min(m.seconds))}-{_seconds(max(m.seconds))}",
        _seconds(m.cold.whole) if m.cold else "",
        *(_seconds(stages.get(stage)) for stage in STAGES),
        _seconds(m.bare.whole) if m.bare else "",
    )


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
    """Every figure of a method on a scene, by name."""
    fronts = front_names(study)
    found, floor = m.difference, study.reference.floor
    ran = m.skipped is None and found is not None
    stages = m.stages if ran else {}
    settings = m.method.settings(study.settings)
    return {
        "scene": str(study.file),
        "width": study.settings.width,
        "height": study.settings.height,
        "method": m.method.name,
        "renderer": m.method.family,
        "cutoff": settings.cutoff,
        "max_depth": settings.max_depth,
        "threads": settings.threads,
        "skipped": m.skipped,
        "disagreeing": found.disagreeing if ran else None,
        "disagreeing_share": _share(m) if ran else None,
        "rms": _rms(m) if ran else None,
        "mean": found.mean if ran else None,
        "largest": found.largest.difference if ran else None,
        "floor_disagreeing": floor.disagreeing,
        "floor_rms": floor.rms,
        "front_share": m.method.name in fronts["share"] if ran else None,
        "front_rms": m.method.name in fronts["rms"] if ran else None,
        "runs": len(m.runs) if ran else None,
        "warm": m.warm if ran else None,
        "warm_least": min(m.seconds) if ran else None,
        "warm_most": max(m.seconds) if ran else None,
        "cold": m.cold.whole if ran and m.cold else None,
        **{f"cold_{stage}": stages.get(stage) for stage in STAGES},
        "first_ever": m.bare.whole if ran and m.bare else None,
        "first_ever_render": m.bare.stages["render"] if ran and m.bare else None,
    }


def to_json(studies: Sequence[SceneStudy]) -> dict[str, Any]:
    """Every figure, every run, and what they come from."""
    return {
        "machine": machine(),
        "versions": versions(),
        "scenes": [
            {
                "scene": str(study.file),
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


def _share(m: Measured) -> float:
    assert m.difference is not None
    return m.difference.disagreeing / m.difference.pixels


def _rms(m: Measured) -> float:
    assert m.difference is not None
    return m.difference.rms
