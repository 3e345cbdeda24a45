"""Objects that move: closed forms, every sample as a scene that stands still, and whatever draws them."""

from dataclasses import replace
from functools import cache
from math import sqrt
from pathlib import Path

import numpy as np
import pytest
import sampler_specification as specification
from variant import VARIANT

from converter.analysis.notices import scene_notices
from converter.compare.classes import explain
from converter.compare.metrics import LIMIT
from converter.renderers.base import EffectUnavailable
from converter.renderers.methods import METHODS
from converter.renderers.native import NativeRenderer
from converter.scene.model import (
    Camera,
    Checker,
    Csg,
    Finish,
    Light,
    Object,
    Operand,
    Polyhedron,
    Quadric,
    Scene,
    Solid,
    Sphere,
    Texmap,
)
from converter.scene.settings import Settings
from converter.studies.exact.tracer import ExactTracer
from converter.to_mitsuba.load import load_description
from converter.to_mitsuba.scene import scene_description
from mitsuba_plugins import set_variant
from native_tracer.sampler import TIME

GLOW = Finish(1, 0, 0, 1, 0, 0, 0)
MATTE = Finish(0.1, 0.7, 0.2, 20, 0, 0, 0)
MIRROR = Finish(0.1, 0.2, 0.2, 20, 0.7, 0, 0)
GLASS = Finish(0.05, 0.1, 0.2, 30, 0.3, 0.6, 1.5)
WHITE = Solid((1, 1, 1))
POINT = Camera((0, 0, -10), (0, 0, 0), (0, 1, 0), 1e-4)
"""Of one direction: all pixels see the origin, and are independent pictures of it."""
MANY = Settings(width=24, height=16, samples=64, background=(0, 0, 0))
FEW = Settings(width=56, height=42, samples=4, seed=5, background=(0.2, 0.3, 0.4))
TEXTURE = Path(__file__).parent.parent / "scenes" / "rainbow1.ppm"


def box(low, high):
    sides = (((1, 0, 0), 0), ((0, 1, 0), 1), ((0, 0, 1), 2))
    return Polyhedron(
        tuple(p for (a, b, c), k in sides for p in ((a, b, c, -high[k]), (-a, -b, -c, low[k]))),
    )


def drawn(scene, settings=FEW, method="native"):
    return np.asarray(METHODS[method].renderer(VARIANT).render(scene, settings).pixels)


def disagreeing(one, other):
    return int((~(np.abs(one - other).max(axis=2) <= LIMIT)).sum())


# ---- Closed forms


def glowing(shape, move):
    return Scene(POINT, (1, 1, 1), (), (WHITE,), (GLOW,), (Object(0, 0, shape, move=move),))


def same_mean(made, expected):
    """Whether pixels that estimate a share of the time have it as their mean, by five deviations of the mean.

    The time's points are stratified: of 64 samples none but two, where the body comes and goes, are left to chance.
    """
    pixels = drawn(made, MANY)[..., 0].astype(float)
    deviation = pixels.std(ddof=1)
    assert abs(pixels.mean() - expected) <= 5 * deviation / sqrt(pixels.size) + 1e-6
    assert deviation <= 1 / 64


@pytest.mark.parametrize("height", [0.0, 0.5, 0.9, 1.1])
@pytest.mark.parametrize("start", [-3.0, -1.0, 0.25, 2.0])
def test_a_ball_hides_a_point_for_as_long_as_its_chord(height, start):
    half = sqrt(max(0.0, 1 - height**2))
    covered = max(0.0, min(half, start + 4) - max(-half, start)) / 4
    same_mean(glowing(Sphere((-start, height, 0), 1), (-4, 0, 0)), covered)


@pytest.mark.parametrize("way", [0.5, 1.0, 3.0, 8.0])
def test_a_boxs_edge_is_a_ramp(way):
    """It comes to the point after 0.25 units, and, a unit thick, has passed it after 1.25."""
    made = glowing(box((0.25, -1, 0), (1.25, 1, 1)), (-way, 0, 0.25))
    same_mean(made, max(0.0, min(1.0, 1.25 / way) - min(1.0, 0.25 / way)))


