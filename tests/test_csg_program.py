"""A csg as an expression: what is one leaf, what changes nothing, and that it stays what it was."""

import numpy as np
import pytest
from csgs import BALL, CUBE, CYLINDER, FAR, RIGHT, box, csg, half_space, is_inside, random_csg
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.scene.model import Csg, Operand, Polyhedron, Quadric, Sphere
from converter.shapes import csg as kind
from converter.shapes.csg_program import idle_operands, program_of, written_leaves
from converter.shapes.primitives import primitive_kind

POINTS = np.random.default_rng(3).uniform(-2.5, 2.5, (60, 3)).tolist()
GRID = [Sphere((0.5 * k, 0.0, 0.0), 1.0) for k in range(3)] + [
    box((-1, -1, -1), (0.5 * k, 1, 1)) for k in range(-1, 3)
] + [half_space(1, 0, 0, 0), half_space(-3, 0, 0, 0), half_space(0, 2, 1, -1), CYLINDER]  # fmt: skip
"""Leaves of which many coincide, contain one another, or are apart."""


@st.composite
def trees(draw, levels=3):
    steps = []
    for k in range(draw(st.integers(1, 4))):
        sign = "+" if k == 0 else draw(st.sampled_from("+-&"))
        leaf = levels == 1 or draw(st.booleans())
        steps.append(Operand(sign, draw(st.sampled_from(GRID)) if leaf else draw(trees(levels - 1))))
    return Csg(tuple(steps))


def values(shape):
    return [is_inside(shape, p) for p in POINTS]


def program_values(shape):
    program = program_of(shape)
    return [program.value([primitive_kind(leaf).contains(leaf, p) for leaf in program.leaves]) for p in POINTS]


@settings(max_examples=150, deadline=None)
@given(trees())
def test_the_program_says_what_the_tree_says(shape):
    assert program_values(shape) == values(shape)


@pytest.mark.parametrize("seed", range(16))
def test_the_program_of_a_random_csg_says_what_the_tree_says(seed):
    shape = random_csg(seed)
    assert program_values(shape) == values(shape)
    assert len(program_of(shape).leaves) <= sum(1 for _ in written_leaves(shape))


@settings(max_examples=60, deadline=None)
@given(trees(2))
def test_idle_operands_can_be_left_out(shape):
    for path in idle_operands(shape):
        assert values(_without(shape, path)) == values(shape)


def _without(shape, path):
    k, *rest = path
    operands = list(shape.operands)
    if rest:
        operands[k] = Operand(operands[k].operation, _without(operands[k].shape, rest))
    else:
        del operands[k]
        while operands and operands[0].operation != "+":
            del operands[0]  # of nothing, nothing is left
    return Csg(tuple(operands))


@pytest.mark.parametrize(
    ("shape", "idle"),
    [
        (csg("+", BALL, "-", FAR), {(1,)}),
        (csg("+", BALL, "+", BALL), {(0,), (1,)}),
        (csg("+", BALL, "-", Sphere((2.0, 0.0, 0.0), 1.0)), {(1,)}),  # they touch
        (csg("+", BALL, "+", Sphere((0.5, 0.0, 0.0), 0.5)), {(1,)}),
        (csg("+", CUBE, "&", BALL), set()),
        (csg("+", CUBE, "+", Sphere((0.0, 0.0, 0.0), 0.5)), {(1,)}),
        (csg("+", BALL, "-", csg("+", RIGHT, "-", FAR)), {(1, 1)}),
        (csg("+", BALL, "&", half_space(1, 0, 0, -3)), {(1,)}),
        (csg("+", BALL, "-", half_space(1, 0, 0, 3)), {(1,)}),
        (csg("+", BALL, "+", csg("+", RIGHT, "-", RIGHT)), {(1,)}),
    ],
)
def test_what_changes_nothing(shape, idle):
    assert idle_operands(shape) == idle


