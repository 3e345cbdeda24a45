"""What a scene file holds and what it needs, as plain data."""

from collections import Counter
from dataclasses import asdict
from typing import Any

from converter.scene.cutoff import cutoff_bound
from converter.scene.model import Checker, Finish, Pigment, Polyhedron, Scene, Solid
from converter.scene.needs import SceneNeeds, is_index, scene_needs
from converter.scene.notices import ior_notices, scene_notices
from converter.scene.settings import Settings


def inspect_scene(scene: Scene, settings: Settings) -> dict[str, Any]:
    """Everything that `whitted inspect` tells, in the order in which it does."""
    needs = scene_needs(scene, settings)
    polyhedra = _polyhedra(scene, needs)
    return {
        "file": str(scene.file or ""),
        "camera": asdict(scene.camera),
        "ambient": scene.ambient,
        "background": needs.background,
        "lights": [{"light": i, **asdict(light)} for i, light in enumerate(scene.lights, start=1)],
        "pigments": _pigments(scene),
        "finishes": _finishes(scene, needs, settings),
        "objects": {
            "count": len(scene.objects),
            "kinds": dict(Counter(type(o.shape).__name__.lower() for o in scene.objects)),
            "planes": sum(len(p["planes"]) + len(p["redundant_planes"]) for p in polyhedra),
            "redundant_planes": sum(len(p["redundant_planes"]) for p in polyhedra),
            "unbounded": sum(not p["bounded"] for p in polyhedra),
        },
        "polyhedra": polyhedra,
        "closing_box": _closing_box(scene, needs, settings),
        "unused": {
            "pigments": [i for i in range(len(scene.pigments)) if i not in needs.pigments],
            "finishes": [i for i in range(len(scene.finishes)) if i not in needs.finishes],
        },
        "needs": {
            "reflects": needs.reflects,
            "refracts": needs.refracts,
            "branches": needs.branches,
            "lit": needs.lit,
            "glossy": needs.glossy,
            "max_depth": needs.max_depth,
            "max_depth_rule": needs.depth.rule,
        },
        "cutoff": asdict(cutoff_bound(scene, settings)),
        "reading_warnings": scene.warnings,
        "notices": [*scene_notices(scene, settings), *ior_notices(scene, settings)],
        "warnings": _warnings(scene, settings),
    }


def _warnings(scene: Scene, settings: Settings) -> dict[str, tuple[str, ...]]:
    """Where methods are known to fail with the scene, by their names; a method for each arithmetic."""
    from converter.regions.warnings import region_warnings
    from converter.renderers.methods import METHODS, Method

    methods: dict[str | None, Method] = {}
    for method in METHODS.values():
        methods.setdefault(method.arithmetic, method)
    found = {method.name: region_warnings(scene, settings, method) for method in methods.values()}
    return {name: warnings for name, warnings in found.items() if warnings}


def _pigments(scene: Scene) -> list[dict[str, Any]]:
    uses = Counter(o.pigment for o in scene.objects)
    return [{"pigment": i, "objects": uses[i], **_pigment(pigment)} for i, pigment in enumerate(scene.pigments)]


def _pigment(pigment: Pigment) -> dict[str, Any]:
    kind = {"kind": type(pigment).__name__.lower()}
    if isinstance(pigment, Solid | Checker):
        return {**kind, **asdict(pigment)}
    from converter.images.texture import probe_texture

    # A scene may have one that is missing, if no object uses it.
    width, height = probe_texture(pigment.file) if pigment.file.exists() else (None, None)
    return {**kind, "file": str(pigment.file), "width": width, "height": height, "p0": pigment.p0, "p1": pigment.p1}


def _finishes(scene: Scene, needs: SceneNeeds, settings: Settings) -> list[dict[str, Any]]:
    uses = Counter(o.finish for o in scene.objects)
    return [
        {
            "finish": i,
            "line": scene.finish_lines[i] if i < len(scene.finish_lines) else 0,
            "objects": uses[i],
            **asdict(finish),
            "ior_read_as": _reading(finish, settings),
            "n1/n2": needs.etas[i],
        }
        for i, finish in enumerate(scene.finishes)
    ]


def _reading(finish: Finish, settings: Settings) -> str | None:
    if finish.kt == 0:
        return None
    return "n2/n1" if is_index(finish, settings.ior) else "n1/n2"


def _polyhedra(scene: Scene, needs: SceneNeeds) -> list[dict[str, Any]]:
    return [
        {
            "object": i,
            "line": o.line,
            "planes": needs.planes[i],
            "redundant_planes": sorted(set(range(len(o.shape.planes))).difference(needs.planes[i])),
            "bounded": needs.bounded[i],
            "plate": needs.plates[i],
        }
        for i, o in enumerate(scene.objects)
        if isinstance(o.shape, Polyhedron)
    ]


def _closing_box(scene: Scene, needs: SceneNeeds, settings: Settings) -> dict[str, Any] | None:
    """Where Mitsuba's meshes of unbounded polyhedra end."""
    if all(needs.bounded):
        return None
    from converter.to_mitsuba.bounds import scene_bounds

    return scene_bounds(scene, settings)._asdict()
