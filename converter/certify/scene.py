"""From a scene to that of the tracer of intervals, with what is known of it exactly: which surfaces are one, and what
lies on them.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, assert_never

import numpy as np
from numpy.typing import NDArray

from converter.analysis.coplanar import with_planes_shared
from converter.certify.numbers import exact, number, numbers
from converter.images.texture import TextureError, read_texture
from converter.renderers.base import refuse_effects
from converter.scene.model import (
    Checker,
    Csg,
    Pigment,
    Polyhedron,
    Primitive,
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

if TYPE_CHECKING:
    import certified_tracer

SPHERE, PLANE, QUADRIC = range(3)
"""Kinds of surfaces, as the tracer numbers them."""
_OPERATIONS = {"+": -1, "-": -2, "&": -3}
_ROUNDING = Fraction(1, 2**53)
"""What a number of a file may be off, relative to itself: it is rounded to a double, or somebody has rounded it."""
_BOX_MARGIN = 1e-6
"""Of its size, and of its distance from the origin, that a box is made larger by: it comes from doubles."""
_SMALLEST, _LARGEST = 1e-15, 1e15
"""Numbers for which the tracer's last rung can tell what is 0."""


def certified_scene(scene: Scene, settings: Settings, ulps: float = 0.0) -> "certified_tracer.Scene":
    """`scene` for the tracer; every number that is not whole known to so many units in the last place of a double.

    Raises:
        EffectUnavailable: the scene is sampled.
        ValueError: a texture cannot be read, or has texels that are no whole numbers of levels.

    """
    import certified_tracer

    needs = scene_needs(scene, settings)
    refuse_effects(needs, "the certifying tracer")
    scene = with_planes_shared(scene)
    used = set(needs.pigments)

    def many(values: Sequence[float]) -> list[tuple[list[float], float]]:
        return numbers(values, ulps)

    camera = scene.camera
    built = certified_tracer.Scene(
        eye=many(camera.eye),
        look_at=many(camera.look_at),
        up=many(camera.up),
        fovy=number(camera.fovy, ulps),
        ambient=many(scene.ambient),
        background=many(needs.background) if settings.background is None else numbers(needs.background),
        cutoff=number(settings.cutoff),
        max_depth=needs.max_depth,
        width=settings.width,
        height=settings.height,
        grid=math.isqrt(needs.samples),
        corner=settings.pixel == "corner",
        blinn=settings.specular == "blinn",
        ties=ulps == 0 and all(_SMALLEST < abs(x) < _LARGEST for x in _lengths(scene) if x),
    )
    for light in scene.lights:
        built.add_light(many(light.position), many(light.color), many(light.attenuation))
    for i, pigment in enumerate(scene.pigments):
        _add_pigment(built, pigment if i in used else Solid((0.0, 0.0, 0.0)), ulps)
    for finish in scene.finishes:
        values = (finish.ka, finish.kd, finish.ks, finish.alpha, finish.kr, finish.kt, finish.ior)
        built.add_finish(many(values), is_index(finish, settings.ior))
    surfaces = _Surfaces(camera.eye, tuple(light.position for light in scene.lights))
    for o, facts in zip(scene.objects, needs.facts, strict=True):
        leaves: list[Primitive] = []
        program = _program(o.shape, leaves)
        indices = [surfaces.add_leaf(built, leaf, scene.pigments[o.pigment], ulps) for leaf in leaves]
        low, high = _box(facts.low, facts.high) if facts.bounded else ((-math.inf,) * 3, (math.inf,) * 3)
        built.add_body(o.pigment, o.finish, indices, program if isinstance(o.shape, Csg) else [], low, high)
    return built


def _lengths(scene: Scene) -> Iterator[float]:
    """The numbers that distances are made of."""
    camera = scene.camera
    yield from (*camera.eye, *camera.look_at, *camera.up)
    for light in scene.lights:
        yield from light.position
    for o in scene.objects:
        leaves: list[Primitive] = []
        _program(o.shape, leaves)
        for leaf in leaves:
            for surface in _numbers_of(leaf):
                yield from surface


def _program(shape: Shape, leaves: list[Primitive]) -> list[int]:
    """Its expression in postfix order; the leaves are appended."""
    if not isinstance(shape, Csg):
        leaves.append(shape)
        return [len(leaves) - 1]
    result: list[int] = []
    for k, operand in enumerate(shape.operands):
        result += _program(operand.shape, leaves)
        if k:
            result.append(_OPERATIONS[operand.operation])
    return result


def _box(low: Vector, high: Vector) -> tuple[Sequence[float], Sequence[float]]:
    """A larger box."""
    size = max(b - a for a, b in zip(low, high, strict=True))
    margin = _BOX_MARGIN * (size + max(map(abs, (*low, *high))))
    return [x - margin for x in low], [x + margin for x in high]


