"""A light outside of a polyhedron is dark from within, without a search."""

from dataclasses import replace

import numpy as np
import pytest
from test_apart import box
from variant import VARIANT

from converter.renderers.mitsuba import MitsubaRenderer
from converter.renderers.native import NativeRenderer
from converter.scene.model import Camera, Finish, Light, Object, Scene, Solid, Sphere
from converter.scene.settings import Settings

WHITE = (1.0, 1.0, 1.0)
CELL = Scene(
    camera=Camera((0, 2, 0), (0, 0, 0), (1, 0, 0), 30),
    ambient=(0, 0, 0),
    lights=(Light((0.5, 1, 0), WHITE, (1, 0, 0)),),
    pigments=(Solid(WHITE),),
    finishes=(Finish(0, 1, 0, 1, 0, 0.1, 1.5),),
    objects=(
        Object(0, 0, Sphere((0, 1.75, 0), 0.1)),
        Object(0, 0, box((-2, 0, -2), (2, 4, 2))),
        Object(0, 0, box((70, 0, -2), (72, 4, 2))),  # of which all lights lie outside
    ),
)


def blocker(scene, way):
    (record,) = MitsubaRenderer(VARIANT, intersections=way).trace_pixels(
        scene, Settings(2, 2, pixel="center"), [(1, 1)]
    )
    (light,) = record.rays[0].hit.lights
    assert record.rays[0].hit.object == 1
    return light.shadowed_by


@pytest.mark.parametrize("way", ["analytic", "bvh", "mesh"])
@pytest.mark.parametrize(("height", "expected"), [(1.5, None), (4 - 2**-12, None), (4 + 2**-12, 1), (30, 1)])
def test_a_light_near_a_wall_is_on_one_side_of_it(mi, way, height, expected):
    scene = replace(CELL, lights=(replace(CELL.lights[0], position=(0.5, height, 0)),))
    scene = replace(scene, camera=replace(CELL.camera, eye=(1, 3, 0), look_at=(1, 0, 0)))
    assert blocker(scene, way) == expected


@pytest.mark.parametrize("way", ["analytic", "bvh", "mesh"])
def test_the_body_is_named_that_is_seen_from_within(mi, way):
    """And not a ball on the way."""
    near = replace(CELL, lights=(replace(CELL.lights[0], position=(0, 2.5, 0)),))
    far = replace(CELL, lights=(replace(CELL.lights[0], position=(0, 30, 0)),))
    camera = replace(CELL.camera, eye=(0, 1, 0))
    assert blocker(replace(near, camera=camera), way) == 0
    assert blocker(replace(far, camera=camera), way) == 1


@pytest.mark.parametrize("place", [1.0, 2.25, 3.5])
def test_a_disc_in_a_wall_lights_the_room_with_its_inner_part(mi, place):
    scene = replace(CELL, lights=(Light((place, 2.25, 0), WHITE, (1, 0, 0), 0.75),))
    settings = Settings(16, 12, samples=16)
    native = np.asarray(NativeRenderer().render(scene, settings).pixels)
    for way in ("analytic", "bvh"):
        drawn = np.asarray(MitsubaRenderer(VARIANT, intersections=way).render(scene, settings).pixels)
        assert np.abs(drawn - native).max() < 1e-5
    assert (native.max() > 0) == (place < 3)
