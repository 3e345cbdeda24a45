"""Every mistake is refused with a message that says where and what, once, and without follow-up errors."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from converter.scene.entries import PIGMENT_NAMES, SHAPE_NAMES
from converter.scene.errors import Problem, SceneError
from converter.scene.parser import load_scene, parse_scene

FIGURE_1 = (
    "0\t30\t-200\n0\t10\t-100\n0\t1\t0\n40\t\t\n3\t\t\n"
    "0\t0\t0 1 1 1 1 0 0\n60.0\t160.0\t-200.0 1 1 1 1 0 0\n-80.0\t160.0\t-200.0 1 1 1 1 0 0\n3\t\t\n"
    "texmap\trainbow1.ppm\t\n0.001\t0\t.12\n0\t0\t0 0\n"
    "checker\t.08 .25 .20\t.93 .83 .82 40\nsolid\t1 1 1\t\n3\t\t\n"
    "0.80\t0.00\t0.00 1 0.0 0 0\n0.30\t0.40\t0.00 1 0.3 0 0\n0.11\t0.11\t0.30 1000 0.7 0 0\n\n12\n"
    "0 0 sphere 0 0 0 600\n2 2 sphere 0 32.7 0 20\n2 2 sphere -5.98 0 -22.31 20\n2 2 sphere -16.32 0 16.32 20\n"
    "2 2 sphere 22.31 0 5.98 20\n2 2 sphere 5.98 -32.66 22.31 20\n2 2 sphere 16.32 -32.66 -16.32 20\n"
    "2 2 sphere -22.31 -32.66 -5.98 20\n2 2 sphere -11.95 -32.66 -44.61 20\n2 2 sphere -32.66 -32.66 32.66 20\n"
    "2 2 sphere 44.61 -32.66 11.95 20\n1 1 polyhedron 5\n0 1 0 60\n1 0 0 -300\n-1 0 0 -300\n0 0 -1 -300\n0 0 1 -300\n"
)
"""The course statement's example as it was printed: its texmap lost a number."""

TEXT = """\
0 30 -200
0 10 -100
0 1 0
40
3
0 0 0 1 1 1 1 0 0
60.0 160.0 -200.0 1 1 1 1 0 0
-80.0 160.0 -200.0 1 1 1 1 0 0
3
texmap rainbow1.ppm
0 0.001 0 .12
0 0 0 0
checker .08 .25 .20 .93 .83 .82 40
solid 1 1 1
3
0.80 0.00 0.00 1 0.0 0 0
0.30 0.40 0.00 1 0.3 0 0
0.11 0.11 0.30 1000 0.7 0 0

4
0 0 sphere 0 0 0 600
2 2 sphere 0 32.7 0 20
1 1 polyhedron 5
0 1 0 60
1 0 0 -300
-1 0 0 -300
0 0 -1 -300
0 0 1 -300
2 2 sphere -5.98 0 -22.31 20
"""
LINES = TEXT.splitlines()


def problems_of(text: str | bytes) -> list[Problem]:
    with pytest.raises(SceneError) as caught:
        parse_scene(text, Path("a.in"))
    return caught.value.problems


def changed(line: int, old: str, new: str) -> str:
    """TEXT with `old` on a line, counted from 1, replaced."""
    assert old in LINES[line - 1]
    return "\n".join([*LINES[: line - 1], LINES[line - 1].replace(old, new, 1), *LINES[line:]]) + "\n"


# -------------------------------------------------------------------------------------------------- the printed example


def test_the_statements_own_example() -> None:
    with pytest.raises(SceneError) as caught:
        parse_scene(FIGURE_1, Path("figure1.in"))
    assert str(caught.value) == (
        "figure1.in:10:9: texmap needs 8 numbers for P0 and P1, found 7 before 'checker'\n"
        "    texmap  rainbow1.ppm\n"
        "            ^"
    )


def test_the_statements_own_example_without_its_texture(tmp_path: Path) -> None:
    file = tmp_path / "figure1.in"
    file.write_text(FIGURE_1)
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    first, second = caught.value.problems
    assert first.message == "texmap needs 8 numbers for P0 and P1, found 7 before 'checker'"
    assert second.message.endswith("rainbow1.ppm: no such file")
    assert (second.line, second.column) == (10, 9)


