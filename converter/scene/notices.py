"""What a scene's reader should be told although nothing is wrong."""

from converter.scene.enclosure import enclosure_notices
from converter.scene.errors import place
from converter.scene.model import Scene
from converter.scene.needs import is_index
from converter.scene.settings import Settings


def scene_notices(scene: Scene, settings: Settings) -> list[str]:
    """One line for each reading of the scene that is a choice: `file:line: finish 2: ior 1.45 is above 1, ...`; those
    that its parser has made come first, and its `enclosure_notices` last.
    """
    notices = list(scene.notes)
    for k in sorted({o.finish for o in scene.objects}):
        finish = scene.finishes[k]
        if settings.ior == "auto" and finish.kt > 0 and is_index(finish, settings.ior):
            line = scene.finish_lines[k] if k < len(scene.finish_lines) else 0
            where = f"{place(scene.file, line)}: finish {k}"
            reading = "so it is read as the material's own index, n2/n1; --ior ratio reads it as n1/n2"
            notices.append(f"{where}: ior {finish.ior:g} is above 1, {reading}")
    return [*notices, *enclosure_notices(scene, settings)]
