"""The mesh of a polyhedron: what of it is inside a box, and which of two methods gives it."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from operator import le, mul, sub

import numpy as np

from converter.to_mitsuba.bounds import LARGEST, Box
from converter.to_mitsuba.meshes.mesh import Long, MeshError, Method, PolyhedronMesh, listed
from converter.to_mitsuba.meshes.neighborhoods import edges_of, hull_rings, points_of, polygon_rings
from converter.to_mitsuba.meshes.triangles import mesh_of, plate_mesh
from native_tracer.halfspaces import Face, HalfSpace, PolyhedronFacts, polyhedron_faces, polyhedron_facts

METHODS: tuple[Method, Method] = ("hull", "polygons")
SMALLEST = 2.0**-126
"""Below this float32 numbers lose digits."""
NEAR = 2.0**-21
"""Planes whose unit normals differ by no more than this, and whose offsets by no more as a share of the largest, nearly
coincide: a few roundings of float32."""


@np.errstate(over="ignore", invalid="ignore")  # numbers may be as large as they like
def polyhedron_mesh(planes: Sequence[HalfSpace], bounds: Box, name: str = "polyhedron") -> PolyhedronMesh:
    """Make a mesh of an intersection of half-spaces.

    What reaches out of `bounds` is cut off there, and the mesh left open: the box is not in the scene. Only what lies
    outside altogether is given a larger box, since Mitsuba takes no mesh without triangles. A plate without thickness
    is one polygon, which has two sides: that of its first plane.

    Args:
        planes: (n, 4), half-spaces a x + b y + c z + d <= 0.
        bounds: a box that holds all that can be seen.
        name: what messages call the polyhedron.

    Raises:
        MeshError: there is neither a volume nor a face, no method gives a closed surface, or float32 numbers do
            not hold it.

    """
    try:
        return _whole_mesh(planes, bounds, name)
    except MeshError:
        # Where planes nearly coincide, corners are nowhere in particular; float32 does not tell such planes apart.
        distinct = _distinct(planes)
        if len(distinct) == len(planes):
            raise
        mesh = _whole_mesh([planes[k] for k in distinct], bounds, name)
        outside = tuple(distinct[k] for k in mesh.outside)
        return replace(mesh, planes=np.array(distinct, dtype=np.int32)[mesh.planes], outside=outside)


def _distinct(planes: Sequence[HalfSpace]) -> list[int]:
    """The planes but those that nearly coincide with an earlier one."""
    unit = _unit_planes([tuple(map(float, plane)) for plane in planes]).astype(np.float64)
    allowed = NEAR * np.array([1.0, 1.0, 1.0, np.abs(unit[:, 3]).max()])
    # In a grid of cells of that size, the cell of each plane and those around it have all that are so near.
    cells = np.floor(np.divide(unit, allowed, out=np.zeros_like(unit), where=allowed > 0)).astype(np.int64)
    strides = [int(4 / NEAR) ** axis for axis in range(4)]
    around = [sum(map(mul, steps, strides)) for steps in product((0, -1, 1), repeat=4)]
    found: dict[int, list[int]] = {}
    result: list[int] = []
    rows, limits = unit.tolist(), allowed.tolist()
    for k, (row, cell) in enumerate(zip(rows, cells.tolist(), strict=True)):
        place = sum(map(mul, cell, strides))
        near = (rows[other] for step in around for other in found.get(place + step, ()))
        if not any(all(map(le, map(abs, map(sub, row, other)), limits)) for other in near):
            found.setdefault(place, []).append(k)
            result.append(k)
    return result


def _whole_mesh(planes: Sequence[HalfSpace], bounds: Box, name: str) -> PolyhedronMesh:
    """The mesh with a face for each plane that has one."""
    body = [tuple(map(float, plane)) for plane in planes]
    closed, faces = body, polyhedron_faces(body)
    kept: Sequence[int] = [k for k, face in enumerate(faces) if face.neighbors]
    if not _fit(faces, bounds):
        facts = polyhedron_facts([body])[0]
        if not facts.drawn:
            raise MeshError(f"{name}: planes {listed(facts.conflict)} leave no volume")
        kept = facts.plate[:1] or facts.kept
        for box in (bounds, _enlarged(bounds, facts)):
            closed = body + _box_planes(box)
            faces = polyhedron_faces(closed)
            if faces and any(faces[k].neighbors for k in kept):
                break
        if kept and not faces:
            raise MeshError(f"{name}: what is left of it inside of the bounds has no volume")
    size = max((abs(x) for face in faces for x in face.points), default=1.0)
    if not SMALLEST < size < 4 * LARGEST:
        raise MeshError(f"{name}: single precision, of which meshes are, has no numbers for a size of {size:.3g}")
    unit = _unit_planes(closed)
    if len(only := [k for k, face in enumerate(faces) if face.neighbors]) == 1:
        return plate_mesh(unit, only[0], faces[only[0]])
    edges = edges_of(faces)
    problems = []
    for method in METHODS:
        try:
            rings = hull_rings(unit, faces, edges) if method == "hull" else polygon_rings(faces, edges)
            mesh = mesh_of(unit, rings, len(planes), faces, method)
            return replace(mesh, outside=tuple(k for k in kept if not faces[k].neighbors))
        except MeshError as error:
            problems.append(f"{error} (by {method})")
    raise MeshError(f"{name}: " + "; ".join(problems))


def _unit_planes(planes: Sequence[Sequence[float]]) -> Long:
    rows = np.reshape(np.array(planes, dtype=np.longdouble), (-1, 4))
    unit: Long = rows / np.sqrt((rows[:, :3] ** 2).sum(axis=1))[:, None]
    return unit


def _fit(faces: Sequence[Face], box: Box) -> bool:
    """Whether there are faces, all inside the box."""
    points = np.concatenate([np.empty((0, 3)), *map(points_of, faces)])
    return len(points) > 0 and bool(np.all((points >= box.low) & (points <= box.high)))


def _enlarged(box: Box, facts: PolyhedronFacts) -> Box:
    """A box that also holds the vertices of a polyhedron, with room to spare."""
    low, high = np.minimum(box.low, facts.low), np.maximum(box.high, facts.high)
    room = (high - low).max()
    return Box.of(low - room, high + room)


def _box_planes(box: Box) -> list[tuple[float, ...]]:
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    low = ((-x, -y, -z, at) for (x, y, z), at in zip(axes, box.low, strict=True))
    return [*low, *((*axis, -at) for axis, at in zip(axes, box.high, strict=True))]
