"""What has been found about a class of programs, put together: who made which mistake, and what it costs."""

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from converter.grade.attempts import Attempt
from converter.grade.judge import Verdict, mistakes
from converter.grade.naming import consistent
from converter.grade.rubric import Mark, Rubric, marks
from converter.grade.tasks import Task
from converter.why.student import Deviation


@dataclass(frozen=True, slots=True)
class Cell:
    """One program on one scene."""

    attempt: Attempt
    verdict: Verdict | None
    mark: Mark

    @property
    def kind(self) -> str:
        """In a word: "right", "forgiven", "mistakes", "unexplained", or "none" where there is no picture."""
        if self.verdict is None:
            return "none"
        if self.verdict.right:
            return "right"
        if not self.verdict.causes:
            return "unexplained"
        return "forgiven" if self.mark.points == self.mark.most else "mistakes"

    @property
    def sentence(self) -> str:
        """What is told of it."""
        trouble = self.attempt.trouble
        told = f"No picture: {trouble}." if self.verdict is None else self.verdict.sentence
        return f"{told} The program {trouble}." if self.verdict is not None and self.status_told else told

    @property
    def status_told(self) -> bool:
        """Whether the program failed though its picture is there."""
        return "status" in self.attempt.mistakes


@dataclass(frozen=True, slots=True)
class Row:
    """One program: a cell a scene."""

    name: str
    cells: Mapping[str, Cell]

    @property
    def points(self) -> float:
        """All that it has."""
        return sum(cell.mark.points for cell in self.cells.values())

    @property
    def clock(self) -> float:
        """Seconds of all scenes, by the clock."""
        return sum(cell.attempt.clock for cell in self.cells.values())

    @property
    def mistakes(self) -> dict[str, list[str]]:
        """The scenes in which each mistake was found, the most frequent first."""
        found: dict[str, list[str]] = {}
        for scene, cell in self.cells.items():
            for cause in cell.verdict.causes if cell.verdict is not None else ():
                found.setdefault(cause, []).append(scene)
        return dict(sorted(found.items(), key=lambda item: -len(item[1])))

    def count(self, kind: str) -> int:
        """Scenes of a kind, see `Cell.kind`."""
        return sum(cell.kind == kind for cell in self.cells.values())


@dataclass(frozen=True, slots=True)
class Grades:
    """The whole class.

    Attributes:
        tasks: the scenes, by name.
        rows: the programs.
        reference: how long the native tracer takes in their place, by scene.
        rubric: how marks were given.
        conditions: sentences: how the programs were run, and judged.

    """

    tasks: Mapping[str, Task]
    rows: Sequence[Row]
    reference: Mapping[str, Attempt]
    rubric: Rubric
    conditions: Sequence[str]

    @property
    def most(self) -> float:
        """The points that can be had."""
        return sum(self.rubric.part(scene).points for scene in self.tasks)

    @property
    def features(self) -> dict[str, list[str]]:
        """The scenes of each feature."""
        found: dict[str, list[str]] = {}
        for scene in self.tasks:
            found.setdefault(self.rubric.feature(scene), []).append(scene)
        return found

    def median_clock(self, scene: str) -> float | None:
        """What the programs that draw a scene take in the middle, in seconds by the clock."""
        drawn = [row.cells[scene].attempt.clock for row in self.rows if row.cells[scene].verdict is not None]
        return statistics.median(drawn) if drawn else None

    def mistakes(self) -> list[tuple[Deviation, dict[str, list[str]]]]:
        """Each mistake that was made, with who made it in which scenes; the most frequent first."""
        made: dict[str, dict[str, list[str]]] = {}
        for row in self.rows:
            for name, scenes in row.mistakes.items():
                made.setdefault(name, {})[row.name] = scenes
        known = mistakes()
        return [(known[name], who) for name, who in sorted(made.items(), key=lambda item: (-len(item[1]), item[0]))]


def grade(
    tasks: Mapping[str, Task],
    attempts: Mapping[str, Mapping[str, Attempt]],
    verdicts: Mapping[str, Mapping[str, Verdict | None]],
    reference: Mapping[str, Attempt],
    rubric: Rubric,
    conditions: Sequence[str],
) -> Grades:
    """Put together what was found, with the marks."""
    rows = []
    for name, by_scene in attempts.items():
        told = consistent(verdicts[name])
        given = marks(rubric, list(tasks), told)
        rows.append(Row(name, {s: Cell(by_scene[s], told[s], given[s]) for s in tasks}))
    return Grades(tasks, rows, reference, rubric, conditions)
