"""Why pixels disagree: the ray trees behind each, and the edge that the first differing ray came too near.

Two methods disagree where a number that one of them rounds lies so near to a boundary that they decide differently:
which of two objects is met, which tile, whether a light is seen. Such a pixel is explained when the ray's margin to
that boundary, a length, is no larger than the error that the method's arithmetic excuses: what is rounded where the ray
is, and what it inherits. It inherits no more than what the two trees' rays differ by, and no more than one bounce can
have made of the error before. At a distance t, an error e_d of the direction has moved the hit by t e_d, and a surface
met at a slant spreads that over 1 / cosine; on a ball of radius r, an error e_p of the position turns the normal by
e_n = e_p / r, and with it the mirrored ray by twice as much, a refracted one, which leaves at another cosine, by
e_n + eta (e_d + e_n) / cosine. A boundary that a ray is near enough to with what it inherits only is a deep reflection.

These are first-order bounds, Igehy's ray differentials (Tracing Ray Differentials, SIGGRAPH 1999) but for the signs;
where a cosine is nearly 0, the square root of an error takes the place of its quotient.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray

from converter.compare.margins import (
    Floats,
    edge_margin,
    intersections,
    silhouette_margin,
    surface_margin,
)
from converter.compare.metrics import LIMIT, Pixels, absolute_difference
from converter.compare.rays import Pair, pair_trees
from converter.pigments.table import pigment_kind
from converter.renderers.records import HitRecord, LightRecord, PixelRecord, RayRecord, Triple
from converter.scene.geometry import simplified
from converter.scene.model import Scene, Shape
from converter.scene.needs import scene_needs
from converter.scene.settings import Settings
from converter.shapes.kind import Intersection, tie_margin
from converter.shapes.table import shape_kind

if TYPE_CHECKING:
    from converter.renderers.methods import Method
    from converter.to_mitsuba.meshes import PolyhedronMesh
    from converter.to_mitsuba.meshes.quadrics import QuadricMesh

Class = Literal[
    "silhouette",
    "checker or texel edge",
    "shadow edge",
    "critical angle",
    "deep reflection",
    "ray not followed",
    "not determined by the scene",
    "unexplained",
]
CLASSES: tuple[Class, ...] = get_args(Class)
"""What a boundary is of. A silhouette is any place where a ray comes to meet another object or another face; a ray is
not followed by a method that has another cut-off or depth, or where its weight is the cut-off itself. Whether a pixel
is determined by the scene's decimals is told by whoever asks for the reasons."""

MOST_TRACED = 256
"""Pixels that are traced at most; of more, as many evenly among them."""
BATCH = 32
"""Pixels that are traced together: those of which one has too many rays are left out."""
ROUNDINGS = 8
"""Units by which a number is off that a few operations lead to."""
SHARPEST = 2.0**-1000
"""The radius of curvature of a cone's tip, in place of 0."""
TWICE = 2
"""A ray may inherit so many times what it differs by in the two trees, since either may have crossed the boundary."""


class Arithmetic(NamedTuple):
    """What of a method's arithmetic decides about its errors, as shares of the largest number involved.

    `unit` is that of its roundings. Nothing is met nearer than `hidden` to where a ray starts, and `moved` is how far
    off the surface it starts. With `facets` normals are those of triangles whose corners are rounded.
    """

    unit: float
    hidden: float
    moved: float
    facets: bool = False


ARITHMETICS = {
    "double": Arithmetic(2.0**-52, 2.0**-47, 0.0),
    "float": Arithmetic(2.0**-23, 2.0**-18, 0.0),
    "mesh": Arithmetic(2.0**-23, 2.0**-20, 2.0**-20),
    "ulp": Arithmetic(2.0**-23, 2.0**-16, 2.0**-16, facets=True),
    "offset": Arithmetic(2.0**-23, 2.0**-10, 2.0**-13, facets=True),
}
"""By the names that `Method.arithmetic` gives them."""


Trace = Callable[[Sequence[tuple[int, int]]], list[PixelRecord]]
"""Traces pixels, as `RayTeller` has it."""


