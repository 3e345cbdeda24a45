"""Meshes of csgs: closed, of the right volume, with the normals of the exact surfaces, and without films."""

import math

import numpy as np
import pytest
from csgs import BALL, CUBE, CYLINDER, FAR, RIGHT, box, csg, half_space, is_inside, random_csg

from converter.scene.model import Polyhedron, Quadric, Sphere
from converter.shapes.csg_program import program_of
from converter.to_mitsuba.bounds import Box
from converter.to_mitsuba.meshes.csg import csg_mesh
from converter.to_mitsuba.meshes.quadrics import View

BOUNDS = Box((-9.0,) * 3, (9.0,) * 3)
VIEW = View((4.0, 5.0, -9.0), 4.0, 1 / 400)
SMALL = Sphere((0.0, 0.0, 0.0), 0.5)
OUTSIDE = Quadric((-1.0, -1.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))
"""All but an ellipsoid."""


FINE = VIEW._replace(pixel=1 / 2000)


def mesh_of(shape, view=VIEW):
    return csg_mesh(program_of(shape), BOUNDS, view)


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


LENS = 2 * math.pi * 0.5**2 * (3 - 0.5) / 3  # two caps of height 1/2
TURNED = [(4, 0, 3), (0, 1, 0), (-3, 0, 4)]


def block(low, high, *factors):
    """A turned box, its planes with various factors."""
    planes = []
    for (a, b, c), p, q, f in zip(TURNED, low, high, factors, strict=True):
        length = math.hypot(a, b, c)
        planes += [(f * a, f * b, f * c, -f * length * q), (-a, -b, -c, length * p)]
    return Polyhedron(tuple(planes))


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        (csg("+", BALL, "&", Sphere((1.0, 0.0, 0.0), 1.0)), LENS),
        (csg("+", BALL, "+", Sphere((1.0, 0.0, 0.0), 1.0)), 8 * math.pi / 3 - LENS),
        (csg("+", BALL, "-", SMALL), 4 * math.pi / 3 * 7 / 8),
        (csg("+", CUBE, "-", CYLINDER), 8 - math.pi / 2),
        (csg("+", CYLINDER, "&", CUBE), math.pi / 2),
        (csg("+", CUBE, "&", OUTSIDE), 8 - 4 * math.pi / 3 / math.sqrt(2)),
        (csg("+", CUBE, "-", OUTSIDE), 4 * math.pi / 3 / math.sqrt(2)),
        (csg("+", CUBE, "-", csg("+", half_space(1, 1, 1, 0), "+", OUTSIDE)), 2 * math.pi / 3 / math.sqrt(2)),
        (csg("+", BALL, "+", FAR), 8 * math.pi / 3),
    ],
)
def test_volume(shape, expected):
    assert volume(mesh_of(shape, FINE)) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        (csg("+", block((0, 0, 0), (1, 1, 1), 1, 1, 1), "-", block((0.5, 0, 0), (1, 1, 1), 3, 7, 0.1)), 0.5),
        (csg("+", block((0, 0, 0), (1, 1, 1), 1, 1, 1), "+", block((1, 0, 0), (2, 1, 1), 3, 7, 0.1)), 2),
        (csg("+", block((0, 0, 0), (1, 1, 1), 1, 1, 1), "&", block((1, 0, 0), (2, 1, 1), 3, 7, 0.1), "+", BALL),
         4 * math.pi / 3),
        (csg("+", BALL, "-", csg("+", BALL, "&", block((0, -2, -2), (2, 2, 2), 1, 1, 1))), 2 * math.pi / 3),
    ],
)  # fmt: skip
def test_no_film_is_left_where_surfaces_coincide(shape, expected):
    assert volume(mesh_of(shape, FINE)) == pytest.approx(expected, rel=2e-3)
    mesh = mesh_of(shape)
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    across = mesh.normals[mesh.triangles].mean(axis=1)
    for middle, normal in zip(middles[::29], across[::29], strict=True):
        sides = [is_inside(shape, tuple((middle + s * 2e-3 * normal).tolist())) for s in (-1, 1)]
        assert sides == [True, False] or _near_another(shape, middle)


def _near_another(shape, middle):
    """Whether both sides of a triangle are not what they are a little farther in: at a rim."""
    away = np.random.default_rng(0).normal(size=(40, 3)) * 4e-3
    return len({is_inside(shape, tuple(p)) for p in (middle + away).tolist()}) == 2


@pytest.mark.parametrize("seed", [1, 7, 10, 13, 15, 22])
def test_triangles_lie_on_the_surface(seed):
    shape = random_csg(seed)
    mesh = mesh_of(shape)
    middles = mesh.vertices[mesh.triangles].mean(axis=1)
    areas = np.linalg.norm(
        np.cross(*(mesh.vertices[mesh.triangles[:, k]] - mesh.vertices[mesh.triangles[:, 0]] for k in (1, 2))), axis=1
    )
    across = mesh.normals[mesh.triangles].mean(axis=1)
    wrong = 0.0
    for middle, normal, area in zip(middles[::29], across[::29], areas[::29], strict=True):
        sides = [is_inside(shape, tuple((middle + s * 5e-3 * normal).tolist())) for s in (-1, 1)]
        wrong += area * (sides != [True, False])
    assert wrong < 0.03 * areas[::29].sum()  # near rims


def test_normals_are_those_of_the_surface_and_point_out():
    mesh = mesh_of(csg("+", CUBE, "-", SMALL))
    on_ball = np.isclose(np.linalg.norm(mesh.vertices, axis=1), 0.5, atol=1e-6)
    np.testing.assert_allclose(mesh.normals[on_ball], -mesh.vertices[on_ball] / 0.5, atol=1e-6)
    np.testing.assert_allclose(np.abs(mesh.normals[~on_ball]).max(axis=1), 1.0)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0)


def test_what_has_no_bounds_is_open_beyond_them():
    mesh = mesh_of(csg("+", half_space(0, 1, 0, 0), "-", CYLINDER))
    assert np.ptp(mesh.vertices[:, 0]) >= 18 and np.ptp(mesh.vertices[:, 2]) >= 18
    assert mesh.vertices[:, 1].max() < 1e-9
    assert not np.any(np.isclose(mesh.vertices[mesh.triangles][:, :, 0].min(axis=1), 27))


def test_a_finer_picture_asks_for_more_triangles():
    shape = program_of(csg("+", BALL, "-", RIGHT))
    coarse, fine = (csg_mesh(shape, BOUNDS, VIEW._replace(pixel=pixel)) for pixel in (1 / 50, 1 / 1000))
    assert len(fine.triangles) > 4 * len(coarse.triangles)
    assert fine.deviation < coarse.deviation / 4


def test_far_from_the_origin():
    far = 1e6
    shape = csg("+", Sphere((far, far, 0.0), 1.0), "-", box((far, far - 2, -2), (far + 2, far + 2, 2)))
    mesh = csg_mesh(
        program_of(shape), Box((far - 9,) * 2 + (-9.0,), (far + 9,) * 2 + (9.0,)), FINE._replace(eye=(far, far, 9.0))
    )
    mesh.vertices[:] -= (far, far, 0)
    assert volume(mesh) == pytest.approx(2 * math.pi / 3, rel=2e-3)
