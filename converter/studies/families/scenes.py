"""Parts of the families' scenes."""

from collections.abc import Sequence
from dataclasses import replace

from converter.pigments.table import pigment_kind
from converter.scene.model import (
    Camera,
    Color,
    Finish,
    Light,
    Object,
    Pigment,
    Plane,
    Polyhedron,
    Scene,
    Shape,
    Solid,
    Sphere,
    Vector,
)
from converter.scene.settings import Settings
from converter.shapes.table import shape_kind

Body = tuple[Shape, Pigment | Color, Finish]
"""A shape with its pigment, or a plain colour, and its finish."""

MATTE = Finish(0.2, 0.7, 0.0, 1.0, 0.0, 0.0, 0.0)
"""Ambient and diffuse light only."""
MIRROR = Finish(0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0)
"""Nothing but a perfect reflection."""
GLASS = Finish(0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.5)
"""Nothing but a perfect refraction."""
GLOW = Finish(1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
"""Its pigment's own colour, times the ambient light's, whatever the lights."""

WHITE: Color = (1.0, 1.0, 1.0)
BLACK: Color = (0.0, 0.0, 0.0)


def settings(width: int = 48, height: int = 36, background: Color = BLACK, max_depth: int | None = None) -> Settings:
    """A small picture, one ray through the centre of each pixel, and no ray dropped for its weight."""
    return Settings(width, height, pixel="center", background=background, cutoff=0.0, max_depth=max_depth)


def camera(eye: Vector, look_at: Vector, fovy: float = 40.0, up: Vector = (0.0, 1.0, 0.0)) -> Camera:
    """A camera whose up is +y, unless told otherwise."""
    return Camera(eye, look_at, up, fovy)


def light(position: Vector, color: Color = WHITE, attenuation: Vector = (1.0, 0.0, 0.0)) -> Light:
    """A light, which no distance dims unless told otherwise."""
    return Light(position, color, attenuation)


def scene(
    view: Camera,
    bodies: Sequence[Body],
    lights: Sequence[Light] = (),
    ambient: Color = WHITE,
) -> Scene:
    """A scene of bodies, each with a pigment and a finish of its own."""
    pigments = tuple(p if not isinstance(p, tuple) else Solid(p) for _, p, _ in bodies)
    finishes = tuple(finish for _, _, finish in bodies)
    objects = tuple(Object(i, i, shape) for i, (shape, _, _) in enumerate(bodies))
    return Scene(view, ambient, tuple(lights), pigments, finishes, objects)


def sphere(center: Vector, radius: float) -> Sphere:
    """A ball."""
    return Sphere(center, radius)


def floor(height: float = 0.0) -> Polyhedron:
    """Everything below y = `height`."""
    return Polyhedron(((0.0, 1.0, 0.0, -height),))


def box(low: Vector, high: Vector) -> Polyhedron:
    """A box along the axes."""
    planes: list[Plane] = []
    for axis in range(3):
        normal = [0.0, 0.0, 0.0]
        normal[axis] = 1.0
        planes.append((normal[0], normal[1], normal[2], -high[axis]))
        planes.append((-normal[0], -normal[1], -normal[2], low[axis]))
    return Polyhedron(tuple(planes))


def scaled(whole: Scene, factor: float) -> Scene:
    """`whole` times `factor`: every length, the lights' attenuation and the pigments, so that its picture stays."""

    def vector(v: Vector) -> Vector:
        return (factor * v[0], factor * v[1], factor * v[2])

    def dimmed(source: Light) -> Light:
        a, b, c = source.attenuation
        fading = (a, b / factor, c / factor**2)
        return replace(source, position=vector(source.position), attenuation=fading, radius=factor * source.radius)

    view = whole.camera
    aperture, focal = factor * view.aperture, factor * view.focal
    return replace(
        whole,
        camera=replace(view, eye=vector(view.eye), look_at=vector(view.look_at), aperture=aperture, focal=focal),
        lights=tuple(map(dimmed, whole.lights)),
        pigments=tuple(pigment_kind(p).scaled(p, factor) for p in whole.pigments),
        objects=tuple(
            replace(o, shape=shape_kind(o.shape).scaled(o.shape, factor), move=vector(o.move)) for o in whole.objects
        ),
    )


# ---- A slanting frame, in which heights are exact --------------------------------------------------------------------

NORMAL: Vector = (2.0, 3.0, 6.0)
"""Of slanting planes. Its length is 7, so that heights above them are exact, and nothing is aligned with an axis."""
ALONG: Vector = (3.0, -2.0, 0.0)
ASIDE: Vector = (12.0, 18.0, -13.0)
"""Orthogonal to it, and to each other."""


def slope(height: float = 7.0, up: float = 1.0) -> Plane:
    """The half-space below, or with -1 above, a plane orthogonal to `NORMAL` and that far from the origin."""
    return (up * NORMAL[0], up * NORMAL[1], up * NORMAL[2], -up * 7 * height)


def on_slope(height: float = 7.0, along: float = 0.0, aside: float = 0.0) -> Vector:
    """The point above the origin's foot on `slope(height)`, and so many times `ALONG` and `ASIDE` off it."""
    x, y, z = (height / 7 * n + along * a + aside * b for n, a, b in zip(NORMAL, ALONG, ASIDE, strict=True))
    return (x, y, z)
