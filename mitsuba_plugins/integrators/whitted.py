"""Recursive ray tracing after Whitted, with the course's shading model, in double precision."""

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.parameters import read_parameters
from mitsuba_plugins.integrators.pictures import Picture
from mitsuba_plugins.integrators.pixels import block
from mitsuba_plugins.integrators.precisions import Precisions
from mitsuba_plugins.integrators.primary_rays import name_sample
from mitsuba_plugins.integrators.ray_tree import trace
from mitsuba_plugins.integrators.tables import Bsdfs
from mitsuba_plugins.intersection.geometry import parse_geometry
from mitsuba_plugins.intersection.rays import start_ray, unit


class Whitted(mi.SamplingIntegrator):
    r"""Whitted ray tracing integrator (``whitted``).

    .. pluginparameters::

     * - geometry
       - |string|
       - The exact surfaces, as a JSON text (see :mod:`mitsuba_plugins.intersection.geometry`)

     * - filename
       - |string|
       - A file that holds that text, instead of ``geometry``

     * - (nested plugins)
       - |bsdf|
       - The materials of the surfaces, ``phong`` BSDFs, under the names that ``geometry`` uses

     * - ambient, background
       - |color|
       - Linear RGB of the ambient light, and of rays that hit nothing (Default: 0)

     * - max_depth
       - |int|
       - Bounces after the primary ray (Default: 16)

     * - waiting
       - |int|
       - Most rays of a tree that wait at once, if of two the one with the smaller kr or kt is followed first
         (Default: max_depth)

     * - depth_limited
       - |bool|
       - Count the pixels in which max_depth drops rays that the cutoff would keep, as ``pixels_too_deep``
         (Default: false)

     * - cutoff
       - |float|
       - A ray whose weight, the product of kr and kt so far, is below it is not traced (Default: 1/512)

     * - seed
       - |int|
       - Start of the random numbers, where something is sampled: a light with a radius, a finish with a cone, a sensor
         with an aperture, an object that moves (Default: 0)

     * - points
       - |string|
       - The random numbers of a pixel's samples: ``stratified``, or ``independent``, to see what that is worth
         (Default: stratified)

     * - reflection, refraction, branching
       - |bool|
       - Follow mirrored rays, refracted rays, and both from one surface (Default: true, true, true)

     * - shadows
       - |bool|
       - Light surfaces by the scene's lights at all (Default: true)

     * - highlights
       - |bool|
       - Evaluate the glossy term (Default: true)

     * - intersections
       - |string|
       - ``analytic``: intersect spheres and half-spaces in the kernel, each with code of its own; ``bvh``: through a
         tree of boxes; ``mesh``: let Embree or OptiX find which of the scene's shapes is hit and compute where from
         the exact surface; ``offset``, ``ulp``: believe Embree or OptiX, and start rays off the surface by Mitsuba's
         own offset or Waechter and Binder's; ``auto``: ``analytic`` for small scenes and few bounded objects on a CPU,
         else ``bvh`` (Default: auto)

     * - precision
       - |string|
       - ``double`` or ``float``: of rays and intersections; ``offset`` and ``ulp`` have ``float`` only; ``mixed``:
         single, with bounds of all its errors, and once more in double what these leave undecided, with ``analytic``
         and ``bvh`` only (Default: double)

     * - brightest
       - |float|
       - Largest channel that a ray can bring with all that follow from it, which ``mixed`` takes for what it does not
         know of a ray (Default: infinity)

    The scene's shapes are needed for ``mesh``, ``offset`` and ``ulp`` only. Every light is an ``attenuated_point``.
    Switching off what a scene does not need makes it faster and changes nothing else. In double precision rays keep
    their origins and directions so from bounce to bounce, and, where the sensor is a ``pinhole``, from the camera on.
    Random numbers are the native tracer's (see :mod:`mitsuba_plugins.sampler`), whatever the scene's sampler.
    Whitted, An Improved Illumination Model for Shaded Display, Communications of the ACM 23(6), 1980. Not for indirect
    diffuse light, area lights or gradients.
    """

    def __init__(self, props):
        mi.SamplingIntegrator.__init__(self, props)
        if ("geometry" in props) == ("filename" in props):
            raise ValueError("whitted: give either 'geometry' or 'filename', the exact surfaces of the scene")
        if "geometry" in props:
            text = props["geometry"]
        else:
            with open(str(mi.file_resolver().resolve(props["filename"])), encoding="utf-8") as file:  # noqa: PTH123
                text = file.read()
        self._geometry = parse_geometry(text)
        self._bsdfs = Bsdfs(props, self.surfaces)
        self.parameters = read_parameters(props, self.surfaces)

    @property
    def surfaces(self):
        """The exact surfaces (list of Surface), in the order of their objects."""
        return self._geometry.surfaces

    def prepared(self, scene, sensor=None, least_weight=None):
        """What kernels read (Precisions): surfaces, finishes, pigments, lights, and where the sensor's rays start. With
        a `least_weight`, pixels get signatures of rays that weigh at least so much.

        Nothing of it is kept here: it may hold the scene, which holds this integrator, and such circles are not freed.
        """
        return Precisions(self.parameters, self.surfaces, self._bsdfs, scene, sensor, least_weight)

    def sample(self, scene, sampler, ray, medium=None, active=True):
        """Radiance along single-precision rays, of any sensor."""
        prepared = self.prepared(scene).deciding
        # Which sample of which pixel a ray is, nobody tells here.
        key = mi.UInt32(mi.Float64(sampler.next_1d()) * 2.0**32) if prepared.sampled else mi.UInt32(0)
        sample = name_sample(prepared, key, mi.UInt32(0))
        color, *_ = trace(prepared, start_ray(prepared.types, ray.o, unit(mi.Vector3d(ray.d))), sample, active)
        return mi.Color3f(color), mi.Bool(active), []

    def render(self, scene, sensor=0, seed=0, spp=0, develop=True, evaluate=True):
        """Draw a picture. The samples of a pixel lie on a regular grid: in the centres of n x n = `spp` cells."""
        if isinstance(sensor, int):
            sensor = scene.sensors()[sensor]
        film = sensor.film()
        film.prepare([])
        film.put_block(block([color for _, color in Picture(self, scene, sensor).bands(spp)], film))
        if not develop:
            return None
        image = film.develop()
        if evaluate:
            dr.eval(image)
        return image

    def traverse(self, callback):
        for name in ("ambient", "background", "cutoff", "max_depth"):
            callback.put(name, getattr(self.parameters, name), mi.ParamFlags.NonDifferentiable)
        for name, bsdf in self._bsdfs.by_name.items():
            callback.put(name, bsdf, mi.ParamFlags.Differentiable)

    def to_string(self):
        parameters = self.parameters
        way = f"{parameters.intersections}, {parameters.precision}"
        return f"Whitted[{len(self.surfaces)} surfaces, {way}, max_depth={parameters.max_depth}]"


mi.register_integrator("whitted", Whitted)
