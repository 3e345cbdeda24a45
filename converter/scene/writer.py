"""Writes scenes as course scene files."""

import os
from math import isfinite
from pathlib import Path

from converter.scene.model import Checker, Object, Pigment, Polyhedron, Scene, Shape, Solid, Sphere, Texmap


def write_scene(scene: Scene) -> str:
    """The text of a scene file; `parse_scene(write_scene(scene), scene.file)` is `scene` again, number for number.

    The ambient light gets a position and an attenuation that mean nothing. Textures are named relative to the folder of
    `scene.file`, where there is one.

    Raises:
        ValueError: a number is not finite, or a texture's name has white space or a `#`, which the format cannot say.
    """
    camera = scene.camera
    folder = None if scene.file is None else scene.file.parent
    lines = [_numbers(*camera.eye), _numbers(*camera.look_at), _numbers(*camera.up), _numbers(camera.fovy)]
    lines += ["", str(1 + len(scene.lights)), _numbers(0, 0, 0, *scene.ambient, 1, 0, 0)]
    lines += [_numbers(*light.position, *light.color, *light.attenuation) for light in scene.lights]
    lines += ["", str(len(scene.pigments))]
    for pigment in scene.pigments:
        lines += _pigment(pigment, folder)
    lines += ["", str(len(scene.finishes))]
    lines += [_numbers(f.ka, f.kd, f.ks, f.alpha, f.kr, f.kt, f.ior) for f in scene.finishes]
    lines += ["", str(len(scene.objects))]
    for object_ in scene.objects:
        lines += _object(object_)
    return "\n".join(lines) + "\n"


def _pigment(pigment: Pigment, folder: Path | None) -> list[str]:
    match pigment:
        case Solid(color):
            return [f"solid {_numbers(*color)}"]
        case Checker(first, second, size):
            return [f"checker {_numbers(*first, *second, size)}"]
        case Texmap(file, p0, p1):
            return [f"texmap {_name(file, folder)}", _numbers(*p0), _numbers(*p1)]


def _object(object_: Object) -> list[str]:
    shape: Shape = object_.shape
    head = f"{object_.pigment} {object_.finish}"
    match shape:
        case Sphere(center, radius):
            return [f"{head} sphere {_numbers(*center, radius)}"]
        case Polyhedron(planes):
            return [f"{head} polyhedron {len(planes)}", *(_numbers(*plane) for plane in planes)]


def _name(file: Path, folder: Path | None) -> str:
    """A texture's name in a scene file in `folder`."""
    if folder is not None:
        if file.is_relative_to(folder):  # by its text: no link is followed, and `..` stays
            file = file.relative_to(folder)
        elif not file.is_absolute():
            file = Path(os.path.relpath(file, folder))
    name = file.as_posix()
    if not name or "#" in name or name.split() != [name]:
        raise ValueError(f"a scene file cannot name the texture {name!r}: white space and # end a name")
    return name


def _numbers(*values: float) -> str:
    return " ".join(map(_number, values))


def _number(value: float) -> str:
    """The shortest text that reads back as the same number."""
    if not isfinite(value):
        raise ValueError(f"a scene file cannot hold the number {value}")
    return repr(float(value)).removesuffix(".0")
