"""Quadrics in the native tracer, against their equations solved in decimal numbers of sixty digits."""

import math
import random
from array import array
from decimal import Decimal, localcontext
from fractions import Fraction

import pytest
from native_scenes import CONSTANT, EPSILON, PRECISIONS, WHITE, add_finish, box, draw, new_scene, trace_ray

import native_tracer

KINDS = {
    "ball": (1, 1, 1, 0, 0, 0, 0, 0, 0, -1),
    "ellipsoid": (4, 1, 9, 0, 0, 0, 0, 0, 0, -4),
    "cylinder": (1, 1, 0, 0, 0, 0, 0, 0, 0, -1),
    "elliptic cylinder": (1, 0, 5, 0, 0, 0, 0, 0, 0, -2),
    "hyperbolic cylinder": (1, -1, 0, 0, 0, 0, 0, 0, 0, -1),
    "parabolic cylinder": (1, 0, 0, 0, 0, 0, 0, -1, 0, 0),
    "cone": (1, 1, -1, 0, 0, 0, 0, 0, 0, 0),
    "elliptic cone": (1, 4, -2, 0, 0, 0, 0, 0, 0, 0),
    "paraboloid": (1, 2, 0, 0, 0, 0, 0, 0, -1, 0),
    "one sheet": (1, 1, -1, 0, 0, 0, 0, 0, 0, -1),
    "two sheets": (1, 1, -1, 0, 0, 0, 0, 0, 0, 1),
    "saddle": (1, -1, 0, 0, 0, 0, 0, 0, -1, 0),
    "parallel planes": (1, 0, 0, 0, 0, 0, 0, 0, 0, -1),
    "crossing planes": (1, -2, 0, 0, 0, 0, 0, 0, 0, 0),
    "half-space": (0, 0, 0, 0, 0, 0, 1, 2, 3, -1),
}
"""One of each, about the origin."""

FLIPPED = {f"{kind}, turned inside out": tuple(-c for c in q) for kind, q in KINDS.items()}
ALL = KINDS | FLIPPED