# ------------------------------------------------------------------------------------------------ one mistake, one word

LIGHT = "a light needs 9 numbers for position, colour and attenuation, found"
FINISH = "a finish needs 7 numbers for ka, kd, ks, alpha, kr, kt and ior, found"
COMMENT, BLANKS = ": a comment starts with '#'", ": blanks separate numbers, and nothing else"
SPHERE = "sphere needs 4 numbers for its centre and radius, found"
NO_SURFACE = "this quadric has no surface"
INSIDE = " (inside is A x^2 + ... + J <= 0)"
LENS = "the lens needs 2 numbers for its radius and the distance in focus, found"
MOVE = "move needs 3 numbers for a displacement, found"
TWICE = "+ 0 0 sphere 1 1 1 1 move 1 0 0 move 1 0 0"
ALONE = "an operand does not move by itself: 'move' stands behind the last one, for the whole csg"
CASES = [
    # the camera
    (1, "-200", "", 1, 1, "the eye needs 3 numbers for x, y and z, found 2 before the end of the line"),
    (1, "-200", "-200 7", 1, 11, "unexpected '7' after the last number of the eye"),
    (2, "10 ", "", 2, 1, "the look-at point needs 3 numbers for x, y and z, found 2 before the end of the line"),
    (3, "0 1 0", "", 4, 1, "expected the up vector, 3 numbers, found '40' alone"),
    (2, "0 10 -100", "0 30 -200", 2, 1, "the look-at point must differ from the eye"),
    (3, "0 1 0", "0 0 0", 3, 1, "the up vector must not be zero"),
    (3, "0 1 0", "0 -20 100", 3, 1, "the up vector must not be parallel to the view direction"),
    (3, "0 1 0", "0 40 -200", 3, 1, "the up vector must not be parallel to the view direction"),
    (4, "40", "0", 4, 1, "fovy must lie between 0 and 180 degrees, found '0'"),
    (4, "40", "180", 4, 1, "fovy must lie between 0 and 180 degrees, found '180'"),
    (4, "40", "-40", 4, 1, "fovy must lie between 0 and 180 degrees, found '-40'"),
    (
        4,
        "40",
        "40 2",
        4,
        4,
        "the lens needs 2 numbers for its radius and the distance in focus, found 1 before the end of the line",
    ),
    (4, "40", "40 2 x", 4, 6, "the lens's focal distance must be a number, found 'x'"),
    (4, "40", "40 2 100 7", 4, 1, "expected fovy alone on its line, found '40' and more"),
    (4, "40", "40 -2 100", 4, 4, "the aperture must not be negative, found '-2'"),
    (4, "40", "40 2 0", 4, 6, "the focal distance must be positive, found '0'"),
    (4, "40", "40 2 -100", 4, 6, "the focal distance must be positive, found '-100'"),
    (4, "40", "40 0 -100", 4, 6, "the focal distance must not be negative, found '-100'"),
    (4, "40", "40 2 inf", 4, 6, "the lens's focal distance must be a number, found 'inf', which is not finite"),
    # counts
    (5, "3", "0", 5, 1, "the number of lights must be a whole number from 1 on, found '0'"),
    (5, "3", "-1", 5, 1, "the number of lights must be a whole number from 1 on, found '-1'"),
    (5, "3", "3.0", 5, 1, "the number of lights must be a whole number from 1 on, found '3.0'"),
    (5, "3", "3e0", 5, 1, "the number of lights must be a whole number from 1 on, found '3e0'"),
    (5, "3", "2", 5, 1, "the number of lights is given as 2, but 3 follow"),
    (5, "3", "4", 5, 1, "the number of lights is given as 4, but 3 follow"),
    (5, "3", "three", 5, 1, "expected the number of lights, found 'three'"),
    (5, "3", "3 lights", 5, 3, "unexpected 'lights' after the number of lights"),
    (5, "3", "", 6, 1, "expected the number of lights alone on a line, found '0'"),
    (9, "3", "1_0", 9, 1, "expected the number of pigments, found '1_0'"),
    (9, "3", "2", 9, 1, "the number of pigments is given as 2, but 3 follow"),
    (9, "3", "4", 9, 1, "the number of pigments is given as 4, but 3 follow"),
    (9, "3", "-3", 9, 1, "the number of pigments must be a whole number from 0 on, found '-3'"),
    (9, "3", "", 10, 1, "expected the number of pigments alone on a line, found 'texmap'"),
    (15, "3", "2", 15, 1, "the number of finishes is given as 2, but 3 follow"),
    (15, "3", "4", 15, 1, "the number of finishes is given as 4, but 3 follow"),
    (15, "3", "", 16, 1, "expected the number of finishes alone on a line, found '0.80'"),
    (20, "4", "5", 20, 1, "the number of objects is given as 5, but 4 follow"),
    (20, "4", "1e5", 20, 1, "the number of objects must be a whole number from 0 on, found '1e5'"),
    (20, "4", "999999999999", 20, 1, "the number of objects is given as 999999999999, but 4 follow"),
    (20, "4", "9" * 5000, 20, 1, f"the number of objects is given as {'9' * 37}..., but 4 follow"),
    (20, "4", "", 21, 1, "expected the number of objects alone on a line, found '0'"),
    # lights
    (7, " 0 0", " 0", 7, 1, f"{LIGHT} 8 before the end of the line"),
    (8, " 0 0", " 0", 8, 1, f"{LIGHT} 8 before the end of the line"),
    (8, "0 0", "0 0 -3", 8, 32, "a light's radius must not be negative, found '-3'"),
    (6, "1 0 0", "1 0 0 -3", 6, 19, "a light's radius must not be negative, found '-3'"),
    (8, "0 0", "0 0 3 4", 8, 34, "unexpected '4' after the last number of the light"),
    (8, "0 0", "0 0 x", 8, 32, "expected a light's radius, found 'x'"),
    (8, "0 0", "0 0 1e999", 8, 32, "a light's radius must be a number, found '1e999', which is too large"),
    (8, "1 0 0", "0 0 0", 8, 26, "the attenuation a + b d + c d^2 must be positive at some distance d"),
    (8, "1 0 0", "-1 0 0", 8, 26, "the attenuation a + b d + c d^2 must be positive at some distance d"),
    (8, "1 0 0", "-1 2 -1", 8, 26, "the attenuation a + b d + c d^2 must be positive at some distance d"),
    (7, "60.0", "6O.0", 7, 1, "a light's x must be a number, found '6O.0'"),
    (7, "60.0", "nan", 7, 1, "a light's x must be a number, found 'nan', which is not finite"),
    (7, "60.0", "-Inf", 7, 1, "a light's x must be a number, found '-Inf', which is not finite"),
    (7, "60.0", "1e999", 7, 1, "a light's x must be a number, found '1e999', which is too large"),
    (7, "60.0", "0x3C", 7, 1, "a light's x must be a number, found '0x3C'"),
    (7, "60.0", "6_0", 7, 1, "a light's x must be a number, found '6_0'"),
    (7, "60.0", "60,0", 7, 1, "a light's x must be a number, found '60,0': decimals follow a point, not a comma"),
    (
        7,
        "60.0",
        "\u221260",
        7,
        1,
        "a light's x must be a number, found '\u221260', whose minus sign is not the plain '-'",
    ),
    (7, "60.0", "\u0666\u0660", 7, 1, "a light's x must be a number, found '\u0666\u0660'"),
    (7, "60.0", "abc", 7, 1, "a light's x must be a number, found 'abc'"),
    # pigments
    (10, "texmap", "texmpa", 10, 1, f"expected {PIGMENT_NAMES}, found 'texmpa' (did you mean 'texmap'?)"),
    (13, "checker", "Checker", 13, 1, f"expected {PIGMENT_NAMES}, found 'Checker' (did you mean 'checker'?)"),
    (14, "solid", "plastic", 14, 1, f"expected {PIGMENT_NAMES}, found 'plastic'"),
    (14, "solid ", "", 14, 1, f"expected {PIGMENT_NAMES}, found '1'"),
    (14, "1 1 1", "1 1", 14, 1, "solid needs 3 numbers for its colour, found 2 before the end of the line"),
    (14, "1 1 1", "1 1 1 1", 14, 13, "unexpected '1' after the last number of the pigment"),
    (13, " 40", "", 13, 1, "checker needs 7 numbers for two colours and a size, found 6 before 'solid'"),
    (13, "40", "0", 13, 33, "the checker's size must be above 0, found '0'"),
    (13, "40", "-4", 13, 33, "the checker's size must be above 0, found '-4'"),
    (10, "rainbow1.ppm", "my rainbow.ppm", 10, 11, "a texture's name is one word: unexpected 'rainbow.ppm' after 'my'"),
    (11, "0 0.001 ", "0.001 ", 10, 8, "texmap needs 8 numbers for P0 and P1, found 7 before 'checker'"),
    (12, "0 0 0 0", "", 10, 8, "texmap needs 8 numbers for P0 and P1, found 4 before 'checker'"),
    (11, "0 0.001", "O 0.001", 11, 1, "texmap's P0[0] must be a number, found 'O'"),
    # finishes
    (16, " 0 0", " 0", 16, 1, f"{FINISH} 6 before the end of the line"),
    (18, " 0 0", " 0", 18, 1, f"{FINISH} 6 before the end of the line"),
    (18, "7 0 0", "7 0 0 -3", 18, 29, "a finish's cone must have a half-angle from 0 to 90 degrees, found '-3'"),
    (18, "7 0 0", "7 0 0 91", 18, 29, "a finish's cone must have a half-angle from 0 to 90 degrees, found '91'"),
    (18, "7 0 0", "7 0 0 3 4", 18, 31, "unexpected '4' after the last number of the finish"),
    (18, "7 0 0", "7 0 0 3x", 18, 29, "a finish's cone must be a number, found '3x'"),
    (17, "0.30", "-0.3", 17, 1, "ka must not be negative, found '-0.3'"),
    (17, "0.40", "-0.4", 17, 6, "kd must not be negative, found '-0.4'"),
    (17, "0.00", "-0.1", 17, 11, "ks must not be negative, found '-0.1'"),
    (17, " 1 ", " -1 ", 17, 16, "alpha must not be negative, found '-1'"),
    (17, "0.3 0 0", "-.3 0 0", 17, 18, "kr must not be negative, found '-.3'"),
    (17, "0.3 0 0", "0.3 -1 0", 17, 22, "kt must not be negative, found '-1'"),
    (17, "0.3 0 0", "0.3 .5 0", 17, 25, "a finish with kt above 0 needs an ior above 0, found '0'"),
    (17, "0.3 0 0", "0.3 .5 -1.5", 17, 25, "a finish with kt above 0 needs an ior above 0, found '-1.5'"),
    # objects
    (22, "sphere", "Sphere", 22, 5, f"expected {SHAPE_NAMES}, found 'Sphere' (did you mean 'sphere'?)"),
    (
        23,
        "polyhedron",
        "polihedron",
        23,
        5,
        f"expected {SHAPE_NAMES}, found 'polihedron' (did you mean 'polyhedron'?)",
    ),
    (22, "sphere", "cube", 22, 5, f"expected {SHAPE_NAMES}, found 'cube'"),
    (22, "sphere ", "", 22, 1, "unexpected '2' at the beginning of a line after the object"),
    (22, " 20", "", 22, 5, "sphere needs 4 numbers for its centre and radius, found 3 before the end of the line"),
    (29, " 20", "", 29, 5, "sphere needs 4 numbers for its centre and radius, found 3 before the end of the file"),
    (22, "20", "20 5", 22, 24, "unexpected '5' after the last number of the object"),
    (22, "20", "0", 22, 21, "the radius must be above 0, found '0'"),
    (22, "20", "-20", 22, 21, "the radius must be above 0, found '-20'"),
    (22, "2 2 ", "3 2 ", 22, 1, "the pigment index 3 is out of range: there are 3, counted from 0"),
    (22, "2 2 ", "2 3 ", 22, 3, "the finish index 3 is out of range: there are 3, counted from 0"),
    (22, "2 2 ", "-1 2 ", 22, 1, "the pigment index must be a whole number, found '-1'"),
    (22, "2 2 ", "2 1.0 ", 22, 3, "the finish index must be a whole number, found '1.0'"),
    (22, "2 2 ", "2 ", 22, 3, "expected the finish index, found 'sphere'"),
    (22, "2 2 ", "", 22, 1, "expected the pigment index, found 'sphere'"),
    (23, "5", "6", 23, 16, "6 planes are announced, but 5 follow"),
    (23, "5", "4", 23, 16, "4 planes are announced, but 5 follow"),
    (23, "5", "0", 23, 16, "the polyhedron's number of planes must be a whole number from 1 on, found '0'"),
    (23, "5", "5.", 23, 16, "the polyhedron's number of planes must be a whole number from 1 on, found '5.'"),
    (23, "5", "99999999999", 23, 16, "99999999999 planes are announced, but 5 follow"),
    (26, "-1 0 0", "0 -0 0", 26, 1, "a plane's normal (its first three numbers) must not be zero"),
    (26, "-1 0 0", "-1 0", 26, 1, "a plane needs 4 numbers for a, b, c and d, found 3 on its line"),
    (26, "-300", "-300 1", 26, 1, "a plane needs 4 numbers for a, b, c and d, found 5 on its line"),
    (26, "-1", "-l", 26, 1, "a plane's a must be a number, found '-l'"),
    (
        22,
        "sphere 0 32.7 0 20",
        "quadric 1 1 1 0 0 0 0 0 0",
        22,
        5,
        "a quadric needs 10 numbers for A to J, found 9 before the end of the line",
    ),
    (
        22,
        "sphere 0 32.7 0 20",
        "quadric 1 1 1 0 0 0 0 0 0 -1 2",
        22,
        34,
        "unexpected '2' after the last number of the object",
    ),
    (22, "sphere 0 32.7 0 20", "quadric 1 1 1 0 0 x 0 0 0 -1", 22, 23, "a quadric's F must be a number, found 'x'"),
    (
        22,
        "sphere 0 32.7 0 20",
        "quadric 1 1 1 0 0 nan 0 0 0 -1",
        22,
        23,
        "a quadric's F must be a number, found 'nan', which is not finite",
    ),
    (22, "sphere 0 32.7 0 20", "quadric 1 1 1 0 0 0 0 0 0 1", 22, 5, f"{NO_SURFACE}: no point is inside{INSIDE}"),
    (22, "sphere 0 32.7 0 20", "quadric -1 0 0 0 0 0 0 0 0 0", 22, 5, f"{NO_SURFACE}: every point is inside{INSIDE}"),
    (22, "sphere 0 32.7 0 20", "quadric 0 0 0 0 0 0 0 0 0 0", 22, 5, f"{NO_SURFACE}: every point is inside{INSIDE}"),
    (22, "sphere 0 32.7 0 20", "csg 1\n+ 0 0 sphere 1 1 1", 23, 7, f"{SPHERE} 3 before the end of the line"),
    (22, "20", "20 move 1 0", 22, 24, f"{MOVE} 2 before the end of the line"),
    (22, "20", "20\nmove 1 0", 23, 1, f"{MOVE} 2 before the end of the line"),
    (22, "20", "20 move 1 y 0", 22, 31, "move's y must be a number, found 'y'"),
    (22, "20", "20 move 1 nan 0", 22, 31, "move's y must be a number, found 'nan', which is not finite"),
    (22, "20", "20 move 1 0 0 7", 22, 35, "unexpected '7' after the last number of the object"),
    (22, "20", "20 moves 1 0 0", 22, 24, "unexpected 'moves' after the last number of the object"),
    (22, " 20", " move 1 0 0", 22, 5, f"{SPHERE} 3 before 'move'"),
    (
        28,
        "-300",
        "-300 move 1 0",
        28,
        12,
        "move needs 3 numbers for a displacement, found 2 before the end of the line",
    ),
    (28, " -300", " move 1 0 0", 28, 1, "a plane needs 4 numbers for a, b, c and d, found 3 on its line"),
    (22, "sphere 0 32.7 0 20", "csg 2\n+ 0 0 sphere 1 1 1 1 move 1 0 0\n+ 0 0 sphere 2 1 1 1", 23, 22, ALONE),
    (
        22,
        "sphere 0 32.7 0 20",
        "csg 1\n+ 0 0 csg 1\n+ 0 0 sphere 1 1 1 1 move 1 0 0 move 1 0 0",
        24,
        33,
        "unexpected 'move' after the last number of the object",
    ),
    # the end
    (29, "20", "20\nfim da cena", 30, 1, "unexpected 'fim' after the last of 4 objects"),
    (29, "20", "20\n7", 30, 1, "unexpected '7' after the last of 4 objects"),
    (29, "20", "20\n1 0 0 -5", 30, 1, "unexpected '1' after the last of 4 objects"),
    (29, "20", "20\n0 0 sphere 0 0 0", 30, 1, "unexpected '0' after the last of 4 objects"),
    (29, "20", "20\n0 0 sphere 0 0 0 0", 20, 1, "the number of objects is given as 4, but 5 follow"),
    (29, "20", "20\n# end\n// end", 31, 1, f"unexpected '//' after the last of 4 objects{COMMENT}"),
    # words that other languages have
    (1, "0 30", "eye 0 30", 1, 1, "the eye's x must be a number, found 'eye'"),
    (7, "60.0", "light 60.0", 7, 1, "a light's x must be a number, found 'light'"),
    (4, "40", "// degrees\n40", 4, 1, f"expected fovy's angle, found '//'{COMMENT}"),
    (1, "0 30", "// a scene\n0 30", 1, 1, f"expected the eye's x, found '//'{COMMENT}"),
    (1, "0 30", "/* a scene */\n0 30", 1, 1, f"expected the eye's x, found '/*'{COMMENT}"),
    (1, "-200", "-200 ; eye", 1, 11, f"unexpected ';' after the last number of the eye{COMMENT}"),
    (5, "3", "3 //lights", 5, 3, f"unexpected '//lights' after the number of lights{COMMENT}"),
    (22, "20", "20 // ball", 22, 24, f"unexpected '//' after the last number of the object{COMMENT}"),
    (14, "1 1 1", "1,1,1", 14, 7, f"expected solid's red, found '1,1,1'{BLANKS}"),
    (14, "1 1 1", "1, 1, 1", 14, 7, f"expected solid's red, found '1,'{BLANKS}"),
    (14, "solid", "solid,", 14, 1, f"expected {PIGMENT_NAMES}, found 'solid,'{BLANKS}"),
]


