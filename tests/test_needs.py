"""What a scene needs, what is told of it, and which `ior` is which."""

import gc
import tracemalloc
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from strategies import scenes

from converter.analysis.notices import ior_notices, scene_notices
from converter.scene import kept
from converter.scene.depth import MAX_DEPTH
from converter.scene.geometry import check_geometry, scene_facts, simplified
from converter.scene.model import (
    Camera,
    Csg,
    Finish,
    Light,
    Object,
    Operand,
    Polyhedron,
    Scene,
    Shape,
    Solid,
    Sphere,
)
from converter.scene.needs import eta, is_index, scene_needs
from converter.scene.parser import load_scene, parse_scene
from converter.scene.settings import IorReading, Settings
from converter.scene.writer import write_scene
from converter.shapes import polyhedron
from converter.shapes.kind import Facts
from converter.to_mitsuba.bounds import scene_bounds

MATTE = Finish(0.2, 0.8, 0, 1, 0, 0, 0)
SHINY = Finish(0.2, 0.5, 0.5, 50, 0, 0, 0)
MIRROR = Finish(0.1, 0, 0, 1, 0.7, 0, 0)
GLASS = Finish(0, 0, 0, 1, 0, 0.9, 1.5)
BOTH = Finish(0, 0, 0, 1, 0.1, 0.8, 0.67)
AMBIENT = Finish(1, 0, 0, 1, 0, 0, 0)
LAMP = Light((0, 10, 0), (1, 1, 1), (1, 0, 0))


def scene_of(*finishes: Finish, unused: tuple[Finish, ...] = (), lights: tuple[Light, ...] = (LAMP,)) -> Scene:
    """A ball for each of `finishes`; `unused` ones stand before them in the scene's list."""
    first = len(unused)
    return Scene(
        camera=Camera((0, 0, -10), (0, 0, 0), (0, 1, 0), 40),
        ambient=(0.1, 0.2, 0.3),
        lights=lights,
        pigments=(Solid((1, 0, 0)), Solid((0, 1, 0))),
        finishes=(*unused, *finishes),
        objects=tuple(Object(1, first + k, Sphere((3 * k, 0, 0), 1)) for k in range(len(finishes))),
    )


def test_only_what_is_referred_to_is_needed() -> None:
    needs = scene_needs(scene_of(MATTE, SHINY, unused=(GLASS, MIRROR)), Settings())
    assert needs.pigments == (1,)
    assert needs.finishes == (2, 3)
    assert not (needs.reflects or needs.refracts or needs.branches or needs.bounces)
    assert needs.max_depth == 0
    assert len(needs.etas) == 4


@pytest.mark.parametrize(
    ("finishes", "reflects", "refracts", "branches"),
    [
        ((MATTE,), False, False, False),
        ((MIRROR,), True, False, False),
        ((GLASS,), False, True, False),
        ((MIRROR, GLASS), True, True, False),
        ((BOTH,), True, True, True),
    ],
)
def test_bounces(finishes: tuple[Finish, ...], reflects: bool, refracts: bool, branches: bool) -> None:
    needs = scene_needs(scene_of(*finishes), Settings())
    assert (needs.reflects, needs.refracts, needs.branches) == (reflects, refracts, branches)
    assert needs.bounces == (reflects or refracts)


def test_a_ray_below_the_cut_off_is_no_need() -> None:
    faint = replace(MIRROR, kr=0.01)
    assert scene_needs(scene_of(faint), Settings()).reflects
    needs = scene_needs(scene_of(faint), Settings(cutoff=0.02))
    assert not needs.reflects
    assert needs.max_depth == 0


def test_no_depth_no_bounce() -> None:
    needs = scene_needs(scene_of(BOTH), Settings(max_depth=0))
    assert not (needs.reflects or needs.refracts or needs.branches or needs.bounces)


@pytest.mark.parametrize(
    ("finish", "lights", "lit", "glossy"),
    [
        (MATTE, (LAMP,), True, False),
        (SHINY, (LAMP,), True, True),
        (SHINY, (), False, False),
        (AMBIENT, (LAMP,), False, False),
        (GLASS, (LAMP,), False, False),
    ],
)
def test_lighting(finish: Finish, lights: tuple[Light, ...], lit: bool, glossy: bool) -> None:
    needs = scene_needs(scene_of(finish, lights=lights), Settings())
    assert (needs.lit, needs.glossy) == (lit, glossy)