def turned(rng):
    """A rotation by fractions, from a quaternion of small whole numbers."""
    w, x, y, z = (Fraction(rng.randint(-4, 4)) for _ in range(4))
    n = w * w + x * x + y * y + z * z
    if n == 0:
        return turned(rng)
    return [
        [(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
        [2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n],
        [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n],
    ]


def placed(quadric, rotation, shift, size):
    """The coefficients, rounded, of a quadric that is made `size` times as large, turned and moved."""
    a, b, c, d, e, f, g, h, i, j = (Fraction(number) for number in quadric)
    half = Fraction(1, 2)
    matrix = [[a, d * half, e * half], [d * half, b, f * half], [e * half, f * half, c]]
    linear = [g * half, h * half, i * half]
    # p = size R x + shift, so that x = R^T (p - shift) / size.
    m = [
        [sum(rotation[r][k] * matrix[k][n] * rotation[s][n] for k in range(3) for n in range(3)) for s in range(3)]
        for r in range(3)
    ]
    m = [[value / size**2 for value in row] for row in m]
    v = [sum(rotation[r][k] * linear[k] for k in range(3)) / size for r in range(3)]
    ms = [sum(m[r][s] * shift[s] for s in range(3)) for r in range(3)]
    constant = j - 2 * sum(v[r] * shift[r] for r in range(3)) + sum(shift[r] * ms[r] for r in range(3))
    v = [v[r] - ms[r] for r in range(3)]
    exact = (m[0][0], m[1][1], m[2][2], 2 * m[0][1], 2 * m[0][2], 2 * m[1][2], 2 * v[0], 2 * v[1], 2 * v[2], constant)
    return tuple(float(number) for number in exact)


IDENTITY = [[Fraction(int(r == s)) for s in range(3)] for r in range(3)]


def gradient(q, p):
    a, b, c, d, e, f, g, h, i, _ = q
    x, y, z = p
    return (
        2 * a * x + d * y + e * z + g,
        d * x + 2 * b * y + f * z + h,
        e * x + f * y + 2 * c * z + i,
    )


def equation(q, origin, direction):
    """a, b, c of a t^2 + b t + c along a ray, in decimals."""
    a, b, c, d, e, f, g, h, i, j = q
    x, y, z = origin
    u, v, w = direction
    return (
        a * u * u + b * v * v + c * w * w + d * u * v + e * u * w + f * v * w,
        sum(n * k for n, k in zip(gradient(q, origin), direction, strict=True)),
        a * x * x + b * y * y + c * z * z + d * x * y + e * x * z + f * y * z + g * x + h * y + i * z + j,
    )


def truth(q, origin, direction):
    """The roots along a ray, ascending, and how clear it is that there are some: the discriminant over its terms."""
    a, b, c = equation(q, origin, direction)
    discriminant = b * b - 4 * a * c
    clear = abs(discriminant) / (b * b + abs(4 * a * c)) if discriminant else Decimal(0)
    if discriminant <= 0:
        return [], clear
    root = discriminant.sqrt()
    q_ = -(b + (root if b >= 0 else -root)) / 2
    return sorted(t for t in ([q_ / a] if a else []) + ([c / q_] if q_ else [])), clear


def decimals(numbers):
    return tuple(Decimal(float(number)) for number in numbers)


def scene_of(coefficients, **finish):
    scene = new_scene()
    pigment, kind = scene.add_solid(WHITE), add_finish(scene, **{"ka": 1, **finish})
    scene.add_quadric(pigment, kind, coefficients)
    return scene


def check(coefficients, ray, precision, size, reach):
    """The ray's hit against the truth; false where it says nothing, for a root is double or at the origin."""
    with localcontext() as context:
        context.prec = 60
        q = decimals(coefficients)
        origin, direction = decimals(ray["origin"]), decimals(ray["direction"])
        roots, clear = truth(q, origin, direction)
        epsilon = Decimal(max(EPSILON[precision], 2.0**-52))
        if clear < 1024 * epsilon:
            return False
        bound = 64 * epsilon * Decimal(reach)
        hit = ray["hit"]
        ahead = []
        for t in roots:
            point = tuple(o + t * d for o, d in zip(origin, direction, strict=True))
            normal = gradient(q, point)
            length = sum(n * n for n in normal).sqrt()
            slope = sum(n * d for n, d in zip(normal, direction, strict=True)) / length
            error = (bound + 64 * epsilon * abs(t)) / abs(slope)
            if abs(t) <= error or error > Decimal(size) / 8:
                return False
            if t > 0:
                ahead.append((t, error, slope, normal, length))
        if not ahead:
            assert hit is None
            return True
        t, error, slope, normal, length = ahead[0]
        if t > Decimal(1000 * reach):
            return False
        assert hit is not None
        assert abs(Decimal(hit["t"]) - t) <= error
        assert hit["entering"] == (slope < 0)
        # The normal turns by no more than the surface bends over the error.
        bend = max(abs(number) for number in q[:6]) * 4 / length
        turn = error * bend + 64 * epsilon
        assert all(abs(Decimal(m) - n / length) <= turn for m, n in zip(hit["normal"], normal, strict=True))
        return True


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("kind", ALL)
@pytest.mark.parametrize("scale", [2.0**-20, 1.0, 2.0**20])
def test_hits_are_the_roots_of_the_equation(kind, scale, precision):
    rng = random.Random(f"{kind} {scale}")
    told = 0
    for number in range(24):
        rotation = IDENTITY if number % 2 else turned(rng)
        shift = [Fraction(scale * rng.uniform(-2, 2)) for _ in range(3)]
        q = placed(ALL[kind], rotation, shift, Fraction(scale))
        eye = tuple(float(s) + scale * rng.uniform(-4, 4) for s in shift)
        target = tuple(float(s) + scale * rng.uniform(-1.5, 1.5) for s in shift)
        ray = trace_ray(scene_of(q), eye, tuple((t - e) for t, e in zip(target, eye, strict=True)), precision=precision)
        told += check(q, ray, precision, scale, 8 * scale)
    assert told >= 8


# ---- Rays that start on a quadric ------------------------------------------------------------------------------------


def chain(ray):
    """A ray and its successors, where each has one at most."""
    rays = [ray]
    while rays[-1]["children"]:
        (successor,) = rays[-1]["children"]
        rays.append(successor)
    return rays


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("kind", ALL)
@pytest.mark.parametrize("finish", [{"kr": 1.0}, {"kt": 1.0, "eta": 1 / 1.25}], ids=["mirror", "glass"])
def test_bounces_go_on_to_the_other_root(kind, finish, precision):
    """After the first hit one root is 0: a ray hits the other one if that is ahead, and nothing else."""
    rng = random.Random(kind)
    followed = 0
    for number in range(12):
        q = placed(ALL[kind], IDENTITY if number % 2 else turned(rng), [0, 0, 0], 1)
        eye = tuple(rng.uniform(-4, 4) for _ in range(3))
        target = tuple(rng.uniform(-1.5, 1.5) for _ in range(3))
        direction = tuple(t - e for t, e in zip(target, eye, strict=True))
        rays = chain(trace_ray(scene_of(q, **finish), eye, direction, precision=precision, max_depth=4))
        inside = None
        for ray in rays:
            if inside is not None:
                a, b, _ = equation(q, ray["origin"], ray["direction"])
                other = -b / a if a else math.inf
                if abs(b) < 1e-2 or abs(a) < 1e-2:
                    break
                if other > 0 and (a > 0) == inside:
                    assert ray["hit"]["t"] == pytest.approx(other, rel=4096 * EPSILON[precision] / abs(b) ** 2)
                    assert ray["hit"]["entering"] == (not inside)
                else:
                    assert other <= 0
                    assert ray["hit"] is None
                followed += 1
            if ray["hit"]:
                turns_in = finish.get("kt") and not ray["hit"]["total_reflection"]
                inside = ray["hit"]["entering"] if turns_in else not ray["hit"]["entering"]
    assert followed or kind.startswith("half-space")


def test_a_ray_that_leaves_one_sheet_meets_the_other():
    scene = scene_of(KINDS["two sheets"], kr=1)  # z = 1 and z = -1 on the axis
    first, second, third = chain(trace_ray(scene, (0, 0, 0), (0, 0, 1), max_depth=2))
    assert (first["hit"]["t"], second["hit"]["t"], third["hit"]["t"]) == (1, 2, 2)
    assert first["hit"]["entering"] and second["hit"]["entering"]


def test_a_ray_that_is_mirrored_off_an_ellipsoid_never_meets_it():
    """From so far that it grazes, but for rounding errors, which may lead the mirrored ray inside."""
    scene = scene_of(KINDS["ellipsoid"], kr=1)
    grazes = 0
    for k in range(1, 1000):
        eye = (1 - (1 + k % 3) * 2.0**-24, 0, -(2.0**16) * (1 + k / 1000))
        first, second = chain(trace_ray(scene, eye, (0, 0, 1), precision="float", max_depth=1))
        grazes += first["hit"]["normal"][2] > 0
        assert second["hit"] is None, k
    assert grazes > 4


# ---- Where it is decided by rule -------------------------------------------------------------------------------------


@pytest.mark.parametrize("precision", PRECISIONS)
def test_what_touches_passes_by(precision):
    touching = [
        ("ball", (1, 0, -5), (0, 0, 1)),
        ("cylinder", (1, -5, 0), (0, 1, 0)),
        ("cylinder", (1, 0, -5), (0, 0, 1)),  # along its side
        ("cone", (-5, 0, 0), (1, 0, 0)),  # its tip, from without
        ("cone", (-1, 0, -1), (1, 0, 1)),  # along its side, through the tip
        ("crossing planes", (0, -5, 0), (0, 1, 0.25)),
        ("parallel planes", (1, -5, 0), (0, 1, 0)),
    ]
    for kind, eye, direction in touching:
        if precision == "float" and kind == "cone" and direction == (1, 0, 1):
            continue  # no direction has two equal components there
        assert trace_ray(scene_of(KINDS[kind]), eye, direction, precision=precision)["hit"] is None, (kind, eye)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_one_root_is_exact_where_there_is_only_one(precision):
    along_axis = trace_ray(scene_of((1, 1, 0, 0, 0, 0, 0, 0, -1, 0)), (0.5, 0.25, 5), (0, 0, -1), precision=precision)
    assert along_axis["hit"]["t"] == 5 - 0.25 - 0.0625
    assert along_axis["hit"]["entering"] is False
    through_the_tip = trace_ray(scene_of(KINDS["cone"]), (0, 0, -5), (0, 0, 1), precision=precision)
    assert through_the_tip["hit"] is None  # inside it all the way
    plane = trace_ray(scene_of((0, 0, 0, 0, 0, 0, 0, 0, 2, -6)), (1, 2, 5), (0, 0, -1), precision=precision)
    assert (plane["hit"]["t"], plane["hit"]["normal"]) == (2, (0, 0, 1))


@pytest.mark.parametrize("precision", ["double", "long double"])
def test_a_ray_along_a_ruling_does_not_meet_the_surface_far_away(precision):
    """But for the roundings of its direction it runs along the straight lines in the cylinder, inside it for ever."""
    for kind, direction in (("parabolic cylinder", (1e-17, 1, 0.5)), ("cylinder", (1e-17, 0, 1))):
        inside = trace_ray(scene_of(KINDS[kind]), (0, 0.75, 0.25), direction, precision=precision)
        assert inside["hit"] is None, kind
    glass = scene_of(KINDS["parabolic cylinder"], kt=1)
    first, second = chain(trace_ray(glass, (0, -3, -1), (1e-17, 1, 0.5), precision=precision, max_depth=1))
    assert first["hit"]
    assert second["hit"] is None
    across = trace_ray(scene_of(KINDS["parabolic cylinder"]), (0.5, 3, 0.25), (1, 0, 0), precision=precision)
    assert across["hit"]


def test_a_ray_along_a_cones_side_beside_it_hits_once():
    ray = trace_ray(scene_of(KINDS["cone"]), (-3, 0, -1), (0.6, 0, 0.8), precision="double")
    assert ray["hit"] is not None
    ray = trace_ray(scene_of((16, 16, -9, 0, 0, 0, 0, 0, 0, 0)), (-1, 0, 0), (3, 0, 4), precision="double")
    # 16 (-1 + 0.6 t)^2 = 9 (0.8 t)^2: 16 - 19.2 t = 0, and 5.76 - 5.76 of t^2.
    assert ray["hit"]["t"] == pytest.approx(16 / 19.2, rel=8 * EPSILON["double"])


# ---- Whole pictures --------------------------------------------------------------------------------------------------


def sphere_as_quadric(center, radius):
    x, y, z = map(Fraction, center)
    return (1, 1, 1, 0, 0, 0, *(float(-2 * c) for c in center), float(x * x + y * y + z * z - Fraction(radius) ** 2))


class Quadrics(native_tracer.Scene):
    """A scene whose spheres are quadrics."""

    def add_sphere(self, pigment, finish, center, radius):
        return self.add_quadric(pigment, finish, sphere_as_quadric(center, radius))


def balls(scene):
    """Mirrors, glass, shadows, one ball in another, and the eye in a third."""
    scene.set_ambient(WHITE)
    scene.set_background((0.2, 0.3, 0.5))
    scene.set_camera((0, 2, 9), (0, 0.7, 0), (0, 1, 0), 45)
    scene.add_light((5, 8, 6), (0.9, 0.9, 0.8), (0.5, 0.02, 0.003))
    scene.add_light((0.3, 0, 1.5), (0.9, 0.3, 0.3), CONSTANT)
    white, checker = scene.add_solid(WHITE), scene.add_checker((0.1, 0.2, 0.1), (0.9, 0.9, 0.8), 0.5)
    matte = add_finish(scene, ka=0.3, kd=0.6)
    mirror = add_finish(scene, ka=0.05, kd=0.05, ks=0.5, alpha=300, kr=0.8)
    glass = add_finish(scene, ka=0.02, ks=0.3, alpha=200, kr=0.15, kt=0.8, eta=1 / 1.5)
    scene.add_polyhedron(checker, matte, [(0, 1, 0, 1)])
    scene.add_sphere(white, mirror, (-2, 0, -1), 1)
    scene.add_sphere(white, glass, (0.25, 0, 1.5), 1)
    scene.add_sphere(white, matte, (0.25, 0, 1.5), 0.5)
    scene.add_sphere(checker, matte, (2.5, 0.25, 0), 1.25)
    scene.add_sphere(white, glass, (0, 2, 9), 0.5)
    return scene


def pixels(scene, **options):
    return array("f", draw(scene, 160, 120, **options).pixels.tobytes())


@pytest.mark.parametrize("precision", ["double", "long double"])
def test_balls_are_spheres(precision):
    pairs = zip(
        pixels(balls(native_tracer.Scene()), precision=precision),
        pixels(balls(Quadrics()), precision=precision),
        strict=True,
    )
    assert all(abs(a - b) <= 1 / 255 for a, b in pairs)


def museum(scale=1.0):
    """Quadrics of all kinds that reflect, refract and shade one another."""
    rng = random.Random(1)
    scene = new_scene(WHITE, (0.2, 0.3, 0.5))
    scene.set_camera((0, 3 * scale, 12 * scale), (0, 0, 0), (0, 1, 0), 45)
    scene.add_light((5 * scale, 8 * scale, 6 * scale), WHITE, CONSTANT)
    white, red = scene.add_solid(WHITE), scene.add_solid((0.8, 0.2, 0.1))
    finishes = [
        add_finish(scene, ka=0.2, kd=0.5, ks=0.4, alpha=60, kr=0.25),
        add_finish(scene, ka=0.02, ks=0.3, alpha=200, kr=0.15, kt=0.8, eta=1 / 1.5),
    ]
    for number in range(24):
        shift = [Fraction(scale * rng.uniform(-4, 4)) for _ in range(3)]
        kind = "ellipsoid" if number < 20 else rng.choice(list(KINDS))
        q = placed(KINDS[kind], turned(rng), shift, Fraction(scale * rng.uniform(0.3, 0.8)))
        scene.add_quadric(white if number % 3 else red, finishes[number % 2], q)
    return scene


@pytest.mark.parametrize("precision", PRECISIONS)
def test_boxes_lose_no_hit(precision):
    found = pixels(museum(), precision=precision, search="brute")
    assert len(set(found)) > 1000
    assert found == pixels(museum(), precision=precision, search="bvh")


@pytest.mark.parametrize("instructions", ["baseline", "avx2", "avx512"])
def test_instruction_sets_draw_the_same_bytes(instructions):
    try:
        drawn = pixels(museum(), instructions=instructions)
    except ValueError:
        pytest.skip(f"this processor has no {instructions}")
    assert drawn == pixels(museum())


@pytest.mark.parametrize("scale", [2.0**-30, 2.0**30])
def test_a_scene_has_no_scale(scale):
    assert pixels(museum(scale)) == pixels(museum())


def test_precisions_agree():
    pairs = list(zip(pixels(museum()), pixels(museum(), precision="long double"), strict=True))
    assert sum(not abs(a - b) <= 1 / 255 for a, b in pairs) == 0


def test_a_factor_changes_nothing():
    q = placed(KINDS["ellipsoid"], turned(random.Random(1)), [1, 2, 3], 1)
    rays = [
        trace_ray(scene_of([factor * c for c in q]), (9, 8, 7), (-8, -6, -4)) for factor in (1, 2.0**-900, 2.0**900)
    ]
    assert rays[0]["hit"] and rays[0] == rays[1] == rays[2]


# ---- Eyes and lights on quadrics -------------------------------------------------------------------------------------


def test_a_light_on_a_quadric_is_not_shadowed_by_it():
    """A lamp on the tip of a paraboloid lights the floor below it, and the bowl from within."""
    scene = new_scene()
    scene.add_light((0, 0, 0), WHITE, CONSTANT)
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_quadric(white, matte, KINDS["paraboloid"])
    scene.add_polyhedron(white, matte, [(0, 0, 1, 3)])
    floor = trace_ray(scene, (1, 0, -1), (0, 0, -1))
    assert floor["hit"]["lights"][0]["shadowed_by"] is None
    bowl = trace_ray(scene, (0.25, 0, 0.125), (0, 0, -1))
    assert bowl["hit"]["entering"] is False
    assert bowl["local"] != (0, 0, 0)


def test_a_light_on_the_other_sheet_is_shadowed_by_this_one():
    """The shadow ray crosses the upper sheet, from within, before it comes to the lamp on the lower one."""
    scene = new_scene()
    scene.add_light((0, 0, -1), WHITE, CONSTANT)
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_quadric(white, matte, KINDS["two sheets"])
    scene.add_polyhedron(white, matte, box((-9, -9, 5), (9, 9, 6)))
    hidden = trace_ray(scene, (0.125, 0, 4.5), (0, 0, 1))
    assert hidden["hit"]["object"] == 1
    assert hidden["hit"]["lights"][0]["shadowed_by"] == 0
    between = trace_ray(scene_with_lamp_between(), (0.125, 0, 4.5), (0, 0, 1))
    assert between["hit"]["lights"][0]["shadowed_by"] == 0


def scene_with_lamp_between():
    scene = new_scene()
    scene.add_light((0, 0, 0), WHITE, CONSTANT)
    white, matte = scene.add_solid(WHITE), add_finish(scene, kd=1)
    scene.add_quadric(white, matte, KINDS["two sheets"])
    scene.add_polyhedron(white, matte, box((-9, -9, 5), (9, 9, 6)))
    return scene


@pytest.mark.parametrize("precision", ["double", "long double"])
def test_an_eye_on_a_cylinder_sees_its_other_side(precision):
    scene = scene_of((100, 100, 0, 0, 0, 0, 0, 0, 0, -1))  # of radius 0.1
    inward = trace_ray(scene, (0.1, 0, 0.3), (-1, 0.125, 0.5), precision=precision)
    assert inward["hit"]["entering"] is False
    assert inward["hit"]["t"] > 0.1
    assert trace_ray(scene, (0.1, 0, 0.3), (1, 0.125, 0.5), precision=precision)["hit"] is None


# ---- Extremes --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("flat", [1e-14, 1e-10, 1e-6, 1e-3, 1.0])
def test_a_paraboloid_may_be_a_long_ellipsoid(flat):
    """x^2 + y^2 + flat z^2 - z, whose centre is as far away as 0.5 / flat: near the tip that says nothing."""
    q = (1, 1, flat, 0, 0, 0, 0, 0, -1, 0)
    for rotation in (IDENTITY, turned(random.Random(3))):
        shift = [Fraction(3), Fraction(-2), Fraction(1)]
        turned_q = placed(q, rotation, shift, 1)
        tip = (3.0, -2.0, 1.0)
        for direction in ((1, 2, 3), (-2, 1, 0.5), (0.3, -0.2, 1)):
            eye = tuple(t - 2 * d + 0.1 for t, d in zip(tip, direction, strict=True))
            ray = trace_ray(scene_of(turned_q), eye, direction)
            check(turned_q, ray, "double", 1, 16)


@pytest.mark.parametrize("width", [1e-2, 1e-4, 1e-6])
def test_a_needle_cone_far_off(width):
    q = placed((1 / width**2, 1 / width**2, -1, 0, 0, 0, 0, 0, 0, 0), turned(random.Random(8)), [1000, 2000, 3000], 1)
    told = 0
    rng = random.Random(2)
    for _ in range(20):
        eye = tuple(c + rng.uniform(-1, 1) for c in (1000, 2000, 3000))
        ray = trace_ray(scene_of(q), eye, tuple(rng.uniform(-1, 1) for _ in range(3)))
        told += check(q, ray, "double", 1, 4096)
    assert told


def test_what_is_no_quadric_is_refused():
    scene = new_scene()
    pigment, finish = scene.add_solid(WHITE), add_finish(scene, ka=1)
    with pytest.raises(ValueError, match="not finite"):
        scene.add_quadric(pigment, finish, [1, 1, math.nan, 0, 0, 0, 0, 0, 0, -1])
    with pytest.raises(ValueError, match="all 0"):
        scene.add_quadric(pigment, finish, [0] * 9 + [-1])
    with pytest.raises(TypeError):
        scene.add_quadric(pigment, finish, [1] * 9)
    with pytest.raises(IndexError, match="there is no pigment 7"):
        scene.add_quadric(7, finish, [1] * 10)
