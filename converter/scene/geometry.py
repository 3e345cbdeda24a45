"""Whether the shapes of a scene exist, and what its polyhedra are like."""

from collections.abc import Sequence
from math import hypot
from weakref import ReferenceType, ref

from converter.scene.errors import Problem
from converter.scene.model import Plane, Polyhedron, Scene
from native_tracer.halfspaces import PolyhedronFacts, polyhedron_facts

__all__ = ["PolyhedronFacts", "check_geometry", "scene_facts"]


_latest: tuple[ReferenceType[Scene], tuple[PolyhedronFacts | None, ...]] | None = None


def scene_facts(scene: Scene) -> tuple[PolyhedronFacts | None, ...]:
    """For each object what is known of its polyhedron; None if it is something else. All in one go.

    The latest scene's facts are kept for as long as it lives: checking a scene, modelling it, and closing its unbounded
    bodies take the same ones.
    """
    global _latest
    if _latest is None or _latest[0]() is not scene:
        facts = iter(polyhedron_facts(o.shape.planes for o in scene.objects if isinstance(o.shape, Polyhedron)))
        found = tuple(next(facts) if isinstance(o.shape, Polyhedron) else None for o in scene.objects)
        _latest = (ref(scene, _forget), found)
    return _latest[1]


def _forget(scene: ReferenceType[Scene]) -> None:
    global _latest
    if _latest is not None and _latest[0] is scene:
        _latest = None


def check_geometry(scene: Scene, facts: Sequence[PolyhedronFacts | None] | None = None) -> list[Problem]:
    """What is wrong with the shapes of `scene`: half-spaces that exclude one another, or leave no face.

    Args:
        scene: any scene.
        facts: its `scene_facts`, if they are at hand.

    """
    known = scene_facts(scene) if facts is None else facts
    return [
        Problem(scene.file, o.line, 1, f"object {i} is nothing: {_why_nothing(o.shape.planes, fact.conflict)}")
        for i, (o, fact) in enumerate(zip(scene.objects, known, strict=True))
        if isinstance(o.shape, Polyhedron) and fact is not None and not fact.drawn
    ]


def _why_nothing(planes: Sequence[Plane], conflict: Sequence[int]) -> str:
    """E.g. "its planes 2 (0 1 0 -1) and 5 (0 -1 0 3) exclude each other", planes counted from 0."""
    named = [f"{k} ({' '.join(f'{x:.12g}' for x in planes[k])})" for k in conflict]
    listed = " and ".join([", ".join(named[:-1]), named[-1]])
    if len(conflict) > 2:
        return f"its planes {listed} have no volume in common"
    # Two planes without a volume between them are parallel, and face away from each other.
    distances = [planes[k][3] / hypot(*planes[k][:3]) for k in conflict]
    apart = sum(distances) > 1e-12 * max(map(abs, distances))
    if apart:
        return f"its planes {listed} exclude each other: inside is a x + b y + c z + d <= 0, so turn the signs of both"
    return f"its planes {listed} touch, and leave neither a volume nor a face"
