"""A scalar ray tracer without rounding, which decides ties by rule and tells which it has met.

It is written to be read beside the rules, and shares no code with the renderers. Directions have any length, so that
no root is taken where none is needed; distances are multiples of the direction. Only colours are computed in floating
point: after all that is decided.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, assert_never

import numpy as np
from numpy.typing import NDArray

from converter.images.texture import read_texture
from converter.renderers.base import refuse_effects
from converter.scene.model import (
    Camera,
    Checker,
    Color,
    Csg,
    Finish,
    Pigment,
    Polyhedron,
    Quadric,
    Scene,
    Shape,
    Solid,
    Sphere,
    Texmap,
    Vector,
)
from converter.scene.needs import is_index, scene_needs
from converter.scene.settings import Settings
from converter.studies.exact.arithmetic import Arithmetic, Decimals, Number
from converter.studies.exact.csg import Along, Leaf, Node, first_met
from converter.studies.family import Truth

TIES = {
    "tile": "a coordinate is a whole number of tiles",
    "texel": "a position in an image is a whole number of texels",
    "along": "a ray runs along a plane, outside or inside of it",
    "in": "a ray runs in a plane",
    "touched edge": "a ray enters a polyhedron where it leaves it",
    "seen edge": "a ray enters, or leaves, a polyhedron through two of its planes at once",
    "bodies": "a ray meets two bodies at the same distance",
    "light in plane": "a light lies in the plane of what it might light",
    "at light": "a shadow ray meets a body at the light",
    "at start": "a ray meets another body where it starts",
    "tangent": "a ray touches a ball, or a quadric",
    "critical": "a ray leaves at the critical angle",
}
"""Every kind of tie."""

Vec = tuple[Number, Number, Number]


@dataclass(frozen=True, slots=True)
class Ray:
    """A ray, and what it starts on: an object, its plane, and whether the ray travels inside that object."""

    origin: Vec
    direction: Vec
    object: int = -1
    plane: int = -1
    inside: bool = False


@dataclass(frozen=True, slots=True)
class Hit:
    """What a ray meets, at `distance` times its direction; `plane` is -1 where it is none; `inside`: from within."""

    distance: Number
    object: int
    plane: int
    inside: bool


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
        self._numbers = arithmetic or Decimals()
        self._scene, self._settings = scene, settings
        needs = scene_needs(scene, settings)
        refuse_effects(needs, "the exact tracer")
        self._max_depth, self._background = needs.max_depth, needs.background
        self._ties: set[str] = set()
        with self._numbers.context():
            self._direction = self._camera(scene.camera)
            self._eye = self._vector(scene.camera.eye)
            self._lights = [self._vector(light.position) for light in scene.lights]
            self._shapes = [self._shape(o.shape) for o in scene.objects]
            self._colors = [self._pigment(pigment) for pigment in scene.pigments]

    def pixel(self, column: int, row: int) -> Pixel:
        """Trace a pixel, counted from the top left corner."""
        with self._numbers.context():
            self._ties = set()
            ray = Ray(self._eye, self._direction(column, row))
            return Pixel(self._color(ray, 1.0, 0), self._nearest(ray), self._ties)

    # ---- The camera

    def _camera(self, camera: Camera) -> Callable[[int, int], Vec]:
        number = self._numbers.number
        forward = _difference(self._vector(camera.look_at), self._vector(camera.eye))
        right = _cross(forward, self._vector(camera.up))
        up = _cross(right, forward)
        # To the length of `forward`, and to half the height of the window.
        tangent = self._numbers.tangent(number(camera.fovy))
        forward2, right2 = _dot(forward, forward), _dot(right, right)
        across = tangent * self._numbers.root(forward2 / right2)
        upward = tangent / self._numbers.root(right2)
        width, height = self._settings.width, self._settings.height
        shift = number(0.5 if self._settings.pixel == "center" else 0.0)

        def direction(column: int, row: int) -> Vec:
            x = (2 * (column + shift) - width) / height
            y = (height - 2 * (row + shift)) / height
            return _sum(forward, _sum(_scaled(right, x * across), _scaled(up, y * upward)))

        return direction

    # ---- What a ray meets

    def _nearest(self, ray: Ray) -> Hit | None:
        """The first body that the ray meets; of two at the same distance, the first of the file."""
        nearest: Hit | None = None
        for index in range(len(self._shapes)):
            hit = self._meet(index, ray)
            if hit is None:
                continue
            order = -1 if nearest is None else self._sign(hit.distance - nearest.distance)
            if order == 0:
                self._ties.add("bodies")
            elif order < 0:
                nearest = hit
        return nearest

    def _in_the_way(self, ray: Ray) -> bool:
        """Whether a body lies between the ray's origin and the end of its direction, where a light is."""
        for index in range(len(self._shapes)):
            hit = self._meet(index, ray)
            order = 1 if hit is None else self._sign(hit.distance - 1)
            if order < 0:
                return True
            if order == 0:
                self._ties.add("at light")
        return False

    def _meet(self, index: int, ray: Ray) -> Hit | None:
        """Where the ray first meets an object, beyond its own start."""
        shape = self._shapes[index]
        if isinstance(shape, _Csg):
            return self._meet_csg(index, shape, ray)
        if isinstance(shape, _Quadric):
            return self._meet_quadric(index, shape, ray)
        if ray.object == index and not ray.inside:
            return None  # the others are convex
        if isinstance(shape, _Ball):
            return self._meet_ball(index, shape, ray)
        return self._meet_polyhedron(index, shape, ray)

    def _meet_ball(self, index: int, ball: "_Ball", ray: Ray) -> Hit | None:
        """The roots of a t^2 - 2 b t + c = 0."""
        arm = _difference(ball.center, ray.origin)
        a, b = _dot(ray.direction, ray.direction), _dot(arm, ray.direction)
        if ray.object == index:
            return Hit(2 * b / a, index, -1, True) if self._sign(b) > 0 else None
        c = _dot(arm, arm) - ball.radius * ball.radius
        discriminant = b * b - a * c
        if self._sign(discriminant) <= 0:
            if self._sign(discriminant) == 0 and self._sign(b) > 0:
                self._ties.add("tangent")
            return None
        if self._sign(c) == 0:
            self._ties.add("at start")
            return Hit(2 * b / a, index, -1, True) if self._sign(b) > 0 else None
        if self._sign(c) > 0 and self._sign(b) < 0:
            return None
        root = self._numbers.root(discriminant)
        outside = self._sign(c) > 0
        return Hit((b - root) / a if outside else (b + root) / a, index, -1, not outside)

    def _meet_quadric(self, index: int, quadric: "_Quadric", ray: Ray) -> Hit | None:
        """The roots of a t^2 + 2 b t + c = 0, where that changes its sign."""
        a, b, c = quadric.along(ray.origin, ray.direction)
        if ray.object == index:
            inside, roots = ray.inside, self._other_root(a, b)
        elif self._sign(c) == 0:
            self._ties.add("at start")
            inside, roots = (self._sign(b) or self._sign(a)) < 0, self._other_root(a, b)
        elif self._sign(a) == 0:
            inside, roots = self._sign(c) < 0, [-c / (2 * b)] if self._sign(b) else []
        else:
            discriminant = b * b - a * c
            if self._sign(discriminant) == 0 and self._sign(a) * self._sign(b) < 0:
                self._ties.add("tangent")
            if self._sign(discriminant) <= 0:
                return None
            root = self._numbers.root(discriminant)
            inside, roots = self._sign(c) < 0, [(-b - root) / a, (-b + root) / a]
        ahead = [t for t in roots if self._sign(t) > 0]
        return Hit(min(ahead), index, -1, inside) if ahead else None

    def _other_root(self, a: Number, b: Number) -> list[Number]:
        """Of a t^2 + 2 b t = 0 but 0; where that is a root twice, none."""
        return [-2 * b / a] if self._sign(a) and self._sign(b) else []

    def _meet_csg(self, index: int, csg: "_Csg", ray: Ray) -> Hit | None:
        """`plane` is the surface's index among all of its leaves'."""
        along = [surface.along(ray.origin, ray.direction) for surface in csg.surfaces]
        if ray.object != index and any(self._sign(c) == 0 for _, _, c in along):
            self._ties.add("at start")
        if any(self._sign(a) == self._sign(b) == 0 for a, b, _ in along):
            self._ties.add("along")
        met = first_met(csg.node, along, self._numbers, lambda: self._ties.add("tangent"))
        if met is None:
            return None
        if met.tied:
            self._ties.add("seen edge")
        return Hit(met.distance, index, met.surface, met.inside)

    def _meet_polyhedron(self, index: int, planes: "Sequence[_Plane]", ray: Ray) -> Hit | None:
        """The ray is inside between the last plane that it enters and the first that it leaves."""
        from_within = ray.object == index
        enters, leaves = _Extreme(1), _Extreme(-1)
        for k, plane in enumerate(planes):
            if from_within and k == ray.plane:
                continue
            slope = _dot(plane.gradient, ray.direction)
            height = _dot(plane.gradient, ray.origin) + plane.offset
            if self._sign(slope) == 0:
                self._ties.add("along" if self._sign(height) else "in")
                if self._sign(height) > 0:
                    return None
            else:
                (enters if self._sign(slope) < 0 else leaves).consider(-height / slope, k, self._sign)
        if from_within:
            # Through an edge, the next plane is met at once.
            return leaves.hit(index, max(leaves.distance, 0 * leaves.distance), True) if leaves.found else None
        if enters.found and leaves.found:
            order = self._sign(enters.distance - leaves.distance)
            if order > 0:
                return None
            if order == 0:
                self._ties.add("touched edge")
        for found, inside in ((enters, False), (leaves, True)):
            if found.found:
                sign = self._sign(found.distance)
                if sign == 0:
                    self._ties.add("at start")
                if sign > 0:
                    if found.tied:
                        self._ties.add("seen edge")
                    return found.hit(index, found.distance, inside)
        return None

    # ---- What it looks like there

    def _color(self, ray: Ray, weight: float, depth: int) -> Color:
        hit = self._nearest(ray)
        if hit is None:
            return self._background
        thing = self._scene.objects[hit.object]
        finish = self._scene.finishes[thing.finish]
        point = _sum(ray.origin, _scaled(ray.direction, hit.distance))
        shape = self._shapes[hit.object]
        surfaces = shape.surfaces if isinstance(shape, _Csg) else shape
        normal = (surfaces[hit.plane] if isinstance(surfaces, list) else surfaces).normal(point)
        if self._sign(_dot(normal, ray.direction)) > 0:
            normal = _scaled(normal, -1)
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
        n, v = _unit(normal), _unit(_scaled(ray.direction, -1))
        for light, position in zip(self._scene.lights, self._lights, strict=True):
            path = _difference(position, point)
            facing = self._sign(_dot(normal, path))
            if facing == 0:
                self._ties.add("light in plane")
            if facing <= 0 or self._in_the_way(Ray(point, path, hit.object, hit.plane, hit.inside)):
                continue
            to_light = _unit(path)
            cosine = _dot(n, to_light)
            if self._settings.specular == "blinn":
                base = _dot(n, _unit(_sum(to_light, v)))
            else:
                base = _dot(_difference(_scaled(n, 2 * cosine), to_light), v)
            highlight = min(max(base, 0.0), 1.0) ** finish.alpha
            a, b, c = light.attenuation
            distance = math.sqrt(_dot(path, path))
            dimmed = [channel / (a + b * distance + c * distance**2) for channel in light.color]
            r, g, b = (
                i * (finish.kd * cosine * p + finish.ks * highlight) for i, p in zip(dimmed, pigment, strict=True)
            )
            yield (r, g, b)

    def _secondary(
        self, ray: Ray, hit: Hit, point: Vec, normal: Vec, finish: Finish
    ) -> Iterator[tuple[float, Callable[[], Ray]]]:
        """How much of the mirrored ray and of the transmitted one is seen, and what makes them."""
        across, length2 = _dot(ray.direction, normal), _dot(normal, normal)

        def mirrored() -> Ray:
            along = _sum(ray.direction, _scaled(normal, -2 * across / length2))
            return Ray(point, along, hit.object, hit.plane, hit.inside)

        def transmitted() -> Ray:
            ior = self._numbers.number(finish.ior)
            entering_ratio = 1 / ior if is_index(finish, self._settings.ior) else ior
            eta = 1 / entering_ratio if hit.inside else entering_ratio
            # The square of the refracted ray's part along the normal, times both squared lengths.
            cosine2 = _dot(ray.direction, ray.direction) * (1 - eta * eta) * length2 + eta * eta * across * across
            if self._sign(cosine2) < 0:
                return mirrored()
            if self._sign(cosine2) == 0:
                self._ties.add("critical")
                cosine2 = 0 * cosine2
            inward = (eta * across + self._numbers.root(cosine2)) / length2
            along = _difference(_scaled(ray.direction, eta), _scaled(normal, inward))
            return Ray(point, along, hit.object, hit.plane, not hit.inside)

        yield finish.kr, mirrored
        yield finish.kt, transmitted

    # ---- Pigments

    def _pigment(self, pigment: Pigment) -> Callable[[Vec], Color]:
        match pigment:
            case Solid(color):
                return lambda _: color
            case Checker(first, second, size):
                return self._tiles(first, second, self._numbers.number(size))
            case Texmap():
                return self._texels(pigment)
        assert_never(pigment)

    def _tiles(self, first: Color, second: Color, size: Number) -> Callable[[Vec], Color]:
        def tile(point: Vec) -> Color:
            odd = sum(self._cell(x / size, "tile", toward_zero=False) for x in point) % 2
            return second if odd else first

        return tile

    def _texels(self, pigment: Texmap) -> Callable[[Vec], Color]:
        number = self._numbers.number
        texels, p0, p1 = self._texture(pigment), *([number(x) for x in p] for p in (pigment.p0, pigment.p1))
        height, width = texels.shape[:2]

        def texel(point: Vec) -> Color:
            column, row = (
                self._cell((_dot(p[:3], point) + p[3]) * count, "texel", toward_zero=True) % count
                for p, count in ((p0, width), (p1, height))
            )
            r, g, b = texels[row, column].tolist()
            return (r, g, b)

        return texel

    @staticmethod
    def _texture(pigment: Texmap) -> NDArray[np.float32]:
        return np.asarray(read_texture(pigment.file).texels)

    def _cell(self, x: Number, kind: str, toward_zero: bool) -> int:
        """The whole number below x, or next to it on the way to 0; x itself if it is whole."""
        whole = self._numbers.nearest_whole(x)
        side = self._sign(x - whole)
        if side == 0:
            self._ties.add(kind)
            return whole
        below = whole if side > 0 else whole - 1
        return below + 1 if toward_zero and self._sign(x) < 0 else below

    # ---- Numbers

    def _sign(self, x: Number) -> int:
        return self._numbers.sign(x)

    def _vector(self, v: Vector) -> Vec:
        x, y, z = (self._numbers.number(c) for c in v)
        return (x, y, z)

    def _shape(self, shape: Shape) -> "_Ball | list[_Plane] | _Quadric | _Csg":
        number = self._numbers.number
        match shape:
            case Sphere(center, radius):
                return _Ball(self._vector(center), number(radius))
            case Polyhedron(planes):
                return [_Plane(self._vector((a, b, c)), number(d)) for a, b, c, d in planes]
            case Quadric(coefficients):
                return _Quadric(tuple(map(number, coefficients)))
            case Csg():
                surfaces: list[_Ball | _Plane | _Quadric] = []
                return _Csg(self._node(shape, surfaces), surfaces)
        assert_never(shape)

    def _node(self, shape: Csg, surfaces: "list[_Ball | _Plane | _Quadric]") -> Node:
        """Its expression; the leaves' surfaces are appended."""
        steps: list[tuple[Literal["+", "-", "&"], Leaf | Node]] = []
        for operand in shape.operands:
            if isinstance(operand.shape, Csg):
                steps.append((operand.operation, self._node(operand.shape, surfaces)))
                continue
            leaf, first = self._shape(operand.shape), len(surfaces)
            assert not isinstance(leaf, _Csg)
            surfaces += leaf if isinstance(leaf, list) else [leaf]
            steps.append((operand.operation, Leaf(range(first, len(surfaces)))))
        return Node(tuple(steps))