@pytest.mark.parametrize(
    ("at", "old", "new", "line", "column", "message"), CASES, ids=[f"{c[0]}:{c[2][:20]}" for c in CASES]
)
def test_a_mistake_is_told_once(at: int, old: str, new: str, line: int, column: int, message: str) -> None:
    (problem,) = problems_of(changed(at, old, new))
    assert (problem.line, problem.column, problem.message) == (line, column, message)
    assert problem.source_line == changed(at, old, new).splitlines()[line - 1]


EXTENSIBLE = (6, 7, 8, 16, 17, 18)
"""Lines of lights and finishes."""
WORDS = [(line, k) for line, text in enumerate(LINES) for k in range(len(text.split()))]


@pytest.mark.parametrize("mutation", ["delete", "double", "garble", "drop line", "double line"])
def test_no_mistake_has_follow_up_errors(mutation: str) -> None:
    for line, k in WORDS:
        words = LINES[line].split()
        lines = LINES[:]
        match mutation:
            case "delete":
                lines[line] = " ".join(words[:k] + words[k + 1 :])
            case "double":
                lines[line] = " ".join(words[: k + 1] + words[k:])
            case "garble":
                lines[line] = " ".join([*words[:k], "x1", *words[k + 1 :]])
            case "drop line":
                del lines[line]
            case "double line":
                lines.insert(line, lines[line])
        surplus = mutation == "double line" and "sphere" in LINES[line]
        surplus |= mutation == "double" and line + 1 in EXTENSIBLE  # which may have that number more
        if surplus or (mutation == "garble" and words[k] == "rainbow1.ppm"):
            continue  # nothing that is refused
        found = problems_of("\n".join(lines))
        assert len(found) == 1, (lines[line], found)
        # The place itself, or the section's or polyhedron's count, or where texmap's numbers begin.
        counts = [5, 9, 15, 20, 23, 10]
        assert abs(found[0].line - (line + 1)) <= 3 or found[0].line in counts, (lines[line], found)


