"""The Mitsuba plugins one by one, each against a closed form."""

import ast
import math
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

import mitsuba_plugins
from converter.scene.settings import Settings


@pytest.fixture
def phong(mi):
    def make(**coefficients):
        return mi.load_dict({"type": "phong", "pigment": {"type": "rgb", "value": [0.5, 0.25, 1.0]}, **coefficients})

    return make


def vector(mi, numbers):
    return mi.Vector3f(*(float(number) for number in numbers))


def interaction(mi, wi):
    si = mi.SurfaceInteraction3f()
    si.wi = vector(mi, wi)
    si.p = mi.Point3f(0)
    si.sh_frame = mi.Frame3f(mi.Normal3f(0, 0, 1))
    si.n = mi.Normal3f(0, 0, 1)
    return si


# ---- Textures


def test_checker_counts_cubes_on_both_sides_of_the_origin(mi):
    texture = mi.load_dict(
        {
            "type": "solid_checker",
            "first": {"type": "rgb", "value": [1.0, 0.0, 0.0]},
            "second": {"type": "rgb", "value": [0.0, 2.0, 0.0]},
            "size": 0.5,
        }
    )
    x = np.array([0.1, 0.6, -0.1, -0.6, 1e12, 1e12 + 0.5])
    color = np.asarray(texture.color_at(mi.Point3d(mi.Float64(x), 0.1, 0.1)))
    assert color[0].tolist() == [1, 0, 0, 1, 1, 0]
    assert color[1].tolist() == [0, 2, 2, 0, 0, 2]


def test_checker_boundary_is_exact_in_double_precision(mi):
    texture = mi.load_dict(
        {
            "type": "solid_checker",
            "first": {"type": "rgb", "value": [1.0, 0.0, 0.0]},
            "second": {"type": "rgb", "value": [0.0, 1.0, 0.0]},
            "size": 0.1,
        }
    )
    # In double precision -0.3 / 0.1 lies above -3, in single precision on it or below.
    y = -0.3
    expected = 1 if math.floor(y / 0.1) % 2 == 0 else 0
    assert texture.color_at(mi.Point3d(0.05, y, 0.05)).x[0] == expected


def test_solid_keeps_its_color_exactly(mi):
    texture = mi.load_dict({"type": "solid", "color": {"type": "rgb", "value": [0.1, -0.7, 3.3]}})
    assert np.ravel(texture.color_at(mi.Point3d(1, 2, 3))).tolist() == [0.1, -0.7, 3.3]
    single = np.array([0.1, -0.7, 3.3], np.float32)
    assert np.array_equal(np.ravel(texture.eval(mi.SurfaceInteraction3f())), single)
    assert not texture.is_spatially_varying()
    parameters = mi.traverse(texture)
    parameters["color"] = mi.Color3f(0.5, 0.25, 0)
    parameters.update()
    assert np.ravel(texture.color_at(mi.Point3d(0))).tolist() == [0.5, 0.25, 0]


def test_checker_has_its_edges_at_whole_numbers_of_sizes(mi):
    """0.3 / 0.1 lies below 3, by its roundings only."""
    texture = mi.load_dict(
        {
            "type": "solid_checker",
            "first": {"type": "rgb", "value": [1.0, 0.0, 0.0]},
            "second": {"type": "rgb", "value": [0.0, 1.0, 0.0]},
            "size": 0.1,
        }
    )
    tile = np.arange(-5000, 5001)
    found = np.asarray(texture.color_at(mi.Point3d(mi.Float64(tile / 10), 0.05, 0.05)).x)
    assert np.array_equal(found, tile % 2 == 0)


def test_projected_bitmap_truncates_and_repeats(mi):
    texels = np.arange(12, dtype=np.float32).reshape(2, 2, 3)
    texture = mi.load_dict(
        {"type": "projected_bitmap", "data": mi.TensorXf(texels), "to_s": "1 0 0 0", "to_r": "0 1 0 0"}
    )

    def texel(s, r):
        return int(texture.color_at(mi.Point3d(s, r, 0)).x[0]) // 3

    assert [texel(s, 0.0) for s in (0.0, 0.4, 0.5, 1.0, 1.6, -0.4, -0.5, -0.6, -1.1)] == [0, 0, 1, 0, 1, 0, 1, 1, 0]
    assert [texel(0.0, r) for r in (0.0, 0.4, 0.5, -0.4, -0.6)] == [0, 0, 2, 0, 2]
    assert texel(math.nan, 1e300) in (0, 1, 2, 3)