@dataclass(frozen=True, slots=True)
class Explained:
    """A disagreeing pixel.

    Attributes:
        x, y: where it is.
        kind: its class.
        ray: the kind of the first ray that differs, and `depth` its bounces; None where no ray does.
        what: what is different.
        margin: the length that the ray is from the boundary.
        error: the length that it may be off.

    """

    x: int
    y: int
    kind: Class
    ray: str | None
    depth: int
    what: str
    margin: float
    error: float


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why pixels disagree: of `disagreeing` in all those in `pixels`, which were traced."""

    disagreeing: int
    pixels: tuple[Explained, ...]

    def counts(self) -> dict[Class, int]:
        """Traced pixels by class, those without any left out."""
        found = Counter(pixel.kind for pixel in self.pixels)
        return {kind: found[kind] for kind in CLASSES if found[kind]}


def less_exact(one: "Method", other: "Method") -> str | None:
    """Whose arithmetic to measure by, a key of `ARITHMETICS`; None where one of them does not tell its rays."""
    found = [method.arithmetic for method in (one, other)]
    known = [kind for kind in found if kind is not None]
    return max(known, key=lambda kind: ARITHMETICS[kind].hidden) if len(known) == len(found) else None


def explain(
    scene: Scene,
    pictures: tuple[Pixels, Pixels],
    settings: tuple[Settings, Settings],
    traces: tuple[Trace, Trace],
    arithmetic: str,
    most: int = MOST_TRACED,
    undetermined: NDArray[np.bool_] | None = None,
) -> Explanation:
    """Classify the pixels in which two pictures of a scene disagree.

    Args:
        scene: what they show.
        pictures: that of the reference, and the other.
        settings: what they were drawn with.
        traces: what traces their pixels.
        arithmetic: the less exact of the two, a key of `ARITHMETICS`.
        most: how many pixels to trace.
        undetermined: (height, width), pixels of which is known that the scene does not determine them.

    """
    disagrees = ~(absolute_difference(*pictures) <= LIMIT).all(axis=2)
    rows, columns = np.nonzero(disagrees)
    chosen = np.linspace(0, len(rows) - 1, min(most, len(rows))).round().astype(int)
    pixels = [(int(columns[i]), int(rows[i])) for i in chosen]
    found: list[Explained] = []
    if pixels:
        explainer = _Explainer(simplified(scene), settings, arithmetic)
    for first in range(0, len(pixels), BATCH):
        batch = pixels[first : first + BATCH]
        try:
            trees = [trace(batch) for trace in traces]
        except ValueError:  # more rays than a listing can hold
            continue
        found += (
            explainer.pixel(x, y, pair_trees(one.rays, other.rays))
            for (x, y), one, other in zip(batch, *trees, strict=True)
        )
    if undetermined is not None:
        found = [replace(p, kind="not determined by the scene") if undetermined[p.y, p.x] else p for p in found]
    return Explanation(len(rows), tuple(found))


class _Error(NamedTuple):
    """How far a ray may be off: its origin, a length, and its direction, an angle."""

    origin: float
    direction: float


class _Margin(NamedTuple):
    """How far a ray is from a boundary, what of its error it inherits, and what its own roundings add."""

    margin: float
    inherited: float
    own: float

    @property
    def error(self) -> float:
        return self.inherited + self.own


class _Cause(NamedTuple):
    """A difference between two trees: the boundary, what differs, in which ray, and how much it makes in its pixel."""

    kind: Class
    what: str
    ray: RayRecord
    amount: float
    near: _Margin

    def verdict(self) -> Class:
        """Its class, if the ray came near enough, and by itself."""
        if not self.near.margin <= self.near.error:
            return "unexplained"
        return self.kind if self.near.margin <= self.near.own else "deep reflection"


class _Explainer:
    """Walks through the two trees of a pixel with the error of each ray."""

    def __init__(self, scene: Scene, settings: tuple[Settings, Settings], arithmetic: str) -> None:
        self._scene = scene
        needs = [scene_needs(scene, each) for each in settings]
        self._etas = needs[0].etas
        self._cutoff = settings[0].cutoff
        self._same_limits = len({(n.max_depth, each.cutoff) for n, each in zip(needs, settings, strict=True)}) == 1
        self._unit, self._hidden, self._moved, facets = ARITHMETICS[arithmetic]
        self._rounding = ROUNDINGS * self._unit
        self._extents = [shape_kind(o.shape).extent(o.shape) + max(map(abs, o.move)) for o in scene.objects]
        self._deviations: list[float] = [0.0] * len(scene.objects)
        self._tilts: dict[tuple[int, int | None], float] = {}
        if self._moved:
            from converter.to_mitsuba.surfaces import shapes

            for i, shape in enumerate(shapes(scene, settings[1])[0].values()):
                if shape["type"] == "mesh":
                    # Also of what is cut off far away: Embree's numbers are as large as a triangle's.
                    mesh = shape["mesh"]
                    self._deviations[i] = mesh.deviation + self._unit / 2 * float(np.abs(mesh.vertices).max())
                    if facets:
                        self._tilts |= {(i, plane): tilt for plane, tilt in _tilts(scene.objects[i].shape, mesh)}

    def pixel(self, x: int, y: int, pairs: Sequence[Pair]) -> Explained:
        """The class of a pixel: that of the difference that changes it most, or of one that nothing explains."""
        start = _Error(0.0, self._rounding)
        causes = [cause for pair in pairs for cause in self._causes(pair, start, None)]
        if not causes:
            return Explained(x, y, "unexplained", None, 0, "the rays are the same", math.inf, 0.0)
        most = max(causes, key=lambda cause: (cause.verdict() == "unexplained" and cause.amount > LIMIT, cause.amount))
        ray, near = most.ray, most.near
        return Explained(x, y, most.verdict(), ray.kind, ray.depth, most.what, near.margin, near.error)

    # ---- One ray in both trees

    def _causes(self, pair: Pair, error: _Error, start: HitRecord | None) -> Iterator[_Cause]:
        """What differs, first in a ray that starts at the hit `start`, then in what follows from it."""
        ray, other = pair.reference, pair.test
        if ray is None or other is None:
            one = pair.either
            amount = one.throughput * max(map(abs, one.radiance))
            short = abs(one.throughput - self._cutoff) if self._same_limits else 0.0
            yield _Cause("ray not followed", "a ray is traced", one, amount, _Margin(short, 0.0, self._rounding))
            return
        hits = [hit for hit in (ray.hit, other.hit) if hit is not None]
        if not hits:
            return
        error = _Error(
            min(error.origin, TWICE * math.dist(ray.origin, other.origin)),
            min(error.direction, TWICE * math.dist(ray.direction, other.direction)),
        )
        reach = inherited = error.origin + max(hit.t for hit in hits) * error.direction
        own = self._own(ray.origin, hits, start)
        if len(hits) == 1 or _side(hits[0]) != _side(hits[1]):
            near = min(self._hit_margins(ray, hits, start, inherited, own), key=_share)
            yield _Cause("silhouette", "object hit", ray, ray.throughput * _largest(ray.radiance, other.radiance), near)
            return
        hit = hits[0]
        spread = self._spread(ray, hit)
        own = spread(own)
        inherited = min(spread(inherited), TWICE * math.dist(hit.point, hits[1].point))
        if _largest(hit.pigment, hits[1].pigment) > 2**-20:
            pigment = self._scene.pigments[self._scene.objects[hit.object].pigment]
            margin = pigment_kind(pigment).edge_margin(pigment, self._at_rest(ray, hit.object, hit.point))
            near = _Margin(margin, inherited, own)
            yield _Cause(
                "checker or texel edge", "pigment", ray, ray.throughput * _largest(ray.local, other.local), near
            )
        yield from self._light_causes(ray, hits, inherited, own)
        if all(one.lit == two.lit for one, two in zip(hit.lights, hits[1].lights, strict=True)):
            # Nothing but a highlight, or light that falls off, at another place.
            lights = zip(hit.lights, hits[1].lights, strict=True)
            amount = sum(_largest(*pair) for one, two in lights for pair in _terms(one, two))
            if ray.throughput * amount > LIMIT / 4:
                near = _Margin(math.dist(hit.point, hits[1].point), spread(reach), own)
                yield _Cause("deep reflection", "light", ray, ray.throughput * amount, near)
        if hit.total_reflection != hits[1].total_reflection:
            near = self._critical_margin(ray, hit, error.direction, inherited, own)
            amount = ray.throughput * _largest(ray.radiance, other.radiance)
            yield _Cause("critical angle", "total reflection", ray, amount, near)
            return
        for child in pair.children:
            following = self._bounced(ray, hit, child.either, error.direction + self._rounding, inherited + own)
            yield from self._causes(child, following, hit)

    def _own(self, origin: Sequence[float], hits: Sequence[HitRecord], start: HitRecord | None) -> float:
        """How far the line of a ray is off the surfaces that it meets, by roundings there and by where it starts."""
        scale = max(max(map(abs, origin)) + hit.t for hit in hits)
        scale = max([scale, *(self._extents[hit.object] for hit in hits)])
        off: float = self._rounding * scale + max(self._deviations[hit.object] for hit in hits)
        return off if start is None else off + self._moved * _reach(start) + 2 * self._deviations[start.object]

    def _shape(self, index: int) -> Shape:
        return self._scene.objects[index].shape

    def _at_rest(self, ray: RayRecord, index: int, point: Sequence[float]) -> Floats:
        """A point beside an object, at the time of a ray, as that stands still."""
        return np.array(point) - (ray.time or 0.0) * np.array(self._scene.objects[index].move)

    def _hit_margins(
        self, ray: RayRecord, hits: Sequence[HitRecord], start: HitRecord | None, inherited: float, own: float
    ) -> Iterator[_Margin]:
        d = np.array(ray.direction)
        hidden = self._hidden * _reach(start) if start is not None else 0.0
        for index in {hit.object for hit in hits}:
            shape, o = self._shape(index), self._at_rest(ray, index, ray.origin)
            yield _Margin(min(silhouette_margin(shape, o, d), edge_margin(shape, o, d)), inherited, own)
            yield _Margin(
                surface_margin(shape, o, start is not None and index == start.object), inherited, own + hidden
            )
        if len(hits) == 2 and hits[0].object != hits[1].object:
            a, b = (self._intersection(ray, hit) for hit in hits)
            yield _Margin(tie_margin(a, b), inherited, own)

    def _intersection(self, ray: RayRecord, hit: HitRecord) -> Intersection:
        """Where the line of a ray meets an object about as far away as it has hit it."""
        o, d = self._at_rest(ray, hit.object, ray.origin), np.array(ray.direction)
        return min(intersections(self._shape(hit.object), o, d), key=lambda found: abs(found.t - hit.t))

    # ---- At a surface that both trees meet

    def _light_causes(
        self, ray: RayRecord, hits: Sequence[HitRecord], inherited: float, own: float
    ) -> Iterator[_Cause]:
        p = np.array(hits[0].point)
        index = hits[0].object
        for one, other in zip(hits[0].lights, hits[1].lights, strict=True):
            if one.lit == other.lit:
                continue
            to_light = np.array(self._scene.lights[one.light].position) - p
            distance = float(np.linalg.norm(to_light))
            direction = to_light / distance
            # How far the light is above the horizon of the surface, which turns with the point.
            turn = 1 + self._curvature(ray, hits[0]) * distance
            rounded = self._rounding * distance
            tilted = self._tilt(hits[0]) * distance
            margins = [_Margin(abs(one.cosine) * distance, turn * inherited, turn * own + rounded + tilted)]
            for blocker in sorted({b for b in (one.shadowed_by, other.shadowed_by) if b is not None}):
                shape, start = self._shape(blocker), self._at_rest(ray, blocker, hits[0].point)
                reach = _reach(hits[0])
                less = own + self._rounding * max(self._extents[blocker], distance) + self._deviations[blocker]
                less += self._moved * reach + 2 * self._deviations[index]
                margins.append(_Margin(silhouette_margin(shape, start, direction), inherited, less))
                near = surface_margin(shape, start, blocker == index)
                margins.append(_Margin(near, inherited, less + self._hidden * reach))
                margins += [
                    _Margin(abs((c.t - distance) * c.cosine), inherited, less + self._hidden * reach)
                    for c in intersections(shape, start, direction)
                ]
            amount = sum(_largest(*pair) for pair in _terms(one, other))
            yield _Cause("shadow edge", "light seen", ray, ray.throughput * amount, min(margins, key=_share))

    def _critical_margin(
        self, ray: RayRecord, hit: HitRecord, direction: float, inherited: float, own: float
    ) -> _Margin:
        """Of the squared cosine behind the surface, whose sign decides."""
        cosine, eta = self._refraction(ray, hit)
        turn, steep = self._curvature(ray, hit), 2 * eta * eta * cosine
        margin = abs(1 - eta * eta * (1 - cosine * cosine))
        return _Margin(margin, steep * (direction + turn * inherited), steep * turn * own + self._rounding * eta * eta)

    def _spread(self, ray: RayRecord, hit: HitRecord) -> Callable[[float], float]:
        """What an error of the ray's line makes of the position of its hit."""
        cosine = max(abs(float(np.dot(ray.direction, hit.normal))), 1e-12)
        radius = self._radius(ray, hit)
        if radius < math.inf:
            return lambda off: min(off / cosine, off + math.sqrt(2 * radius * off))
        return lambda off: off / cosine

    def _radius(self, ray: RayRecord, hit: HitRecord) -> float:
        """The smallest radius of curvature of the surface at a hit."""
        shape = self._shape(hit.object)
        return shape_kind(shape).radius_of_curvature(shape, self._at_rest(ray, hit.object, hit.point))

    def _curvature(self, ray: RayRecord, hit: HitRecord) -> float:
        """By what angle the normal turns in a unit of length."""
        return 1 / max(self._radius(ray, hit), SHARPEST)

    def _tilt(self, hit: HitRecord) -> float:
        """By what angle the normal at a hit may be off, where it is a triangle's."""
        return self._tilts.get((hit.object, hit.plane), 0.0)

    def _refraction(self, ray: RayRecord, hit: HitRecord) -> tuple[float, float]:
        """The cosine before a surface, and the index on the ray's side over that behind."""
        eta = self._etas[self._scene.objects[hit.object].finish]
        cosine = abs(float(np.dot(ray.direction, hit.normal)))
        return cosine, eta if hit.entering else 1 / eta

    def _bounced(self, ray: RayRecord, hit: HitRecord, child: RayRecord, direction: float, off: float) -> _Error:
        """The error of a ray that leaves a surface where its origin is off by `off`, one of `direction` coming in."""
        turned = self._curvature(ray, hit) * off + self._tilt(hit) + self._rounding
        off += self._moved * _reach(hit)
        if child.kind == "reflected" or hit.total_reflection:
            return _Error(off, direction + 2 * turned + self._rounding)
        _, eta = self._refraction(ray, hit)
        behind = max(abs(float(np.dot(child.direction, hit.normal))), 1e-12)
        bent = eta * (direction + turned)
        return _Error(off, min(bent / behind, math.sqrt(2 * bent)) + turned + self._rounding)


