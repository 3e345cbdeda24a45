"""Csgs in scene files: what is read, what is written, what is refused."""

import pytest
from csgs import BALL, CUBE, csg

from converter.scene.errors import SceneError
from converter.scene.geometry import check_geometry
from converter.scene.model import Csg, Polyhedron, Sphere
from converter.scene.parser import load_scene, parse_scene
from converter.scene.writer import write_scene

HEAD = """\
.5 2 -6
0 0 0
0 1 0
35
2
0 0 0 .6 .7 .8 1 0 0
4 6 -5 .8 .8 .7 1 0 0
1
solid .8 .8 .9
1
.3 .6 .3 20 0 0 0
"""
LEAF = "0 0 sphere 0 0 0 1"
SMALL = "0 0 sphere 0 0 0 .5"


def scene(objects: str, count: int = 1) -> str:
    return f"{HEAD}{count}\n{objects}\n"


def nested(levels: int) -> str:
    return "0 0 " + "csg 1 + 0 0 " * (levels - 1) + f"csg 1 + {LEAF}"


def test_operands_are_whole_objects():
    text = f"0 0 csg 3\n+ {LEAF}\n- 0 0 csg 2 + {SMALL} & {LEAF}\n& 0 0 polyhedron 2\n1 0 0 -.5\n-1 0 0 -.5"
    small, slab = Sphere((0, 0, 0), 0.5), Polyhedron(((1, 0, 0, -0.5), (-1, 0, 0, -0.5)))
    expected = csg("+", BALL, "-", csg("+", small, "&", BALL), "&", slab)
    for separated in (text, text.replace("\n", " "), text.replace(" ", "\n")):
        assert parse_scene(scene(separated)).objects[0].shape == expected


def test_what_is_read_is_written():
    shape = csg("+", csg("+", BALL, "-", CUBE), "&", csg("+", csg("+", BALL)))
    text = write_scene(parse_scene(scene("\n".join(["0 0 sphere 0 0 0 1"]))))
    head, _, _ = text.rpartition("0 0 sphere")
    given = parse_scene(scene(f"0 0 csg 2 + 0 0 csg 2 + {LEAF} - 0 0 polyhedron 6 "
                              "-1 0 0 -1 1 0 0 -1 0 -1 0 -1 0 1 0 -1 0 0 -1 -1 0 0 1 -1 "
                              f"& 0 0 csg 1 + 0 0 csg 1 + {LEAF}"))  # fmt: skip
    assert given.objects[0].shape == shape
    assert parse_scene(write_scene(given)) == given
    assert write_scene(given).startswith(head)