def test_every_width_of_a_projected_bitmap_repeats_exactly(mi):
    """Dr.Jit would multiply by the width's rounded reciprocal, and miss by a whole image."""
    from mitsuba_plugins.intersection.columns import column

    repeats = 4
    for width in range(1, 2049):
        texels = np.repeat(np.arange(width, dtype=np.float32), 3).reshape(1, width, 3)
        texture = mi.load_dict(
            {"type": "projected_bitmap", "data": mi.TensorXf(texels), "to_s": "1 0 0 0", "to_r": "0 0 0 0"}
        )
        whole = np.arange(-repeats * width, repeats * width + 1)
        found = np.asarray(texture._wrap(column(mi.Float64, whole), texture.width))
        assert np.array_equal(found, whole % width), width
        # Numbers of which all products with the width are doubles.
        sixteenths = np.arange(-16 * repeats, 16 * repeats + 1)
        found = np.asarray(texture.color_at(mi.Point3d(column(mi.Float64, sixteenths / 16), 0, 0)).x)
        position = np.abs(sixteenths) * width // 16 * np.sign(sixteenths)
        assert np.array_equal(found, position % width), width


# ---- NumPy's memory

AT_THE_END = """
import ctypes, mmap
import numpy as np
import mitsuba_plugins, mitsuba as mi
from mitsuba_plugins.intersection.columns import column

mitsuba_plugins.set_variant({variant!r})
memory = mmap.mmap(-1, 2 * mmap.PAGESIZE)
start = ctypes.addressof(ctypes.c_char.from_buffer(memory))
count, offset = 17, mmap.PAGESIZE - 17 * 8
numbers = np.frombuffer(memory, np.float64, count, offset)
numbers[:] = np.arange(count)
assert ctypes.CDLL(None).mprotect(ctypes.c_void_p(start + mmap.PAGESIZE), ctypes.c_size_t(mmap.PAGESIZE), 0) == 0
print(np.asarray({kind}(mi.Float64, numbers) + 1).sum(), flush=True)
"""


def at_the_end(kind):
    program = AT_THE_END.format(variant=VARIANT, kind=kind)
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)


@pytest.mark.skipif(VARIANT != "llvm_ad_rgb", reason="only LLVM's kernels read NumPy's memory in place")
def test_drjit_reads_past_the_end_of_numpys_memory():
    """Why `column` exists: a kernel reads whole packets. Where this does not fail any more, it is not needed."""
    assert at_the_end("(lambda kind, numbers: kind(numbers))").returncode == -signal.SIGSEGV


def test_columns_end_where_their_numbers_end(mi):
    result = at_the_end("column")
    assert (result.stdout, result.stderr) == ("153.0\n", "")


# ---- The BSDF


@pytest.mark.parametrize("side", [1, -1])
def test_phong_is_the_course_formula(mi, phong, side):
    bsdf = phong(kd=0.4, ks=0.3, alpha=20.0)
    wi, wo = np.array([0.6, 0.0, 0.8]), np.array([-0.5, 0.1, math.sqrt(1 - 0.26)])
    flip = np.array([1, 1, side])
    value = bsdf.eval(mi.BSDFContext(), interaction(mi, wi * flip), vector(mi, wo * flip))
    mirror = np.array([-wi[0], -wi[1], wi[2]])
    expected = 0.4 * np.array([0.5, 0.25, 1.0]) * wo[2] + 0.3 * (mirror @ wo) ** 20
    assert np.allclose(np.asarray(value).ravel() * math.pi, expected, rtol=1e-5)
    assert not np.asarray(bsdf.eval(mi.BSDFContext(), interaction(mi, wi * flip), vector(mi, -wo * flip))).any()


def test_phong_blinn_uses_the_half_vector(mi, phong):
    bsdf = phong(ks=1.0, alpha=50.0, blinn=True)
    wi, wo = np.array([0.6, 0.0, 0.8]), np.array([-0.5, 0.1, math.sqrt(1 - 0.26)])
    half = (wi + wo) / np.linalg.norm(wi + wo)
    value = bsdf.eval(mi.BSDFContext(), interaction(mi, wi), vector(mi, wo))
    assert np.asarray(value).ravel()[0] * math.pi == pytest.approx(half[2] ** 50, rel=1e-5)


