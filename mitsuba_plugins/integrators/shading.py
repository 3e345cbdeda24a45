"""What a surface sends back along a ray by itself: ambient light, and what each light adds, in Phong's model.

Phong, Illumination for Computer Generated Pictures, Communications of the ACM 18(6), 1975; Blinn, Models of Light
Reflection for Computer Synthesized Pictures, SIGGRAPH 1977, for the other highlight.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins import sampler as samples
from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.doubts import light_doubt
from mitsuba_plugins.integrators.kernel_scene import KernelScene
from mitsuba_plugins.integrators.tables import Finish
from mitsuba_plugins.intersection.rays import NOTHING, Hit, Ray, largest, power, reflect, unit
from mitsuba_plugins.intersection.rounding import bounds_all, epsilon, least_spread
from mitsuba_plugins.syntax import syntax


@dataclass
class Illumination:
    """What a light adds at a hit: n . l, the attenuation, the object in its way or NOTHING, the two terms (Color3), and
    whether the shadow ray came close to a tie that nobody has decided; or, where all is bounded, by how much the terms
    may be off (Float).
    """

    cosine: Any
    attenuation: Any
    blocker: Any
    diffuse: Any
    specular: Any
    undecided: Any


@syntax
def local_radiance(
    scene: KernelScene, ray: Ray, hit: Hit, finish: Finish, color: Any, sample: samples.Sample, path: Any
) -> tuple[Any, Any, Any]:
    """What a surface sends back along a ray by itself (Color3); if the scene has a `signer`, a word (UInt32) for the
    shadows that it lies in, else None; and whether one of these is undecided.
    """
    types = scene.types
    radiance = finish.ka * types.Color3(scene.parameters.ambient) * color
    shadows: Any = None if scene.signer is None else dr.zeros(mi.UInt32, dr.width(ray.d))
    bounded = bounds_all(ray.t_min)
    unsure: Any = dr.zeros(mi.Bool, dr.width(ray.d))
    color_doubt: Any = None
    if dr.hint(bounded, mode="scalar"):
        color_doubt = scene.color_doubt(ray, hit)
        unsure = dr.max(dr.abs(finish.ka * types.Color3(scene.parameters.ambient))) * color_doubt
    if dr.hint(scene.parameters.shadows, mode="scalar"):
        lit = hit.valid & (finish.kd + finish.ks > 0)
        index = dr.zeros(mi.UInt32, dr.width(ray.d))
        while dr.hint(
            lit & (index < scene.lights.count),
            exclude=[scene, ray, hit, finish, color, lit, sample, path, bounded, color_doubt],
        ):
            illumination = light(scene, index, ray, hit, finish, color, lit, sample, path, color_doubt)
            radiance += illumination.diffuse + illumination.specular
            if dr.hint(bounded, mode="scalar"):
                unsure += illumination.undecided
            else:
                unsure |= illumination.undecided
            if dr.hint(scene.signer is not None, mode="scalar"):
                word = scene.signer.shadow_word(path, index)
                shadows += dr.select(illumination.blocker != NOTHING, word, 0)
            index += 1
    return radiance, shadows, unsure


def light(
    scene: KernelScene,
    index: Any,
    ray: Ray,
    hit: Hit,
    finish: Finish,
    color: Any,
    active: Any,
    sample: samples.Sample,
    path: Any,
    color_doubt: Any = None,
) -> Illumination:
    """What one light, by its index, adds at a hit of a `sample`'s ray of that path."""
    position, radius, emission, coefficients = scene.lights.get(index, active)
    a, b, c = coefficients
    to_light = position - hit.p
    error = hit.error
    if bounds_all(error):
        error = error + 4 * epsilon(error) * largest(position)
    if scene.has_soft_shadows:
        square = sample.square(scene.types.Float, path, samples.FIRST_LIGHT + index)
        to_light, error = _to_disc(to_light, position, radius, square, error)
    distance = dr.norm(to_light)
    to_light = to_light * quotient(1, distance)
    n = dr.select(hit.inside, -hit.n, hit.n)
    cosine = dr.dot(n, to_light)
    # A surface is not lit along itself, nor by a light at the very point.
    apart = distance > 8 * epsilon(distance) * largest(hit.p)
    along_plane = scene.light_contacts.grazes(index, hit.primitive, active)
    facing = active & (cosine > least_spread(cosine)) & apart & ~along_plane
    blocker, undecided = scene.tracer.blocker(hit, to_light, distance, error, index, facing)
    attenuation = a + distance * (b + distance * c)
    # Masked at the end: a light at the hit itself has no direction, and nothing times no number is no number.
    lit = facing & (blocker == NOTHING)
    intensity = emission * quotient(1, attenuation)
    diffuse = (finish.kd * cosine * color * intensity) & lit
    specular = scene.types.Color3(0)
    highlight = _highlight_cosine(scene, ray, n, to_light) if scene.parameters.highlights else None
    if highlight is not None:
        # What is rounded above 1 has no bounds.
        shine = power(dr.minimum(dr.maximum(highlight[0], 0), 1), finish.alpha)
        specular = (finish.ks * shine * intensity) & lit
    if bounds_all(distance):
        doubt, most = light_doubt(
            ray, hit, finish, color, color_doubt, cosine, distance, error, emission, coefficients, highlight
        )
        turns = active & ~along_plane & ~(dr.abs(cosine) > hit.lean + quotient(error, distance))
        unsure = (facing & undecided) | turns | (active & ~(most < dr.inf))
        undecided = dr.select(unsure, most, dr.select(lit, doubt, 0))
    return Illumination(cosine, attenuation, blocker, diffuse, specular, undecided)


def _highlight_cosine(scene: KernelScene, ray: Ray, n: Any, to_light: Any) -> tuple[Any, Any]:
    """The cosine whose power a highlight is, and by how much more than others an angle may be off there."""
    if scene.blinn:
        half = to_light - ray.d
        return dr.dot(n, unit(half)), quotient(2, dr.norm(half)) if bounds_all(to_light) else 1
    return dr.dot(reflect(ray.d, n), to_light), 1


def _to_disc(center: Any, position: Any, radius: Any, square: Any, error: Any) -> tuple[Any, Any]:
    """From a point to a point of a light, and how far these two may be off, given how far the first may.

    The way to the light's centre is given: the disc lies across it, and turns with it where the point is off.
    """
    nearness = quotient(1, dr.norm(center))
    tangent, bitangent = samples.frame(center * nearness)
    x, y = samples.disc_point(*square)
    off = radius * (error * nearness + 8 * epsilon(radius)) + 8 * epsilon(radius) * largest(position)
    is_disc = radius > 0
    way = center + (radius * x) * tangent + (radius * y) * bitangent
    return dr.select(is_disc, way, center), dr.select(is_disc, error + off, error)
