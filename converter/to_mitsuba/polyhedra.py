"""Polyhedra as triangle meshes that remember which plane each triangle lies on.

The planes of a polyhedron become points, its dual, whose convex hull manifold3d finds: a hull vertex is a face of the
polyhedron, a hull triangle a vertex, n log n (Preparata and Shamos, "Computational Geometry", 1985, section 7.3; de
Berg et al., "Computational Geometry", 3rd ed., 2008, section 11.4). Only the neighbourhoods are taken from it, which
face borders on which; coordinates are those of the polygons of `native_tracer.halfspaces`, each from three planes.

manifold3d drops points closer to the hull than 1e-7 of its size. Two things are done about that. The body is scaled,
differently along three axes, until it is about as thick as long, so that slivers are none: affine maps take half-spaces
to half-spaces. And the hull's neighbourhoods are compared with those of the polygons, another method altogether: a hull
that misses a face or an edge is not used. Then the polygons' own are, if they close a surface.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import compress, islice, product
from operator import le, mul, sub
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from converter.to_mitsuba.bounds import LARGEST, Box, scene_bounds
from native_tracer.halfspaces import Face, HalfSpace, PolyhedronFacts, polyhedron_faces, polyhedron_facts

if TYPE_CHECKING:
    import trimesh

__all__ = ["Box", "PolyhedronError", "PolyhedronMesh", "polyhedron_mesh", "scene_bounds", "write_ply"]

Floats = NDArray[np.float64]
Long = NDArray[np.longdouble]
Method = Literal["hull", "polygons"]
METHODS: tuple[Method, Method] = ("hull", "polygons")
Ring = list[int]
"""What is around a face, neighbours' planes or vertices, counterclockwise as seen from outside."""

HAIR = 2.0**-46
"""Edges shorter than this share of their distance from the origin become points: at ordinary angles the roundings of
the planes, 2^-53 each, move vertices by less."""
SMALLEST = 2.0**-126
"""Below this float32 numbers lose digits."""
NEAR = 2.0**-21
"""Planes whose unit normals differ by no more than this, and whose offsets by no more as a share of the largest, nearly
coincide: a few roundings of float32."""
OFF = 2.0**-44
"""How far a vertex may be from the planes of its faces, as a share of the body's distance from the origin: it is
computed to about 2^-53 of that, and moved by a `HAIR` at most."""


class PolyhedronError(ValueError):
    """A polyhedron cannot be made a mesh; the message names it, and the plane."""


@dataclass(frozen=True, eq=False)
class PolyhedronMesh:
    """The surface of a polyhedron, or as much of it as is inside a box.

    Attributes:
        vertices: (n, 3) float64, scene units.
        triangles: (m, 3) uint32, counterclockwise as seen from outside.
        planes: (m,) int32, for each triangle the index of its plane among the polyhedron's.
        deviation: how far the vertices, rounded to float32, are from the planes of their triangles, at most.
        method: where the neighbourhoods come from, the dual hull or the clipped polygons.
        outside: planes whose faces lie outside of the box altogether, and have no triangles.

    """

    vertices: Floats
    triangles: NDArray[np.uint32]
    planes: NDArray[np.int32]
    deviation: float
    method: Method
    outside: tuple[int, ...] = ()

    def to_trimesh(self) -> "trimesh.Trimesh":
        """As a trimesh, vertices and triangles in the same order."""
        import trimesh  # late: takes a while, and only mesh files need it

        return trimesh.Trimesh(self.vertices, self.triangles, process=False)


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
        PolyhedronError: there is neither a volume nor a face, no method gives a closed surface, or float32 numbers do
            not hold it.

    """
    try:
        return _whole_mesh(planes, bounds, name)
    except PolyhedronError:
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
            raise PolyhedronError(f"{name}: planes {_listed(facts.conflict)} leave no volume")
        kept = facts.plate[:1] or facts.kept
        for box in (bounds, _enlarged(bounds, facts)):
            closed = body + _box_planes(box)
            faces = polyhedron_faces(closed)
            if faces and any(faces[k].neighbors for k in kept):
                break
        if kept and not faces:
            raise PolyhedronError(f"{name}: what is left of it inside of the bounds has no volume")
    size = max((abs(x) for face in faces for x in face.points), default=1.0)
    if not SMALLEST < size < 4 * LARGEST:
        raise PolyhedronError(f"{name}: single precision, of which meshes are, has no numbers for a size of {size:.3g}")
    unit = _unit_planes(closed)
    if len(only := [k for k, face in enumerate(faces) if face.neighbors]) == 1:
        return _plate_mesh(unit, only[0], faces[only[0]])
    edges = _edges(faces)
    problems = []
    for method in METHODS:
        try:
            rings = _hull_rings(unit, faces, edges) if method == "hull" else _polygon_rings(faces, edges)
            mesh = _mesh(unit, rings, len(planes), faces, method)
            return replace(mesh, outside=tuple(k for k in kept if not faces[k].neighbors))
        except PolyhedronError as error:
            problems.append(f"{error} (by {method})")
    raise PolyhedronError(f"{name}: " + "; ".join(problems))


def write_ply(mesh: PolyhedronMesh, path: Path) -> None:
    """Write a binary PLY file: positions as float32, no normals, triangles in the mesh's order."""
    path.write_bytes(mesh.to_trimesh().export(file_type="ply", vertex_normal=False))


