"""Meshes of quadrics: as fine as a picture needs, with the normals of the exact surface.

A coarse mesh, made along the principal axes by the kind of the quadric, has its vertices on the surface. Edges are
halved, and the new vertices put on the surface, as long as their middles are farther off it than a share of a pixel, as
seen from the eye. So the mesh is fine where it is near. What has no bounds is followed as far as the scene's bounds,
and left open there.
"""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Quadric, Vector
from converter.shapes.quadric_frame import Frame, frame_of
from converter.to_mitsuba.bounds import LARGEST, Box
from converter.to_mitsuba.fineness import USUAL
from converter.to_mitsuba.meshes.body import SMALLEST
from converter.to_mitsuba.meshes.mesh import MeshError

if TYPE_CHECKING:
    import trimesh

Floats = NDArray[np.float64]
Triangles = NDArray[np.int64]

OFF = USUAL.pixels
"""How much of a pixel the middle of an edge may be off the surface."""
MOST_TRIANGLES = 1 << 20
"""Of one mesh, about."""
LEAST_TRIANGLES, TRIANGLES_A_PIXEL = 1 << 13, 8
"""Small pictures do with fewer, whatever their lens asks for."""
AROUND, STEP = 16, 0.5
"""Coarse meshes: corners around an axis, and steps along hyperbolas, in units of their hyperbolic angle."""
WIDEST = 64
"""Coarse meshes: steps along a hyperbola, either way, at most."""
HALVINGS = 12
"""Coarse meshes: how often the distance to the end is halved toward the middle."""
ROUNDING = 2.0**-44
"""What places may be off, as a share of their coordinates along the axes."""
FAR = 16.0
"""What is told of how far a mesh is off holds as far as this many times `View.near`, twice as far as what is looked at:
rays start off their surfaces by as much, which must not be more than a share of a pixel."""
COARSER = 4.0
"""How much more may be off, beyond that."""
STRETCH = 2.0
"""How long an edge may be next to its distance from the eye: what one pixel allows must not vary much along it."""


class View(NamedTuple):
    """Whence meshes are seen.

    Attributes:
        eye: where the camera is.
        near: no surface has to be finer than one at this distance.
        pixel: the angle of a pixel, or of several where meshes may be coarser.
        most: triangles of one mesh, about; what asks for more stays coarser.

    """

    eye: Vector
    near: float
    pixel: float
    most: int = MOST_TRIANGLES


def most_triangles(pixels: int) -> int:
    """Of one mesh, for a picture of so many pixels."""
    return min(max(TRIANGLES_A_PIXEL * pixels, LEAST_TRIANGLES), MOST_TRIANGLES)


@dataclass(frozen=True, eq=False)
class QuadricMesh:
    """The surface of a quadric, or as much of it as is in a scene's bounds.

    Attributes:
        vertices: (n, 3) float64, scene units.
        normals: (n, 3) float64, of length 1, of the exact surface, outward. A cone's tip has a vertex a triangle.
        triangles: (m, 3) int64, counterclockwise as seen from outside.
        deviation: how far triangles, with float32 corners, are off the surface, about; none that are far away.
        tilt: the angle by which normals between the vertices are off there, about.

    """

    vertices: Floats
    normals: Floats
    triangles: Triangles
    deviation: float
    tilt: float

    def to_trimesh(self) -> "trimesh.Trimesh":
        """As a trimesh, vertices and triangles in the same order."""
        import trimesh  # late: takes a while, and only mesh files need it

        return trimesh.Trimesh(self.vertices, self.triangles, vertex_normals=self.normals, process=False)


@dataclass(frozen=True, eq=False)
class QuadricSolid:
    """A closed body as far as some bounds, and somewhat beyond: what booleans are made of.

    Attributes:
        vertices: (n, 3) float64, scene units.
        triangles: (m, 3) int64, counterclockwise as seen from outside of the body.
        surface: (m,) which triangles are the quadric's; the others close the body beyond the bounds.
        complement: whether what is inside of the quadric is all that this body is not.

    """

    vertices: Floats
    triangles: Triangles
    surface: NDArray[np.bool_]
    complement: bool


