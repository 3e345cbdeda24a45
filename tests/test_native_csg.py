"""Constructive solid geometry in the native tracer, against an oracle and against itself."""

import math
import random
from array import array
from itertools import pairwise

import pytest
from native_scenes import CONSTANT, EPSILON, PRECISIONS, WHITE, add_finish, box, draw, new_scene, trace_ray
from test_native_quadrics import KINDS, equation, gradient, placed, turned

UNITE, SUBTRACT, INTERSECT = -1, -2, -3


# ---- An oracle, which knows nothing of passages ----------------------------------------------------------------------


def functions(leaf):
    """Polynomials, as quadrics, whose points not above 0 are the leaf's: of a polyhedron, all of them."""
    kind, numbers = leaf
    if kind == "sphere":
        x, y, z, r = numbers
        return [(1, 1, 1, 0, 0, 0, -2 * x, -2 * y, -2 * z, x * x + y * y + z * z - r * r)]
    if kind == "quadric":
        return [tuple(numbers)]
    return [(0, 0, 0, 0, 0, 0, *plane) for plane in numbers]


def value(q, p):
    return equation(q, p, (0, 0, 0))[2]


def roots(q, origin, direction):
    a, b, c = equation(q, origin, direction)
    if a == 0:
        return [-c / b] if b else []
    discriminant = b * b - 4 * a * c
    if discriminant <= 0:
        return []
    q_ = -(b + math.copysign(math.sqrt(discriminant), b)) / 2
    return [q_ / a] + ([c / q_] if q_ else [])


def contains(leaves, program, p):
    stack = []
    for step in program:
        if step >= 0:
            stack.append(all(value(q, p) <= 0 for q in functions(leaves[step])))
            continue
        right, left = stack.pop(), stack.pop()
        stack.append(left or right if step == UNITE else left and not right if step == SUBTRACT else left and right)
    return stack[0]


def along(origin, direction, t):
    return tuple(o + t * d for o, d in zip(origin, direction, strict=True))


def first_hit(leaves, program, origin, direction):
    """Distance, normal, whether the ray enters; None if it misses; False if that is hard to tell."""
    found = sorted(
        (t, q) for leaf in leaves for q in functions(leaf) for t in roots(q, origin, direction) if abs(t) < 1e6
    )
    times = [t for t, _ in found]
    if any(b - a < 1e-6 for a, b in pairwise(times)) or any(abs(t) < 1e-6 for t in times):
        return False
    ahead = [(t, q) for t, q in found if t > 0]
    middles = [0.0] + [(a + b) / 2 for (a, _), (b, _) in pairwise(ahead)]
    middles += [ahead[-1][0] + 1] if ahead else []
    states = [contains(leaves, program, along(origin, direction, t)) for t in middles]
    for (t, q), before, after in zip(ahead, states, states[1:], strict=False):
        if before != after:
            normal = gradient(q, along(origin, direction, t))
            length = math.hypot(*normal)
            facing = sum(n * d for n, d in zip(normal, direction, strict=True))
            sign = 1 if (facing < 0) == after else -1
            return t, tuple(sign * n / length for n in normal), after
    return None


def random_leaf(rng, scale=1.0):
    center = [scale * rng.uniform(-1, 1) for _ in range(3)]
    size = scale * rng.uniform(0.4, 1.2)
    kind = rng.choice(["sphere", "box", "half-space", "quadric"])
    if kind == "sphere":
        return "sphere", (*center, size)
    if kind == "box":
        low = [c - size / 2 for c in center]
        high = [c + size / 2 for c in center]
        return "polyhedron", box(low, high)
    if kind == "half-space":
        normal = [rng.uniform(-1, 1) for _ in range(3)]
        return "polyhedron", [(*normal, scale * rng.uniform(-0.3, 0.3))]
    q = placed(KINDS[rng.choice(list(KINDS))], turned(rng), [rng.uniform(-1, 1) for _ in range(3)], 1)
    sign = rng.choice([1, 1, -1])
    return "quadric", tuple(sign * c for c in q)


def random_program(rng, leaves):
    """A random expression tree over leaves 0 to n - 1, each once."""

    def tree(first, end):
        if end - first == 1:
            return [first]
        middle = rng.randint(first + 1, end - 1)
        return tree(first, middle) + tree(middle, end) + [rng.choice([UNITE, SUBTRACT, INTERSECT])]

    return tree(0, leaves)


def scene_of(leaves, program, **finish):
    scene = new_scene()
    scene.add_csg(scene.add_solid(WHITE), add_finish(scene, **{"ka": 1, **finish}), leaves, program)
    return scene


