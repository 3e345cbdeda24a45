"""Facts of half-space intersections, against closed forms and against exact rational arithmetic."""

import math
import random
import subprocess
import sys
from array import array
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.scene.geometry import check_geometry, scene_facts
from converter.scene.model import Object, Plane, Polyhedron, Sphere
from converter.shapes.kind import Facts
from native_tracer import _core
from native_tracer.halfspaces import polyhedron_faces, polyhedron_facts

CUBE: list[Plane] = [
    (1, 0, 0, -1),
    (-1, 0, 0, -1),
    (0, 1, 0, -1),
    (0, -1, 0, -1),
    (0, 0, 1, -1),
    (0, 0, -1, -1),
]
OCTAHEDRON: list[Plane] = [(a, b, c, -1) for a in (1, -1) for b in (1, -1) for c in (1, -1)]


def facts_of(planes: Sequence[Sequence[float]]):
    return polyhedron_facts([planes])[0]


def prism(sides: int) -> list[Plane]:
    return [(math.cos(a), math.sin(a), 0.0, -1.0) for a in (2 * math.pi * i / sides for i in range(sides))]


def sphere_planes(count: int, seed: int = 0) -> list[Plane]:
    """Planes that touch the unit sphere at random places."""
    rng = random.Random(seed)
    planes = []
    while len(planes) < count:
        x, y, z = (rng.gauss(0, 1) for _ in range(3))
        r = math.hypot(x, y, z)
        planes.append((x / r, y / r, z / r, -1.0))
    return planes


def rotation(seed: int) -> list[list[float]]:
    rng = random.Random(seed)
    w, x, y, z = (rng.gauss(0, 1) for _ in range(4))
    s = 2 / (w * w + x * x + y * y + z * z)
    return [
        [1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)],
        [s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)],
        [s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)],
    ]


def moved(planes: Sequence[Plane], seed: int, scale: float = 1.0, offset: float = 0.0) -> list[Plane]:
    """The body, turned at random, then scaled, then shifted; every plane multiplied by some number."""
    rng = random.Random(seed)
    turn = rotation(seed)
    shift = [rng.gauss(0, 1) * offset for _ in range(3)]
    result = []
    for a, b, c, d in planes:
        x, y, z = (row[0] * a + row[1] * b + row[2] * c for row in turn)
        d = d * scale - (x * shift[0] + y * shift[1] + z * shift[2])
        factor = 10 ** rng.uniform(-9, 9)
        result.append((x * factor, y * factor, z * factor, d * factor))
    return result


def wedge(slope: float) -> list[Plane]:
    """0 <= y <= slope x up to x = 1, two wide: thinner than anything at its edge, and `slope` thick at most."""
    return [(0, -1, 0, 0), (-slope, 1, 0, 0), (1, 0, 0, -1), (0, 0, 1, -1), (0, 0, -1, -1)]


# ---- Closed forms ----------------------------------------------------------------------------------------------------


def test_cube():
    facts = facts_of(CUBE)
    assert (facts.solid, facts.bounded, facts.kept, facts.redundant) == (True, True, (0, 1, 2, 3, 4, 5), ())
    assert (facts.low, facts.high, facts.inside) == ((-1, -1, -1), (1, 1, 1), (0, 0, 0))
    for face in polyhedron_faces(CUBE):
        assert face.area == 4
        assert len(face.neighbors) == 4


@pytest.mark.parametrize(
    ("planes", "kept"),
    [
        ([], ()),
        ([(0, 2, 0, 3)], (0,)),
        ([(0, 1, 0, 0), (0, -1, 0, -1)], (0, 1)),
        ([(0, 1, 0, 0), (1, 0, 0, 0)], (0, 1)),
        ([(0, 1, 0, 0), (0, 1, 0, -1)], (0,)),
        (CUBE[:5], (0, 1, 2, 3, 4)),
        (prism(7), tuple(range(7))),
        (prism(500), tuple(range(500))),
        (moved(prism(12), 1), tuple(range(12))),
        (moved(prism(12), 2, 1e-6, 1.0), tuple(range(12))),
        (moved(OCTAHEDRON[:4], 3), (0, 1, 2, 3)),
    ],
)
def test_unbounded(planes, kept):
    facts = facts_of(planes)
    assert (facts.solid, facts.bounded, facts.kept) == (True, False, kept)
    assert all(a * x + b * y + c * z + d < 0 for a, b, c, d in planes for x, y, z in [facts.inside])