def test_a_shadow_moves():
    """Of a plate that leaves the light's way to the origin for a quarter of the time."""
    floor = Object(0, 0, Polyhedron(((0, 1, 0, 0),)))
    plate = Object(0, 1, box((-2, 1, -2), (1, 1.5, 2)), move=(2, 0, 0))
    light = Light((4, 4, 0), (1, 1, 1), (1, 0, 0))
    camera = replace(POINT, eye=(0, 1, -10))
    made = Scene(camera, (0, 0, 0), (light,), (WHITE,), (Finish(0, 1, 0, 1, 0, 0, 0), GLOW), (floor, plate))
    # The way meets heights 1 to 1.5, x from 1 to 1.5: the plate, which ends at 1 + 2 u, has it from the start, and
    # begins at -2 + 2 u. A plate that begins at 0 ends the shadow after half of the time, and so on.
    same_mean(made, 0.0)
    held = replace(plate, shape=box((-2, 1, -2), (0.5, 1.5, 2)))
    same_mean(replace(made, objects=(floor, held)), 0.25 * sqrt(0.5))


# ---- Every sample


def all_moving(scene, move):
    return replace(scene, objects=tuple(replace(o, move=move) for o in scene.objects))


def of_matter():
    """Four kinds of bodies that move, and some that stand still, with solid pigments and an image."""
    pigments = (Solid((0.9, 0.3, 0.2)), Solid((0.2, 0.7, 0.9)), Texmap(TEXTURE, (0.3, 0.1, 0.2, 0.1), (0, 0.5, 0.2, 0)))
    hollow = Csg((Operand("+", box((1, -1, -1), (3, 1, 1))), Operand("-", Sphere((2, 0, -1), 0.75))))
    objects = (
        Object(2, 0, Polyhedron(((0, 1, 0, 1),))),
        Object(0, 1, Sphere((-2, 0, 0), 1), move=(0.5, 0.5, -1)),
        Object(2, 0, hollow, move=(0.5, 0, -0.7)),
        Object(1, 2, Quadric((1, 2, 1, 0, 0, 0.5, 0, 0, 4, 3.5)), move=(-0.3, 0.2, 0.1)),
        Object(2, 0, box((-3, -1, 1), (-1, 2, 2)), move=(0, 0.25, 0)),
        Object(1, 1, box((2, -1, 2), (4, 2, 3))),
    )
    # The second light is on the ball at first, then in it, and beside it from time 2/3 on.
    lights = (Light((3, 6, -5), (0.7, 0.7, 0.7), (1, 0, 0)), Light((-2, 1, 0), (0.5, 0.5, 0.3), (1, 0.05, 0)))
    camera = Camera((0.5, 1.5, -8), (0, 0, 0), (0.1, 1, 0), 45)
    return Scene(camera, (0.3, 0.3, 0.3), lights, pigments, (MATTE, MIRROR, GLASS), objects)


def times(settings):
    """The time of each sample of each pixel."""
    row, column, k = (a.ravel() for a in np.indices((settings.height, settings.width, settings.samples)))
    x = specification.sample_points(settings.seed, column, row, k, 1, TIME)[:, 0]
    return ((x.astype(float) + 0.5) / 2**32).reshape(settings.height, settings.width, settings.samples)


def stopped(scene, u):
    """The scene as it is at a time, standing still."""
    objects, pigments = [], []
    for i, o in enumerate(scene.objects):
        by = tuple(u * x for x in o.move)
        objects.append(replace(o, pigment=i, shape=moved(o.shape, by), move=(0.0, 0.0, 0.0)))
        pigments.append(taken_along(scene.pigments[o.pigment], by))
    return replace(scene, objects=tuple(objects), pigments=tuple(pigments))


def taken_along(pigment, by):
    if isinstance(pigment, Solid) or not any(by):
        return pigment
    p0, p1 = ((*p[:3], float(p[3] - np.dot(p[:3], by))) for p in (pigment.p0, pigment.p1))
    return replace(pigment, p0=p0, p1=p1)


def moved(shape, by):
    x, y, z = by
    if isinstance(shape, Sphere):
        return replace(shape, center=tuple(np.add(shape.center, by).tolist()))
    if isinstance(shape, Polyhedron):
        return Polyhedron(tuple((a, b, c, d - (a * x + b * y + c * z)) for a, b, c, d in shape.planes))
    if isinstance(shape, Csg):
        return Csg(tuple(replace(operand, shape=moved(operand.shape, by)) for operand in shape.operands))
    a, b, c, d, e, f, g, h, i, j = shape.coefficients
    turned = np.array([[2 * a, d, e], [d, 2 * b, f], [e, f, 2 * c]])
    linear = np.array([g, h, i])
    numbers = *(linear - turned @ by), j - linear @ by + np.array(by) @ turned @ by / 2
    return Quadric((a, b, c, d, e, f, *map(float, numbers)))


