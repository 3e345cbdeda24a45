"""Lights close to surfaces, and highlights that are sharp."""

from collections.abc import Iterator

import numpy as np

from converter.analysis.regions.region import Finding, Region
from converter.analysis.regions.situation import Floats, Situation
from converter.shapes.table import shape_kind
from native_tracer.incidence import surfaces_at


def _light(s: Situation, k: int, text: str) -> Finding:
    return Finding(s.scene.light_lines[k] if k < len(s.scene.light_lines) else 0, f"light {k + 1} {text}")


def _near_planes(s: Situation, limit: float) -> Iterator[Finding]:
    """Lights low over a face; those that lie in its plane are known to the tracers."""
    planes = s.planes
    for k, source in enumerate(s.scene.lights if s.needs.lit else ()):
        place = np.array(source.position)
        distances = planes.signed_distances(place)
        numbers = np.maximum(np.abs(planes.offset), float(np.abs(place).max()))
        near = [
            i for i in np.flatnonzero((distances > 0) & (distances < limit * numbers)) if _over_face(s, place, int(i))
        ]
        if near:
            i = min(near, key=lambda i: distances[i] / numbers[i])
            text = f"is {distances[i] / numbers[i]:.2g} of its coordinates above plane {planes.plane[i]}"
            yield _light(s, k, f"{text} of object {planes.object[i]} (less than {limit:.2g})")
            return


def _over_face(s: Situation, place: Floats, i: int) -> bool:
    """Whether a point is over a face, and not on it; the face's finish answers to light."""
    index = int(s.planes.object[i])
    own = s.planes_of(index)
    foot = place - s.planes.signed_distances(place)[i] * s.planes.normal[i]
    room = 1e-9 * (float(np.abs(place).max()) + np.abs(own.offset))
    if s.finish(index).kd == s.finish(index).ks == 0 or not np.all(own.signed_distances(foot) <= room):
        return False
    shape = s.scene.objects[index].shape
    return not surfaces_at(place, [shape_kind(shape).planes(shape)[s.planes.plane[i]]], [False])


def _near_balls(s: Situation, limit: float) -> Iterator[Finding]:
    balls = np.flatnonzero(s.bodies.is_ball)
    center, radius = s.bodies.center[balls], s.bodies.radius[balls]
    for k, source in enumerate(s.scene.lights if s.needs.lit else ()):
        place = np.array(source.position)
        shares = np.abs(np.linalg.norm(center - place, axis=1) - radius) / radius
        rows = np.column_stack([center, radius])
        near = [i for i in np.flatnonzero(shares < limit) if not surfaces_at(place, rows[[i]], [True])]
        if near:
            i = min(near, key=lambda i: shares[i])
            text = f"is {shares[i]:.2g} radii from the surface of object {s.bodies.object[balls[i]]}"
            yield _light(s, k, f"{text} (less than {limit:.2g})")
            return


def _sharp(s: Situation, limit: float) -> Iterator[Finding]:
    for k in s.needs.finishes if s.scene.lights else ():
        finish = s.scene.finishes[k]
        if finish.ks > 0 and finish.alpha * limit > 1:
            line = s.scene.finish_lines[k] if k < len(s.scene.finish_lines) else 0
            yield Finding(line, f"finish {k} has an alpha of {finish.alpha:g} (more than {1 / limit:g})")
            return


REGIONS = (
    Region(("low-light",), {"double": 3e-14, "float": 2e-5, "mesh": 3e-14}, _near_planes),
    Region(("light-distance",), {"float": 1e-4, "offset": 1e-4, "ulp": 1e-4}, _near_balls),
    Region(("highlight",), {"float": 1e-4, "offset": 1e-4, "ulp": 1e-4}, _sharp),
)