def test_without_vertices_the_box_is_around_the_nearest_points():
    facts = facts_of([(0, 3, 0, -6)])
    assert (facts.low, facts.high) == ((0, 2, 0), (0, 2, 0))


@pytest.mark.parametrize(
    ("extra", "redundant"),
    [
        ((2, 0, 0, -2), 6),  # repeats plane 0, scaled
        ((1 / 3, 0, 0, -1 / 3), 6),
        ((1, 1, 0, -2), 6),  # touches an edge
        ((1, 1, 1, -3), 6),  # touches a vertex
        ((1e-9, 2e-9, -3e-9, -6e-9), 6),
        ((1, 2, 3, -7), 6),  # is farther away
        ((1, 0, 0, -0.5), 0),  # is nearer than plane 0
    ],
)
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_redundant(extra, redundant, seed):
    planes = [*CUBE, extra]
    facts = facts_of(planes if seed is None else moved(planes, seed, 1e3))
    assert facts.redundant == (redundant,)
    assert facts.kept == tuple(k for k in range(7) if k != redundant)


def test_the_first_of_many_repeats_is_kept():
    planes = [tuple(x * factor for x in plane) for factor in (3, 1, 1e9, 1e-9) for plane in CUBE]
    assert facts_of(planes).kept == (0, 1, 2, 3, 4, 5)


@pytest.mark.parametrize("depth", [1e-3, 1e-6, 1e-9, 1e-12])
def test_what_cuts_a_little_is_kept(depth):
    assert facts_of([*CUBE, (1, 1, 1, depth - 3)]).redundant == ()
    assert facts_of([*CUBE, (1, depth, 0, -1)]).redundant == ()
    assert facts_of([*CUBE, (1, 0, 0, depth - 1)]).redundant == (0,)


@pytest.mark.parametrize("noise", [1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8])
@pytest.mark.parametrize("cap", [[], [(0.0, 0.0, 1.0, -1.0)]])
def test_walls_that_are_parallel_but_for_noise(noise, cap):
    """No wall is lost, however far away the walls may meet."""
    rng = random.Random(7)
    for seed in range(20):
        walls = moved([*prism(3 + seed % 6), *cap], seed, 1.0, 10.0)
        planes = [(*(x * (1 + noise * rng.gauss(0, 1)) for x in wall[:3]), wall[3]) for wall in walls]
        facts = facts_of(planes)
        assert facts.solid
        assert facts.kept == tuple(range(len(planes)))
        assert noise > 1e-9 or not facts.bounded


# ---- Slivers, and none -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slope", [1.0, 1e-3, 1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_slivers_are_solid(slope, seed):
    planes = wedge(slope)
    facts = facts_of(planes if seed is None else moved(planes, seed, 1e-6))
    assert facts.solid
    assert facts.bounded
    assert facts.kept == (0, 1, 2, 3, 4)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_what_rounding_may_have_made_has_no_volume(scale):
    assert not facts_of(wedge(1e-16)).solid
    thick, thin = ([(1, 0, 0, -scale), (-1, 0, 0, scale * (1 - t))] for t in (1e-12, 1e-15))
    assert facts_of(thick).solid
    assert not facts_of(thin).solid


@pytest.mark.parametrize(
    ("planes", "conflict"),
    [
        ([*CUBE, (0, -1, 0, 3)], (2, 6)),
        ([(1, 0, 0, 0), (-2, 0, 0, 0), (0, 3, 0, 0), (0, -1, 0, 0)], (0, 1)),  # a line
        ([(1, 1, 0, 1), (0, 0, 1, 0), (-1, 0, 0, 0), (0, -1, 0, 0)], (0, 2, 3)),
        ([(0, 0, 1, -5), (1, 1, 1, 1), (-1, 0, 0, 0), (0, -1, 0, 0), (0, 0, -1, 0)], (1, 2, 3, 4)),
        ([*CUBE, *[(x, y, z, 1) for x, y, z, _ in OCTAHEDRON]], None),
        ([*sphere_planes(200), (1, 0, 0, 5)], None),
        ([(1, 0, 0, k - 9) for k in range(9)] + [(-1, 0, 0, 4.5)], (5, 9)),
    ],
)
def test_conflict(planes, conflict):
    facts = facts_of(planes)
    assert not facts.solid
    if conflict is not None:
        assert facts.conflict == conflict
    some = [planes[k] for k in facts.conflict]
    assert 2 <= len(some) <= 4
    assert not facts_of(some).solid
    assert not facts.drawn
    assert all(facts_of(rest).solid for rest in combinations(some, len(some) - 1))


