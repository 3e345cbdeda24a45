"""Hypothesis strategies for whole scenes, every one of which the format allows."""

from collections.abc import Sequence
from dataclasses import replace
from math import hypot
from pathlib import Path
from typing import Any, TypeVar

from hypothesis import assume
from hypothesis import strategies as st

from converter.scene.model import (
    Camera,
    Checker,
    Csg,
    Finish,
    Light,
    Object,
    Operand,
    Pigment,
    Plane,
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
from converter.shapes.csg_program import program_of
from converter.shapes.quadric_form import kind_of

T = TypeVar("T")
coordinates = st.floats(-1000, 1000)
portions = st.floats(0, 1)
vectors = st.tuples(coordinates, coordinates, coordinates)
colors = st.tuples(portions, portions, portions)
directions = st.tuples(*[st.integers(-9, 9).map(float)] * 3).filter(any)
"""Vectors of lengths from 1 to 16, none nearly zero."""


def _crossed(a: Vector, b: Vector) -> float:
    return hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@st.composite
def cameras(draw: st.DrawFn) -> Camera:
    """Cameras that look somewhere, with an up vector that is not parallel to that."""
    eye = draw(vectors)
    view = draw(directions)
    up = draw(directions.filter(lambda up: _crossed(view, up) > 0.1))
    pose = eye, (eye[0] + view[0], eye[1] + view[1], eye[2] + view[2]), up
    return Camera(*pose, draw(st.floats(1, 170)))


@st.composite
def lights(draw: st.DrawFn) -> Light:
    """Lights that get no brighter with the distance."""
    attenuation = draw(st.tuples(portions, portions, portions).filter(any))
    return Light(draw(vectors), draw(colors), attenuation)


def pigments(textures: Sequence[Path] = ()) -> st.SearchStrategy[Pigment]:
    """Pigments; texmaps only of the given files."""
    kinds: list[st.SearchStrategy[Pigment]] = [
        st.builds(Solid, colors),
        st.builds(Checker, colors, colors, st.floats(0.01, 100)),
    ]
    if textures:
        four = st.tuples(*[st.floats(-10, 10)] * 4)
        kinds.append(st.builds(Texmap, st.sampled_from(list(textures)), four, four))
    return st.one_of(kinds)


@st.composite
def finishes(draw: st.DrawFn) -> Finish:
    """Finishes, some of which reflect, some of which transmit; `ior` is good in either reading."""
    ka, kd, ks = draw(colors)
    kr = draw(st.one_of(st.just(0.0), portions))
    kt = draw(st.one_of(st.just(0.0), portions))
    ior = draw(st.floats(0.3, 3)) if kt > 0 else draw(st.one_of(st.just(0.0), st.floats(0.3, 3)))
    return Finish(ka, kd, ks, draw(st.floats(0, 2000)), kr, kt, ior)


@st.composite
def polyhedra(draw: st.DrawFn, most_planes: int = 8) -> Polyhedron:
    """Polyhedra that hold at least a small ball, many of them without bounds."""
    center = draw(vectors)
    planes: list[Plane] = []
    for _ in range(draw(st.integers(1, most_planes))):
        a, b, c = draw(directions)
        distance = draw(st.floats(0.1, 100)) * hypot(a, b, c)
        planes.append((a, b, c, -(a * center[0] + b * center[1] + c * center[2]) - distance))
    return Polyhedron(tuple(planes))


@st.composite
def quadrics(draw: st.DrawFn) -> Quadric:
    """Quadrics of every kind that has a surface."""
    few = st.integers(-4, 4).map(float)
    a, b, c, d, e, f = draw(st.tuples(*[few] * 6))
    g, h, i, j = draw(st.one_of(st.tuples(*[few] * 4), st.tuples(*[coordinates] * 4)))
    shape = Quadric((a, b, c, d, e, f, g, h, i, j))
    assume(kind_of(shape).name)
    return shape


def primitives() -> st.SearchStrategy[Primitive]:
    """Of every kind."""
    return st.one_of(st.builds(Sphere, vectors, st.floats(0.01, 1000)), polyhedra(), quadrics())


@st.composite
def csgs(draw: st.DrawFn, levels: int = 3) -> Csg:
    """Csgs, of which some are nothing."""
    inner = primitives() if levels == 1 else st.one_of(primitives(), csgs(levels - 1))
    others = st.builds(Operand, st.sampled_from("+-&"), inner)
    return Csg((Operand("+", draw(inner)), *draw(st.lists(others, max_size=3))))


def shapes() -> st.SearchStrategy[Shape]:
    """Of every kind, all of them something."""
    return st.one_of(primitives(), csgs().filter(lambda shape: bool(program_of(shape).code)))


@st.composite
def with_effects(draw: st.DrawFn, scene: Scene) -> Scene:
    """The scene with some of the optional numbers, of which some are 0."""
    sizes = st.one_of(st.just(0.0), st.floats(1e-300, 1000))

    def perhaps(part: T, **numbers: st.SearchStrategy[Any]) -> T:
        return (
            replace(part, **{name: draw(number) for name, number in numbers.items()}) if draw(st.booleans()) else part
        )

    return replace(
        scene,
        camera=perhaps(scene.camera, aperture=sizes, focal=st.floats(1e-300, 1000)),
        lights=tuple(perhaps(light, radius=sizes) for light in scene.lights),
        finishes=tuple(perhaps(finish, cone=st.one_of(st.just(0.0), st.floats(0, 90))) for finish in scene.finishes),
        objects=tuple(perhaps(o, move=vectors) for o in scene.objects),
    )


@st.composite
def scenes(draw: st.DrawFn, textures: Sequence[Path] = (), file: Path | None = None, most_objects: int = 6) -> Scene:
    """Whole scenes without effects; `textures` are the files that texmaps may name, `file` the scene's own."""
    palette = draw(st.lists(pigments(textures), min_size=1, max_size=4))
    surfaces = draw(st.lists(finishes(), min_size=1, max_size=4))
    objects = st.builds(Object, st.integers(0, len(palette) - 1), st.integers(0, len(surfaces) - 1), shapes())
    return Scene(
        camera=draw(cameras()),
        ambient=draw(colors),
        lights=tuple(draw(st.lists(lights(), max_size=3))),
        pigments=tuple(palette),
        finishes=tuple(surfaces),
        objects=tuple(draw(st.lists(objects, max_size=most_objects))),
        file=file,
    )