@pytest.mark.parametrize("size", range(len(WORDS)))
def test_a_scene_that_is_cut_off(size: int) -> None:
    words = TEXT.split()[:size]
    for text in (" ".join(words), TEXT[: len(TEXT) * size // len(WORDS)].rpartition("\n")[0]):
        assert len(problems_of(text)) == 1


# -------------------------------------------------------------------------------------------------------- many mistakes


def test_all_mistakes_are_told_in_one_go() -> None:
    text = TEXT
    for old, new in [
        ("0 30 -200", "0 nan -200"),
        ("40\n3", "400\n3"),
        ("60.0 160.0", "6O.0 160.0"),
        (".08", ",08"),
        ("solid", "sollid"),
        ("0.30 0.40", "0.30 -0.40"),
        ("0.11 0.11 0.30", "0.11 0.11"),
        ("600", "-600"),
        ("1 1 poly", "5 1 poly"),
        ("1 0 0 -300\n", "1 0 0 -300 0\n"),
        ("-22.31 20", "-22.31"),
    ]:
        assert old in text
        text = text.replace(old, new, 1)
    found = [(p.line, p.column) for p in problems_of(text)]
    assert found == [(1, 3), (4, 1), (7, 1), (13, 9), (14, 1), (17, 6), (18, 1), (21, 18), (25, 1), (29, 5)]


def test_a_bad_number_does_not_hide_a_later_mistake_in_the_same_entry() -> None:
    found = problems_of(changed(21, "0 0 0 600", "x1 0 0 -1"))
    assert [(p.line, p.column) for p in found] == [(21, 12), (21, 19)]


def test_a_missing_fovy_is_missed() -> None:
    (problem,) = problems_of(changed(4, "40", ""))
    assert (problem.line, problem.column) == (5, 1)
    assert problem.message == "expected fovy, the angle of view, before the number of lights, found '3'"
    (problem,) = problems_of(changed(4, "40", "fovy 40"))
    assert problem.message == "expected fovy's angle, found 'fovy'"


@pytest.mark.parametrize(("old", "new"), [(" ", ","), (" ", ", "), (" ", ";"), ("\n", ";\n")])
def test_marks_between_all_numbers_are_told_once(old: str, new: str) -> None:
    (problem,) = problems_of(TEXT.replace(old, new))
    assert problem.line == 1
    assert problem.message.endswith(BLANKS)


def test_comments_of_another_language_are_told_once() -> None:
    (problem,) = problems_of("// by me\n// for you\n" + TEXT.replace("\n3\n", "\n3 // of them\n"))
    assert (problem.line, problem.column, problem.message) == (1, 1, f"expected the eye's x, found '//'{COMMENT}")
    (problem,) = problems_of(TEXT.replace("\n", " // why\n"))
    assert problem.message == f"expected the look-at point's x, found '//'{COMMENT}"


def test_labels_before_the_cameras_numbers_are_each_told() -> None:
    labels = iter(["eye ", "lookat ", "up ", "fovy "])
    text = "\n".join(next(labels, "") + line for line in LINES)
    assert [p.line for p in problems_of(text)] == [1, 2, 3, 4]


def test_one_plane_is_a_plane() -> None:
    (problem,) = problems_of(changed(23, "5", "1"))
    assert problem.message == "1 plane is announced, but 5 follow"


def test_a_wrong_count_does_not_put_indices_out_of_range() -> None:
    (problem,) = problems_of(changed(14, "solid 1 1 1", ""))
    assert problem.message == "the number of pigments is given as 3, but 2 follow"


def test_only_the_first_twenty_are_shown() -> None:
    balls = "".join(f"0 0 sphere 0 0 0 -{i + 1}\n" for i in range(57))
    head = TEXT.partition("\n4\n")[0]
    with pytest.raises(SceneError) as caught:
        parse_scene(f"{head}\n57\n{balls}", Path("a.in"))
    assert len(caught.value.problems) == 20
    assert caught.value.omitted == 37
    assert [p.line for p in caught.value.problems] == list(range(21, 41))
    assert str(caught.value).endswith("\n... and 37 more")


def test_without_lines_the_first_mistake_is_told() -> None:
    text = " ".join(TEXT.split())
    (problem,) = problems_of(text.replace("polyhedron 5", "polyhedron 6"))
    assert problem.message == "6 planes are announced, found 5 before the end of the line"
    assert text[problem.column - 1 :].startswith("5 0 1 0 60")
    (problem,) = problems_of(text.replace("solid", "sollid"))
    assert "did you mean 'solid'" in problem.message
    (problem,) = problems_of(text + " more")
    assert problem.message == "unexpected 'more' after the last of 4 objects"
    radii = problems_of(text.replace("600", "-600").replace("-22.31 20", "-22.31 0"))
    assert len(radii) == 2


# ------------------------------------------------------------------------------------------------------ how it is shown


def test_the_caret_stands_below_the_word() -> None:
    text = TEXT.replace("0 0 sphere 0 0 0 600", "\t0 0\tsphere 0 0 0\t-600")
    (problem,) = problems_of(text)
    _, line, caret = str(problem).splitlines()
    assert line[caret.index("^") :] == "-600"
    assert problem.column == caret.index("^") - 4 + 1


def test_a_long_line_is_shown_in_part() -> None:
    text = " ".join(TEXT.split()).replace("600", "-600") + "  # " + "x" * 100_000
    (problem,) = problems_of(text)
    _, line, caret = str(problem).splitlines()
    assert line[caret.index("^") :].startswith("-600 ")
    assert len(line) < 120


def test_a_terminal_is_not_sent_what_is_in_the_file() -> None:
    (problem,) = problems_of(changed(21, "sphere", "sp\x1b[31mhere"))
    assert "\x1b" not in str(problem)


def test_text_without_a_file_has_a_name_too() -> None:
    with pytest.raises(SceneError, match=r"^scene:1:1: expected the eye's x, found 'hello'"):
        parse_scene("hello")


# ---------------------------------------------------------------------------------------------------------------- speed


def test_many_mistakes_take_no_time() -> None:
    head = TEXT.partition("\n4\n")[0]
    for ball in (
        "0 0 0 -1\n",
        "0 0 Sphere 0 0 0 1\n",
        "0 0 sphere 0 0 0\n",
        "0 9 sphere x y z -1 ",
        "0 0 polyhedron 9\n0 0 0 0\n",
    ):
        start = time.process_time()
        with pytest.raises(SceneError) as caught:
            parse_scene(f"{head}\n5000\n{ball * 5000}")
        assert len(str(caught.value)) < 20_000
        assert time.process_time() - start < 3


@pytest.mark.parametrize("head", ["plastic", "texmap sky.ppm", "texmap", "solid", "0 0 polyhedron 3", "0 0 cube"])
def test_many_lines_that_belong_to_nothing_take_no_time(head: str) -> None:
    start = time.process_time()
    line = 21 if head.startswith("0") else 14
    problems_of(changed(line, LINES[line - 1], head + "\n1 2 3 4" * 30_000))
    assert time.process_time() - start < 3


def test_reading_needs_no_heavy_module() -> None:
    code = "import sys; from converter.scene import parser; print('numpy' in sys.modules, 'OpenImageIO' in sys.modules)"
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert result.stdout.split() == ["False", "False"]
