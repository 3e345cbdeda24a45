"""Where rays meet shapes, and the normals there.

Directions have any length, so that no root is taken where none is needed; distances are multiples of the direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, assert_never

from converter.scene.model import Csg, Polyhedron, Quadric, Shape, Sphere
from converter.studies.exact.arithmetic import Number
from converter.studies.exact.csg import Along, Leaf, Node, first_met
from converter.studies.exact.ties import Decisions
from converter.studies.exact.vectors import Vec, dot, subtract


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


class Body(Protocol):
    """A shape that rays meet."""

    def intersect(self, index: int, ray: Ray, decide: Decisions) -> Hit | None:
        """Where a ray first meets the shape of object `index`, beyond its own start."""
        ...

    def normal(self, plane: int, point: Vec) -> Vec:
        """The outward normal, of any length, at a point of that plane of a hit."""
        ...


class Surface(Protocol):
    """A surface of a csg's leaf."""

    def along(self, p: Vec, d: Vec) -> Along:
        """Its value at p + t d."""
        ...

    def normal(self, plane: int, point: Vec) -> Vec:
        """As `Body` has it."""
        ...


def body_of(shape: Shape, decide: Decisions) -> Body:
    """A shape in certain numbers."""
    match shape:
        case Sphere() | Quadric():
            return _surface_of(shape, decide)
        case Polyhedron():
            return ConvexPolyhedron(_planes_of(shape, decide))
        case Csg():
            surfaces: list[Surface] = []
            return CsgBody(_node(shape, surfaces, decide), surfaces)
    assert_never(shape)


def _surface_of(shape: Sphere | Quadric, decide: Decisions) -> "Ball | QuadricBody":
    if isinstance(shape, Sphere):
        return Ball(decide.vector(shape.center), decide.number(shape.radius))
    return QuadricBody(tuple(map(decide.number, shape.coefficients)))


def _planes_of(shape: Polyhedron, decide: Decisions) -> "list[Plane]":
    return [Plane(decide.vector((a, b, c)), decide.number(d)) for a, b, c, d in shape.planes]


def _node(shape: Csg, surfaces: list[Surface], decide: Decisions) -> Node:
    """Its expression; the leaves' surfaces are appended."""
    steps: list[tuple[Literal["+", "-", "&"], Leaf | Node]] = []
    for operand in shape.operands:
        first = len(surfaces)
        match operand.shape:
            case Csg():
                steps.append((operand.operation, _node(operand.shape, surfaces, decide)))
                continue
            case Polyhedron():
                surfaces += _planes_of(operand.shape, decide)
            case Sphere() | Quadric():
                surfaces.append(_surface_of(operand.shape, decide))
        steps.append((operand.operation, Leaf(range(first, len(surfaces)))))
    return Node(tuple(steps))


@dataclass(frozen=True, slots=True)
class Ball:
    """A sphere."""

    center: Vec
    radius: Number

    def intersect(self, index: int, ray: Ray, decide: Decisions) -> Hit | None:
        """The roots of a t^2 - 2 b t + c = 0."""
        sign = decide.sign
        arm = subtract(self.center, ray.origin)
        a, b = dot(ray.direction, ray.direction), dot(arm, ray.direction)
        if ray.object == index:  # it is convex
            return Hit(2 * b / a, index, -1, True) if ray.inside and sign(b) > 0 else None
        c = dot(arm, arm) - self.radius * self.radius
        discriminant = b * b - a * c
        if sign(discriminant) <= 0:
            if sign(discriminant) == 0 and sign(b) > 0:
                decide.note("tangent")
            return None
        if sign(c) == 0:
            decide.note("at start")
            return Hit(2 * b / a, index, -1, True) if sign(b) > 0 else None
        if sign(c) > 0 and sign(b) < 0:
            return None
        root = decide.root(discriminant)
        outside = sign(c) > 0
        return Hit((b - root) / a if outside else (b + root) / a, index, -1, not outside)

    def along(self, p: Vec, d: Vec) -> Along:
        """As `Surface` has it."""
        arm = subtract(p, self.center)
        return dot(d, d), dot(arm, d), dot(arm, arm) - self.radius * self.radius

    def normal(self, plane: int, point: Vec) -> Vec:
        """From the centre."""
        return subtract(point, self.center)


