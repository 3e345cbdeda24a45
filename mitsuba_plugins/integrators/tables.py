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

from mitsuba_plugins.intersection.columns import column
from mitsuba_plugins.intersection.geometry import Surface
from mitsuba_plugins.intersection.rays import Real


@dataclass
class Finish:
    """A finish's coefficients (Float of the rays' precision)."""

    ka: Any
    kd: Any
    ks: Any
    alpha: Any
    kr: Any
    kt: Any
    eta: Any
    versine: Any  # 1 - cos of half the angle of the cone in which rays are spread


class Bsdfs:
    """The BSDFs that are nested in an integrator, by their names, in an object of a class that Dr.Jit does not know.

    In what it knows it looks for variables of loops, and takes the texels of a texture that two BSDFs share for some.

    Raises:
        ValueError: one that the surfaces name is missing, or is no `phong`.

    """

    def __init__(self, props: Any, surfaces: list[Surface]) -> None:
        self.by_name = {name: plugin for name, plugin in props.objects() if isinstance(plugin, mi.BSDF)}
        for name in {surface.material for surface in surfaces}:
            if name not in self.by_name:
                raise ValueError(f"whitted: 'geometry' names a material '{name}', and no BSDF of that name is nested")
            if not hasattr(bsdf := self.by_name[name], "COEFFICIENTS"):
                raise ValueError(f"whitted: every material is a 'phong' BSDF, '{name}' is a {type(bsdf).__name__}")

    def transmitting(self, surfaces: list[Surface]) -> list[int]:
        """The objects that rays are refracted into."""
        glass = {name for name, bsdf in self.by_name.items() if bsdf.kt[0] > 0}
        return [k for k, surface in enumerate(surfaces) if surface.material in glass]


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
        self._cells = [_cell_function(texture) for texture in textures.values()]
        self._differences = [_difference_function(texture) for texture in textures.values()]
        self.has_edges = any(hasattr(t, "color_at") and t.is_spatially_varying() for t in textures.values())
        """Whether a pigment's colour changes from one point to the next, so that it matters how far points are off."""
        self.spread = any(bsdf.cone[0] > 0 for bsdf in finishes.values())
        """Whether rays are spread in a cone."""
        numbers = [n for f in finishes.values() for n in (f.ka, f.kd, f.ks, f.alpha, f.kr, f.kt, f.eta, f.versine)]
        self._numbers = types.Float(dr.concat(numbers or [mi.Float64(0)] * 8))
        dr.make_opaque(self._numbers)

    def finish(self, index: Any, active: Any) -> Finish:
        """The finish of an object."""
        row = dr.gather(mi.UInt32, self._finish, index, active)
        ka, kd, ks, alpha = dr.gather(self._types.Vector4, self._numbers, 2 * row, active)
        kr, kt, eta, versine = dr.gather(self._types.Vector4, self._numbers, 2 * row + 1, active)
        return Finish(ka, kd, ks, alpha, kr, kt, eta, versine)

    def color(self, index: Any, p: Any, errors: Any, active: Any) -> Any:
        """An object's pigment (Color3) at a position (Point3), whose coordinates may be off by `errors` (Vector3)."""
        if not self._colors:
            return self._types.Color3(0)
        if len(self._colors) == 1:
            return self._types.Color3(self._colors[0](p, errors))
        texture = dr.gather(mi.UInt32, self._texture, index, active)
        return self._types.Color3(dr.switch(texture, self._colors, p, errors))

    def unlike(self, index: Any, p: Any, errors: Any, active: Any) -> Any:
        """By how much a channel of an object's pigment may differ (Float) from that at a position (Point3) whose
        coordinates are off by less than `errors` (Vector3).
        """
        if not self.has_edges:
            return self._types.Float(0)
        if len(self._differences) == 1:
            return self._types.Float(self._differences[0](p, errors))
        texture = dr.gather(mi.UInt32, self._texture, index, active)
        return self._types.Float(dr.switch(texture, self._differences, p, errors))

    def cell(self, index: Any, p: Any, errors: Any, active: Any) -> Any:
        """A word (UInt32) for the piece of an object's pigment at a position, such as a checker's cube."""
        if not self._cells:
            return mi.UInt32(0)
        if len(self._cells) == 1:
            return self._cells[0](p, errors)
        texture = dr.gather(mi.UInt32, self._texture, index, active)
        return dr.switch(texture, self._cells, p, errors)


def _cell_function(texture: Any) -> Any:
    return getattr(texture, "cell_at", lambda p, _: dr.zeros(mi.UInt32, dr.width(p)))


def _difference_function(texture: Any) -> Any:
    return getattr(texture, "unlike_at", lambda p, _: dr.zeros(mi.Float64, dr.width(p)))


def _color_function(texture: Any) -> Any:
    if hasattr(texture, "color_at"):
        return texture.color_at

    def color_at(p: Any, _: Any) -> Any:
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.p = mi.Point3f(p)
        return mi.Color3d(texture.eval(si))

    return color_at


class Lights:
    """Positions, colours, attenuations and radii of the scene's emitters."""

    def __init__(self, types: Real, emitters: list[Any]) -> None:
        self._types = types
        for emitter in emitters:
            if not hasattr(emitter, "attenuation"):
                raise ValueError(f"whitted: every light is an 'attenuated_point', found {type(emitter).__name__}")
        self.count = len(emitters)
        self.positions = np.zeros((0, 3))
        """(n, 3), in double precision."""
        self.radii = np.zeros(0)
        """(n,), 0 of a point."""
        if emitters:
            zero = mi.Float64(0)
            places = [n for e in emitters for n in (*e.position, mi.Float64(e.radius), *e.attenuation, zero)]
            exact = dr.concat(places)
            self._places = types.Float(exact)
            self._colors = types.Float(dr.concat([n for e in emitters for n in (*e.color, zero)]))
            dr.make_opaque(self._places, self._colors)
            rows = np.array(dr.detach(exact)).reshape(-1, 8)
            self.positions, self.radii = rows[:, :3], rows[:, 3]

    def get(self, light: Any, active: Any) -> tuple[Any, Any, Any, Any]:
        """Position (Point3), radius, colour (Color3) and attenuation (Vector3) of a light, by its index."""
        position = dr.gather(self._types.Vector4, self._places, 2 * light, active)
        attenuation = dr.gather(self._types.Vector4, self._places, 2 * light + 1, active)
        color = dr.gather(self._types.Vector4, self._colors, light, active)
        return (
            self._types.Point3(position.xyz),
            position.w,
            self._types.Color3(color.xyz),
            self._types.Vector3(attenuation.xyz),
        )
