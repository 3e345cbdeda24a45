"""Pixels that come close to a tie, which Mitsuba's kernel only tells: others, with the rules' code, draw them again."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from tie_scenes import GREEN, RED, SETTINGS, TIE_SCENES, view, wall
from variant import VARIANT

from converter.renderers.mitsuba import MitsubaRenderer
from converter.studies.families.scenes import MATTE, MIRROR, floor, light, scene


def floor_before_wall(up=(0.0, 1.0, 0.0)):
    """Where they meet, in a line that a row of rays meets, the floor counts: a mirror, so that a ray is dropped."""
    bodies = [(floor(-1.0), RED, replace(MIRROR, kd=0.5)), (wall((0.0, 0.0, 1.0), 3.0), GREEN, MATTE)]
    return scene(view((0.0, 0.0, 0.0), up=up), bodies, [light((1.0, 2.0, 1.0))])


def floor_aside():
    """The line goes from row to row, and meets one of the three samples of a launch."""
    return floor_before_wall(up=(1.0, 0.0, 0.0))


def shadows_of_edges():
    """The first of its lights is that whose ties matter."""
    made = TIE_SCENES["shadows of edges"][1]()
    return replace(made, lights=made.lights[::-1])


SCENES = {
    "floor before wall": (floor_before_wall, replace(SETTINGS, max_depth=0)),
    "nine samples": (floor_before_wall, replace(SETTINGS, max_depth=0, samples=9)),
    "one of three samples": (floor_aside, replace(SETTINGS, max_depth=0, samples=9)),
    "balls that touch": TIE_SCENES["balls that touch"][1:],
    "shadows of edges": (shadows_of_edges, SETTINGS),
}


@dataclass
class Drawn:
    """A picture, and of each launch how many pixels it drew, and how many it left undecided."""

    pixels: np.ndarray
    too_deep: int
    launches: list[tuple[int, int]]


@pytest.fixture
def draw(mi, monkeypatch):
    """Draws scenes in bands of five rows and launches of three samples; `postponing` ties, or deciding at once."""
    import drjit as dr

    from mitsuba_plugins.integrators import launches as drawing
    from mitsuba_plugins.integrators.pace import Pace

    add_samples, launches = drawing._add_samples, []

    def spy(scene, color, *rest):
        result = add_samples(scene, color, *rest)
        dr.eval(result)
        launches.append((dr.width(result[0]), int(dr.count(result[2] | dr.zeros(mi.Bool, dr.width(color)))[0])))
        return result

    monkeypatch.setattr(drawing, "_add_samples", spy)
    monkeypatch.setattr(Pace, "rows", lambda self, width: 5)
    monkeypatch.setattr(Pace, "samples", lambda self, pixels: 3)

    def drawn(name, postponing):
        from mitsuba_plugins.integrators.kernel_scene import KernelScene

        make, settings = SCENES[name]
        launches.clear()
        with monkeypatch.context() as patch:
            if not postponing:
                patch.setattr(KernelScene, "postpone_ties", lambda self, postpones: None)
            rendering = MitsubaRenderer(VARIANT).render(make(), settings)
        return Drawn(np.array(rendering.pixels), rendering.statistics["pixels_too_deep"], list(launches))

    return drawn


@pytest.mark.parametrize("name", SCENES)
def test_redrawn_pixels_are_those_that_are_decided_at_once(draw, name):
    redrawn, at_once = draw(name, True), draw(name, False)
    assert np.array_equal(redrawn.pixels, at_once.pixels)
    assert redrawn.too_deep == at_once.too_deep
    assert not any(undecided for _, undecided in at_once.launches)
    # Once, in the first launch that has some; those after it decide at once.
    first = next(k for k, (_, undecided) in enumerate(redrawn.launches) if undecided)
    count = redrawn.launches[first][1]
    assert redrawn.launches[first + 1] == (count, 0)
    assert redrawn.launches[:first] + redrawn.launches[first + 2 :] == (
        at_once.launches[:first] + at_once.launches[first + 1 :]
    )
    assert count < 5 * SETTINGS.width


def test_what_is_redrawn_would_be_wrong(draw, monkeypatch):
    """The row in which the floor meets the wall; none is drawn again if no pixel says so."""
    from mitsuba_plugins.intersection.surfaces import ExactSurfaces

    right = draw("floor before wall", True)
    closest = ExactSurfaces.closest
    monkeypatch.setattr(
        ExactSurfaces, "closest", lambda self, ray, active: replace(closest(self, ray, active), undecided=False)
    )
    wrong = draw("floor before wall", True)
    differing = np.flatnonzero((right.pixels != wrong.pixels).any(axis=(1, 2)))
    assert len(differing) == 1
    assert right.too_deep - wrong.too_deep == SETTINGS.width
