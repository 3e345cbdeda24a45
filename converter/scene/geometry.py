"""Whether the shapes of a scene exist, and what is known of each."""

from collections.abc import Sequence

from converter.frozen import replace
from converter.scene.errors import Problem
from converter.scene.kept import kept_with
from converter.scene.model import Scene, Shape
from converter.shapes.kind import Facts
from converter.shapes.table import SHAPE_KINDS, shape_kind


def scene_facts(scene: Scene) -> tuple[Facts, ...]:
    """What is known of each object's shape. All in one go, kind by kind, and once for each scene."""
    kept = kept_with(scene)
    if "facts" not in kept:
        kept["facts"] = _looked_into([o.shape for o in scene.objects])
    found: tuple[Facts, ...] = kept["facts"]
    return found


def _looked_into(shapes: Sequence[Shape]) -> tuple[Facts, ...]:
    kinds = set(map(type, shapes))
    found = {kind: iter(SHAPE_KINDS[kind].facts([s for s in shapes if type(s) is kind])) for kind in kinds}
    return tuple([next(found[type(shape)]) for shape in shapes])


def simplified(scene: Scene) -> Scene:
    """`scene` with the simplest shapes that are the same; itself if it has them."""
    shapes = [shape_kind(o.shape).simplified(o.shape) for o in scene.objects]
    changed = [i for i, (shape, o) in enumerate(zip(shapes, scene.objects, strict=True)) if shape is not o.shape]
    if not changed:
        return scene
    objects, facts = list(scene.objects), list(scene_facts(scene))
    for i, found in zip(changed, _looked_into([shapes[i] for i in changed]), strict=True):
        objects[i], facts[i] = replace(objects[i], shape=shapes[i]), found
    result = replace(scene, objects=tuple(objects))
    kept_with(result)["facts"] = tuple(facts)
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