@pytest.mark.parametrize(
    ("name", "precision"),
    [("of_matter", "double"), ("of_matter", "long double"), ("of_matter", "float"), ("from_within", "double")],
)
def test_every_sample_is_a_picture_that_stands_still(name, precision):
    """The whole tree of a ray, in mirrors and glass, with its shadows, is that of the scene stopped at its time."""
    renderer = NativeRenderer(precision)
    scene, at = SCENES[name](), times(FEW)
    places = [(x, y) for y in range(5, 40, 8) for x in range(4, 54, 9)]
    found = renderer.trace_pixels(scene, FEW, places)
    wrong = 0
    for record, (x, y) in zip(found, places, strict=True):
        for k, ray in enumerate(record.rays):
            assert ray.time == pytest.approx(at[y, x, k], abs=1e-6 if precision == "float" else 1e-15)
            still = renderer.trace_pixel(stopped(scene, ray.time), FEW, x, y).rays[k]
            wrong += ray.radiance != pytest.approx(still.radiance, abs=3e-4 if precision == "float" else 1e-6)
    assert wrong <= (5 if precision == "float" else 0)


# ---- Whatever draws it


def tiles():
    """Bodies with edges and tiles at round numbers, one of which slides on the floor, and a csg of moved tiles."""
    pigments = (Checker((1, 1, 1), (0.1, 0.2, 0.1), 0.5), Checker((0.9, 0.8, 0.2), (0.2, 0.1, 0.5), 1.0))
    stairs = Csg((Operand("+", box((2, -1, -1), (4, 0, 1))), Operand("+", box((3, 0, -1), (4, 1, 1)))))
    objects = (
        Object(0, 0, Polyhedron(((0, 1, 0, 1),))),
        Object(1, 0, box((-3, -1, -1), (-1, 1, 1)), move=(1, 0, 0)),
        Object(1, 0, box((-3, 1, -1), (-1, 2, 1)), move=(1, 0, 0)),  # on the one before
        Object(0, 1, stairs, move=(0, 0, -0.5)),
        Object(0, 2, Sphere((0.5, 0, -2), 1), move=(0.5, 0.5, 0)),
    )
    return replace(of_matter(), pigments=pigments, objects=objects)


def crowd(count=60):
    """Many bodies, which move every way."""
    random = np.random.default_rng(3)
    made = of_matter()
    more = []
    for i in range(count):
        x, y, z = random.uniform((-6, -1, -3), (6, 4, 8)).tolist()
        size = float(random.uniform(0.2, 0.7))
        shape = Sphere((x, y, z), size) if i % 3 else box((x, y, z), (x + size, y + size, z + size))
        more.append(Object(i % 3, i % 3, shape, move=tuple(random.uniform(-1, 1, 3).tolist()) if i % 4 else (0, 0, 0)))
    return replace(made, objects=made.objects + tuple(more))


def from_within():
    """The eye on a glass ball that moves over it, and a light in a box that moves; another light has a radius."""
    made = of_matter()
    around = Object(1, 2, Sphere((0.5, 1.5, -6), 2), move=(0.5, 0, -1))
    case = Operand("+", box((2, 5, -6), (4, 7, -4))), Operand("-", box((2.5, 4, -5.5), (3.5, 6.5, -4.5)))
    lantern = Object(0, 0, Csg(case), move=(0.3, 0, 0))
    lights = (made.lights[0], replace(made.lights[1], radius=0.5))
    return replace(made, objects=(*made.objects, around, lantern), lights=lights)


SCENES = {"of_matter": of_matter, "tiles": tiles, "crowd": crowd, "from_within": from_within}


@pytest.mark.parametrize("name", SCENES)
def test_nothing_depends_on_threads_or_search_and_little_on_precision(name):
    scene, settings = SCENES[name](), replace(FEW, width=70, height=50)
    first = drawn(scene, settings)
    assert drawn(scene, replace(settings, threads=1)).tobytes() == first.tobytes()
    for search in ("brute", "bvh"):
        assert np.asarray(NativeRenderer(search=search).render(scene, settings).pixels).tobytes() == first.tobytes()
    exact = np.asarray(NativeRenderer("long double").render(scene, settings).pixels)
    assert disagreeing(exact, first) == 0
    assert np.median(np.abs(exact - first)) < 1e-7
    assert drawn(scene, replace(settings, seed=6)).tobytes() != first.tobytes()