@pytest.mark.parametrize(
    ("shape", "leaves"),
    [
        (csg("+", BALL, "+", BALL), 1),
        (csg("+", BALL, "-", FAR), 1),
        (csg("+", BALL, "-", RIGHT, "+", RIGHT), 2),
        (csg("+", BALL, "+", csg("+", RIGHT, "-", RIGHT)), 1),
        (csg("+", BALL, "-", half_space(1, 2, 3, 0), "+", csg("+", BALL, "&", half_space(0.1, 0.2, 0.3, 0))), 1),
        (csg("+", BALL, "-", Polyhedron(((1, 0, 0, 0), (-1, 0, 0, 0)))), 1),  # a plate
        (csg("+", BALL, "-", CYLINDER, "+", Quadric(tuple(-3 * x for x in CYLINDER.coefficients)), "-", RIGHT), 2),
    ],
)
def test_how_many_leaves_matter(shape, leaves):
    assert len(program_of(shape).leaves) == leaves


def test_planes_that_are_one_have_the_same_numbers():
    first, second = box((0, 0, 0), (1, 1, 1)), Polyhedron(((3, 0, 0, -6), (-7, 0, 0, 7), (0.1, 0.3, 0, -5)))
    program = program_of(csg("+", first, "+", second))
    a, b = (leaf.planes for leaf in program.leaves)
    assert (1, 0, 0, -1) in a and (-1, 0, 0, 1) in b


def test_quadrics_and_balls_that_are_one_have_the_same_numbers():
    slightly = Sphere((0.1 + 0.2, 1.0, 2.0), 0.75)
    assert len(program_of(csg("+", Sphere((0.3, 1.0, 2.0), 0.75), "+", slightly)).leaves) == 1
    numbers = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, -1.0)
    scaled = Quadric(tuple(x * 7 for x in numbers))
    turned = Quadric(tuple(x * -3 for x in numbers))
    assert len(program_of(csg("+", Quadric(numbers), "+", scaled)).leaves) == 1
    program = program_of(csg("+", BALL, "&", Quadric(numbers), "+", csg("+", RIGHT, "&", turned)))
    one, other = (leaf.coefficients for leaf in program.leaves if isinstance(leaf, Quadric))
    assert one == tuple(-x for x in other)


def test_nothing_and_everything():
    assert program_of(csg("+", BALL, "-", BALL)).code == ()
    everything = program_of(csg("+", half_space(1, 0, 0, 0), "+", half_space(-2, 0, 0, 0)))
    assert everything.code == () and everything.everything


@pytest.mark.parametrize(
    ("shape", "simple"),
    [
        (csg("+", BALL), BALL),
        (csg("+", csg("+", csg("+", CUBE))), CUBE),
        (csg("+", BALL, "-", FAR), BALL),
        (Csg(tuple(Operand("&" if k else "+", half_space(*plane)) for k, plane in enumerate(CUBE.planes))), CUBE),
        (csg("+", half_space(1, 0, 0, -1), "-", half_space(1, 0, 0, 1)), Polyhedron(((1, 0, 0, -1), (-1, 0, 0, -1)))),
        (csg("+", Quadric((1, 1, 1, 0, 0, 0, 0, 0, 0, -1))), BALL),
    ],
)
def test_what_is_a_primitive_is_drawn_as_that(shape, simple):
    assert kind.simplified(shape) == simple


def test_what_is_no_primitive_stays():
    for shape in (
        csg("+", BALL, "-", RIGHT),
        csg("+", CUBE, "-", box((0, 0, 0), (2, 2, 2))),
        csg("+", BALL, "-", BALL),
    ):
        assert kind.simplified(shape) is shape


@settings(max_examples=30, deadline=None)
@given(trees(2), trees(2), trees(2))
def test_laws(a, b, c):
    """Of sets: De Morgan's, and what follows from them."""
    pairs = [
        (csg("+", a, "-", csg("+", b, "+", c)), csg("+", csg("+", a, "-", b), "&", csg("+", a, "-", c))),
        (csg("+", a, "-", csg("+", b, "&", c)), csg("+", csg("+", a, "-", b), "+", csg("+", a, "-", c))),
        (csg("+", csg("+", a, "+", b), "-", b), csg("+", a, "-", b)),
        (csg("+", a, "+", a), csg("+", a)),
        (csg("+", a, "+", b, "+", c), csg("+", c, "+", b, "+", a)),
        (csg("+", a, "-", b, "-", c), csg("+", a, "-", c, "-", b)),
    ]
    for one, other in pairs:
        assert program_values(one) == program_values(other)
