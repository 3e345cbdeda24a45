"""A point light with a polynomial attenuation, or a disc of such points: the course's light."""

import drjit as dr
import mitsuba as mi

from mitsuba_plugins import sampler
from mitsuba_plugins.arithmetic import quotient


class AttenuatedPoint(mi.Emitter):
    r"""Attenuated point light (``attenuated_point``).

    .. pluginparameters::

     * - position
       - |vector|
       - World space position (no default)

     * - color
       - |color|
       - Linear RGB: what a white Lambertian surface that faces the light shows where the attenuation is 1 (no default)

     * - attenuation
       - |vector|
       - Coefficients :math:`(a, b, c)` of :math:`1/(a + b\,d + c\,d^2)` at distance :math:`d` (Default: 1, 0, 0)

     * - radius
       - |float|
       - Of a disc about the position that faces whatever is lit, each of whose points is such a light (Default: 0)

    Its irradiance at distance :math:`d` is :math:`\pi` times the colour over the attenuation, so that together with the
    :math:`1/\pi` of a physical BSDF the course's sums come out; Mitsuba's ``point`` is the case (0, 0, 1) with an
    intensity of :math:`\pi` times the colour. Not for integrators that start paths at lights.
    """

    def __init__(self, props):
        mi.Emitter.__init__(self, props)
        self.position = mi.Point3d(props["position"])
        self.color = mi.Color3d(props["color"])
        self.attenuation = mi.Vector3d(props.get("attenuation", [1.0, 0.0, 0.0]))
        self.radius = props.get("radius", 0.0)
        dr.make_opaque(self.position, self.color, self.attenuation)
        self.m_flags = mi.EmitterFlags.DeltaPosition
        self.m_needs_sample_2 = False
        self.m_needs_sample_3 = False

    def sample_direction(self, it, sample, active=True):
        ds = dr.zeros(mi.DirectionSample3f)
        ds.p = mi.Point3f(self.position)
        if self.radius > 0:
            center = mi.Vector3f(ds.p - it.p)
            tangent, bitangent = sampler.frame(quotient(center, dr.norm(center)))
            # A coordinate of exactly 1/2 has no place in the disc.
            x, y = sampler.disc_point(*dr.select(sample == 0.5, 0.5 + dr.epsilon(mi.Float), sample))
            ds.p += self.radius * (x * tangent + y * bitangent)
        ds.time = it.time
        ds.pdf = 1.0
        ds.delta = True
        ds.emitter = mi.EmitterPtr(self)
        ds.d = ds.p - it.p
        ds.dist = dr.norm(ds.d)
        ds.d = quotient(ds.d, ds.dist)
        ds.n = mi.Normal3f(-ds.d)
        a, b, c = mi.Vector3f(self.attenuation)
        # Without the cosine, which the BSDF applies.
        irradiance = quotient(dr.pi * mi.Color3f(self.color), a + ds.dist * (b + ds.dist * c))
        return ds, irradiance & active

    def eval_direction(self, it, ds, active=True):
        return self.sample_direction(it, mi.Point2f(0), active)[1]

    def pdf_direction(self, it, ds, active=True):
        return mi.Float(0)

    def eval(self, si, active=True):
        return mi.Color3f(0)

    def sample_ray(self, time, sample1, sample2, sample3, active=True):
        raise RuntimeError("attenuated_point: its attenuation is no power that it emits, so no path can start at it")

    def bbox(self):
        # A point inside the scene's own box: an emitter without extent must not enlarge it.
        return mi.ScalarBoundingBox3f()

    def traverse(self, callback):
        callback.put("position", self.position, mi.ParamFlags.Differentiable | mi.ParamFlags.Discontinuous)
        callback.put("color", self.color, mi.ParamFlags.Differentiable)
        callback.put("attenuation", self.attenuation, mi.ParamFlags.Differentiable)

    def to_string(self):
        numbers = f"position={self.position}, color={self.color}, attenuation={self.attenuation}, radius={self.radius}"
        return f"AttenuatedPoint[{numbers}]"


mi.register_emitter("attenuated_point", AttenuatedPoint)
