"""Lights that light nothing, and cameras that see nothing, since a body shuts them in or out."""

from converter.scene.errors import place
from converter.scene.model import Scene, Vector
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind


def enclosure_notices(scene: Scene, settings: Settings) -> tuple[str, ...]:
    """A line for each light and camera that is cut off from all else, by whatever method, with its line in the file.

    Every surface blocks light, a transparent one too: a light inside a body lights nothing outside of it, and one
    outside of a body that the camera is in, nothing in there. Of bodies that move nothing is told.
    """
    bodies = [i for i, o in enumerate(scene.objects) if not any(o.move)]
    needs = scene_needs(scene, settings)
    around = [i for i in bodies if _contains(scene, i, scene.camera.eye)]
    found = []
    for k, source in enumerate(scene.lights if needs.lit else ()):
        line = scene.light_lines[k] if k < len(scene.light_lines) else 0
        inside = {i for i in bodies if _contains(scene, i, source.position)}
        if hidden := sorted(inside.difference(around)):
            what = f"is inside {_object(scene, hidden[0])}, and lights nothing outside of it"
        elif closed := [i for i in around if i not in inside]:
            what = f"is outside of {_object(scene, closed[0])}, which the camera is in, and lights nothing in there"
        else:
            continue
        found.append(f"{place(scene.file, line)}: light {k + 1} {what}")
    for i in around:
        finish = scene.finishes[scene.objects[i].finish]
        alone = not any(_contains(scene, i, needs.facts[k].inside) for k in bodies if k != i)
        if finish.kt == 0 and alone and len(bodies) == len(scene.objects) > 1:
            found.append(
                f"{place(scene.file, scene.objects[i].line)}: object {i} has the camera inside, and nothing else"
            )
    return tuple(found)


def _contains(scene: Scene, i: int, p: Vector) -> bool:
    shape = scene.objects[i].shape
    return shape_kind(shape).contains(shape, p)


def _object(scene: Scene, i: int) -> str:
    line = scene.objects[i].line
    return f"object {i}" + (f" (line {line})" if line else "")