def test_phong_alpha_zero_is_a_full_highlight(mi, phong):
    bsdf = phong(ks=0.25, alpha=0.0)
    value = bsdf.eval(mi.BSDFContext(), interaction(mi, (0.0, 0.0, 1.0)), mi.Vector3f(0.8, 0, 0.6))
    grazing = bsdf.eval(mi.BSDFContext(), interaction(mi, (0.8, 0.0, 0.6)), mi.Vector3f(0.8, 0, 0.6))
    assert np.asarray(value).ravel()[0] * math.pi == pytest.approx(0.25)
    assert np.asarray(grazing).ravel()[0] * math.pi == pytest.approx(0.25), "0 ** 0 is 1"


@pytest.mark.parametrize(
    "coefficients", [{"kd": 1.0}, {"ks": 1.0, "alpha": 30.0}, {"ks": 1.0, "alpha": 30.0, "blinn": True}]
)
def test_phong_samples_what_it_evaluates(mi, phong, coefficients):
    bsdf = phong(**coefficients)
    n = 400_000
    rng = mi.PCG32(size=n)
    u = lambda: rng.next_float32()  # noqa: E731
    si = interaction(mi, (0.48, 0.36, 0.8))
    bs, weight = bsdf.sample(mi.BSDFContext(), si, u(), mi.Point2f(u(), u()))
    sampled = np.asarray(weight).mean(axis=1)
    wo = mi.warp.square_to_uniform_hemisphere(mi.Point2f(u(), u()))
    integral = 2 * math.pi * np.asarray(bsdf.eval(mi.BSDFContext(), si, wo)).mean(axis=1)
    assert np.allclose(sampled, integral, rtol=0.03)
    pdf = 2 * math.pi * np.asarray(bsdf.pdf(mi.BSDFContext(), si, wo)).mean()
    above = (np.asarray(bs.wo)[2] > 0).mean()
    assert pdf == pytest.approx(above, rel=0.03)


def test_phong_mirror_and_refracted_lobes(mi, phong):
    bsdf = phong(kr=0.25, kt=0.75, eta=1 / 1.5)
    wi = (0.6, 0.0, 0.8)
    mirrored, weight = bsdf.sample(mi.BSDFContext(), interaction(mi, wi), 0.1, mi.Point2f(0.5))
    assert np.allclose(np.asarray(mirrored.wo).ravel(), [-0.6, 0, 0.8], atol=1e-6)
    refracted, _ = bsdf.sample(mi.BSDFContext(), interaction(mi, wi), 0.9, mi.Point2f(0.5))
    sine = 0.6 / 1.5
    assert np.allclose(np.asarray(refracted.wo).ravel(), [-sine, 0, -math.sqrt(1 - sine**2)], atol=1e-6)
    assert np.asarray(weight).ravel().tolist() == [1, 1, 1]
    # From inside, past the critical angle.
    total, _ = bsdf.sample(mi.BSDFContext(), interaction(mi, (0.8, 0.0, -0.6)), 0.9, mi.Point2f(0.5))
    assert np.allclose(np.asarray(total.wo).ravel(), [-0.8, 0, -0.6], atol=1e-6)
    only_mirror = mi.BSDFContext()
    only_mirror.component = 2
    assert bsdf.sample(only_mirror, interaction(mi, wi), 0.9, mi.Point2f(0.5))[0].wo.z[0] > 0


# ---- The emitter


def test_attenuated_point_light(mi):
    light = mi.load_dict(
        {
            "type": "attenuated_point",
            "position": [0.0, 3.0, 4.0],
            "color": {"type": "rgb", "value": [1.0, 0.5, 2.0]},
            "attenuation": [0.5, 0.25, 0.125],
        }
    )
    ds, irradiance = light.sample_direction(interaction(mi, (0, 0, 1)), mi.Point2f(0))
    assert ds.dist[0] == pytest.approx(5)
    expected = math.pi * np.array([1, 0.5, 2]) / (0.5 + 0.25 * 5 + 0.125 * 25)
    assert np.allclose(np.asarray(irradiance).ravel(), expected, rtol=1e-6)


def test_a_light_with_a_radius_is_a_disc_that_faces_what_it_lights(mi):
    light = mi.load_dict(
        {
            "type": "attenuated_point",
            "position": [0.0, 3.0, 4.0],
            "color": {"type": "rgb", "value": [1.0, 1.0, 1.0]},
            "radius": 2.0,
        }
    )
    u = (np.arange(20) + 0.5) / 20
    x, y = (mi.Float(a.ravel()) for a in np.meshgrid(u, u))
    ds, _ = light.sample_direction(interaction(mi, (0, 0, 1)), mi.Point2f(x, y))
    arms = np.asarray(ds.p).T - (0, 3, 4)
    assert np.abs(arms @ (0, 3, 4)).max() < 1e-4
    lengths = np.linalg.norm(arms, axis=1)
    assert lengths.max() <= 2 + 1e-5
    assert (lengths**2).mean() == pytest.approx(2, rel=0.02)  # uniform over the area: half of that of the edge