@pytest.mark.parametrize(
    ("finishes", "cutoff", "depth"),
    [
        ((MIRROR,), 1 / 512, 18),  # 0.7^18 < 1/512 < 0.7^17
        ((replace(MIRROR, kr=0.5),), 1 / 512, 9),
        ((replace(MIRROR, kr=0.5), MIRROR), 1 / 512, 18),
        ((replace(MIRROR, kr=1.0),), 1 / 512, MAX_DEPTH),
        ((replace(MIRROR, kr=0.99),), 1 / 512, 621),
        ((replace(MIRROR, kr=0.999),), 1 / 512, MAX_DEPTH),
        ((MIRROR,), 0, MAX_DEPTH),
        ((BOTH,), 1 / 512, 28),
        ((BOTH,), 0, 15),  # 2^16 - 1 rays
        ((replace(BOTH, kt=0.9),), 1 / 512, 60),
        ((replace(BOTH, kr=0.1, kt=0.1),), 1 / 512, 3),
        ((MATTE,), 1 / 512, 0),
        ((MATTE,), 0, 0),
    ],
)
def test_depth(finishes: tuple[Finish, ...], cutoff: float, depth: int) -> None:
    assert scene_needs(scene_of(*finishes), Settings(cutoff=cutoff)).max_depth == depth


@pytest.mark.parametrize(("name", "depth"), [("course_glass_9", 60), ("panes_33", 1000)])
def test_panes_are_followed_to_what_is_behind(name: str, depth: int) -> None:
    """Of n panes a ray crosses 2 n faces."""
    count = int(name.rpartition("_")[2])
    finish = Finish(0.1, 0.1, 0.8, 400, 0.1, 0.9, 1.45) if count == 9 else Finish(0, 0, 0, 1, 0, 1, 1)
    limit = scene_needs(scene_of(finish), Settings()).depth
    assert limit.bounces == depth > 2 * count
    assert limit.waiting <= 16


def test_depth_can_be_set() -> None:
    assert scene_needs(scene_of(MIRROR), Settings(max_depth=3)).max_depth == 3
    assert scene_needs(scene_of(MATTE), Settings(max_depth=3)).max_depth == 0


def test_background() -> None:
    assert scene_needs(scene_of(MATTE), Settings()).background == (0.1, 0.2, 0.3)
    assert scene_needs(scene_of(MATTE), Settings(background=(0, 0, 1))).background == (0, 0, 1)


@pytest.mark.parametrize(
    ("ior", "reading", "index"),
    [
        (1.5, "auto", True),
        (1.0, "auto", False),
        (0.67, "auto", False),
        (1.5, "ratio", False),
        (0.67, "ratio", False),
        (1.5, "index", True),
        (0.67, "index", True),
    ],
)
def test_readings_of_ior(ior: float, reading: IorReading, index: bool) -> None:
    finish = replace(GLASS, ior=ior)
    assert is_index(finish, reading) == index
    assert eta(finish, reading) == pytest.approx(1 / ior if index else ior)


def test_ior_means_nothing_without_transmission() -> None:
    for reading in ("auto", "ratio", "index"):
        assert eta(replace(MIRROR, ior=0), reading) == 1


@hypothesis_settings(max_examples=30, deadline=None)
@given(scenes(), st.sampled_from(["auto", "ratio", "index"]))
def test_needs_agree_with_the_scene(scene: Scene, reading: IorReading) -> None:
    needs = scene_needs(scene, Settings(ior=reading))
    assert set(needs.pigments) == {o.pigment for o in scene.objects}
    assert set(needs.finishes) == {o.finish for o in scene.objects}
    assert len(needs.etas) == len(scene.finishes)
    assert all(e > 0 for e in needs.etas)
    assert needs.bounces == (needs.reflects or needs.refracts)
    assert not needs.branches or (needs.reflects and needs.refracts)


# ------------------------------------------------------------------------------------------------------------- notices


