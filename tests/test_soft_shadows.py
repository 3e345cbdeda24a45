"""Lights with a radius: closed forms, and every sample written down once more."""

from dataclasses import replace
from math import acos, asin, asinh, isqrt, pi, radians, sqrt, tan

import numpy as np
import pytest
import sampler_specification as specification
from variant import VARIANT

from converter.analysis.notices import scene_notices
from converter.compare.metrics import LIMIT
from converter.renderers.methods import METHODS, find_method
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Finish, Light, Object, Polyhedron, Scene, Solid, Sphere
from converter.scene.settings import Settings
from native_tracer.sampler import FIRST_LIGHT

WHITE = Solid((1.0, 1.0, 1.0))
MATTE = Finish(0, 1, 0, 1, 0, 0, 0)
FLOOR = Object(0, 0, Polyhedron(((0, 1, 0, 0),)))
ABOVE = Light((0, 10, 0), (1, 1, 1), (1, 0, 0), radius=0.25)
CAMERA = Camera((0, 1, -5), (0, 0, 0), (0, 1, 0), 1e-4)
"""Of a point: all pixels see the floor's origin, and are independent pictures of it."""
SETTINGS = Settings(width=24, height=16, samples=64, background=(0, 0, 0))


def scene(*blocks, light=ABOVE, lights=(), camera=CAMERA, finishes=(MATTE,), floor=FLOOR):
    objects = tuple(block if isinstance(block, Object) else Object(0, 0, block) for block in blocks)
    return Scene(camera, (0, 0, 0), (light, *lights), (WHITE,), finishes, (floor, *objects))


def drawn(made, settings=SETTINGS, renderer=None):
    return np.asarray((renderer or NativeRenderer()).render(made, settings).pixels)


def same_mean(pixels, expected, most_deviation=None):
    """Whether pixels that estimate a number have it as their mean, by five deviations of the mean."""
    values = pixels[..., 0].astype(float)
    deviation = values.std(ddof=1)
    assert abs(values.mean() - expected) <= 5 * deviation / sqrt(values.size) + 1e-6
    if most_deviation is not None:
        assert deviation < most_deviation


# ---- Closed forms


def half_space(edge):
    """All beyond x = edge at a height of 5, half of the light's."""
    return Polyhedron(((-1, 0, 0, edge), (0, -1, 0, 5), (0, 1, 0, -5.5)))


def shadow_of_half_space(edge):
    """The part of the disc on this side of an edge, a circle's segment, for an edge seen at `edge` radii."""
    return 0 if edge <= -1 else 1 if edge >= 1 else 1 - (acos(edge) - edge * sqrt(1 - edge * edge)) / pi


@pytest.mark.parametrize("edge", [-1.1, -0.9, -0.5, -0.2, 0.0, 0.3, 0.7, 0.95, 1.1])
def test_a_straight_edge_across_a_penumbra(edge):
    # The block's upper edge is met first by rays that lean away, its lower one by those that lean over.
    height = 5.5 if edge > 0 else 5
    visible = shadow_of_half_space(edge)
    pixels = drawn(scene(half_space(edge * 0.25 * height / 10)))
    # Half the deviation of independent points, but where only a sliver is covered. The cosine at the rim is 3e-4 low.
    gain = 2 if abs(edge) <= 0.75 else 1
    same_mean(pixels / (1 - 0.25**2 / 400), visible, sqrt(visible * (1 - visible) / 64) / gain + 1e-4)


@pytest.mark.parametrize("radius", [0.05, 0.1, 0.15])
def test_a_ball_in_the_middle(radius):
    """What its cone leaves of the disc: nothing in the umbra, whatever its rays' number."""
    covered = 10 * tan(asin(radius / 5)) / 0.25
    pixels = drawn(scene(Sphere((0, 5, 0), radius)))
    if covered >= 1:
        assert (pixels == 0).all()
    else:
        rim, edge = (sqrt(100 + (part * 0.25) ** 2) for part in (1, covered))
        same_mean(pixels, 20 * (rim - edge) / 0.25**2)


