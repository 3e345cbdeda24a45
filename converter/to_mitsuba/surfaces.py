"""Objects as exact surfaces for the integrator, and as Mitsuba's shapes."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from converter.scene.model import Object, Polyhedron, Scene, Sphere
from converter.scene.needs import SceneNeeds
from converter.scene.settings import Settings
from converter.to_mitsuba.bounds import Box, scene_bounds

MOST_TRIANGLES = 1 << 24
"""Of all spheres together, where they are meshes."""


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


def material_name(o: Object) -> str:
    """What the BSDF of an object is called."""
    return f"finish_{o.finish}_pigment_{o.pigment}"


def exact_surfaces(scene: Scene, needs: SceneNeeds) -> dict[str, dict[str, Any]]:
    """Every object by its name, as the integrator's `geometry` lists them."""
    return {f"object_{i}": _exact(o, needs, i) for i, o in enumerate(scene.objects)}


def _exact(o: Object, needs: SceneNeeds, i: int) -> dict[str, Any]:
    material = material_name(o)
    if isinstance(o.shape, Sphere):
        return {"material": material, "sphere": [*o.shape.center, o.shape.radius]}
    planes = {str(index): list(o.shape.planes[index]) for index in needs.planes[i]}
    return {"material": material, "planes": planes, "box": needs.boxes[i] if needs.bounded[i] else None}


def shapes(
    scene: Scene, settings: Settings, sphere_tolerance: float | None = None
) -> tuple[dict[str, dict[str, Any]], dict[str, dict[str, Any]]]:
    """Every object as a shape, by its name, and what `geometry` has to tell of the meshes among them.

    A sphere is Mitsuba's `sphere`, a polyhedron a `mesh` that holds a `PolyhedronMesh` of ours. With a tolerance,
    spheres are meshes too, their triangles off by no more than that share of the radius.

    Raises:
        PolyhedronError: a polyhedron cannot be made into a mesh.
        ValueError: the tolerance asks for more than `MOST_TRIANGLES`.

    """
    result: dict[str, dict[str, Any]] = {}
    meshes: dict[str, dict[str, Any]] = {}
    bounds: Box | None = None
    ball = None
    if sphere_tolerance is not None:
        ball = unit_ball(sphere_tolerance, sum(isinstance(o.shape, Sphere) for o in scene.objects))
    for i, o in enumerate(scene.objects):
        name = f"object_{i}"
        if isinstance(o.shape, Polyhedron):
            from converter.to_mitsuba.polyhedra import polyhedron_mesh

            bounds = bounds or scene_bounds(scene, settings)
            mesh = polyhedron_mesh(o.shape.planes, bounds, f"object {i}")
            result[name] = {"type": "mesh", "mesh": mesh}
            meshes[name] = {"triangles": mesh.planes.tolist(), "deviation": mesh.deviation}
        elif ball is not None:
            result[name] = {"type": "mesh", "mesh": ball.placed(o.shape)}
        else:
            result[name] = {"type": "sphere", "center": list(o.shape.center), "radius": o.shape.radius}
        result[name]["bsdf"] = {"type": "ref", "id": material_name(o)}
    return result, meshes
