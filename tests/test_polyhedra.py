"""Polyhedra as meshes, against closed forms and against the clipped polygons; and how much of them is needed."""

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere
from converter.scene.settings import Settings
from converter.to_mitsuba.bounds import Box, scene_bounds
from converter.to_mitsuba.meshes import MeshError, polyhedron_mesh, write_ply
from native_tracer.halfspaces import polyhedron_faces, polyhedron_facts

BOX = Box((-100.0, -100.0, -100.0), (100.0, 100.0, 100.0))
CUBE = [(1, 0, 0, -1), (-1, 0, 0, -1), (0, 1, 0, -1), (0, -1, 0, -1), (0, 0, 1, -1), (0, 0, -1, -1)]
OCTAHEDRON = [(a, b, c, -1) for a in (1, -1) for b in (1, -1) for c in (1, -1)]
GOLDEN = (1 + math.sqrt(5)) / 2
DODECAHEDRON = [
    (*normal, -1) for a in (1, -1) for b in (GOLDEN, -GOLDEN) for normal in ((0, a, b), (a, b, 0), (b, 0, a))
]


def sphere_planes(count, seed=0):
    normals = np.random.default_rng(seed).normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return [(*normal, -1.0) for normal in normals.tolist()]


def prism(sides):
    return [(math.cos(a), math.sin(a), 0.0, -1.0) for a in (2 * math.pi * i / sides for i in range(sides))]


def moved(planes, seed, offset=0.0):
    """The body, turned and shifted at random."""
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    shift = rng.normal(size=3) * offset
    return [(*(n := turn @ plane[:3]).tolist(), float(plane[3] - n @ shift)) for plane in planes]


def unit(planes):
    rows = np.array(planes, dtype=np.longdouble)
    return rows / np.sqrt((rows[:, :3] ** 2).sum(axis=1))[:, None]


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] - mesh.vertices[0] for i in range(3))
    return float((np.cross(a, b) * c).sum() / 6)


def plane_areas(mesh, planes):
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    areas = (np.cross(b - a, c - a) * unit(planes)[mesh.planes, :3]).sum(axis=1) / 2
    assert areas.min() > -1e-12 * areas.max()  # every triangle faces outward
    return np.bincount(mesh.planes, areas.astype(float), minlength=len(planes))


def open_edges(mesh):
    """Vertices of the edges that only one triangle has."""
    corners = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edges, counts = np.unique(corners, axis=0, return_counts=True)
    assert counts.max() <= 2
    return mesh.vertices[edges[counts == 1]]


def check_mesh(mesh, planes, tolerance=1e-12):
    """Every plane with a face has triangles, which lie on it; nothing is outside; what no box cuts is closed."""
    facts = polyhedron_facts([planes])[0]
    assert set(mesh.planes) | set(mesh.outside) == set(facts.kept)
    rows = unit(planes).astype(float)
    reach = np.abs(mesh.vertices).max()
    assert (mesh.vertices @ rows[:, :3].T + rows[:, 3]).max() <= tolerance * reach
    own = rows[mesh.planes]
    assert np.abs((mesh.vertices[mesh.triangles] * own[:, None, :3]).sum(axis=2) + own[:, None, 3]).max() <= (
        tolerance * reach
    )
    if facts.bounded and max(map(abs, (*facts.low, *facts.high))) <= BOX.high[0]:
        shape = mesh.to_trimesh()
        assert shape.is_watertight
        assert shape.is_winding_consistent
        assert shape.euler_number == 2


# ---- Closed forms ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("planes", "expected", "vertices", "triangles"),
    [
        (CUBE, 8, 8, 12),
        (OCTAHEDRON, 4 / 3, 6, 8),
        # Volume over the inscribed ball's radius cubed; that radius is 1 over the length of the normals.
        (DODECAHEDRON, 10 * math.sqrt(130 - 58 * math.sqrt(5)) * (1 + GOLDEN**2) ** -1.5, 20, 36),
        ([*prism(500), *CUBE[4:]], 2 * 500 * math.tan(math.pi / 500), 1000, 1996),
    ],
)
@pytest.mark.parametrize("seed", [None, 1])
def test_volumes(planes, expected, vertices, triangles, seed):
    planes = planes if seed is None else moved(planes, seed, 3.0)
    mesh = polyhedron_mesh(planes, BOX)
    check_mesh(mesh, planes)
    assert volume(mesh) == pytest.approx(expected, rel=1e-12)
    assert (len(mesh.vertices), len(mesh.triangles), mesh.method) == (vertices, triangles, "hull")