# ---- The sensor


@pytest.mark.parametrize("pixel", [0.0, -0.5])
def test_pinhole_is_mitsubas_perspective(mi, pixel):
    film = {"type": "hdrfilm", "width": 80, "height": 60, "rfilter": {"type": "box"}}
    eye, look_at, up = [1.0, 2.0, 3.0], [0.5, 0.0, -4.0], [0.1, 1.0, 0.2]
    pinhole = mi.load_dict(
        {"type": "pinhole", "eye": eye, "look_at": look_at, "up": up, "fovy": 50.0, "pixel_offset": pixel, "film": film}
    )
    perspective = mi.load_dict(
        {
            "type": "perspective",
            "fov": 50.0,
            "fov_axis": "y",
            "principal_point_offset_x": pixel / 80,
            "principal_point_offset_y": pixel / 60,
            "to_world": mi.ScalarTransform4f().look_at(origin=eye, target=look_at, up=up),
            "film": film,
        }
    )
    position = mi.Point2f([0.01, 0.3, 0.99], [0.02, 0.7, 0.95])
    ours, _ = pinhole.sample_ray(0.0, 0.0, position, mi.Point2f(0))
    theirs, _ = perspective.sample_ray(0.0, 0.0, position, mi.Point2f(0))
    assert np.abs(np.asarray(ours.d) - np.asarray(theirs.d)).max() < 1e-6


def test_pinhole_sends_the_course_rays(mi):
    film = {"type": "hdrfilm", "width": 4, "height": 2}
    pinhole = mi.load_dict(
        {"type": "pinhole", "eye": [0, 0, 0], "look_at": [0, 0, -1], "up": [0, 1, 0], "fovy": 90.0, "film": film}
    )
    origin, direction = pinhole.primary_ray(mi.Point2d(0, 0))
    # The top left corner of a window that is twice as wide as high: view down -z, right is +x.
    assert np.allclose(np.asarray(direction).ravel(), np.array([-2, 1, -1]) / math.sqrt(6), atol=1e-15)
    assert not np.asarray(origin).any()


# ---- What Dr.Jit gets wrong


def test_quotients_are_rounded_once(mi):
    import drjit as dr

    from mitsuba_plugins.arithmetic import quotient

    rng = np.random.default_rng(1)
    v, b = rng.normal(size=(3, 1000)), rng.normal(size=1000)
    vector, scalar = mi.Vector3d(v), mi.Float64(b)
    constant = mi.Float64(49)
    for found, expected in (
        (quotient(vector, scalar), v / b),
        (quotient(vector, vector), v / v),
        (quotient(vector, 49), v / 49),
        (quotient(1, vector), 1 / v),
        (quotient(scalar, 49), b / 49),
        (quotient(scalar, constant), b / 49),
        (quotient(mi.Float64(1), dr.full(mi.Float64, 49, 1000)), np.full(1000, 1 / 49)),
        (quotient(7, constant), np.array([7 / 49])),
    ):
        assert np.array_equal(np.asarray(found), expected)
    assert isinstance(quotient(mi.Point3d(v), scalar), mi.Point3d)


HOST_DIVISIONS = {
    "intersection/box_tree.py": {"without_large_nodes"},
    "intersection/columns.py": {"column"},
    "intersection/geometry.py": {"surrounding_ball"},
    "intersection/leaf_table.py": {"_sphere_around"},
    "intersection/primitives.py": {"_pieces"},
    "intersection/rounding.py": {"camera_errors"},
    "intersection/shapes/polyhedron.py": {"contacts", "_normalised"},
    "intersection/shapes/quadric.py": {"_form", "_rows", "_anchor", "_contact"},
    "intersection/shapes/sphere.py": {"contacts"},
    "integrators/pace.py": {"__init__", "rows", "samples", "passes", "launch"},
    "integrators/parameters.py": {"read_parameters"},
    "sampler.py": {"disc_point", "cone_direction", "_small_turn"},
    "trial.py": {"_memory"},
    "integrators/pictures.py": {"bands_by_passes", "signed_bands", "chosen_pixels", "_stage", "told"},
    "integrators/pixels.py": {"sample_offsets", "place_in_tiles", "mean_colors"},
    "integrators/precisions.py": {"share_in_double"},
}
"""Functions that divide Python's or NumPy's numbers, or whole numbers, or build a path."""


