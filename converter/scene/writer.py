"""Writes scenes as course scene files."""

from converter.pigments.table import pigment_kind
from converter.scene.model import Scene
from converter.scene.numerals import numerals
from converter.shapes.table import shape_kind


def write_scene(scene: Scene) -> str:
    """The text of a scene file; `parse_scene(write_scene(scene), scene.file)` is `scene` again, number for number.

    The ambient light gets a position and an attenuation that mean nothing. Textures are named relative to the folder of
    `scene.file`, where there is one.

    Raises:
        ValueError: a number is not finite, or a texture's name has white space or a `#`, which the format cannot say.
    """
    camera = scene.camera
    folder = None if scene.file is None else scene.file.parent
    lines = [numerals(*camera.eye), numerals(*camera.look_at), numerals(*camera.up)]
    lens = (camera.aperture, camera.focal)
    lines.append(_extended((camera.fovy,), lens))
    lines += ["", str(1 + len(scene.lights)), numerals(0, 0, 0, *scene.ambient, 1, 0, 0)]
    lines += [_extended((*light.position, *light.color, *light.attenuation), (light.radius,)) for light in scene.lights]
    lines += ["", str(len(scene.pigments))]
    for pigment in scene.pigments:
        lines += pigment_kind(pigment).write(pigment, folder)
    lines += ["", str(len(scene.finishes))]
    lines += [_extended((f.ka, f.kd, f.ks, f.alpha, f.kr, f.kt, f.ior), (f.cone,)) for f in scene.finishes]
    lines += ["", str(len(scene.objects))]
    for o in scene.objects:
        first, *others = shape_kind(o.shape).write(o.shape)
        lines += [f"{o.pigment} {o.finish} {first}", *others]
        if any(o.move):
            lines[-1] += f" move {numerals(*o.move)}"
    return "\n".join(lines) + "\n"


def _extended(numbers: tuple[float, ...], optional: tuple[float, ...]) -> str:
    """A line of numbers, with those that are optional if one is not 0."""
    return numerals(*numbers, *optional) if any(optional) else numerals(*numbers)
