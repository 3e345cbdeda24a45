"""Cameras with long and wide lenses, that look along their up vector, or are close to a surface."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from converter.analysis.regions.region import Finding, Region, worst
from converter.analysis.regions.situation import Floats, Situation
from converter.scene.model import Csg, Polyhedron, Shape, Sphere
from converter.shapes.csg_program import written_leaves
from converter.shapes.table import shape_kind
from converter.to_mitsuba.meshes.quadrics import most_triangles

_NOISE = 2.0**-48
"""What a computed distance may be off, as a share of coordinates."""


def _pixel(s: Situation) -> float:
    """The angle between neighbouring rays, in radians."""
    rows = s.settings.height * math.isqrt(s.needs.samples)
    return 2 * math.tan(math.radians(s.scene.camera.fovy) / 2) / rows


def _corner_rays(s: Situation) -> Floats:
    """(5, 3) directions, not of unit length, to the middle of the picture and to its corners."""
    camera = s.scene.camera
    forward = _unit(np.subtract(camera.look_at, camera.eye))
    right = _unit(np.cross(forward, _unit(np.array(camera.up))))
    tangent = math.tan(math.radians(camera.fovy) / 2)
    across, up = tangent * s.settings.width / s.settings.height * right, tangent * np.cross(right, forward)
    return np.array([forward, *(forward + i * across + j * up for i in (-1, 1) for j in (-1, 1))])


def _unit(v: Floats) -> Floats:
    v = v / np.abs(v).max()
    return np.asarray(v / np.linalg.norm(v))


def _pixel_shares(s: Situation, polyhedra_only: bool = False) -> Floats:
    """For each object the size of a pixel on it, over the numbers that it and the rays to it are made of."""
    distance = np.full(len(s.scene.objects), np.inf)
    coordinate = np.zeros(len(s.scene.objects))
    bodies = s.bodies
    distance[bodies.object] = np.linalg.norm(bodies.center - s.eye, axis=1)
    coordinate[bodies.object] = np.abs(bodies.center).max(axis=1, initial=0.0)
    # What has no bounds is as far away as where the picture shows it. The eye's own planes are where it does not.
    rays = _corner_rays(s)
    t = -s.planes.signed_distances(s.eye) / (rays @ s.planes.normal.T) * np.linalg.norm(rays, axis=1)[:, None]
    seen = np.where((t > _NOISE * s.reach) & np.isfinite(t), t, 0.0).max(axis=0, initial=0.0)
    endless = ~np.array(s.needs.bounded, dtype=np.bool_)
    distance[endless] = 0.0
    own = endless[s.planes.object]
    np.maximum.at(distance, s.planes.object[own], seen[own])
    np.maximum.at(coordinate, s.planes.object[own], np.abs(s.planes.offset[own]))
    for i in np.flatnonzero(endless & (distance == 0)).tolist():  # a quadric, or a csg
        shape = s.scene.objects[i].shape
        distance[i] = shape_kind(shape).distances(shape, s.needs.facts[i], s.scene.camera.eye).nearest
    shares = _pixel(s) * distance / (np.maximum(coordinate, s.reach) + distance)
    balls = bodies.object[bodies.is_ball]
    shares[balls] = np.inf if polyhedra_only else shares[balls]
    return np.where((distance > 0) & np.isfinite(distance), shares, np.inf)


def _long_lens_at_edges(s: Situation, limit: float) -> Iterator[Finding]:
    if len(s.planes.offset) > 1:
        yield from _too_long(s, _pixel_shares(s, polyhedra_only=True), limit)


def _long_lens(s: Situation, limit: float) -> Iterator[Finding]:
    yield from _too_long(s, np.where(_curved(s), np.inf, _pixel_shares(s)), limit)


def _too_long(s: Situation, shares: Floats, limit: float) -> Iterator[Finding]:
    for i, more in worst(shares, limit):
        text = f"on object {i}, seen through a lens of {s.scene.camera.fovy:.3g} degrees, a pixel is {shares[i]:.2g}"
        text += f" of the coordinates (less than {limit:.2g}{more})"
        yield Finding(s.scene.objects[i].line, text)


def _fine_meshes(s: Situation, limit: float) -> Iterator[Finding]:
    """Curved bodies that are meshes, and larger than as many pixels as their triangles can be made for."""
    settings = s.settings
    most = most_triangles(settings.width * settings.height * settings.rays_a_pixel())
    bodies = s.bodies
    shares = np.full(len(s.scene.objects), np.inf)
    distance = np.maximum(np.linalg.norm(bodies.center - s.eye, axis=1) - bodies.radius, 0)
    shares[bodies.object] = most * _pixel(s) * np.maximum(distance, bodies.radius) / bodies.radius
    for i, more in worst(np.where(_curved(s), shares, np.inf), limit):
        text = f"object {i}, seen through a lens of {s.scene.camera.fovy:.3g} degrees, is larger than its mesh is fine"
        size = most / shares[i]
        yield Finding(s.scene.objects[i].line, f"{text}: {size:.2g} pixels (more than {most / limit:.2g}{more})")


def _long_lens_at_quadrics(s: Situation, limit: float) -> Iterator[Finding]:
    yield from _too_long(s, np.where(_curved(s), _pixel_shares(s), np.inf), limit)


def _curved(s: Situation) -> NDArray[np.bool_]:
    """For each object whether it has a curved surface, and is no ball."""

    def is_curved(shape: Shape) -> bool:
        leaves = written_leaves(shape) if isinstance(shape, Csg) else iter([shape])
        return not isinstance(shape, Sphere) and not all(isinstance(leaf, Polyhedron) for leaf in leaves)

    return np.array([is_curved(o.shape) for o in s.scene.objects], dtype=np.bool_)


def _long_lens_at_mirrors(s: Situation, limit: float) -> Iterator[Finding]:
    if s.needs.reflects or s.needs.refracts:
        yield from _too_long(s, _pixel_shares(s), limit)


def _long_lens_at_round_glass(s: Situation, limit: float) -> Iterator[Finding]:
    """Light that enters and leaves glass at a glance magnifies what is not known of a ray."""
    if s.needs.refracts:
        glass = np.array([s.finish(i).kt > 0 for i in range(len(s.scene.objects))], dtype=np.bool_)
        round_bodies = _curved(s) | np.isin(np.arange(len(glass)), s.bodies.object[s.bodies.is_ball])
        yield from _too_long(s, np.where(glass & round_bodies, _pixel_shares(s), np.inf), limit)


def _horizon(s: Situation, limit: float) -> Iterator[Finding]:
    """Of bodies without bounds, which are cut off somewhere to be meshes."""
    tangent = math.tan(math.radians(s.scene.camera.fovy) / 2)
    if tangent < limit and not all(s.needs.bounded):
        index = s.needs.bounded.index(False)
        text = f"object {index} has no bounds, and is seen through a lens of {s.scene.camera.fovy:.3g} degrees"
        yield Finding(s.scene.objects[index].line, f"{text} (less than {math.degrees(2 * math.atan(limit)):.2g})")


def _wide_lens(s: Situation, limit: float) -> Iterator[Finding]:
    if 180 - s.scene.camera.fovy < limit:
        yield Finding(0, f"the camera's fovy is {s.scene.camera.fovy:.9g} degrees (more than {180 - limit:.7g})")


def _large_lens(s: Situation, limit: float) -> Iterator[Finding]:
    """A lens from whose rim what is in focus is seen at a glance."""
    camera = s.scene.camera
    if camera.focal < limit * camera.aperture:
        text = f"the camera's aperture is {camera.aperture / camera.focal:.2g} of the distance in focus"
        yield Finding(0, f"{text} (more than {1 / limit:.2g})")


def _up_along_view(s: Situation, limit: float) -> Iterator[Finding]:
    camera = s.scene.camera
    view, up = _unit(np.subtract(camera.look_at, camera.eye)), _unit(np.array(camera.up))
    sine = float(np.linalg.norm(np.cross(view, up)))
    if sine < limit:
        yield Finding(0, f"the camera's up vector is {sine:.2g} from its view (less than {limit:.2g} radians)")


def _short_view(s: Situation, limit: float) -> Iterator[Finding]:
    """The difference of two large numbers says little of a direction."""
    camera = s.scene.camera
    share = math.dist(camera.eye, camera.look_at) / max(*map(abs, camera.eye), *map(abs, camera.look_at))
    if share < limit:
        yield Finding(0, f"the camera looks at a point {share:.2g} of its coordinates away (less than {limit:.2g})")


def _near_surface(s: Situation, limit: float) -> Iterator[Finding]:
    """Surfaces that the eye is near; those that it lies on are known to the exact methods."""
    shares = _nearness(s)
    shares[[i for i in np.flatnonzero(shares < limit) if _lies_on(s, int(i))]] = np.inf
    yield from _too_near(s, shares, limit)


def _at_surface(s: Situation, limit: float) -> Iterator[Finding]:
    """Surfaces that the eye is near, or lies on."""
    yield from _too_near(s, _nearness(s), limit)


def _nearness(s: Situation) -> Floats:
    """For each object how far the eye is from its surface, over the coordinates of both."""
    shares = np.full(len(s.scene.objects), np.inf)
    planes, balls = s.planes, np.flatnonzero(s.bodies.is_ball)
    distances = np.abs(planes.signed_distances(s.eye))
    np.minimum.at(shares, planes.object, distances / np.maximum(np.abs(planes.offset), s.reach))
    gaps = np.abs(np.linalg.norm(s.bodies.center[balls] - s.eye, axis=1) - s.bodies.radius[balls])
    own = np.abs(s.bodies.center[balls]).max(axis=1, initial=0.0) + s.bodies.radius[balls]
    shares[s.bodies.object[balls]] = gaps / np.maximum(own, s.reach)
    return shares


def _too_near(s: Situation, shares: Floats, limit: float) -> Iterator[Finding]:
    for i, more in worst(shares, limit):
        text = f"the camera is {shares[i]:.2g} of its coordinates from the surface of object {i}"
        yield Finding(s.scene.objects[i].line, f"{text} (less than {limit:.2g}{more})")


def _lies_on(s: Situation, index: int) -> bool:
    shape = s.scene.objects[index].shape
    return shape_kind(shape).lies_on(shape, s.scene.camera.eye)


REGIONS = (
    Region(("grazing", "threads", "fovy"), {"double": 3e-15, "float": 5e-8, "offset": 5e-8, "ulp": 5e-8}, _long_lens),
    Region(("threads", "mirror-corner"), {"mesh": 5e-8}, _long_lens_at_edges),
    Region(
        ("mirror-corner", "critical-angle", "grazing-glass"), {"double": 3e-14, "float": 2e-6}, _long_lens_at_mirrors
    ),
    Region(("grazing-glass",), {"double": 3e-11}, _long_lens_at_round_glass),
    Region(
        ("quadric-edge", "needles"),
        {"double": 3e-15, "float": 1e-6, "offset": 5e-8, "ulp": 5e-8},
        _long_lens_at_quadrics,
    ),
    Region(("quadric-edge",), dict.fromkeys(("mesh", "offset", "ulp"), 4.0), _fine_meshes),
    Region(("horizon",), {"mesh": 1e-3}, _horizon),
    Region(("fovy",), {"float": 3e-3, "mesh": 3e-3}, _wide_lens),
    Region(("tie-along",), {"double": 1e-10}, _short_view),
    Region(("view-up",), {"float": 3e-5}, _up_along_view),
    Region(
        ("aperture", "defocus"), {"double": 3e-6, "float": 3e-5, "mesh": 3e-6, "offset": 3e-4, "ulp": 3e-3}, _large_lens
    ),
    Region(("camera-height", "inside-glass"), {"double": 2e-15, "float": 3e-8, "mesh": 3e-8}, _near_surface),
    Region(("camera-height", "camera-on-floor", "camera-on-ball"), {"offset": 3e-8, "ulp": 3e-8}, _at_surface),
)
