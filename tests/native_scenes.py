"""Small scenes for the tests of the native tracer, and single rays through them."""

from __future__ import annotations

import colorsys
import math
from array import array
from typing import Any

import native_tracer

PRECISIONS = ("float", "double", "long double")
EPSILON = {"float": 2.0**-23, "double": 2.0**-52, "long double": 2.0**-52}
"""Spacing of the numbers after 1, as Python sees them: results in long double reach it as doubles."""

BLACK = (0.0, 0.0, 0.0)
WHITE = (1.0, 1.0, 1.0)
CONSTANT = (1.0, 0.0, 0.0)
"""The attenuation of a light that distance does not dim."""

Vector = tuple[float, float, float]
Plane = tuple[float, float, float, float]


def new_scene(ambient: Vector = BLACK, background: Vector = BLACK) -> native_tracer.Scene:
    scene = native_tracer.Scene()
    scene.set_ambient(ambient)
    scene.set_background(background)
    return scene


def add_finish(scene: native_tracer.Scene, **values: float) -> int:
    """A finish; what is not given is 0, and eta 1."""
    numbers = {"ka": 0.0, "kd": 0.0, "ks": 0.0, "alpha": 1.0, "kr": 0.0, "kt": 0.0, "eta": 1.0, **values}
    return scene.add_finish(**numbers)


def look(scene: native_tracer.Scene, eye: Vector, direction: Vector) -> None:
    """Aim the camera so that the middle of the picture looks along `direction`."""
    smallest = min(range(3), key=lambda i: abs(direction[i]))
    up = tuple(1.0 if i == smallest else 0.0 for i in range(3))
    # As far away as the numbers are large: forward is the difference of two points.
    reach = max(1.0, *map(abs, eye)) / max(map(abs, direction))
    scene.set_camera(eye, tuple(e + reach * d for e, d in zip(eye, direction, strict=True)), up, 1.0)


def trace_ray(scene: native_tracer.Scene, eye: Vector, direction: Vector, **options: Any) -> dict[str, Any]:
    """The tree of one ray."""
    look(scene, eye, direction)
    settings = {"cutoff": 0.0, "max_depth": 0, "corner": False, **options}
    (ray,) = native_tracer.trace_pixel(scene, 1, 1, 0, 0, **settings)["rays"]
    return ray


def draw(scene: native_tracer.Scene, width: int = 64, height: int = 48, **options: Any) -> native_tracer.Image:
    image = native_tracer.Image(width, height)
    native_tracer.render(scene, image, **{"cutoff": 1 / 512, "max_depth": 16, **options})
    return image


def box(low: Vector, high: Vector) -> list[Plane]:
    """A box's planes: x, y and z from below, then from above."""
    planes = []
    for axis in range(3):
        normal = [0.0, 0.0, 0.0]
        normal[axis] = -1.0
        planes.append((*normal, low[axis]))
    for axis in range(3):
        normal = [0.0, 0.0, 0.0]
        normal[axis] = 1.0
        planes.append((*normal, -high[axis]))
    return planes


def normalized(v: Vector) -> Vector:
    length = math.sqrt(math.fsum(x * x for x in v))
    return tuple(x / length for x in v)


def dot(a: Vector, b: Vector) -> float:
    return math.fsum(x * y for x, y in zip(a, b, strict=True))


def rainbow(width: int, height: int) -> array[float]:
    """Texels of a smooth ramp of hues."""
    row = [0.5 + 0.5 * channel for x in range(width) for channel in colorsys.hsv_to_rgb(x / width, 1, 1)]
    return array("f", row * height)


def gallery(scale: float = 1.0, shift: Vector = BLACK) -> native_tracer.Scene:
    """One of everything: mirrors, glass, a checkered column without end, a texture, two lights with falloff.

    `scale` and `shift` are applied to all of it, the camera and the lights included.
    """

    def point(*p: float) -> Vector:
        return tuple(scale * c + s for c, s in zip(p, shift, strict=True))

    def planes(*numbers: Plane) -> list[Plane]:
        return [(a, b, c, scale * d - dot((a, b, c), shift)) for a, b, c, d in numbers]

    def projection(a: float, b: float, c: float, d: float) -> Plane:
        return a / scale, b / scale, c / scale, d - dot((a, b, c), shift) / scale

    scene = new_scene((0.9, 0.95, 1.0), (0.2, 0.3, 0.5))
    scene.set_camera(point(0, 2, 9), point(0, 0.7, 0), (0, 1, 0), 45)
    scene.add_light(point(5, 8, 6), (0.9, 0.9, 0.8), (0.5, 0.02 / scale, 0.003 / scale**2))
    scene.add_light(point(-6, 5, 4), (0.4, 0.4, 0.6), CONSTANT)
    white = scene.add_solid(WHITE)
    red = scene.add_solid((0.8, 0.2, 0.1))
    checker = scene.add_checker((0.1, 0.2, 0.1), (0.9, 0.9, 0.8), 0.7 * scale)
    texture = scene.add_texmap(96, 4, rainbow(96, 4), projection(0.2, 0.05, 0, 0.3), projection(0, 0.1, 0, 0))
    matte = add_finish(scene, ka=0.3, kd=0.6)
    shiny = add_finish(scene, ka=0.2, kd=0.5, ks=0.4, alpha=60, kr=0.25)
    mirror = add_finish(scene, ka=0.05, kd=0.05, ks=0.5, alpha=300, kr=0.8)
    glass = add_finish(scene, ka=0.02, ks=0.3, alpha=200, kr=0.15, kt=0.8, eta=1 / 1.5)
    scene.add_polyhedron(
        checker, matte, planes((0, 1, 0, 1), (1, 0, 0, -12), (-1, 0, 0, -12), (0, 0, 1, -12), (0, 0, -1, -12))
    )
    scene.add_sphere(white, mirror, point(-2.2, 0.2, -1), 1.2 * scale)
    scene.add_sphere(white, glass, point(0.3, 0, 1.5), scale)
    scene.add_sphere(texture, shiny, point(2.6, 0.1, 0), 1.1 * scale)
    scene.add_polyhedron(red, glass, planes(*box((-1, -0.99, 3), (-0.2, 0.2, 3.8))))
    scene.add_polyhedron(
        red, shiny, planes((1.2, 1, 1, -0.6), (-1, 1.3, 1, -0.7), (0.1, 1, -1, -1.9), (0, -1, 0, -0.9))
    )
    return scene
