"""The report as CSV tables and JSON: by student, by student and scene, by mistake."""

import csv
import io
from collections.abc import Iterable, Sequence
from typing import Any

from converter.grade.grades import Cell, Grades, Row
from converter.grade.judge import mistakes


def marks_csv(grades: Grades) -> str:
    """A row a program: its points, in all, by feature and by scene."""
    features, scenes = grades.features, list(grades.tasks)
    header = ["program", "points", "of", "right", *features, *scenes]
    return _csv(
        header,
        (
            [
                row.name,
                _number(row.points),
                _number(grades.most),
                row.count("right"),
                *(_number(sum(row.cells[s].mark.points for s in names)) for names in features.values()),
                *(_number(row.cells[s].mark.points) for s in scenes),
            ]
            for row in grades.rows
        ),
    )


def pictures_csv(grades: Grades) -> str:
    """A row a program and scene: what became of it."""
    header = ["program", "scene", "feature", "found", "points", "of", "wrong", "wrong_with_mistakes", "mistakes"]
    header += ["trouble", "seconds", "processor_seconds", "memory_mib", "reference_seconds", "class_seconds"]
    rows = []
    for row in grades.rows:
        for scene, cell in row.cells.items():
            verdict, attempt = cell.verdict, cell.attempt
            shares = ("", "") if verdict is None else (f"{verdict.wrong:.6f}", f"{verdict.left:.6f}")
            causes = "" if verdict is None else " ".join(verdict.causes)
            marked = (_number(cell.mark.points), _number(cell.mark.most))
            spent = (f"{attempt.clock:.3f}", f"{attempt.cpu:.3f}", attempt.memory)
            others = (f"{grades.reference[scene].clock:.3f}", _seconds(grades.median_clock(scene)))
            told = (row.name, scene, grades.rubric.feature(scene), cell.kind)
            rows.append((*told, *marked, *shares, causes, attempt.trouble, *spent, *others))
    return _csv(header, rows)


def mistakes_csv(grades: Grades) -> str:
    """A row a mistake: how many made it, and who."""
    header = ["mistake", "part", "programs", "scenes", "sentence", "look_at", "who"]
    rows = (
        [
            m.name,
            m.part,
            len(who),
            len({s for scenes in who.values() for s in scenes}),
            m.sentence,
            m.hint,
            " ".join(who),
        ]
        for m, who in grades.mistakes()
    )
    return _csv(header, rows)


def to_json(grades: Grades) -> dict[str, Any]:
    """All of it as plain data."""
    return {
        "conditions": list(grades.conditions),
        "most": grades.most,
        "scenes": [
            {
                "name": scene,
                "feature": grades.rubric.feature(scene),
                "points": grades.rubric.part(scene).points,
                "reference_seconds": grades.reference[scene].clock,
                "class_seconds": grades.median_clock(scene),
            }
            for scene in grades.tasks
        ],
        "programs": [row_json(row) for row in grades.rows],
        "mistakes": [
            {"name": m.name, "part": m.part, "sentence": m.sentence, "hint": m.hint, "programs": who}
            for m, who in grades.mistakes()
        ],
    }


def row_json(row: Row) -> dict[str, Any]:
    """What was found about one program."""
    known = mistakes()
    return {
        "name": row.name,
        "points": row.points,
        "scenes": [_cell_json(scene, cell) for scene, cell in row.cells.items()],
        "mistakes": [
            {"name": name, "sentence": known[name].sentence, "hint": known[name].hint, "scenes": scenes}
            for name, scenes in row.mistakes.items()
        ],
    }


def _cell_json(scene: str, cell: Cell) -> dict[str, Any]:
    verdict, attempt = cell.verdict, cell.attempt
    found: dict[str, Any] = (
        {}
        if verdict is None
        else {
            "size": [verdict.width, verdict.height],
            "wrong": verdict.wrong,
            "wrong_with_mistakes": verdict.left,
            "mistakes": list(verdict.causes),
            "alternatives": {name: list(others) for name, others in verdict.alternatives.items() if others},
            "left": [{"object": o, "mechanism": m, "share": share} for o, m, share in verdict.places],
        }
    )
    return {
        "scene": scene,
        "found": cell.kind,
        "sentence": cell.sentence,
        "points": cell.mark.points,
        "of": cell.mark.most,
        "forgiven": list(cell.mark.forgiven),
        **found,
        "trouble": attempt.trouble,
        "said": attempt.said,
        "seconds": attempt.clock,
        "processor_seconds": attempt.cpu,
        "memory_mib": attempt.memory,
    }


def _csv(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(map(_plain, header))
    writer.writerows([_plain(value) for value in row] for row in rows)
    return text.getvalue()


def _plain(value: Any) -> Any:
    """A text that no spreadsheet takes for a formula: programs choose what they say."""
    return f"'{value}" if isinstance(value, str) and value[:1] in ("=", "+", "-", "@", "\t", "\r") else value


def _number(value: float) -> str:
    return f"{round(value, 4):g}"


def _seconds(value: float | None) -> str:
    return "" if value is None else f"{value:.3f}"
