"""Meshes of quadrics: as fine as a picture needs, on the surface, and all of it."""

import math

import numpy as np
import pytest
from quadrics import SURFACES, quadric, substituted

from converter.scene.parser import parse_scene
from converter.scene.settings import Settings
from converter.shapes import quadric as kind
from converter.shapes.quadric_frame import frame_of
from converter.to_mitsuba.bounds import Box
from converter.to_mitsuba.meshes.mesh import MeshError
from converter.to_mitsuba.meshes.quadrics import (
    COARSER,
    FAR,
    MOST_TRIANGLES,
    OFF,
    View,
    most_triangles,
    quadric_mesh,
    quadric_solid,
)
from converter.to_mitsuba.surfaces import shapes

TURNED = {
    name: quadric(substituted(numbers, ((3, 1, 0), (-1, 2, 1), (0, 1, 4)), (2, -1, 5)))
    for name, numbers in SURFACES.items()
}
EVERY = pytest.mark.parametrize("shape", TURNED.values(), ids=TURNED.keys())
BOUNDS = Box((-40.0, -30.0, -50.0), (30.0, 40.0, 60.0))
VIEW = View((4.0, 5.0, -9.0), 1.0, 1 / 400)
RANDOM = np.random.default_rng(3)


def mesh_of(shape, bounds=BOUNDS, view=VIEW):
    return quadric_mesh(shape, bounds, view)


@EVERY
def test_vertices_are_on_the_surface_and_normals_are_its_own(shape):
    mesh, frame = mesh_of(shape), frame_of(shape)
    y = frame.of(mesh.vertices)
    gradient = frame.half_gradient(y)
    size = np.linalg.norm(gradient, axis=1)
    somewhere = size > 1e-6 * size.max()  # not a tip, or where planes cross
    off = np.abs(frame.at(y))[somewhere] / (2 * size[somewhere])
    assert off.max() < 1e-12 * np.abs(mesh.vertices).max()
    outward = (gradient / np.maximum(size, 1e-300)[:, None]) @ frame.axes.T
    np.testing.assert_allclose(mesh.normals[somewhere], outward[somewhere], atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-12)


@EVERY
def test_triangles_face_outward(shape):
    mesh = mesh_of(shape)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    length = np.linalg.norm(across, axis=1)
    for corner in mesh.triangles.T:
        assert np.all((across * mesh.normals[corner]).sum(axis=1)[length > 0] > 0)