def test_many_planes_meet_in_a_point():
    planes = [*((x, y, 1.0, -1.0) for x, y, _, _ in prism(300)), (0, 0, -1, 0)]
    mesh = polyhedron_mesh(planes, BOX)
    check_mesh(mesh, planes)
    assert len(mesh.vertices) == 301
    assert volume(mesh) == pytest.approx(300 * math.tan(math.pi / 300) / 3, rel=1e-12)


def test_gem():
    planes = sphere_planes(2000)
    mesh = polyhedron_mesh(planes, BOX)
    check_mesh(mesh, planes)
    assert mesh.method == "hull"
    areas = [face.area for face in polyhedron_faces(planes)]
    assert plane_areas(mesh, planes) == pytest.approx(areas, rel=1e-9, abs=1e-15)
    assert volume(mesh) == pytest.approx(sum(areas) / 3, rel=1e-12)  # around a unit ball


def test_repeated_and_touching_planes_have_no_triangles():
    planes = [(1, 1, 1, -3), (3, 0, 0, -3), *CUBE, (1, 1, 0, -2)]
    mesh = polyhedron_mesh(planes, BOX)
    check_mesh(mesh, planes)
    assert Counter(mesh.planes.tolist()) == {1: 2, 3: 2, 4: 2, 5: 2, 6: 2, 7: 2}


# ---- Slivers ---------------------------------------------------------------------------------------------------------


def wedge(s):
    return [(0, -1, 0, 0), (-s, 1, 0, 0), (1, 0, 0, -1), (0, 0, 1, -1), (0, 0, -1, -1)], s


def slab(s):
    return [(0, 1, 0, -s), (0, -1, 0, 0), *CUBE[:2], *CUBE[4:]], 4 * s


def needle(s):
    return [*((x, y, z, -s) for x, y, z, _ in CUBE[:4]), *CUBE[4:]], 8 * s * s


def spike(s):
    return [(1, 0, -s, 0), (-1, 0, -s, 0), (0, 1, -s, 0), (0, -1, -s, 0), (0, 0, 1, -1)], 4 * s * s / 3


def cut_corner(s):
    return [*CUBE, (1, 1, 1, s - 3)], 8 - s**3 / 6


def bent_face(s):
    return [*CUBE, (1, s, 0, -1)], 8 - s


@pytest.mark.parametrize("body", [wedge, slab, needle, spike, cut_corner, bent_face])
@pytest.mark.parametrize("thickness", [1.0, 1e-3, 1e-6, 1e-9, 1e-12])
def test_slivers(body, thickness):
    planes, expected = body(thickness)
    mesh = polyhedron_mesh(planes, BOX)
    check_mesh(mesh, planes)
    assert volume(mesh) == pytest.approx(expected, rel=1e-12)
    for seed in (1, 2):
        turned = moved(planes, seed)
        check_mesh(polyhedron_mesh(turned, BOX), turned)


def test_polygons_step_in_for_the_hull():
    """Manifold's hull drops what is nearer than 1e-7 of the size."""
    planes, _ = cut_corner(1e-8)
    mesh = polyhedron_mesh(planes, BOX)
    assert mesh.method == "polygons"
    assert np.count_nonzero(mesh.planes == 6) == 1