@dataclass(frozen=True, slots=True)
class _Ball:
    center: Vec
    radius: Number

    def along(self, p: Vec, d: Vec) -> Along:
        """Its value at p + t d."""
        arm = _difference(p, self.center)
        return _dot(d, d), _dot(arm, d), _dot(arm, arm) - self.radius * self.radius

    def normal(self, point: Vec) -> Vec:
        """Outward, of any length."""
        return _difference(point, self.center)


@dataclass(frozen=True, slots=True)
class _Quadric:
    """The numbers A to J."""

    numbers: tuple[Number, ...]

    def along(self, p: Vec, d: Vec) -> Along:
        """Its value at p + t d."""
        g, h, i, j = self.numbers[6:]
        gradient = self.normal(p)
        constant = (_dot(p, gradient) + _dot((g, h, i), p)) / 2 + j
        return _dot(d, _difference(self.normal(d), (g, h, i))) / 2, _dot(d, gradient) / 2, constant

    def normal(self, point: Vec) -> Vec:
        """The gradient, which points out, and may have any length."""
        (x, y, z), (a, b, c, d, e, f, g, h, i, _) = point, self.numbers
        return (
            2 * a * x + d * y + e * z + g,
            2 * b * y + d * x + f * z + h,
            2 * c * z + e * x + f * y + i,
        )