def test_no_kernel_divides_but_by_quotient():
    """A vector over a scalar, a reciprocal, or a divisor that is known when the kernel is recorded is inexact."""
    folder = Path(mitsuba_plugins.__file__).parent
    found = []
    for file in sorted(folder.rglob("*.py")):
        module = str(file.relative_to(folder))
        for function in ast.walk(ast.parse(file.read_text())):
            if not isinstance(function, ast.FunctionDef) or function.name in HOST_DIVISIONS.get(module, ()):
                continue
            for node in ast.walk(function):
                divides = isinstance(getattr(node, "op", None), ast.Div | ast.FloorDiv | ast.Mod)
                if divides or (isinstance(node, ast.Attribute) and node.attr in ("rcp", "rsqrt", "normalize")):
                    found.append((module, function.name))
    assert found == [("arithmetic.py", "quotient")]


def test_drjit_exp2_in_double_precision_overflows_where_it_should_underflow(mi):
    """Shows why `rays.power` exists; when this fails, Dr.Jit has been mended and `power` may go."""
    import drjit as dr

    assert np.isinf(dr.exp2(mi.Float64(-1023.8))[0])


@pytest.mark.parametrize("sine", [0.28, 0.352, 0.6, 0.8, 0.936, 0.96])
def test_at_the_critical_angle_a_ray_is_refracted_along_the_surface(mi, sine):
    """Sines of Pythagorean triples, and frames of whole numbers."""
    from mitsuba_plugins.intersection.rays import refract

    cosine = round(math.sqrt(1 - sine**2), 3)
    frames = np.array(
        [[(2, 3, 6), (3, -6, 2)], [(6, 2, -3), (2, 3, 6)], [(1, 4, 8), (8, -4, 1)], [(0, 9, 0), (9, 0, 0)]]
    )
    normal, along = (frames[:, i] / np.linalg.norm(frames[:, i], axis=1)[:, None] for i in (0, 1))
    d = mi.Vector3d((sine * along - cosine * normal).T)
    bent, total, _ = refract(d, mi.Vector3d(normal.T), mi.Float64(1 / sine))
    assert not np.asarray(total).any()
    assert np.allclose(np.asarray(bent).T, along, atol=1e-15)


def test_power_underflows(mi):
    from mitsuba_plugins.intersection.rays import power

    base = np.linspace(0, 1, 20_001)
    for exponent in (0.0, 1.0, 1000.0, 1e6):
        result = np.asarray(power(mi.Float64(base), mi.Float64(exponent)))
        assert np.allclose(result, base**exponent, rtol=1e-9, atol=1e-290)


# ---- The integrator


@pytest.mark.parametrize("intersections", ["analytic", "bvh", "mesh", "offset"])
def test_symbolic_and_evaluated_loops_agree(mi, small_scene, intersections):
    """Dr.Jit compiles the integrator's loops; run step by step they must draw the same.

    Each bounce more has kernels of its own there, which take seconds to compile.
    """
    import drjit as dr

    from converter.to_mitsuba.load import load_description
    from converter.to_mitsuba.scene import scene_description

    scene = load_description(scene_description(small_scene, Settings(width=48, height=36, max_depth=2), intersections))
    symbolic = np.asarray(mi.render(scene))
    with (
        dr.scoped_set_flag(dr.JitFlag.SymbolicLoops, False),
        dr.scoped_set_flag(dr.JitFlag.SymbolicConditionals, False),
    ):
        evaluated = np.asarray(mi.render(scene))
    assert np.isfinite(symbolic).all()
    assert np.abs(symbolic - evaluated).max() < 1e-6


def test_parameters_may_be_changed_between_pictures(mi, small_scene):
    from converter.to_mitsuba.load import load_description
    from converter.to_mitsuba.scene import scene_description

    scene = load_description(scene_description(small_scene, Settings(width=48, height=36)))
    parameters = mi.traverse(scene.integrator())
    before = np.asarray(mi.render(scene))
    for name, value in (("cutoff", 2.0), ("max_depth", 0), ("ambient", mi.Color3d(0)), ("background", mi.Color3d(9))):
        kept = type(parameters[name])(parameters[name])
        parameters[name] = value
        parameters.update()
        assert (np.asarray(mi.render(scene)) != before).any(), name
        parameters[name] = kept
        parameters.update()
    assert np.array_equal(np.asarray(mi.render(scene)), before)


