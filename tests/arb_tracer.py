"""A scalar tracer in ball arithmetic, written from the format's rules alone: an oracle for the tracer of intervals.

A number is an `arb` of python-flint (Johansson, Arb: Efficient Arbitrary-Precision Midpoint-Radius Interval Arithmetic,
2017), which encloses what a computation without rounding would give. All have `PRECISION` bits from the beginning, so
that no surface that a ray starts on needs a rule of its own: the distance to it is a ball about 0 that is narrower than
`TIE`, and so equal to 0. A body is known by the pieces of the whole line that lie in it, before the start, too.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import cmp_to_key
from typing import NamedTuple

import numpy as np
from arb_vectors import Vec, added, cross, difference, dot, gradient, number, numbers, product, scaled, unit
from flint import arb, arb_mat, ctx

from converter.images.texture import read_texture
from converter.scene.model import Checker, Csg, Polyhedron, Primitive, Quadric, Scene, Shape, Solid, Sphere
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings

PRECISION = 1024
TIE = Fraction(1, 2**500)
"""What is nearer to 0 is a tie."""
OPERATIONS = {"+": frozenset.union, "-": frozenset.difference, "&": frozenset.intersection}


class Undecided(ArithmeticError):  # noqa: N818 - what it says
    """A number's sign is not known."""


class End(NamedTuple):
    """Where a line crosses a surface, by its index in the body, at a multiple of the line's direction."""

    t: arb
    surface: int


Span = tuple[End | None, End | None]
"""A piece of a line, from and to; None: without end."""


class Hit(NamedTuple):
    """What a ray meets first; `inside`: from within."""

    t: arb
    body: int
    surface: int
    inside: bool


