"""What a scene counts, what is tolerated, and the marks that follow."""

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from converter.grade.judge import FEW, Verdict, mistakes
from converter.scene.errors import did_you_mean


class RubricError(ValueError):
    """A rubric cannot be used; the message names the file and says why."""


@dataclass(frozen=True, slots=True)
class Part:
    """What is to be known of a scene: what it counts, what it shows, and what is tolerated in it."""

    points: float = 1.0
    feature: str = ""
    tolerate: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Rubric:
    """How marks are given.

    Attributes:
        parts: of scenes, by name.
        tolerate: mistakes, or other readings, that cost nothing.
        once: whether a mistake costs marks only in the first scene in which it is found.
        partial: the share of its points that a wrong picture is worth at most: if nearly all of it is right.

    """

    parts: Mapping[str, Part] = field(default_factory=dict)
    tolerate: frozenset[str] = frozenset()
    once: bool = True
    partial: float = 0.5

    def part(self, scene: str) -> Part:
        """What is to be known of a scene; one that is not named counts 1, and is a feature of its own."""
        return self.parts.get(scene, Part())

    def feature(self, scene: str) -> str:
        """What a scene shows."""
        return self.part(scene).feature or scene


@dataclass(frozen=True, slots=True)
class Mark:
    """What a scene has brought.

    Attributes:
        points, most: what it has brought, and could have.
        forgiven: mistakes in it that cost nothing: tolerated, or counted in an earlier scene.

    """

    points: float
    most: float
    forgiven: tuple[str, ...] = ()


def marks(rubric: Rubric, scenes: Sequence[str], verdicts: Mapping[str, Verdict | None]) -> dict[str, Mark]:
    """The marks of one student, by scene.

    Where mistakes look the same in a scene, the one that costs least is taken for made.

    Args:
        rubric: how they are given.
        scenes: names, in the order in which a mistake is looked for first.
        verdicts: of the pictures; None: there is none.

    """
    charged: set[str] = set()
    result = {}
    for scene in scenes:
        part, verdict = rubric.part(scene), verdicts.get(scene)
        if verdict is None:
            result[scene] = Mark(0.0, part.points)
            continue
        free = rubric.tolerate | part.tolerate | (charged if rubric.once else set())
        forgiven = [c for c in verdict.causes if free & {c, *verdict.alternatives.get(c, ())}]
        costing = [c for c in verdict.causes if c not in forgiven]
        by_costing = sum(max(verdict.spoiled.get(cause, 0.0), 0.0) for cause in costing)
        wrong = min(verdict.left + by_costing, max(verdict.left, verdict.wrong))
        full = verdict.right or (verdict.causes and not costing and wrong <= FEW)
        share = 1.0 if full else rubric.partial * (1 - wrong)
        result[scene] = Mark(part.points * share, part.points, tuple(forgiven))
        charged |= set(costing)
    return result


def read_rubric(file: Path, scenes: Iterable[str]) -> Rubric:
    """The rubric in a TOML file.

        tolerate = ["pixel_center", "blinn"]    # by the names of `whitted why --list`
        charge = "once"                         # or "always": in each scene
        partial = 0.5

        [scenes.07_shadow]
        points = 2
        feature = "shadows"
        tolerate = ["transparent_casts_none"]

    Raises:
        RubricError: it says something else.
        OSError: it cannot be read.

    """
    try:
        data = tomllib.loads(file.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise RubricError(f"{file}: {error}") from None
    reader = _Reader(file)
    reader.check_keys(data, ("tolerate", "charge", "partial", "scenes"), "")
    charge = data.get("charge", "once")
    if charge not in ("once", "always"):
        reader.refuse(f'charge must be "once" or "always", found {charge!r}')
    partial = reader.number(data, "partial", "", 0.5)
    if partial > 1:
        reader.refuse(f"partial must lie between 0 and 1, found {partial:g}")
    described = data.get("scenes", {})
    if not isinstance(described, dict):
        reader.refuse("scenes must be tables such as [scenes.07_shadow]")
    known = tuple(scenes)
    parts = {}
    for name, part in described.items():
        if name not in known:
            reader.refuse(f"there is no scene {name!r}{did_you_mean(name, known)}")
        if not isinstance(part, dict):
            reader.refuse(f"scenes.{name} must be a table")
        where = f"scenes.{name}: "
        reader.check_keys(part, ("points", "feature", "tolerate"), where)
        feature = part.get("feature", "")
        if not isinstance(feature, str):
            reader.refuse(f"{where}feature must be a text, found {feature!r}")
        parts[name] = Part(reader.number(part, "points", where, 1.0), feature, reader.names(part, where))
    return Rubric(parts, reader.names(data, ""), charge == "once", partial)


@dataclass(frozen=True, slots=True)
class _Reader:
    file: Path

    def refuse(self, why: str) -> None:
        raise RubricError(f"{self.file}: {why}")

    def check_keys(self, data: Mapping[str, Any], known: tuple[str, ...], where: str) -> None:
        for key in data:
            if key not in known:
                self.refuse(f"{where}there is no {key!r} in a rubric{did_you_mean(key, known)}")

    def number(self, data: Mapping[str, Any], key: str, where: str, default: float) -> float:
        value = data.get(key, default)
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < 1e6:
            self.refuse(f"{where}{key} must be a number that is not negative, found {value!r}")
        return float(value)

    def names(self, data: Mapping[str, Any], where: str) -> frozenset[str]:
        found = data.get("tolerate", [])
        known = tuple(mistakes())
        if not isinstance(found, list):
            self.refuse(f"{where}tolerate must be a list of names")
        for name in found:
            if name not in known:
                self.refuse(f"{where}there is no mistake {name!r}{did_you_mean(str(name), known)}")
        return frozenset(found)
