"""Planes of several bodies that are one plane, written differently.

A box on a box, a floor made of slabs: their faces share planes, which one of them writes as `1 3 2 -2` and another as
`-10 -30 -20 20`. Normals of length 1 made of those differ in their last digits; which of the two faces is nearer would
then be decided by rounding, another way for every ray. So such planes get the same numbers before anything is computed
from them: distances tie, and of objects at the same distance the first of the file counts. Likewise the two planes of a
plate without thickness: a ray then enters it exactly where it leaves.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import hypot

from converter.scene.geometry import scene_facts
from converter.scene.model import Plane, Scene
from converter.shapes.table import shape_kind

_EPSILON = 2.0**-52
_SAME = 4 * _EPSILON
"""How much coefficients of one plane may differ, relative to its normal or its offset: some roundings."""
_PROBE = (0.5377, 0.7393, 0.4057, 0.3119)
"""Planes that are the same, or face each other, have the same product with it but for its sign; few others have."""

_Place = tuple[int, int]
"""The index of an object, and of its plane."""


def with_planes_shared(scene: Scene) -> Scene:
    """`scene`, where planes that are the same but for a factor and roundings are as the first of them is written.

    The factor may be negative: bodies that lie on each other share a plane with opposite normals. So do the sides of a
    plate, whatever roundings were allowed for when it was found to be one.
    """
    scene = _with_planes(scene, _plate_backs(scene))
    changed: dict[_Place, Plane] = {}
    for cluster in _clusters(scene):
        heads: list[Plane] = []
        for place in sorted(cluster):
            plane = _plane(scene, place)
            shared = next((same for head in heads if (same := _as_written(plane, head)) is not None), None)
            if shared is None:
                heads.append(plane)
            elif shared != plane:
                changed[place] = shared
    return _with_planes(scene, changed)


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
            a, b, c, d = _plane(scene, (i, front))
            if _plane(scene, (i, back)) != (-a, -b, -c, -d):
                found[i, back] = (-a, -b, -c, -d)
    return found


def _clusters(scene: Scene) -> Iterator[list[_Place]]:
    """Planes that may be the same, two or more at a time."""
    a, b, c, d = _PROBE
    probed = sorted(
        (abs(a * p[0] + b * p[1] + c * p[2] + d * p[3]) / hypot(p[0], p[1], p[2]), (i, k))
        for i, o in enumerate(scene.objects)
        for k, p in enumerate(shape_kind(o.shape).planes(o.shape))
    )
    cluster: list[_Place] = []
    for (before, place), (after, next_place) in pairwise(probed):
        if after - before <= 16 * _SAME * (1 + after):
            cluster = cluster or [place]
            cluster.append(next_place)
        elif cluster:
            yield cluster
            cluster = []
    if cluster:
        yield cluster


def _plane(scene: Scene, place: _Place) -> Plane:
    shape = scene.objects[place[0]].shape
    return shape_kind(shape).planes(shape)[place[1]]


def _as_written(plane: Plane, head: Plane) -> Plane | None:
    """`head`, or what faces it, if `plane` is the same; else None."""
    length, head_length = hypot(*plane[:3]), hypot(*head[:3])
    normal = [n / length for n in plane[:3]]
    head_normal = [n / head_length for n in head[:3]]
    offset, head_offset = plane[3] / length, head[3] / head_length
    sign = 1.0 if sum(m * n for m, n in zip(normal, head_normal, strict=True)) > 0 else -1.0
    if any(abs(m - sign * n) > _SAME for m, n in zip(normal, head_normal, strict=True)):
        return None
    if abs(offset - sign * head_offset) > _SAME * abs(head_offset):
        return None
    x, y, z, w = (sign * number for number in head)
    return (x, y, z, w)
