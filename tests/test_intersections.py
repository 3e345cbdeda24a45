"""The ways in which the integrator finds what a ray hits: exact at every scale and size of scene, or not so."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

from converter.compare.metrics import compare_pixels
from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.model import Checker, Polyhedron, Scene, Sphere, Texmap
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.to_mitsuba.fineness import Fineness

ROOT = Path(__file__).parent.parent
SETTINGS = Settings(width=160, height=120)


def scaled(scene: Scene, s: float) -> Scene:
    """The same scene in a unit of length s times smaller: its picture is the same."""

    def times(v):
        return tuple(s * x for x in v)

    def shape(of):
        if isinstance(of, Sphere):
            return replace(of, center=times(of.center), radius=s * of.radius)
        return Polyhedron(tuple((a, b, c, s * d) for a, b, c, d in of.planes))

    def pigment(of):
        if isinstance(of, Checker):
            return replace(of, size=s * of.size)
        if isinstance(of, Texmap):
            return replace(of, p0=(*(x / s for x in of.p0[:3]), of.p0[3]), p1=(*(x / s for x in of.p1[:3]), of.p1[3]))
        return of

    def attenuation(a, b, c):
        return a, b / s, c / s / s

    return replace(
        scene,
        camera=replace(scene.camera, eye=times(scene.camera.eye), look_at=times(scene.camera.look_at)),
        lights=tuple(
            replace(light, position=times(light.position), attenuation=attenuation(*light.attenuation))
            for light in scene.lights
        ),
        pigments=tuple(map(pigment, scene.pigments)),
        objects=tuple(replace(o, shape=shape(o.shape)) for o in scene.objects),
    )


def disagreeing(renderer, scene: Scene, reference: Scene | None = None) -> int:
    """Pixels of a renderer's picture that differ from the native tracer's, of another scene if one is given."""
    truth = NativeRenderer().render(reference or scene, SETTINGS)
    return compare_pixels(np.asarray(truth.pixels), np.asarray(renderer.render(scene, SETTINGS).pixels)).disagreeing


@pytest.mark.parametrize("intersections", ["analytic", "bvh"])
@pytest.mark.parametrize("scale", [2.0**-40, 2.0**-20, 2.0**-10, 2.0**10, 2.0**20, 2.0**40])
def test_exact_at_every_scale(mi, small_scene, intersections, scale):
    renderer = MitsubaRenderer(VARIANT, intersections)
    assert disagreeing(renderer, scaled(small_scene, scale), small_scene) == 0


@pytest.mark.parametrize("name", ["figure1", "infinity", "whitted"])
@pytest.mark.parametrize("scale", [0.001, 1000.0])
def test_the_default_draws_the_same_picture_at_every_scale(mi, name, scale):
    """Of scenes with spheres in spheres, long ways between mirrors, and glass, by both ways that are default."""
    scene = load_scene(ROOT / "scenes" / f"{name}.in")
    # A scale that is no power of two moves edges by roundings, and a checker's boundaries with them.
    assert disagreeing(MitsubaRenderer(VARIANT), scaled(scene, scale), scene) <= 2


@pytest.mark.parametrize(("kind", "size"), [("sphereflake", "3"), ("gallery", "300")])
def test_large_scenes(mi, tmp_path, kind, size):
    file = tmp_path / "large.in"
    subprocess.run([sys.executable, ROOT / "scenes" / "large.py", kind, size, file], check=True)
    assert disagreeing(MitsubaRenderer(VARIANT), load_scene(file)) == 0


@pytest.mark.parametrize(
    ("options", "share"),
    [
        ({"intersections": "analytic", "precision": "float"}, 0.005),
        ({"intersections": "bvh", "precision": "float"}, 0.005),
        ({"intersections": "ulp"}, 0.02),
        ({"intersections": "offset"}, 0.05),
        ({"intersections": "offset", "fineness": Fineness(spheres=0.001)}, 0.05),
    ],
    ids=str,
)
def test_single_precision_draws_nearly_the_same(mi, small_scene, options, share):
    """Wrong where a rounding decides, and nowhere else: a face or a shadow gone would be more than this."""
    wrong = disagreeing(MitsubaRenderer(VARIANT, **options), small_scene)
    assert wrong <= share * SETTINGS.width * SETTINGS.height


def test_spheres_as_meshes_keep_their_tolerance():
    from converter.to_mitsuba.meshing import unit_ball

    for tolerance in (0.1, 0.01, 0.001):
        ball = unit_ball(tolerance)
        corners = ball.vertices[ball.triangles]
        assert np.allclose(np.linalg.norm(corners, axis=2), 1)
        middles = np.linalg.norm(corners.mean(axis=1), axis=1)
        assert 1 - tolerance <= middles.min() < 1 - tolerance / 5
    with pytest.raises(ValueError, match="too many triangles"):
        unit_ball(1e-9)


@pytest.mark.parametrize("intersections", ["analytic", "bvh"])
def test_pictures_of_all_sizes_share_one_kernel(mi, small_scene, intersections):
    """A kernel costs tenths of a second; so none depends on the size of a picture, nor on where NumPy puts a table."""
    import drjit as dr

    renderer = MitsubaRenderer(VARIANT, intersections)
    kernels = set()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        for width in range(32, 42):
            dr.kernel_history_clear()
            renderer.render(small_scene, replace(SETTINGS, width=width))
            kernels |= {entry["hash"] for entry in dr.kernel_history() if entry.get("operation_count", 0) > 500}
    assert len(kernels) == 1


@pytest.mark.parametrize("intersections", ["analytic", "bvh", "mesh", "offset"])
def test_scenes_are_freed(mi, small_scene, intersections):
    """A scene holds its integrator, and would never be freed if that held the scene."""
    import gc

    import drjit as dr

    from converter.to_mitsuba.load import load_description
    from converter.to_mitsuba.scene import scene_description

    def highest_shape() -> int:
        scene = load_description(scene_description(small_scene, Settings(width=8, height=6), intersections))
        mi.render(scene)
        return int(dr.reinterpret_array(mi.UInt32, scene.shapes_dr()).numpy().max())

    highest_shape()
    gc.collect()
    first = highest_shape()
    for _ in range(3):
        gc.collect()
        assert highest_shape() <= first


def test_gpus_take_the_tree(mi, monkeypatch, small_scene):
    """For few surfaces it is as fast there, and compiled sooner; of none there is no tree."""
    from mitsuba_plugins.intersection import ways

    surfaces = MitsubaRenderer(VARIANT)._load(small_scene, SETTINGS).integrator().surfaces
    chosen = {}
    for gpu in (False, True):
        monkeypatch.setattr(ways, "on_gpu", lambda gpu=gpu: gpu)
        chosen[gpu] = [ways.way_for(*asked) for asked in ((surfaces, "auto"), (surfaces, "analytic"), ([], "auto"))]
    assert chosen == {False: ["analytic"] * 3, True: ["bvh", "analytic", "analytic"]}
