"""Whether the shapes of a scene exist, and what is known of each."""

from collections.abc import Sequence
from dataclasses import replace
from weakref import ReferenceType, ref

from converter.scene.errors import Problem
from converter.scene.model import Scene, Shape
from converter.shapes.kind import Facts
from converter.shapes.table import SHAPE_KINDS, shape_kind

_latest: tuple[ReferenceType[Scene], tuple[Facts, ...]] | None = None


def scene_facts(scene: Scene) -> tuple[Facts, ...]:
    """What is known of each object's shape. All in one go, kind by kind.

    The latest scene's facts are kept for as long as it lives: checking a scene, modelling it, and closing its unbounded
    bodies take the same ones.
    """
    global _latest
    if _latest is None or _latest[0]() is not scene:
        _latest = (ref(scene, _forget), _looked_into([o.shape for o in scene.objects]))
    return _latest[1]


def _looked_into(shapes: Sequence[Shape]) -> tuple[Facts, ...]:
    kinds = set(map(type, shapes))
    found = {kind: iter(SHAPE_KINDS[kind].facts([s for s in shapes if type(s) is kind])) for kind in kinds}
    return tuple([next(found[type(shape)]) for shape in shapes])


def _forget(scene: ReferenceType[Scene]) -> None:
    global _latest
    if _latest is not None and _latest[0] is scene:
        _latest = None


def simplified(scene: Scene) -> Scene:
    """`scene` with the simplest shapes that are the same; itself if it has them."""
    objects = []
    for o in scene.objects:
        shape = shape_kind(o.shape).simplified(o.shape)
        objects.append(o if shape is o.shape else replace(o, shape=shape))
    return (
        scene
        if all(a is b for a, b in zip(objects, scene.objects, strict=True))
        else replace(scene, objects=tuple(objects))
    )


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