@dataclass(frozen=True, slots=True)
class QuadricBody:
    """A surface of second degree, by the numbers A to J."""

    numbers: tuple[Number, ...]

    def intersect(self, index: int, ray: Ray, decide: Decisions) -> Hit | None:
        """The roots of a t^2 + 2 b t + c = 0, where that changes its sign."""
        sign = decide.sign
        a, b, c = self.along(ray.origin, ray.direction)
        if ray.object == index:
            inside, roots = ray.inside, _other_root(a, b, decide)
        elif sign(c) == 0:
            decide.note("at start")
            inside, roots = (sign(b) or sign(a)) < 0, _other_root(a, b, decide)
        elif sign(a) == 0:
            inside, roots = sign(c) < 0, [-c / (2 * b)] if sign(b) else []
        else:
            discriminant = b * b - a * c
            if sign(discriminant) == 0 and sign(a) * sign(b) < 0:
                decide.note("tangent")
            if sign(discriminant) <= 0:
                return None
            root = decide.root(discriminant)
            inside, roots = sign(c) < 0, [(-b - root) / a, (-b + root) / a]
        ahead = [t for t in roots if sign(t) > 0]
        return Hit(min(ahead), index, -1, inside) if ahead else None

    def along(self, p: Vec, d: Vec) -> Along:
        """As `Surface` has it."""
        g, h, i, j = self.numbers[6:]
        gradient = self._gradient(p)
        constant = (dot(p, gradient) + dot((g, h, i), p)) / 2 + j
        return dot(d, subtract(self._gradient(d), (g, h, i))) / 2, dot(d, gradient) / 2, constant

    def normal(self, plane: int, point: Vec) -> Vec:
        """The gradient."""
        return self._gradient(point)

    def _gradient(self, point: Vec) -> Vec:
        (x, y, z), (a, b, c, d, e, f, g, h, i, _) = point, self.numbers
        return (
            2 * a * x + d * y + e * z + g,
            2 * b * y + d * x + f * z + h,
            2 * c * z + e * x + f * y + i,
        )


def _other_root(a: Number, b: Number, decide: Decisions) -> list[Number]:
    """Of a t^2 + 2 b t = 0 but 0; where that is a root twice, none."""
    return [-2 * b / a] if decide.sign(a) and decide.sign(b) else []


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane of a polyhedron."""

    gradient: Vec
    offset: Number

    def along(self, p: Vec, d: Vec) -> Along:
        """As `Surface` has it."""
        return 0 * self.offset, dot(self.gradient, d) / 2, dot(self.gradient, p) + self.offset

    def normal(self, plane: int, point: Vec) -> Vec:
        """The same everywhere."""
        return self.gradient


@dataclass(frozen=True, slots=True)
class ConvexPolyhedron:
    """What half-spaces have in common."""

    planes: Sequence[Plane]

    def intersect(self, index: int, ray: Ray, decide: Decisions) -> Hit | None:
        """The ray is inside between the last plane that it enters and the first that it leaves."""
        from_within = ray.object == index
        if from_within and not ray.inside:
            return None  # it is convex
        sign = decide.sign
        enters, leaves = _Extreme(1), _Extreme(-1)
        for k, plane in enumerate(self.planes):
            if from_within and k == ray.plane:
                continue
            slope = dot(plane.gradient, ray.direction)
            height = dot(plane.gradient, ray.origin) + plane.offset
            if sign(slope) == 0:
                decide.note("along" if sign(height) else "in")
                if sign(height) > 0:
                    return None
            else:
                (enters if sign(slope) < 0 else leaves).consider(-height / slope, k, decide)
        if from_within:
            # Through an edge, the next plane is met at once.
            return leaves.hit(index, max(leaves.distance, 0 * leaves.distance), True) if leaves.found else None
        if enters.found and leaves.found:
            order = sign(enters.distance - leaves.distance)
            if order > 0:
                return None
            if order == 0:
                decide.note("touched edge")
        for found, inside in ((enters, False), (leaves, True)):
            if found.found:
                side = sign(found.distance)
                if side == 0:
                    decide.note("at start")
                if side > 0:
                    if found.tied:
                        decide.note("seen edge")
                    return found.hit(index, found.distance, inside)
        return None

    def normal(self, plane: int, point: Vec) -> Vec:
        """That of the plane."""
        return self.planes[plane].gradient


@dataclass(slots=True)
class _Extreme:
    """The largest (direction 1) or smallest (-1) of some distances, and the first of the planes that have it."""

    direction: int
    found: bool = False
    distance: Number = None
    plane: int = -1
    tied: bool = False

    def consider(self, distance: Number, plane: int, decide: Decisions) -> None:
        """Take one more distance."""
        order = self.direction * decide.sign(distance - self.distance) if self.found else 1
        if order > 0:
            self.found, self.distance, self.plane, self.tied = True, distance, plane, False
        elif order == 0:
            self.tied = True

    def hit(self, index: int, distance: Number, inside: bool) -> Hit:
        """There, on the object `index`."""
        return Hit(distance, index, self.plane, inside)


@dataclass(frozen=True, slots=True)
class CsgBody:
    """An expression over leaves, and their surfaces; a hit's plane is a surface's index among all of these."""

    node: Node
    surfaces: list[Surface]

    def intersect(self, index: int, ray: Ray, decide: Decisions) -> Hit | None:
        """Where the ray enters the whole, or leaves it."""
        along = [surface.along(ray.origin, ray.direction) for surface in self.surfaces]
        if ray.object != index and any(decide.sign(c) == 0 for _, _, c in along):
            decide.note("at start")
        if any(decide.sign(a) == decide.sign(b) == 0 for a, b, _ in along):
            decide.note("along")
        met = first_met(self.node, along, decide, ray.inside if ray.object == index else None)
        if met is None:
            return None
        if met.tied:
            decide.note("seen edge")
        return Hit(met.distance, index, met.surface, met.inside)

    def normal(self, plane: int, point: Vec) -> Vec:
        """That of the surface."""
        return self.surfaces[plane].normal(plane, point)
