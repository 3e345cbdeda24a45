"""A scene as regions are looked for in it: arrays of what has a size and a place, worked out once."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from converter.scene.geometry import simplified
from converter.scene.model import Finish, Scene
from converter.scene.needs import SceneNeeds, scene_needs
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind

Floats = NDArray[np.float64]
Integers = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Bodies:
    """Bounded objects: their indices (n,), a ball around each, or for a sphere itself, and whether it is one."""

    object: Integers
    center: Floats  # (n, 3)
    radius: Floats
    is_ball: NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Planes:
    """Planes that have a face, in the order of the objects: object and index in it (m,), outward unit normal (m, 3),
    and offset (m,) from the origin: inside is normal . p + offset <= 0.
    """

    object: Integers
    plane: Integers
    normal: Floats
    offset: Floats

    def signed_distances(self, point: Floats) -> Floats:
        """(m,) signed distances of a point (3,), positive outside."""
        return np.asarray(self.normal @ point + self.offset)


@dataclass(frozen=True, eq=False)
class Situation:
    """A scene with its settings and needs, and arrays of what is in it.

    Attributes:
        eye: (3,)
        bodies: the bounded objects.
        planes: all planes that have a face.
        low, high: (n, 3) corners of the boxes around all objects, infinite where they have no bounds.

    """

    scene: Scene
    settings: Settings
    needs: SceneNeeds
    eye: Floats
    bodies: Bodies
    planes: Planes
    low: Floats
    high: Floats

    @property
    def reach(self) -> float:
        """The largest coordinate of the eye."""
        return float(np.abs(self.eye).max())

    def finish(self, index: int) -> Finish:
        """The finish of an object."""
        return self.scene.finishes[self.scene.objects[index].finish]

    def planes_of(self, index: int) -> Planes:
        """The planes of one object, which come together."""
        every = self.planes
        first, end = np.searchsorted(every.object, (index, index + 1))
        own = slice(first, end)
        return Planes(every.object[own], every.plane[own], every.normal[own], every.offset[own])

    def overlap(self, one: int, other: int) -> bool:
        """Whether the boxes around two objects touch, with a little room."""
        room = 1e-6 * min(np.ptp([self.low[k], self.high[k]], axis=0).max() for k in (one, other))
        room = room if math.isfinite(room) else 0.0
        return bool(np.all((self.low[one] <= self.high[other] + room) & (self.low[other] <= self.high[one] + room)))


@np.errstate(all="ignore")  # numbers may be as large as they like
def situation_of(scene: Scene, settings: Settings) -> Situation:
    """Work it out."""
    scene = simplified(scene)
    needs = scene_needs(scene, settings)
    boxes = np.array(needs.boxes, dtype=np.float64).reshape(-1, 2, 3)
    bounded = np.array(needs.bounded, dtype=np.bool_)
    low = np.where(bounded[:, None], boxes[:, 0], -np.inf)
    high = np.where(bounded[:, None], boxes[:, 1], np.inf)
    eye = np.array(scene.camera.eye)
    return Situation(scene, settings, needs, eye, _bodies(scene, boxes, bounded), _planes(scene, needs), low, high)


def _bodies(scene: Scene, boxes: Floats, bounded: NDArray[np.bool_]) -> Bodies:
    center = boxes[:, 0] / 2 + boxes[:, 1] / 2
    radius = np.linalg.norm(boxes[:, 1] / 2 - boxes[:, 0] / 2, axis=1)
    is_ball = np.zeros(len(scene.objects), dtype=np.bool_)
    for i, o in enumerate(scene.objects):
        if ball := shape_kind(o.shape).ball(o.shape):
            center[i], radius[i], is_ball[i] = *ball, True
    object = np.flatnonzero(bounded & (radius > 0))
    return Bodies(object, center[object], radius[object], is_ball[object])


def _planes(scene: Scene, needs: SceneNeeds) -> Planes:
    kept = [
        (i, k, *planes[k])
        for i, (o, needed) in enumerate(zip(scene.objects, needs.planes, strict=True))
        for planes in (shape_kind(o.shape).planes(o.shape),)
        for k in needed
    ]
    rows = np.array([row[2:] for row in kept], dtype=np.float64).reshape(-1, 4)
    rows = rows / np.abs(rows[:, :3]).max(axis=1, initial=0.0, keepdims=True)
    rows = rows / np.linalg.norm(rows[:, :3], axis=1, keepdims=True)
    places = np.array([row[:2] for row in kept], dtype=np.intp).reshape(-1, 2)
    return Planes(places[:, 0], places[:, 1], rows[:, :3], rows[:, 3])
