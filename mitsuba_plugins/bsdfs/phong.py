"""Phong's model with a mirror and a refracted lobe: the course's finish on a pigment."""

import drjit as dr
import mitsuba as mi

from mitsuba_plugins import sampler as samples
from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.rays import power, unit


class Phong(mi.BSDF):
    r"""Phong BSDF with kr and kt (``phong``).

    .. pluginparameters::

     * - pigment
       - |texture|
       - Colour :math:`C` of the ambient and diffuse terms (no default)

     * - ka, kd, ks
       - |float|
       - Ambient, diffuse and specular coefficients (Default: 0); ``ka`` means something to the ``whitted`` integrator
         only

     * - alpha
       - |float|
       - Exponent of the highlight (Default: 1)

     * - kr, kt
       - |float|
       - Weights of the mirrored and of the refracted ray, neither tinted by the pigment (Default: 0)

     * - eta
       - |float|
       - Index of refraction outside over inside, :math:`n_1/n_2` (Default: 1)

     * - cone
       - |float|
       - Half-angle, in degrees, of the cone in which mirrored and refracted rays are spread, uniform in solid angle
         (Default: 0)

     * - blinn
       - |bool|
       - Highlight :math:`(n \cdot h)^\alpha` instead of :math:`(r \cdot v)^\alpha` (Default: false)

    The four lobes are components 0 to 3: diffuse :math:`k_d\,C\,\cos\theta/\pi`, glossy :math:`k_s\,h^\alpha/\pi`
    (white, and without a cosine, as in Phong's paper of 1975), mirror and refraction; both sides of a surface answer
    alike. Past the critical angle the refracted lobe follows the mirror direction. The model is the course's: nothing
    makes it conserve energy or be reciprocal.
    """

    COEFFICIENTS = ("ka", "kd", "ks", "alpha", "kr", "kt", "eta", "cone")

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.pigment = props.get_texture("pigment")
        for name in self.COEFFICIENTS:
            setattr(self, name, mi.Float64(props.get(name, 1.0 if name in ("alpha", "eta") else 0.0)))
        self.blinn = props.get("blinn", False)
        dr.make_opaque(*(getattr(self, name) for name in self.COEFFICIENTS))
        sides = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        varying = mi.BSDFFlags.SpatiallyVarying if self.pigment.is_spatially_varying() else mi.BSDFFlags.Empty
        self.m_components = [
            mi.BSDFFlags.DiffuseReflection | sides | varying,
            mi.BSDFFlags.GlossyReflection | sides,
            mi.BSDFFlags.DeltaReflection | sides,
            mi.BSDFFlags.DeltaTransmission | sides | mi.BSDFFlags.NonSymmetric,
        ]
        self.m_flags = self.m_components[0] | self.m_components[1] | self.m_components[2] | self.m_components[3]

    @property
    def versine(self):
        """1 - cos of the cone's half-angle (Float64)."""
        return 2 * dr.square(dr.sin(dr.deg2rad(self.cone) * 0.5))

    # ------------------------------------------------------------------ lobes

    def _weights(self, ctx):
        """Sampling weights of the lobes that the context asks for, in the components' order."""
        lobes = (self.kd, self.ks, self.kr, self.kt)
        return [
            mi.Float(lobe) if ctx.is_enabled(flag, i) else 0.0
            for i, (lobe, flag) in enumerate(zip(lobes, self._kinds(), strict=True))
        ]

    @staticmethod
    def _kinds():
        flags = mi.BSDFFlags
        return flags.DiffuseReflection, flags.GlossyReflection, flags.DeltaReflection, flags.DeltaTransmission

    def _highlight(self, wi, wo):
        """Cosine whose power is the highlight, for directions on the upper side."""
        if self.blinn:
            return dr.maximum(unit(wi + wo).z, 0)
        return dr.maximum(dr.dot(mi.reflect(wi), wo), 0)

    def _glossy_pdf(self, wi, wo):
        cosine = self._highlight(wi, wo)
        alpha = mi.Float(self.alpha)
        pdf = (alpha + 1) * dr.inv_two_pi * power(cosine, alpha)
        # A half vector's density becomes its direction's by d(omega_h) / d(omega_o) = 1 / (4 wo.h).
        return quotient(pdf, 4 * dr.maximum(dr.dot(wo, unit(wi + wo)), 1e-6)) if self.blinn else pdf

    def _sample_glossy(self, wi, sample):
        cosine = dr.power(1 - sample.y, quotient(1, mi.Float(self.alpha) + 1))
        sine = dr.safe_sqrt(1 - dr.square(cosine))
        s, c = dr.sincos(dr.two_pi * sample.x)
        around = mi.Vector3f(c * sine, s * sine, cosine)
        return mi.reflect(wi, mi.Normal3f(around)) if self.blinn else mi.Frame3f(mi.reflect(wi)).to_world(around)

    # ------------------------------------------------------------------ Mitsuba's interface

    def eval(self, ctx, si, wo, active=True):
        wi, wo = _upward(si.wi, wo)
        return self._eval(ctx, si, wi, wo, active)

    def pdf(self, ctx, si, wo, active=True):
        return self._pdf(ctx, *_upward(si.wi, wo))

    def eval_pdf(self, ctx, si, wo, active=True):
        wi, wo = _upward(si.wi, wo)
        return self._eval(ctx, si, wi, wo, active), self._pdf(ctx, wi, wo)

    def _eval(self, ctx, si, wi, wo, active):
        diffuse, glossy, _, _ = self._weights(ctx)
        value = self.pigment.eval(si, active) * (diffuse * wo.z) + glossy * power(
            self._highlight(wi, wo), mi.Float(self.alpha)
        )
        return (value * dr.inv_pi) & active & (wi.z > 0) & (wo.z > 0)

    def _pdf(self, ctx, wi, wo):
        weights = self._weights(ctx)
        total = sum(weights, mi.Float(0))
        pdf = weights[0] * wo.z * dr.inv_pi + weights[1] * self._glossy_pdf(wi, wo)
        return dr.select((wi.z > 0) & (wo.z > 0) & (total > 0), quotient(pdf, total), 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        side = dr.select(si.wi.z < 0, mi.Float(-1), mi.Float(1))
        wi = mi.Vector3f(si.wi.x, si.wi.y, si.wi.z * side)
        weights = self._weights(ctx)
        total = sum(weights, mi.Float(0))
        at = sample1 * total
        lobe = mi.UInt32(0)
        for i in range(3):
            passed = at >= sum(weights[: i + 1], mi.Float(0))
            lobe = dr.select(passed, i + 1, lobe)

        eta = dr.select(side > 0, mi.Float(self.eta), quotient(1, mi.Float(self.eta)))
        refracted, total_reflection = refract(wi, eta)
        wo = mi.warp.square_to_cosine_hemisphere(sample2)
        wo[lobe == 1] = self._sample_glossy(wi, sample2)
        wo[lobe == 2] = mi.reflect(wi)
        wo[lobe == 3] = refracted

        # A cone's directions are no density's to other integrators, which take the lobe for one direction.
        delta = lobe >= 2
        spread = samples.cone_direction(wo, mi.Float(self.versine), *sample2)
        spread.z = dr.mulsign(dr.abs(spread.z), wo.z)
        wo[delta & (self.cone > 0)] = spread
        pdf = dr.select(delta, quotient(dr.select(lobe == 2, weights[2], weights[3]), total), self._pdf(ctx, wi, wo))
        value = dr.select(delta, mi.Color3f(total), quotient(self._eval(ctx, si, wi, wo, active), pdf))
        valid = active & (total > 0) & (pdf > 0) & (delta | (wo.z > 0))

        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = mi.Vector3f(wo.x, wo.y, wo.z * side)
        bs.pdf = dr.select(valid, pdf, 0)
        bs.eta = dr.select((lobe == 3) & ~total_reflection, quotient(1, eta), 1)
        bs.sampled_component = lobe
        kinds = [mi.UInt32(int(kind)) for kind in self._kinds()]
        bs.sampled_type = dr.select(
            lobe == 0, kinds[0], dr.select(lobe == 1, kinds[1], dr.select(lobe == 2, kinds[2], kinds[3]))
        )
        return bs, value & valid

    def eval_diffuse_reflectance(self, si, active=True):
        return self.pigment.eval(si, active) * mi.Float(self.kd)

    def traverse(self, callback):
        for name in self.COEFFICIENTS:
            callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable)
        callback.put("pigment", self.pigment, mi.ParamFlags.Differentiable)

    def to_string(self):
        return (
            f"Phong[{', '.join(f'{name}={getattr(self, name)}' for name in self.COEFFICIENTS)}, pigment={self.pigment}]"
        )


def _upward(wi, wo):
    """Both directions with the side of `wi` on top."""
    flip = wi.z < 0
    return (
        mi.Vector3f(wi.x, wi.y, dr.select(flip, -wi.z, wi.z)),
        mi.Vector3f(wo.x, wo.y, dr.select(flip, -wo.z, wo.z)),
    )


def refract(wi, eta):
    """Snell's law in the local frame.

    Args:
        wi: unit direction toward the viewer, wi.z > 0.
        eta: index on wi's side over the index on the other.

    Returns:
        The refracted direction, or the mirrored one past the critical angle, and whether it is past.

    """
    cosine2 = 1 - eta * eta * (1 - wi.z * wi.z)
    past = cosine2 <= 0
    through = mi.Vector3f(-eta * wi.x, -eta * wi.y, -dr.safe_sqrt(cosine2))
    return dr.select(past, mi.reflect(wi), through), past


mi.register_bsdf("phong", Phong)
