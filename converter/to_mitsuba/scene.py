"""A whole scene as a Mitsuba dictionary."""

from typing import Any

from converter.analysis.coplanar import with_planes_shared
from converter.pigments.table import pigment_kind
from converter.renderers.base import refuse_effects
from converter.scene.effects import Effect
from converter.scene.geometry import simplified
from converter.scene.model import Scene
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.to_mitsuba.camera import sensor
from converter.to_mitsuba.fineness import USUAL, Fineness
from converter.to_mitsuba.finishes import bsdf
from converter.to_mitsuba.integrator import Intersections, RayPrecision, integrator
from converter.to_mitsuba.lights import light
from converter.to_mitsuba.surfaces import exact_surfaces, material_name, shapes

EFFECTS: tuple[Effect, ...] = ("soft shadows", "glossy rays", "depth of field", "motion")
"""What of distributed ray tracing the integrator draws."""
STILL: tuple[Intersections, ...] = ("mesh", "offset", "ulp")
"""Intersections that use Mitsuba's shapes, which do not move."""
MOVING = "native, mitsuba-analytic and mitsuba-bvh do"


def scene_description(
    scene: Scene,
    settings: Settings,
    intersections: Intersections = "auto",
    precision: RayPrecision = "double",
    fineness: Fineness = USUAL,
    with_shapes: bool = True,
) -> dict[str, Any]:
    """Everything that `scene`, drawn with `settings`, needs, by names that say where it stands in the scene file.

    The integrator knows the exact surfaces. Mitsuba's shapes, which take their time, are for other integrators, and
    for intersections that use them: "mesh", "offset", "ulp".

    Raises:
        EffectUnavailable: the integrator cannot draw it.
        TextureError: a texture that is used cannot be read.
        MeshError, ValueError: as `shapes` has it.

    """
    scene = with_planes_shared(simplified(scene))
    needs = scene_needs(scene, settings)
    refuse_effects(needs, "Mitsuba with our plugins", EFFECTS)
    if intersections in STILL:
        still = [effect for effect in EFFECTS if effect != "motion"]
        refuse_effects(needs, f"Mitsuba with intersections by its own shapes ({intersections})", still, MOVING)
    geometry = exact_surfaces(scene, needs)
    found: dict[str, Any] = {}
    if with_shapes:
        found, meshes = shapes(scene, settings, fineness)
        for name, facts in meshes.items():
            geometry[name] |= facts
    description: dict[str, Any] = {
        "type": "scene",
        "embree_use_robust_intersections": True,
        "sensor": sensor(scene.camera, settings, needs.samples),
    }
    description |= {f"pigment_{i}": pigment_kind(p).texture(p) for i in needs.pigments for p in (scene.pigments[i],)}
    for o in {(o.finish, o.pigment): o for o in scene.objects}.values():
        pigment = {"type": "ref", "id": f"pigment_{o.pigment}"}
        description[material_name(o)] = bsdf(scene.finishes[o.finish], needs.etas[o.finish], pigment, settings)
    description["integrator"] = integrator(scene, needs, settings, geometry, intersections, precision)
    if needs.lit:
        description |= {f"light_{i}": light(source) for i, source in enumerate(scene.lights, start=1)}
    return description | found
