"""The effects of distributed ray tracing that a scene has: what is sampled of it (Cook, Porter and Carpenter 1984)."""

from collections.abc import Iterable, Sequence
from typing import Literal

from converter.scene.errors import place
from converter.scene.model import Scene

Effect = Literal["soft shadows", "glossy rays", "depth of field", "motion"]


def scene_effects(scene: Scene, lit: bool, spreading: Iterable[int]) -> dict[Effect, str]:
    """The effects that can be seen, each with what has it first, such as `scene.in:7: light 1 has a radius`.

    Args:
        scene: any scene.
        lit: whether any ray goes to a light.
        spreading: finishes, ascending, that a mirrored or a transmitted ray may leave from.

    """
    found: dict[Effect, str] = {}
    if scene.camera.aperture > 0 and scene.objects:
        found["depth of field"] = f"{place(scene.file, 0)}: the camera has an aperture"
    if lit and (light := next((i for i, light in enumerate(scene.lights) if light.radius > 0), None)) is not None:
        found["soft shadows"] = f"{_place(scene, scene.light_lines, light)}: light {light + 1} has a radius"
    if (finish := next((i for i in spreading if scene.finishes[i].cone > 0), None)) is not None:
        found["glossy rays"] = f"{_place(scene, scene.finish_lines, finish)}: finish {finish} has a cone"
    if (moving := next((i for i, o in enumerate(scene.objects) if any(o.move)), None)) is not None:
        found["motion"] = f"{place(scene.file, scene.objects[moving].line)}: object {moving} moves"
    return found


def _place(scene: Scene, lines: Sequence[int], index: int) -> str:
    return place(scene.file, lines[index] if index < len(lines) else 0)