@pytest.mark.parametrize(
    "shape", [Polyhedron(((0, 1, 0, 1),)), Quadric((1, 0, 1, 0, 0, 0, 0, -1, 0, -1)), Sphere((0, 0, 0), 1)]
)
def test_what_moves_without_bounds_is_searched_for(shape):
    """A floor, a bowl, and a ball that moves beyond all numbers."""
    way = (0.0, 1e308, 0.0) if isinstance(shape, Sphere) else (0.5, -1.0, 0.25)
    made = crowd(12)
    made = replace(made, objects=(*made.objects, Object(0, 0, shape, move=way), Object(1, 1, shape, move=way)))
    brute, tree = (np.asarray(NativeRenderer(search=search).render(made, FEW).pixels) for search in ("brute", "bvh"))
    assert brute.tobytes() == tree.tobytes()


@pytest.mark.parametrize(
    ("name", "way", "samples"),
    [
        ("tiles", "analytic", 1),
        ("tiles", "bvh", 16),
        ("from_within", "analytic", 4),
        ("crowd", "bvh", 4),
    ],
)
def test_both_renderers_draw_the_same_noise(name, way, samples):
    scene, settings = SCENES[name](), replace(FEW, samples=samples)
    native, mitsuba = drawn(scene, settings), drawn(scene, settings, f"mitsuba-{way}")
    assert disagreeing(native, mitsuba) == 0
    assert np.median(np.abs(native - mitsuba)) < 1e-6


@pytest.mark.parametrize("instructions", ["baseline", "avx2", "avx512"])
@pytest.mark.parametrize("precision", ["double", "float"])
def test_bytes_do_not_depend_on_the_instruction_set(precision, instructions):
    import native_tracer
    from converter.renderers.native import build_scene
    from converter.scene.needs import scene_needs

    scene = tiles()
    images = [native_tracer.Image(70, 50) for _ in range(2)]
    for image, chosen in zip(images, ("", instructions), strict=True):
        try:
            options = {"cutoff": 1 / 512, "max_depth": 5, "samples": 4, "seed": 3, "precision": precision}
            native_tracer.render(build_scene(scene, scene_needs(scene, FEW)), image, instructions=chosen, **options)
        except ValueError:
            pytest.skip(f"this processor has no {chosen}")
    assert bytes(images[0].pixels) == bytes(images[1].pixels)


# ---- Ties of what moves

CLEAR = Finish(0.2, 0, 0, 1, 0, 0.7, 1)
"""Bends nothing, and adds a little at every surface."""
HALVES = Csg((Operand("+", box((1, -1, -1), (2, 1, 1))), Operand("+", box((2, -1, -1), (3, 1, 1)))))
TWINS = {
    "ball and quadric": (Sphere((-2, 0, 0), 1), Quadric((1, 1, 1, 0, 0, 0, 4, 0, 0, 3))),
    "box and csg": (box((1, -1, -1), (3, 1, 1)), HALVES),
}


@pytest.mark.parametrize("method", ["native", "native-bvh", "native-long-double", "mitsuba-analytic"])
@pytest.mark.parametrize("name", TWINS)
def test_of_bodies_that_move_as_one_only_the_first_is_seen(name, method):
    """Its distances, and those of the other, are rounded apart."""
    ground = Object(0, 0, Polyhedron(((0, 1, 0, 1),)))
    for pair in (TWINS[name], TWINS[name][::-1]):
        first, second = (Object(k, 0, shape, move=(0.5, 0.25, -1)) for k, shape in enumerate(pair))
        made = replace(of_matter(), objects=(ground, first, second))
        alone = drawn(replace(made, objects=(ground, first)))
        assert disagreeing(drawn(made, FEW, method), alone) == 0
        assert disagreeing(drawn(replace(made, objects=(ground, second))), alone) > 100


def facing(*bodies):
    """Bodies of glass, each with its displacement, and tiles behind them."""
    pigments = tuple(map(Solid, ((0.9, 0.2, 0.1), (0.1, 0.8, 0.2), (0.1, 0.2, 0.9))))[: len(bodies)]
    wall = Object(len(bodies), 0, Polyhedron(((0, 0, 1, 4),)))
    objects = (*(Object(i, 1, shape, move=move) for i, (shape, move) in enumerate(bodies)), wall)
    camera = Camera((0.5, 1.25, 6), (0, 0, 0), (0, 1, 0), 40)
    tiles = Checker((1, 1, 1), (0.1, 0.1, 0.1), 0.5)
    return Scene(camera, (1, 1, 1), (), (*pigments, tiles), (GLOW, CLEAR), objects)


