"""Whether the shapes of a scene exist."""

from converter.scene.errors import Problem
from converter.scene.model import Scene


def check_geometry(scene: Scene) -> list[Problem]:
    """What is wrong with the shapes of `scene`: nothing is looked for yet."""
    return []
