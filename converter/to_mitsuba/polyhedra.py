"""Polyhedra as triangle meshes that remember which plane each triangle lies on.

The planes of a polyhedron become points, its dual, whose convex hull manifold3d finds: a hull vertex is a face of the
polyhedron, a hull triangle a vertex, n log n (Preparata and Shamos, "Computational Geometry", 1985, section 7.3; de
Berg et al., "Computational Geometry", 3rd ed., 2008, section 11.4). Only the neighbourhoods are taken from it, which
face borders on which; coordinates are computed from the planes themselves.

manifold3d drops points closer to the hull than 1e-7 of its size. Two things are done about that. The body is scaled,
differently along three axes, until it is about as thick as long, so that slivers are none: affine maps take half-spaces
to half-spaces. And the mesh is compared with the polygons of `native_tracer.halfspaces`, another method altogether. A
hull that misses a face is not used; the polygons' neighbourhoods are, if they close a surface.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from native_tracer.halfspaces import Face, HalfSpace, polyhedron_faces, polyhedron_facts

if TYPE_CHECKING:
    import trimesh

Floats = NDArray[np.float64]
Long = NDArray[np.longdouble]
Method = Literal["hull", "polygons"]
Ring = list[int]
"""Neighbours of a face, by their planes' indices, counterclockwise as seen from outside."""

HAIR = 2.0**-46
"""Edges shorter than this share of their distance from the origin are points: the planes' roundings, 2^-53 each, move a
vertex of planes at ordinary angles by less."""
AREA_TOLERANCE = 1e-6
"""How much areas by the two methods may differ, relatively. Both compute with a mantissa of 64 bits, of which planes at
an angle s lose -log2(s); a neighbour too few makes more of a difference, or none that can be seen."""


class PolyhedronError(ValueError):
    """A polyhedron cannot be made a mesh; the message names it, and the plane."""


class Box(NamedTuple):
    """An axis-aligned box."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class PolyhedronMesh:
    """The surface of a polyhedron, or as much of it as is inside a box.

    Attributes:
        vertices: (n, 3) float64, scene units.
        triangles: (m, 3) uint32, counterclockwise as seen from outside.
        planes: (m,) int32, for each triangle the index of its plane among the polyhedron's.
        deviation: how far the vertices, rounded to float32, are from the planes of their triangles, at most.
        method: where the neighbourhoods come from, the dual hull or the clipped polygons.

    """

    vertices: Floats
    triangles: NDArray[np.uint32]
    planes: NDArray[np.int32]
    deviation: float
    method: Method

    def to_trimesh(self) -> "trimesh.Trimesh":
        """As a trimesh, vertices and triangles in the same order."""
        import trimesh  # late: takes a while, and only mesh files need it

        return trimesh.Trimesh(self.vertices, self.triangles, process=False)


def polyhedron_mesh(planes: Sequence[HalfSpace], bounds: Box, name: str = "polyhedron") -> PolyhedronMesh:
    """Make a mesh of an intersection of half-spaces.

    Args:
        planes: (n, 4), half-spaces a x + b y + c z + d <= 0.
        bounds: what reaches out of this box is cut off there. The mesh is open where the box cuts it.
        name: what messages call the polyhedron.

    Raises:
        PolyhedronError: there is no volume, a face lies outside of `bounds`, or no method gives a mesh with all faces.

    """
    closed: list[Sequence[float]] = [tuple(map(float, plane)) for plane in planes]
    faces = polyhedron_faces(closed)
    kept: Sequence[int] = [k for k, face in enumerate(faces) if face.neighbors]
    if not _fit(faces, bounds):
        facts = polyhedron_facts([closed])[0]
        if not facts.solid:
            raise PolyhedronError(f"{name}: planes {_listed(facts.conflict)} leave no volume")
        kept = facts.kept
        closed += _box_planes(bounds)
        faces = polyhedron_faces(closed)
        if outside := [k for k in kept if not (faces and faces[k].neighbors)]:
            raise PolyhedronError(f"{name}: the face of plane {_listed(outside)} lies outside of the bounds")

    unit = _unit_planes(closed)
    problems = []
    methods: tuple[tuple[Method, Callable[[Long, Sequence[Face]], dict[int, Ring]]], ...]
    methods = ("hull", _hull_rings), ("polygons", _polygon_rings)
    for method, find_rings in methods:
        try:
            mesh = _mesh_of(unit, find_rings(unit, faces), len(planes), method)
            _check_areas(unit, mesh, faces, kept)
        except PolyhedronError as error:
            problems.append(f"{error} (by {method})")
        else:
            return mesh
    raise PolyhedronError(f"{name}: " + "; ".join(problems))


def write_ply(mesh: PolyhedronMesh, path: Path) -> None:
    """Write a binary PLY file: positions as float32, no normals, triangles in the mesh's order."""
    path.write_bytes(mesh.to_trimesh().export(file_type="ply", vertex_normal=False))


