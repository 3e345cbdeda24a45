"""Searching by a tree draws what searching one by one draws, byte for byte, in every precision, on every processor.

Objects that coincide, touch, or are grazed by rays are where a tree that loses a hit would show it.
"""

import math
import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from native_scenes import (
    BLACK,
    CONSTANT,
    PRECISIONS,
    WHITE,
    add_finish,
    box,
    dot,
    draw,
    gallery,
    look,
    new_scene,
    normalized,
    trace_ray,
)

import native_tracer
from converter.renderers.native import NativeRenderer
from converter.scene.parser import load_scene
from converter.scene.settings import Settings

SCENES = sorted((Path(__file__).parent.parent / "scenes").glob("*.in"))


def available_instructions():
    names = []
    for name in ("baseline", "avx2", "avx512"):
        try:
            draw(new_scene(), 1, 1, instructions=name)
        except ValueError:
            continue
        names.append(name)
    return names


INSTRUCTIONS = available_instructions()


def check(scene, width=48, height=36, precisions=PRECISIONS, **options):
    """Draw the scene either way in all precisions with all instruction sets; returns the rays traced in double."""
    rays = 0
    for precision in precisions:
        for instructions in INSTRUCTIONS:
            common = {"precision": precision, "instructions": instructions, **options}
            brute, tree = (draw(scene, width, height, search=s, **common) for s in ("brute", "bvh"))
            statistics = [{**image.statistics, "search": None} for image in (brute, tree)]
            assert statistics[0] == statistics[1]
            assert bytes(brute.pixels) == bytes(tree.pixels)
            if precision == "double":
                rays = sum(statistics[0][kind] for kind in ("primary", "reflected", "transmitted", "shadow"))
    return rays


def finishes(scene):
    """Matte, shiny, a mirror, and glass."""
    return [
        add_finish(scene, ka=0.3, kd=0.6),
        add_finish(scene, ka=0.2, kd=0.5, ks=0.4, alpha=60, kr=0.25),
        add_finish(scene, ka=0.05, kd=0.05, kr=0.9),
        add_finish(scene, ka=0.02, kr=0.15, kt=0.8, eta=1 / 1.5),
    ]


def turned(normals, rng):
    """The vectors, turned at random."""
    x = normalized([rng.gauss(0, 1) for _ in range(3)])
    y = [rng.gauss(0, 1) for _ in range(3)]
    y = normalized([b - dot(x, y) * a for a, b in zip(x, y, strict=True)])
    z = (x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0])
    return [tuple(n[0] * a + n[1] * b + n[2] * c for a, b, c in zip(x, y, z, strict=True)) for n in normals]


AXES = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0), (0, 0, -1)]


def crowd(seed, count=60, scale=1.0, shift=BLACK, sharp=0.5, reach=1.0):
    """Balls, blocks, plates and needles of all sizes, some of them twice; and a floor without end.

    `sharp` is the least angle of a needle, `reach` how far away the camera is.
    """
    rng = random.Random(seed)
    scene = new_scene((0.9, 0.95, 1.0), (0.2, 0.3, 0.5))
    kinds = finishes(scene)
    pigments = [scene.add_solid(WHITE), scene.add_solid((0.9, 0.4, 0.1))]

    def place(p):
        return tuple(scale * c + s for c, s in zip(p, shift, strict=True))

    def plane(normal, through):
        return (*normal, -dot(normal, place(through)))

    scene.set_camera(place((0, 0.5 * reach, 3 * reach)), place(BLACK), (0, 1, 0), 50 / reach)
    scene.add_light(place((3, 6, 4)), WHITE, CONSTANT)
    scene.add_light(place((-4, 2, 1)), (0.4, 0.4, 0.6), CONSTANT)
    scene.add_polyhedron(pigments[0], kinds[1], [plane((0.1, 1, 0.05), (0, -1.2, 0))])
    for _ in range(count):
        center = [rng.uniform(-1, 1) for _ in range(3)]
        if rng.random() < 0.2:
            center = [round(2 * c) / 2 for c in center]  # so that some touch, and some are met head on
        size = 0.4 * 2 ** rng.uniform(-5, 0)
        pigment, finish = rng.choice(pigments), rng.choice(kinds)
        kind = rng.choice(["ball", "ball", "block", "plate", "needle"])
        for _ in range(rng.choice([1, 1, 1, 2])):
            if kind == "ball":
                scene.add_sphere(pigment, finish, place(center), scale * size)
                continue
            if kind == "needle":
                slope = sharp * rng.uniform(1, 2)
                normals = [(math.cos(a), slope, math.sin(a)) for a in (0, 2, 4)] + [(0, -1, 0)]
                sizes = [size * slope] * 3 + [size * 0.1]
            else:
                normals = AXES
                sizes = [size, size, size * (0.02 if kind == "plate" else 1)] * 2
            if rng.random() < 0.7:
                normals = turned(normals, rng)
            planes = [
                plane(n, [c + s * x / dot(n, n) for c, x in zip(center, n, strict=True)])
                for n, s in zip(normals, sizes, strict=True)
            ]
            scene.add_polyhedron(pigment, finish, planes)
    return scene


