"""A scalar ray tracer without rounding, which decides ties by rule and tells which it has met.

It is written to be read beside the rules, and shares no code with the renderers. Only colours are computed in floating
point: after all that is decided.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from converter.renderers.base import refuse_effects
from converter.scene.model import Color, Finish, Scene
from converter.scene.needs import is_index, scene_needs
from converter.scene.settings import Settings
from converter.studies.exact.arithmetic import Arithmetic, Decimals
from converter.studies.exact.camera import pixel_directions
from converter.studies.exact.pigments import color_function
from converter.studies.exact.shapes import Hit, Ray, body_of
from converter.studies.exact.ties import Decisions
from converter.studies.exact.vectors import Vec, add, dot, scale, subtract, unit
from converter.studies.family import Truth


@dataclass(slots=True)
class Pixel:
    """A pixel's colour, what is seen there first, and the ties that were met on the way."""

    color: Color = (0.0, 0.0, 0.0)
    hit: Hit | None = None
    ties: set[str] = field(default_factory=set)


def exact_picture(scene: Scene, settings: Settings, arithmetic: Arithmetic | None = None) -> Truth:
    """The true picture; see `ExactTracer`."""
    tracer = ExactTracer(scene, settings, arithmetic)
    rows = [[tracer.pixel(x, y).color for x in range(settings.width)] for y in range(settings.height)]
    return np.array(rows, dtype=np.float64)


class ExactTracer:
    """Traces single pixels of a scene, one ray each.

    Args:
        scene: whose numbers are taken as the decimal numbers that a file has for them.
        settings: the picture's.
        arithmetic: `Fractions()` or `Decimals()`, which is the default.

    Raises:
        Undecided: the numbers cannot express the camera; `pixel` raises it, too.
        EffectUnavailable: the scene is sampled.

    """

    def __init__(self, scene: Scene, settings: Settings, arithmetic: Arithmetic | None = None) -> None:
        self._scene, self._settings = scene, settings
        needs = scene_needs(scene, settings)
        refuse_effects(needs, "the exact tracer")
        self._max_depth, self._background = needs.max_depth, needs.background
        self._numbers = arithmetic or Decimals()
        self._decide = decide = Decisions(self._numbers)
        with self._numbers.context():
            self._direction = pixel_directions(scene.camera, settings, decide)
            self._eye = decide.vector(scene.camera.eye)
            self._lights = [decide.vector(light.position) for light in scene.lights]
            self._bodies = [body_of(thing.shape, decide) for thing in scene.objects]
            self._colors = [color_function(pigment, decide) for pigment in scene.pigments]

    def pixel(self, column: int, row: int) -> Pixel:
        """Trace a pixel, counted from the top left corner."""
        with self._numbers.context():
            self._decide.ties = set()
            ray = Ray(self._eye, self._direction(column, row))
            return Pixel(self._color(ray, 1.0, 0), self._nearest(ray), self._decide.ties)

    # ---- What a ray meets

    def _nearest(self, ray: Ray) -> Hit | None:
        """The first body that the ray meets; of two at the same distance, the first of the file."""
        nearest: Hit | None = None
        for index, body in enumerate(self._bodies):
            hit = body.intersect(index, ray, self._decide)
            if hit is None:
                continue
            order = -1 if nearest is None else self._decide.sign(hit.distance - nearest.distance)
            if order == 0:
                self._decide.note("bodies")
            elif order < 0:
                nearest = hit
        return nearest

    def _in_the_way(self, ray: Ray) -> bool:
        """Whether a body lies between the ray's origin and the end of its direction, where a light is."""
        for index, body in enumerate(self._bodies):
            hit = body.intersect(index, ray, self._decide)
            order = 1 if hit is None else self._decide.sign(hit.distance - 1)
            if order < 0:
                return True
            if order == 0:
                self._decide.note("at light")
        return False

    # ---- What it looks like there

    def _color(self, ray: Ray, weight: float, depth: int) -> Color:
        hit = self._nearest(ray)
        if hit is None:
            return self._background
        thing = self._scene.objects[hit.object]
        finish = self._scene.finishes[thing.finish]
        point = add(ray.origin, scale(ray.direction, hit.distance))
        normal = self._bodies[hit.object].normal(hit.plane, point)
        if self._decide.sign(dot(normal, ray.direction)) > 0:
            normal = scale(normal, -1)
        pigment = self._colors[thing.pigment](point)
        color = [finish.ka * a * c for a, c in zip(self._scene.ambient, pigment, strict=True)]
        if finish.kd > 0 or finish.ks > 0:
            for extra in self._lit(ray, hit, point, normal, finish, pigment):
                color = [c + e for c, e in zip(color, extra, strict=True)]
        for share, following in self._secondary(ray, hit, point, normal, finish):
            if share > 0 and weight * share >= self._settings.cutoff and depth < self._max_depth:
                color = [
                    c + share * e
                    for c, e in zip(color, self._color(following(), weight * share, depth + 1), strict=True)
                ]
        return (color[0], color[1], color[2])

    def _lit(self, ray: Ray, hit: Hit, point: Vec, normal: Vec, finish: Finish, pigment: Color) -> Iterator[Color]:
        """What each light adds."""
        n, v = unit(normal), unit(scale(ray.direction, -1))
        for light, position in zip(self._scene.lights, self._lights, strict=True):
            path = subtract(position, point)
            facing = self._decide.sign(dot(normal, path))
            if facing == 0:
                self._decide.note("light in plane")
            if facing <= 0 or self._in_the_way(Ray(point, path, hit.object, hit.plane, hit.inside)):
                continue
            to_light = unit(path)
            cosine = dot(n, to_light)
            if self._settings.specular == "blinn":
                base = dot(n, unit(add(to_light, v)))
            else:
                base = dot(subtract(scale(n, 2 * cosine), to_light), v)
            highlight = min(max(base, 0.0), 1.0) ** finish.alpha
            a, b, c = light.attenuation
            distance = math.sqrt(dot(path, path))
            dimmed = [channel / (a + b * distance + c * distance**2) for channel in light.color]
            r, g, b = (
                i * (finish.kd * cosine * p + finish.ks * highlight) for i, p in zip(dimmed, pigment, strict=True)
            )
            yield (r, g, b)

    def _secondary(
        self, ray: Ray, hit: Hit, point: Vec, normal: Vec, finish: Finish
    ) -> Iterator[tuple[float, Callable[[], Ray]]]:
        """How much of the mirrored ray and of the transmitted one is seen, and what makes them."""
        across, length2 = dot(ray.direction, normal), dot(normal, normal)

        def mirrored() -> Ray:
            along = add(ray.direction, scale(normal, -2 * across / length2))
            return Ray(point, along, hit.object, hit.plane, hit.inside)

        def transmitted() -> Ray:
            ior = self._decide.number(finish.ior)
            entering_ratio = 1 / ior if is_index(finish, self._settings.ior) else ior
            eta = 1 / entering_ratio if hit.inside else entering_ratio
            # The square of the refracted ray's part along the normal, times both squared lengths.
            cosine2 = dot(ray.direction, ray.direction) * (1 - eta * eta) * length2 + eta * eta * across * across
            if self._decide.sign(cosine2) < 0:
                return mirrored()
            if self._decide.sign(cosine2) == 0:
                self._decide.note("critical")
                cosine2 = 0 * cosine2
            inward = (eta * across + self._decide.root(cosine2)) / length2
            along = subtract(scale(ray.direction, eta), scale(normal, inward))
            return Ray(point, along, hit.object, hit.plane, not hit.inside)

        yield finish.kr, mirrored
        yield finish.kt, transmitted