@pytest.mark.parametrize(
    ("objects", "line", "column", "message"),
    [
        (f"0 0 csg 2\n- {LEAF}\n+ {SMALL}", 14, 1, "the first operand of a csg must have '+', found '-'"),
        (f"0 0 csg 1\n& {LEAF}", 14, 1, "the first operand of a csg must have '+', found '&'"),
        ("0 0 csg 0", 13, 9, "the csg's number of operands must be a whole number from 1 on, found '0'"),
        ("0 0 csg -1", 13, 9, "the csg's number of operands must be a whole number from 1 on, found '-1'"),
        ("0 0 csg", 13, 8, "expected the csg's number of operands, found the end of the file"),
        (f"0 0 csg 2\n+ {LEAF}", 13, 9, "2 operands are announced, found 1 before the end of the file"),
        (f"0 0 csg 2\n+ {LEAF}\n- {SMALL}\n- {SMALL}", 13, 9, "2 operands are announced, but another one follows"),
        (f"0 0 csg 1\n+ {LEAF}\n- {SMALL}", 13, 9, "1 operand is announced, but another one follows"),
        (f"0 0 csg 2\n+ {LEAF}\n* {SMALL}", 15, 1, "expected '+', '-' or '&' before an operand of the csg, found '*'"),
        (
            f"0 0 csg 2\n+ {LEAF} 7\n- {SMALL}",
            14,
            22,
            "expected '+', '-' or '&' before an operand of the csg, found '7'",
        ),
        (f"0 0 csg 2\n+ {LEAF}\n- {SMALL} 7", 15, 23, "unexpected '7' after the last number of the object"),
        (f"0 0 csg 2\n+ {LEAF}\n- sphere 0 0 0 1", 15, 3, "expected the pigment index, found 'sphere'"),
        (f"0 0 csg 2\n+ {LEAF}\n- 1 0 sphere 0 0 0 1", 15, 3, "the pigment index 1 is out of range: there is only 0"),
        (f"0 0 csg 2\n+ {LEAF}\n- 0 2 sphere 0 0 0 1", 15, 5, "the finish index 2 is out of range: there is only 0"),
        (f"0 0 csg 2\n+ {LEAF}\n- 0 0 sphere 0 0 0 0", 15, 20, "the radius must be above 0, found '0'"),
        (
            f"0 0 csg 2\n+ {LEAF}\n- 0 0 sper 0 0 0 1",
            15,
            7,
            "expected sphere, polyhedron, quadric or csg, found 'sper' (did you mean 'sphere'?)",
        ),
        (f"0 0 csg 2\n+ 0 0 polyhedron 2\n1 0 0 1\n- {LEAF}", 14, 18, "2 planes are announced, found 1 before '-'"),
        (
            f"0 0 csg 2\n+\n{LEAF}\n-\n0 0 sphere 0 0 0",
            17,
            5,
            "sphere needs 4 numbers for its centre and radius, found 3 before the end of the file",
        ),
        (
            "0 0 csg 65\n" + f"+ {LEAF}\n" * 65,
            78,
            7,
            "a csg may have 64 spheres, polyhedra and quadrics at most, found more",
        ),
        (
            "0 0 csg 2\n" + "".join(f"{sign} 0 0 csg 40\n" + f"+ {LEAF}\n" * 40 for sign in "+-"),
            80,
            7,
            "a csg may have 64 spheres, polyhedra and quadrics at most, found more",
        ),
        (nested(33), 13, 389, "more than 32 csgs are in one another"),
        (nested(100_000), 13, 389, "more than 32 csgs are in one another"),
    ],
    ids=lambda value: str(value)[:20].replace("\n", " "),
)
def test_a_mistake_is_told_with_its_place(objects, line, column, message):
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(objects))
    (problem,) = caught.value.problems
    assert (problem.line, problem.column, problem.message) == (line, column, message)


def test_the_first_mistake_behind_a_csg_is_the_one_that_is_told():
    """Whose operands, on lines of their own, look like objects."""
    with pytest.raises(SceneError) as caught:
        parse_scene(scene(f"0 0 csg 2\n+\n{LEAF}\n-\n{SMALL}\n0 0 sphere 0 0 0 nan", 2))
    (problem,) = caught.value.problems
    assert (problem.line, problem.column) == (18, 18)


@pytest.mark.parametrize(("objects", "levels"), [("0 0 csg 64\n" + f"+ {LEAF}\n" * 64, 1), (nested(32), 32)])
def test_as_many_leaves_and_levels_as_there_may_be(objects, levels):
    shape = parse_scene(scene(objects)).objects[0].shape
    depth = 0
    while isinstance(shape, Csg):
        depth, shape = depth + 1, shape.operands[-1].shape
    assert depth == levels


@pytest.mark.parametrize(
    ("objects", "why"),
    [
        (f"0 0 csg 2 + {LEAF} - {LEAF}", "no point is inside of its csg"),
        (f"0 0 csg 2 + {LEAF} & 0 0 sphere 3 0 0 1", "no point is inside of its csg"),
        (f"0 0 csg 2 + {SMALL} - {LEAF}", "no point is inside of its csg"),
        ("0 0 csg 2 + 0 0 polyhedron 1 1 0 0 -1 & 0 0 polyhedron 1 -3 0 0 3", "no point is inside of its csg"),
        (
            "0 0 csg 2 + 0 0 polyhedron 1 1 3 0 -1 + 0 0 polyhedron 1 -.1 -.3 0 .1",
            "every point is inside of its csg, which has no surface",
        ),
    ],
)
def test_nothing_and_everything_are_refused(tmp_path, objects, why):
    file = tmp_path / "scene.in"
    file.write_text(scene(objects))
    with pytest.raises(SceneError) as caught:
        load_scene(file)
    (problem,) = caught.value.problems
    assert (problem.line, problem.message) == (13, f"object 0 is nothing: {why}")


def test_something_is_not_refused():
    assert check_geometry(parse_scene(scene(f"0 0 csg 2 + {LEAF} - {SMALL}"))) == []
