"""Meshes of csgs: manifold3d makes unions, differences and intersections of the leaves' meshes.

Those are as fine as a picture needs, and closed beyond the scene's bounds where they have none. Every triangle of the
result lies on a surface of a leaf, that of a ball, a quadric or a plane. One is kept if the exact expression has inside
on one side of it and outside on the other, all leaves with that surface taken together: so there is no film where
surfaces coincide. It has the normals of the exact surface at its corners.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple, assert_never

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Polyhedron, Primitive, Quadric, Sphere, Vector
from converter.shapes.csg_program import DIFFERENCE, INTERSECTION, UNION, Program, combined_bits, fold
from converter.shapes.quadric_form import moved
from converter.shapes.quadric_frame import frame_of
from converter.to_mitsuba.bounds import LARGEST, Box
from converter.to_mitsuba.meshes.body import SMALLEST, polyhedron_mesh
from converter.to_mitsuba.meshes.mesh import MeshError
from converter.to_mitsuba.meshes.quadrics import OFF, QuadricMesh, View, quadric_solid

if TYPE_CHECKING:
    from manifold3d import Manifold

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

FINEST = 2.0**-14
"""What triangles of a ball may be off in any case, as a share of its radius."""
ROOM = 1.0
"""How far beyond the scene's bounds leaves without bounds are closed, as a share of its size."""


class _Surface(NamedTuple):
    """A ball's, a quadric's, or a plane.

    Attributes:
        numbers: what is the same for leaves with the same surface; all signs turned, that of a complement.
        local: the numbers A to J of a quadric about the origin, which is near its middle.
        origin: a point.

    """

    numbers: tuple[float, ...]
    local: tuple[float, ...]
    origin: Vector = (0.0, 0.0, 0.0)

    def at(self, p: Floats) -> Floats:
        """The value at points (n, 3)."""
        q = p - np.array(self.origin)
        slope = np.array(self.local[6:9]) / 2
        return np.asarray(((self._half_gradient(p) + slope) * q).sum(axis=1) + self.local[9])

    def _half_gradient(self, p: Floats) -> Floats:
        a, b, c, d, e, f, g, h, i, _ = self.local
        matrix = np.array(((2 * a, d, e), (d, 2 * b, f), (e, f, 2 * c))) / 2
        return np.asarray((p - np.array(self.origin)) @ matrix + np.array((g, h, i)) / 2)

    def normals(self, p: Floats) -> Floats:
        """(n, 3), of length 1, outward; 0 where there is none."""
        gradient = self._half_gradient(p)
        length = np.linalg.norm(gradient, axis=1, keepdims=True)
        return np.asarray(np.divide(gradient, length, out=np.zeros_like(gradient), where=length > 0))

    def nearest(self, p: Floats) -> Floats:
        """Points near points (n, 3) that are near it, by two steps along the gradient."""
        for _ in range(2):
            gradient = 2 * self._half_gradient(p)
            square = (gradient**2).sum(axis=1)
            step = np.divide(self.at(p), square, out=np.zeros_like(square), where=square > 0)
            p = p - step[:, None] * gradient
        return p

    @property
    def curved(self) -> bool:
        """Whether it is no plane."""
        return any(self.local[:6])


@dataclass(frozen=True, eq=False)
class _Solid:
    """A closed mesh; each triangle's surface, by its index, or -1 where it closes what has no bounds."""

    vertices: Floats
    triangles: Integers
    surfaces: Integers
    complement: bool = False


class _Body(NamedTuple):
    """What is inside of a manifold, or what is outside of it."""

    inner: "Manifold"
    complement: bool


@np.errstate(all="ignore")  # numbers may be as large as they like
def csg_mesh(program: Program, bounds: Box, view: View, name: str = "csg") -> QuadricMesh:
    """Make a mesh of a csg.

    Args:
        program: its leaves and their expression, which is something.
        bounds: a box that holds all that can be seen; what reaches out of it is open there.
        view: whence it is seen.
        name: what messages call it.

    Raises:
        MeshError: a leaf cannot be made a mesh, or float32 numbers do not hold it.

    """
    pieces = [_surfaces(leaf) for leaf in program.leaves]
    solids = [_solid(leaf, bounds, view, f"{name}: its leaf {k}") for k, leaf in enumerate(program.leaves)]
    size = max(float(np.abs(solid.vertices).max(initial=0.0)) for solid in solids)
    if not SMALLEST < size < LARGEST:  # of NaN, too
        raise MeshError(f"{name}: single precision, of which meshes are, has no numbers for a size of {size:.3g}")
    vertices, triangles, owners = _combined(program, solids, name)
    parts: list[tuple[Floats, Floats, Integers]] = []
    off = tilt = 0.0
    for k, own in enumerate(pieces):
        for j, surface in enumerate(own):
            corners = vertices[triangles[(owners == (k, j)).all(axis=1)]]
            corners = corners[_is_border(program, pieces, surface, surface.nearest(corners.mean(axis=1)))]
            if not len(corners):
                continue
            part = _with_normals(surface, corners)
            parts.append(part)
            if surface.curved:
                deviation, angle = _errors(surface, *part, view)
                off, tilt = max(off, deviation), max(tilt, angle)
    if not parts:  # Mitsuba takes no mesh without triangles
        point = np.repeat([program.facts[0].inside], 3, axis=0)
        parts.append((point, np.tile((0.0, 0.0, 1.0), (3, 1)), np.array([[0, 1, 2]])))
    counts = np.cumsum([0, *(len(points) for points, _, _ in parts)])
    return QuadricMesh(
        np.vstack([points for points, _, _ in parts]),
        np.vstack([normals for _, normals, _ in parts]),
        np.vstack([corners + first for (_, _, corners), first in zip(parts, counts[:-1], strict=True)]),
        off + size * 2.0**-24,
        tilt,
    )


