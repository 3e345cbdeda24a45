"""How deep rays are followed: the bound on a pixel's rays, what lies behind many panes, and what depth drops."""

import random
import re
import time
from dataclasses import replace
from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from variant import VARIANT

from converter.commands import main, raytrace
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.depth import MAX_DEPTH, MOST_RAYS, depth_limit
from converter.scene.model import Camera, Finish, Object, Polyhedron, Scene, Solid, Sphere
from converter.scene.settings import Settings
from converter.scene.writer import write_scene

BLACK, WHITE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
GLOW = Finish(1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0)
"""Shows its pigment under a white ambient light."""
RENDERERS = [NativeRenderer(), MitsubaRenderer(VARIANT)]
RENDERER = pytest.mark.parametrize("renderer", RENDERERS, ids=["native", "mitsuba"])


def passing(kr: float, kt: float, ka: float = 0.0) -> Finish:
    """A finish of glass that bends no ray."""
    return Finish(ka, 0.0, 0.0, 1.0, kr, kt, 1.0)


def panes(count: int, finish: Finish) -> Scene:
    """Panes before a red wall, seen straight on in the middle of a small picture."""
    slabs = [Polyhedron(((0.0, 0.0, -1.0, z), (0.0, 0.0, 1.0, -z - 0.25))) for z in map(float, range(count))]
    wall = Polyhedron(((0.0, 0.0, -1.0, float(count)),))
    objects = (*(Object(0, 0, slab) for slab in slabs), Object(1, 1, wall))
    view = Camera((0.0, 0.0, -5.0), BLACK, (0.0, 1.0, 0.0), 1.0)
    return Scene(view, WHITE, (), (Solid(WHITE), Solid((1.0, 0.0, 0.0))), (finish, GLOW), objects)


def corridor(kr: float, ka: float) -> Scene:
    """Two mirrors that face each other, and the camera between them."""
    walls = [Polyhedron(((0.0, 0.0, 1.0, 0.0),)), Polyhedron(((0.0, 0.0, -1.0, 20.0),))]
    view = Camera((0.0, 0.0, 10.0), BLACK, (0.0, 1.0, 0.0), 1.0)
    mirror = Finish(ka, 0.0, 0.0, 1.0, kr, 0.0, 0.0)
    return Scene(view, WHITE, (), (Solid(WHITE),), (mirror,), tuple(Object(0, 0, wall) for wall in walls))


def small(**changes) -> Settings:
    return Settings(**({"width": 3, "height": 3, "pixel": "center", "background": BLACK} | changes))


def drawn(renderer, scene: Scene, settings: Settings) -> tuple[np.ndarray, int]:
    """The picture, and in how many pixels depth dropped a ray."""
    rendering = renderer.render(scene, settings)
    return np.asarray(rendering.pixels), rendering.statistics["pixels_too_deep"]


# ---- The bound -----------------------------------------------------------------------------------------------------

coefficients = st.one_of(
    st.floats(0, 1), st.floats(0.9, 1), st.sampled_from([0.0, 1 / 512, 0.1, 0.5, 0.9, 0.999, 1.0, 1.5])
)
finishes = st.builds(passing, coefficients, coefficients)
cutoffs = st.one_of(st.sampled_from([0.0, 1 / 512]), st.floats(1e-6, 0.5))


def rays_of_one_finish(kr: float, kt: float, cutoff: float, depth: int) -> int:
    """All rays where every one meets a finish with kr and kt up to 1: by how many of each lead to it."""
    mirrored, through = [kr**n for n in range(depth + 1)], [kt**n for n in range(depth + 1)]
    weights = ((n, i, mirrored[i] * through[n - i]) for n in range(1, depth + 1) for i in range(n + 1))
    return 1 + sum(comb(n, i) for n, i, weight in weights if weight > 0 and weight >= cutoff)


@given(st.floats(0, 1), st.floats(0, 1), cutoffs)
def test_a_pixel_has_fewer_rays_than_the_bound(kr, kt, cutoff):
    limit = depth_limit([passing(kr, kt)], Settings(cutoff=cutoff))
    if limit.waiting:
        assert rays_of_one_finish(kr, kt, cutoff, min(limit.bounces, 60)) < MOST_RAYS


@pytest.mark.parametrize(
    ("kr", "kt", "cutoff"), [(0.1, 1.0, 1 / 512), (0.5, 0.9, 1e-4), (0.9, 0.1, 1e-9), (1.0, 1.0, 0.0)]
)
def test_the_bound_is_no_looser_than_it_need_be(kr, kt, cutoff):
    limit = depth_limit([passing(kr, kt)], Settings(cutoff=cutoff))
    assert limit.rule == "rays" and limit.acts
    assert rays_of_one_finish(kr, kt, cutoff, limit.bounces) < MOST_RAYS
    assert rays_of_one_finish(kr, kt, cutoff, limit.bounces + 1) > 0.9 * MOST_RAYS


