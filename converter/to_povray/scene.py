"""A whole scene in POV-Ray's language."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from converter.pigments.table import pigment_kind
from converter.scene.geometry import simplified
from converter.scene.model import Csg, Object, Scene
from converter.scene.needs import SceneNeeds, scene_needs
from converter.scene.settings import Settings
from converter.shapes.csg_program import program_of
from converter.shapes.table import shape_kind
from converter.to_povray.camera import camera
from converter.to_povray.finishes import finish, transmission
from converter.to_povray.image_maps import Image
from converter.to_povray.interiors import interiors
from converter.to_povray.lights import light
from converter.to_povray.scale import FARTHEST, NEAREST, has_horizon, reach, scaled, suitable_scale
from converter.to_povray.surfaces import object_
from converter.to_povray.text import number, rgb

MARK = "// Written by whitted convert"
"""How a scene begins, so that it is known again."""
MAX_TRACE_LEVEL = 256
"""POV-Ray follows no ray deeper, the primary one counted."""


@dataclass(frozen=True, slots=True)
class PovrayScene:
    """A scene in POV-Ray's language.

    Attributes:
        text: the scene file.
        textures: the image files that it names, as bytes by their names.
        omissions: a sentence on each thing that POV-Ray draws otherwise than the scene means it.

    """

    text: str
    textures: Mapping[str, bytes]
    omissions: tuple[str, ...]


@np.errstate(all="ignore")  # numbers may be as large as they like; those that are none cannot be written
def povray_scene(scene: Scene, settings: Settings, name: str = "scene") -> PovrayScene:
    """Everything that `scene`, drawn with `settings`, needs; the names of texture files begin with `name`.

    Raises:
        TextureError: a texture that is used cannot be read.
        ExportError: POV-Ray has no numbers for it.

    """
    scene = simplified(scene)
    factor = suitable_scale(scene, scene_needs(scene, settings))
    scene = scaled(scene, factor)
    needs = scene_needs(scene, settings)
    images = {
        i: image
        for i in needs.pigments
        if (image := pigment_kind(scene.pigments[i]).povray_image(scene.pigments[i], f"{name}_pigment_{i}"))
    }
    omissions: list[str] = []
    omissions += [f"{cause}, and is drawn without {effect}" for effect, cause in needs.effects.items()]
    if has_horizon(scene, needs):
        omissions.append(f"nothing is seen that is farther away than {FARTHEST / factor:.3g}")
    parts = [
        _global_settings(scene, needs, settings, omissions),
        camera(scene.camera, settings),
        _lights(scene, needs, factor, omissions) if needs.lit else "",
        _textures(scene, needs, settings, images, omissions),
        _objects(scene, needs, omissions),
    ]
    text = "\n".join([_heading(scene, settings, factor, omissions), *filter(None, parts)])
    return PovrayScene(text, {image.file: image.ppm() for image in images.values()}, tuple(omissions))


def draw_options(settings: Settings) -> list[str]:
    """What `povray` has to be told so that a pixel is what it is meant to be: one ray, no gamma, 16 bits a channel.

    With n x n samples the picture is n times as wide and high, and the mean of each n x n pixels is a pixel.
    """
    n = math.isqrt(settings.rays_a_pixel())
    return [f"+W{n * settings.width}", f"+H{n * settings.height}", "-A", "-D", "+FP16", "File_Gamma=1"]


def _heading(scene: Scene, settings: Settings, factor: float, omissions: list[str]) -> str:
    n = math.isqrt(settings.rays_a_pixel())
    lines = [f"{MARK} from {scene.file.name!a}" if scene.file else MARK]
    lines.append(f"// povray +I... {' '.join(draw_options(settings))}")
    if n > 1:
        lines.append(f"// and then the mean of each {n} x {n} pixels")
    if factor != 1:
        lines.append(
            f"// Lengths are multiplied by {number(factor)}: POV-Ray misses what is nearer than {number(NEAREST)}."
        )
    if omissions:
        lines += ["// What POV-Ray draws otherwise than it is meant:", *(f"//   {omission}" for omission in omissions)]
    return "\n".join(lines) + "\n#version 3.7;\n"


def _global_settings(scene: Scene, needs: SceneNeeds, settings: Settings, omissions: list[str]) -> str:
    depth = needs.max_depth + 1
    if depth > MAX_TRACE_LEVEL:
        omissions.append(f"rays are followed for {MAX_TRACE_LEVEL - 1} bounces, not {needs.max_depth}")
    return (
        f"global_settings {{\n  assumed_gamma 1.0\n  ambient_light {rgb(scene.ambient)}\n"
        f"  max_trace_level {min(depth, MAX_TRACE_LEVEL)}\n  adc_bailout {number(settings.cutoff)}\n}}\n"
        f"background {{ {rgb(needs.background)} }}\n"
    )


def _lights(scene: Scene, needs: SceneNeeds, factor: float, omissions: list[str]) -> str:
    size = max(reach(scene, needs), *(math.dist(scene.camera.eye, source.position) for source in scene.lights))
    text = ""
    for i, source in enumerate(scene.lights, start=1):
        sources, error = light(source, size)
        text += sources
        if error:
            a, b, c = source.attenuation
            law = f"1 / ({a:g} + {b * factor:g} d + {c * factor**2:g} d^2)"
            place = _place("light", i, scene.light_lines, i - 1)
            told = f"is approached by five lights, off by up to {error:.1g} of its colour"
            omissions.append(f"{place}: {law} {told if sources else 'cannot be expressed, and the light is left out'}")
    return text


def _textures(
    scene: Scene, needs: SceneNeeds, settings: Settings, images: Mapping[int, Image], omissions: list[str]
) -> str:
    for i, image in images.items():
        if image.clamped:
            place = _place("pigment", i, scene.pigment_lines, i)
            omissions.append(f"{place}: its texture's colours beyond 0..1 are clamped")
    for i in needs.finishes:
        source = scene.finishes[i]
        place = _place("finish", i, scene.finish_lines, i)
        if needs.glossy and source.ks > 0 and source.alpha == 0:
            how = "ends at a right angle" if settings.specular == "phong" else "is left out"
            omissions.append(f"{place}: its highlight, with alpha 0, {how}")
        transmitted, _ = transmission(source)
        if needs.refracts and settings.cutoff > 0 and not math.isclose(transmitted, source.kt, rel_tol=1e-4):
            than = f"a ray through it weighs kt / (kr + kt) = {transmitted:.3g}, not kt = {source.kt:g}"
            omissions.append(f"{place}: where --cutoff drops rays, {than}")
    text = ""
    for i, j in sorted({(o.finish, o.pigment) for o in scene.objects}):
        users = [k for k, o in enumerate(scene.objects) if (o.finish, o.pigment) == (i, j)]
        boxes = [needs.boxes[k] for k in users] if all(needs.bounded[k] for k in users) else None
        transmitted, _ = transmission(scene.finishes[i])
        inner = pigment_kind(scene.pigments[j]).povray(scene.pigments[j], transmitted, images.get(j), boxes)
        answer = finish(scene.finishes[i], settings)
        text += f"#declare {_texture(i, j)} = texture {{\n  pigment {{ {inner} }}\n  {answer}\n}}\n"
    return text


def _objects(scene: Scene, needs: SceneNeeds, omissions: list[str]) -> str:
    inner, overlaps = interiors(scene, needs)
    lines = [o.line for o in scene.objects]
    for i, j in overlaps if needs.refracts else ():
        pair = f"{_place('object', i, lines, i)} and {_place('object', j, lines, j)}"
        omissions.append(f"{pair} are transparent and overlap, so that rays are refracted by other ratios there")

    for i in range(len(scene.objects)) if needs.refracts else ():
        if needs.plates[i] and scene.finishes[scene.objects[i].finish].kt > 0:
            place = _place("object", i, lines, i)
            omissions.append(f"{place} is transparent and has no thickness: rays are refracted once there, not twice")

    for i, o in enumerate(scene.objects):
        if isinstance(o.shape, Csg) and program_of(o.shape).coincident:
            place = _place("object", i, lines, i)
            omissions.append(f"{place}: surfaces of its csg coincide, where POV-Ray may leave films, or holes")

    def block(i: int, o: Object) -> str:
        texture = _texture(o.finish, o.pigment)
        shape = shape_kind(o.shape).povray(o.shape, needs.facts[i])
        return object_(f"Object_{i}", shape, texture, inner.get(i), needs.lit)

    return "".join(block(i, o) for i, o in enumerate(scene.objects))


def _texture(finish: int, pigment: int) -> str:
    return f"Finish_{finish}_Pigment_{pigment}"


def _place(kind: str, index: int, lines: Sequence[int], at: int) -> str:
    """E.g. `light 2 (line 7)`; a line 0 is not known."""
    line = lines[at] if at < len(lines) else 0
    return f"{kind} {index}" + (f" (line {line})" if line else "")
