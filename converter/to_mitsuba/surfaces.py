"""Objects as Mitsuba shapes, and their exact surfaces beside them."""

from typing import Any

from converter.scene.model import Polyhedron, Scene, Sphere
from converter.scene.needs import SceneNeeds
from converter.scene.settings import Settings


def surfaces(scene: Scene, needs: SceneNeeds, settings: Settings) -> tuple[dict[str, Any], dict[str, Any]]:
    """Every object as a shape, and as an exact surface as the integrator's `geometry` lists them, both by name.

    A sphere is Mitsuba's `sphere`, a polyhedron a `mesh` that holds a `PolyhedronMesh` of ours.
    """
    shapes: dict[str, Any] = {}
    geometry: dict[str, Any] = {}
    bounds = None
    if any(isinstance(o.shape, Polyhedron) for o in scene.objects):
        from converter.to_mitsuba.bounds import scene_bounds

        bounds = scene_bounds(scene, settings)
    for i, o in enumerate(scene.objects):
        name = f"object_{i}"
        shapes[name], geometry[name] = (
            _sphere(o.shape) if isinstance(o.shape, Sphere) else _polyhedron(o.shape, needs, i, bounds)
        )
        shapes[name]["bsdf"] = {"type": "ref", "id": f"finish_{o.finish}_pigment_{o.pigment}"}
    return shapes, geometry


def _sphere(sphere: Sphere) -> tuple[dict[str, Any], dict[str, Any]]:
    shape = {"type": "sphere", "center": list(sphere.center), "radius": sphere.radius}
    return shape, {"sphere": [*sphere.center, sphere.radius]}


def _polyhedron(
    polyhedron: Polyhedron, needs: SceneNeeds, i: int, bounds: Any
) -> tuple[dict[str, Any], dict[str, Any]]:
    from converter.to_mitsuba.polyhedra import polyhedron_mesh

    mesh = polyhedron_mesh(polyhedron.planes, bounds, f"object {i}")
    surface = {
        "planes": {str(index): list(polyhedron.planes[index]) for index in needs.planes[i]},
        "triangles": mesh.planes.tolist(),
        "box": needs.boxes[i] if needs.bounded[i] else None,
        "deviation": mesh.deviation,
    }
    return {"type": "mesh", "mesh": mesh}, surface