def wedge():
    """Its edge is before the eye, one of its sides in light; the distances to both are rounded apart."""
    sides = Polyhedron(((-3, 0, 4, 8), (1, 0, 2, 4), (0, 0, -1, -9)))
    camera = Camera((0, 0.1, 0.3), (0, 0.1, -0.7), (0, 1, 0), 90)
    light = Light((9, 0.5, 0.7), (1, 1, 1), (1, 0, 0))
    return Scene(camera, (1, 1, 1), (light,), (WHITE,), (MATTE,), (Object(0, 0, sides),))


TIED = {
    "moving as one": facing(
        (box((-1, -1, -1), (1, 1, 0)), (0.5, 0, 0.25)), (box((0, -1, -2), (2, 1.5, 0)), (0.5, 0, 0.25))
    ),
    "sliding apart": facing(
        (box((0, -1, -2), (2, 1.5, 0)), (-0.5, 0.5, 0)), (box((-1, -1, -1), (1, 1, 0)), (0.5, 0.25, 0))
    ),
    "beside one that stands": facing(
        (box((-1, -1, -1), (1, 1, 0)), (0.5, 0.25, 0)), (box((0, -1, -2), (2, 1.5, 0)), (0, 0, 0))
    ),
    "stacked": facing(*((box((x, -1, -1), (x + 1, 1, 1)), (0.5, -0.25, 0.25)) for x in (-1, 0, 1))),
    "one on the other": facing(
        (box((-1, -1, -1), (1, 0, 1)), (0.5, 0, 0.25)), (box((-1, 0, -1), (1, 1, 1)), (-0.5, 0, 0))
    ),
    "along an edge": all_moving(wedge(), (0, 0.5, 0)),
}


@cache
def truth(name):
    """Of one ray a pixel, of the scene stopped at its time."""
    made, settings = TIED[name], replace(FEW, width=12, height=8, samples=1)
    pixels = [
        [ExactTracer(stopped(made, float(time)), settings).pixel(x, y).color for x, time in enumerate(row)]
        for y, row in enumerate(times(settings)[..., 0])
    ]
    return settings, np.array(pixels)


@pytest.mark.parametrize("method", ["native", "native-bvh", "native-long-double", "mitsuba-analytic"])
@pytest.mark.parametrize("name", TIED)
def test_ties_are_decided_by_the_rules_while_bodies_move(name, method):
    settings, expected = truth(name)
    assert disagreeing(drawn(TIED[name], settings, method), expected) == 0


def test_no_displacement_is_the_plain_scene_to_the_last_bit():
    made = replace(of_matter(), lights=of_matter().lights[:1])  # of which none lies on what moves
    still = [all_moving(made, (zero, zero, zero)) for zero in (0.0, -0.0)]
    assert len({drawn(scene, replace(FEW, seed=seed)).tobytes() for seed, scene in enumerate(still)}) == 1
    assert disagreeing(drawn(all_moving(made, (1e-9, 0, 0))), drawn(still[0])) == 0
    assert "move" not in scene_description(still[1], FEW, with_shapes=False)["integrator"]["geometry"]


# ---- What slides in itself


FLOOR = Polyhedron(((0, 2, 0, 2),))


def sliding(move, floor=FLOOR, eye=(0.5, 1.5, -8), light=(2, -1, 1)):
    """A floor of one colour, with a light on it, and a ball above."""
    objects = (Object(0, 0, floor, move=move), Object(0, 1, Sphere((0, 1, 1), 1)))
    lights = (Light(light, (1, 1, 1), (1, 0, 0)), Light((-3, 6, -3), (0.5, 0.5, 0.5), (1, 0, 0)))
    return Scene(Camera(eye, (0, 0.25, 0), (0, 1, 0), 50), (0.2, 0.2, 0.2), lights, (WHITE,), (MATTE, MIRROR), objects)


