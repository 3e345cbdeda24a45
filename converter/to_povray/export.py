"""Scenes in POV-Ray's language into files: the scene, and images beside it."""

import re
from pathlib import Path

from converter.errors import ExportError
from converter.files import is_special, replacing
from converter.scene.model import Scene
from converter.scene.settings import Settings
from converter.to_povray.image_maps import MARK as IMAGE_MARK
from converter.to_povray.scene import MARK, PovrayScene, povray_scene


def export_povray(scene: Scene, settings: Settings, file: Path) -> tuple[PovrayScene, list[Path]]:
    """Write `scene`, drawn with `settings`, for POV-Ray; return it, and the files written, the scene first.

    The scene's file appears last, so never without its images, and each file as a whole.

    Raises:
        ExportError: one of the files exists, and this function has not written it.
        ExportError, TextureError, OSError: as `povray_scene` and the file system have it.

    """
    name = re.sub(r"[^A-Za-z0-9_.-]", "_", file.stem)  # POV-Ray's strings take no other without ado
    exported = povray_scene(scene, settings, name)
    images = {file.with_name(image): data for image, data in exported.textures.items()}
    _check(file, MARK.encode())
    for image in images:
        _check(image, IMAGE_MARK)
    for target, data in (*images.items(), (file, exported.text.encode())):
        with replacing(target) as temporary:
            temporary.write_bytes(data)
    for left in file.parent.glob(f"{name}_pigment_*.ppm"):  # of an earlier export
        if left not in images and _is_ours(left, IMAGE_MARK):
            left.unlink()
    return exported, [file, *images]


def _check(file: Path, mark: bytes) -> None:
    if file.is_dir():
        raise ExportError(f"{file} is a folder: expected a file to write the scene to")
    if file.exists() and (is_special(file) or not _is_ours(file, mark)):
        raise ExportError(f"{file} is not of an exported scene: name another file")


def _is_ours(file: Path, mark: bytes) -> bool:
    with file.open("rb") as opened:
        return mark in opened.read(100)
