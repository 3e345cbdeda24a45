"""The loop over the rays of a tree: each adds what the surface that it hits sends back, and others follow it.

Whitted, An Improved Illumination Model for Shaded Display, Communications of the ACM 23(6), 1980.
"""

from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins import sampler as samples
from mitsuba_plugins.integrators.doubts import MOST_DOUBT, cutoff_doubt
from mitsuba_plugins.integrators.kernel_scene import KernelScene
from mitsuba_plugins.integrators.primary_rays import timed
from mitsuba_plugins.integrators.secondary_rays import followed, reflected, transmitted
from mitsuba_plugins.integrators.shading import local_radiance
from mitsuba_plugins.integrators.stack import RayStack
from mitsuba_plugins.intersection.rays import Ray, lanes
from mitsuba_plugins.intersection.rounding import bounds_all
from mitsuba_plugins.syntax import syntax


@syntax
def trace(scene: KernelScene, ray: Ray, sample: samples.Sample, active: Any) -> tuple[Any, Any, Any, Any]:
    """Radiance (Color3) along rays: the whole tree below each, in one kernel; if `depth_limited`, whether the limit
    dropped a ray that the cut-off would have kept, else False; if the scene has a `signer`, the signature (UInt32),
    else None; and, if the scene `leaves_undecided`, whether a tree is, else False. Each is the primary ray of a
    `sample`.

    Where a surface sends on two rays, the heavier one waits on a stack in local memory.
    """
    types, parameters = scene.types, scene.parameters
    # Everything starts at full width: with an index of width 1, all SIMD lanes would share one stack.
    width = dr.width(ray.d)
    radiance = dr.zeros(types.Color3, width)
    weight = dr.full(types.Float, 1, width)
    depth = dr.zeros(mi.UInt32, width)
    ray = timed(scene, ray, sample)
    active = active & lanes(width)
    too_deep: Any = dr.zeros(mi.Bool, width) if parameters.depth_limited else False
    signature: Any = None if scene.signer is None else dr.zeros(mi.UInt32, width)
    postpones = scene.postpones_ties
    bounded = bounds_all(weight)
    doubt: Any = dr.zeros(types.Float, width) if bounded else None
    undecided: Any = dr.zeros(mi.Bool, width) if postpones or bounded else False
    waiting: Any = dr.zeros(mi.UInt32, width) if parameters.branching else None
    stack = RayStack(types, parameters.waiting if parameters.branching else 0, scene.sampled)
    path: Any = dr.full(mi.UInt32, samples.PRIMARY_PATH, width) if scene.sampled else None
    while dr.hint(active, exclude=[scene, types, parameters, sample, postpones, bounded]):
        hit = scene.closest(ray, active)
        finish, color = scene.material(ray, hit)
        local, shadows, unsure = local_radiance(scene, ray, hit, finish, color, sample, path)
        if dr.hint(scene.signer is not None, mode="scalar"):
            least_weight = scene.signer.least_weight
            signature += dr.select(hit.valid & (weight >= least_weight), scene.hit_word(ray, hit, path), 0)
            lit_weight = weight * (finish.kd + finish.ks)
            signature += dr.select(hit.valid & (lit_weight >= least_weight), shadows, 0)
        if dr.hint(postpones, mode="scalar"):
            undecided |= hit.undecided | unsure
        if dr.hint(bounded, mode="scalar"):
            # What is undecided is lost, with all that would follow.
            doubt += weight * dr.select(hit.undecided, parameters.brightest, dr.select(hit.valid, unsure, 0))
            local = dr.select(hit.undecided, 0, local)
        radiance += weight * dr.select(hit.valid, local, types.Color3(parameters.background))

        depth += 1
        mirror_weight, mirrors, through_weight, refracts = followed(scene, weight, depth, hit, finish)
        if dr.hint(parameters.depth_limited, mode="scalar"):
            heavier = weight * dr.maximum(finish.kr, finish.kt)
            too_deep |= hit.valid & (depth > parameters.max_depth) & (heavier > 0) & (heavier >= scene.cutoff)
        active = mirrors | refracts
        if dr.hint(bounded, mode="scalar"):
            follows = hit.valid & (parameters.max_depth >= depth)
            doubt += dr.select(follows, cutoff_doubt(weight, finish, scene.cutoff, parameters.brightest), 0)
            undecided |= ~(doubt < MOST_DOUBT)
            active &= ~undecided
        if dr.hint(parameters.branching, mode="scalar"):
            through = transmitted(scene, ray, hit, finish, sample, path, refracts)[0]
            mirrored = reflected(scene, ray, hit, finish, sample, path, mirrors)
            pushes = mirrors & refracts
            # The lighter one first, which has the smaller tree below it: so few rays wait.
            mirrors_first = mirrors & ~(refracts & (finish.kt < finish.kr))
            later = dr.select(mirrors_first, through, mirrored)
            later_weight = dr.select(mirrors_first, through_weight, mirror_weight)
            if dr.hint(scene.sampled, mode="scalar"):
                later_path = 2 * path + dr.select(mirrors_first, mi.UInt32(1), 0)
                path = 2 * path + dr.select(mirrors_first, mi.UInt32(0), 1)
            else:
                later_path = path
            stack.write(waiting, later, later_weight, depth, later_path, pushes)
            waiting += dr.select(pushes, mi.UInt32(1), 0)
            ray = dr.select(mirrors_first, mirrored, through)
            weight = dr.select(mirrors_first, mirror_weight, through_weight)
            resumes = ~active & (waiting > 0)
            waiting -= dr.select(resumes, mi.UInt32(1), 0)
            waiting_ray, waiting_weight, waiting_depth, waiting_path = stack.read(waiting, ray.time, resumes)
            ray = dr.select(resumes, waiting_ray, ray)
            weight = dr.select(resumes, waiting_weight, weight)
            depth = dr.select(resumes, waiting_depth, depth)
            if dr.hint(scene.sampled, mode="scalar"):
                path = dr.select(resumes, waiting_path, path)
            active |= resumes
        elif dr.hint(parameters.reflection and parameters.refraction, mode="scalar"):
            weight = dr.select(mirrors, mirror_weight, through_weight)
            through = transmitted(scene, ray, hit, finish, sample, path, refracts)[0]
            ray = dr.select(mirrors, reflected(scene, ray, hit, finish, sample, path, mirrors), through)
            if dr.hint(scene.sampled, mode="scalar"):
                path = 2 * path + dr.select(mirrors, mi.UInt32(0), 1)
        elif dr.hint(parameters.reflection, mode="scalar"):
            weight = mirror_weight
            ray = reflected(scene, ray, hit, finish, sample, path, mirrors)
            if dr.hint(scene.sampled, mode="scalar"):
                path = 2 * path
        elif dr.hint(parameters.refraction, mode="scalar"):
            weight = through_weight
            ray = transmitted(scene, ray, hit, finish, sample, path, refracts)[0]
            if dr.hint(scene.sampled, mode="scalar"):
                path = 2 * path + 1
    return radiance, too_deep, signature, undecided
