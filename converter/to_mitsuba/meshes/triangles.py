"""From which faces border on which to triangles."""

from collections.abc import Sequence
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from converter.to_mitsuba.meshes.mesh import Floats, Long, MeshError, Method, PolyhedronMesh, Ring, listed
from converter.to_mitsuba.meshes.neighborhoods import points_of
from native_tracer.halfspaces import Face

OFF = 2.0**-44
"""How far a vertex may be from the planes of its faces, as a share of the body's distance from the origin: it is
computed to about 2^-53 of that, and moved by a `HAIR` at most."""


def mesh_of(planes: Long, rings: dict[int, Ring], count: int, faces: Sequence[Face], method: Method) -> PolyhedronMesh:
    """The faces of the first `count` planes as triangles; the rest are the box's.

    Raises:
        MeshError: the rings close no surface, or not that of the polyhedron.

    """
    vertices, corners = _vertices(rings, faces)
    _check_convex(planes, rings, vertices, corners)
    triangles: list[list[int]] = []
    owners: list[int] = []
    for k, ring in corners.items():
        if k < count:
            face = _triangulated(ring)
            triangles += face
            owners += [k] * len(face)
    return _from_triangles(planes, vertices, triangles, owners, method)


def plate_mesh(planes: Long, plane: int, face: Face) -> PolyhedronMesh:
    """The only face of a plate."""
    triangles = _triangulated(list(range(len(face.neighbors))))
    return _from_triangles(planes, points_of(face), triangles, [plane] * len(triangles), "polygons")


def _from_triangles(
    planes: Long, vertices: Floats, triangles: list[list[int]], owners: list[int], method: Method
) -> PolyhedronMesh:
    used, indices = np.unique(np.reshape(np.array(triangles, dtype=np.int64), (-1, 3)), return_inverse=True)
    indices = indices.reshape(-1, 3)
    vertices = vertices[used]
    rounded = vertices.astype(np.float32).astype(np.longdouble)[indices]
    sides = planes[owners]
    deviations = np.abs((rounded * sides[:, None, :3]).sum(axis=2) + sides[:, None, 3])
    return PolyhedronMesh(
        vertices,
        indices.astype(np.uint32),
        np.array(owners, dtype=np.int32),
        float(deviations.max(initial=0)),
        method,
    )


def _vertices(rings: dict[int, Ring], faces: Sequence[Face]) -> tuple[Floats, dict[int, Ring]]:
    """The vertices of a closed surface, (v, 3), and those that each ring's edges begin at.

    Raises:
        MeshError: a face does not join its neighbours, or the surface is not closed like a sphere's.

    """
    # Half-edges, one for each face and neighbour: the one on the other side, and the next one around the face.
    index = {pair: h for h, pair in enumerate((k, i) for k, ring in rings.items() for i in ring)}
    if single := {k for k, i in index if (i, k) not in index}:
        raise MeshError(f"the face of plane {listed(sorted(single))} does not join its neighbours")
    if lost := [k for k, ring in rings.items() if len(ring) < 3]:
        raise MeshError(f"the face of plane {listed(lost)} is lost")
    twins = [index[i, k] for k, i in index]
    before = [index[k, ring[a - 1]] for k, ring in rings.items() for a in range(len(ring))]
    # Around a vertex: from a half-edge that begins there, to the twin of the one before it.
    vertex = [-1] * len(index)
    count = 0
    for start in range(len(index)):
        h = start
        while vertex[h] < 0:
            vertex[h] = count
            h = twins[before[h]]
        count += vertex[start] == count
    if count - len(index) // 2 + len(rings) != 2:
        raise MeshError("the faces close no surface")
    # Every face has computed where its edges begin. Rounding aside they agree, and any of them will do.
    begin = {(k, i): p for k, face in enumerate(faces) for i, p in zip(face.neighbors, points_of(face), strict=True)}
    places = np.empty((count, 3))
    places[vertex] = [begin[pair] for pair in index]
    vertices = iter(vertex)
    return places, {k: list(islice(vertices, len(ring))) for k, ring in rings.items()}


def _check_convex(planes: Long, rings: dict[int, Ring], vertices: Floats, corners: dict[int, Ring]) -> None:
    """Whether the vertices of a closed surface are on the planes of their faces, and none is beyond another plane.

    A closed surface that is convex along every edge is convex (van Heijenoort, "On locally convex manifolds",
    Communications on Pure and Applied Mathematics 5, 1952): of a face's neighbour only those vertices matter that come
    before and after the edge between them.

    Raises:
        MeshError: there are others.

    """
    owners = np.repeat(list(corners), [len(ring) for ring in corners.values()])
    begins = np.array([v for ring in corners.values() for v in ring])
    heights = _heights(planes, owners, vertices[begins])
    place = {(k, i): a for k, ring in rings.items() for a, i in enumerate(ring)}
    beside = [
        (corners[i][place[i, k] - 1], corners[i][(place[i, k] + 2) % len(corners[i])])
        for k, ring in rings.items()
        for i in ring
    ]
    outermost = np.maximum(heights, _heights(planes, owners[:, None], vertices[beside]).max(axis=1))
    allowed = OFF * np.abs(vertices).max()
    if np.any(out := outermost > allowed):
        raise MeshError(f"plane {listed(np.unique(owners[out]))} cuts off more")
    if np.any(off := heights < -allowed):
        raise MeshError(f"the face of plane {listed(np.unique(owners[off]))} is not flat")


def _heights(planes: Long, which: NDArray[np.int64], points: Floats) -> Floats:
    """Of points above planes, one plane for each."""
    sides = planes[which].astype(np.float64)
    heights: Floats = (points * sides[..., :3]).sum(axis=-1) + sides[..., 3]
    return heights


def _triangulated(corners: Ring) -> list[list[int]]:
    """A convex polygon as triangles: cut off every other corner until a triangle is left."""
    triangles = []
    while len(corners) > 3:
        ears = zip(corners[::2], corners[1::2], corners[2::2] + corners[:1], strict=False)
        triangles += [list(ear) for ear in ears]
        corners = corners[::2]
    return [*triangles, corners] if len(corners) == 3 else triangles