# ---- The same picture ------------------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    count=st.integers(1, 80),
    scale=st.sampled_from([1e-6, 1e-3, 1.0, 7.0, 1e6]),
    shift=st.sampled_from([BLACK, (100.0, -30.0, 1000.0)]),
    sharp=st.sampled_from([1.0, 0.1, 1e-3]),
    reach=st.sampled_from([1.0, 40.0]),
)
def test_crowds(seed, count, scale, shift, sharp, reach):
    moved = tuple(scale * s for s in shift)
    scene = crowd(seed, count, scale, moved, sharp, reach)
    assert check(scene, 20, 15, cutoff=1 / 64, max_depth=4) > 20 * 15


def test_a_ray_along_planes_that_goes_on_alone():
    """What it meets only the rules for ties say."""
    scene = new_scene((0.9, 0.95, 1.0))
    white, matte = scene.add_solid(WHITE), add_finish(scene, ka=0.5)
    for place in range(64):
        corner = [(place >> shift) % 4 - 1.75 for shift in (0, 2, 4)]
        scene.add_polyhedron(white, matte, box(corner, [c + 0.5 for c in corner]))
    eye, direction = (-1.5, -0.6875, 5), normalized((0, -0.25, -1))
    look(scene, eye, direction)
    check(scene, 1, 1, cutoff=0, max_depth=0, corner=False)
    assert trace_ray(scene, eye, direction, search="bvh")["hit"]["plane"] == 5


def test_a_large_crowd():
    assert check(crowd(1, 1000), 40, 30, cutoff=1 / 64, max_depth=4) > 4000


def test_balls_smaller_than_pixels():
    rng = random.Random(4)
    scene = new_scene()
    kinds, white = finishes(scene), scene.add_solid(WHITE)
    for _ in range(2000):
        scene.add_sphere(white, rng.choice(kinds), [rng.uniform(-1, 1) for _ in range(3)], 0.01)
    scene.set_camera((0, 0, 500), BLACK, (0, 1, 0), 0.25)
    scene.add_light((300, 400, 200), WHITE, CONSTANT)
    assert check(scene, 64, 48) > 3500


@pytest.mark.parametrize("seed", range(2))
def test_rays_that_go_on_alone(seed):
    # Mirrors that send the rays of a group everywhere, in a room, the first object, from within which some start.
    rng = random.Random(seed)
    scene = new_scene((0.9, 0.95, 1.0), (0.2, 0.3, 0.5))
    mirror, white = add_finish(scene, ka=0.1, kd=0.3, kr=0.9), scene.add_solid(WHITE)
    scene.add_polyhedron(white, mirror, box((-4, -4, -4), (4, 4, 4)))
    for number in range(400):
        center = [rng.uniform(-1, 1) for _ in range(3)]
        size = 0.04 + 0.06 * rng.random()
        if number % 3:
            scene.add_sphere(white, mirror, center, size)
        else:
            scene.add_polyhedron(white, mirror, box([c - size for c in center], [c + size for c in center]))
    scene.set_camera((0, 0.5, 3), BLACK, (0, 1, 0), 45)
    scene.add_light((3, 3.5, 2), WHITE, CONSTANT)
    assert check(scene, 32, 24, max_depth=3) > 4 * 32 * 24


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("shape", ["ball", "block", "wedge"])
def test_rays_that_graze_a_box(shape, precision):
    # From afar, at the outermost point along x, through a window a few rounding errors wide: of rays that pass just
    # outside, some count as hits.
    rng = random.Random(1)
    hits = misses = 0
    for _ in range(40):
        scene = new_scene()
        white, matte = scene.add_solid(WHITE), add_finish(scene, ka=1)
        scene.set_ambient(WHITE)
        center = [rng.uniform(-1, 1) for _ in range(3)]
        if shape == "ball":
            scene.add_sphere(white, matte, center, 0.5)
        elif shape == "block":
            scene.add_polyhedron(white, matte, box([c - 0.5 for c in center], [c + 0.5 for c in center]))
        else:
            # Its edge points along x, with an angle of six degrees.
            planes = [(0.05, 1, 0), (0.05, -1, 0), (-1, 0, 0), (0, 0, 1), (0, 0, -1)]
            sizes = [0.025, 0.025, 0.5, 0.5, 0.5]
            scene.add_polyhedron(white, matte, [(*n, -dot(n, center) - s) for n, s in zip(planes, sizes, strict=True)])
        aim = (center[0] + 0.5, center[1], center[2])
        distance = 10.0 ** rng.uniform(0, 3)
        angle = rng.uniform(-0.2, 0.2)
        eye = (aim[0], aim[1] + distance * math.sin(angle), aim[2] + distance * math.cos(angle))
        # The window at the aim, far wider than rays within whose errors an edge is count as hits.
        width = 2.0 ** {"float": -22, "double": -46, "long double": -46}[precision] * distance
        scene.set_camera(eye, aim, (1, 0, 0), math.degrees(width / distance) * 8)
        brute, tree = (
            draw(scene, 32, 32, max_depth=0, precision=precision, search=search) for search in ("brute", "bvh")
        )
        assert bytes(brute.pixels) == bytes(tree.pixels)
        seen = [pixel[0] > 0 for row in brute.pixels.tolist() for pixel in row]
        hits += sum(seen)
        misses += len(seen) - sum(seen)
    assert hits > 1000 and misses > 1000


