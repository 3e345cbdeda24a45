"""Recursive ray tracing after Whitted, with the course's shading model, in double precision."""

import math
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins import sampler as samples
from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.integrators.doubts import MOST_DOUBT, Precisions, bounds_hold, cutoff_doubt, light_doubt
from mitsuba_plugins.integrators.pictures import PassSums, bands, block
from mitsuba_plugins.integrators.signature import hit_word, shadow_word
from mitsuba_plugins.integrators.stack import RayStack
from mitsuba_plugins.integrators.tables import Bsdfs, Finish, Illumination, Lights, Materials
from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.contacts import Contacts, EyeContact, LightContacts
from mitsuba_plugins.intersection.geometry import parse_geometry
from mitsuba_plugins.intersection.primitives import Primitives, pieces
from mitsuba_plugins.intersection.rays import (
    NOTHING,
    UPRIGHT,
    Hit,
    Ray,
    lanes,
    largest,
    mirrored_spread,
    power,
    real,
    reflect,
    refract,
    start_ray,
    unit,
)
from mitsuba_plugins.intersection.rounding import (
    bounds_all,
    camera_errors,
    coordinate_errors,
    decides_ties,
    epsilon,
    least_spread,
    most_blur,
    most_camera_blur,
)
from mitsuba_plugins.intersection.ways import WAYS, tracer_of, way_for
from mitsuba_plugins.syntax import syntax


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
        self.ambient = mi.Color3d(props.get("ambient", mi.ScalarColor3d(0.0)))
        self.background = mi.Color3d(props.get("background", mi.ScalarColor3d(0.0)))
        self.max_depth = mi.UInt32(props.get("max_depth", 16))
        self.intersections = props.get("intersections", "auto")
        if self.intersections not in (*WAYS, "auto"):
            raise ValueError(f"whitted: intersections is one of {WAYS} or auto, not '{self.intersections}'")
        self.intersections = way_for(self.surfaces, self.intersections)
        self.moves = any(surface.moves for surface in self.surfaces)
        if self.moves and self.intersections not in ("analytic", "bvh"):
            raise ValueError(f"whitted: 'geometry' moves objects, and the shapes of '{self.intersections}' stand still")
        self.precision = props.get("precision", "double")
        if self.precision not in ("double", "float", "mixed"):
            raise ValueError(f"whitted: precision is double, float or mixed, not '{self.precision}'")
        if self.precision == "mixed" and self.intersections not in ("analytic", "bvh"):
            raise ValueError(f"whitted: precision mixed is for analytic and bvh, not for '{self.intersections}'")
        if self.intersections in ("offset", "ulp"):
            self.precision = "float"
        self.types = real("float" if self.precision == "float" else "double")
        self.cutoff = self.types.Float(props.get("cutoff", 1 / 512))
        dr.make_opaque(self.ambient, self.background, self.max_depth, self.cutoff)
        self.reflection = props.get("reflection", True)
        self.refraction = props.get("refraction", True)
        self.branching = props.get("branching", True) and self.reflection and self.refraction
        self.shadows = props.get("shadows", True)
        self.highlights = props.get("highlights", True)
        self.stack_size = max(1, props.get("waiting", props.get("max_depth", 16)))
        self._brightest = mi.Float(min(props.get("brightest", math.inf), 2.0**100))
        dr.make_opaque(self._brightest)
        self.depth_limited = props.get("depth_limited", False)
        self.seed = props.get("seed", 0)
        self.points = props.get("points", "stratified")
        if self.points not in ("stratified", "independent"):
            raise ValueError(f"whitted: points is stratified or independent, not '{self.points}'")
        self.signing = False
        self.pixels_too_deep = 0
        self.precisions: Precisions | None = None
        self.sums: PassSums | None = None
        self._tracer: Any = None
        self._eye_contact: EyeContact | None = None

    @property
    def surfaces(self):
        """The exact surfaces (list of Surface), in the order of their objects."""
        return self._geometry.surfaces

    # ------------------------------------------------------------------ preparation

    @contextmanager
    def prepared(self, scene, sensor=None, least_weight=None):
        """Lay out what the kernel reads: surfaces, finishes, pigments, lights, and what the eye of a `pinhole` lies on;
        the methods below need it. With a `least_weight`, pixels get signatures of rays that weigh at least so much.

        Let go of at the end: it may hold the scene, which holds this integrator, and such circles are never freed.
        """
        contacts = Contacts(self.surfaces)
        self._pieces = column(mi.UInt32, pieces(self.surfaces)) if least_weight is not None else None
        self.signing = least_weight is not None
        self._least_weight = dr.opaque(self.types.Float, least_weight) if self.signing else None
        self.__dict__.update(self._laid_out(self.types, scene, sensor, contacts))
        self.light_count = self._lights.count
        self._soft_shadows = self.shadows and bool(self._lights.radii.any())
        self._spreads = self._materials.spread and (self.reflection or self.refraction)
        self._has_lens = getattr(sensor, "has_lens", False)
        # Where signatures are made, rays have paths.
        self.sampled = self.moves or self._soft_shadows or self._spreads or self._has_lens or self.signing
        self.precisions = None
        if self._fits_single():
            self.precisions = Precisions(self, lambda: self._laid_out(real("float"), scene, sensor, contacts))
        try:
            yield
        finally:
            self._tracer = None
            if self.precisions is not None:
                self.precisions.forget()

    def _laid_out(self, types, scene, sensor, contacts):
        """What there is once for each precision: attributes, by their names."""
        primitives = Primitives(types, self.surfaces)
        # These, too, are read anew each time: they are what mitsuba.traverse lets a user change.
        lights = Lights(types, scene.emitters())
        at_lights = LightContacts(types, contacts, lights.positions, lights.radii, self._entered())
        on_something = hasattr(sensor, "eye") and not getattr(sensor, "has_lens", False)
        return {
            "types": types,
            "cutoff": types.Float(self.cutoff),
            "first_primitives": primitives.first,
            "_materials": Materials(types, [self._bsdfs.by_name[surface.material] for surface in self.surfaces]),
            "_lights": lights,
            "_light_contacts": at_lights,
            "_eye_contact": EyeContact(types, contacts, np.ravel(sensor.eye)) if on_something else None,
            "_errors_of_primary_rays": camera_errors(types, sensor),
            "_tracer": tracer_of(self.intersections, types, scene, self.surfaces, primitives, at_lights),
        }

    def _entered(self):
        """The objects that rays are refracted into."""
        if not self.refraction:
            return []
        glass = {name for name, bsdf in self._bsdfs.by_name.items() if bsdf.kt[0] > 0}
        return [k for k, surface in enumerate(self.surfaces) if surface.material in glass]

    def _fits_single(self):
        """Whether all errors of single precision are bounded; not where anything is sampled, nor of rays that start on
        a surface.
        """
        on_something = self._eye_contact is not None and self._eye_contact.exists
        return self.precision == "mixed" and not self.sampled and not on_something and bounds_hold(self.surfaces)

    @property
    def leaves_undecided(self):
        """Whether `trace` leaves trees of rays undecided, and tells which."""
        return self.postpones_ties or bounds_all(self.types.Float)

    @property
    def postpones_ties(self):
        """Whether `trace` tells which rays' trees come close to a tie, and leaves it undecided."""
        return self._tracer.postpones_ties

    def postpone_ties(self, postpones):
        """Let `trace` do so, where it would decide ties: the code by which it does slows down the kernel."""
        self._tracer.postpones_ties = postpones and self._tracer.finds_ties and self.precision != "float"

    # ------------------------------------------------------------------ one ray

    def timed(self, ray: Ray, sample) -> Ray:
        """A ray with the time of its `sample`, which its whole tree has, where anything moves."""
        if not self.moves:
            return ray
        return replace(ray, time=sample.square(self.types.Float, samples.PRIMARY_PATH, samples.TIME)[0])

    def closest(self, ray: Ray, active) -> Hit:
        """The first surface that a ray meets."""
        return self._tracer.closest(ray, active)

    def material(self, ray: Ray, hit: Hit):
        """The finish and the pigment's colour at a hit."""
        finish = self._materials.finish(hit.object, hit.valid)
        return finish, self._materials.color(hit.object, hit.p_at_rest, self._errors(ray, hit), hit.valid)

    def _errors(self, ray: Ray, hit: Hit):
        """How far the coordinates of a hit may be off, where a pigment asks."""
        decides = (decides_ties(hit.t) or bounds_all(hit.t)) and self.intersections not in ("offset", "ulp")
        if not decides or not self._materials.has_edges:
            return self.types.Vector3(0)
        return coordinate_errors(hit.p_at_rest, hit.n, ray.d, hit.t, hit.off)

    def light(
        self, index, ray: Ray, hit: Hit, finish: Finish, color, active, sample, path, color_doubt=None
    ) -> Illumination:
        """What one light, by its index, adds at a hit of a `sample`'s ray of that path."""
        position, radius, emission, coefficients = self._lights.get(index, active)
        a, b, c = coefficients
        to_light = position - hit.p
        error = hit.error
        if bounds_all(error):
            error = error + 4 * epsilon(error) * largest(position)
        if self._soft_shadows:
            square = sample.square(self.types.Float, path, samples.FIRST_LIGHT + index)
            to_light, error = _to_disc(to_light, position, radius, square, error)
        distance = dr.norm(to_light)
        to_light = to_light * quotient(1, distance)
        n = dr.select(hit.inside, -hit.n, hit.n)
        cosine = dr.dot(n, to_light)
        # A surface is not lit along itself, nor by a light at the very point.
        apart = distance > 8 * epsilon(distance) * largest(hit.p)
        along_plane = self._light_contacts.grazes(index, hit.primitive, active)
        facing = active & (cosine > least_spread(cosine)) & apart & ~along_plane
        blocker, undecided = self._tracer.blocker(hit, to_light, distance, error, index, facing)
        attenuation = a + distance * (b + distance * c)
        # Masked at the end: a light at the hit itself has no direction, and nothing times no number is no number.
        lit = facing & (blocker == NOTHING)
        intensity = emission * quotient(1, attenuation)
        diffuse = (finish.kd * cosine * color * intensity) & lit
        specular = self.types.Color3(0)
        highlight = self._highlight_cosine(ray, n, to_light) if self.highlights else None
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

    def _highlight_cosine(self, ray: Ray, n, to_light):
        """The cosine whose power a highlight is, and by how much more than others an angle may be off there."""
        if self._materials.blinn:
            half = to_light - ray.d
            return dr.dot(n, unit(half)), quotient(2, dr.norm(half)) if bounds_all(to_light) else 1
        return dr.dot(reflect(ray.d, n), to_light), 1

    def reflected(self, ray: Ray, hit: Hit, finish: Finish, sample, path, active) -> Ray:
        """The ray that follows a `sample`'s ray of that path in the mirror direction."""
        d, spread = reflect(ray.d, hit.n), mirrored_spread(ray, hit)
        if self._spreads:
            d, spread = self._in_cone(d, spread, hit, hit.inside, finish, sample, path, samples.MIRRORED_CONE, active)
        return self._tracer.spawn(hit, d, hit.inside, spread)

    def transmitted(self, ray: Ray, hit: Hit, finish: Finish, sample, path, active) -> tuple[Ray, Any]:
        """The refracted ray, or the mirrored one past the critical angle, and whether it is past."""
        eta = dr.select(hit.inside, quotient(1, finish.eta), finish.eta)
        n = dr.select(hit.inside, -hit.n, hit.n)
        d, total, spread = refract(ray.d, n, eta, dr.minimum(ray.spread + hit.lean, most_blur(ray.spread)), hit.lean)
        spread = dr.select(total, mirrored_spread(ray, hit), spread)
        inside = hit.inside == total
        if self._spreads:
            d, spread = self._in_cone(d, spread, hit, inside, finish, sample, path, samples.REFRACTED_CONE, active)
        return self._tracer.spawn(hit, d, inside, spread), total

    @syntax
    def _in_cone(self, d, spread, hit: Hit, inside, finish: Finish, sample, path, use, active):
        """A direction that is uniform in the cone about `d`, where the finish has one, and how far it may be off.

        One that leads to the other side of the tangent plane is mirrored in that.
        """
        if active & (finish.versine > 0):
            square = sample.square(self.types.Float, path, use)
            d = samples.cone_direction(d, finish.versine, *square)
            n = dr.select(inside, -hit.n, hit.n)
            d = unit(d - n * (2 * dr.minimum(dr.dot(n, d), 0)))
            # By eight times at most do the frame's axes turn faster than its axis.
            spread = dr.minimum(8 * spread + 2 * hit.lean, most_blur(spread))
        return d, spread

    # ------------------------------------------------------------------ the ray tree

    @syntax
    def trace(self, ray: Ray, sample, active):
        """Radiance (Color3) along rays: the whole tree below each, in one kernel; if `depth_limited`, whether the limit
        dropped a ray that the cut-off would have kept, else False; if `signing`, the signature (UInt32), else None;
        and, if ties are postponed, whether a ray of the tree came close to one, else False. Each is the primary ray of
        a `sample`.

        Where a surface sends on two rays, the heavier one waits on a stack in local memory.
        """
        # Everything starts at full width: with an index of width 1, all SIMD lanes would share one stack.
        width = dr.width(ray.d)
        radiance = dr.zeros(self.types.Color3, width)
        weight = dr.full(self.types.Float, 1, width)
        depth = dr.zeros(mi.UInt32, width)
        ray = self.timed(ray, sample)
        active = active & lanes(width)
        too_deep = dr.zeros(mi.Bool, width) if self.depth_limited else False
        signature: Any = dr.zeros(mi.UInt32, width) if self.signing else None
        postpones = self.postpones_ties
        bounded = bounds_all(weight)
        doubt: Any = dr.zeros(self.types.Float, width) if bounded else None
        undecided = dr.zeros(mi.Bool, width) if postpones or bounded else False
        waiting: Any = dr.zeros(mi.UInt32, width) if self.branching else None
        stack = RayStack(self.types, self.stack_size if self.branching else 0, self.sampled)
        path: Any = dr.full(mi.UInt32, samples.PRIMARY_PATH, width) if self.sampled else None
        while dr.hint(active, exclude=[self, sample, postpones, bounded]):
            hit = self.closest(ray, active)
            finish, color = self.material(ray, hit)
            local, shadows, unsure = self.local_radiance(ray, hit, finish, color, sample, path)
            if dr.hint(self.signing, mode="scalar"):
                signature += dr.select(hit.valid & (weight >= self._least_weight), self._hit_word(ray, hit, path), 0)
                lit_weight = weight * (finish.kd + finish.ks)
                signature += dr.select(hit.valid & (lit_weight >= self._least_weight), shadows, 0)
            if dr.hint(postpones, mode="scalar"):
                undecided |= hit.undecided | unsure
            if dr.hint(bounded, mode="scalar"):
                # What is undecided is lost, with all that would follow.
                doubt += weight * dr.select(hit.undecided, self._brightest, dr.select(hit.valid, unsure, 0))
                local = dr.select(hit.undecided, 0, local)
            radiance += weight * dr.select(hit.valid, local, self.types.Color3(self.background))

            depth += 1
            mirror_weight, mirrors, through_weight, refracts = self.followed(weight, depth, hit, finish)
            if dr.hint(self.depth_limited, mode="scalar"):
                heavier = weight * dr.maximum(finish.kr, finish.kt)
                too_deep |= hit.valid & (depth > self.max_depth) & (heavier > 0) & (heavier >= self.cutoff)
            active = mirrors | refracts
            if dr.hint(bounded, mode="scalar"):
                follows = hit.valid & (self.max_depth >= depth)
                doubt += dr.select(follows, cutoff_doubt(weight, finish, self.cutoff, self._brightest), 0)
                undecided |= ~(doubt < MOST_DOUBT)
                active &= ~undecided
            if dr.hint(self.branching, mode="scalar"):
                through = self.transmitted(ray, hit, finish, sample, path, refracts)[0]
                mirrored = self.reflected(ray, hit, finish, sample, path, mirrors)
                pushes = mirrors & refracts
                # The lighter one first, which has the smaller tree below it: so few rays wait.
                mirrors_first = mirrors & ~(refracts & (finish.kt < finish.kr))
                later = dr.select(mirrors_first, through, mirrored)
                later_weight = dr.select(mirrors_first, through_weight, mirror_weight)
                if dr.hint(self.sampled, mode="scalar"):
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
                if dr.hint(self.sampled, mode="scalar"):
                    path = dr.select(resumes, waiting_path, path)
                active |= resumes
            elif dr.hint(self.reflection and self.refraction, mode="scalar"):
                weight = dr.select(mirrors, mirror_weight, through_weight)
                through = self.transmitted(ray, hit, finish, sample, path, refracts)[0]
                ray = dr.select(mirrors, self.reflected(ray, hit, finish, sample, path, mirrors), through)
                if dr.hint(self.sampled, mode="scalar"):
                    path = 2 * path + dr.select(mirrors, mi.UInt32(0), 1)
            elif dr.hint(self.reflection, mode="scalar"):
                weight = mirror_weight
                ray = self.reflected(ray, hit, finish, sample, path, mirrors)
                if dr.hint(self.sampled, mode="scalar"):
                    path = 2 * path
            elif dr.hint(self.refraction, mode="scalar"):
                weight = through_weight
                ray = self.transmitted(ray, hit, finish, sample, path, refracts)[0]
                if dr.hint(self.sampled, mode="scalar"):
                    path = 2 * path + 1
        return radiance, too_deep, signature, undecided

    def _hit_word(self, ray: Ray, hit: Hit, path):
        """What the hit of a ray of that path adds to a signature."""
        piece = dr.gather(mi.UInt32, self._pieces, hit.primitive & UPRIGHT, hit.valid)
        cell = self._materials.cell(hit.object, hit.p_at_rest, self._errors(ray, hit), hit.valid)
        inside = dr.select(hit.inside, mi.UInt32(1), 0)
        return hit_word(path, hit.object, piece, inside, cell)

    def followed(self, weight, depth, hit: Hit, finish: Finish):
        """Weight of the mirrored ray of a hit, and where it is followed; the same of the refracted one.

        `weight` is that of the ray that has hit, and `depth` how many bounces lie before those that follow.
        """
        follows = hit.valid & (depth <= self.max_depth)
        mirror_weight, mirrors = self._successor_weight(self.reflection, weight * finish.kr, follows)
        through_weight, refracts = self._successor_weight(self.refraction, weight * finish.kt, follows)
        return mirror_weight, mirrors, through_weight, refracts

    def _successor_weight(self, enabled, weight, active):
        """Weight of a mirrored or refracted ray, and where it is followed."""
        if not enabled:
            return self.types.Float(0), mi.Bool(False)
        return weight, active & (weight > 0) & (weight >= self.cutoff)

    @syntax
    def local_radiance(self, ray: Ray, hit: Hit, finish: Finish, color, sample, path):
        """What a surface sends back along a ray by itself (Color3): ambient light, and what the lights add; if
        `signing`, a word (UInt32) for the shadows that it lies in, else None; and whether one of these is undecided.
        """
        radiance = finish.ka * self.types.Color3(self.ambient) * color
        shadows: Any = dr.zeros(mi.UInt32, dr.width(ray.d)) if self.signing else None
        bounded = bounds_all(ray.t_min)
        unsure: Any = dr.zeros(mi.Bool, dr.width(ray.d))
        color_doubt: Any = None
        if dr.hint(bounded, mode="scalar"):
            color_doubt = self._materials.unlike(hit.object, hit.p_at_rest, self._errors(ray, hit), hit.valid)
            unsure = dr.max(dr.abs(finish.ka * self.types.Color3(self.ambient))) * color_doubt
        if dr.hint(self.shadows, mode="scalar"):
            lit = hit.valid & (finish.kd + finish.ks > 0)
            light = dr.zeros(mi.UInt32, dr.width(ray.d))
            while dr.hint(
                lit & (light < self.light_count),
                exclude=[self, ray, hit, finish, color, lit, sample, path, bounded, color_doubt],
            ):
                illumination = self.light(light, ray, hit, finish, color, lit, sample, path, color_doubt)
                radiance += illumination.diffuse + illumination.specular
                if dr.hint(bounded, mode="scalar"):
                    unsure += illumination.undecided
                else:
                    unsure |= illumination.undecided
                if dr.hint(self.signing, mode="scalar"):
                    shadows += dr.select(illumination.blocker != NOTHING, shadow_word(path, light), 0)
                light += 1
        return radiance, shadows, unsure

    # ------------------------------------------------------------------ pictures

    def sample(self, scene, sampler, ray, medium=None, active=True):
        """Radiance along single-precision rays, of any sensor."""
        with self.prepared(scene):
            # Which sample of which pixel a ray is, nobody tells here.
            key = mi.UInt32(mi.Float64(sampler.next_1d()) * 2.0**32) if self.sampled else mi.UInt32(0)
            sample = self.name_sample(key, mi.UInt32(0))
            color, *_ = self.trace(start_ray(self.types, ray.o, unit(mi.Vector3d(ray.d))), sample, active)
        return mi.Color3f(color), mi.Bool(active), []

    def render(self, scene, sensor=0, seed=0, spp=0, develop=True, evaluate=True):
        """Draw a picture. The samples of a pixel lie on a regular grid: in the centres of n x n = `spp` cells."""
        if isinstance(sensor, int):
            sensor = scene.sensors()[sensor]
        film = sensor.film()
        film.prepare([])
        film.put_block(block([color for _, color in bands(self, scene, sensor, spp)], film))
        if not develop:
            return None
        image = film.develop()
        if evaluate:
            dr.eval(image)
        return image

    def pixel_key(self, corner):
        """The key of the random numbers of pixels, by their top left corners (Point2d)."""
        if not self.sampled:
            return mi.UInt32(0)
        return samples.pixel_key(dr.opaque(mi.UInt32, self.seed), mi.UInt32(corner.x), mi.UInt32(corner.y))

    def name_sample(self, key, number):
        """A sample of pixels, by their keys and its number."""
        if self.points == "independent":
            key, number = samples.make_independent(key, number)
        return samples.Sample(key, number)

    def primary_ray(self, sensor, position, sample) -> Ray:
        """The ray of a `sample` through a film position (Point2d, in pixels), in double precision where the sensor has
        it.
        """
        if hasattr(sensor, "primary_ray"):
            error, spread = self._errors_of_primary_rays
            if self._has_lens:
                square = sample.square(mi.Float64, samples.PRIMARY_PATH, samples.LENS)
                o, d = sensor.primary_ray(position, samples.disc_point(*square))
                error = error + 8 * epsilon(error) * self.types.Float(largest(o) + sensor.aperture)
                # The nearer the plane in focus, in radii of the lens, the more a direction changes with its two ends.
                spread = quotient(4 * (spread + least_spread(spread)), self.types.Float(sensor.relative_focal))
                spread = dr.minimum(spread, most_camera_blur(spread))
            else:
                o, d = sensor.primary_ray(position)
            if bounds_all(error):
                error = error + epsilon(error) * self.types.Float(largest(o))
            ray = start_ray(self.types, o, d, error, spread)
            return ray if self._eye_contact is None else self._eye_contact.start(ray)
        size, offset = sensor.film().crop_size(), sensor.film().crop_offset()
        sample = mi.Point2f(quotient(position - mi.Point2d(offset), mi.Point2d(size)))
        ray, _ = sensor.sample_ray(0.0, 0.5, sample, mi.Point2f(0.5))
        return start_ray(self.types, ray.o, unit(mi.Vector3d(ray.d)))

    def traverse(self, callback):
        callback.put("ambient", self.ambient, mi.ParamFlags.NonDifferentiable)
        callback.put("background", self.background, mi.ParamFlags.NonDifferentiable)
        callback.put("cutoff", self.cutoff, mi.ParamFlags.NonDifferentiable)
        callback.put("max_depth", self.max_depth, mi.ParamFlags.NonDifferentiable)
        for name, bsdf in self._bsdfs.by_name.items():
            callback.put(name, bsdf, mi.ParamFlags.Differentiable)

    def to_string(self):
        way = f"{self.intersections}, {self.precision}"
        return f"Whitted[{len(self.surfaces)} surfaces, {way}, max_depth={self.max_depth}]"


def _to_disc(center, position, radius, square, error):
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


mi.register_integrator("whitted", Whitted)