def check(leaves, program, ray, precision):
    expected = first_hit(leaves, program, ray["origin"], ray["direction"])
    if expected is False:
        return 0
    hit = ray["hit"]
    assert (hit is None) == (expected is None)
    if expected:
        t, normal, entering = expected
        slope = abs(sum(n * d for n, d in zip(normal, ray["direction"], strict=True)))
        assert hit["entering"] == entering
        if slope > 1e-2:
            assert hit["t"] == pytest.approx(t, abs=4096 * EPSILON[precision] / slope)
            assert all(
                abs(a - b) < 1e5 * EPSILON[precision] / slope for a, b in zip(hit["normal"], normal, strict=True)
            )
    return 1


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("count", [2, 3, 5, 8, 16, 64])
def test_hits_are_the_oracles(count, precision):
    rng = random.Random(count)
    told = 0
    for _ in range(max(3, 40 // count)):
        leaves = [random_leaf(rng) for _ in range(count)]
        program = random_program(rng, count)
        scene = scene_of(leaves, program)
        for _ in range(12):
            eye = tuple(rng.uniform(-3, 3) for _ in range(3))
            target = tuple(rng.uniform(-1, 1) for _ in range(3))
            ray = trace_ray(scene, eye, tuple(t - e for t, e in zip(target, eye, strict=True)), precision=precision)
            told += check(leaves, program, ray, precision)
    assert told >= 20


@pytest.mark.parametrize("finish", [{"kr": 1.0}, {"kt": 1.0, "eta": 1 / 1.25}], ids=["mirror", "glass"])
@pytest.mark.parametrize("precision", ["double", "long double"])
def test_bounces_go_on_where_they_are(finish, precision):
    """Every ray of a path is asked of the oracle from a little farther on, which knows nothing of what it starts on."""
    rng = random.Random(7)
    told = 0
    for _ in range(24):
        leaves = [random_leaf(rng) for _ in range(rng.randint(2, 6))]
        program = random_program(rng, len(leaves))
        eye = tuple(rng.uniform(-3, 3) for _ in range(3))
        ray = trace_ray(
            scene_of(leaves, program, **finish),
            eye,
            tuple(rng.uniform(-1, 1) - e for e in eye),
            precision=precision,
            max_depth=6,
        )
        while ray["children"]:
            (ray,) = ray["children"]
            ahead = {**ray, "origin": along(ray["origin"], ray["direction"], 1e-5)}
            if ray["hit"]:
                ahead["hit"] = {**ray["hit"], "t": ray["hit"]["t"] - 1e-5}
                if ray["hit"]["t"] < 1e-4:
                    break
            told += check(leaves, program, ahead, precision)
    assert told >= 20


# ---- The same body, said in another way ------------------------------------------------------------------------------


BALL = ("sphere", (0.25, 0.5, 0.125, 1.25))
OTHER = ("sphere", (-0.75, 0.25, 0.5, 1.0))
THIRD = ("sphere", (0.5, -0.5, -0.75, 0.875))
BOX = ("polyhedron", box((-1, -1, -1), (1, 1, 1)))
NEIGHBOR = ("polyhedron", box((1, -1, -1), (2, 1, 1)))  # shares a face with the box
LONG = ("polyhedron", box((-0.5, -0.5, -1), (0.5, 0.5, 1)))  # a bore through the box, from face to face
CONE = ("quadric", (1, 1, -1, 0, 0, 0, 0, 0, 0, 0))


def room(add):
    """A floor, a mirror and two lights about what `add(scene, pigment, finish)` puts there."""
    scene = new_scene((0.9, 0.95, 1.0), (0.2, 0.3, 0.5))
    scene.set_camera((1, 2.5, 6), (0, 0, 0), (0, 1, 0), 45)
    scene.add_light((5, 8, 6), (0.9, 0.9, 0.8), CONSTANT)
    scene.add_light((-6, 5, 4), (0.4, 0.4, 0.6), CONSTANT)
    checker = scene.add_checker((0.1, 0.2, 0.1), (0.9, 0.9, 0.8), 0.5)
    matte = add_finish(scene, ka=0.3, kd=0.6)
    glass = add_finish(scene, ka=0.1, kd=0.2, ks=0.3, alpha=200, kr=0.2, kt=0.6, eta=1 / 1.5)
    scene.add_polyhedron(checker, matte, [(0, 1, 0, 2)])
    scene.add_polyhedron(checker, add_finish(scene, kd=0.2, kr=0.8), [(0, 0, 1, 4)])
    add(scene, checker, glass)
    return scene


def pixels(add, **options):
    return array("f", draw(room(add), 128, 96, **options).pixels.tobytes())


def csg(leaves, *program):
    return lambda scene, pigment, finish: scene.add_csg(pigment, finish, leaves, program)


def half_spaces(polyhedron):
    return [("polyhedron", [plane]) for plane in polyhedron[1]]


def all_of(count):
    return [0] + [step for k in range(1, count) for step in (k, INTERSECT)]


A, B, C = 0, 1, 2
PAIRS = {
    "a csg of one": (csg([BALL], A), lambda s, p, f: s.add_sphere(p, f, BALL[1][:3], BALL[1][3])),
    "a box of half-spaces": (csg(half_spaces(BOX), *all_of(6)), lambda s, p, f: s.add_polyhedron(p, f, BOX[1])),
    "a box without a half-space": (
        csg([BOX, ("polyhedron", [(1, 2, 0, 0.5)])], A, B, SUBTRACT),
        lambda s, p, f: s.add_polyhedron(p, f, [*BOX[1], (-1, -2, 0, -0.5)]),
    ),
    "A - A": (csg([BALL, BALL], A, B, SUBTRACT), lambda s, p, f: None),
    "A - A, a box": (csg([BOX, BOX], A, B, SUBTRACT), lambda s, p, f: None),
    "A - A, a cone": (csg([CONE, CONE], A, B, SUBTRACT), lambda s, p, f: None),
    "A + A": (csg([BALL, BALL], A, B, UNITE), csg([BALL], A)),
    "A + A, a box": (csg([BOX, BOX], A, B, UNITE), csg([BOX], A)),
    "A & A": (csg([CONE, CONE], A, B, INTERSECT), csg([CONE], A)),
    "De Morgan": (
        csg([BALL, OTHER, THIRD], A, B, C, UNITE, SUBTRACT),
        csg([BALL, OTHER, THIRD], A, B, SUBTRACT, C, SUBTRACT),
    ),
    "De Morgan, other": (
        csg([BALL, OTHER, THIRD], A, B, C, INTERSECT, SUBTRACT),
        csg([BALL, OTHER, THIRD], A, B, SUBTRACT, A, C, SUBTRACT, UNITE),
    ),
    "(A + B) - B": (
        csg([BALL, OTHER], A, B, UNITE, B, SUBTRACT),
        csg([BALL, OTHER], A, B, SUBTRACT),
    ),
    "(A + B) - B, faces that touch": (
        csg([BOX, NEIGHBOR], A, B, UNITE, B, SUBTRACT),
        csg([BOX], A),
    ),
    "boxes that touch": (
        csg([BOX, NEIGHBOR], A, B, UNITE),
        lambda s, p, f: s.add_polyhedron(p, f, box((-1, -1, -1), (2, 1, 1))),
    ),
    "operands in another order": (
        csg([BALL, BOX, THIRD], A, B, UNITE, C, SUBTRACT),
        csg([THIRD, BOX, BALL], B, C, UNITE, A, SUBTRACT),
    ),
    "intersected in another order": (
        csg([BALL, CONE], A, B, INTERSECT),
        csg([CONE, BALL], A, B, INTERSECT),
    ),
    "a bore in two pieces": (
        csg([BOX, LONG], A, B, SUBTRACT),
        csg(
            [
                BOX,
                ("polyhedron", box((-0.5, -0.5, -1), (0.5, 0.5, 0.25))),
                ("polyhedron", box((-0.5, -0.5, 0.25), (0.5, 0.5, 1))),
            ],
            A,
            B,
            C,
            UNITE,
            SUBTRACT,
        ),
    ),
    "a complement": (
        csg([BALL, ("quadric", (-1, -1, 1, 0, 0, 0, 0, 0, 0, 0))], A, B, SUBTRACT),
        csg([BALL, CONE], A, B, INTERSECT),
    ),
}


def differing(one, other):
    return sum(
        one[3 * i : 3 * i + 3] != other[3 * i : 3 * i + 3]
        and not all(
            abs(a - b) <= 1 / 255 for a, b in zip(one[3 * i : 3 * i + 3], other[3 * i : 3 * i + 3], strict=True)
        )
        for i in range(len(one) // 3)
    )


@pytest.mark.parametrize("precision", ["double", "long double"])
@pytest.mark.parametrize("pair", PAIRS)
def test_a_body_is_what_it_is_however_it_is_said(pair, precision):
    one, other = (pixels(add, precision=precision) for add in PAIRS[pair])
    assert differing(one, other) == 0
    assert one == other


def test_precisions_agree_on_what_is_met_at_edges():
    """Rays from a round place meet the edges of a box exactly: the first of its planes is seen, as of any box."""

    def add(scene, pigment, finish):
        scene.set_camera((-1, 0.5, 7), (0, 0, 0), (0, 1, 0), 45)
        carved = [("polyhedron", box((-0.5, -0.5, -1), (1.5, 2, 2))), ("sphere", (2, 2, -0.5, 1.5))]
        scene.add_csg(pigment, finish, carved, [A, B, SUBTRACT])

    assert differing(pixels(add), pixels(add, precision="long double")) == 0


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("pair", ["A - A", "A - A, a box", "A - A, a cone"])
def test_nothing_is_left_at_any_scale(pair, scale):
    leaf = {"A - A": BALL, "A - A, a box": BOX, "A - A, a cone": CONE}[pair]
    kind, numbers = leaf
    if kind == "sphere":
        leaf = kind, [scale * n for n in numbers]
    elif kind == "polyhedron":
        leaf = kind, [(a, b, c, scale * d) for a, b, c, d in numbers]
    rng = random.Random(1)
    scene = scene_of([leaf, leaf], [A, B, SUBTRACT])
    for _ in range(100):
        eye = tuple(scale * rng.uniform(-3, 3) for _ in range(3))
        assert trace_ray(scene, eye, tuple(rng.uniform(-1, 1) for _ in range(3)))["hit"] is None


@pytest.mark.parametrize("instructions", ["baseline", "avx2", "avx512"])
def test_instruction_sets_draw_the_same_bytes(instructions):
    rng = random.Random(3)
    leaves = [random_leaf(rng) for _ in range(12)]
    add = csg(leaves, *random_program(rng, 12))
    try:
        drawn = pixels(add, instructions=instructions)
    except ValueError:
        pytest.skip(f"this processor has no {instructions}")
    assert drawn == pixels(add)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_boxes_lose_no_hit(precision):
    """Many bodies in the scene's tree, of many leaves, in each body's own."""

    def add(scene, pigment, finish):
        rng = random.Random(9)
        for _ in range(20):
            center = [rng.uniform(-2, 2) for _ in range(3)]
            leaves = [
                ("sphere", [*(c + rng.uniform(-0.4, 0.4) for c in center), rng.uniform(0.1, 0.4)]) for _ in range(9)
            ]
            scene.add_csg(
                pigment, finish, leaves, [0] + [s for k in range(1, 9) for s in (k, rng.choice([-1, -1, -2]))]
            )

    assert pixels(add, precision=precision, search="brute") == pixels(add, precision=precision, search="bvh")


@pytest.mark.parametrize("precision", PRECISIONS)
def test_leaves_that_a_ray_misses_are_left_out(precision):
    """Of small balls, most of which it misses, and some of which the expression uses twice."""
    rng = random.Random(11)
    compared = 0
    for _ in range(60):
        leaves = [("sphere", (*(rng.uniform(-1, 1) for _ in range(3)), rng.uniform(0.3, 0.9))) for _ in range(9)]
        program = [rng.randrange(9) if step >= 0 else step for step in random_program(rng, 14)]
        scene = scene_of(leaves, program)
        for _ in range(20):
            origin = tuple(rng.uniform(-2, 2) for _ in range(3))
            ray = trace_ray(scene, origin, tuple(rng.uniform(-1, 1) for _ in range(3)), precision=precision)
            compared += check(leaves, program, ray, precision)
    assert compared > 1000


@pytest.mark.parametrize("leaf", ["cylinder", "parallel planes", "crossing planes"])
def test_a_ray_along_a_leaf_meets_what_cuts_that_off(leaf):
    """It crosses the leaf nowhere, and is inside of it, or of its complement, all the way."""
    eyes = [(0.25, 0.5, 7), (2, 0.5, 7)]
    inside = [contains([("quadric", KINDS[leaf])], [0], eye) for eye in eyes]
    for sign, hits in ((1, inside), (-1, [not hit for hit in inside])):
        quadric = ("quadric", tuple(sign * number for number in KINDS[leaf]))
        scene = scene_of([quadric, ("polyhedron", [(0, 0, 1, -1)])], [A, B, INTERSECT])
        for eye, hit in zip(eyes, hits, strict=True):
            ray = trace_ray(scene, eye, (0, 0, -1))
            assert (ray["hit"] and ray["hit"]["t"]) == (6 if hit else None)


def test_a_ray_leaves_what_is_thinner_than_the_error_of_its_start():
    """From so far that it comes to be inside of the ball for less than the first hit may be off."""
    ball, other = ("sphere", (0, 0, 0, 1)), ("sphere", (3, 0, 0, 1))
    scene = scene_of([ball, other], [A, B, UNITE], kt=1, eta=1)
    for k in range(1, 8):
        ray = trace_ray(scene, (0, 1 - k * 2.0**-16, -8192), (0, 0, 1), precision="float", max_depth=3)
        entered = []
        while ray["children"]:
            entered.append(ray["hit"]["entering"])
            (ray,) = ray["children"]
        assert entered == [True, False], k


def test_the_first_leaf_is_met_at_an_edge():
    """Where a ball is cut off by a plane, a ray meets both at once, but for roundings."""
    for x, y in ((0.8, 0.0), (0.48, 0.64), (-0.64, 0.48), (-0.768, 0.224), (0.0, -0.8)):
        ball, plane = ("sphere", (0, 0, 0, 1)), ("polyhedron", [(0, 0, 1, -0.6)])
        for leaves, normal in (([ball, plane], (x, y, 0.6)), ([plane, ball], (0, 0, 1))):
            ray = trace_ray(scene_of(leaves, [A, B, INTERSECT]), (2 * x, 2 * y, 1.4), (-x, -y, -0.8))
            assert ray["hit"]["normal"] == pytest.approx(normal)


# ---- Eyes and lights ------------------------------------------------------------------------------------------------


def test_a_light_in_a_drilled_hole_shines_out_of_it():
    scene = new_scene()
    scene.add_light((0, 0, 0), WHITE, CONSTANT)
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_csg(white, matte, [BOX, LONG], [A, B, SUBTRACT])
    scene.add_polyhedron(white, matte, [(0, 0, -1, -3)])  # a wall behind the hole
    seen = trace_ray(scene, (0.25, 0.25, -2.5), (0, 0, -1))
    assert seen["hit"]["lights"][0]["shadowed_by"] is None
    hidden = trace_ray(scene, (2.25, 0.25, -2.5), (0, 0, -1))
    assert hidden["hit"]["lights"][0]["shadowed_by"] == 0
    wall = trace_ray(scene, (0, 0, 0), (1, 0, 0))
    assert wall["hit"]["normal"] == (-1, 0, 0)
    assert wall["hit"]["t"] == 0.5


@pytest.mark.parametrize("precision", ["double", "long double"])
def test_a_light_on_a_subtracted_face_shines_into_the_hole(precision):
    scene = new_scene()
    scene.add_light((0.5, 0, 0), WHITE, CONSTANT)  # on the hole's wall
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_csg(white, matte, [BOX, LONG], [A, B, SUBTRACT])
    opposite = trace_ray(scene, (0, 0.125, 0.125), (-1, 0, 0), precision=precision)
    assert opposite["hit"]["lights"][0]["shadowed_by"] is None
    assert opposite["local"] != (0, 0, 0)


@pytest.mark.parametrize("precision", ["double", "long double"])
def test_an_eye_on_a_subtracted_face_sees_the_hole(precision):
    scene = scene_of([BOX, LONG], [A, B, SUBTRACT])
    across = trace_ray(scene, (0.5, 0.1, 0.3), (-1, 0.125, 0.25), precision=precision)
    assert across["hit"]["entering"] is True
    assert across["hit"]["point"][0] == -0.5
    through = trace_ray(scene, (0.5, 0.1, 0.3), (1, 0.125, 0.25), precision=precision)
    assert through["hit"]["entering"] is False
    assert through["hit"]["point"][0] == 1


# ---- What is no csg --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("leaves", "program", "message"),
    [
        ([BALL], [], "leave one value"),
        ([BALL, BALL], [0, 1], "leave one value"),
        ([BALL], [0, UNITE], "lacks an operand"),
        ([BALL], [UNITE], "lacks an operand"),
        ([BALL], [0, -4], "no operation -4"),
        ([BALL] * 65, [0], "64 leaves at most"),
        ([BALL, BALL], [0, *[1, UNITE] * 64], "uses 64 leaves at most"),
        ([("torus", (1, 2, 3, 4))], [0], "not 'torus'"),
        ([("sphere", (1, 2, 3, 0))], [0], "radius"),
        ([("polyhedron", [])], [0], "at least one plane"),
        ([BALL], [0] * 65 + [UNITE] * 64, "too deep"),
    ],
)
def test_what_is_no_csg_is_refused(leaves, program, message):
    with pytest.raises(ValueError, match=message):
        scene_of(leaves, program)


def test_a_leaf_that_there_is_not_is_refused():
    with pytest.raises(IndexError, match="there is no leaf 1"):
        scene_of([BALL], [1])
