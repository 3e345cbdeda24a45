"""The rays that a picture begins with, one for each sample of a pixel, and what tells their random numbers."""

from dataclasses import replace
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins import sampler as samples
from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.kernel_scene import KernelScene
from mitsuba_plugins.intersection.rays import Ray, largest, start_ray, unit
from mitsuba_plugins.intersection.rounding import bounds_all, epsilon, least_spread, most_camera_blur


def pixel_key(scene: KernelScene, corner: Any) -> Any:
    """The key of the random numbers of pixels, by their top left corners (Point2d)."""
    if not scene.sampled:
        return mi.UInt32(0)
    return samples.pixel_key(dr.opaque(mi.UInt32, scene.parameters.seed), mi.UInt32(corner.x), mi.UInt32(corner.y))


def name_sample(scene: KernelScene, key: Any, number: Any) -> samples.Sample:
    """A sample of pixels, by their keys and its number."""
    if scene.parameters.points == "independent":
        key, number = samples.make_independent(key, number)
    return samples.Sample(key, number)


def primary_ray(scene: KernelScene, position: Any, sample: samples.Sample) -> Ray:
    """The ray of a `sample` through a film position (Point2d, in pixels) of the scene's sensor, in double precision
    where that has it.
    """
    types, sensor = scene.types, scene.sensor
    if hasattr(sensor, "primary_ray"):
        error, spread = scene.errors_of_eye
        if scene.has_lens:
            square = sample.square(mi.Float64, samples.PRIMARY_PATH, samples.LENS)
            o, d = sensor.primary_ray(position, samples.disc_point(*square))
            error = error + 8 * epsilon(error) * types.Float(largest(o) + sensor.aperture)
            # The nearer the plane in focus, in radii of the lens, the more a direction changes with its two ends.
            spread = quotient(4 * (spread + least_spread(spread)), types.Float(sensor.relative_focal))
            spread = dr.minimum(spread, most_camera_blur(spread))
        else:
            o, d = sensor.primary_ray(position)
        if bounds_all(error):
            error = error + epsilon(error) * types.Float(largest(o))
        ray = start_ray(types, o, d, error, spread)
        return ray if scene.eye_contact is None else scene.eye_contact.start(ray)
    size, offset = sensor.film().crop_size(), sensor.film().crop_offset()
    place = mi.Point2f(quotient(position - mi.Point2d(offset), mi.Point2d(size)))
    ray, _ = sensor.sample_ray(0.0, 0.5, place, mi.Point2f(0.5))
    return start_ray(types, ray.o, unit(mi.Vector3d(ray.d)))


def timed(scene: KernelScene, ray: Ray, sample: samples.Sample) -> Ray:
    """A ray with the time of its `sample`, which its whole tree has, where anything moves."""
    if not scene.moves:
        return ray
    return replace(ray, time=sample.square(scene.types.Float, samples.PRIMARY_PATH, samples.TIME)[0])