@np.errstate(all="ignore")  # numbers may be as large as they like
def quadric_mesh(shape: Quadric, bounds: Box, view: View, name: str = "quadric") -> QuadricMesh:
    """Make a mesh of a quadric that has a surface.

    Args:
        shape: the quadric.
        bounds: a box that holds all that can be seen.
        view: whence it is seen.
        name: what messages call it.

    Raises:
        MeshError: float32 numbers do not hold it.

    """
    frame = frame_of(shape)
    points, triangles, surface = _coarse(frame, _reach(frame, bounds), closed=False)
    triangles = triangles[surface]
    size = float(np.abs(frame.origin + points @ frame.axes.T).max(initial=0.0))
    if not SMALLEST < size < LARGEST:  # of NaN, too
        raise MeshError(f"{name}: single precision, of which meshes are, has no numbers for a size of {size:.3g}")
    inside = _in_box(frame, points, triangles, bounds)
    triangles = triangles[inside] if inside.any() else triangles
    points, triangles, _ = _refined(frame, _Mesh(points, triangles, np.full(len(triangles), True)), view, bounds)
    return _finished(frame, points, triangles, view)


@np.errstate(all="ignore")
def quadric_solid(shape: Quadric, bounds: Box, view: View) -> QuadricSolid:
    """Make a closed mesh of a quadric that has a surface, with the arguments of `quadric_mesh`."""
    frame = frame_of(shape)
    points, triangles, surface = _refined(frame, _coarse(frame, _reach(frame, bounds), closed=True), view)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    if (across * a).sum() * np.linalg.det(frame.axes) < 0:  # six volumes
        triangles = triangles[:, ::-1]
    outward = (across[surface] * frame.half_gradient(points)[triangles[surface]].sum(axis=1)).sum(axis=1)
    complement = bool(np.sign(outward).sum() * (across * a).sum() < 0)
    return QuadricSolid(frame.origin + points @ frame.axes.T, triangles, surface, complement)


def _reach(frame: Frame, bounds: Box) -> float:
    """How far a box reaches from the origin of a frame."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    return float(np.linalg.norm(np.where(corners, bounds.high, bounds.low) - frame.origin, axis=1).max())


# ---- Coarse meshes, in coordinates of the frame ----------------------------------------------------------------------


class _Mesh(NamedTuple):
    """Points, corners of triangles, and which of them are the quadric's: the others close what would be open."""

    points: Floats
    triangles: Triangles
    surface: NDArray[np.bool_]