# ---- Neighbourhoods --------------------------------------------------------------------------------------------------


def _hull_rings(planes: Long, faces: Sequence[Face]) -> dict[int, Ring]:
    """Find each face's neighbours by the convex hull of the dual points."""
    from manifold3d import Manifold  # late, as trimesh

    kept = [k for k, face in enumerate(faces) if face.neighbors]
    center, axes = _frame([faces[k] for k in kept])
    depths = -(planes[kept, :3] @ center + planes[kept, 3])
    if not np.all(depths > 0):
        raise PolyhedronError("no point inside could be computed")
    # Adding zero turns -0 into 0, so that points can be told by their bytes.
    points = (planes[kept, :3] @ axes / depths[:, None]).astype(np.float64) + 0.0
    plane_of = {point.tobytes(): k for point, k in zip(points, kept, strict=True)}
    hull = Manifold.hull_points(points).to_mesh64()
    corners = np.asarray(hull.vert_properties, dtype=np.float64)[:, :3] + 0.0
    owners = [plane_of[point.tobytes()] for point in corners]
    missing = sorted(set(kept) - set(owners))
    if missing:
        raise PolyhedronError(f"plane {_listed(missing)} has no face")
    following: dict[int, dict[int, int]] = {k: {} for k in kept}
    for triangle in np.asarray(hull.tri_verts).tolist():
        a, b, c = (owners[corner] for corner in triangle)
        following[a][b], following[b][c], following[c][a] = c, a, b
    rings = {k: _walk(ring) for k, ring in following.items()}
    surface = _Surface.of(planes, rings)
    return _without_hairs(rings, surface.edge_lengths())


def _polygon_rings(planes: Long, faces: Sequence[Face]) -> dict[int, Ring]:
    """Take each face's neighbours from the clipped polygons."""
    rings = {k: face.neighbors for k, face in enumerate(faces) if face.neighbors}
    lengths: dict[tuple[int, int], float] = {}
    for k, ring in rings.items():
        points = np.reshape(faces[k].points, (-1, 3))
        ends = np.roll(points, -1, axis=0)
        relative = np.linalg.norm(ends - points, axis=1) / np.abs(points).max()
        lengths.update(zip(((k, i) for i in ring), relative.tolist(), strict=True))
    return _without_hairs(rings, lengths)


def _frame(faces: Sequence[Face]) -> tuple[Floats, Floats]:
    """A point inside, and columns u, v, w such that the points center + x u + y v + z w fill about a unit ball."""
    points = np.concatenate([np.reshape(face.points, (-1, 3)) for face in faces])
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


def _without_hairs(rings: dict[int, Ring], lengths: dict[tuple[int, int], float]) -> dict[int, Ring]:
    """Make points of the edges that are `HAIR` long at most, seen from either side."""
    hairs = {frozenset(pair) for pair, length in lengths.items() if length <= HAIR}
    result = {k: [i for i in ring if frozenset((k, i)) not in hairs] for k, ring in rings.items()}
    lost = [k for k, ring in result.items() if len(ring) < 3]
    if lost:
        raise PolyhedronError(f"the face of plane {_listed(lost)} is too narrow")
    return result