def crossings(mesh, origin, direction):
    """Where a line meets the triangles (Moeller and Trumbore)."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    p = np.cross(direction, c - a)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverse = 1 / ((b - a) * p).sum(axis=1)
        u = ((origin - a) * p).sum(axis=1) * inverse
        q = np.cross(origin - a, b - a)
        v = (q @ direction) * inverse
        t = ((c - a) * q).sum(axis=1) * inverse
        return np.sort(t[(u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)])


@EVERY
def test_lines_cross_the_mesh_where_they_cross_the_surface(shape):
    """As far as the bounds go, and nowhere else."""
    mesh, middle = mesh_of(shape), frame_of(shape).origin
    counted = 0
    spread = np.linalg.norm(frame_of(shape).semi_axes) or 4.0
    for target in middle + RANDOM.normal(size=(40, 3)) * spread / 2:
        direction = (target - VIEW.eye) / np.linalg.norm(target - VIEW.eye)
        exact = [c for c in kind.intersections(shape, np.array(VIEW.eye), direction) if c.cosine]
        met = crossings(mesh, np.array(VIEW.eye), direction)
        for t, cosine in exact:
            place = VIEW.eye + t * direction
            if abs(cosine) > 0.1 and np.all(place > BOUNDS.low) and np.all(place < BOUNDS.high):
                counted += 1
                off = OFF * VIEW.pixel * max(abs(t), VIEW.near)
                assert np.abs(met - t).min(initial=math.inf) < 3 * off / abs(cosine)
        for t in met:
            assert kind.surface_margin(shape, VIEW.eye + t * direction, False) < 3 * OFF * VIEW.pixel * max(abs(t), 1)
    assert counted > 5


@EVERY
def test_triangles_are_as_fine_as_a_pixel_asks_for_and_not_much_finer(shape):
    fine, coarse = mesh_of(shape), mesh_of(shape, view=VIEW._replace(pixel=4 * VIEW.pixel))
    frame = frame_of(shape)
    middle = fine.vertices[fine.triangles].mean(axis=1)
    distance = np.maximum(np.linalg.norm(middle - VIEW.eye, axis=1), VIEW.near)
    allowed = OFF * VIEW.pixel * distance * np.clip(distance / (FAR * VIEW.near), 1, COARSER)
    y = frame.of(middle)
    slope = np.linalg.norm(frame.half_gradient(y), axis=1)
    off = np.abs(frame.at(y)) / (2 * np.maximum(slope, 1e-300))
    away = slope > 1e-2 * slope.max()
    assert (off / allowed)[away].max() < 3
    # Errors shrink with the square of the size, so that triangles are about inversely as many.
    if not any(flat in kind.classified(shape) for flat in ("planes", "half", "cylinder")):
        assert 1.5 < len(fine.triangles) / len(coarse.triangles) < 6
    assert fine.deviation < OFF * VIEW.pixel * 40


@pytest.mark.parametrize("axes", [(1, 1, 1), (1, 2, 3), (1, 100, 1), (0.01, 1, 1)])
def test_an_ellipsoid_is_closed_and_has_its_volume(axes):
    a, b, c = axes
    shape = quadric((1 / a**2, 1 / b**2, 1 / c**2, 0, 0, 0, 0, 0, 0, -1))
    mesh = mesh_of(shape, Box((-200.0,) * 3, (200.0,) * 3)).to_trimesh()
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(4 / 3 * math.pi * a * b * c, rel=0.02 if a == 1 else 0.2)
    outside = mesh_of(quadric(-x for x in shape.coefficients), Box((-200.0,) * 3, (200.0,) * 3)).to_trimesh()
    assert outside.volume == pytest.approx(-mesh.volume, rel=1e-3)


@EVERY
def test_a_solid_is_closed_and_its_part_of_a_box_has_the_volume(shape):
    from manifold3d import Error, Manifold, Mesh64

    low, high = np.array((-3.0, -4.0, -5.0)), np.array((5.0, 4.0, 3.0))
    solid = quadric_solid(shape, Box(tuple(low), tuple(high)), VIEW._replace(pixel=1 / 100))
    body = Manifold(Mesh64(solid.vertices, solid.triangles.astype(np.uint64)))
    assert body.status() == Error.NoError and body.volume() > 0
    box = Manifold.cube(high - low).translate(low)
    part = box - body if solid.complement else box ^ body
    assert part.status() == Error.NoError
    grid = np.stack(np.meshgrid(*(np.linspace(a, b, 81)[:-1] + (b - a) / 160 for a, b in zip(low, high, strict=True))))
    frame = frame_of(shape)
    share = (frame.at(frame.of(grid.reshape(3, -1).T)) < 0).mean()
    assert part.volume() / box.volume() == pytest.approx(share, abs=2e-3)
    a, b, c = (solid.vertices[solid.triangles[solid.surface, k]] for k in range(3))
    middle = frame.of((a + b + c) / 3)
    facing = (np.cross(b - a, c - a) @ frame.axes * frame.half_gradient(middle)).sum(axis=1)
    assert ((facing < 0) if solid.complement else (facing > 0)).mean() > 0.999


def test_what_is_out_of_sight_has_triangles_nevertheless():
    assert len(mesh_of(quadric((1, 1, 0, 0, 0, 0, -2000, 0, 0, 999999))).triangles) > 0


@pytest.mark.parametrize("numbers", [(1e-90, 1e-90, 0, 0, 0, 0, 0, 0, 0, -1), (1, 1, 1, 0, 0, 0, 1e60, 0, 0, 0)])
def test_what_single_precision_does_not_hold_is_told(numbers):
    with pytest.raises(MeshError, match="object 3: single precision"):
        quadric_mesh(quadric(numbers), BOUNDS, VIEW, "object 3")


def test_shapes_of_a_scene_have_the_pictures_fineness():
    scene = parse_scene("0 0 -9 0 0 0 0 1 0 40 1 0 0 0 1 1 1 1 0 0 1 solid 1 1 1 1 .2 .8 0 1 0 0 0 1 "
                        "0 0 quadric 1 2 3 0 0 0 0 0 0 -1")  # fmt: skip
    counts = []
    for height in (75, 300, 1200):
        elements, told = shapes(scene, Settings(width=height, height=height))
        counts.append(len(elements["object_0"]["mesh"].triangles))
        assert told["object_0"]["deviation"] < 10 / height
    assert counts[0] < counts[1] < counts[2] < 40 * counts[0]


def test_small_pictures_have_small_meshes():
    """Through a lens for which a million triangles are too few."""
    shape = quadric((1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0))
    few, more = (len(mesh_of(shape, view=View((0.0, 0.0, 4.0), 1.0, 1e-9, most)).triangles) for most in (1000, 8000))
    assert 1000 <= few <= 4000
    assert 8000 <= more <= 32000
    assert most_triangles(48 * 36) < most_triangles(320 * 240) < most_triangles(800 * 600) == MOST_TRIANGLES
