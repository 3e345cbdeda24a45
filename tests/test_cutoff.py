"""The bound on what a cut-off costs: it holds on every picture, and on some it is nearly reached."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from converter.analysis import cutoff as cutoff_module
from converter.analysis.cutoff import CutoffBound, cutoff_bound
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Checker, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere, Texmap
from converter.scene.needs import scene_needs
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

SCENES = sorted((Path(__file__).parent.parent / "scenes").glob("*.in"))
WHITE = Solid((1, 1, 1))
ROOM = Sphere((0, 0, 0), 10)
INSIDE = Camera((0, 0, 0), (0, 0, 1), (0, 1, 0), 60)


def scene_of(*objects: tuple[Finish, Sphere | Polyhedron], camera: Camera = INSIDE, **changes) -> Scene:
    """White objects under white ambient light."""
    scene = Scene(
        camera=camera,
        ambient=(1, 1, 1),
        lights=(),
        pigments=(WHITE,),
        finishes=tuple(finish for finish, _ in objects),
        objects=tuple(Object(0, k, shape) for k, (_, shape) in enumerate(objects)),
    )
    return replace(scene, **changes)


def mirror(kr: float, ka: float = 0.5) -> Finish:
    return Finish(ka, 0, 0, 1, kr, 0, 0)


def dark(*size: int, **changes) -> Settings:
    """Settings with a black background, which no wall is darker than."""
    return Settings(*size, background=(0, 0, 0), **changes)


def difference(scene: Scene, settings: Settings) -> float:
    """The largest difference that the cut-off makes; infinite where only one of the pictures has a colour.

    Where rays branch and no depth is set, the limit without a cut-off may be lower: then half the cut-off is compared.
    """
    more = replace(settings, cutoff=0)
    needs = scene_needs(scene, settings)
    if needs.branches and settings.max_depth is None:
        more = replace(settings, cutoff=settings.cutoff / 2, max_depth=needs.max_depth)
    with_cutoff, without = (np.asarray(NativeRenderer().render(scene, s).pixels, dtype=float) for s in (settings, more))
    same = (with_cutoff == without) | (np.isnan(with_cutoff) & np.isnan(without))
    differences = np.abs(np.subtract(with_cutoff, without, out=np.zeros_like(without), where=~same))
    return float(np.nan_to_num(differences, nan=np.inf).max())


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_holds_on_the_gallery(file: Path) -> None:
    scene, settings = load_scene(file), Settings(64, 48)
    bound = cutoff_bound(scene, settings)
    assert not bound.unbounded_by
    assert difference(scene, settings) <= bound.bound


# ---- Random scenes -------------------------------------------------------------------------------------------------

places = st.tuples(*[st.floats(-4, 4)] * 3)
colors = st.tuples(*[st.sampled_from([0.0, 0.3, 1.0, 1.5])] * 3)
coefficients = st.sampled_from([0.0, 0.05, 0.125, 0.3, 0.5, 0.7, 0.9, 0.99, 1.1])


@st.composite
def finishes(draw: st.DrawFn) -> Finish:
    ka, kd, ks = (draw(st.sampled_from([0.0, 0.2, 1.0])) for _ in range(3))
    return Finish(ka, kd, ks, draw(st.sampled_from([0.0, 3.0, 200.0])), draw(coefficients), draw(coefficients), 1.5)


@st.composite
def shapes(draw: st.DrawFn) -> Sphere | Polyhedron:
    x, y, z = draw(places)
    size = draw(st.floats(0.3, 3))
    if draw(st.booleans()):
        return Sphere((x, y, z), size)
    normals = [(1, 0, 0), (-1, 0, 0), (0, 2, 0), (0, -1, 0), (0.3, 0, 1), (0, 0.2, -1), (1, 1, 1)]
    count = draw(st.integers(1, len(normals)))
    return Polyhedron(
        tuple((a, b, c, -(a * x + b * y + c * z) - size * math.hypot(a, b, c)) for a, b, c in normals[:count])
    )


@st.composite
def mirror_rooms(draw: st.DrawFn) -> Scene:
    """Up to four bodies, most of the time in a closed ball with the camera, under lights that distance dims."""
    finish = finishes()
    objects = draw(st.lists(st.tuples(finish, shapes()), min_size=1, max_size=4))
    if draw(st.integers(0, 3)):
        objects.append((draw(finish), ROOM))
    attenuations = st.sampled_from([(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0.1, 0.02), (2, -0.1, 0), (0, -1, 0.1)])
    lights = draw(st.lists(st.builds(Light, places, colors, attenuations), max_size=3))
    pigments = (WHITE, Checker(draw(colors), draw(colors), 1.3))
    camera = Camera(draw(places), (0, 0, 20), (0, 1, 0), 100)
    scene = scene_of(*objects, camera=camera, lights=tuple(lights), ambient=draw(colors), pigments=pigments)
    return replace(scene, objects=tuple(replace(o, pigment=draw(st.integers(0, 1))) for o in scene.objects))


@hypothesis_settings(max_examples=60, deadline=None)
@given(mirror_rooms(), st.sampled_from([1 / 8, 1 / 64, 1 / 512]), st.sampled_from([None, 3, 9]))
def test_holds_on_random_scenes(scene: Scene, cutoff: float, max_depth: int | None) -> None:
    settings = Settings(6, 4, cutoff=cutoff, max_depth=max_depth)
    bound = cutoff_bound(scene, settings)
    assert (bound.bound == math.inf) == bool(bound.unbounded_by)
    assert difference(scene, settings) <= bound.bound


# ---- Scenes that reach it ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kr", [0.05, 0.5, 0.7, 0.95])
@pytest.mark.parametrize("cutoff", [1 / 8, 1 / 64, 1 / 512])
@pytest.mark.parametrize("max_depth", [None, 2, 40])
def test_is_reached_in_a_mirror_ball(kr: float, cutoff: float, max_depth: int | None) -> None:
    """Every ray of every bounce meets the same wall, which shines the same everywhere."""
    scene, settings = scene_of((mirror(kr), ROOM)), dark(8, 6, cutoff=cutoff, max_depth=max_depth)
    bound = cutoff_bound(scene, settings)
    measured = difference(scene, settings)
    assert measured <= bound.bound
    # Of the bound a 2^-20th of the brightest colour is for rounding.
    assert measured >= bound.bound - 2**-19 * bound.brightest


@pytest.mark.parametrize("cutoff", [1 / 8, 1 / 64])
def test_is_reached_where_rays_split(cutoff: float) -> None:
    """In a glass ball, along its wall: rays meet it beyond the critical angle for ever: both successors stay in it."""
    camera = Camera((9.5, 0, 0), (9.5, 0, 1), (0, 1, 0), 5)
    scene = scene_of((Finish(0.5, 0, 0, 1, 0.4, 0.5, 1.5), ROOM), camera=camera)
    settings = dark(4, 3, cutoff=cutoff, max_depth=12)
    bound = cutoff_bound(scene, settings)
    measured = difference(scene, settings)
    assert bound.dropped > 2 * cutoff
    assert 0.99 * bound.bound < measured <= bound.bound


def test_weight_that_is_dropped() -> None:
    """0.5^10 is the first weight below 1/512; where rays split, all of 2^3 rays of the third bounce are."""
    assert cutoff_bound(scene_of((mirror(0.5), ROOM)), Settings()).dropped == 2**-10
    split = Finish(0, 0, 0, 1, 0.25, 0.25, 1.5)
    assert cutoff_bound(scene_of((split, ROOM)), Settings(cutoff=1 / 17)).dropped == 8 * 0.25**3


def test_brightest_colour_with_a_light() -> None:
    """A light 4 from the wall of a ball, dimmed by d^2; the texture's brightest texel counts, and kr makes a series."""
    finish = Finish(0.5, 0.6, 0.2, 10, 0.5, 0, 0)
    light = Light((6, 0, 0), (3.2, 0, 0), (0, 0, 1))
    local = 0.5 + 3.2 / 16 * (0.6 + 0.2)
    bound = cutoff_bound(scene_of((finish, ROOM), lights=(light,)), dark(max_depth=20))
    assert bound.brightest == pytest.approx(local * (1 - 0.5**21) / (1 - 0.5), rel=1e-9)
    without_end = cutoff_bound(scene_of((finish, ROOM), lights=(light,)), dark(max_depth=1000))
    assert without_end.brightest == pytest.approx(local / (1 - 0.5), rel=1e-9)
    texture = Texmap(SCENES[0].parent / "rainbow1.ppm", (0, 0, 0, 0), (0, 0, 0, 0))
    textured = scene_of((mirror(0.5, ka=1), ROOM), pigments=(texture,))
    assert cutoff_bound(textured, dark(max_depth=0)).brightest == pytest.approx(0.99, abs=0.005)