@pytest.mark.parametrize(("kr", "kt"), [(0.5, 0.8), (0.3, 0.85), (0.6, 0.7)])
def test_the_bound_acts_as_soon_as_there_are_too_many_rays(kr, kt):
    few, many = 1.0, 1e-8  # cut-offs
    while few > (1 + 1e-4) * many:
        middle = (few * many) ** 0.5
        if rays_of_one_finish(kr, kt, middle, 120) < MOST_RAYS:
            few = middle
        else:
            many = middle
    assert depth_limit([passing(kr, kt)], Settings(cutoff=many)).rule == "rays"


@given(st.lists(finishes, min_size=1, max_size=4), cutoffs, st.integers(0, 2**32))
def test_trees_at_random_are_within_the_limit(many, cutoff, seed):
    """Rays meet finishes at random, and of two that follow the lighter one is followed first."""
    limit = depth_limit(many, Settings(cutoff=cutoff))
    choose = random.Random(seed).choice
    pending, count, most, deepest = [(1.0, 0)], 0, 0, 0
    while pending:
        most = max(most, len(pending) - 1)
        weight, depth = pending.pop()
        count, deepest = count + 1, max(deepest, depth)
        assert count < MOST_RAYS or not limit.waiting
        if depth < limit.bounces:
            finish = choose(many)
            weights = [weight * k for k in sorted((finish.kr, finish.kt), reverse=True)]
            pending += [(w, depth + 1) for w in weights if w > 0 and w >= cutoff]
    assert most <= limit.waiting <= 15
    if not limit.acts:
        assert limit.needed == limit.bounces


def test_depth_ends_where_the_cutoff_does():
    assert depth_limit([passing(0.1, 0.9)], Settings()).bounces == 60
    assert depth_limit([passing(0.0, 0.5)], Settings()).bounces == 9
    assert depth_limit([passing(0.0, 1.0)], Settings()).bounces == MAX_DEPTH
    assert depth_limit([passing(0.1, 0.9)], Settings(max_depth=80)).rule == "cutoff"
    assert depth_limit([passing(0.1, 0.9)], Settings(max_depth=59)).rule == "set"


def test_many_finishes_cost_little():
    many = [passing(k / 1000, 1 - k / 1000) for k in range(1000)]
    started = time.process_time()
    assert depth_limit(many, Settings()).bounces >= 100
    assert time.process_time() - started < 5


# ---- What lies behind ----------------------------------------------------------------------------------------------


def through_panes(count: int, finish: Finish, cutoff: float) -> float:
    """Red of the wall, and of the faces before it, that a straight ray sees: the tree along a line."""
    total, pending = 0.0, [(0, 1, 1.0)]  # the face it meets, its direction, its weight
    while pending:
        face, way, weight = pending.pop()
        if face == 2 * count:
            total += weight
        elif face >= 0:
            total += weight * finish.ka
            for turned, k in ((-way, finish.kr), (way, finish.kt)):
                if weight * k >= cutoff and k > 0:
                    pending.append((face + turned, turned, weight * k))
    return total


@RENDERER
@pytest.mark.parametrize("count", [9, 12])
def test_the_wall_is_seen_through_panes_of_the_courses_glass(mi, renderer, count):
    finish = passing(0.1, 0.9, 0.01)
    pixels, dropped = drawn(renderer, panes(count, finish), small())
    assert pixels[1, 1, 0] == pytest.approx(through_panes(count, finish, 1 / 512), rel=1e-6)
    assert pixels[1, 1, 0] > through_panes(count, finish, 0.9 ** (2 * count - 0.5))  # without the wall
    assert dropped == 0


@RENDERER
def test_clear_panes_change_nothing(mi, renderer):
    clear = panes(33, passing(0.0, 1.0))
    bare = replace(clear, objects=clear.objects[-1:])
    assert np.array_equal(drawn(renderer, clear, small())[0], drawn(renderer, bare, small())[0])


@RENDERER
@pytest.mark.parametrize(("kr", "dropped"), [(1.0, 9), (0.996, 9), (0.99, 0)])
def test_a_corridor_of_mirrors_is_a_thousand_deep(mi, renderer, kr, dropped):
    pixels, too_deep = drawn(renderer, corridor(kr, 2.0**-10), small())
    rays = 1001 if dropped else 622  # 0.99^621 > 1/512 > 0.99^622
    rays = next(n for n in range(1, rays + 1) if n == 1001 or kr**n < 1 / 512)
    expected = 2.0**-10 * sum(kr**n for n in range(rays))
    assert pixels[1, 1] == pytest.approx([expected] * 3, rel=1e-6)
    assert too_deep == dropped


# ---- What depth drops ----------------------------------------------------------------------------------------------

