"""Plates without thickness, as every method draws them: like thin slabs, from both sides.

What says that a ray enters a plate where it leaves it is the renderers' rule for ties.
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_halfspaces import PLATE, moved

from converter.analysis.coplanar import with_planes_shared
from converter.analysis.cutoff import cutoff_bound
from converter.analysis.regions.warnings import region_warnings
from converter.compare.margins import edge_margin, intersections, silhouette_margin, surface_margin
from converter.renderers.methods import METHODS
from converter.renderers.native import NativeRenderer
from converter.scene.model import Finish, Polyhedron, Scene, Solid
from converter.scene.needs import scene_needs
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import Settings
from converter.scene.writer import write_scene
from converter.studies.families.scenes import GLASS, MATTE, MIRROR, WHITE, camera, light, scene, sphere
from converter.to_mitsuba.bounds import Box
from converter.to_mitsuba.meshes import polyhedron_mesh
from converter.to_povray.scene import povray_scene

CASE = Path(__file__).parent / "corpus" / "drawn" / "plate.in"
SETTINGS = Settings(width=80, height=60, pixel="center")
EXACT = ("native", "native-long-double", "native-float", "native-bvh", "mitsuba", "mitsuba-bvh", "mitsuba-mesh")
LOOSE = ("mitsuba-offset", "mitsuba-ulp")
ABOVE, BELOW = (3.0, 2.0, -5.0), (3.1, -2.2, -5.3)
RED = Solid((0.9, 0.2, 0.1))


def drawn(made: Scene, method: str):
    return np.array(METHODS[method].renderer().render(made, SETTINGS).pixels)


def plate_scene(planes, finish: Finish, eye) -> Scene:
    balls = [(sphere((0.3, y, 0.0), 0.3), WHITE, MATTE) for y in (0.6, -0.6)]
    lights = [light((3.0, 4.0, -5.0), (0.6, 0.6, 0.6))]
    return scene(camera(eye, (0.0, 0.0, 0.0)), [(Polyhedron(tuple(planes)), RED, finish), *balls], lights)


def slab(planes, thickness: float):
    """The plate, whose upper side is lowered."""
    return [(*p[:3], p[3] + thickness) if k == 2 else p for k, p in enumerate(planes)]


def disagreeing(one, other) -> int:
    return int((np.abs(np.subtract(one, other)).max(axis=-1) > 1 / 255).sum())


@pytest.mark.parametrize("method", [*EXACT, *LOOSE])
def test_every_pixel_of_a_plate_is_hit(mi, method):
    made = load_scene(CASE)
    thick = replace(made.objects[0], shape=Polyhedron(tuple(slab(made.objects[0].shape.planes, -1e-9))))
    truth = drawn(replace(made, objects=(thick,)), "native")
    hit = np.abs(np.subtract(drawn(made, method), made.ambient)).max(axis=-1) > 1e-6
    assert 200 < hit.sum() < 300
    assert np.array_equal(hit, np.abs(np.subtract(truth, made.ambient)).max(axis=-1) > 1e-6)


@pytest.mark.parametrize("eye", [ABOVE, BELOW], ids=["above", "below"])
@pytest.mark.parametrize("finish", [MATTE, MIRROR], ids=["matte", "mirror"])
@pytest.mark.parametrize("seed", [None, 1, 2])
@pytest.mark.parametrize("method", [*EXACT, *LOOSE])
def test_a_plate_is_drawn_as_a_thin_slab(mi, method, finish, eye, seed):
    planes = PLATE if seed is None else moved(PLATE, seed, 1.0, 0.2)
    thick = slab(PLATE, -1e-7) if seed is None else moved(slab(PLATE, -1e-7), seed, 1.0, 0.2)
    truth = drawn(plate_scene(thick, finish, eye), "native")
    found = drawn(plate_scene(planes, finish, eye), method)
    assert disagreeing(found, truth) <= (2 if method in LOOSE else 0)


@pytest.mark.parametrize("eye", [ABOVE, BELOW], ids=["above", "below"])
@pytest.mark.parametrize("seed", [None, 1])
def test_a_clear_plate_bends_no_ray(mi, eye, seed):
    """A ray enters it and leaves it at once; Embree's methods do not, and their user is warned."""
    planes = PLATE if seed is None else moved(PLATE, seed, 1.0, 0.2)
    thick = slab(PLATE, -1e-7) if seed is None else moved(slab(PLATE, -1e-7), seed, 1.0, 0.2)
    truth = drawn(plate_scene(thick, GLASS, eye), "native")
    made = plate_scene(planes, GLASS, eye)
    for method in EXACT:
        warned = region_warnings(made, SETTINGS, METHODS[method])
        if method == "mitsuba-mesh":
            assert any("object 0 is transparent and has no thickness" in text for text in warned)
        else:
            assert not warned
            assert disagreeing(drawn(made, method), truth) == 0


