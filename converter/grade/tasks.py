"""The scenes that programs are to draw, each with all that belongs to it."""

import hashlib
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from converter.scene.model import Scene, Texmap
from converter.scene.parser import load_scene


class NoTask(ValueError):  # noqa: N818 - what it says
    """A folder of scenes cannot be used; the message says why."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """A scene that is to be drawn.

    Attributes:
        name: that of its file, without the ending.
        file: it.
        scene: what is in it.
        textures: the files that it names, below its folder.

    """

    name: str
    file: Path
    scene: Scene
    textures: tuple[Path, ...]

    def copy_to(self, folder: Path) -> Path:
        """Copy the scene and its textures into a folder; the scene's file there."""
        for file in (self.file, *self.textures):
            target = folder / file.relative_to(self.file.parent)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, target)
        return folder / self.file.name

    def fingerprint(self) -> str:
        """A number that changes with the scene and its textures."""
        digest = hashlib.sha256()
        for file in (self.file, *self.textures):
            digest.update(f"{file.name}\0".encode(errors="surrogateescape"))
            digest.update(file.read_bytes())
        return digest.hexdigest()


def read_tasks(folder: Path) -> list[Task]:
    """The scenes of a folder in the order of their names, or the one in a file.

    Raises:
        NoTask: there is none, or one with a texture that lies elsewhere.
        SceneError: one is no scene.
        OSError: it cannot be read.

    """
    files = sorted(folder.glob("*.in")) if folder.is_dir() else [folder]
    if not files:
        raise NoTask(f"{folder}: there are no scenes (*.in) in it")
    return [_read(file) for file in files]


def _read(file: Path) -> Task:
    scene = load_scene(file)
    textures = sorted({pigment.file for pigment in scene.pigments if isinstance(pigment, Texmap)})
    return Task(file.stem, file, scene, tuple(_checked(file, textures)))


def _checked(file: Path, textures: Sequence[Path]) -> Sequence[Path]:
    for texture in textures:
        if not texture.is_relative_to(file.parent) or ".." in texture.relative_to(file.parent).parts:
            raise NoTask(f"{file}: its texture {texture} lies outside of the scene's folder, where no program sees it")
    return [texture for texture in textures if texture.is_file()]