BOX = ((0.0, 0.0, -1.0), (0.0, 0.0, 1.0), (1.0, 0.4, 0.0), (-1.0, 0.2, 0.0))
MIXED = Scene(
    Camera((0.0, 0.0, 4.0), BLACK, (0.0, 1.0, 0.0), 60.0),
    WHITE,
    (),
    (Solid((0.2, 0.1, 0.05)), Solid((0.05, 0.3, 0.1))),
    (passing(0.85, 0.15, 0.1), passing(0.15, 0.85, 0.1), passing(0.5, 0.5, 0.1)),
    (
        Object(0, 0, Sphere((-1.1, 0.0, 0.0), 1.0)),
        Object(1, 1, Sphere((1.1, 0.0, 0.0), 1.0)),
        Object(0, 2, Polyhedron(tuple((*normal, d) for normal, d in zip(BOX, (-2.0, 1.5, -1.2, -1.2), strict=True)))),
    ),
)
"""Of two that follow, now the mirrored ray is the lighter one and now the other."""


@pytest.mark.parametrize("depth", [17, 20, 23, 27, 30])
@pytest.mark.parametrize(
    "scene", [MIXED, panes(9, passing(0.1, 0.9)), panes(16, passing(0.0, 1.0))], ids=["mixed", "branching", "clear"]
)
def test_renderers_agree_at_every_depth(mi, scene, depth):
    """Of their pictures, and of the pixels in which depth dropped a ray."""
    settings = small(width=24, height=18, max_depth=depth)
    (native, counted), (mitsuba, found) = (drawn(renderer, scene, settings) for renderer in RENDERERS)
    assert np.abs(native - mitsuba).max() <= 1e-6
    assert counted == found


@pytest.mark.parametrize("depth", [0, 1, 3, 8])
@pytest.mark.parametrize("samples", [1, 9])
def test_pixels_that_depth_left_incomplete_are_counted_once(mi, depth, samples):
    settings = small(width=40, height=30, max_depth=depth, samples=samples)
    counts = [drawn(renderer, MIXED, settings)[1] for renderer in RENDERERS]
    trees = [
        NativeRenderer().trace_pixel(MIXED, settings, x, y)["rays"]
        for x in range(0, settings.width)
        for y in range(0, settings.height)
    ]
    assert counts == [sum(any(map(is_too_deep, rays)) for rays in trees)] * 2
    assert 0 < counts[0] < 1200


def is_too_deep(ray) -> bool:
    return "depth" in ray["dropped"].values() or any(map(is_too_deep, ray["children"]))


@RENDERER
def test_as_many_rays_wait_as_a_user_asks_for(mi, renderer):
    """In a ball that mirrors and transmits all, the mirrored ray never leaves, and every transmitted one waits."""
    ball = replace(MIXED, finishes=(passing(1.0, 1.0, 2.0**-10),), objects=(Object(0, 0, Sphere(BLACK, 1.0)),))
    settings = small(cutoff=0.0, max_depth=100, ior="ratio")
    ball = replace(ball, pigments=(Solid(WHITE),))
    assert drawn(renderer, ball, settings)[0][1, 1, 0] == pytest.approx(101 * 2.0**-10, rel=1e-6)


# ---- What is told --------------------------------------------------------------------------------------------------


@pytest.fixture
def told(capsys, tmp_path):
    """Draws a scene by a command; what it says on stderr."""

    def run(scene: Scene, command: str, *options: str) -> str:
        file = tmp_path / "a.in"
        file.write_text(write_scene(scene))
        if command == "raytrace":
            status = raytrace.main([str(file), str(tmp_path / "a.ppm"), "8", "6"])
        else:
            out = [str(tmp_path / "a.ppm")] if command == "render" else []
            status = main.main([command, str(file), *out, "8", "6", *options])
        assert status == 0
        return capsys.readouterr().err

    return run


@pytest.mark.parametrize("method", ["native", "mitsuba"])
def test_a_limit_that_drops_rays_is_told_with_one_that_does_not(mi, told, method):
    scene = panes(9, passing(0.1, 0.9))
    warning = told(scene, "render", "--method", method, "--max-depth", "16")
    assert re.search(r"48 of 48 pixels lack rays .*, beyond 16 bounces: --max-depth 60 would do", warning)
    assert "lack rays" not in told(scene, "render", "--method", method, "--max-depth", "60")
    assert "lack rays" not in told(scene, "render", "--method", method, "--max-depth", "16", "--quiet")


def test_both_methods_of_a_comparison_are_told(mi, told):
    found = told(panes(9, passing(0.1, 0.9)), "compare", "--max-depth", "16")
    assert [name in found for name in ("warning: native: 48 of 48", "warning: mitsuba: 48 of 48")] == [True, True]


def test_a_limit_that_no_option_helps_is_told(told):
    found = told(corridor(1.0, 0.5), "raytrace")
    assert "beyond 1000 bounces: whitted render --max-depth 1000 is the most, and may not do either" in found
    assert "lack rays" not in told(corridor(0.99, 0.5), "raytrace")


def test_a_method_with_a_depth_of_its_own_is_told(told):
    found = told(panes(9, passing(0.1, 0.9)), "render", "--method", "native-depth-2")
    assert "beyond 2 bounces: more is not what native-depth-2 follows" in found
