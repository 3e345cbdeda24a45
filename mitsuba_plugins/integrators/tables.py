"""A scene's exact surfaces, finishes, pigments and lights as tables that a kernel gathers from.

The integrator reads numbers and calls no plugin through Mitsuba's interface, whose positions are in single precision:
on a checker's boundary or at a texel's edge they would choose the wrong colour over whole faces. Rows of four numbers
are fetched by one packet gather.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.integrators.geometry import Surface
from mitsuba_plugins.integrators.rays import Ray, sphere_distance


def _rows(kind: Any, rows: list[Any]) -> Any:
    """A flat, evaluated array of rows of four."""
    table = kind([number for row in rows for number in row] or [0] * 4)
    dr.make_opaque(table)
    return table


class Records:
    """One record a sphere, one a polyhedron's plane: (center, radius), or (unit normal, offset)."""

    def __init__(self, surfaces: list[Surface]) -> None:
        rows: list[Any] = []
        self.first = []
        for surface in surfaces:
            self.first.append(len(rows))
            rows.extend([surface.sphere] if surface.sphere is not None else surface.planes.values())
        self._rows = _rows(mi.Float64, rows)
        self._is_sphere = mi.Bool([surface.sphere is not None for surface in surfaces])
        dr.make_opaque(self._is_sphere)

    def intersect(self, index: Any, record: Any, ray: Ray, active: Any) -> Any:
        """Distance to one sphere or one plane of object `index`; infinite or NaN where the rules of `rays` bar it."""
        sphere, v, w = self._get(index, record, active)
        own = ray.object == index
        t_plane = -(dr.dot(v, ray.o) + w) / dr.dot(v, ray.d)
        t_own = dr.select(ray.inside & (ray.record != record), dr.maximum(t_plane, 0), dr.inf)
        t_plane = dr.select(own, t_own, dr.select(t_plane > ray.t_min, t_plane, dr.inf))
        return dr.select(sphere, sphere_distance(mi.Point3d(v), w, ray, own), t_plane)

    def surface_point(self, index: Any, record: Any, p: Any, active: Any) -> tuple[Any, Any]:
        """The point of a surface nearest to `p`, along its normal, and the outward unit normal there."""
        sphere, v, w = self._get(index, record, active)
        arm = p - mi.Point3d(v)
        n = dr.select(sphere, arm / dr.norm(arm), v)
        on_sphere = mi.Point3d(v) + n * w
        on_plane = p - n * (dr.dot(n, p) + w)
        return dr.select(sphere, on_sphere, on_plane), n

    def _get(self, index: Any, record: Any, active: Any) -> tuple[Any, Any, Any]:
        row = dr.gather(mi.Vector4d, self._rows, record, active)
        return dr.gather(mi.Bool, self._is_sphere, index, active), mi.Vector3d(row.xyz), row.w


@dataclass
class Finish:
    """A finish's coefficients: Float where they weigh light, Float64 where they decide about rays and highlights."""

    ka: Any
    kd: Any
    ks: Any
    alpha: Any
    kr: Any
    kt: Any
    eta: Any


@dataclass
class Illumination:
    """What a light adds at a hit: n . l, the attenuation (Float64), the object in its way or NOTHING, the two terms."""

    cosine: Any
    attenuation: Any
    blocker: Any
    diffuse: Any
    specular: Any


class Materials:
    """The finishes and pigments of the surfaces' BSDFs, by object."""

    def __init__(self, bsdfs: list[Any]) -> None:
        finishes = {id(bsdf): bsdf for bsdf in bsdfs}
        for bsdf in finishes.values():
            if not hasattr(bsdf, "COEFFICIENTS"):
                raise ValueError(f"whitted: every surface needs a 'phong' BSDF, found {type(bsdf).__name__}")
        textures = {id(bsdf.pigment): bsdf.pigment for bsdf in finishes.values()}
        self.blinn = any(bsdf.blinn for bsdf in finishes.values())
        finish_row = {key: row for row, key in enumerate(finishes)}
        texture_row = {key: row for row, key in enumerate(textures)}
        self._finish = mi.UInt32([finish_row[id(bsdf)] for bsdf in bsdfs] or [0])
        self._texture = mi.UInt32([texture_row[id(bsdf.pigment)] for bsdf in bsdfs] or [0])
        self._colors = [_color_function(texture) for texture in textures.values()]
        zero, rows = mi.Float64(0), finishes.values()
        self._weights = mi.Float(dr.concat([n for f in rows for n in (f.ka, f.kd, f.ks, zero)] or [zero] * 4))
        self._exact = dr.concat([n for f in rows for n in (f.kr, f.kt, f.eta, f.alpha)] or [zero] * 4)
        dr.make_opaque(self._finish, self._texture, self._weights, self._exact)

    def finish(self, index: Any, active: Any) -> Finish:
        """The finish of an object."""
        row = dr.gather(mi.UInt32, self._finish, index, active)
        ka, kd, ks, _ = dr.gather(mi.Vector4f, self._weights, row, active)
        kr, kt, eta, alpha = dr.gather(mi.Vector4d, self._exact, row, active)
        return Finish(ka, kd, ks, alpha, kr, kt, eta)

    def color(self, index: Any, p: Any, active: Any) -> Any:
        """An object's pigment (Color3f) at a position (Point3d)."""
        if not self._colors:
            return mi.Color3f(0)
        if len(self._colors) == 1:
            return self._colors[0](p)
        return dr.switch(dr.gather(mi.UInt32, self._texture, index, active), self._colors, p)


def _color_function(texture: Any) -> Any:
    if hasattr(texture, "color_at"):
        return texture.color_at

    def color_at(p: Any) -> Any:
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.p = mi.Point3f(p)
        return texture.eval(si)

    return color_at


class Lights:
    """Positions, colours and attenuations of the scene's emitters."""

    def __init__(self, emitters: list[Any]) -> None:
        for emitter in emitters:
            if not hasattr(emitter, "attenuation"):
                raise ValueError(f"whitted: every light is an 'attenuated_point', found {type(emitter).__name__}")
        self.count = len(emitters)
        if emitters:
            zero = mi.Float64(0)
            self._places = dr.concat([n for e in emitters for n in (*e.position, zero, *e.attenuation, zero)])
            self._colors = dr.concat([n for e in emitters for n in (*e.color, mi.Float(0))])
            dr.make_opaque(self._places, self._colors)

    def get(self, light: Any, active: Any) -> tuple[Any, Any, Any]:
        """Position (Point3d), colour (Color3f) and attenuation (Vector3d) of a light, by its index."""
        position = dr.gather(mi.Vector4d, self._places, 2 * light, active)
        attenuation = dr.gather(mi.Vector4d, self._places, 2 * light + 1, active)
        color = dr.gather(mi.Vector4f, self._colors, light, active)
        return mi.Point3d(position.xyz), mi.Color3f(color.xyz), mi.Vector3d(attenuation.xyz)