@pytest.mark.parametrize("radius", [0.1, 1.0, 5.0, 40.0])
@pytest.mark.parametrize("fading", [(1, 0, 0), (0, 0, 1)])
def test_a_lamp_overhead(radius, fading):
    """The mean of 10/d and of 10/d^3 over the disc, where d is the distance to a point of it."""
    rim = sqrt(100 + radius**2)
    mean = 20 * (rim - 10) / radius**2 if fading == (1, 0, 0) else 20 * (1 / 10 - 1 / rim) / radius**2
    same_mean(drawn(scene(light=replace(ABOVE, radius=radius, attenuation=fading))), mean)


@pytest.mark.parametrize("radius", [0.01, 1.0, 30.0])
def test_a_lamp_that_the_floor_cuts_in_half(radius):
    """Its lower half lies behind the surface: the mean of y/d over the upper one."""
    light = replace(ABOVE, position=(10, 0, 0), radius=radius)
    integral = radius * sqrt(100 + radius**2) / 2 - 50 * asinh(radius / 10)
    same_mean(drawn(scene(light=light)), 2 * integral / (pi * radius**2))


def test_a_highlight_is_the_samples():
    """Phong's lobe with alpha 1 at the mirror direction is the cosine between two ways to the disc."""
    camera = replace(CAMERA, eye=(0, 5, 0), look_at=(0, 0, 0), up=(0, 0, 1))
    made = scene(camera=camera, finishes=(replace(MATTE, kd=0, ks=1),), light=replace(ABOVE, radius=5))
    same_mean(drawn(made), 20 * (sqrt(125) - 10) / 25)


# ---- Every sample


def unit(v):
    return v / np.linalg.norm(v, axis=-1)[..., None]