class ArbTracer:
    """Traces single pixels of a scene that is not sampled, one ray each."""

    def __init__(self, scene: Scene, settings: Settings) -> None:
        ctx.prec = PRECISION
        self._tie, self._zero, self._one = number(TIE), arb(0), arb(1)
        self._scene, self._settings = scene, settings
        self._max_depth = scene_needs(scene, settings).max_depth
        self._background = numbers(scene.ambient if settings.background is None else settings.background)
        self._ambient = numbers(scene.ambient)
        self._cutoff = number(settings.cutoff)
        self._eye = numbers(scene.camera.eye)
        self._forward = unit(difference(numbers(scene.camera.look_at), self._eye))
        self._right = unit(cross(self._forward, numbers(scene.camera.up)))
        sine, cosine = (number(scene.camera.fovy) / 360).sin_cos_pi()
        self._tangent = sine / cosine
        self._lights = [(numbers(x.position), numbers(x.color), numbers(x.attenuation)) for x in scene.lights]
        self._finishes = [numbers((f.ka, f.kd, f.ks, f.alpha, f.kr, f.kt, f.ior)) for f in scene.finishes]
        self._pigments = {o.pigment: self._prepared(scene.pigments[o.pigment]) for o in scene.objects}
        self._bodies = [self._leaves(o.shape) for o in scene.objects]

    def levels(self, column: int, row: int) -> tuple[int, ...]:
        """A pixel's bytes.

        Raises:
            Undecided: they are not known.

        """
        width, height = self._settings.width, self._settings.height
        shift = Fraction(1, 2) if self._settings.pixel == "center" else 0
        x = self._tangent * number((2 * (column + shift) - width) / Fraction(height))
        y = self._tangent * number((height - 2 * (row + shift)) / Fraction(height))
        up = cross(self._right, self._forward)
        direction = unit(added(self._forward, added(scaled(self._right, x), scaled(up, y))))
        return tuple(map(self._level, self._color(self._eye, direction, self._one, 0)))

    def _level(self, channel: arb) -> int:
        """The nearest of 255 levels, halves up, also those that roundings might have left a little low."""
        level = 255 * channel.max(self._zero).min(self._one) + number(Fraction(5001, 10000))
        found = level.floor().unique_fmpz()
        if found is None:
            raise Undecided
        return int(found)

    # ---- Decisions

    def _order(self, a: arb, b: arb) -> int:
        """1, 0 or -1: a is larger, both are equal, b is larger."""
        if a > b:
            return 1
        if a < b:
            return -1
        if abs(a - b) < self._tie:
            return 0
        raise Undecided

    def _sign(self, x: arb) -> int:
        return self._order(x, self._zero)

    def _below(self, x: arb) -> tuple[int, bool]:
        """The largest whole number that is not above x, and whether x is that."""
        nearest = round(float(x.mid()))
        side = self._order(x, arb(nearest))
        return nearest - (side < 0), side == 0

    # ---- Bodies

    def _leaves(self, shape: Shape) -> "list[tuple[Primitive, tuple[arb, ...] | arb_mat, int]]":
        """Its leaves in their order, the numbers of each, and the index of its first surface."""
        found: list[tuple[Primitive, tuple[arb, ...] | arb_mat, int]] = []
        first = 0
        for leaf in primitives(shape):
            match leaf:
                case Sphere(center, radius):
                    found.append((leaf, numbers((*center, radius)), first))
                case Quadric(coefficients):
                    found.append((leaf, numbers(coefficients), first))
                case Polyhedron(planes):
                    found.append((leaf, arb_mat([list(numbers(plane)) for plane in planes]), first))
            first += len(leaf.planes) if isinstance(leaf, Polyhedron) else 1
        return found

    def _meet(self, body: int, origin: Vec, direction: Vec, within: int | None) -> Hit | None:
        """Where a ray crosses a body's surface first, beyond its start; one that goes on inside a polyhedron, or on a
        side of a csg, leaves it, at an edge perhaps at once.

        `within`: the body inside which it goes on where it starts, or of one that it is outside of `~body`.
        """
        shape = self._scene.objects[body].shape
        spans = [self._spans(*leaf, origin, direction) for leaf in self._bodies[body]]
        if isinstance(shape, Csg):
            return self._meet_csg(body, shape, spans, within)
        for span in spans[0]:
            for inside, end in zip((False, True), span, strict=True):
                if end is None:
                    continue
                side = self._sign(end.t)
                if side > 0 or (side == 0 and inside and body == within and isinstance(shape, Polyhedron)):
                    return Hit(end.t, body, end.surface, inside)
        return None

    def _meet_csg(self, body: int, shape: Csg, spans: Sequence[list[Span]], within: int | None) -> Hit | None:
        """By sets of the cells into which all crossings divide the line: cell k lies before the place k."""
        ends = [end for leaf in spans for span in leaf for end in span if end is not None]
        ends.sort(key=cmp_to_key(lambda a, b: self._order(a.t, b.t)))
        places: list[list[End]] = []
        place_of: dict[int, int] = {}
        for end in ends:
            if not places or self._order(end.t, places[-1][0].t) > 0:
                places.append([])
            places[-1].append(end)
            place_of[id(end)] = len(places) - 1

        def cells(leaf: list[Span]) -> frozenset[int]:
            first = [0 if start is None else place_of[id(start)] + 1 for start, _ in leaf]
            last = [len(places) if stop is None else place_of[id(stop)] for _, stop in leaf]
            return frozenset(k for a, b in zip(first, last, strict=True) for k in range(a, b + 1))

        remaining = iter(spans)

        def inside(shape: Shape) -> frozenset[int]:
            if not isinstance(shape, Csg):
                return cells(next(remaining))
            whole: frozenset[int] = frozenset()
            for operand in shape.operands:
                whole = OPERATIONS[operand.operation](whole, inside(operand.shape))
            return whole

        whole = inside(shape)
        for k, place in enumerate(places):
            side = self._sign(place[0].t)
            if side == 0 and within in (body, ~body) and (k + 1 in whole) != (within == body):
                crossed = [
                    end.surface
                    for sign, leaf in zip(signs(shape), spans, strict=True)
                    for span in leaf
                    for way, end in zip((-sign, sign), span, strict=True)
                    if end is not None and place_of[id(end)] == k and (way > 0) == (within == body)
                ]
                if crossed:
                    return Hit(place[0].t, body, min(crossed), within == body)
            if side > 0 and (k in whole) != (k + 1 in whole):
                return Hit(place[0].t, body, min(end.surface for end in place), k in whole)
        return None

    def _spans(self, leaf: Primitive, n: "tuple[arb, ...] | arb_mat", first: int, p: Vec, d: Vec) -> list[Span]:
        """The pieces of the line p + t d that lie in a leaf, in their order."""
        if isinstance(leaf, Polyhedron):
            return self._span_of_planes(n, first, p, d)
        if isinstance(leaf, Sphere):
            arm = difference(p, n[:3])
            a, b, c = dot(d, d), dot(arm, d), dot(arm, arm) - n[3] * n[3]
        else:
            slope = gradient(n, p)
            a = dot(d, difference(gradient(n, d), n[6:9])) / 2
            b = dot(slope, d) / 2
            c = (dot(slope, p) + dot(n[6:9], p)) / 2 + n[9]
        return self._where_negative(a, b, c, first)

    def _where_negative(self, a: arb, b: arb, c: arb, surface: int) -> list[Span]:
        """Where a t^2 + 2 b t + c is not positive, as far as that is more than a point."""
        bend = self._sign(a)
        if bend == 0:
            slope = self._sign(b)
            if slope == 0:
                return [(None, None)] if self._sign(c) <= 0 else []
            end = End(-c / (2 * b), surface)
            return [(None, end)] if slope > 0 else [(end, None)]
        discriminant = b * b - a * c
        if self._sign(discriminant) <= 0:
            return [] if bend > 0 else [(None, None)]
        root = discriminant.sqrt()
        if bend > 0:
            return [(End((-b - root) / a, surface), End((-b + root) / a, surface))]
        return [(None, End((-b + root) / a, surface)), (End((-b - root) / a, surface), None)]

    def _span_of_planes(self, planes: arb_mat, first: int, p: Vec, d: Vec) -> list[Span]:
        """From the last plane that is entered to the first that is left; of several at once the first of the file."""
        values = (planes * arb_mat([[p[0], d[0]], [p[1], d[1]], [p[2], d[2]], [self._one, self._zero]])).entries()
        enters: End | None = None
        leaves: End | None = None
        for k in range(len(values) // 2):
            height, slope = values[2 * k : 2 * k + 2]
            side = self._sign(slope)
            if side == 0:
                if self._sign(height) > 0:
                    return []
                continue
            end = End(-height / slope, first + k)
            if side < 0:
                enters = end if enters is None or self._order(end.t, enters.t) > 0 else enters
            else:
                leaves = end if leaves is None or self._order(end.t, leaves.t) < 0 else leaves
            if enters is not None and leaves is not None and self._order(enters.t, leaves.t) > 0:
                return []
        return [(enters, leaves)]

    def _normal(self, hit: Hit, point: Vec) -> Vec:
        """Of the surface, out of its leaf."""
        leaf, n, first = next(leaf for leaf in reversed(self._bodies[hit.body]) if leaf[2] <= hit.surface)
        if isinstance(leaf, Polyhedron):
            row = hit.surface - first
            return unit((n[row, 0], n[row, 1], n[row, 2]))
        return unit(difference(point, n[:3]) if isinstance(leaf, Sphere) else gradient(n, point))

    # ---- Rays

    def _nearest(self, origin: Vec, direction: Vec, within: int | None) -> Hit | None:
        """The first of the file of those at the same distance."""
        nearest: Hit | None = None
        for body in range(len(self._bodies)):
            hit = self._meet(body, origin, direction, within)
            if hit is not None and (nearest is None or self._order(hit.t, nearest.t) < 0):
                nearest = hit
        return nearest

    def _hidden(self, point: Vec, path: Vec, within: int | None) -> bool:
        """Whether a body lies between a point and the end of a path from it."""
        hits = (self._meet(body, point, path, within) for body in range(len(self._bodies)))
        return any(hit is not None and self._order(hit.t, self._one) < 0 for hit in hits)

    def _color(self, origin: Vec, direction: Vec, weight: arb, depth: int, within: int | None = None) -> Vec:
        """What is seen along a ray, which travels inside a body, or outside of that where it starts."""
        hit = self._nearest(origin, direction, within)
        if hit is None:
            return self._background
        thing = self._scene.objects[hit.body]
        ka, kd, ks, alpha, kr, kt, ior = self._finishes[thing.finish]
        point = added(origin, scaled(direction, hit.t))
        normal = self._normal(hit, point)
        if self._sign(dot(normal, direction)) > 0:
            normal = scaled(normal, arb(-1))
        side = hit.body if hit.inside else ~hit.body
        pigment = self._pigment(thing.pigment, point)
        color = product(scaled(self._ambient, ka), pigment)
        if kd > 0 or ks > 0:
            for light in self._lights:
                color = added(color, self._lit(*light, direction, point, normal, side, pigment, (kd, ks, alpha)))
        if depth == self._max_depth:
            return color
        across = dot(direction, normal)
        mirrored = difference(direction, scaled(normal, 2 * across))
        if kr > 0 and self._order(weight * kr, self._cutoff) >= 0:
            color = added(color, scaled(self._color(point, mirrored, weight * kr, depth + 1, side), kr))
        if kt > 0 and self._order(weight * kt, self._cutoff) >= 0:
            eta = 1 / ior if self._is_index(ior) != hit.inside else ior
            cosine2 = 1 - eta * eta * (1 - across * across)
            sign = self._sign(cosine2)
            through = mirrored
            if sign >= 0:
                root = cosine2.sqrt() if sign else self._zero
                through = difference(scaled(direction, eta), scaled(normal, eta * across + root))
                side = ~side
            color = added(color, scaled(self._color(point, through, weight * kt, depth + 1, side), kt))
        return color

    def _is_index(self, ior: arb) -> bool:
        """Whether an ior is n2/n1."""
        return self._settings.ior == "index" or (self._settings.ior == "auto" and bool(ior > 1))

    def _lit(
        self,
        place: Vec,
        light: Vec,
        dimming: Vec,
        direction: Vec,
        point: Vec,
        normal: Vec,
        within: int | None,
        pigment: Vec,
        finish: Vec,
    ) -> Vec:
        """What a light adds."""
        kd, ks, alpha = finish
        path = difference(place, point)
        if self._sign(dot(normal, path)) <= 0 or self._hidden(point, path, within):
            return (self._zero,) * 3
        distance = dot(path, path).sqrt()
        to_light = scaled(path, 1 / distance)
        cosine = dot(normal, to_light)
        if self._settings.specular == "blinn":
            base = dot(normal, unit(difference(to_light, direction)))
        else:
            base = dot(difference(to_light, scaled(normal, 2 * cosine)), direction)
        shine = ks * self._power(base, alpha)
        factor = tuple(kd * cosine * channel + shine for channel in pigment)
        a, b, c = dimming
        return scaled(product(factor, light), 1 / (a + b * distance + c * distance * distance))

    def _power(self, base: arb, exponent: arb) -> arb:
        """Of what is not negative, else of 0."""
        if self._sign(exponent) == 0:
            return self._one
        return base**exponent if self._sign(base) > 0 else self._zero

    # ---- Pigments

    def _prepared(self, pigment):
        match pigment:
            case Solid(color):
                return numbers(color)
            case Checker(first, second, size):
                return numbers(first), numbers(second), number(size)
        texels = np.asarray(read_texture(pigment.file).texels)
        levels = np.rint(255 * texels.astype(np.float64))
        assert ((levels / 255).astype(np.float32) == texels).all()
        return levels.astype(int), numbers(pigment.p0), numbers(pigment.p1)

    def _pigment(self, index: int, point: Vec) -> Vec:
        prepared = self._pigments[index]
        match self._scene.pigments[index]:
            case Solid():
                return prepared
            case Checker():
                first, second, size = prepared
                return second if sum(self._below(x / size)[0] for x in point) % 2 else first
        levels, *vectors = prepared
        place = []
        for vector, count in zip(vectors, (levels.shape[1], levels.shape[0]), strict=True):
            below, whole = self._below(count * (dot(vector[:3], point) + vector[3]))
            place.append((below + (below < 0 and not whole)) % count)  # toward 0
        return tuple(arb(int(level)) / 255 for level in levels[place[1], place[0]])


def primitives(shape: Shape) -> list[Primitive]:
    """A shape's leaves, in their order."""
    if not isinstance(shape, Csg):
        return [shape]
    return [leaf for operand in shape.operands for leaf in primitives(operand.shape)]


def signs(shape: Shape, sign: int = 1) -> list[int]:
    """Of each leaf: 1 where the whole can only grow if the leaf does, -1 where it can only shrink."""
    if not isinstance(shape, Csg):
        return [sign]
    return [one for x in shape.operands for one in signs(x.shape, -sign if x.operation == "-" else sign)]
