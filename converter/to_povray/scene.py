"""A whole scene in POV-Ray's language."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from converter.images.texture import read_texture
from converter.scene.model import Scene, Texmap
from converter.scene.needs import SceneNeeds, scene_needs
from converter.scene.settings import Settings
from converter.to_povray.camera import camera
from converter.to_povray.finishes import finish, transmission
from converter.to_povray.interiors import interiors
from converter.to_povray.lights import light
from converter.to_povray.pigments import Image, pigment
from converter.to_povray.surfaces import object_, surface
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


def povray_scene(scene: Scene, settings: Settings, name: str = "scene") -> PovrayScene:
    """Everything that `scene`, drawn with `settings`, needs; the names of texture files begin with `name`.

    Raises:
        TextureError: a texture that is used cannot be read.

    """
    needs = scene_needs(scene, settings)
    omissions: list[str] = []
    images = {
        i: Image(f"{name}_pigment_{i}.ppm", read_texture(source.file), source)
        for i in needs.pigments
        if isinstance(source := scene.pigments[i], Texmap)
    }
    omissions += [
        f"pigment {i}: its texture has colours beyond 0..1, which are clamped" for i in images if images[i].clamped
    ]
    parts = [_settings(scene, needs, settings, omissions), camera(scene.camera, settings)]
    if needs.lit:
        parts.append(_lights(scene, needs, omissions))
    parts.append(_textures(scene, needs, settings, images, omissions))
    parts.append(_objects(scene, needs, omissions))
    parts.insert(0, _heading(scene, settings, omissions))
    textures = {image.file: image.ppm() for image in images.values()}
    return PovrayScene("\n".join(parts), textures, tuple(omissions))


def _heading(scene: Scene, settings: Settings, omissions: list[str]) -> str:
    n = math.isqrt(settings.samples)
    size = f"+W{n * settings.width} +H{n * settings.height}"
    lines = [
        MARK + (f" from {scene.file.name!a}" if scene.file else ""),
        f"// povray +I... {size} -A -D +FN16 File_Gamma=1",
    ]
    if n > 1:
        lines.append(f"// and then the mean of each {n} x {n} pixels")
    if omissions:
        lines += ["// What POV-Ray draws otherwise than it is meant:", *(f"//   {omission}" for omission in omissions)]
    return "\n".join(lines) + "\n#version 3.7;\n"


def _settings(scene: Scene, needs: SceneNeeds, settings: Settings, omissions: list[str]) -> str:
    depth = needs.max_depth + 1
    if depth > MAX_TRACE_LEVEL:
        omissions.append(f"POV-Ray follows rays for {MAX_TRACE_LEVEL - 1} bounces, not {needs.max_depth}")
        depth = MAX_TRACE_LEVEL
    return (
        f"global_settings {{\n  assumed_gamma 1.0\n  ambient_light {rgb(scene.ambient)}\n"
        f"  max_trace_level {depth}\n  adc_bailout {number(settings.cutoff)}\n}}\n"
        f"background {{ {rgb(needs.background)} }}\n"
    )


def _lights(scene: Scene, needs: SceneNeeds, omissions: list[str]) -> str:
    eye = scene.camera.eye
    corners = [c for box, bounded in zip(needs.boxes, needs.bounded, strict=True) if bounded for c in box]
    size = max(math.dist(eye, p) for p in (scene.camera.look_at, *(s.position for s in scene.lights), *corners))
    text = ""
    for i, source in enumerate(scene.lights, start=1):
        sources, error = light(source, size)
        text += sources
        if error:
            a, b, c = source.attenuation
            law = f"1 / ({a:g} + {b:g} d + {c:g} d^2)"
            omissions.append(f"light {i}: {law} is approached by a sum of fades that is off by up to {error:.1g}")
    return text


def _textures(
    scene: Scene, needs: SceneNeeds, settings: Settings, images: dict[int, Image], omissions: list[str]
) -> str:
    text = ""
    for i in needs.finishes:
        source = scene.finishes[i]
        if source.ks > 0 and source.alpha == 0:
            line = f" (line {scene.finish_lines[i]})" if i < len(scene.finish_lines) else ""
            omissions.append(f"finish {i}{line}: a highlight with alpha 0 is none")
    for i, j in sorted({(o.finish, o.pigment) for o in scene.objects}):
        boxes = [
            needs.boxes[k] if needs.bounded[k] else ((-math.inf,) * 3, (math.inf,) * 3)
            for k, o in enumerate(scene.objects)
            if (o.finish, o.pigment) == (i, j)
        ]
        colors = pigment(scene.pigments[j], transmission(scene.finishes[i])[0], images.get(j), boxes)
        text += f"#declare Finish_{i}_Pigment_{j} = texture {{\n  {colors}\n  {finish(scene.finishes[i], settings)}\n}}\n"
    return text


def _objects(scene: Scene, needs: SceneNeeds, omissions: list[str]) -> str:
    inner, overlaps = interiors(scene, needs) if needs.refracts else ({}, [])
    for pair in overlaps:
        (i, first), (j, second) = ((f"object {k}", scene.objects[k].line) for k in pair)
        lines = f" (lines {first} and {second})" if first and second else ""
        omissions.append(f"{i} and {j}{lines} are transparent and overlap: POV-Ray refracts rays by its own rules there")
    text = ""
    for i, o in enumerate(scene.objects):
        texture = f"Finish_{o.finish}_Pigment_{o.pigment}"
        text += object_(f"Object_{i}", surface(o.shape, needs, i), texture, inner.get(i), needs.lit)
    return text
