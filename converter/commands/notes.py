"""What a command tells on stderr besides errors."""

from pathlib import Path

from converter.commands.exits import tell
from converter.scene.model import Scene
from converter.scene.settings import Settings


def say(message: str, quiet: bool = False) -> None:
    """One line on stderr."""
    if not quiet:
        tell(message)


def load_with_notices(path: str | Path, settings: Settings, quiet: bool = False) -> Scene:
    """The scene in a file; what is worth knowing about how it is read goes to stderr.

    Raises:
        SceneError: the file is no scene.

    """
    from converter.scene.parser import load_scene

    scene = load_scene(path)
    if not quiet:
        from converter.scene.notices import scene_notices

        for notice in scene_notices(scene, settings):
            say(f"note: {notice}")
    return scene