# ---- From neighbourhoods to triangles --------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Surface:
    """A closed surface of polygons, as half-edges: one for each face and neighbour, ring by ring.

    Attributes:
        owners, neighbors: (h,) the face a half-edge belongs to, and the one on its other side.
        before: (h,) the half-edge before it in its ring.
        ends: (h,) the vertex it leads to.
        vertices: (v, 3) long double.
        errors: (v,) how far off the vertices may be by rounding.

    """

    owners: NDArray[np.int64]
    neighbors: NDArray[np.int64]
    before: NDArray[np.int64]
    ends: NDArray[np.int64]
    vertices: Long
    errors: Long

    @classmethod
    def of(cls, planes: Long, rings: dict[int, Ring]) -> "_Surface":
        """Join rings of neighbours.

        Raises:
            PolyhedronError: they close no surface like a sphere's.

        """
        owners = np.repeat(list(rings), [len(ring) for ring in rings.values()])
        neighbors = np.concatenate([np.array(ring) for ring in rings.values()])
        before = np.concatenate([first + np.roll(np.arange(n), 1) for first, n in _spans(rings)])
        after = np.empty_like(before)
        after[before] = np.arange(len(before))
        keys, twin_keys = owners * len(planes) + neighbors, neighbors * len(planes) + owners
        order = np.argsort(keys)
        twins = order[np.minimum(np.searchsorted(keys, twin_keys, sorter=order), len(keys) - 1)]
        single = owners[keys[twins] != twin_keys]
        if single.size:
            raise PolyhedronError(f"the face of plane {_listed(np.unique(single))} does not join its neighbours")
        # Around a vertex: from a half-edge that ends there to the next one, which ends there on the face beyond. The
        # least index in each cycle stands for the vertex; it goes twice as far in every round.
        labels, step = np.arange(len(keys)), twins[after]
        for _ in range(len(keys).bit_length()):
            labels = np.minimum(labels, labels[step])
            step = step[step]
        _, ends = np.unique(labels, return_inverse=True)
        count = int(ends.max()) + 1
        if count - len(keys) // 2 + len(rings) != 2:
            raise PolyhedronError("the faces close no surface")
        order = np.argsort(ends, kind="stable")
        groups = np.split(owners[order], np.flatnonzero(np.diff(ends[order])) + 1)
        return cls(owners, neighbors, before, ends, *_meeting_points(planes, groups))

    def edge_lengths(self) -> dict[tuple[int, int], float]:
        """Lengths of the edges by both faces' planes, relative to their distance from the origin, less their errors."""
        i, j = self.ends[self.before], self.ends
        begin, end = self.vertices[i], self.vertices[j]
        lengths = np.sqrt(((end - begin) ** 2).sum(axis=1)) - self.errors[i] - self.errors[j]
        pairs = zip(self.owners.tolist(), self.neighbors.tolist(), strict=True)
        return dict(zip(pairs, (lengths / np.abs(end).max(axis=1)).tolist(), strict=True))


def _spans(rings: dict[int, Ring]) -> list[tuple[int, int]]:
    sizes = [len(ring) for ring in rings.values()]
    return list(zip(np.cumsum([0, *sizes[:-1]]).tolist(), sizes, strict=True))


def _meeting_points(planes: Long, groups: list[NDArray[np.int64]]) -> tuple[Long, Long]:
    """Where each group of three planes or more meets, by the three at the largest angles, and its rounding error."""
    triples = np.array([group if len(group) == 3 else _steepest(planes[group, :3], group) for group in groups])
    a, b, c = (planes[triples[:, i], :3] for i in range(3))
    sides = np.cross(b, c), np.cross(c, a), np.cross(a, b)
    volumes = (a * sides[0]).sum(axis=1)
    offsets = planes[triples, 3]
    points: Long = -np.sum([offsets[:, i, None] * side for i, side in enumerate(sides)], axis=0) / volumes[:, None]
    # A product of unit vectors is off by the precision, however small it is.
    return points, 8 * np.finfo(np.longdouble).eps * np.abs(offsets).max(axis=1) / np.abs(volumes)