def test_a_plate_blocks_light(mi):
    for method in ("native", "mitsuba", "mitsuba-mesh"):
        shades = []
        for x in (0.0, 50.0):  # between the lamp and the floor, and elsewhere
            plate = tuple((a, b, c, d - a * x) for a, b, c, d in PLATE)
            floor = (Polyhedron(((0.0, 1.0, 0.0, 2.0),)), WHITE, MATTE)
            view = camera((0.0, -1.0, -6.0), (0.0, -2.0, 0.0))
            lamp = light((0.0, 4.0, 0.0), (0.6, 0.6, 0.6))
            shades.append(drawn(scene(view, [(Polyhedron(plate), RED, MATTE), floor], [lamp]), method)[30, 40])
        assert shades[0].max() < 0.8 * shades[1].max()


def test_an_endless_sheet(mi):
    made = load_scene(CASE.with_name("plate_without_bounds.in"))
    assert scene_needs(made, SETTINGS).bounded == (False,)
    pictures = [
        drawn(replace(made, camera=replace(made.camera, look_at=(1.0, 0.1, 0.0))), method)
        for method in ("native", "native-long-double", "mitsuba", "mitsuba-bvh")
    ]
    assert all(disagreeing(picture, pictures[0]) == 0 for picture in pictures)
    assert np.abs(np.subtract(pictures[0], made.ambient)).max() > 0.1


@pytest.mark.parametrize(
    ("front", "back"),
    [
        ((1.0, 3.0, 2.0, -2.0), (-0.1, -0.3, -0.2, 0.2)),
        # As far apart as the sides of a plate may be.
        ((1.42, -1.99, 0.92, 1.28), (-1.4200000000000008, 1.989999999999999, -0.9199999999999996, -1.280000000000001)),
    ],
)
def test_the_sides_of_a_plate_get_the_same_numbers(front, back):
    made = plate_scene((front, back), MATTE, ABOVE)
    assert scene_needs(made, SETTINGS).plates == ((0, 1), (), ())
    a, b, c, d = front
    assert with_planes_shared(made).objects[0].shape == Polyhedron((front, (-a, -b, -c, -d)))


def test_the_mesh_of_a_plate_is_one_polygon():
    box = Box((-10.0,) * 3, (10.0,) * 3)
    mesh = polyhedron_mesh(PLATE, box)
    assert (len(mesh.vertices), mesh.planes.tolist(), mesh.outside) == (4, [2, 2], ())
    cut = polyhedron_mesh(PLATE[2:4], box)
    assert np.abs(cut.vertices).max(axis=0).tolist() == [10, 0, 10]


@pytest.mark.parametrize("direction", [(0.0, -1.0, 0.0), (0.0, 1.0, 0.0), (0.3, -0.9, 0.1)])
def test_what_differs_on_a_plate_is_not_explained_by_its_other_side(direction):
    d = np.array(direction) / np.linalg.norm(direction)
    shape = Polyhedron(tuple(PLATE))
    assert silhouette_margin(shape, -5 * d, d) > 0.4
    assert edge_margin(shape, -5 * d, d) > 0.4
    assert surface_margin(shape, np.zeros(3), on_it=True) == 1
    assert tuple(intersections(shape, -5 * d, d)[0]) == pytest.approx((5, d[1] if d[1] < 0 else 1))


def test_a_plate_for_povray():
    made = plate_scene(PLATE, GLASS, ABOVE)
    found = povray_scene(made, Settings())
    (clipped,) = re.findall(r"clipped_by \{(.*?)\n  \}", found.text, re.DOTALL)
    assert clipped.count("plane {") == 4
    assert "clipped_by" not in povray_scene(plate_scene(PLATE[2:4], MATTE, ABOVE), Settings()).text
    assert any("object 0 is transparent and has no thickness" in text for text in found.omissions)
    assert not any("thickness" in text for text in povray_scene(plate_scene(PLATE, MATTE, ABOVE), Settings()).omissions)


def test_a_plate_is_written_and_read_again():
    made = plate_scene(PLATE, MIRROR, ABOVE)
    assert parse_scene(write_scene(made)) == made
    assert scene_needs(made, SETTINGS).bounded == (True, True, True)
    assert cutoff_bound(made, Settings()).bound < 1
    assert NativeRenderer().trace_pixel(made, SETTINGS, 40, 30).rays[0].hit.plane == 2