def _coarse(frame: Frame, reach: float, closed: bool) -> _Mesh:
    """Closed bodies that end beyond a ball of the radius `reach` about the origin.

    Where they do not have to be closed, they end as soon as their surface is beyond.
    """
    values, constant, slope = frame.values, frame.constant, abs(frame.slope)
    # A quadric and its complement have one surface; here more eigenvalues are positive than negative.
    upward = 1.0
    if (values < 0).sum() > (values > 0).sum() or ((values < 0).sum() == (values > 0).sum() and constant > 0):
        values, constant, upward = -values, -constant, -1.0
    positive, negative = np.flatnonzero(values > 0), np.flatnonzero(values < 0)
    axes = [*positive, *negative, *(k for k in range(3) if values[k] == 0)]
    scale = np.array([1 / math.sqrt(abs(values[k])) if values[k] else 1.0 for k in axes])
    size = math.sqrt(abs(constant))
    sideways = math.inf if closed else 2 * reach / min(scale[:2])
    match len(positive), len(negative), bool(slope), bool(constant):
        case 3, 0, _, _:
            mesh = _ball(size)
        case 2, 1, _, False:
            mesh = _cone(min(reach / scale[2], sideways))
        case 2, 1, _, _:
            mesh = _hyperboloid(size, constant < 0, min(reach / scale[2], sideways))
        case 2, 0, True, _:
            mesh = _paraboloid(slope, min(math.sqrt(2 * slope * reach), sideways))
        case 2, 0, _, _:
            mesh = _swept(size * _ring(), reach)
        case 1, 1, True, _:
            mesh = _saddle(slope, reach * sum(1 / scale[:2]))
        case 1, 1, _, True:
            along = _angles(min(2 * reach / scale[0], math.inf if closed else reach / scale[1]) / size)
            branches = [side * size * np.cosh(along) for side in (-1, 1)]
            mesh = _joined(_swept(np.column_stack([b, size * np.sinh(along)]), reach, {-1}) for b in branches)
        case 1, 1, _, _:
            far = 2 * reach / min(scale[:2])
            wedges = [np.array([(side, -1.0), (0.0, 0.0), (side, 1.0)]) for side in (-1, 1)]
            mesh = _joined(_swept(far * wedge, reach, {-1}) for wedge in wedges)
        case 1, 0, True, _:
            along = _halved(min(math.sqrt(2 * slope * reach), math.inf if closed else reach / scale[0]))
            mesh = _upright(_swept(np.column_stack([along, along**2 / (2 * slope)]), reach, {-1}))
        case 1, 0, _, _:
            corners = [(-size, -reach), (-size, reach), (size, reach), (size, -reach)]
            mesh = _swept(np.array(corners), reach, {1, 3})
        case _:
            corners = [(-reach, 0.0), (reach, 0.0), (reach, reach), (-reach, reach)]
            mesh = _upright(_swept(np.array(corners), reach, {1, 2, 3}))
    placed = np.zeros_like(mesh.points)
    placed[:, axes] = mesh.points * scale
    placed[:, 2] *= upward if slope else 1.0
    return mesh._replace(points=placed)


def _ring() -> Floats:
    turns = 2 * np.pi * np.arange(AROUND) / AROUND
    return np.column_stack([np.cos(turns), np.sin(turns)])


def _angles(most: float) -> Floats:
    """Hyperbolic angles between those whose sine is `most` at least, either way, 0 among them.

    Of a middle that is tiny next to that, 0 is all.
    """
    end = max(2.0, math.asinh(most) / STEP) if math.isfinite(most) else 2.0
    positive = STEP * np.arange(max(1, math.ceil(end) - WIDEST), math.ceil(end) + 1)
    return np.concatenate([-positive[::-1], [0.0], positive])


def _halved(most: float) -> Floats:
    """From -most to most, ever finer toward 0."""
    positive = most * 2.0 ** np.arange(-HALVINGS, 1)
    return np.concatenate([-positive[::-1], [0.0], positive])


def _swept(profile: Floats, reach: float, others: Collection[int] = ()) -> _Mesh:
    """A prism: points (n, 2) around a convex profile, drawn out along the third axis.

    Its ends are not the quadric's, nor are the `others` of its sides, that after the last point being -1.
    """
    count = len(profile)
    side = np.full(count, True)
    side[list(others)] = False
    points, triangles = _grid(np.array([np.column_stack([profile, np.full(count, z)]) for z in (-reach, reach)]), True)
    return _with_lids(points, triangles, np.tile(side, 2), count)


def _upright(mesh: _Mesh) -> _Mesh:
    """The second axis and the third exchanged."""
    return mesh._replace(points=mesh.points[:, [0, 2, 1]], triangles=mesh.triangles[:, ::-1])