# ---- No bound, no need of one --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("light", "bounded"),
    [
        (Light((10, 0, 0), (1, 1, 1), (0, 1, 0)), False),
        (Light((10, 0, 0), (1, 1, 1), (0, 0, 1)), False),
        (Light((10, 0, 0), (0, 0, 0), (0, 0, 1)), False),
        (Light((10, 0, 0), (1, 1, 1), (0.01, 0, 1)), True),
        (Light((9.9, 0, 0), (1, 1, 1), (0, 1, 0)), True),
        (Light((9.9, 0, 0), (1, 1, 1), (-1, 1, 0)), False),
        (Light((9.9, 0, 0), (1, 1, 1), (-21, 1, 0)), True),  # negative at every distance that there is
    ],
)
def test_lights_that_touch_a_surface(light: Light, bounded: bool) -> None:
    scene = scene_of((Finish(0, 1, 0, 1, 0.5, 0, 0), ROOM), lights=(light,))
    bound = cutoff_bound(scene, Settings())
    assert math.isfinite(bound.bound) == bounded
    assert bool(bound.unbounded_by) != bounded
    assert math.isfinite(bound.brightest) == bounded
    matte = replace(scene, finishes=(Finish(0, 1, 0, 1, 0, 0, 0),))
    assert cutoff_bound(matte, Settings()).bound == 0