def test_one_of_everything():
    check(gallery())


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_one_of_everything_at_other_scales(scale):
    check(gallery(scale, (3 * scale, -20 * scale, 100 * scale)))


@pytest.mark.parametrize("file", SCENES, ids=lambda file: file.stem)
def test_scene_files(file):
    scene = load_scene(file)
    picture = Settings(width=64, height=48)
    for precision in PRECISIONS:
        brute, tree = (NativeRenderer(precision, search).render(scene, picture) for search in ("brute", "bvh"))
        assert bytes(brute.pixels) == bytes(tree.pixels)


# ---- The same objects ------------------------------------------------------------------------------------------------


def test_of_equal_distances_the_first_object_counts():
    scene = new_scene()
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    for _ in range(10):
        scene.add_sphere(white, matte, BLACK, 1)
        scene.add_polyhedron(white, matte, box((-1, -1, -1), (1, 1, 1)))
        scene.add_sphere(white, matte, (7, 0, 0), 1)
    for eye, first in (((0, 0, 5), 0), ((7, 0, 5), 2)):
        assert trace_ray(scene, eye, (0, 0, -1), search="bvh")["hit"]["object"] == first


def test_rays_of_a_pixel_are_the_same():
    scene = crowd(5, 300)

    def rays(search, x, y):
        tree = native_tracer.trace_pixel(scene, 40, 30, x, y, cutoff=1 / 64, max_depth=4, search=search)
        pending = list(tree["rays"])
        for ray in pending:
            pending.extend(ray["children"])
            # Which of several objects is found to be in a light's way depends on the order of the search.
            for light in ray["hit"]["lights"] if ray["hit"] else []:
                light["shadowed_by"] = light["shadowed_by"] is not None
        return tree

    for x in range(0, 40, 7):
        for y in range(0, 30, 7):
            assert rays("brute", x, y) == rays("bvh", x, y)


def test_what_is_in_a_lights_way_is():
    scene = new_scene()
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_polyhedron(white, matte, [(0, 1, 0, 0)])
    for i in range(100):
        scene.add_sphere(white, matte, (i, 2, 0), 0.4)
    scene.add_light((33, 10, 0), WHITE, CONSTANT)
    look(scene, (33, 1, 1), (0, -1, -1))
    ray = trace_ray(scene, (33, 1, 1), (0, -1, -1), search="bvh")
    assert [light["shadowed_by"] for light in ray["hit"]["lights"]] == [34]


# ---- What is searched how --------------------------------------------------------------------------------------------


def balls(count):
    scene = new_scene()
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    for i in range(count):
        scene.add_sphere(white, matte, (i, 0, -9), 0.4)
    return scene


def test_the_number_of_objects_decides():
    assert draw(balls(3), 2, 2).statistics["search"] == "brute"
    assert draw(balls(1000), 2, 2).statistics["search"] == "bvh"
    assert draw(balls(1000), 2, 2, search="brute").statistics["search"] == "brute"
    assert draw(balls(3), 2, 2, search="bvh").statistics["search"] == "bvh"


def test_without_bounded_objects_there_is_no_tree():
    scene = new_scene()
    assert draw(scene, 2, 2, search="bvh").statistics["search"] == "brute"
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_polyhedron(white, matte, [(0, 1, 0, 0)])
    scene.add_polyhedron(white, matte, [(0, 1, 0, 0), (0, -1, 0, -1), (1, 0, 0, 1), (-1, 0, 0, -1)])
    assert draw(scene, 2, 2, search="bvh").statistics["search"] == "brute"


def test_polyhedra_without_points():
    scene = new_scene()
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_polyhedron(white, matte, [(1, 0, 0, 1), (-1, 0, 0, 1), (0, 1, 0, 0), (0, -1, 0, 0)])
    scene.add_polyhedron(white, matte, box((1, 1, 1), (0, 2, 2)))
    scene.add_sphere(white, matte, (0, 0, -5), 1)
    check(scene)


def test_an_unknown_search_is_refused():
    with pytest.raises(ValueError, match="search"):
        draw(balls(1), search="octree")
    with pytest.raises(ValueError, match="search"):
        trace_ray(balls(1), BLACK, (0, 0, -1), search="octree")
