"""The stability study as a table, as Markdown and as JSON."""

import re
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from converter.studies.machine import machine, versions
from converter.studies.stability import FEW, FamilyStudy, Outcome

LEGEND = (
    "the last value that holds, from the easy ones on: no pixel (of those that may not) is off by more than 1/255\n"
    "all: every value of the family; none: not even the easiest; a ... b: where both small and large values are hard"
)


def table_header(studies: Sequence[FamilyStudy]) -> tuple[str, ...]:
    """The names of the methods, after the families'."""
    return ("", *studies[0].outcomes) if studies else ("",)


def table_rows(studies: Sequence[FamilyStudy]) -> list[tuple[str, ...]]:
    """A row for every family: up to where each method holds."""
    return [(study.family.name, *(limit(study, method) for method in study.outcomes)) for study in studies]


def limit(study: FamilyStudy, method: str) -> str:
    """Up to where a method holds: "all", "none", "1e-06", or "1e-06 ... 1e+04"."""
    outcomes = study.outcomes[method]
    if not outcomes:
        return ""
    held = study.held(method)
    if held is None:
        return "none"
    if held == (outcomes[0].value, outcomes[-1].value):
        return "all"
    return f"{number(held[0])} ... {number(held[1])}" if study.family.both_ways else number(held[1])


def number(value: float) -> str:
    """A stressed number: short, but no two of a family alike."""
    return f"{value:.2g}" if value < 100 or value >= 1e4 else f"{value:.7g}"


def failures(studies: Sequence[FamilyStudy]) -> list[str]:
    """A line for every reason for which pictures are missing; of reasons that differ in numbers the first is told."""
    missing: dict[tuple[str, str], tuple[str, dict[str, list[str]]]] = {}

    def add(family: str, reason: str, method: str, value: float) -> None:
        _, values = missing.setdefault((family, re.sub(r"[-+.e\d]+", "#", reason)), (reason, {}))
        values.setdefault(method, []).append(number(value))

    for study in studies:
        for value, reason in study.broken.items():
            add(study.family.name, f"no truth: {reason}", "all methods", value)
        for method, outcomes in study.outcomes.items():
            for outcome in outcomes:
                if outcome.failure is not None:
                    add(study.family.name, outcome.failure, method, outcome.value)
    lines = []
    for (family, _), (reason, values) in missing.items():
        together: dict[str, list[str]] = {}
        for method, found in values.items():
            together.setdefault(", ".join(found), []).append(method)
        where = "; ".join(f"{', '.join(methods)} at {at}" for at, methods in together.items())
        lines.append(f"no picture: {family}, {where}: {reason}")
    return lines


def silences(studies: Sequence[FamilyStudy]) -> list[str]:
    """What is told of failures that come without a warning: a line for every family and method that has some."""
    found = [
        f"no warning: {study.family.name}, {method} at {', '.join(number(o.value) for o in outcomes if o.silent)}"
        for study in studies
        for method, outcomes in study.outcomes.items()
        if any(outcome.silent for outcome in outcomes)
    ]
    return found or [f"wherever a method gets more than {FEW:.0%} of the pixels wrong, a warning says so beforehand"]


def to_json(studies: Sequence[FamilyStudy]) -> dict[str, Any]:
    """Every figure, and what it comes from."""
    return {
        "machine": machine(),
        "versions": versions(),
        "families": [
            {
                "family": study.family.name,
                "about": study.family.about,
                "stress": study.family.stress,
                "values": study.family.values,
                "both_ways": study.family.both_ways,
                "broken": [{"value": value, "reason": reason} for value, reason in study.broken.items()],
                "methods": [
                    {
                        "method": method,
                        "holds": limit(study, method),
                        "held": study.held(method),
                        "outcomes": [_record(outcome) for outcome in outcomes],
                    }
                    for method, outcomes in study.outcomes.items()
                ],
            }
            for study in studies
        ],
    }


def _record(outcome: Outcome) -> dict[str, Any]:
    return {
        "value": outcome.value,
        "holds": outcome.holds,
        "warned": outcome.warned,
        "share": outcome.share,
        "allowed": outcome.allowed,
        "failure": outcome.failure,
        "difference": asdict(outcome.difference) if outcome.difference else None,
    }