def _grid(points: Floats, rings: bool = False) -> tuple[Floats, Triangles]:
    """(n, m, 3) points, rows of which the neighbours are joined; all triangles go round the same way."""
    n, m, _ = points.shape
    index = np.arange(n * m).reshape(n, m)
    if rings:
        index = np.column_stack([index, index[:, 0]])
    a, b, c, d = (x.ravel() for x in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    return points.reshape(-1, 3), np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


def _with_lids(
    points: Floats, triangles: Triangles, surface: NDArray[np.bool_], count: int, first: bool = True
) -> _Mesh:
    """A grid of rings, closed by its last ring, and its `first`, of `count` points each."""
    k = np.arange(1, count - 1)
    lid = np.column_stack([np.zeros_like(k), k, k + 1])
    lids = [lid + (len(points) - count), *([lid[:, ::-1]] if first else [])]
    closed = np.vstack([triangles, *lids])
    return _Mesh(points, closed, np.concatenate([surface, np.full(len(closed) - len(surface), False)]))


def _rings(radii: Floats, heights: Floats) -> tuple[Floats, Triangles]:
    """Rings about the third axis, joined."""
    ring = _ring()
    rows = [np.column_stack([r * ring, np.full(AROUND, z)]) for r, z in zip(radii, heights, strict=True)]
    return _grid(np.array(rows), rings=True)


def _dome(radii: Floats, heights: Floats) -> _Mesh:
    """Rings about the third axis, from a tip on, which has radius 0."""
    points, triangles = _rings(radii[1:], heights[1:])
    around = np.arange(AROUND)
    fan = np.column_stack([np.full(AROUND, len(points)), np.roll(around, -1), around])
    surface = np.full(len(triangles) + AROUND, True)
    closed = _with_lids(points, np.vstack([triangles, fan]), surface, AROUND, first=False)
    return closed._replace(points=np.vstack([points, [0.0, 0.0, heights[0]]]))


def _ball(size: float) -> _Mesh:
    from trimesh.creation import icosphere

    mesh = icosphere(subdivisions=1)
    return _Mesh(size * np.asarray(mesh.vertices), np.asarray(mesh.faces, np.int64), np.full(len(mesh.faces), True))


def _cone(reach: float) -> _Mesh:
    return _joined(_dome(np.array([0.0, reach]), np.array([0.0, side * reach])) for side in (-1, 1))


def _hyperboloid(size: float, one_sheet: bool, reach: float) -> _Mesh:
    u = _angles(reach / size)
    if one_sheet:
        points, triangles = _rings(size * np.cosh(u), size * np.sinh(u))
        return _with_lids(points, triangles, np.full(len(triangles), True), AROUND)
    u = u[len(u) // 2 :]
    return _joined(_dome(size * np.sinh(u), side * size * np.cosh(u)) for side in (-1, 1))


def _paraboloid(slope: float, reach: float) -> _Mesh:
    radii = _halved(reach)[HALVINGS + 1 :]
    return _dome(radii, radii**2 / (2 * slope))


def _saddle(slope: float, reach: float) -> _Mesh:
    """By its two families of straight lines; closed by walls around it and a lid on top."""
    u, v = np.meshgrid(_halved(reach), _halved(reach))
    points, triangles = _grid(np.stack([(u + v) / 2, (u - v) / 2, u * v / (2 * slope)], axis=-1))
    above = points.copy()
    above[:, 2] = 2 * points[:, 2].max() + reach
    starts, ends = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    count = len(points)
    single = ~np.isin(starts * count + ends, ends * count + starts)
    p, q = starts[single], ends[single]
    walls = np.vstack([np.column_stack([q, p, p + count]), np.column_stack([q, p + count, q + count])])
    closed = np.vstack([triangles, walls, triangles[:, ::-1] + count])
    return _Mesh(np.vstack([points, above]), closed, np.arange(len(closed)) < len(triangles))


def _joined(meshes: Iterable[_Mesh]) -> _Mesh:
    """Several bodies as one, each with its triangles seen from outside."""
    points: list[Floats] = []
    triangles: list[Triangles] = []
    surfaces: list[NDArray[np.bool_]] = []
    for mesh in meshes:
        a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
        outward = (np.cross(b - a, c - a) * a).sum() > 0
        triangles.append(mesh.triangles[:, :: 1 if outward else -1] + sum(map(len, points)))
        points.append(mesh.points)
        surfaces.append(mesh.surface)
    return _Mesh(np.vstack(points), np.vstack(triangles), np.concatenate(surfaces))


# ---- Finer ones ------------------------------------------------------------------------------------------------------


def _refined(frame: Frame, mesh: _Mesh, view: View, bounds: Box | None = None) -> _Mesh:
    """Halve edges of the surface until none is too far off it, or too long; what leaves the bounds is dropped.

    Whether an edge is halved depends on its ends alone, so that neighbours agree, and a triangle stays that has none.
    """
    eye = frame.of(view.eye)
    points, triangles, surface = mesh
    finished: list[Triangles] = []
    flags: list[NDArray[np.bool_]] = []
    while len(triangles) and sum(map(len, finished)) + len(triangles) < view.most:
        pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        keys, owner = np.unique(pairs[:, 0] * len(points) + pairs[:, 1], return_inverse=True)
        ends = points[np.column_stack([keys // len(points), keys % len(points)])]
        halved, placed = _halves(frame, ends, eye, view)
        halved &= np.bincount(owner, np.repeat(surface, 3), len(keys)) > 0
        new = np.full(len(keys), -1)
        new[halved] = len(points) + np.arange(halved.sum())
        points = np.vstack([points, placed[halved]])
        corners = new[owner.reshape(-1, 3)]
        stays = (corners < 0).all(axis=1)
        finished.append(triangles[stays])
        flags.append(surface[stays])
        triangles, parents = _halved_triangles(triangles[~stays], corners[~stays])
        surface = surface[~stays][parents]
        if bounds is not None:
            inside = _in_box(frame, points, triangles, bounds)
            if inside.any() or any(map(len, finished)):
                triangles, surface = triangles[inside], surface[inside]
    return _Mesh(points, np.vstack([*finished, triangles]), np.concatenate([*flags, surface]))


def _halves(frame: Frame, ends: Floats, eye: Floats, view: View) -> tuple[NDArray[np.bool_], Floats]:
    """Which edges (n, 2, 3) are to be halved, and the place on the surface for the middle of each."""
    middle = ends.mean(axis=1)
    placed = _on_surface(frame, middle)
    distance = np.maximum(_to_segments(eye, ends), view.near)
    off = np.linalg.norm(placed - middle, axis=1) - ROUNDING * np.abs(middle).max(axis=1)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    share = OFF * np.clip(distance / (FAR * view.near), 1.0, COARSER)
    return (off > share * view.pixel * distance) | (length > STRETCH * distance), placed


def _to_segments(eye: Floats, ends: Floats) -> Floats:
    """Distances (n,) of a point from segments (n, 2, 3)."""
    start, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    share = ((eye - start) * way).sum(axis=1) / np.maximum((way * way).sum(axis=1), np.finfo(float).tiny)
    return np.asarray(np.linalg.norm(start + np.clip(share, 0, 1)[:, None] * way - eye, axis=1))


def _halved_triangles(triangles: Triangles, new: Triangles) -> tuple[Triangles, Triangles]:
    """Triangles whose edges, from each corner to the next, have a new vertex in the middle, or -1, but not all; and of
    each part the index of the whole.
    """
    count = (new >= 0).sum(axis=1)
    # Turned until, of one or two new vertices, the first is on the first edge, and the second on the second.
    first = np.where(count == 1, (new >= 0).argmax(axis=1), ((new < 0).argmax(axis=1) + 1) % 3)
    turn = (first[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(triangles, turn, axis=1).T
    p, q, r = np.take_along_axis(new, turn, axis=1).T
    parts = (
        (1, (a, p, c)),
        (1, (p, b, c)),
        (2, (a, p, c)),
        (2, (p, q, c)),
        (2, (p, b, q)),
        (3, (a, p, r)),
        (3, (p, b, q)),
        (3, (r, q, c)),
        (3, (p, q, r)),
    )
    corners = np.vstack([np.column_stack(part)[count == k] for k, part in parts])
    return corners, np.concatenate([np.flatnonzero(count == k) for k, _ in parts])


def _on_surface(frame: Frame, y: Floats) -> Floats:
    """Points (n, 3) near the surface, moved onto it along the gradient."""
    for _ in range(2):  # once more, for its roundings
        gradient = frame.half_gradient(y)
        length = np.linalg.norm(gradient, axis=1, keepdims=True)
        d = np.divide(gradient, length, out=np.zeros_like(gradient), where=length > 0)
        a, b, c = (frame.values * d * d).sum(axis=1), (gradient * d).sum(axis=1), frame.at(y)
        rest = b * b - a * c
        # The root nearer to 0; where there is none, the place where f is least.
        fall = b + np.sqrt(np.maximum(rest, 0.0))
        t = np.where(fall > 0, -c / np.where(fall > 0, fall, 1.0), 0.0)
        y = y + t[:, None] * d
    return y


def _in_box(frame: Frame, points: Floats, triangles: Triangles, bounds: Box) -> NDArray[np.bool_]:
    """Which triangles are not beyond one side of a box altogether."""
    corners = (frame.origin + points @ frame.axes.T)[triangles]
    return np.asarray(np.all((corners.max(axis=1) >= bounds.low) & (corners.min(axis=1) <= bounds.high), axis=1))


def _finished(frame: Frame, points: Floats, triangles: Triangles, view: View) -> QuadricMesh:
    """In the scene's coordinates, with normals, and what they are off by."""
    points, normals, triangles = _with_normals(frame, points, triangles.copy())
    used, corners = np.unique(triangles, return_inverse=True)
    points, normals, triangles = points[used], normals[used], corners.reshape(-1, 3)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    turned = (np.cross(b - a, c - a) * normals[triangles].sum(axis=1)).sum(axis=1) * np.linalg.det(frame.axes) < 0
    triangles[turned] = triangles[turned][:, ::-1]
    vertices = frame.origin + points @ frame.axes.T
    return QuadricMesh(vertices, normals @ frame.axes.T, triangles, *_errors(frame, points, normals, triangles, view))


def _with_normals(frame: Frame, points: Floats, triangles: Triangles) -> tuple[Floats, Floats, Triangles]:
    """Points, normals, triangles. A tip, or a point where planes cross, becomes several, each with the normal of its
    triangle's other corners.
    """
    normals = _units(frame.half_gradient(points))
    row, corner = np.nonzero((normals == 0).all(axis=1)[triangles])
    points = np.vstack([points, points[triangles[row, corner]]])
    normals = np.vstack([normals, _units(normals[triangles].sum(axis=1))[row]])
    triangles[row, corner] = np.arange(len(points) - len(row), len(points))
    return points, normals, triangles


def _errors(frame: Frame, points: Floats, normals: Floats, triangles: Triangles, view: View) -> tuple[float, float]:
    """How far triangles are off the surface, and their normals, in their middles and those of their edges: `deviation`
    and `tilt` of those that are seen best.
    """
    distance = np.linalg.norm(points[triangles].mean(axis=1) - frame.of(view.eye), axis=1)
    corners = triangles[distance <= max(FAR * view.near, 2 * distance.min())]
    shares = np.array([[1, 1, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1]]) / np.array([[3], [2], [2], [2]])
    middle, mean = ((shares @ rows[corners]).reshape(-1, 3) for rows in (points, normals))
    placed = _on_surface(frame, middle)
    off = float(np.linalg.norm(placed - middle, axis=1).max())
    sine = float(np.linalg.norm(np.cross(_units(mean), _units(frame.half_gradient(placed))), axis=1).max())
    largest = float(np.abs(points[corners]).max() + np.abs(frame.origin).max())
    return off + largest * 2.0**-24, math.asin(min(sine, 1.0))


def _units(rows: Floats) -> Floats:
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    units: Floats = np.divide(rows, length, out=np.zeros_like(rows), where=length > 0)
    return units
