"""The same scene in other units, for POV-Ray's tolerances are absolute."""

import math
from dataclasses import replace

import numpy as np

from converter.errors import ExportError
from converter.pigments.table import pigment_kind
from converter.scene.model import Light, Object, Scene, Vector
from converter.scene.needs import SceneNeeds
from converter.shapes.table import shape_kind

NEAREST, FARTHEST = 1e-3, 1e7
"""Distances between which POV-Ray sees everything."""
SMALLEST, LARGEST = 1e-100, 1e100
"""Sizes of scenes between which squares of their numbers neither overflow nor vanish."""


def scaled(scene: Scene, factor: float) -> Scene:
    """`scene` with all lengths multiplied by `factor`, which gives the same picture.

    Raises:
        ExportError: a shape cannot be multiplied.

    """
    if factor == 1:
        return scene

    def times(v: Vector) -> Vector:
        x, y, z = v
        return (factor * x, factor * y, factor * z)

    def light(source: Light) -> Light:
        a, b, c = source.attenuation
        return replace(source, position=times(source.position), attenuation=(a, b / factor, c / factor**2))

    def object_(source: Object) -> Object:
        kind = shape_kind(source.shape)
        shape = kind.scaled(source.shape, factor)
        try:
            kind.write(shape)  # which only finite numbers can be
        except ValueError:
            raise ExportError("POV-Ray's numbers do not hold this scene: a surface would be too far away") from None
        return replace(source, shape=shape)

    return replace(
        scene,
        camera=replace(scene.camera, eye=times(scene.camera.eye), look_at=times(scene.camera.look_at)),
        lights=tuple(map(light, scene.lights)),
        pigments=tuple(pigment_kind(source).scaled(source, factor) for source in scene.pigments),
        objects=tuple(map(object_, scene.objects)),
    )


def suitable_scale(scene: Scene, needs: SceneNeeds) -> float:
    """A power of two by which to multiply the scene's lengths, so that no digit changes.

    POV-Ray takes what is nearer than `NEAREST` along a ray for the surface that the ray starts on, and sees nothing
    that is farther than `FARTHEST`: a horizon needs room.

    Raises:
        ExportError: no numbers hold the scene's size and its square.

    """
    size = reach(scene, needs)
    if not SMALLEST < size < LARGEST:
        raise ExportError(f"POV-Ray's numbers do not hold this scene: it reaches {size:.3g} far")
    return math.ldexp(1, round(math.log2((2**12 if has_horizon(scene, needs) else 2**15) / size)))


def has_horizon(scene: Scene, needs: SceneNeeds) -> bool:
    """Whether rays may meet something without bounds at any distance: nothing that has bounds is around the eye."""
    eye = np.array(scene.camera.eye)
    enclosed = any(
        bounded and bool(np.all(eye > low) and np.all(eye < high))
        for bounded, (low, high) in zip(needs.bounded, needs.boxes, strict=True)
    )
    return not enclosed and not all(needs.bounded)


def reach(scene: Scene, needs: SceneNeeds) -> float:
    """Distance from the eye to the farthest corner of a body, and to what the camera looks at."""
    return max(math.dist(scene.camera.eye, p) for p in (scene.camera.look_at, *(p for box in needs.boxes for p in box)))
