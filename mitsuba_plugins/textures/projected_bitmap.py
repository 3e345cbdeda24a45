"""An image projected through space: the course's `texmap` pigment."""

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.rounding import epsilon


class ProjectedBitmap(mi.Texture):
    r"""Projected bitmap texture (``projected_bitmap``).

    .. pluginparameters::

     * - filename
       - |string|
       - Path of the image, in any format that Mitsuba reads; integer formats are scaled to 0..1 and not gamma corrected

     * - data
       - |tensor|
       - The image as a (height, width, 3) tensor of linear RGB instead of a file

     * - to_s, to_r
       - |string|
       - Four numbers each, :math:`P_0` and :math:`P_1`: the image position of a point is :math:`s = P_0 \cdot (x, y,
         z, 1)` along the columns and :math:`r = P_1 \cdot (x, y, z, 1)` along the rows, 1 spanning the whole image

    The texel at column :math:`\mathrm{trunc}(s\,w) \bmod w` and row :math:`\mathrm{trunc}(r\,h) \bmod h` is the colour:
    the image repeats, row 0 is on top, and nothing is filtered. Truncation makes the first texel two wide around 0.
    """

    def __init__(self, props):
        mi.Texture.__init__(self, props)
        image = props["data"] if "data" in props else _read(props["filename"])
        # Opaque, so that images of all sizes share one kernel.
        self.height, self.width = mi.Float64(image.shape[0]), mi.Float64(image.shape[1])
        self.texels = mi.Float(image.array)
        self.to_s = _row(props["to_s"])
        self.to_r = _row(props["to_r"])
        dr.make_opaque(self.texels, self.to_s, self.to_r, self.height, self.width)

    def color_at(self, p, errors=0):
        """Colour (Color3d) at a position of either precision, Point3d for exact texel boundaries.

        A position that is a whole number of texels, but for the errors of the coordinates, is that number.
        """
        p, errors = mi.Vector3d(p), mi.Vector3d(errors)
        column = self._texel(self.to_s, p, errors, self.width)
        row = self._texel(self.to_r, p, errors, self.height)
        return mi.Color3d(dr.gather(mi.Color3f, self.texels, row * mi.UInt32(self.width) + column))

    def unlike_at(self, p, errors):
        """By how much a channel may differ (Float64) from the colour at a position whose coordinates are off by less
        than `errors` (Vector3); infinite where these are as large as texels.
        """
        p, errors = mi.Vector3d(p), mi.Vector3d(errors)
        (left, right), (top, bottom) = (
            self._ends(projection, p, errors, count)
            for projection, count in ((self.to_s, self.width), (self.to_r, self.height))
        )
        crosses = (left != right) | (top != bottom)
        least, most = mi.Color3f(dr.inf), mi.Color3f(-dr.inf)
        for row in (top, bottom):
            for column in (left, right):
                index = self._wrap(row, self.height) * mi.UInt32(self.width) + self._wrap(column, self.width)
                color = dr.gather(mi.Color3f, self.texels, index, crosses)
                least, most = dr.minimum(least, color), dr.maximum(most, color)
        near = (right - left <= 1) & (bottom - top <= 1)
        return dr.select(crosses, dr.select(near, mi.Float64(dr.max(most - least)), dr.inf), 0)

    @classmethod
    def _ends(cls, projection, p, errors, count):
        """The first and the last texel, of those along one side, that a position may lie in."""
        a, b, c, d = projection
        position = (a * p.x + b * p.y + c * p.z + d) * count
        error = (dr.abs(a) * errors.x + dr.abs(b) * errors.y + dr.abs(c) * errors.z) * count
        # What is as near as double precision can tell, too.
        error += 16 * epsilon(error) * (dr.abs(position) + dr.abs(d) * count)
        return dr.trunc(position - error), dr.trunc(position + error)

    @classmethod
    def _texel(cls, projection, p, errors, count):
        a, b, c, d = projection
        position = (a * p.x + b * p.y + c * p.z + d) * count
        rounding = 4 * epsilon(position)
        errors = errors + dr.abs(p) * rounding
        error = dr.abs(a) * errors.x + dr.abs(b) * errors.y + dr.abs(c) * errors.z + dr.abs(d) * rounding
        return cls._wrap(dr.trunc(position + dr.copysign(error, position) * count), count)

    @staticmethod
    def _wrap(position, count):
        """The texel at a whole number, of `count` that repeat."""
        # The remainder is taken in floating point: far from the origin the position would overflow an integer.
        remainder = position - dr.floor(quotient(position, count)) * count
        # A NaN or a rounded remainder must not read outside the image.
        return mi.UInt32(dr.fmin(dr.fmax(remainder, 0), count - 1))

    def eval(self, si, active=True):
        return mi.Color3f(self.color_at(si.p)) & active

    def eval_3(self, si, active=True):
        return self.eval(si, active)

    def mean(self):
        return dr.mean(self.texels)

    def is_spatially_varying(self):
        return True

    def traverse(self, callback):
        callback.put("texels", self.texels, mi.ParamFlags.Differentiable)

    def to_string(self):
        return f"ProjectedBitmap[{self.width[0]:.0f} x {self.height[0]:.0f}, to_s={self.to_s}, to_r={self.to_r}]"


def _read(filename):
    path = mi.file_resolver().resolve(filename)
    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, srgb_gamma=False)
    return mi.TensorXf(bitmap)


def _row(text):
    # A string, since Mitsuba's scene files have no vector of four numbers.
    numbers = [float(word) for word in text.replace(",", " ").split()]
    if len(numbers) != 4:
        raise ValueError(f"projected_bitmap: to_s and to_r take 4 numbers each, got '{text}'")
    return [mi.Float64(number) for number in numbers]


mi.register_texture("projected_bitmap", ProjectedBitmap)