@pytest.mark.parametrize(
    ("position", "distance"),
    [((0, 0.5, 0), 0.5), ((0, 3, 0), 2), ((0, 1, 0), 0), ((0, -7, 0), 8)],
)
def test_lights_near_a_polyhedron(position: tuple[float, float, float], distance: float) -> None:
    """The half-space below y = 1, its normal 3 long: nothing of it is nearer than the plane."""
    light = Light(position, (1, 1, 1), (0, 1, 0))
    floor = Polyhedron(((0, 3, 0, -3),))
    bound = cutoff_bound(scene_of((Finish(0, 1, 0, 1, 0, 0, 0), floor), lights=(light,)), Settings())
    assert bound.brightest == (pytest.approx(max(1, 1 / distance)) if distance else math.inf)


def test_colours_without_end() -> None:
    growing = scene_of((mirror(1e300), ROOM), (mirror(0.001), Sphere((0, 0, 3), 1)))
    bound = cutoff_bound(growing, Settings())
    assert bound.bound == math.inf
    assert bound.unbounded_by == "colours may exceed all numbers"


def test_nothing_is_dropped() -> None:
    mirrors = scene_of((mirror(1.0), ROOM))  # the depth limit is the same with and without a cut-off
    assert cutoff_bound(mirrors, Settings()).bound == 0
    assert difference(mirrors, Settings(8, 6)) == 0
    assert cutoff_bound(scene_of((mirror(0.5), ROOM)), Settings(cutoff=0)).bound == 0
    assert cutoff_bound(scene_of((mirror(0.5), ROOM)), Settings(max_depth=0)).bound == 0
    assert cutoff_bound(scene_of(), Settings()) == CutoffBound(1 / 512, 0, 0, 1)


# ---- How it is worked out ------------------------------------------------------------------------------------------


def test_a_depth_limit_that_comes_before_the_cut_off() -> None:
    """Rays of the third bounce weigh 1/8, but only two bounces are followed."""
    weights = np.array([[0.5, 0.0]])
    assert cutoff_module._worst_loss(weights, 0.01, 2, np.ones(6)) == 0.125
    assert cutoff_module._worst_loss(weights, 0.01, 2, np.array([1.0, 2, 3, 4, 5, 6])) == 0.125 * 3


def test_many_finishes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Weights taken together never make the bound smaller, and not much larger."""
    many = [Finish(0.5, 0, 0, 1, 0.9 - 0.013 * k, 0.02 + 0.001 * k, 1.5) for k in range(50)]
    few = scene_of(*((finish, ROOM) for finish in many[:3]))
    exact = cutoff_bound(few, Settings(cutoff=1 / 64, max_depth=8))
    monkeypatch.setattr(cutoff_module, "MOST_WEIGHTS", 16)
    coarse = cutoff_bound(few, Settings(cutoff=1 / 64, max_depth=8))
    assert exact.bound < coarse.bound < 2 * exact.bound
    monkeypatch.undo()
    large = cutoff_bound(scene_of(*((finish, ROOM) for finish in many)), Settings(max_depth=64))
    assert exact.bound < large.bound < math.inf
