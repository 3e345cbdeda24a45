"""The rays that follow where a ray has hit: mirrored and refracted ones, and which of them are traced."""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins import sampler as samples
from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.kernel_scene import KernelScene
from mitsuba_plugins.integrators.tables import Finish
from mitsuba_plugins.intersection.rays import Hit, Ray, mirrored_spread, reflect, refract, unit
from mitsuba_plugins.intersection.rounding import most_blur
from mitsuba_plugins.syntax import syntax


def reflected(
    scene: KernelScene, ray: Ray, hit: Hit, finish: Finish, sample: samples.Sample, path: Any, active: Any
) -> Ray:
    """The ray that follows a `sample`'s ray of that path in the mirror direction."""
    d, spread = reflect(ray.d, hit.n), mirrored_spread(ray, hit)
    if scene.has_cones:
        cone = samples.MIRRORED_CONE
        d, spread = _in_cone(scene, d, spread, hit, hit.inside, finish, sample, path, cone, active)
    result: Ray = scene.tracer.spawn(hit, d, hit.inside, spread)
    return result


def transmitted(
    scene: KernelScene, ray: Ray, hit: Hit, finish: Finish, sample: samples.Sample, path: Any, active: Any
) -> tuple[Ray, Any]:
    """The refracted ray, or the mirrored one past the critical angle, and whether it is past."""
    eta = dr.select(hit.inside, quotient(1, finish.eta), finish.eta)
    n = dr.select(hit.inside, -hit.n, hit.n)
    d, total, spread = refract(ray.d, n, eta, dr.minimum(ray.spread + hit.lean, most_blur(ray.spread)), hit.lean)
    spread = dr.select(total, mirrored_spread(ray, hit), spread)
    inside = hit.inside == total
    if scene.has_cones:
        cone = samples.REFRACTED_CONE
        d, spread = _in_cone(scene, d, spread, hit, inside, finish, sample, path, cone, active)
    return scene.tracer.spawn(hit, d, inside, spread), total


@syntax
def _in_cone(
    scene: KernelScene,
    d: Any,
    spread: Any,
    hit: Hit,
    inside: Any,
    finish: Finish,
    sample: samples.Sample,
    path: Any,
    use: int,
    active: Any,
) -> tuple[Any, Any]:
    """A direction that is uniform in the cone about `d`, where the finish has one, and how far it may be off.

    One that leads to the other side of the tangent plane is mirrored in that.
    """
    if active & (finish.versine > 0):
        square = sample.square(scene.types.Float, path, use)
        d = samples.cone_direction(d, finish.versine, *square)
        n = dr.select(inside, -hit.n, hit.n)
        d = unit(d - n * (2 * dr.minimum(dr.dot(n, d), 0)))
        # By eight times at most do the frame's axes turn faster than its axis.
        spread = dr.minimum(8 * spread + 2 * hit.lean, most_blur(spread))
    return d, spread


def followed(scene: KernelScene, weight: Any, depth: Any, hit: Hit, finish: Finish) -> tuple[Any, Any, Any, Any]:
    """Weight of the mirrored ray of a hit, and where it is followed; the same of the refracted one.

    `weight` is that of the ray that has hit, and `depth` how many bounces lie before those that follow.
    """
    follows = hit.valid & (depth <= scene.parameters.max_depth)
    mirror_weight, mirrors = _successor_weight(scene, scene.parameters.reflection, weight * finish.kr, follows)
    through_weight, refracts = _successor_weight(scene, scene.parameters.refraction, weight * finish.kt, follows)
    return mirror_weight, mirrors, through_weight, refracts


def _successor_weight(scene: KernelScene, enabled: bool, weight: Any, active: Any) -> tuple[Any, Any]:
    """Weight of a mirrored or refracted ray, and where it is followed."""
    if not enabled:
        return scene.types.Float(0), mi.Bool(False)
    return weight, active & (weight > 0) & (weight >= scene.cutoff)
