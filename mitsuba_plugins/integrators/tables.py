"""A scene's finishes, pigments and lights as tables that a kernel gathers from.

The integrator reads numbers and calls no plugin through Mitsuba's interface, whose positions are in single precision:
on a checker's boundary or at a texel's edge they would choose the wrong colour over whole faces. Rows of four numbers
are fetched by one packet gather.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np

from mitsuba_plugins.integrators.columns import column
from mitsuba_plugins.integrators.rays import Real


@dataclass
class Finish:
    """A finish's coefficients: Float where they weigh light, of the rays' precision where they decide about those."""

    ka: Any
    kd: Any
    ks: Any
    alpha: Any
    kr: Any
    kt: Any
    eta: Any


@dataclass
class Illumination:
    """What a light adds at a hit: n . l, the attenuation, the object in its way or NOTHING, the two terms (Color3f)."""

    cosine: Any
    attenuation: Any
    blocker: Any
    diffuse: Any
    specular: Any


class Materials:
    """The finishes and pigments of the surfaces' BSDFs, by object."""

    def __init__(self, types: Real, bsdfs: list[Any]) -> None:
        self._types = types
        finishes = {id(bsdf): bsdf for bsdf in bsdfs}
        textures = {id(bsdf.pigment): bsdf.pigment for bsdf in finishes.values()}
        self.blinn = any(bsdf.blinn for bsdf in finishes.values())
        finish_row = {key: row for row, key in enumerate(finishes)}
        texture_row = {key: row for row, key in enumerate(textures)}
        self._finish = column(mi.UInt32, [finish_row[id(bsdf)] for bsdf in bsdfs])
        self._texture = column(mi.UInt32, [texture_row[id(bsdf.pigment)] for bsdf in bsdfs])
        self._colors = [_color_function(texture) for texture in textures.values()]
        self.has_edges = any(hasattr(texture, "color_at") for texture in textures.values())
        """Whether a pigment's colour changes from one point to the next, so that it matters how far points are off."""
        zero, rows = mi.Float64(0), finishes.values()
        self._weights = mi.Float(dr.concat([n for f in rows for n in (f.ka, f.kd, f.ks, zero)] or [zero] * 4))
        self._exact = types.Float(dr.concat([n for f in rows for n in (f.kr, f.kt, f.eta, f.alpha)] or [zero] * 4))
        dr.make_opaque(self._weights, self._exact)

    def finish(self, index: Any, active: Any) -> Finish:
        """The finish of an object."""
        row = dr.gather(mi.UInt32, self._finish, index, active)
        ka, kd, ks, _ = dr.gather(mi.Vector4f, self._weights, row, active)
        kr, kt, eta, alpha = dr.gather(self._types.Vector4, self._exact, row, active)
        return Finish(ka, kd, ks, alpha, kr, kt, eta)

    def color(self, index: Any, p: Any, errors: Any, active: Any) -> Any:
        """An object's pigment (Color3f) at a position (Point3), whose coordinates may be off by `errors` (Vector3)."""
        if not self._colors:
            return mi.Color3f(0)
        if len(self._colors) == 1:
            return self._colors[0](p, errors)
        return dr.switch(dr.gather(mi.UInt32, self._texture, index, active), self._colors, p, errors)


def _color_function(texture: Any) -> Any:
    if hasattr(texture, "color_at"):
        return texture.color_at

    def color_at(p: Any, _: Any) -> Any:
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.p = mi.Point3f(p)
        return texture.eval(si)

    return color_at


class Lights:
    """Positions, colours and attenuations of the scene's emitters."""

    def __init__(self, types: Real, emitters: list[Any]) -> None:
        self._types = types
        for emitter in emitters:
            if not hasattr(emitter, "attenuation"):
                raise ValueError(f"whitted: every light is an 'attenuated_point', found {type(emitter).__name__}")
        self.count = len(emitters)
        self.positions = np.zeros((0, 3))
        """(n, 3), in double precision."""
        if emitters:
            zero = mi.Float64(0)
            places = [n for e in emitters for n in (*e.position, zero, *e.attenuation, zero)]
            exact = dr.concat(places)
            self._places = types.Float(exact)
            self._colors = dr.concat([n for e in emitters for n in (*e.color, mi.Float(0))])
            dr.make_opaque(self._places, self._colors)
            self.positions = np.array(dr.detach(exact)).reshape(-1, 8)[:, :3]

    def get(self, light: Any, active: Any) -> tuple[Any, Any, Any]:
        """Position (Point3), colour (Color3f) and attenuation (Vector3) of a light, by its index."""
        position = dr.gather(self._types.Vector4, self._places, 2 * light, active)
        attenuation = dr.gather(self._types.Vector4, self._places, 2 * light + 1, active)
        color = dr.gather(mi.Vector4f, self._colors, light, active)
        return self._types.Point3(position.xyz), mi.Color3f(color.xyz), self._types.Vector3(attenuation.xyz)