def primary_rays(camera, settings):
    """Columns, rows and numbers of all samples, and their directions."""
    n = isqrt(settings.samples)
    row, column, k = (a.ravel() for a in np.indices((settings.height, settings.width, n * n)))
    x = column + (k % n + 0.5) / n - 0.5
    y = row + (k // n + 0.5) / n - 0.5
    forward = unit(np.subtract(camera.look_at, camera.eye))
    right = unit(np.cross(forward, camera.up))
    half = tan(radians(camera.fovy) / 2)
    across, up = (2 * x - settings.width) / settings.height * half, (1 - 2 * y / settings.height) * half
    window = forward + across[:, None] * right + up[:, None] * np.cross(right, forward)
    return column, row, k, unit(window)


def lit(point, number, light, keys, path):
    """What a light gives to points of a white floor."""
    center = np.subtract(light.position, point)
    axis = unit(center)
    points = specification.sample_points(*keys, path, FIRST_LIGHT + number)
    x, y = specification.disc_points(points).astype(float).T * light.radius
    sign = np.where(axis[:, 2] < -0.4371, -1.0, 1.0)
    a = -1 / (sign + axis[:, 2])
    tangent = np.stack([1 + sign * axis[:, 0] ** 2 * a, sign * axis[:, 0] * axis[:, 1] * a, -sign * axis[:, 0]], -1)
    way = center + x[:, None] * tangent + y[:, None] * np.cross(axis, tangent)
    distance = np.linalg.norm(way, axis=1)
    cosine = way[:, 1] / distance
    a, b, c = light.attenuation
    return np.where((cosine > 0) & free(point, way), cosine / (a + b * distance + c * distance**2), 0)


LAMPS = (
    Light((1, 6, 3), (1, 1, 1), (1, 0, 0), radius=1.5),
    Light((-3, 4, -2), (1, 1, 1), (0.5, 0.1, 0.02), radius=0.0),
    Light((2, 5, -4), (1, 1, 1), (0, 0, 0.1), radius=2.0),
)
WIDE = Camera((0.5, 3, -8), (0, 0.5, 0), (0.1, 1, 0), 40)
FEW = Settings(width=20, height=14, samples=9, seed=5, background=(0, 0, 0))


def free(point, way):
    """Whether a way passes the ball about (0, 2, 0) of radius 1."""
    offset = point - np.array([0, 2, 0])
    squared, along, beyond = (way**2).sum(1), (way * offset).sum(1), (offset**2).sum(1) - 1
    root = along**2 - squared * beyond
    half = np.sqrt(np.maximum(root, 0))
    return ~((root > 0) & (half > along) & (-along - half < squared))


PANE = Finish(0, 0, 0, 1, 0, 1, 1.0)
MIRROR = Finish(0, 0, 0, 1, 1, 0, 0)
BLACK = Finish(0, 0, 0, 1, 0, 0, 0)


@pytest.mark.parametrize("precision", ["double", "long double", "float"])
@pytest.mark.parametrize("path", [1, 2, 3])
def test_every_sample_is_the_specifications(precision, path):
    """Where the floor is seen directly, in a mirror, and through a surface that changes nothing."""
    camera = WIDE
    between = {2: Polyhedron(((0, 0, 1, 12),)), 3: Polyhedron(((0, 0, -1, -7.5),))}
    if path == 2:
        camera = replace(WIDE, look_at=(0.6, 2.5, -20))  # so that all rays meet the mirror
    made = scene(
        Object(0, 1, Sphere((0, 2, 0), 1)),
        *(Object(0, 2, shape) for number, shape in between.items() if number == path),
        light=LAMPS[0],
        lights=LAMPS[1:],
        camera=camera,
        finishes=(MATTE, BLACK, MIRROR if path == 2 else PANE),
    )
    column, row, k, direction = primary_rays(camera, FEW)
    origin = np.broadcast_to(np.array(camera.eye, float), direction.shape)
    if path == 2:
        origin = origin + ((-12 - origin[:, 2]) / direction[:, 2])[:, None] * direction
        direction = direction * [1, 1, -1]
    seen = direction[:, 1] < 0
    point = origin - (origin[:, 1] / np.where(seen, direction[:, 1], -1))[:, None] * direction
    point[:, 1] = 0
    seen &= free(origin, point - origin)
    color = sum(lit(point, i, light, (FEW.seed, column, row, k), path) for i, light in enumerate(LAMPS))
    expected = np.where(seen, color, 0).reshape(FEW.height, FEW.width, FEW.samples).mean(axis=2)
    found = drawn(made, FEW, NativeRenderer(precision))[..., 0]
    assert expected.max() > 0.5
    assert (expected > 0).mean() > 0.3
    wrong = np.abs(found - expected) > 1e-6
    assert wrong.mean() <= (0.02 if precision == "float" else 0)  # where a float meets the ball's edge otherwise


# ---- Whatever draws it


def lamps(radius=1.5):
    """A matte scene with a mirror, under two lamps."""
    return scene(
        Sphere((0, 2, 0), 1),
        Object(0, 1, Sphere((2, 1, 1), 1)),
        light=replace(LAMPS[0], radius=radius),
        lights=LAMPS[1:2],
        camera=WIDE,
        finishes=(replace(MATTE, ks=0.3, alpha=20), replace(MIRROR, kd=0.2, kr=0.7)),
    )


def test_nothing_depends_on_threads_tiles_lanes_or_search():
    settings = replace(FEW, width=100, height=70, samples=4)
    first = drawn(lamps(), settings).tobytes()
    assert drawn(lamps(), replace(settings, threads=1)).tobytes() == first
    assert drawn(lamps(), settings, NativeRenderer(search="bvh")).tobytes() == first
    assert drawn(lamps(), replace(settings, seed=6)).tobytes() != first


@pytest.mark.parametrize("instructions", ["baseline", "avx2", "avx512"])
@pytest.mark.parametrize("precision", ["double", "float"])
def test_bytes_do_not_depend_on_the_instruction_set(precision, instructions):
    import native_tracer
    from converter.renderers.native import build_scene
    from converter.scene.needs import scene_needs

    needs = scene_needs(lamps(), FEW)
    images = [native_tracer.Image(70, 50) for _ in range(2)]
    for image, chosen in zip(images, ("", instructions), strict=True):
        try:
            options = {"cutoff": 1 / 512, "max_depth": 5, "samples": 4, "seed": 3, "precision": precision}
            native_tracer.render(build_scene(lamps(), needs), image, instructions=chosen, **options)
        except ValueError:
            pytest.skip(f"this processor has no {chosen}")
    assert bytes(images[0].pixels) == bytes(images[1].pixels)


def test_a_picture_in_long_double_is_the_same():
    settings = replace(FEW, width=60, height=40, samples=16)
    exact = drawn(lamps(), settings, NativeRenderer("long double"))
    assert np.abs(exact - drawn(lamps(), settings)).max() < 1e-5


def glass():
    """Rays that split in two, under the lamps."""
    pane = Object(0, 2, Polyhedron(((0, 0, 1, 1), (0, 0, -1, -1.5), (1, 0, 0, -3), (-1, 0, 0, -3), (0, 1, 0, -4))))
    made = lamps()
    return replace(
        made, objects=(*made.objects, pane), finishes=(*made.finishes, Finish(0.1, 0.2, 0.2, 30, 0.3, 0.6, 1.4))
    )


@pytest.mark.parametrize("samples", [1, 16])
@pytest.mark.parametrize("made", [lamps, glass])
@pytest.mark.parametrize("method", ["mitsuba-analytic", "mitsuba-bvh", "mitsuba-mesh"])
def test_both_renderers_draw_the_same_noise(method, made, samples):
    settings = replace(FEW, width=64, height=48, samples=samples)
    native, mitsuba = (METHODS[name].renderer(VARIANT) for name in ("native", method))
    difference = np.abs(drawn(made(), settings, native) - drawn(made(), settings, mitsuba)).max(axis=2)
    assert (difference > LIMIT).sum() == 0
    assert np.median(difference) < 1e-6


def test_both_renderers_draw_the_same_noise_of_independent_points():
    settings = replace(FEW, width=64, height=48, samples=16)
    native, mitsuba, stratified = (
        drawn(glass(), method.settings(settings), method.renderer(VARIANT))
        for method in map(find_method, ("native:points=independent", "mitsuba-analytic:points=independent", "native"))
    )
    assert np.abs(native - mitsuba).max() < LIMIT
    assert np.abs(native - stratified).max() > 10 * LIMIT


@pytest.mark.parametrize("method", ["native", "mitsuba-analytic"])
def test_a_pixels_rays_have_its_colour(method):
    settings = replace(FEW, samples=4)
    renderer = METHODS[method].renderer(VARIANT)
    pixels = drawn(glass(), settings, renderer)
    places = [(3, 8), (10, 9), (13, 7)]
    for record, (x, y) in zip(renderer.trace_pixels(glass(), settings, places), places, strict=True):
        assert record.color == pytest.approx(pixels[y, x], abs=1e-6)


def test_a_radius_of_0_is_a_point_to_the_last_bit():
    """Whatever the seed; and a radius that is nearly none gives nearly the same."""
    point = drawn(lamps(0.0), replace(FEW, seed=1))
    plain = replace(lamps(), lights=tuple(replace(light, radius=0.0) for light in LAMPS[:2]))
    assert point.tobytes() == drawn(plain, replace(FEW, seed=2)).tobytes()
    assert np.abs(drawn(lamps(1e-9), FEW) - point).max() < 1e-6


def test_sixteen_rays_a_pixel_are_drawn_where_nobody_asks():
    settings = replace(FEW, samples=None)
    assert drawn(lamps(), settings).tobytes() == drawn(lamps(), replace(settings, samples=16)).tobytes()
    assert drawn(lamps(0.0), settings).tobytes() == drawn(lamps(0.0), replace(settings, samples=1)).tobytes()
    (notice,) = scene_notices(lamps(), settings)
    assert notice == "scene: light 1 has a radius: 16 rays a pixel are drawn (--samples asks for another number)"
    assert scene_notices(lamps(), FEW) == scene_notices(lamps(0.0), settings) == []
