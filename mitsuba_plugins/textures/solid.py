"""One colour throughout: the course's `solid` pigment."""

import drjit as dr
import mitsuba as mi


class Solid(mi.Texture):
    r"""Solid colour texture (``solid``).

    .. pluginparameters::

     * - color
       - |color|
       - Linear RGB (no default)

    The colour is used as it is, also outside 0..1, and kept in double precision, which Mitsuba's ``srgb`` does not.
    """

    def __init__(self, props):
        mi.Texture.__init__(self, props)
        self.color = mi.Color3d(props["color"])
        dr.make_opaque(self.color)

    def color_at(self, p, errors=0):
        """The colour (Color3d), wherever it is asked for."""
        return self.color

    def eval(self, si, active=True):
        return mi.Color3f(self.color) & active

    def eval_3(self, si, active=True):
        return self.eval(si, active)

    def mean(self):
        return mi.Float(dr.mean(self.color))

    def is_spatially_varying(self):
        return False

    def traverse(self, callback):
        callback.put("color", self.color, mi.ParamFlags.Differentiable)

    def to_string(self):
        return f"Solid[color={self.color}]"


mi.register_texture("solid", Solid)