# ---- Neighbourhoods --------------------------------------------------------------------------------------------------


def _edges(faces: Sequence[Face]) -> set[tuple[int, int]]:
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
    begins = np.concatenate([_points(face) for face in faces if face.neighbors])
    firsts = np.cumsum(sizes) - sizes
    following = np.arange(1, len(begins) + 1)
    following[firsts + sizes - 1] = firsts
    reaches = np.maximum.reduceat(np.abs(begins).max(axis=1), firsts)
    lengths: Floats = np.linalg.norm(begins[following] - begins, axis=1) / np.repeat(reaches, sizes)
    return lengths


def _points(face: Face) -> Floats:
    return np.reshape(face.points, (-1, 3))


def _polygon_rings(faces: Sequence[Face], edges: set[tuple[int, int]]) -> dict[int, Ring]:
    """Take each face's neighbours from the clipped polygons."""
    return {k: [i for i in face.neighbors if (k, i) in edges] for k, face in enumerate(faces) if face.neighbors}


def _hull_rings(planes: Long, faces: Sequence[Face], edges: set[tuple[int, int]]) -> dict[int, Ring]:
    """Find each face's neighbours by the convex hull of the dual points.

    Raises:
        PolyhedronError: the hull misses a plane, or an edge of the clipped polygons.

    """
    from manifold3d import Manifold  # late: takes a while, and many scenes have no polyhedra

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
    if missing := sorted(set(kept) - set(owners)):
        raise PolyhedronError(f"plane {_listed(missing)} has no face")
    following: dict[int, dict[int, int]] = {k: {} for k in kept}
    for triangle in np.asarray(hull.tri_verts).tolist():
        a, b, c = (owners[corner] for corner in triangle)
        following[a][b], following[b][c], following[c][a] = c, a, b
    # Dual points in a plane are a vertex of many faces, which the hull splits at random: only real edges count.
    rings = {k: [i for i in _walk(ring) if (k, i) in edges] for k, ring in following.items()}
    if missing := [k for k, n in Counter(k for k, _ in edges).items() if len(rings[k]) != n]:
        raise PolyhedronError(f"plane {_listed(missing)} has other neighbours")
    return rings


def _frame(faces: Sequence[Face]) -> tuple[Floats, Floats]:
    """A point inside, and columns u, v, w such that the points center + x u + y v + z w fill about a unit ball."""
    points = np.concatenate([_points(face) for face in faces])
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


# ---- From neighbourhoods to triangles --------------------------------------------------------------------------------


def _mesh(planes: Long, rings: dict[int, Ring], count: int, faces: Sequence[Face], method: Method) -> PolyhedronMesh:
    """The faces of the first `count` planes as triangles; the rest are the box's.

    Raises:
        PolyhedronError: the rings close no surface, or not that of the polyhedron.

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


def _plate_mesh(planes: Long, plane: int, face: Face) -> PolyhedronMesh:
    """The only face of a plate."""
    triangles = _triangulated(list(range(len(face.neighbors))))
    return _from_triangles(planes, _points(face), triangles, [plane] * len(triangles), "polygons")


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
        PolyhedronError: a face does not join its neighbours, or the surface is not closed like a sphere's.

    """
    # Half-edges, one for each face and neighbour: the one on the other side, and the next one around the face.
    index = {pair: h for h, pair in enumerate((k, i) for k, ring in rings.items() for i in ring)}
    if single := {k for k, i in index if (i, k) not in index}:
        raise PolyhedronError(f"the face of plane {_listed(sorted(single))} does not join its neighbours")
    if lost := [k for k, ring in rings.items() if len(ring) < 3]:
        raise PolyhedronError(f"the face of plane {_listed(lost)} is lost")
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
        raise PolyhedronError("the faces close no surface")
    # Every face has computed where its edges begin. Rounding aside they agree, and any of them will do.
    begin = {(k, i): p for k, face in enumerate(faces) for i, p in zip(face.neighbors, _points(face), strict=True)}
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
        PolyhedronError: there are others.

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
        raise PolyhedronError(f"plane {_listed(np.unique(owners[out]))} cuts off more")
    if np.any(off := heights < -allowed):
        raise PolyhedronError(f"the face of plane {_listed(np.unique(owners[off]))} is not flat")


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


def _unit_planes(planes: Sequence[Sequence[float]]) -> Long:
    rows = np.reshape(np.array(planes, dtype=np.longdouble), (-1, 4))
    unit: Long = rows / np.sqrt((rows[:, :3] ** 2).sum(axis=1))[:, None]
    return unit


def _fit(faces: Sequence[Face], box: Box) -> bool:
    """Whether there are faces, all inside the box."""
    points = np.concatenate([np.empty((0, 3)), *map(_points, faces)])
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


def _listed(indices: Iterable[int]) -> str:
    """A few indices, e.g. "2, 5 and 7"."""
    words = [str(int(i)) for i in indices]
    if len(words) > 5:
        words = [*words[:4], f"{len(words) - 4} more"]
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