TWO_SLABS = Csg(tuple(Operand("+", box((-400, low, -300), (500, low + 2, 600))) for low in (-5, -3)))
SLIDING = {
    "two slabs": {"move": (3, 0, 1), "floor": TWO_SLABS},
    "floor": {"move": (3, 0, 1)},
    "light beside its face": {"move": (3, 0, 1), "floor": box((-400, -3, -300), (500, -1, 600)), "light": (900, -1, 1)},
    "slope": {"move": (0.8, -0.6, 0.3), "floor": Polyhedron(((0.6, 0.8, 0, 1.1),)), "light": (0.7, -1.9, 0.1)},
    "eye on the floor": {"move": (3, 0, 1), "eye": (0.5, -1, -8)},
    "pipe": {
        "move": (0, 0, 3),
        "floor": Quadric((-1, -1, 0, 0, 0, 0, 0, 0, 0, 4)),
        "light": (0, -2, 1),
        "eye": (0, 0, -9),
    },
}


@pytest.mark.parametrize(
    ("name", "method"),
    [*((name, "native") for name in SLIDING), *((name, "mitsuba-analytic") for name in SLIDING if name != "two slabs")],
)
def test_what_slides_in_itself_is_still(name, method):
    """A light, or an eye, lies on it as if it stood still."""
    made = sliding(**SLIDING[name])
    still = all_moving(made, (0.0, 0.0, 0.0))
    pixels, plain = drawn(made, FEW, method), drawn(still, FEW)
    assert np.ptp(plain) > 0.2
    assert disagreeing(pixels, plain) == 0
    assert np.abs(pixels - plain).max() < 1e-6


# ---- What is told


@pytest.mark.parametrize("method", ["native", "mitsuba-analytic"])
def test_a_pixels_rays_have_its_colour_and_time(method):
    scene, renderer = tiles(), METHODS[method].renderer(VARIANT)
    pixels = drawn(scene, FEW)
    places = [(13, 20), (20, 22), (28, 24)]
    for record, (x, y) in zip(renderer.trace_pixels(scene, FEW, places), places, strict=True):
        assert record.color == pytest.approx(pixels[y, x], abs=1e-6)
        for ray, time in zip(record.rays, times(FEW)[y, x], strict=True):
            assert {each.time for each in family(ray)} == {ray.time}
            assert ray.time == pytest.approx(time, abs=1e-15)


def family(ray):
    yield ray
    for child in ray.children:
        yield from family(child)


def test_rays_of_a_scene_that_stands_still_have_no_time():
    still = replace(of_matter(), objects=of_matter().objects[:1])
    for method in ("native", "mitsuba-analytic"):
        record = METHODS[method].renderer(VARIANT).trace_pixel(still, FEW, 28, 40)
        assert [ray.time for ray in record.rays] == [None] * 4


def test_disagreements_with_single_precision_are_explained():
    ball = Object(0, 0, Sphere((0, 0, 0), 2.5), move=(0.5, 0.3, 0.7))
    scene = replace(tiles(), pigments=(Checker((1, 1, 1), (0, 0, 0), 0.003),), objects=(ball,))
    settings = replace(FEW, width=400, height=300)
    renderers = NativeRenderer(), NativeRenderer("float")
    pictures = tuple(np.asarray(each.render(scene, settings).pixels) for each in renderers)
    traces = tuple(lambda pixels, each=each: each.trace_pixels(scene, settings, pixels) for each in renderers)
    found = explain(scene, pictures, (settings, settings), traces, "float", most=40)
    assert found.disagreeing > 10
    assert "unexplained" not in found.counts()


@pytest.mark.parametrize("method", ["mitsuba-mesh", "mitsuba-offset", "mitsuba-ulp"])
def test_shapes_of_mitsuba_do_not_move(method):
    with pytest.raises(EffectUnavailable, match=r"object 1 moves, and .*own shapes.*: native, mitsuba-analytic and"):
        drawn(of_matter(), FEW, method)


def test_the_integrator_knows_that_shapes_of_mitsuba_do_not_move():
    made = scene_description(tiles(), FEW, with_shapes=False)
    made["integrator"]["intersections"] = "mesh"
    set_variant(VARIANT)
    with pytest.raises(Exception, match="'geometry' moves objects, and the shapes of 'mesh' stand still"):
        load_description(made)


def test_a_body_that_comes_into_view_and_leaves_the_camera_is_no_oddity():
    far = replace(glowing(Sphere((100, 0, 0), 1), (-100, 0, 0)), camera=replace(POINT, fovy=40))
    around = Object(0, 0, Sphere((0, 0, -10), 50), move=(200, 0, 0))
    for scene in (far, replace(far, objects=(*far.objects, around))):
        assert scene_notices(scene, replace(FEW, samples=4)) == []
    assert any("sees no object" in notice for notice in scene_notices(all_moving(far, (0.0, 0.0, 0.0)), FEW))