def test_direct_integrator_draws_the_same_light(mi, small_scene):
    """Mitsuba's own integrator with our BSDF and lights, on a scene without ambient light, mirrors and glass."""
    from dataclasses import replace

    from converter.to_mitsuba.load import load_description
    from converter.to_mitsuba.scene import scene_description

    matte = tuple(replace(f, ka=0.0, kr=0.0, kt=0.0) for f in small_scene.finishes)
    # One light, since `direct` picks one of several at random.
    scene = replace(small_scene, finishes=matte, ambient=(0.0, 0.0, 0.0), lights=small_scene.lights[:1])
    loaded = load_description(scene_description(scene, Settings(width=80, height=60)))
    whitted = np.asarray(mi.render(loaded))
    direct = np.asarray(mi.render(loaded, integrator=mi.load_dict({"type": "direct"}), spp=1))
    differ = (np.abs(whitted - direct) > 1 / 255).any(axis=-1)
    assert whitted.max() > 0.3
    assert differ.mean() < 0.03, "shadow edges and silhouettes only: Mitsuba's rays are in single precision"


def described(scene, **changes):
    """What Mitsuba loads by itself, for the exact surfaces alone, with changes of the integrator."""
    from converter.to_mitsuba.scene import scene_description

    made = scene_description(scene, Settings(width=40, height=30, pixel="center"), with_shapes=False)
    return made | {"integrator": made["integrator"] | changes}


def test_the_integrator_traces_rays_of_others(mi, small_scene):
    """Of an integrator that it is nested in, and of Mitsuba's own camera."""
    made = described(small_scene)
    expected = np.asarray(mi.render(mi.load_dict(made, optimize=False)))
    nested = made | {"integrator": {"type": "aov", "aovs": "t:depth", "image": made["integrator"]}}
    camera = small_scene.camera
    view = mi.ScalarTransform4f().look_at(camera.eye, camera.look_at, camera.up)
    other = {
        "type": "perspective",
        "fov": camera.fovy,
        "fov_axis": "y",
        "to_world": view,
        "film": made["sensor"]["film"],
    }
    for changed in (nested, made | {"sensor": other}):
        found = np.asarray(mi.render(mi.load_dict(changed, optimize=False), spp=1))[..., :3]
        assert (np.abs(found - expected).max(axis=2) > 1 / 255).mean() < 0.01


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"filename": "a.json"}, "give either 'geometry' or 'filename'"),
        ({"geometry": "[]"}, "'geometry' does not describe surfaces"),
        ({"geometry": '{"a": {"material": "m"}}'}, "'geometry' gives a none of"),
        ({"geometry": '{"a": {"material": "m", "sphere": [0, 0, 0, 1]}}'}, "names a material 'm', and no BSDF"),
        (
            {"geometry": '{"a": {"material": "m", "sphere": [0, 0, 0, 1]}}', "m": {"type": "diffuse"}},
            "is a 'phong' BSDF",
        ),
        ({"intersections": "embree"}, "intersections is one of"),
        ({"precision": "half"}, "precision is double, float or mixed, not 'half'"),
        ({"precision": "mixed", "intersections": "mesh"}, "precision mixed is for analytic and bvh, not for 'mesh'"),
        ({"points": "random"}, "points is stratified or independent, not 'random'"),
    ],
)
def test_an_integrator_that_makes_no_sense_is_refused(mi, small_scene, changes, message):
    with pytest.raises(Exception, match=f"whitted: .*{message}"):
        mi.load_dict(described(small_scene, **changes), optimize=False)


def test_lights_and_samples_that_the_integrator_does_not_know(mi, small_scene):
    made = described(small_scene)
    loaded, lamp = (mi.load_dict(each, optimize=False) for each in (made, made | {"lamp": {"type": "point"}}))
    with pytest.raises(ValueError, match="every light is an 'attenuated_point', found"):
        lamp.integrator().render(lamp, spp=1)
    with pytest.raises(ValueError, match="a grid, and 3 is no square number"):
        loaded.integrator().render(loaded, spp=3)


def test_rows_of_a_texture_have_four_numbers(mi):
    with pytest.raises(Exception, match="to_s and to_r take 4 numbers each, got '1 2 3'"):
        mi.load_dict(
            {"type": "projected_bitmap", "data": mi.TensorXf(np.ones((1, 1, 3))), "to_s": "1 2 3", "to_r": "0 0 0 0"}
        )