# ---- Leaves ----------------------------------------------------------------------------------------------------------


def _surfaces(leaf: Primitive) -> list[_Surface]:
    match leaf:
        case Sphere(center, r):
            return [_Surface((*center, r, 0.0), (1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -r * r), center)]
        case Quadric(coefficients):
            x, y, z = np.nan_to_num(frame_of(leaf).origin).tolist()
            local = moved(leaf, [Fraction(-w) for w in (x, y, z)])
            return [_Surface(coefficients, local.coefficients, (x, y, z))]
        case Polyhedron(planes):
            return [_Surface(plane, (0.0,) * 6 + plane) for plane in planes]
    assert_never(leaf)


def _solid(leaf: Primitive, bounds: Box, view: View, name: str) -> _Solid:
    room = ROOM * (np.array(bounds.high) - np.array(bounds.low))
    outer = Box.of(np.array(bounds.low) - room, np.array(bounds.high) + room)
    match leaf:
        case Sphere(center, radius):
            distance = max(float(np.linalg.norm(np.array(view.eye) - center)) - radius, view.near)
            ball = _unit_ball(max(FINEST, OFF * view.pixel * distance / radius))
            return _Solid(ball[0] * radius + center, ball[1], np.zeros(len(ball[1]), dtype=np.int64))
        case Quadric():
            solid = quadric_solid(leaf, outer, view)
            return _Solid(solid.vertices, solid.triangles, np.where(solid.surface, 0, -1), solid.complement)
        case Polyhedron(planes):
            return _polyhedron_solid(planes, outer, name)
    assert_never(leaf)


@lru_cache(maxsize=16)
def _unit_ball(tolerance: float) -> tuple[Floats, Integers]:
    from converter.to_mitsuba.meshing import unit_ball  # late: it needs the meshes of this folder

    ball = unit_ball(tolerance)
    return ball.vertices, ball.triangles


def _polyhedron_solid(planes: Sequence[Sequence[float]], outer: Box, name: str) -> _Solid:
    """As far as a box, whose sides close it."""
    from converter.shapes.csg_regions import box_planes

    sides = list(box_planes(outer.low, outer.high))
    beyond = np.array(outer.high) - np.array(outer.low)
    larger = Box.of(np.array(outer.low) - beyond, np.array(outer.high) + beyond)
    mesh = polyhedron_mesh([*planes, *sides], larger, name)
    return _Solid(mesh.vertices, mesh.triangles.astype(np.int64), np.where(mesh.planes < len(planes), mesh.planes, -1))


# ---- All together ----------------------------------------------------------------------------------------------------


def _combined(program: Program, solids: Sequence[_Solid], name: str) -> tuple[Floats, Integers, Integers]:
    """Vertices (n, 3), triangles (m, 3), counterclockwise from outside, and each triangle's leaf and surface (m, 2)."""
    from manifold3d import Error, Manifold, Mesh64

    every = np.concatenate([solid.vertices for solid in solids])
    middle = (every.min(axis=0) + every.max(axis=0)) / 2
    scale = float(np.abs(every - middle).max())
    first = Manifold.reserve_ids(len(solids))

    def body(k: int) -> _Body:
        solid = solids[k]
        count = len(solid.triangles)
        mesh = Mesh64(
            np.ascontiguousarray((solid.vertices - middle) / scale),
            np.ascontiguousarray(solid.triangles.astype(np.uint64)),
            run_index=np.array([0, 3 * count], dtype=np.uint64),
            run_original_id=np.array([first + k], dtype=np.uint32),
            face_id=np.arange(count, dtype=np.uint64),
        )
        inner = Manifold(mesh)
        if inner.status() != Error.NoError:
            raise MeshError(f"{name}: the mesh of its leaf {k} closes no body ({inner.status().name})")
        return _Body(inner, solid.complement)

    whole = fold(program.code, body, _boolean)
    mesh = whole.inner.to_mesh64()
    runs = np.diff([int(x) for x in mesh.run_index]) // 3
    leaves = np.repeat(np.asarray(mesh.run_original_id, dtype=np.int64) - first, runs)
    faces = np.asarray(mesh.face_id, dtype=np.int64)
    owners = np.array(
        [(k, solids[k].surfaces[face]) for k, face in zip(leaves, faces, strict=True)], dtype=np.int64
    ).reshape(-1, 2)
    triangles = np.asarray(mesh.tri_verts, dtype=np.int64).reshape(-1, 3)
    vertices = np.asarray(mesh.vert_properties)[:, :3] * scale + middle
    return vertices, triangles[:, :: -1 if whole.complement else 1], owners


