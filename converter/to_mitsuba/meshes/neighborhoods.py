"""Which faces of a polyhedron border on which: by the convex hull of its dual, and by the clipped polygons."""

from collections import Counter
from collections.abc import Sequence
from itertools import compress

import numpy as np

from converter.to_mitsuba.meshes.mesh import Floats, Long, MeshError, Ring, listed
from native_tracer.halfspaces import Face

HAIR = 2.0**-46
"""Edges shorter than this share of their distance from the origin become points: at ordinary angles the roundings of
the planes, 2^-53 each, move vertices by less."""


def edges_of(faces: Sequence[Face]) -> set[tuple[int, int]]:
    """The pairs of faces that share an edge, by both their clipped polygons, either way round.

    Where more than three planes meet in a vertex, rounding puts edges of no length between them: those are left out.
    """
    pairs = [(k, i) for k, face in enumerate(faces) for i in face.neighbors]
    found = set(pairs)
    long = set(compress(pairs, _relative_lengths(faces) > HAIR))
    edges = {(k, i) for k, i in long if (i, k) in long}
    # A face that has no others keeps them.
    sizes = Counter(k for k, _ in edges)
    narrow = {k for k, face in enumerate(faces) if face.neighbors and sizes[k] < 3}
    return edges | {(k, i) for k, i in found if (i, k) in found and (k in narrow or i in narrow)}


def _relative_lengths(faces: Sequence[Face]) -> Floats:
    """The lengths of all faces' edges, one face after the other, relative to their face's distance from the origin."""
    sizes = np.array([len(face.neighbors) for face in faces if face.neighbors])
    begins = np.concatenate([points_of(face) for face in faces if face.neighbors])
    firsts = np.cumsum(sizes) - sizes
    following = np.arange(1, len(begins) + 1)
    following[firsts + sizes - 1] = firsts
    reaches = np.maximum.reduceat(np.abs(begins).max(axis=1), firsts)
    lengths: Floats = np.linalg.norm(begins[following] - begins, axis=1) / np.repeat(reaches, sizes)
    return lengths


def points_of(face: Face) -> Floats:
    """(n, 3) places where its edges begin."""
    return np.reshape(face.points, (-1, 3))


def polygon_rings(faces: Sequence[Face], edges: set[tuple[int, int]]) -> dict[int, Ring]:
    """Take each face's neighbours from the clipped polygons."""
    return {k: [i for i in face.neighbors if (k, i) in edges] for k, face in enumerate(faces) if face.neighbors}


def hull_rings(planes: Long, faces: Sequence[Face], edges: set[tuple[int, int]]) -> dict[int, Ring]:
    """Find each face's neighbours by the convex hull of the dual points.

    Raises:
        MeshError: the hull misses a plane, or an edge of the clipped polygons.

    """
    from manifold3d import Manifold  # late: takes a while, and many scenes have no polyhedra

    kept = [k for k, face in enumerate(faces) if face.neighbors]
    center, axes = _frame([faces[k] for k in kept])
    depths = -(planes[kept, :3] @ center + planes[kept, 3])
    if not np.all(depths > 0):
        raise MeshError("no point inside could be computed")
    # Adding zero turns -0 into 0, so that points can be told by their bytes.
    points = (planes[kept, :3] @ axes / depths[:, None]).astype(np.float64) + 0.0
    plane_of = {point.tobytes(): k for point, k in zip(points, kept, strict=True)}
    hull = Manifold.hull_points(points).to_mesh64()
    corners = np.asarray(hull.vert_properties, dtype=np.float64)[:, :3] + 0.0
    owners = [plane_of[point.tobytes()] for point in corners]
    if missing := sorted(set(kept) - set(owners)):
        raise MeshError(f"plane {listed(missing)} has no face")
    following: dict[int, dict[int, int]] = {k: {} for k in kept}
    for triangle in np.asarray(hull.tri_verts).tolist():
        a, b, c = (owners[corner] for corner in triangle)
        following[a][b], following[b][c], following[c][a] = c, a, b
    # Dual points in a plane are a vertex of many faces, which the hull splits at random: only real edges count.
    rings = {k: [i for i in _walk(ring) if (k, i) in edges] for k, ring in following.items()}
    if missing := [k for k, n in Counter(k for k, _ in edges).items() if len(rings[k]) != n]:
        raise MeshError(f"plane {listed(missing)} has other neighbours")
    return rings


def _frame(faces: Sequence[Face]) -> tuple[Floats, Floats]:
    """A point inside, and columns u, v, w such that the points center + x u + y v + z w fill about a unit ball."""
    points = np.concatenate([points_of(face) for face in faces])
    weights = np.concatenate([np.full(len(face.neighbors), face.area / len(face.neighbors)) for face in faces])
    weights /= weights.sum()
    center = weights @ points
    # Singular values, since the eigenvalues of a covariance would lose the small ones.
    _, sizes, directions = np.linalg.svd(np.sqrt(weights)[:, None] * (points - center), full_matrices=False)
    axes = directions.T * sizes
    return center, axes if np.linalg.det(directions) > 0 else -axes


def _walk(following: dict[int, int]) -> Ring:
    ring = [next(iter(following))]
    while (k := following[ring[-1]]) != ring[0]:
        ring.append(k)
    return ring
