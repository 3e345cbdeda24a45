"""Regions in which methods are known to fail: what is told of them, and that the stability study finds no others."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from variant import VARIANT

from converter.analysis.regions.warnings import REGIONS, method_warnings, region_warnings
from converter.certify.certificate import certify
from converter.commands.main import main
from converter.renderers.base import RendererUnavailable
from converter.renderers.methods import METHODS
from converter.scene.model import Checker, Csg, Finish, Operand, Polyhedron, Quadric, Texmap
from converter.scene.parser import load_scene
from converter.scene.settings import Settings
from converter.shapes import quadric
from converter.studies.families import FAMILIES, ties
from converter.studies.families.scenes import (
    GLASS,
    GLOW,
    MATTE,
    MIRROR,
    WHITE,
    box,
    camera,
    floor,
    light,
    scene,
    sphere,
)
from converter.studies.stability import TRUTH, study_family
from converter.studies.worker import CERTIFICATE, DrawingFailed

SCENES = Path(__file__).parents[1] / "scenes"
VIEW = camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0))
BALL = (sphere((0.0, 0.0, 0.0), 1.0), WHITE, MATTE)
FLOOR = (floor(-1.0), WHITE, MATTE)
LAMP = light((3.0, 4.0, 5.0))
USUAL = {"double": "native", "float": "native-float", "mesh": "mitsuba-mesh"}
OFF = {"offset": "mitsuba-offset", "ulp": "mitsuba-ulp"}


def warnings(made, method):
    return region_warnings(made, Settings(), METHODS[method])


def far_ball(distance):
    return scene(camera((0.0, 0.0, distance), (0.0, 0.0, 0.0)), [BALL])


def two(first, second, finish=MATTE):
    return scene(VIEW, [(first, WHITE, finish), (second, WHITE, finish)])


def less(first, second):
    return Csg((Operand("+", first), Operand("-", second)))


def tiled(shape, pigment):
    return scene(VIEW, [(shape, pigment, GLOW)])


SHINY = Finish(0.1, 0.1, 0.5, 2e4, 0.0, 0.0, 1.0)
SLIVER = Polyhedron(((-1e-7, 1.0, 0.0, -1e-7), (0.0, -1.0, 0.0, 0.0), (1.0, 0.0, 0.0, -1.0), (0.0, 0.0, 1.0, -1.0)))
SLIVER = Polyhedron((*SLIVER.planes, (0.0, 0.0, -1.0, -1.0)))
CLOSE = sphere((0.0, 0.0, 0.0), 1.0 - 1e-7)
MIRRORS = [(sphere((0.0, 0.0, z), r), WHITE, MIRROR) for z, r in ((0.0, 9.0), (-2.0, 1.0), (-5.0, 1.0))]
CONE = Quadric((1.0, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, -1.0))
EGG = Quadric((1.0, 2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0))
ROOM = box((-5.0, -5.0, -5.0), (5.0, 5.0, 5.0))


@pytest.mark.parametrize(
    ("made", "method", "part"),
    [
        (far_ball(1e6), "native-float", "object 0 is 1e+06 of its radii from the camera (more than 1e+05)"),
        (far_ball(1e6), "mitsuba-analytic-float", "is 1e+06 of its radii from the camera"),
        (far_ball(3e3), "mitsuba-offset", "is 3e+03 of its radii from the camera (more than 1e+03)"),
        (scene(VIEW, [(sphere((3e5, 0.0, 0.0), 1.0), WHITE, MATTE)]), "mitsuba-mesh", "of its radii from the origin"),
        (scene(VIEW, [(box((3e5, 0.0, 0.0), (3e5 + 1, 1.0, 1.0)), WHITE, MATTE)]), "native-float", "from the origin"),
        (
            two(BALL[0], sphere((0.0, -1e6, 0.0), 1e6 - 1)),
            "native-float",
            "object 1 has 1e+06 times the radius of object 0 (more than 1e+05)",
        ),
        (scene(VIEW, [(floor(-1e10), WHITE, MATTE)]), "mitsuba-mesh", "object 0 is 1e+10 from the origin"),
        (scene(VIEW, [(SLIVER, WHITE, GLASS)]), "native-float", "object 0 is transparent and 5e-08 thick"),
        (
            two(floor(-1.0), Polyhedron(((0.0, -1.0, 0.0, -1.0 + 1e-6),))),
            "native-float",
            "plane 0 of object 0 is apart from plane 0 of object 1 by 2.5e-07 of the numbers",
        ),
        (two(floor(-1.0), floor(-1.0 + 1e-7)), "native-float", "is above or below plane 0 of object 1 by 2.5e-08"),
        (two(floor(-1.0), floor(-1.0 + 1e-5)), "mitsuba-mesh", "is above or below plane 0 of object 1 by 2.5e-06"),
        (two(BALL[0], CLOSE, GLASS), "native-float", "object 0 comes as near to object 1 as 1e-07 of its radius"),
        (
            scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 1e-4), [BALL]),
            "native-float",
            "on object 0, seen through a lens of 0.0001 degrees, a pixel is 1.5e-09 of the coordinates",
        ),
        (
            scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 1e-2), [(BALL[0], WHITE, MIRROR)]),
            "native-float",
            "on object 0, seen through a lens of 0.01 degrees, a pixel is 1.5e-07 of the coordinates",
        ),
        (
            scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 0.02), [FLOOR]),
            "mitsuba-mesh",
            "object 0 has no bounds, and is seen through a lens of 0.02 degrees (less than 0.11)",
        ),
        (
            scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 179.999), [BALL]),
            "mitsuba-mesh",
            "the camera's fovy is 179.999 degrees (more than 179.997)",
        ),
        (
            scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), up=(0.0, 1e-6, 1.0)), [BALL]),
            "native-float",
            "the camera's up vector is 1e-06 from its view (less than 3e-05 radians)",
        ),
        (
            scene(camera((0.0, 1 + 1e-9, 0.0), (0.0, 1.0, 1.0)), [(floor(1.0), WHITE, MATTE)]),
            "mitsuba-mesh",
            "the camera is 1e-09 of its coordinates from the surface of object 0",
        ),
        (
            scene(camera((0.0, 0.0, 1 - 1e-9), (0.0, 0.0, 0.0)), [(BALL[0], WHITE, GLASS)]),
            "native-float",
            "the camera is 1e-09 of its coordinates from the surface of object 0",
        ),
        (
            scene(camera((0.0, 0.0, 1.0), (0.0, 0.0, 2.0)), [BALL]),
            "mitsuba-offset",
            "the camera is 0 of its coordinates from the surface of object 0",
        ),
        (
            scene(VIEW, [FLOOR], [light((0.5, -1.0 + 1e-6, 0.0))]),
            "native-float",
            "light 1 is 1e-06 of its coordinates above plane 0 of object 0 (less than 2e-05)",
        ),
        (scene(VIEW, [BALL], [light((0.0, 1.00001, 0.0))]), "native-float", "light 1 is 1e-05 radii from the surface"),
        (
            scene(VIEW, [(BALL[0], WHITE, SHINY)], [light((0.0, 9.0, 0.0))]),
            "native-float",
            "finish 0 has an alpha of 20000 (more than 10000)",
        ),
        (
            tiled(floor(-1e5), Checker(WHITE, WHITE, 1e-3)),
            "native-float",
            "object 0 is 1e+08 tiles from the origin (more than 3.3e+06)",
        ),
        (
            tiled(BALL[0], Texmap(SCENES / "rainbow1.ppm", (0.0, 1.0, 0.0, 1e9), (0.0, 0.0, 0.0, 0.0))),
            "native-float",
            "object 0 is 1e+09 copies of its image from the origin",
        ),
        (
            scene(VIEW, [(less(BALL[0], sphere((0.0, 0.0, 0.0), 1.0 - 1e-8)), WHITE, MATTE)]),
            "native-float",
            "surfaces of the leaves 0 and 1 of object 0, a csg, are 2.5e-09 of their coordinates apart",
        ),
        (
            scene(VIEW, [(less(ROOM, box((-1.0, -1.0, -1.0), (1.0, 5.0 - 1e-6, 1.0))), WHITE, MATTE)]),
            "native-float",
            "surfaces of the leaves 0 and 1 of object 0, a csg, are 2e-07 of their coordinates apart (less than 5e-07)",
        ),
        (
            scene(VIEW, [(less(BALL[0], sphere((0.0, 0.0, 0.0), 1.0 - 1e-3)), WHITE, GLASS)]),
            "mitsuba-mesh",
            "object 0, a csg, which is transparent, are 0.00025 of their coordinates apart (less than 0.001)",
        ),
        (
            scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 1e-3), [(CONE, WHITE, GLOW)]),
            "native-float",
            "on object 0, seen through a lens of 0.001 degrees, a pixel is",
        ),
        (
            scene(camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), 1e-4), [(EGG, WHITE, GLOW)]),
            "mitsuba-mesh",
            "object 0, seen through a lens of 0.0001 degrees, is larger than its mesh is fine",
        ),
        (
            scene(VIEW, [(BALL[0], WHITE, replace(GLASS, ior=1.0 - 1e-7))]),
            "native-float",
            "finish 0 has an index that differs from 1 by 1e-07",
        ),
    ],
)
def test_a_region_in_which_a_method_fails_is_named_with_the_method_that_holds(made, method, part):
    (warning,) = [warning for warning in warnings(made, method) if part in warning]
    family = METHODS[method].family
    assert warning.endswith(f"where {method} is known to fail; --method {family} holds")
    assert not [warning for warning in warnings(made, family) if part in warning]


def test_balls_that_reflect_each_other_in_a_closed_room_are_named():
    made = scene(VIEW, MIRRORS)
    for method, most, depth in (("native-float", 12, 14), ("native", 48, None), ("mitsuba-mesh", 48, None)):
        (warning,) = region_warnings(made, Settings(max_depth=depth), METHODS[method])
        told = f"object 0 is one of 3 balls that reflect each other in a closed room, for {depth or 1000} bounces"
        assert f"{told} (more than {most})" in warning
        assert not region_warnings(made, Settings(max_depth=most), METHODS[method])
        assert not region_warnings(scene(VIEW, MIRRORS[1:]), Settings(), METHODS[method])  # rays get away


def test_mirrors_that_face_each_other_are_named_where_they_are_followed_far():
    made = scene(VIEW, [(ROOM, WHITE, MIRROR)])
    assert not region_warnings(made, Settings(max_depth=256), METHODS["native-float"])
    assert not region_warnings(scene(VIEW, [(floor(-1.0), WHITE, MIRROR)]), Settings(), METHODS["native-float"])
    (warning,) = region_warnings(made, Settings(), METHODS["native-float"])
    assert "object 0 is a mirror that is followed for 1000 bounces (more than 256)" in warning


@pytest.mark.parametrize("method", [m.name for m in METHODS.values() if m.arithmetic in USUAL])
def test_a_plain_scene_is_in_no_such_region(method):
    assert not method_warnings(scene(VIEW, [BALL, FLOOR], [LAMP]), Settings(), METHODS[method])


@pytest.mark.parametrize("file", sorted(SCENES.glob("*.in")), ids=lambda file: file.stem)
def test_no_scene_of_the_gallery_is(file):
    made = load_scene(file)
    for method in USUAL.values():
        assert not method_warnings(made, Settings(), METHODS[method])


def test_what_lies_on_a_surface_is_known_to_lie_there():
    on_ball = scene(camera((0.0, 0.0, 1.0), (0.0, 0.0, 2.0)), [BALL], [light((0.0, 1.0, 0.0))])
    on_floor = scene(camera((2.9, 2.4, 6.0), (0.0, 5.0, 6.0)), [(Polyhedron(((2.0, 3.0, 6.0, -49.0),)), WHITE, MATTE)])
    on_floor = replace(on_floor, lights=(light((2.9, 2.4, 6.0)),))
    for made in (on_ball, on_floor):
        for method in USUAL.values():
            assert not warnings(made, method)


def test_surfaces_that_do_not_meet_are_no_gap():
    """Two tables of nearly the same height, apart."""
    left, right = box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), box((3.0, 0.0, 0.0), (4.0, 1.0 + 1e-9, 1.0))
    assert not warnings(two(left, right), "native-float")
    assert warnings(two(left, box((0.5, 0.0, 0.5), (4.0, 1.0 + 1e-9, 1.5))), "native-float")


@pytest.mark.parametrize(
    "other",
    [
        sphere((0.0, 0.0, 0.0), 1.0),  # the same
        sphere((0.5, 0.0, 0.0), 0.5),  # touches it from within
        sphere((0.0, 2.0, 0.0), 1.0),  # touches it from without
        box((-1.0, -1.0, -1.0), (1.0, 1.0, 1.0)),
        sphere((0.0, 0.0, 0.0), 0.99),
    ],
)
def test_operands_that_touch_or_are_one_are_not_nearly_one(other):
    for operation in ("+", "-", "&"):
        made = Csg((Operand("+", BALL[0]), Operand(operation, other)))
        assert not warnings(scene(VIEW, [(made, WHITE, GLASS)]), "native-float")


def test_faces_of_operands_in_one_plane_that_are_apart_are_not_nearly_one():
    low = box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    for x, told in ((3.0, 0), (0.5, 1)):
        made = Csg((Operand("+", low), Operand("+", box((x, 0.25, 0.25), (4.0, 1.0 + 1e-7, 0.75)))))
        assert len(warnings(scene(VIEW, [(made, WHITE, MATTE)]), "native-float")) == told


def test_quadrics_are_compared_all_around():
    """A paraboloid that is nearly another is told of; not a cylinder that crosses it nearly where they are compared."""
    bowl, lower = (Quadric((1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, j)) for j in (0.0, -1e-8))
    inside, direction = np.array(quadric.facts([bowl])[0].inside), np.array((2, 1, 2)) / 3
    x, _, z = (inside + quadric.intersections(bowl, inside, direction)[-1].t * direction).tolist()
    crossing = Quadric((1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -(x * x + z * z) * (1 + 1e-9)))
    for other, told in ((lower, 1), (crossing, 0)):
        assert len(warnings(scene(VIEW, [(less(bowl, other), WHITE, MATTE)]), "native-float")) == told


def test_a_light_beside_a_face_is_not_low_above_it():
    table = (box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), WHITE, MATTE)
    assert warnings(scene(VIEW, [table], [light((0.5, 1.0 + 1e-9, 0.5))]), "native-float")
    assert not warnings(scene(VIEW, [table], [light((2.5, 1.0 + 1e-9, 0.5))]), "native-float")


def test_povray_is_not_known_that_well():
    assert method_warnings(far_ball(1e9), Settings(), METHODS["povray"]) == ()


def test_double_precision_has_an_end_too():
    made = scene(VIEW, [(sphere((3e14, 0.0, 0.0), 1.0), WHITE, MATTE)])
    (warning,) = warnings(made, "native")
    assert warning.endswith("where native is known to fail")


def test_the_worst_is_named_and_the_others_are_counted():
    made = scene(VIEW, [(sphere((x, 0.0, 0.0), 1.0), WHITE, MATTE) for x in (3e5, 5e5, 4e5)])
    (warning,) = [w for w in warnings(made, "mitsuba-mesh") if "origin" in w]
    assert "object 1 is 5e+05 of its radii" in warning
    assert "so are 2 others" in warning


@pytest.mark.parametrize("method", OFF.values())
def test_rays_that_start_off_their_surfaces_are_told_of_wherever_they_start(method):
    made = scene(VIEW, [BALL], [LAMP])
    (warning,) = set(method_warnings(made, Settings(), METHODS[method])) - set(warnings(made, method))
    assert "rays start up to" in warning
    assert not method_warnings(scene(VIEW, [(BALL[0], WHITE, GLOW)]), Settings(), METHODS[method])


def test_numbers_of_any_size_are_looked_through():
    for number in (1e-300, 1e300):
        ball = sphere((number, number, 0.0), number)
        made = scene(
            camera((0.0, 0.0, number), (0.0, 0.0, 0.0)),
            [(ball, Checker(WHITE, WHITE, number), GLASS), (floor(number), WHITE, MIRROR)],
            [light((number, number, number))],
        )
        for method in (*USUAL.values(), *OFF.values()):
            assert all(warning.isprintable() for warning in warnings(made, method))


def test_lines_of_the_file_are_named(tmp_path, capsys):
    file = tmp_path / "a.in"
    file.write_text(
        "0 0 4\n0 0 0\n0 1 0\n40\n2\n0 0 0 1 1 1 1 0 0\n0 1.00001 0 1 1 1 1 0 0\n"
        "1\nsolid 1 1 1\n1\n.2 .7 .5 20000 0 0 0\n1\n0 0 sphere 0 0 0 1\n"
    )
    assert main(["render", str(file), str(tmp_path / "a.ppm"), "8", "6", "--method", "native-float"]) == 0
    told = capsys.readouterr().err
    assert f"warning: {file}:7: light 1 is 1e-05 radii from the surface of object 0" in told
    assert f"warning: {file}:11: finish 0 has an alpha of 20000" in told
    assert main(["inspect", str(file), "--json", "-"]) == 0
    assert f"{file}:7: light 1 is 1e-05 radii" in capsys.readouterr().out


# ---- The study


class Here:
    """Draws in this process; what all methods are compared with only once."""

    def __init__(self):
        self._truths = {}

    def render(self, method, variant, scene, settings, seconds):
        if method not in (CERTIFICATE, TRUTH):
            return self._drawn(method, scene, settings)
        key = (method, scene, settings)
        if key not in self._truths:
            self._truths[key] = self._drawn(*key)
        return self._truths[key]

    def _drawn(self, method, scene, settings):
        try:
            if method == CERTIFICATE:
                return certify(scene, settings).colors
            return np.asarray(METHODS[method].renderer(VARIANT).render(scene, settings).pixels)
        except (RendererUnavailable, ValueError) as error:  # of nothing there is no mesh, nor of what moves
            raise DrawingFailed(str(error)) from error


@cache
def drawn_family(name):
    """A family whose cases are made once, and what draws them."""
    return replace(FAMILIES[name], case=cache(FAMILIES[name].case)), Here()


@cache
def outcomes(family, method):
    made, here = drawn_family(family)
    return study_family(made, [METHODS[method]], here).outcomes[method]


TIES = [family.name for family in ties.FAMILIES]
CASES = [
    (family, method) for family in FAMILIES for method in USUAL.values() if method == "native" or family not in TIES
]


@pytest.mark.parametrize(("family", "method"), CASES)
def test_no_method_fails_without_a_warning(mi, family, method):
    silent = [outcome.value for outcome in outcomes(family, method) if outcome.silent]
    assert silent == []


@pytest.mark.parametrize("method", [USUAL["float"], USUAL["mesh"]])
def test_single_precision_and_meshes_decide_no_ties(mi, method):
    """The README says so: whether a ray meets one is not known before it is traced."""
    failing = [family for family in TIES if not outcomes(family, method)[0].holds]
    assert len(failing) > 4


@pytest.mark.parametrize("region", REGIONS, ids=lambda region: ", ".join(region.families))
def test_every_region_is_one_in_which_methods_fail(mi, region):
    """In each family that leads into it, and with each arithmetic in some."""
    for arithmetic in region.limits:
        method = (USUAL | OFF)[arithmetic]
        failing = [
            family for family in region.families if any(o.warned and not o.holds for o in outcomes(family, method))
        ]
        assert failing, arithmetic