def _boolean(operation: int, a: _Body, b: _Body) -> _Body:
    """By De Morgan's rules for what is outside of a manifold."""
    if operation == UNION:
        inner = _boolean(INTERSECTION, _turned(a), _turned(b))
        return _turned(inner) if a.complement or b.complement else _Body(a.inner + b.inner, False)
    if operation == DIFFERENCE:
        return _boolean(INTERSECTION, a, _turned(b))
    if a.complement and b.complement:
        return _Body(a.inner + b.inner, True)
    if b.complement:
        return _Body(a.inner - b.inner, False)
    return _Body(b.inner - a.inner if a.complement else a.inner ^ b.inner, False)


def _turned(body: _Body) -> _Body:
    return _Body(body.inner, not body.complement)


def _is_border(
    program: Program, pieces: Sequence[Sequence[_Surface]], surface: _Surface, points: Floats
) -> NDArray[np.bool_]:
    """Whether there is inside on one side of a surface, and outside on the other, at points of it (n, 3)."""
    sides = []
    for inner in (False, True):
        inside = [_inside(own, surface, inner, points) for own in pieces]
        bits = fold(program.code, lambda k, inside=inside: inside[k], _combined_arrays)  # type: ignore[misc]
        sides.append(bits)
    return np.asarray(sides[0] != sides[1])


def _combined_arrays(operation: int, a: NDArray[np.int8], b: NDArray[np.int8]) -> NDArray[np.int8]:
    return np.asarray(combined_bits(operation, a, b))  # type: ignore[arg-type]


def _inside(own: Sequence[_Surface], surface: _Surface, inner: bool, points: Floats) -> NDArray[np.int8]:
    """Whether points are inside of a leaf with these surfaces, where they are on one side of one surface."""
    result = np.ones(len(points), dtype=np.int8)
    for other in own:
        if other.numbers == surface.numbers:
            result &= inner
        elif other.numbers == tuple(-x for x in surface.numbers):
            result &= not inner
        else:
            result &= other.at(points) <= 0
    return result


# ---- Normals ---------------------------------------------------------------------------------------------------------


def _with_normals(surface: _Surface, corners: Floats) -> tuple[Floats, Floats, Integers]:
    """Points, normals and triangles of those with corners (m, 3, 3) on a surface, whose normals may be turned there."""
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outward = (across * surface.normals(corners.mean(axis=1))).sum(axis=1) >= 0
    parts = list(_sides(surface, corners, outward))
    first = np.cumsum([0, *(len(points) for points, _, _ in parts)])
    return (
        np.vstack([points for points, _, _ in parts]),
        np.vstack([normals for _, normals, _ in parts]),
        np.vstack([triangles + start for (_, _, triangles), start in zip(parts, first[:-1], strict=True)]),
    )


def _sides(surface: _Surface, corners: Floats, outward: NDArray[np.bool_]) -> Iterator[tuple[Floats, Floats, Integers]]:
    for chosen, sign in ((outward, 1.0), (~outward, -1.0)):
        if chosen.any():
            points, indices = np.unique(corners[chosen].reshape(-1, 3), axis=0, return_inverse=True)
            yield points, sign * surface.normals(points), indices.reshape(-1, 3)


def _errors(surface: _Surface, points: Floats, normals: Floats, triangles: Integers, view: View) -> tuple[float, float]:
    """How far triangles near the eye are off a surface, and the angle by which their normals are.

    They are looked at in their middles and in those of their edges.
    """
    distance = np.maximum(np.linalg.norm(points[triangles].mean(axis=1) - np.array(view.eye), axis=1), view.near)
    near = triangles[distance <= 4 * distance.min()]
    parts = [near, near[:, [0, 1]], near[:, [1, 2]], near[:, [2, 0]]]
    middle = np.vstack([points[part].mean(axis=1) for part in parts])
    mean = np.vstack([normals[part].sum(axis=1) for part in parts])
    placed = surface.nearest(middle)
    sine = np.linalg.norm(np.cross(mean, surface.normals(placed)), axis=1) / np.linalg.norm(mean, axis=1)
    tilt = float(np.arcsin(np.minimum(np.nan_to_num(sine), 1.0)).max())
    return float(np.linalg.norm(placed - middle, axis=1).max()), tilt
