"""Two ray trees of the same pixel laid side by side, as the renderers' `trace_pixel` gives them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Any

from converter.renderers.records import HitRecord, LightRecord, RayRecord

TOLERANCE = 1e-4
"""Lengths may differ by this share of the distances about, directions and colours by this much: more than float32
rounds away on its way through a scene, and much less than a pixel's 1/255."""


@dataclass(frozen=True, slots=True)
class Unequal:
    """Something that is not the same in both trees: what, and what it is in each (None: not there)."""

    what: str
    reference: Any
    test: Any


@dataclass(slots=True)
class Pair:
    """The same ray in both trees; None in a tree where it is missing."""

    reference: RayRecord | None
    test: RayRecord | None
    unequal: list[Unequal] = field(default_factory=list)
    children: list["Pair"] = field(default_factory=list)

    @property
    def either(self) -> RayRecord:
        """The ray, from the reference's tree if it is there."""
        ray = self.test if self.reference is None else self.reference
        assert ray is not None, "a pair has at least one ray"
        return ray


def pair_trees(reference: Sequence[RayRecord], test: Sequence[RayRecord]) -> list[Pair]:
    """Pair the primary rays of a pixel in their order, and what follows from them by its kind."""
    return [_pair(one, other) for one, other in zip_longest(reference, test)]


def walk(pairs: Sequence[Pair]) -> Iterator[Pair]:
    """Every pair, each before its children."""
    for pair in pairs:
        yield pair
        yield from walk(pair.children)


def first_unequal(pairs: Sequence[Pair]) -> Pair | None:
    """The first pair that differs. What a ray inherits from its children does not count: they differ themselves."""
    return next((pair for pair in walk(pairs) if pair.unequal), None)


def _pair(reference: RayRecord | None, test: RayRecord | None) -> Pair:
    pair = Pair(reference, test)
    if reference is None or test is None:
        pair.unequal.append(Unequal("traced", *(None if ray is None else "yes" for ray in (reference, test))))
    else:
        pair.unequal += _ray_differences(reference, test)
    children = [{child.kind: child for child in ray.children} if ray else {} for ray in (reference, test)]
    pair.children = [
        _pair(children[0].get(kind), children[1].get(kind))
        for kind in ("reflected", "transmitted")
        if kind in children[0] or kind in children[1]
    ]
    return pair


def _ray_differences(reference: RayRecord, test: RayRecord) -> list[Unequal]:
    comparison = _Comparison()
    one, other = reference.hit, test.hit
    scale = max([*map(abs, reference.origin), *(hit.t for hit in (one, other) if hit)])
    comparison.near("throughput", reference.throughput, test.throughput)
    if reference.time is not None and test.time is not None:
        comparison.near("time", reference.time, test.time)
    comparison.near("origin", reference.origin, test.origin, scale)
    comparison.near("direction", reference.direction, test.direction)
    if one is None or other is None:
        comparison.same("object hit", *(hit and hit.object for hit in (one, other)))
    else:
        _compare_hits(comparison, one, other, scale)
    comparison.near("local colour", reference.local, test.local)
    for kind in ("reflected", "transmitted"):
        comparison.same(f"{kind} ray dropped", *(ray.dropped.get(kind) for ray in (reference, test)))
    return comparison.unequal


def _compare_hits(comparison: "_Comparison", reference: HitRecord, test: HitRecord, scale: float) -> None:
    comparison.same("object hit", reference.object, test.object)
    comparison.same("plane", reference.plane, test.plane)
    comparison.near("t", reference.t, test.t, scale)
    comparison.near("point", reference.point, test.point, max([scale, *map(abs, reference.point)]))
    comparison.near("normal", reference.normal, test.normal)
    comparison.same("entering", reference.entering, test.entering)
    if reference.object != test.object:
        return  # all else follows from that
    comparison.near("pigment", reference.pigment, test.pigment)
    comparison.same("total reflection", reference.total_reflection, test.total_reflection)
    lights = [{light.light: light for light in hit.lights} for hit in (reference, test)]
    for i in sorted(lights[0].keys() | lights[1].keys()):
        one, other = lights[0].get(i), lights[1].get(i)
        name = f"light {i + 1}"
        if one is None or other is None:
            comparison.same(name, *(light and "there" for light in (one, other)))
        else:
            _compare_lights(comparison, name, one, other)


def _compare_lights(comparison: "_Comparison", name: str, reference: LightRecord, test: LightRecord) -> None:
    comparison.near(f"{name}, n.l", reference.cosine, test.cosine)
    if max(reference.cosine, test.cosine) <= 0:
        return  # behind the surface: what else lies in its way does not matter
    blockers = reference.shadowed_by, test.shadowed_by
    if (blockers[0] is None) != (blockers[1] is None):  # which of several is found first is no difference
        comparison.same(f"{name}, shadowed by", *blockers)
    comparison.near(f"{name}, attenuation", reference.attenuation, test.attenuation, abs(reference.attenuation))
    comparison.near(f"{name}, diffuse", reference.diffuse, test.diffuse)
    comparison.near(f"{name}, specular", reference.specular, test.specular)


class _Comparison:
    """Collects what is unequal."""

    def __init__(self) -> None:
        self.unequal: list[Unequal] = []

    def same(self, what: str, reference: Any, test: Any) -> None:
        if reference != test:
            self.unequal.append(Unequal(what, reference, test))

    def near(self, what: str, reference: Any, test: Any, scale: float = 1.0) -> None:
        """Numbers, or rows of as many numbers."""
        pairs = [(reference, test)] if isinstance(reference, int | float) else zip(reference, test, strict=True)
        # Not `>`, which is false for NaN.
        if not all(abs(a - b) <= TOLERANCE * scale for a, b in pairs):
            self.unequal.append(Unequal(what, reference, test))
