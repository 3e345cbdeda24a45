"""Planes of several bodies that are one plane, written differently.

A box on a box, a floor made of slabs: their faces share planes, which one of them writes as `1 3 2 -2` and another as
`-10 -30 -20 20`. Normals of length 1 made of those differ in their last digits; which of the two faces is nearer would
then be decided by rounding, another way for every ray. So such planes get the same numbers before anything is computed
from them: distances tie, and of objects at the same distance the first of the file counts. Likewise the two planes of a
plate without thickness: a ray then enters it exactly where it leaves. Only last digits change, so that this is right
for bodies that move, too.
"""

from converter.frozen import replace
from converter.scene.geometry import scene_facts
from converter.scene.model import Plane, Scene
from converter.shapes.same_surfaces import same_planes
from converter.shapes.table import shape_kind

_Place = tuple[int, int]
"""The index of an object, and of its plane."""


def with_planes_shared(scene: Scene) -> Scene:
    """`scene`, where planes that are the same but for a factor and roundings are as the first of them is written.

    The factor may be negative: bodies that lie on each other share a plane with opposite normals. So do the sides of a
    plate, whatever roundings were allowed for when it was found to be one.
    """
    scene = _with_planes(scene, _plate_backs(scene))
    planes = [shape_kind(o.shape).planes(o.shape) for o in scene.objects]
    places = [(i, k) for i, own in enumerate(planes) for k in range(len(own))]
    changed = same_planes([plane for own in planes for plane in own])
    return _with_planes(scene, {places[at]: plane for at, plane in changed.items()})


def _with_planes(scene: Scene, changed: dict[_Place, Plane]) -> Scene:
    """`scene` with some planes changed; itself if none is."""
    if not changed:
        return scene
    objects = list(scene.objects)
    for i in {i for i, _ in changed}:
        shape, kind = objects[i].shape, shape_kind(objects[i].shape)
        planes = [changed.get((i, k), plane) for k, plane in enumerate(kind.planes(shape))]
        objects[i] = replace(objects[i], shape=kind.with_planes(shape, planes))
    return replace(scene, objects=tuple(objects))


def _plate_backs(scene: Scene) -> dict[_Place, Plane]:
    """For the second side of each plate the first one, facing away, unless it is that already."""
    found: dict[_Place, Plane] = {}
    for i, fact in enumerate(scene_facts(scene)):
        if fact.plate:
            front, back = fact.plate
            planes = shape_kind(scene.objects[i].shape).planes(scene.objects[i].shape)
            a, b, c, d = planes[front]
            if planes[back] != (-a, -b, -c, -d):
                found[i, back] = (-a, -b, -c, -d)
    return found
