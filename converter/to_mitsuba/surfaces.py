"""Objects as exact surfaces for the integrator, and as Mitsuba's shapes."""

from typing import Any

from converter.scene.model import Object, Scene
from converter.scene.needs import SceneNeeds
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind
from converter.to_mitsuba.fineness import USUAL, Fineness
from converter.to_mitsuba.meshing import Meshing


def material_name(o: Object) -> str:
    """What the BSDF of an object is called."""
    return f"finish_{o.finish}_pigment_{o.pigment}"


def exact_surfaces(scene: Scene, needs: SceneNeeds) -> dict[str, dict[str, Any]]:
    """Every object by its name, as the integrator's `geometry` lists them."""
    return {
        f"object_{i}": {"material": material_name(o), **shape_kind(o.shape).geometry(o.shape, facts), **_motion(o)}
        for i, (o, facts) in enumerate(zip(scene.objects, needs.facts, strict=True))
    }


def _motion(o: Object) -> dict[str, Any]:
    return {"move": list(o.move)} if any(o.move) else {}


def shapes(
    scene: Scene, settings: Settings, fineness: Fineness = USUAL
) -> tuple[dict[str, dict[str, Any]], dict[str, dict[str, Any]]]:
    """Every object as a shape, by its name, and what `geometry` has to tell of the meshes among them.

    Raises:
        MeshError: a shape cannot be made a mesh.
        ValueError: the tolerance asks for too many triangles.

    """
    meshing = Meshing(scene, settings, fineness)
    result: dict[str, dict[str, Any]] = {}
    meshes: dict[str, dict[str, Any]] = {}
    for i, o in enumerate(scene.objects):
        element, told = shape_kind(o.shape).mitsuba_shape(o.shape, meshing, f"object {i}")
        result[f"object_{i}"] = element | {"bsdf": {"type": "ref", "id": material_name(o)}}
        if told:
            meshes[f"object_{i}"] = told
    return result, meshes
