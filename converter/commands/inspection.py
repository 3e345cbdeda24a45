"""What a scene file holds and what it needs, as plain data."""

from collections import Counter
from dataclasses import asdict
from typing import Any

from converter.analysis.cutoff import cutoff_bound
from converter.analysis.notices import ior_notices, scene_notices
from converter.commands.csg_trees import csg_trees
from converter.pigments.table import pigment_kind
from converter.scene.geometry import simplified
from converter.scene.model import Finish, Pigment, Polyhedron, Quadric, Scene
from converter.scene.needs import SceneNeeds, is_index, scene_needs
from converter.scene.settings import Settings
from converter.shapes.quadric import classified
from converter.shapes.table import shape_kind


def inspect_scene(scene: Scene, settings: Settings) -> dict[str, Any]:
    """Everything that `whitted inspect` tells, in the order in which it does."""
    drawn = simplified(scene)
    needs = scene_needs(drawn, settings)
    polyhedra = _polyhedra(drawn, needs)
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
            "kinds": dict(Counter(shape_kind(o.shape).NAME for o in scene.objects)),
            "planes": sum(len(p["planes"]) + len(p["redundant_planes"]) for p in polyhedra),
            "redundant_planes": sum(len(p["redundant_planes"]) for p in polyhedra),
            "unbounded": sum(not bounded for bounded in needs.bounded),
        },
        "polyhedra": polyhedra,
        "quadrics": _quadrics(scene, drawn, needs),
        "csgs": csg_trees(scene, drawn, needs),
        "moving": [{"object": i, "line": o.line, "move": o.move} for i, o in enumerate(scene.objects) if any(o.move)],
        "closing_box": _closing_box(drawn, needs, settings),
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
            "effects": list(needs.effects),
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
    from converter.analysis.regions.warnings import region_warnings
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
    kind = pigment_kind(pigment)
    return {"kind": kind.SPELLINGS[0], **kind.facts(pigment)}


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
            "redundant_planes": sorted(set(range(len(planes))).difference(needs.planes[i])),
            "bounded": needs.bounded[i],
            "plate": needs.plates[i],
        }
        for i, o in enumerate(scene.objects)
        if isinstance(o.shape, Polyhedron)
        for planes in (o.shape.planes,)
    ]


def _quadrics(scene: Scene, drawn: Scene, needs: SceneNeeds) -> list[dict[str, Any]]:
    return [
        {
            "object": i,
            "line": o.line,
            "kind": classified(o.shape),
            "drawn_as": shape_kind(simple.shape).NAME,
            "bounded": needs.bounded[i],
        }
        for i, (o, simple) in enumerate(zip(scene.objects, drawn.objects, strict=True))
        if isinstance(o.shape, Quadric)
    ]


def _closing_box(scene: Scene, needs: SceneNeeds, settings: Settings) -> dict[str, Any] | None:
    """Where Mitsuba's meshes of what has no bounds end."""
    if all(needs.bounded):
        return None
    from converter.to_mitsuba.bounds import scene_bounds

    return scene_bounds(scene, settings)._asdict()
