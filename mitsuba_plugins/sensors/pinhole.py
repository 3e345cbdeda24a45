"""A pinhole camera, or one with a thin lens, in double precision: the course's camera."""

import drjit as dr
import mitsuba as mi

from mitsuba_plugins.arithmetic import quotient
from mitsuba_plugins.intersection.rays import unit


class Pinhole(mi.Sensor):
    r"""Pinhole camera in double precision (``pinhole``).

    .. pluginparameters::

     * - eye, look_at
       - |vector|
       - Centre of projection, and a point that appears in the middle of the picture (no default)

     * - up
       - |vector|
       - A direction that points upward in the picture, not parallel to the view (no default)

     * - fovy
       - |float|
       - Full vertical angle of view in degrees, 0 < fovy < 180 (no default)

     * - aperture, focal
       - |float|
       - Radius of a thin lens about the eye, and the distance along the view direction of what is in focus
         (Default: 0, a pinhole; 1)

     * - pixel_offset
       - |float|
       - Added to both film coordinates, in pixels: -0.5 sends the ray of a pixel's centre through its top left corner
         (Default: 0)

    The picture is right-handed (its right is view x up) and its pixels are square. Every ray starts at the eye
    itself, or on the lens. The difference to Mitsuba's ``perspective`` and ``thinlens``, whose pictures are the same,
    is in the digits: these round their matrices to single precision, which mirrors magnify from bounce to bounce. Not
    for light tracing.
    """

    def __init__(self, props):
        mi.Sensor.__init__(self, props)
        self.eye = mi.Point3d(props["eye"])
        self.look_at = mi.Point3d(props["look_at"])
        self.up = mi.Vector3d(props["up"])
        self.fovy = mi.Float64(props["fovy"])
        self.pixel_offset = mi.Float64(props.get("pixel_offset", 0.0))
        self.aperture = mi.Float64(props.get("aperture", 0.0))
        self.focal = mi.Float64(props.get("focal", 1.0))
        dr.make_opaque(self.eye, self.look_at, self.up, self.fovy, self.pixel_offset, self.aperture, self.focal)

    @property
    def has_lens(self):
        """Whether rays start at different points."""
        return self.aperture[0] > 0

    @property
    def relative_focal(self):
        """The distance of what is in focus, over that or the lens's radius, whichever is larger (Float64)."""
        return quotient(self.focal, dr.maximum(self.aperture, self.focal))

    def primary_ray(self, position, lens=None):
        """Ray through a film position.

        Args:
            position: Point2d in pixels from the top left corner of the whole film.
            lens: a point of the unit disc (two Float64), from whose place on the lens the ray comes, if there is one.

        Returns:
            Its origin (Point3d) and unit direction (Vector3d).

        """
        # Opaque, so that pictures of all sizes share one kernel.
        width, height = (dr.opaque(mi.Float64, size) for size in self.film().size())
        forward = unit(_in_range(_direction(self.eye, self.look_at)))
        right = unit(_in_range(dr.cross(forward, _in_range(self.up))))
        upward = dr.cross(right, forward)
        half_height = dr.tan(dr.deg2rad(self.fovy) * 0.5)
        x = (quotient(2 * (position.x + self.pixel_offset), width) - 1) * half_height * quotient(width, height)
        y = (1 - quotient(2 * (position.y + self.pixel_offset), height)) * half_height
        direction = unit(forward + x * right + y * upward)
        if lens is None:
            return self.eye, direction
        across = lens[0] * right + lens[1] * upward
        # All rays of a position meet on the plane in focus.
        relative_aperture = quotient(self.aperture, dr.maximum(self.aperture, self.focal))
        cosine = dr.dot(direction, forward)
        direction = unit(self.relative_focal * direction - (cosine * relative_aperture) * across)
        return self.eye + self.aperture * across, direction

    def sample_ray(self, time, wavelength_sample, position_sample, aperture_sample, active=True):
        film = self.film()
        size, offset = film.crop_size(), film.crop_offset()
        position = mi.Point2d(position_sample.x * size.x + offset.x, position_sample.y * size.y + offset.y)
        lens = mi.warp.square_to_uniform_disk_concentric(aperture_sample) if self.has_lens else None
        origin, direction = self.primary_ray(position, None if lens is None else mi.Point2d(lens))
        ray = mi.Ray3f(mi.Point3f(origin), mi.Vector3f(direction), time, [])
        return ray, mi.Color3f(1)

    def sample_ray_differential(self, time, wavelength_sample, position_sample, aperture_sample, active=True):
        ray, weight = self.sample_ray(time, wavelength_sample, position_sample, aperture_sample, active)
        return mi.RayDifferential3f(ray), weight

    def bbox(self):
        eye = mi.ScalarPoint3f(*(component[0] for component in self.eye))
        return mi.ScalarBoundingBox3f(eye - self.aperture[0], eye + self.aperture[0])

    def traverse(self, callback):
        for name in ("eye", "look_at", "up", "fovy", "aperture", "focal"):
            callback.put(name, getattr(self, name), mi.ParamFlags.Differentiable | mi.ParamFlags.Discontinuous)

    def to_string(self):
        return f"Pinhole[eye={self.eye}, look_at={self.look_at}, up={self.up}, fovy={self.fovy}]"


def _direction(start, end):
    """Along the difference of two points: half of it where no number holds it."""
    whole = end - start
    return dr.select(dr.all(dr.isfinite(whole)), whole, end * 0.5 - start * 0.5)


def _in_range(v):
    """`v`, made shorter or longer where the square of its length would overflow or vanish."""
    largest = dr.max(dr.abs(v))
    return dr.select((largest > 1e-100) & (largest < 1e100), v, quotient(v, largest))


mi.register_sensor("pinhole", Pinhole)
