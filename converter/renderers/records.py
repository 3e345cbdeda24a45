"""What happened to the rays behind one pixel, as renderers tell it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

RayKind = Literal["primary", "reflected", "transmitted"]
Triple = tuple[float, ...]
"""Three numbers."""
MOST_RAYS = 1 << 20
"""In all the trees that are traced together."""


@dataclass(slots=True)
class LightRecord:
    """What one light adds at a hit.

    Attributes:
        light: its index, the ambient light not counted.
        cosine: n.l
        shadowed_by: index of an object in its way; None if there is none.
        attenuation: what its colour is divided by.
        diffuse, specular: linear RGB that it adds.
    """

    light: int
    cosine: float
    shadowed_by: int | None
    attenuation: float
    diffuse: Triple
    specular: Triple

    @property
    def lit(self) -> bool:
        """Whether it lights the surface."""
        return self.cosine > 0 and self.shadowed_by is None


@dataclass(slots=True)
class HitRecord:
    """What a ray hits.

    Attributes:
        object, plane: indices in the scene and, in a polyhedron (else None), of the plane.
        t: distance along the ray.
        point: where.
        normal: the outward one there, of length 1.
        entering: whether the ray meets the surface from outside.
        pigment: colour of the material there.
        total_reflection: whether the transmitted ray follows the mirror direction.
        lights: what each light adds.
    """

    object: int
    plane: int | None
    t: float
    point: Triple
    normal: Triple
    entering: bool
    pigment: Triple
    total_reflection: bool
    lights: list[LightRecord]


@dataclass(slots=True)
class RayRecord:
    """A ray, with its secondary rays.

    Attributes:
        kind: what it is to the ray before it.
        throughput: product of the kr and kt that lead to it.
        depth: bounces before it.
        origin, direction: three numbers each; the direction has length 1.
        time: from 0 to 1, of all rays of a tree; None where nothing moves.
        hit: what it hits; None if it hits nothing.
        local: its colour without that of secondary rays; the background's where nothing is hit.
        radiance: its colour with theirs, not multiplied by its own throughput.
        dropped: secondary rays that were not traced, by their kinds, and why.
        children: its secondary rays.
    """

    kind: RayKind
    throughput: float
    depth: int
    origin: Triple
    direction: Triple
    time: float | None = None
    hit: HitRecord | None = None
    local: Triple = (0.0, 0.0, 0.0)
    radiance: Triple = (0.0, 0.0, 0.0)
    dropped: dict[str, Literal["cutoff", "depth"]] = field(default_factory=dict)
    children: list["RayRecord"] = field(default_factory=list)


@dataclass(slots=True)
class PixelRecord:
    """A pixel (column `x`, row `y` from the top left corner), its colour as a picture has it, and its primary rays."""

    x: int
    y: int
    color: Triple
    rays: list[RayRecord]


def pixel_record(told: Mapping[str, Any]) -> PixelRecord:
    """What `trace_pixel` of a tracer in C++ tells, as a record."""
    return PixelRecord(told["x"], told["y"], told["color"], [_ray_record(ray) for ray in told["rays"]])


def _ray_record(told: Mapping[str, Any]) -> RayRecord:
    rest = dict(told)
    throughput, hit, children = rest.pop("weight"), rest.pop("hit"), rest.pop("children")
    if hit is not None:
        hit = HitRecord(**hit | {"lights": [LightRecord(**light) for light in hit["lights"]]})
    ray = RayRecord(throughput=throughput, hit=hit, children=list(map(_ray_record, children)), **rest)
    if "radiance" not in rest:  # not every tracer tells it
        ray.radiance = ray.local
        for child in ray.children:
            factor = child.throughput / ray.throughput
            ray.radiance = tuple(a + factor * b for a, b in zip(ray.radiance, child.radiance, strict=True))
    return ray
