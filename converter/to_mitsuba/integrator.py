"""The Whitted integrator: the ambient light, how deep to go, what the scene needs, and its exact surfaces."""

import json
from typing import Any, Literal

from converter.analysis.cutoff import cutoff_bound
from converter.scene.model import Scene
from converter.scene.needs import SceneNeeds
from converter.scene.settings import Settings
from converter.to_mitsuba.lights import color

Intersections = Literal["auto", "analytic", "bvh", "mesh", "offset", "ulp"]
RayPrecision = Literal["double", "float", "mixed"]


def integrator(
    scene: Scene,
    needs: SceneNeeds,
    settings: Settings,
    geometry: dict[str, Any],
    intersections: Intersections = "auto",
    precision: RayPrecision = "double",
) -> dict[str, Any]:
    """A `whitted` integrator; `geometry` maps each object's name to its exact surface (see `surfaces`)."""
    materials = sorted({surface["material"] for surface in geometry.values()})
    return {
        "type": "whitted",
        "geometry": json.dumps(geometry),
        "ambient": color(scene.ambient),
        "background": color(needs.background),
        "max_depth": needs.max_depth,
        "waiting": needs.depth.waiting,
        "depth_limited": needs.depth.acts,
        "cutoff": settings.cutoff,
        **({"seed": settings.seed, "points": settings.points} if needs.sampled else {}),
        "reflection": needs.reflects,
        "refraction": needs.refracts,
        "branching": needs.branches,
        "shadows": needs.lit,
        "highlights": needs.glossy,
        "intersections": intersections,
        "precision": precision,
        **({"brightest": cutoff_bound(scene, settings).brightest} if precision == "mixed" else {}),
        **{name: {"type": "ref", "id": name} for name in materials},
    }
