"""The native tracer as one of the renderers: scenes of the model come out as their closed forms say."""

import sys
import types
from array import array
from pathlib import Path

import pytest

from converter.renderers.base import Interrupted
from converter.renderers.native import NativeRenderer
from converter.scene.model import (
    Camera,
    Checker,
    Finish,
    Light,
    Object,
    Polyhedron,
    Scene,
    Solid,
    Sphere,
    Texmap,
)
from converter.scene.settings import Settings

DOWN = Camera(eye=(0, 1, 0), look_at=(0, 0, 0), up=(0, 0, -1), fovy=40)
FLOOR = Polyhedron(((0, 2, 0, 0),))
MATTE = Finish(ka=0.25, kd=0.5, ks=0, alpha=1, kr=0, kt=0, ior=0)
ONE_PIXEL = Settings(width=1, height=1, pixel="center")


def scene_of(pigment, finish=MATTE, shape=FLOOR, lights=(), **values):
    return Scene(
        camera=DOWN,
        ambient=(1, 1, 1),
        lights=lights,
        pigments=(pigment,),
        finishes=(finish,),
        objects=(Object(0, 0, shape),),
        **values,
    )


def pixel(scene, settings=ONE_PIXEL, precision="double"):
    rendering = NativeRenderer(precision).render(scene, settings)
    assert (rendering.width, rendering.height) == (settings.width, settings.height)
    return tuple(memoryview(rendering.pixels).tolist()[0][0])


@pytest.mark.parametrize("precision", ["float", "double", "long double"])
def test_a_lit_floor(precision):
    light = Light((0, 2, 0), (1, 0.5, 0.25), (0, 1, 0))
    assert pixel(scene_of(Solid((1, 1, 1)), lights=(light,)), precision=precision) == (0.5, 0.375, 0.3125)


def test_seconds_and_statistics():
    rendering = NativeRenderer().render(scene_of(Solid((1, 1, 1))), Settings(width=20, height=10, threads=2))
    assert list(rendering.seconds) == ["build", "render"]
    assert rendering.statistics["rays"] == rendering.statistics["primary"] == 200
    assert rendering.statistics["threads"] in (1, 2)


def test_background_is_the_ambient_light_unless_set():
    scene = scene_of(Solid((1, 1, 1)), shape=Sphere((0, 5, 0), 1))
    assert pixel(scene) == (1, 1, 1)
    assert pixel(scene, Settings(width=1, height=1, background=(0.5, 0, 0.25))) == (0.5, 0, 0.25)


def test_checker():
    assert pixel(scene_of(Checker((1, 0, 0), (0, 1, 0), 3))) in ((0.25, 0, 0), (0, 0.25, 0))


def test_glass_is_read_by_the_setting():
    # A ray along the normal is not bent; the reading shows in what a slanted one hits.
    glass = Finish(ka=0, kd=0, ks=0, alpha=1, kr=0, kt=1, ior=1.5)
    scene = scene_of(Solid((1, 1, 1)), glass)
    auto, index, ratio = (
        NativeRenderer().trace_pixel(scene, Settings(width=3, height=3, ior=ior), 0, 0)["rays"][0]["children"][0]
        for ior in ("auto", "index", "ratio")
    )
    assert auto["direction"] == index["direction"] != ratio["direction"]
    assert auto["direction"][1] < ratio["direction"][1]


def test_only_textures_in_use_are_read(monkeypatch):
    read = []

    def read_texture(path, place):
        read.append(path)
        return types.SimpleNamespace(width=2, height=1, texels=array("f", [1, 0, 0, 0, 1, 0]))

    monkeypatch.setitem(sys.modules, "converter.images.texture", types.SimpleNamespace(read_texture=read_texture))
    used = Texmap(Path("used.ppm"), (0, 0, 0, 0.75), (0, 0, 0, 0))
    unused = Texmap(Path("unused.ppm"), (0, 0, 0, 0), (0, 0, 0, 0))
    scene = Scene(
        camera=DOWN,
        ambient=(1, 1, 1),
        lights=(),
        pigments=(unused, used),
        finishes=(MATTE,),
        objects=(Object(1, 0, FLOOR),),
    )
    assert pixel(scene) == (0, 0.25, 0)
    assert read == [Path("used.ppm")]


def test_plane_numbers_are_the_scenes():
    # The first plane cuts nothing and is left out; the ray's hit is on the second.
    shape = Polyhedron(((0, 1, 0, -9), (0, 1, 0, 0), (0, -1, 0, -1)))
    tree = NativeRenderer().trace_pixel(scene_of(Solid((1, 1, 1)), shape=shape), ONE_PIXEL, 0, 0)
    assert tree["rays"][0]["hit"]["plane"] == 1
    assert tree["color"] == (0.25, 0.25, 0.25)


def test_a_stopped_rendering_is_handed_over():
    mirror = Finish(ka=0, kd=0, ks=0, alpha=1, kr=1, kt=1, ior=1)
    scene = scene_of(Solid((1, 1, 1)), mirror, Sphere((0, 0, 0), 5))

    def progress(_):
        raise KeyboardInterrupt

    with pytest.raises(Interrupted) as caught:
        NativeRenderer().render(scene, Settings(width=40, height=30, cutoff=0, max_depth=60), progress)
    partial = caught.value.partial
    assert memoryview(partial.pixels).shape == (30, 40, 3)
    assert partial.statistics["primary"] > 0
