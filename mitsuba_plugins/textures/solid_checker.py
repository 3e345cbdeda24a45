"""A checkerboard of cubes in space: the course's `checker` pigment."""

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.rounding import epsilon
from mitsuba_plugins.sampler import combine


class SolidChecker(mi.Texture):
    r"""Solid checkerboard texture (``solid_checker``).

    .. pluginparameters::

     * - first
       - |color|
       - Linear RGB where :math:`\lfloor x/s \rfloor + \lfloor y/s \rfloor + \lfloor z/s \rfloor` is even (no default)

     * - second
       - |color|
       - Linear RGB elsewhere (no default)

     * - size
       - |float|
       - Edge length :math:`s` of the cubes, in scene units (no default)

    It is evaluated at the position in world space and needs no UV coordinates. Colours are used as they are, also
    outside 0..1. Not for filtering: it answers with the colour at a point.
    """

    def __init__(self, props):
        mi.Texture.__init__(self, props)
        self.first = mi.Color3d(props["first"])
        self.second = mi.Color3d(props["second"])
        self.size = mi.Float64(props["size"])
        dr.make_opaque(self.first, self.second, self.size)

    def color_at(self, p, errors=0):
        """Colour (Color3d) at a position of either precision: Point3d for exact boundaries between cubes.

        A coordinate that is a whole number of edges, but for its error, is that number.
        """
        cell = self._cube(p, errors)
        # The parity of a sum is found without the sum: far from the origin it would overflow an integer.
        half = (cell.x + cell.y + cell.z) * 0.5
        return dr.select(half == dr.floor(half), self.first, self.second)

    def unlike_at(self, p, errors):
        """By how much a channel may differ (Float64) from the colour at a position whose coordinates are off by less
        than `errors` (Vector3).
        """
        crosses = dr.any(self._cube(p, errors) != self._cube(p, -errors))
        return dr.select(crosses, dr.max(dr.abs(self.first - self.second)), 0)

    def cell_at(self, p, errors=0):
        """A word (UInt32) for the cube at a position: others near it have others."""
        cell = self._cube(p, errors)
        rest = cell - dr.floor(cell * 2.0**-22) * 2.0**22
        x, y, z = (mi.UInt32(dr.fmax(number, 0)) for number in rest)  # 0 where it is no number
        return combine(combine(x, y), z)

    def _cube(self, p, errors):
        p = mi.Vector3d(p)
        p = p + mi.Vector3d(errors) + dr.abs(p) * (2 * epsilon(p))
        return dr.floor(quotient(p, self.size))

    def eval(self, si, active=True):
        return mi.Color3f(self.color_at(si.p)) & active

    def eval_3(self, si, active=True):
        return self.eval(si, active)

    def mean(self):
        return mi.Float(dr.mean(self.first + self.second) * 0.5)

    def is_spatially_varying(self):
        return True

    def traverse(self, callback):
        callback.put("first", self.first, mi.ParamFlags.Differentiable)
        callback.put("second", self.second, mi.ParamFlags.Differentiable)
        callback.put("size", self.size, mi.ParamFlags.Differentiable | mi.ParamFlags.Discontinuous)

    def to_string(self):
        return f"SolidChecker[first={self.first}, second={self.second}, size={self.size}]"


mi.register_texture("solid_checker", SolidChecker)