def _tilts(shape: Shape, mesh: "PolyhedronMesh | QuadricMesh") -> Iterator[tuple[int | None, float]]:
    """For each plane that has triangles the largest angle between it and one of those, made of float32 corners; for a
    surface that is none what its mesh tells.
    """
    if not hasattr(mesh, "planes"):
        yield None, mesh.tilt
        return
    corners = mesh.vertices.astype(np.float32).astype(np.float64)[mesh.triangles]
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.array([plane[:3] for plane in shape_kind(shape).planes(shape)])[mesh.planes]
    with np.errstate(invalid="ignore", divide="ignore"):
        sines = np.linalg.norm(np.cross(across, normals), axis=1)
        angles = np.arctan2(sines, np.einsum("ij,ij->i", across, normals))
    for plane in np.unique(mesh.planes):
        yield int(plane), float(angles[mesh.planes == plane].max())


def _reach(hit: HitRecord) -> float:
    """The numbers that a hit's position was made of."""
    return float(max(map(abs, hit.point)) + hit.t)


def _share(margin: _Margin) -> float:
    """A margin in errors."""
    return margin.margin / margin.error if margin.error > 0 else math.inf


def _side(hit: HitRecord) -> tuple[int, int | None, bool]:
    """Of which surface."""
    return hit.object, hit.plane, hit.entering


def _terms(one: LightRecord, other: LightRecord) -> Iterator[tuple[Triple, Triple]]:
    """What either light adds, term by term."""
    yield one.diffuse, other.diffuse
    yield one.specular, other.specular


def _largest(one: Triple, other: Triple) -> float:
    """Largest difference of two colours; infinite where it is no number."""
    difference = max(abs(a - b) for a, b in zip(one, other, strict=True))
    return difference if difference == difference else math.inf
