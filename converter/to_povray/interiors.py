"""Refractive indices of transparent bodies.

POV-Ray remembers which bodies a ray is in, and takes n1/n2 from the innermost one and the one that it enters. Our
finishes say n1/n2 themselves, whatever is around. So a body's index is multiplied by that of the body around it.

POV-Ray finds out by itself which bodies the camera is in, but not of every kind. A body with the camera in it is
therefore made of what is outside of it, with the reciprocal index: its `inverse`, which the camera is not in.
"""

import math
from enum import Enum
from itertools import combinations
from operator import lt
from typing import TYPE_CHECKING, NamedTuple

from converter.scene.model import Polyhedron, Scene, Shape, Sphere
from converter.scene.needs import SceneNeeds
from converter.shapes.polyhedron import signed_distances
from converter.shapes.table import shape_kind

if TYPE_CHECKING:
    from native_tracer.halfspaces import PolyhedronFacts


class Interior(NamedTuple):
    """What POV-Ray is told of the inside of a body: its index, and whether the body is its own inverse."""

    ior: float
    inverse: bool


class Relation(Enum):
    """How two bodies lie to each other."""

    APART = 0
    FIRST_INSIDE = 1
    SECOND_INSIDE = 2
    OVERLAP = 3


def interiors(scene: Scene, needs: SceneNeeds) -> tuple[dict[int, Interior], list[tuple[int, int]]]:
    """The interior of each object that transmits, by its index, and pairs of such objects that overlap."""
    bodies = [i for i, o in enumerate(scene.objects) if scene.finishes[o.finish].kt > 0]
    inverse = {i: shape_kind(s).contains(s, scene.camera.eye) for i in bodies for s in (scene.objects[i].shape,)}
    around: dict[int, set[int]] = {i: set() for i in bodies}
    overlaps = []
    for i, j in combinations(bodies, 2):
        match relation(scene, needs, i, j), inverse[i], inverse[j]:
            case (Relation.FIRST_INSIDE, False, False) | (Relation.SECOND_INSIDE, True, True):
                around[i].add(j)
            case (Relation.SECOND_INSIDE, False, False) | (Relation.FIRST_INSIDE, True, True):
                around[j].add(i)
            case (Relation.APART, False, True):
                around[i].add(j)
            case (Relation.APART, True, False):
                around[j].add(i)
            case (Relation.OVERLAP, _, _):
                overlaps.append((i, j))
    iors: dict[int, float] = {}
    for i in _outermost_first(around):
        own = needs.etas[scene.objects[i].finish]
        innermost = max(around[i] & iors.keys(), key=lambda body: len(around[body]), default=None)
        iors[i] = (own if inverse[i] else 1 / own) * (1.0 if innermost is None else iors[innermost])
    return {i: Interior(iors[i], inverse[i]) for i in bodies}, overlaps


def _outermost_first(around: dict[int, set[int]]) -> list[int]:
    """The bodies, each after those around it; where roundings put one around itself by way of others, somewhere.

    Not by the number of those around it alone: of bodies without bounds it is not always known that they are.
    """
    ordered: dict[int, None] = {}
    waiting = sorted(around, key=lambda body: len(around[body]), reverse=True)
    begun: set[int] = set()
    while waiting:
        body = waiting[-1]
        before = [other for other in sorted(around[body]) if other not in begun]
        if body in begun or not before:
            ordered[waiting.pop()] = None
        else:
            waiting.extend(before)
        begun.add(body)
    return list(ordered)


def relation(scene: Scene, needs: SceneNeeds, i: int, j: int) -> Relation:
    """How objects `i` and `j` lie to each other.

    A ball close to an edge of a polyhedron may count as overlapping; kinds that nothing is known of do.
    """
    if needs.bounded[i] and needs.bounded[j]:
        (low, high), (other_low, other_high) = needs.boxes[i], needs.boxes[j]
        if any(map(lt, high, other_low)) or any(map(lt, other_high, low)):
            return Relation.APART
    first, second = scene.objects[i].shape, scene.objects[j].shape
    if _apart(first, second):
        return Relation.APART
    if needs.bounded[i] and _inside(first, second):
        return Relation.FIRST_INSIDE
    if needs.bounded[j] and _inside(second, first):
        return Relation.SECOND_INSIDE
    return Relation.OVERLAP


def _apart(first: Shape, second: Shape) -> bool:
    """Whether two shapes are known to have nothing in common."""
    match first, second:
        case Sphere(), Sphere():
            return math.dist(first.center, second.center) >= first.radius + second.radius
        case Sphere(), Polyhedron():
            return max(signed_distances(second, first.center)) >= first.radius
        case Polyhedron(), Sphere():
            return _apart(second, first)
        case Polyhedron(), Polyhedron():
            return not _common(first, second).solid
    return False


def _inside(inner: Shape, outer: Shape) -> bool:
    """Whether a shape is known to lie in another, which it is not apart from."""
    match inner, outer:
        case Sphere(), Sphere():
            return math.dist(inner.center, outer.center) + inner.radius <= outer.radius
        case Sphere(), Polyhedron():
            return max(signed_distances(outer, inner.center)) <= -inner.radius
        case Polyhedron(), Sphere():
            from native_tracer.halfspaces import polyhedron_faces

            faces = [face.points for face in polyhedron_faces(inner.planes)]
            corners = [points[k : k + 3] for points in faces for k in range(0, len(points), 3)]
            return all(math.dist(corner, outer.center) <= outer.radius for corner in corners)
        case Polyhedron(), Polyhedron():
            # They are not apart, so the inner one is what they have in common if all its faces are the inner one's.
            return all(k < len(inner.planes) for k in _common(inner, outer).kept)
    return False


def _common(first: Polyhedron, second: Polyhedron) -> "PolyhedronFacts":
    """What two polyhedra have in common."""
    from native_tracer.halfspaces import polyhedron_facts

    return polyhedron_facts([first.planes + second.planes])[0]
