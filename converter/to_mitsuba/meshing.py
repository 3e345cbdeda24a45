"""How fine the meshes of a scene are, and where those of what has no bounds end."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Scene, Sphere
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind
from converter.to_mitsuba.bounds import Box, scene_bounds
from converter.to_mitsuba.fineness import USUAL, Fineness
from converter.to_mitsuba.meshes.quadrics import View, most_triangles

MOST_TRIANGLES = 1 << 24
"""Of all spheres together, where they are meshes."""

NEAR = 8
"""What is nearer to the eye than this share of what it looks at is meshed as if it were not."""


@dataclass(frozen=True, eq=False)
class SphereMesh:
    """A sphere as triangles: vertices and their normals (n, 3) float64, and triangles (m, 3)."""

    vertices: NDArray[np.float64]
    normals: NDArray[np.float64]
    triangles: NDArray[np.int64]

    def placed(self, sphere: Sphere) -> "SphereMesh":
        """Move and scale this unit sphere."""
        return SphereMesh(sphere.center + sphere.radius * self.normals, self.normals, self.triangles)


def unit_ball(tolerance: float, count: int = 1) -> SphereMesh:
    """A unit sphere around the origin: an icosahedron, divided until no triangle is off by more than `tolerance`.

    Raises:
        ValueError: `count` of them would have more than `MOST_TRIANGLES`.

    """
    from trimesh.creation import icosphere

    # Each division halves the triangles' size, and quarters what they are off by.
    divisions = 0
    while 20 * 4**divisions * count <= MOST_TRIANGLES:
        mesh = icosphere(subdivisions=divisions)
        if 1 - np.abs(np.sum(mesh.face_normals * mesh.triangles[:, 0], axis=1)).min() <= tolerance:
            return SphereMesh(mesh.vertices, mesh.vertices, mesh.faces)
        divisions += 1
    raise ValueError(f"{count} spheres off by {tolerance:g} of their radius at most would have too many triangles")


@dataclass(frozen=True)
class Meshing:
    """What the shapes of a scene are made meshes by.

    Attributes:
        scene, settings: what is drawn, and how.
        fineness: what meshes may be off by.

    """

    scene: Scene
    settings: Settings
    fineness: Fineness = USUAL

    @cached_property
    def bounds(self) -> Box:
        """Where meshes of what has no bounds end."""
        return scene_bounds(self.scene, self.settings)

    @cached_property
    def view(self) -> View:
        """Whence meshes are seen that are as fine as the picture needs."""
        camera, rows = self.scene.camera, self.settings.height * math.isqrt(self.settings.rays_a_pixel())
        pixel = 2 * math.tan(math.radians(camera.fovy) / 2) / rows
        near = math.dist(camera.eye, camera.look_at) / NEAR
        most = most_triangles(self.settings.width * self.settings.height * self.settings.rays_a_pixel())
        return View(camera.eye, near, pixel * self.fineness.pixels / USUAL.pixels, most)

    @cached_property
    def unit_ball(self) -> SphereMesh | None:
        """What balls are made of, if they are meshes.

        Raises:
            ValueError: the tolerance asks for more than `MOST_TRIANGLES`.

        """
        if self.fineness.spheres is None:
            return None
        count = sum(shape_kind(o.shape).ball(o.shape) is not None for o in self.scene.objects)
        return unit_ball(self.fineness.spheres, count)
