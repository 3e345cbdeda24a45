"""How much of a scene can be seen: where unbounded polyhedra may be cut off."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from converter.scene.geometry import scene_facts
from converter.scene.model import Scene, Vector
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind

Floats = NDArray[np.float64]

CUT_OFF = 1 / 8
"""How much of a pixel may be missing along a horizon."""
FARTHEST = 2.0**16
"""How far a plane is followed, at most, in units of the distance from it: float32 vertices out there are off by up to
2^-25 of their distance, a 512th of this one."""
LARGEST = 2.0**126
"""Where every box ends; float32 numbers do not far beyond."""


class Box(NamedTuple):
    """An axis-aligned box."""

    low: Vector
    high: Vector

    @classmethod
    def of(cls, low: Floats, high: Floats) -> "Box":
        """The box between two corners, (3,) each, as far as `LARGEST`; NaN is as far as that."""
        a, b, c = np.fmin(np.fmax(low, -LARGEST), LARGEST).tolist()
        d, e, f = np.fmax(np.fmin(high, LARGEST), -LARGEST).tolist()
        return cls((a, b, c), (d, e, f))

    def narrowed(self, low: Vector, high: Vector) -> "Box":
        """What it has in common with the box between two corners, which may be infinite; itself if that is nothing."""
        lower, upper = np.maximum(self.low, low), np.minimum(self.high, high)
        return Box.of(lower, upper) if np.all(lower < upper) else self


@np.errstate(over="ignore", invalid="ignore")  # numbers may be as large as they like
def scene_bounds(scene: Scene, settings: Settings | None = None) -> Box:
    """How large a box has to be for nothing outside of it to be missed in the picture of `scene`.

    A ray from height h above a plane that meets it farther than r away makes an angle below h / r with it: without what
    is farther, the picture lacks a strip of that angle along the plane's horizon. So r = h / (`CUT_OFF` e) will do,
    with e the smallest angle of a pixel, one in a corner, and h the largest distance of the eye from a plane. Reflected
    and refracted rays start among the things that are seen, not at the eye: h is greater by how far those are from it.
    (In rays that go to and fro between unbounded mirrors, the strip is wider with each reflection.) Nothing has to be
    farther away than the last vertex of a bounded polyhedron, and balls and lights have to be inside, since what is
    between them and the rest casts shadows.

    A ball or a bounded polyhedron that transmits nothing, and has the eye inside, ends all this at its own box.

    Args:
        scene: any scene; its polyhedra have volumes.
        settings: size of the picture, and the weight below which rays are not followed; the defaults if left out.

    """
    settings = settings or Settings()
    eye = np.array(scene.camera.eye)
    size = max(math.dist(eye, p) for p in (scene.camera.look_at, *(light.position for light in scene.lights)))
    enclosing: list[tuple[Floats, Floats]] = []
    heights: list[tuple[float, float]] = []  # of the eye above an object's planes, and how far that goes
    for o, facts in zip(scene.objects, scene_facts(scene), strict=True):
        kind = shape_kind(o.shape)
        horizon = kind.horizon(o.shape, facts, scene.camera.eye)
        size = max(size, horizon.needed)
        heights.append((horizon.height, horizon.farthest))
        encloses = facts.bounded and kind.contains(o.shape, scene.camera.eye)
        if encloses and not _followed(scene.finishes[o.finish].kt, settings):
            enclosing.append((np.array(facts.low), np.array(facts.high)))

    half = math.tan(math.radians(scene.camera.fovy) / 2)
    to_corner = half * math.hypot(1, settings.width / settings.height)
    pixel = 2 * half / settings.height / (1 + to_corner**2)
    stretch = 1 / max(CUT_OFF * pixel, 1 / FARTHEST)
    bounces = any(_followed(f.kr, settings) or _followed(f.kt, settings) for f in scene.finishes)
    reach = max([size, *(min(stretch * (h + bounces * size), farthest) for h, farthest in heights)])
    low, high = eye - 1.01 * reach, eye + 1.01 * reach
    for inner_low, inner_high in enclosing:
        room = 0.01 * (inner_high - inner_low)  # so that no cut touches the enclosure
        low, high = np.maximum(low, inner_low - room), np.minimum(high, inner_high + room)
    return Box.of(low, high)


def _followed(weight: float, settings: Settings) -> bool:
    """Whether rays of a kr or kt are followed."""
    return weight > 0 and weight >= settings.cutoff