def _steepest(normals: Long, group: NDArray[np.int64]) -> list[int]:
    i = 0
    for _ in range(2):  # the second round improves on the arbitrary start
        j = int(np.argmax((np.cross(normals[i], normals) ** 2).sum(axis=1)))
        k = int(np.argmax(np.abs(normals @ np.cross(normals[i], normals[j]))))
        i = int(np.argmax(np.abs(normals @ np.cross(normals[j], normals[k]))))
    return [int(group[i]), int(group[j]), int(group[k])]


def _triangulated(corners: Ring) -> list[list[int]]:
    """A convex polygon as triangles: cut off every other corner until a triangle is left."""
    triangles = []
    while len(corners) > 3:
        ears = zip(corners[::2], corners[1::2], corners[2::2] + corners[:1], strict=False)
        triangles += [list(ear) for ear in ears]
        corners = corners[::2]
    return [*triangles, corners] if len(corners) == 3 else triangles


def _mesh_of(planes: Long, rings: dict[int, Ring], plane_count: int, method: Method) -> PolyhedronMesh:
    """The faces of the first `plane_count` planes as triangles; the rest are the box's."""
    surface = _Surface.of(planes, rings)
    triangles: list[list[int]] = []
    owners: list[int] = []
    for k, (first, size) in zip(rings, _spans(rings), strict=True):
        if k < plane_count:
            face = _triangulated(surface.ends[first : first + size].tolist())
            triangles += face
            owners += [k] * len(face)
    used, corners = np.unique(np.reshape(np.array(triangles, dtype=np.int64), (-1, 3)), return_inverse=True)
    vertices = surface.vertices[used].astype(np.float64)
    corners = corners.reshape(-1, 3)
    rounded = vertices.astype(np.float32).astype(np.longdouble)[corners]
    sides = planes[owners]
    distances = np.abs((rounded * sides[:, None, :3]).sum(axis=2) + sides[:, None, 3])
    return PolyhedronMesh(
        vertices,
        corners.astype(np.uint32),
        np.array(owners, dtype=np.int32),
        float(distances.max(initial=0)),
        method,
    )


def _check_areas(planes: Long, mesh: PolyhedronMesh, faces: Sequence[Face], kept: Sequence[int]) -> None:
    """Compare each face's area with that of its clipped polygon.

    Raises:
        PolyhedronError: they differ.

    """
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(np.longdouble) for i in range(3))
    areas = (np.cross(b - a, c - a) * planes[mesh.planes, :3]).sum(axis=1) / 2
    total = np.zeros(len(planes), dtype=np.longdouble)
    np.add.at(total, mesh.planes, areas)
    for k in kept:
        points = np.reshape(faces[k].points, (-1, 3))
        perimeter = np.linalg.norm(points - np.roll(points, 1, axis=0), axis=1).sum()
        hair = 4 * HAIR * np.abs(points).max() * perimeter
        if not abs(total[k] - faces[k].area) <= AREA_TOLERANCE * faces[k].area + hair:
            raise PolyhedronError(f"the face of plane {k} has an area of {total[k]:g}, not {faces[k].area:g}")


def _unit_planes(planes: Sequence[Sequence[float]]) -> Long:
    rows = np.reshape(np.array(planes, dtype=np.longdouble), (-1, 4))
    unit: Long = rows / np.sqrt((rows[:, :3] ** 2).sum(axis=1))[:, None]
    return unit


def _fit(faces: Sequence[Face], box: Box) -> bool:
    """Whether there are faces, all inside the box."""
    points = np.reshape([x for face in faces for x in face.points], (-1, 3))
    return points.size > 0 and bool(np.all((points >= box.low) & (points <= box.high)))


def _box_planes(box: Box) -> list[tuple[float, ...]]:
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    low = ((-x, -y, -z, at) for (x, y, z), at in zip(axes, box.low, strict=True))
    return [*low, *((*axis, -at) for axis, at in zip(axes, box.high, strict=True))]


def _listed(indices: Iterable[int]) -> str:
    """A few indices, e.g. "2, 5 and 7"."""
    words = [str(int(i)) for i in indices]
    if len(words) > 5:
        words = [*words[:4], f"{len(words) - 4} more"]
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