@pytest.mark.parametrize("tilt", [1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
def test_planes_that_nearly_repeat_others(tilt):
    rng = np.random.default_rng(5)
    for seed in range(10):
        planes = sphere_planes(12, seed)
        planes += [(*(np.array(plane[:3]) + tilt * rng.normal(size=3)).tolist(), -1.0) for plane in planes[:3]]
        planes = moved(planes, seed, 3.0)
        check_mesh(polyhedron_mesh(planes, BOX), planes)


@pytest.mark.parametrize("tilt", [1e-14, 1e-12, 1e-10, 1e-8, 1e-7, 1e-6])
def test_faces_of_planes_that_lean_against_one_another(tilt):
    """Of what float32 does not tell apart one plane does for all, and the mesh has its number."""
    normals = [np.roll((a, b, 0.0), axis) for a in (1, -1) for b in (tilt, -tilt) for axis in range(3)]
    planes = [(*normal.tolist(), -1.0) for normal in normals] + [(*n[::-1].tolist(), -1.0) for n in normals]
    mesh = polyhedron_mesh(planes, BOX)
    assert mesh.to_trimesh().is_watertight
    assert volume(mesh) == pytest.approx(8, rel=1e-5)
    assert mesh.deviation < 1e-6
    # Each triangle lies on the plane that it names.
    normal = unit(planes)[mesh.planes].astype(float)
    corners = mesh.vertices[mesh.triangles]
    assert np.abs(np.einsum("mik,mk->mi", corners, normal[:, :3]) + normal[:, 3:]).max() < 1e-6


# ---- Any body --------------------------------------------------------------------------------------------------------


@st.composite
def bodies(draw):
    """Half-spaces around a point, some of which touch, repeat or nearly repeat others."""
    seed = draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    kind = draw(st.sampled_from(["ball", "integers", "pairs"]))
    count = draw(st.integers(1, 40))
    if kind == "integers":
        normals = rng.integers(-2, 3, size=(count, 3)).astype(float)
        normals = normals[np.any(normals != 0, axis=1)]
        planes = [(*normal, -float(rng.integers(1, 4))) for normal in normals.tolist()]
        return planes or CUBE
    planes = [(*normal, -1.0) for (normal,) in zip(np.reshape(sphere_planes(count, seed), (-1, 4))[:, :3].tolist())]
    if kind == "pairs":
        tilt = 10 ** rng.uniform(-9, -1)
        planes += [(*(np.array(p[:3]) + tilt * rng.normal(size=3)).tolist(), -1.0) for p in planes[: count // 3]]
    return moved(planes, seed, draw(st.sampled_from([0.0, 1.0, 30.0])))


@settings(max_examples=60, deadline=None)
@given(bodies())
def test_every_plane_has_its_face(planes):
    check_mesh(polyhedron_mesh(planes, BOX), planes)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.randoms(use_true_random=False))
def test_order_and_length_of_normals_do_not_matter(seed, random):
    planes = sphere_planes(30, seed)
    mesh = polyhedron_mesh(planes, BOX)
    order = random.sample(range(30), 30)
    lengths = [10 ** random.uniform(-9, 9) for _ in order]
    other = polyhedron_mesh([tuple(r * x for x in planes[k]) for r, k in zip(lengths, order, strict=True)], BOX)
    assert volume(other) == pytest.approx(volume(mesh), rel=1e-9)
    areas = plane_areas(mesh, planes)
    assert plane_areas(other, [planes[k] for k in order]) == pytest.approx(areas[order], rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("planes", "vertices", "triangles"),
    [
        ([(0, 1, 0, 0)], 4, 2),
        ([(0, 1, 0, 0), (0, -1, 0, -1)], 8, 4),
        (CUBE[:4], 8, 8),
        (CUBE[:5], 8, 10),
        ([(0, 1, 0, 0), (1, 0, 0, 0)], 6, 4),
    ],
)
def test_unbounded_ones_lack_only_the_box(planes, vertices, triangles):
    mesh = polyhedron_mesh(planes, BOX)
    check_mesh(mesh, planes)
    assert (len(mesh.vertices), len(mesh.triangles)) == (vertices, triangles)
    edges = open_edges(mesh)
    on_box = (edges == BOX.low) | (edges == BOX.high)
    assert np.all(np.any(on_box.all(axis=1), axis=1))  # both ends on one side of the box
    assert np.abs(mesh.vertices).max() == 100


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6))
def test_unbounded_ones_are_cut_at_the_box(seed):
    planes = moved(sphere_planes(8, seed)[:4], seed, 1.0)
    mesh = polyhedron_mesh(planes, BOX)
    check_mesh(mesh, planes)
    assert np.all((mesh.vertices >= BOX.low) & (mesh.vertices <= BOX.high))
    edges = open_edges(mesh)
    assert np.all(np.any((np.abs(edges) == 100).all(axis=1), axis=1))


def test_outside_of_the_box():
    column = [*CUBE[:4], (0, 0, 1, -1), (0, 0, -1, -1e4)]
    mesh = polyhedron_mesh(column, BOX)
    assert mesh.outside == (5,)
    assert set(mesh.planes) == {0, 1, 2, 3, 4}
    assert mesh.vertices.min() == -100
    far = polyhedron_mesh([(0, 1, 0, 1e4)], BOX)
    assert len(far.triangles) == 2
    assert np.all(far.vertices[:, 1] == -1e4)


def test_deviation_is_what_float32_makes_of_it():
    planes = moved(CUBE, 5, 30.0)
    mesh = polyhedron_mesh(planes, BOX)
    rounded = mesh.vertices.astype(np.float32).astype(float)
    rows = unit(planes)
    distances = np.abs(rounded[mesh.triangles] @ rows[:, :3].T + rows[:, 3])
    assert mesh.deviation == pytest.approx(max(distances[t, :, k].max() for t, k in enumerate(mesh.planes)), rel=1e-6)
    assert 0 < mesh.deviation < 2**-24 * np.abs(mesh.vertices).max() * math.sqrt(3)
    assert polyhedron_mesh(CUBE, BOX).deviation == 0


def test_no_volume():
    with pytest.raises(MeshError, match="object 7: planes 2 and 6 leave no volume"):
        polyhedron_mesh([*CUBE, (0, -1, 0, 3)], BOX, "object 7")


# ---- Files -----------------------------------------------------------------------------------------------------------


def test_mitsuba_reads_what_is_written(mi, tmp_path):
    """The same vertices, rounded to float32, and the same triangles in the same order as the mesh in memory."""
    mesh = polyhedron_mesh(moved(sphere_planes(100), 1, 20.0), BOX)
    write_ply(mesh, tmp_path / "gem.ply")
    shape = mi.load_dict({"type": "ply", "filename": str(tmp_path / "gem.ply"), "face_normals": True})
    read = mi.traverse(shape)
    assert np.array_equal(np.array(read["vertex_positions"]), mesh.vertices.astype(np.float32).ravel())
    assert np.array_equal(np.array(read["faces"]), mesh.triangles.ravel())
    assert shape.has_face_normals()


# ---- How much is needed ----------------------------------------------------------------------------------------------

DULL = (Finish(1, 0, 0, 1, 0, 0, 0),)
FLOOR = Object(0, 0, Polyhedron(((0.0, 1.0, 0.0, 0.0),)))


def scene_of(*objects, eye=(0.0, 2.0, 10.0), finishes=DULL, lights=()):
    camera = Camera(eye, (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), 40.0)
    return Scene(camera, (1.0, 1.0, 1.0), lights, (Solid((1.0, 1.0, 1.0)),), finishes, objects)


def test_the_horizon_is_within_an_eighth_of_a_pixel():
    scene = scene_of(FLOOR)
    settings = Settings(width=300, height=200)
    box = scene_bounds(scene, settings)
    pixel = 2 * math.tan(math.radians(20)) / 200
    reach = 2 / (pixel / 8)  # where a ray that far below the horizon, in the middle of the picture, meets the floor
    assert reach < -box.low[2] < 2 * reach
    assert reach < box.high[0] < 2 * reach
    finer = scene_bounds(scene, replace(settings, width=600, height=400))
    assert finer.high[0] == pytest.approx(2 * box.high[0], rel=1e-3)


def test_an_opaque_ball_around_everything_ends_the_scene():
    sky = Object(0, 0, Sphere((1.0, 0.0, 0.0), 50.0))
    assert scene_bounds(scene_of(FLOOR, sky)) == Box((-50.0, -51.0, -51.0), (52.0, 51.0, 51.0))
    glass = Finish(1, 0, 0, 1, 0, 0.5, 1.5)
    assert scene_bounds(scene_of(FLOOR, sky, finishes=(glass,))).high[0] > 1000
    assert scene_bounds(scene_of(FLOOR, sky, eye=(0.0, 2.0, 60.0))).high[0] > 1000


def test_a_room_ends_the_scene():
    room = Object(0, 0, Polyhedron(tuple((a, b, c, 20.0 * d) for a, b, c, d in CUBE)))
    assert scene_bounds(scene_of(FLOOR, room)) == Box((-20.4,) * 3, (20.4,) * 3)


def test_reflected_rays_start_elsewhere():
    mirror = Finish(0, 0, 0, 1, 0.5, 0, 0)
    ball = Object(0, 0, Sphere((0.0, 30.0, 0.0), 1.0))
    assert (
        scene_bounds(scene_of(FLOOR, ball, finishes=(mirror,))).high[0]
        > 5 * scene_bounds(scene_of(FLOOR, ball)).high[0]
    )


def test_bounded_ones_need_no_horizon():
    block = Object(0, 0, Polyhedron(tuple(CUBE)))
    box = scene_bounds(scene_of(block))
    assert 10 < max(box.high) < 25
    lit = scene_bounds(scene_of(block, lights=(Light((0.0, 500.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 0.0)),)))
    assert 500 < lit.high[1] < 510


@pytest.mark.parametrize("planes", [CUBE, [(0, 1, 0, 0)], [(0, 1e-3, 0, 1e3)], prism(7), moved(prism(7), 1)])
def test_every_face_of_a_scene_gets_triangles(planes):
    polyhedron = Polyhedron(tuple(tuple(map(float, p)) for p in planes))
    bounds = scene_bounds(scene_of(Object(0, 0, polyhedron)))
    mesh = polyhedron_mesh(planes, bounds)
    assert mesh.outside == ()
    check_mesh(mesh, planes)
