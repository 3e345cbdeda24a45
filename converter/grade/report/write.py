"""Writes the whole report into a folder."""

import shutil
from collections.abc import Callable
from pathlib import Path

from converter.commands.json_out import write_json, write_text
from converter.grade.grades import Grades
from converter.grade.report.gradescope import to_gradescope
from converter.grade.report.pages import STUDENTS, class_page, student_page
from converter.grade.report.tables import marks_csv, mistakes_csv, pictures_csv, to_json
from converter.grade.undecided import draw
from converter.scene.settings import Settings

RESULTS = "results"
"""Folder of what Gradescope reads."""


def write_report(grades: Grades, settings: Settings, report: Path, tell: Callable[[str, float], None]) -> None:
    """Write pages, tables and results into the folder `report`.

    Args:
        grades: what is told.
        settings: size and readings of the right pictures.
        report: the folder, in which the programs' pictures lie already.
        tell: told what is at hand and the share that is done.

    """
    references = {scene: draw(task.scene, settings) for scene, task in grades.tasks.items()}
    for name in (STUDENTS, RESULTS):  # those of programs that are no longer there go
        shutil.rmtree(report / name, ignore_errors=True)
        (report / name).mkdir(parents=True)
    for count, row in enumerate(grades.rows, 1):
        write_text(report / STUDENTS / f"{row.name}.html", student_page(row, grades, references, report))
        write_json(report / RESULTS / f"{row.name}.json", to_gradescope(row, grades))
        tell(f"writing {row.name}", count / len(grades.rows))
    write_text(report / "index.html", class_page(grades, references, report))
    write_text(report / "marks.csv", marks_csv(grades))
    write_text(report / "pictures.csv", pictures_csv(grades))
    write_text(report / "mistakes.csv", mistakes_csv(grades))
    write_json(report / "report.json", to_json(grades))