def _add_pigment(built: "certified_tracer.Scene", pigment: Pigment, ulps: float) -> None:
    match pigment:
        case Solid(color):
            built.add_solid(numbers(color, ulps))
        case Checker(first, second, size):
            built.add_checker(numbers(first, ulps), numbers(second, ulps), number(size, ulps))
        case Texmap(file, p0, p1):
            texels, largest = _whole_texels(np.asarray(read_texture(file, pigment.place).texels), pigment)
            built.add_texmap(texels, largest, numbers(p0, ulps), numbers(p1, ulps))
        case _:
            assert_never(pigment)


def _whole_texels(texels: NDArray[np.float32], pigment: Texmap) -> tuple[NDArray[np.uint16], int]:
    """Texels as whole numbers, and the largest: an image's numbers before they became floats.

    Raises:
        TextureError: it has others.

    """
    for largest in (255, 65535, *range(1, 255)):
        whole = np.rint(texels.astype(np.float64) * largest)
        if (whole >= 0).all() and (whole <= largest).all() and ((whole / largest).astype(np.float32) == texels).all():
            return np.ascontiguousarray(whole.astype(np.uint16)), largest
    place = f"{pigment.place}: " if pigment.place else ""
    raise TextureError(f"{place}texture {pigment.file}: its colours are no whole numbers of levels, to be certified")


# ---- Surfaces --------------------------------------------------------------------------------------------------------


def _numbers_of(leaf: Primitive) -> list[tuple[float, ...]]:
    match leaf:
        case Sphere(center, radius):
            return [(*center, radius)]
        case Polyhedron(planes):
            return list(planes)
        case Quadric(coefficients):
            return [coefficients]
    assert_never(leaf)


@dataclass(slots=True)
class _Surfaces:
    """What is known of surfaces: of those that are one, which; and whether the eye, and the lights, lie on them."""

    eye: Vector
    lights: tuple[Vector, ...]
    known: dict[tuple[object, ...], int] = field(default_factory=dict)

    def add_leaf(self, built: "certified_tracer.Scene", leaf: Primitive, pigment: Pigment, ulps: float) -> int:
        """Add a leaf of a body with that pigment; its index."""
        kind = SPHERE if isinstance(leaf, Sphere) else PLANE if isinstance(leaf, Polyhedron) else QUADRIC
        surfaces = _numbers_of(leaf)
        return built.add_leaf(
            kind,
            [numbers(surface, ulps) for surface in surfaces],
            [self._identity(kind, surface) for surface in surfaces],
            [_lies_on(kind, surface, self.eye) for surface in surfaces],
            [[_lies_on(kind, surface, light) for light in self.lights] for surface in surfaces],
            [_layer(kind, surface, pigment) for surface in surfaces],
        )

    def _identity(self, kind: int, surface: tuple[float, ...]) -> int:
        values = tuple(map(exact, surface))
        if kind != SPHERE:
            first = next(x for x in values if x)
            values = tuple(x / first for x in values)
        return self.known.setdefault((kind, *values), len(self.known))


def _layer(kind: int, surface: tuple[float, ...], pigment: Pigment) -> tuple[int, int]:
    """Of a plane across an axis that axis, and the layer of a checker's tiles that its points lie in; -1 of others."""
    axes = [axis for axis in range(3) if surface[axis]]
    if kind != PLANE or len(axes) != 1 or not isinstance(pigment, Checker):
        return -1, 0
    axis = axes[0]
    coordinate = -exact(surface[3]) / exact(surface[axis])
    return axis, math.floor(coordinate / exact(pigment.size))


def _lies_on(kind: int, surface: tuple[float, ...], point: Vector) -> bool:
    """Whether a point lies on a surface, but for what its own numbers and the surface's may be off."""
    value, scale = _value(kind, surface, point)
    if abs(value) > 1e-12 * scale:
        return False
    true, size = _value(kind, tuple(map(exact, surface)), tuple(map(exact, point)))
    return bool(abs(true) <= _ROUNDING * size)


def _value(kind: int, surface: Sequence[Any], p: Sequence[Any]) -> tuple[Any, Any]:
    """What is 0 on a surface, and the sizes of its terms, each as often as it has factors of the file; in doubles or
    fractions.
    """
    if kind == SPHERE:
        *center, radius = surface
        arm = [(x - c) for x, c in zip(p, center, strict=True)]
        reach = sum(abs(x) + abs(c) for x, c in zip(p, center, strict=True)) + radius
        return sum(x * x for x in arm) - radius * radius, 2 * radius * reach
    if kind == PLANE:
        terms = [surface[k] * p[k] for k in range(3)]
        return sum(terms) + surface[3], 2 * sum(map(abs, terms)) + abs(surface[3])
    x, y, z = p
    squares = [x * x, y * y, z * z, x * y, x * z, y * z]
    second = [q * s for q, s in zip(surface, squares, strict=False)]
    first = [q * s for q, s in zip(surface[6:], p, strict=False)]
    size = 3 * sum(map(abs, second)) + 2 * sum(map(abs, first)) + abs(surface[9])
    return sum(second) + sum(first) + surface[9], size
