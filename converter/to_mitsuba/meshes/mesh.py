"""The mesh of a polyhedron, and what is told where there is none."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import trimesh

Floats = NDArray[np.float64]
Long = NDArray[np.longdouble]
Method = Literal["hull", "polygons"]
Ring = list[int]
"""What is around a face, neighbours' planes or vertices, counterclockwise as seen from outside."""


class MeshError(ValueError):
    """A shape cannot be made a mesh; the message names it, and the plane or the leaf."""


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


class Mesh(Protocol):
    """What has triangles."""

    def to_trimesh(self) -> "trimesh.Trimesh":
        """As a trimesh, vertices and triangles in the same order."""
        ...


def write_ply(mesh: Mesh, path: Path) -> bool:
    """Write a binary PLY file: positions as float32, triangles in the mesh's order; return whether it has normals.

    Those of its vertices are written if it has them; else each triangle has its own.
    """
    smooth = hasattr(mesh, "normals")
    path.write_bytes(mesh.to_trimesh().export(file_type="ply", vertex_normal=smooth))
    return smooth


def listed(indices: Iterable[int]) -> str:
    """A few indices, e.g. "2, 5 and 7"."""
    words = [str(int(i)) for i in indices]
    if len(words) > 5:
        words = [*words[:4], f"{len(words) - 4} more"]
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