@dataclass(frozen=True, slots=True)
class _Plane:
    gradient: Vec
    offset: Number

    def along(self, p: Vec, d: Vec) -> Along:
        """Its value at p + t d."""
        return 0 * self.offset, _dot(self.gradient, d) / 2, _dot(self.gradient, p) + self.offset

    def normal(self, point: Vec) -> Vec:
        """The same everywhere."""
        return self.gradient


@dataclass(frozen=True, slots=True)
class _Csg:
    """An expression over leaves, and their surfaces."""

    node: Node
    surfaces: "list[_Ball | _Plane | _Quadric]"


@dataclass(slots=True)
class _Extreme:
    """The largest (direction 1) or smallest (-1) of some distances, and the first of the planes that have it."""

    direction: int
    found: bool = False
    distance: Number = None
    plane: int = -1
    tied: bool = False

    def consider(self, distance: Number, plane: int, sign: Callable[[Number], int]) -> None:
        """Take one more distance."""
        order = self.direction * sign(distance - self.distance) if self.found else 1
        if order > 0:
            self.found, self.distance, self.plane, self.tied = True, distance, plane, False
        elif order == 0:
            self.tied = True

    def hit(self, index: int, distance: Number, inside: bool) -> Hit:
        """There, on the object `index`."""
        return Hit(distance, index, self.plane, inside)


def _dot(a: Sequence[Number], b: Sequence[Number]) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _cross(a: Vec, b: Vec) -> Vec:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _sum(a: Vec, b: Vec) -> Vec:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _difference(a: Vec, b: Vec) -> Vec:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _scaled(a: Vec, factor: Number) -> Vec:
    return (a[0] * factor, a[1] * factor, a[2] * factor)


def _unit(a: Vec) -> Vec:
    """In floating point."""
    x, y, z = map(float, a)
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length)
