"""A whole scene as a Mitsuba dictionary."""

from typing import Any

from converter.scene.model import Scene
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.to_mitsuba.camera import sensor
from converter.to_mitsuba.finishes import bsdf
from converter.to_mitsuba.integrator import Intersections, integrator
from converter.to_mitsuba.lights import light
from converter.to_mitsuba.pigments import texture
from converter.to_mitsuba.surfaces import surfaces


def scene_description(scene: Scene, settings: Settings, intersections: Intersections = "auto") -> dict[str, Any]:
    """Everything that `scene`, drawn with `settings`, needs, by names that say where it stands in the scene file.

    Raises:
        TextureError: a texture that is used cannot be read.
        PolyhedronError: a polyhedron cannot be made into a mesh.

    """
    needs = scene_needs(scene, settings)
    shapes, geometry = surfaces(scene, needs, settings)
    pairs = sorted({(o.finish, o.pigment) for o in scene.objects})
    description: dict[str, Any] = {
        "type": "scene",
        "embree_use_robust_intersections": True,
        "integrator": integrator(scene, needs, settings, geometry, intersections),
        "sensor": sensor(scene.camera, settings),
    }
    description |= {f"pigment_{i}": texture(scene.pigments[i]) for i in needs.pigments}
    for i, j in pairs:
        pigment = {"type": "ref", "id": f"pigment_{j}"}
        description[f"finish_{i}_pigment_{j}"] = bsdf(scene.finishes[i], needs.etas[i], pigment, settings)
    if needs.lit:
        description |= {f"light_{i}": light(source) for i, source in enumerate(scene.lights, start=1)}
    return description | shapes
