"""Whether the shapes of a scene exist, and what is known of each."""

from collections.abc import Sequence

from converter.frozen import replace
from converter.scene.errors import Problem
from converter.scene.facts import facts_of, with_facts
from converter.scene.kept import kept_with
from converter.scene.model import Scene
from converter.shapes.kind import Facts
from converter.shapes.table import shape_kind


def scene_facts(scene: Scene) -> Sequence[Facts]:
    """What is known of each object's shape, once for each scene."""
    kept = kept_with(scene)
    if "facts" not in kept:
        kept["facts"] = facts_of([o.shape for o in scene.objects])
    found: Sequence[Facts] = kept["facts"]
    return found


def simplified(scene: Scene) -> Scene:
    """`scene` with the simplest shapes that are the same; itself if it has them."""
    shapes = [shape_kind(o.shape).simplified(o.shape) for o in scene.objects]
    changed = [i for i, (shape, o) in enumerate(zip(shapes, scene.objects, strict=True)) if shape is not o.shape]
    if not changed:
        return scene
    objects = list(scene.objects)
    for i in changed:
        objects[i] = replace(objects[i], shape=shapes[i])
    result = replace(scene, objects=tuple(objects))
    kept_with(result)["facts"] = with_facts(scene_facts(scene), {i: shapes[i] for i in changed})
    return result


def check_geometry(scene: Scene, facts: Sequence[Facts] | None = None) -> list[Problem]:
    """What is wrong with the shapes of `scene`: half-spaces that exclude one another, or leave no face.

    Args:
        scene: any scene.
        facts: its `scene_facts`, if they are at hand.

    """
    known = scene_facts(scene) if facts is None else facts
    return [
        Problem(scene.file, o.line, 1, f"object {i} is nothing: {shape_kind(o.shape).why_nothing(o.shape, fact)}")
        for i, (o, fact) in enumerate(zip(scene.objects, known, strict=True))
        if not fact.drawn
    ]