def test_an_ior_above_1_is_told_with_its_place() -> None:
    scene = parse_scene(write_scene(scene_of(MATTE, GLASS, BOTH)), Path("glass.in"))
    (notice,) = ior_notices(scene, Settings())
    line = write_scene(scene).splitlines().index("0 0 0 1 0 0.9 1.5") + 1
    assert notice.startswith(f"glass.in:{line}: finish 1: ior 1.5 is above 1")
    assert "--ior ratio" in notice
    assert scene_notices(scene, Settings()) == []


def test_a_scene_made_by_a_program_has_notices_too() -> None:
    (notice,) = ior_notices(scene_of(GLASS), Settings())
    assert notice.startswith("scene: finish 0: ior 1.5 ")


@pytest.mark.parametrize(
    ("scene", "settings"),
    [
        (scene_of(GLASS), Settings(ior="ratio")),
        (scene_of(GLASS), Settings(ior="index")),
        (scene_of(BOTH), Settings()),
        (scene_of(replace(GLASS, kt=0)), Settings()),
        (scene_of(MATTE, unused=(GLASS,)), Settings()),
    ],
    ids=["ratio asked for", "index asked for", "a ratio", "nothing transmitted", "not used"],
)
def test_nothing_to_tell(scene: Scene, settings: Settings) -> None:
    assert ior_notices(scene, settings) == []


def test_facts_of_polyhedra_are_worked_out_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    calls = []
    facts = polyhedron.facts

    def counted(shapes: Sequence[Polyhedron]) -> list[Facts]:
        calls.append(1)
        return facts(shapes)

    monkeypatch.setattr(polyhedron, "facts", counted)
    cube = Polyhedron(((1, 0, 0, -1), (-1, 0, 0, -1), (0, 1, 0, -1), (0, -1, 0, -1), (0, 0, 1, -1), (0, 0, -1, -1)))
    wedge = Polyhedron(((0, 1, 0, -1), (1, 0, 0, -2)))
    file = tmp_path / "a.in"
    file.write_text(write_scene(replace(scene_of(MATTE), objects=(Object(0, 0, cube), Object(0, 0, wedge)))))
    scene = load_scene(file)
    needs = scene_needs(scene, Settings())
    scene_bounds(scene)
    assert needs.bounded == (True, False)
    assert len(calls) == 1
    smaller = replace(scene, objects=scene.objects[1:])
    assert scene_needs(smaller, Settings()).bounded == (False,)
    assert scene_needs(scene, Settings()) == needs
    assert len(calls) == 2
    identity = id(scene)
    assert identity in kept._kept
    del scene
    gc.collect()
    assert identity not in kept._kept


def test_shapes_are_looked_into_once_where_some_are_simplified(monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[Shape] = []
    facts = polyhedron.facts

    def noted(shapes: Sequence[Polyhedron]) -> list[Facts]:
        looked.extend(shapes)
        return facts(shapes)

    monkeypatch.setattr(polyhedron, "facts", noted)
    wedge = Polyhedron(((0, 1, 0, -1), (1, 0, 0, -2)))
    ball = Csg((Operand("+", Sphere((0, 0, 0), 1)),))
    scene = replace(scene_of(MATTE), objects=(Object(0, 0, wedge), Object(0, 0, ball)))
    scene_needs(scene, Settings())
    simpler = simplified(scene)
    assert simpler.objects[1].shape == Sphere((0, 0, 0), 1)
    assert scene_needs(simpler, Settings()).boxes == (scene_facts(scene)[0][:2], ((-1, -1, -1), (1, 1, 1)))
    assert looked == [wedge]


def test_what_is_known_of_balls_takes_little_memory() -> None:
    balls = tuple(Object(0, 0, Sphere((float(i), 2.0, 3.0), 0.5)) for i in range(3000))
    scene = replace(scene_of(MATTE), objects=balls)
    tracemalloc.start()
    assert not check_geometry(scene)
    needs = scene_needs(scene, Settings())
    taken, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert taken < 40 * len(balls)
    assert needs.boxes[-1] == ((2998.5, 1.5, 2.5), (2999.5, 2.5, 3.5)) == needs.facts[2999][:2]
    assert needs.facts[1:3] == tuple(scene_facts(scene))[1:3] and len(needs.bounded) == 3000
