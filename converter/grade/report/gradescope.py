"""A program's results as Gradescope's autograder reads them: `results.json`."""

from typing import Any

from converter.grade.grades import Grades, Row
from converter.grade.judge import mistakes


def to_gradescope(row: Row, grades: Grades) -> dict[str, Any]:
    """The content of a `results.json`: a test a scene."""
    known = mistakes()
    tests = []
    for scene, cell in row.cells.items():
        causes = () if cell.verdict is None else cell.verdict.causes
        hints = [f"Look at {known[cause].hint}." for cause in causes]
        feature = grades.rubric.feature(scene)
        tests.append(
            {
                "name": scene if feature == scene else f"{scene}: {feature}",
                "score": round(cell.mark.points, 4),
                "max_score": cell.mark.most,
                "status": "passed" if cell.mark.points == cell.mark.most else "failed",
                "output": "\n".join((cell.sentence, *hints)),
                "output_format": "text",
            }
        )
    return {"tests": tests, "execution_time": round(row.clock), "output": " ".join(grades.conditions)}