def test_check_geometry(small_scene):
    assert check_geometry(small_scene) == []
    nothing = Object(0, 0, Polyhedron(((1.0, 0.0, 0.0, 1.0), (-1.0, 0.0, 0.0, 0.0))), line=12)
    touching = ((1.0, 0.0, 0.0, -1.0), (-2.0, 0.0, 0.0, 2.0))
    plate = Object(0, 0, Polyhedron(touching), line=14)
    rod = Object(0, 0, Polyhedron((*touching, (0.0, 1.0, 0.0, 0.0), (0.0, -1.0, 0.0, 0.0))), line=15)
    ball = Object(0, 0, Sphere((0.0, 0.0, 0.0), 1.0))
    scene = replace(small_scene, objects=(nothing, ball, plate, rod), file=Path("a.in"))
    facts = scene_facts(scene)
    assert facts[1] == Facts((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
    empty, no_face = check_geometry(scene, facts)
    assert str(empty).startswith("a.in:12:1: object 0 is nothing: its planes 0 (1 0 0 1) and 1 (-1 0 0 0) exclude")
    assert (no_face.line, "touch, and leave neither a volume nor a face" in no_face.message) == (15, True)


# ---- Plates without thickness ----------------------------------------------------------------------------------------

PLATE: list[Plane] = [(1, 0, 0, -1), (-1, 0, 0, -1), (0, 1, 0, 0), (0, -1, 0, 0), (0, 0, 1, -1), (0, 0, -1, -1)]


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_plate_is_a_face_seen_from_both_sides(seed, scale):
    for planes in (PLATE, moved(PLATE, seed, scale, seed % 3 * 10.0)):
        facts = facts_of(planes)
        assert (facts.solid, facts.plate, facts.drawn, facts.bounded) == (False, (2, 3), True, True)
        assert (facts.kept, facts.redundant, facts.conflict) == ((0, 1, 2, 3, 4, 5), (), ())
        faces = polyhedron_faces(planes)
        assert [len(face.neighbors) for face in faces] == [0, 0, 4, 0, 0, 0]
        assert sorted(faces[2].neighbors) == [0, 1, 4, 5]
        assert faces[2].area == pytest.approx(4 * (scale if planes is not PLATE else 1.0) ** 2)
    facts = facts_of(PLATE)
    assert (facts.low, facts.high, facts.inside) == ((-1, 0, -1), (1, 0, 1), (0, 0, 0))


@pytest.mark.parametrize(
    ("extra", "redundant"),
    [
        ((1, 0, 0, -2), 6),  # is farther away
        ((1, 0, 0, -0.5), 0),  # is nearer
        ((0, 2, 0, 0), 6),  # repeats a side
        ((0, 1, 0, -1), 6),  # is above it
        ((1, 0, 1, -2), 6),  # touches a corner
        ((3, 1, 0, -3), 6),  # meets it where plane 0 does
    ],
)
def test_planes_that_do_not_bound_a_plate_are_redundant(extra, redundant):
    facts = facts_of([*PLATE, extra])
    assert (facts.plate, facts.redundant) == ((2, 3), (redundant,))


def test_a_plate_without_bounds():
    sheet = facts_of([(0, 1, 0, -3), (0, -2, 0, 6)])
    assert (sheet.plate, sheet.bounded, sheet.low, sheet.high) == ((0, 1), False, (0, 3, 0), (0, 3, 0))
    strip = facts_of([*PLATE[:4]])
    assert (strip.plate, strip.bounded, strip.kept) == ((2, 3), False, (0, 1, 2, 3))
    assert -1 < strip.inside[0] < 1


@pytest.mark.parametrize("gap", [2e-15, 1e-14, 1e-9])
def test_planes_that_exclude_each_other_by_a_hair_are_no_plate(gap):
    assert facts_of([(1, 0, 0, -1), (-1, 0, 0, 1)]).plate == (0, 1)
    assert facts_of([(1, 0, 0, -1), (-1, 0, 0, 1 + gap / 8)]).plate == ((0, 1) if gap < 3e-15 else ())
    assert not facts_of([(1, 0, 0, -1), (-1, 0, 0, 1 + gap)]).drawn


# ---- Against exact arithmetic ----------------------------------------------------------------------------------------

Point = tuple[Fraction, Fraction, Fraction]


def exact(planes: Sequence[Plane]) -> tuple[int, tuple[int, ...], bool]:
    """The body's dimension, its planes with a face, and whether it is bounded, by trying all vertices."""
    far = 10**9
    own = [tuple(map(Fraction, p)) for p in planes]
    box = [(*(sign * (i == j) for j in range(3)), -far) for i in range(3) for sign in (1, -1)]
    rows = own + [tuple(map(Fraction, p)) for p in box]
    points = {p for three in combinations(rows, 3) if (p := _meet(*three)) and all(_side(q, p) <= 0 for q in rows)}
    dimension = _dimension(points)
    kept: dict[Plane, int] = {}
    for k, plane in enumerate(own):
        largest = max(map(abs, plane[:3]))
        if _dimension({p for p in points if _side(plane, p) == 0}) == 2:
            kept.setdefault(tuple(x / largest for x in plane), k)
    return dimension, tuple(kept.values()), all(abs(x) < far for p in points for x in p)


def _side(plane, point) -> Fraction:
    return sum(a * x for a, x in zip(plane, (*point, 1), strict=True))


def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _meet(p, q, r) -> Point | None:
    qr, rp, pq = _cross(q, r), _cross(r, p), _cross(p, q)
    determinant = sum(a * b for a, b in zip(p, qr, strict=False))
    if determinant == 0:
        return None
    return tuple(-(p[3] * qr[i] + q[3] * rp[i] + r[3] * pq[i]) / determinant for i in range(3))


def _dimension(points) -> int:
    """Of the points' affine hull; -1 without points."""
    start, *others = points or (None,)
    arms = [tuple(x - y for x, y in zip(p, start, strict=True)) for p in others]
    if not arms:
        return -1 if start is None else 0
    normal = next((n for arm in arms if any(n := _cross(arms[0], arm))), None)
    if normal is None:
        return 1
    return 3 if any(sum(a * b for a, b in zip(normal, arm, strict=True)) for arm in arms) else 2


@st.composite
def integer_planes(draw) -> list[Plane]:
    """Small integers, among which planes often touch, repeat, or exclude one another."""
    size = draw(st.sampled_from([1, 1, 2, 3, 10]))
    numbers = st.integers(-size, size)
    planes: list[Plane] = []
    for _ in range(draw(st.integers(1, 7))):
        if planes and draw(st.integers(0, 6)) == 0:
            factor = draw(st.sampled_from([2, 3, 0.5, 7]))
            planes.append(tuple(factor * x for x in draw(st.sampled_from(planes))))
        else:
            normal = draw(st.tuples(numbers, numbers, numbers).filter(any))
            planes.append((*normal, -draw(st.integers(0, 2 * size) | numbers)))
    return planes


@settings(max_examples=100, deadline=None)
@given(integer_planes(), st.integers(0, 1000), st.sampled_from([1e-6, 1.0, 1e6]))
def test_agrees_with_exact_arithmetic(planes, seed, scale):
    dimension, kept, bounded = exact(planes)
    for body in (planes, moved(planes, seed, scale)):
        facts = facts_of(body)
        assert (facts.solid, bool(facts.plate)) == (dimension == 3, dimension == 2)
        if facts.plate:
            assert facts.bounded == bounded
        if facts.solid:
            assert (facts.kept, facts.bounded) == (kept, bounded)
            assert all(_side(map(Fraction, p), map(Fraction, facts.inside)) < 0 for p in body)


# ---- Faces -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("planes", [CUBE, OCTAHEDRON, wedge(1e-3), [*prism(30), *CUBE[4:]], sphere_planes(200)])
def test_faces_close(planes):
    """Outward area vectors of a closed surface add up to nothing, and every edge has two sides."""
    faces = polyhedron_faces(planes)
    total = [0.0, 0.0, 0.0]
    for (a, b, c, _), face in zip(planes, faces, strict=True):
        share = face.area / math.hypot(a, b, c)
        total = [t + share * x for t, x in zip(total, (a, b, c), strict=True)]
    assert max(map(abs, total)) < 1e-14 * sum(face.area for face in faces)
    if planes is not OCTAHEDRON:  # where four faces meet, an edge of no length may be seen from one side only
        edges = {(k, i) for k, face in enumerate(faces) for i in face.neighbors}
        assert edges == {(i, k) for k, i in edges}


def test_what_begins_huge_loses_no_edges():
    """For the far ends of this column, and the square that a face begins as, a side is narrow as noise."""
    sides = polyhedron_faces([*prism(500), (0, 0, 1, -1e8), (0, 0, -1, -1e8)])[:500]
    assert all({*side.neighbors} == {(k - 1) % 500, (k + 1) % 500, 500, 501} for k, side in enumerate(sides))


def test_faces_of_what_has_none():
    assert polyhedron_faces(CUBE[:5]) == []
    assert polyhedron_faces([(1, 0, 0, 1), (-1, 0, 0, 1)]) == []
    assert polyhedron_faces([]) == []


def test_redundant_planes_have_empty_faces():
    faces = polyhedron_faces([(1, 1, 0, -2), *CUBE, (2, 0, 0, -2)])
    assert [bool(face.neighbors) for face in faces] == [False, *[True] * 6, False]
    assert {i for face in faces for i in face.neighbors} == set(range(1, 7))


# ---- The search for the planes that cut a face -----------------------------------------------------------------------


def cone(count: int, height: float = 1.0) -> list[Plane]:
    """Planes through one point; only the roundings of their normals tell which of them are faces."""
    return [(x, y, 1.0, -height) for x, y, _, _ in prism(count)]


def pencil(count: int) -> list[Plane]:
    """Planes through the z axis."""
    return [(math.cos(a), math.sin(a), 0.0, 0.0) for a in (1.5 * i / count for i in range(count))]


def polygons(planes: Sequence[Sequence[float]], leaf_size: int):
    height = max(abs(d) / math.hypot(a, b, c) for a, b, c, d in planes)
    coefficients = array("d", [x for plane in planes for x in plane])
    return _core.halfspace_polygons(coefficients, 2.0**24 * (height or 1.0), leaf_size)


def assert_search_changes_nothing(planes: Sequence[Sequence[float]]) -> None:
    all_tried = polygons(planes, len(planes))
    assert polygons(planes, 1) == all_tried
    assert polygons(planes, 8) == all_tried


@pytest.mark.parametrize(
    "planes",
    [
        sphere_planes(400),
        moved(sphere_planes(400), 1, 1e-3, 30.0),
        prism(400),
        moved([*prism(400), *CUBE[4:]], 2, 1.0, 3.0),
        cone(400),
        cone(400, 0.0),
        moved([*cone(400), (0, 0, -1, 0)], 3, 1.0, 3.0),
        [*cone(200), *((x, y, -z, d) for x, y, z, d in cone(200))],
        pencil(400),
        moved(pencil(400), 4),
        CUBE * 60,
        [(0.3, 0.4, 0.5, -1 - (7919 * i % 400) / 400) for i in range(400)],
        [*sphere_planes(400), (1, 0, 0, 5)],
    ],
)
def test_search_for_planes_changes_nothing(planes):
    assert_search_changes_nothing(planes)


@st.composite
def many_planes(draw) -> list[Plane]:
    """Bodies of up to some hundred planes, bounded or open, of which some repeat or nearly repeat others."""
    seed = draw(st.integers(0, 10**6))
    rng = random.Random(seed)
    count = draw(st.integers(40, 300))
    kind = draw(st.sampled_from(["gem", "prism", "cone", "parallel", "integers", "random"]))
    if kind == "gem":
        planes = sphere_planes(count, seed)
    elif kind == "prism":
        planes = prism(count)
    elif kind == "cone":
        planes = cone(count)
    elif kind == "parallel":
        planes = [(0.6, 0.0, 0.8, -rng.random()) for _ in range(count)]
    elif kind == "integers":
        planes = [(*(rng.randint(-2, 2) for _ in range(3)), -rng.randint(0, 3)) for _ in range(count)]
        planes = [plane for plane in planes if any(plane[:3])] or CUBE
    else:
        planes = [(*(rng.gauss(0, 1) for _ in range(3)), rng.gauss(-0.5, 1)) for _ in range(count)]
    if draw(st.booleans()):
        planes = [(*plane[:3], plane[3] * (1 + 9 * (rng.random() < 0.9) * rng.random())) for plane in planes]
    if draw(st.booleans()):
        noise = 10 ** rng.uniform(-17, -1)
        planes += [tuple(x * (1 + noise * rng.gauss(0, 1)) for x in plane) for plane in rng.choices(planes, k=count)]
    rng.shuffle(planes)
    return moved(planes, seed, draw(st.sampled_from([1e-6, 1.0])), draw(st.sampled_from([0.0, 1.0, 30.0])))


@settings(max_examples=100, deadline=None)
@given(many_planes())
def test_search_for_planes_changes_nothing_anywhere(planes):
    assert_search_changes_nothing(planes)


def test_a_face_of_many_edges():
    *sides, top, bottom = polyhedron_faces([*prism(3000), *CUBE[4:]])
    assert sorted(top.neighbors) == sorted(bottom.neighbors) == list(range(3000))
    for base, height in ((top, 1.0), (bottom, -1.0)):
        assert base.area == pytest.approx(3000 * math.tan(math.pi / 3000), rel=1e-13)
        begins = [base.points[i : i + 3] for i in range(0, len(base.points), 3)]
        for k, (x, y, z) in zip(base.neighbors, begins, strict=True):
            assert z == height
            side = sides[k].points
            assert min(math.dist((x, y, z), side[i : i + 3]) for i in range(0, len(side), 3)) < 1e-12


# ---- Size and misuse -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("planes", "kept", "conflict"),
    [
        (prism(20000), tuple(range(20000)), ()),
        (CUBE * 3333, (0, 1, 2, 3, 4, 5), ()),
        ([*(CUBE[0] for _ in range(19999)), (-1, 0, 0, 3)], (), (0, 19999)),
    ],
)
def test_twenty_thousand_planes(planes, kept, conflict):
    facts = facts_of(planes)
    assert (facts.kept, facts.conflict) == (kept, conflict)


def test_many_planes_and_many_polyhedra():
    assert len(facts_of(sphere_planes(2000)).kept) == 2000
    many = polyhedron_facts(moved(CUBE, seed, 1e-3, 10) for seed in range(2000))
    assert all(facts.kept == (0, 1, 2, 3, 4, 5) for facts in many)


@pytest.mark.parametrize("plane", [(0, 0, 0, 1), (math.nan, 1, 0, 0), (1, 0, 0, math.inf)])
def test_planes_that_are_none(plane):
    with pytest.raises(ValueError, match="plane 6 "):
        facts_of([*CUBE, plane])
    with pytest.raises(ValueError, match="plane 6 "):
        polyhedron_faces([*CUBE, plane])


def test_buffers_that_do_not_fit():
    cube = array("d", [x for plane in CUBE for x in plane])
    with pytest.raises(ValueError, match="four coefficients"):
        _core.halfspace_bodies(cube[:-1], array("q", [0, 5]))
    for offsets in ([0, 7], [3, 2], [-1, 2]):
        with pytest.raises(ValueError, match="offsets"):
            _core.halfspace_bodies(cube, array("q", offsets))


def test_needs_no_numpy():
    code = (
        "import sys, native_tracer.halfspaces as h; h.polyhedron_facts([[(1, 0, 0, 0)]]); print('numpy' in sys.modules)"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60)
    assert ran.stdout.strip() == "False"
