"""How often Python records the code of a kernel: once, though Dr.Jit records loops again of which something stays."""

from collections import Counter

import pytest
from csgs import BALL, CYLINDER, RIGHT, csg
from variant import VARIANT

from converter.renderers.mitsuba import MitsubaRenderer
from converter.scene.model import Object, Scene, Sphere
from converter.scene.settings import Settings

SETTINGS = Settings(width=16, height=12)
SEARCHES = 2
"""For what a ray meets, and for what is between that and a light."""
MANY = 9
"""Leaves of a csg that is stepped through."""


def with_many_kinds(scene: Scene) -> Scene:
    """A csg, and one with more leaves than have code of their own each."""
    bite = csg("+", BALL, "-", RIGHT)
    row = [Sphere((0.5 * k, 1.0, 0.0), 0.4) for k in range(MANY)]
    drilled = csg(*(part for ball in row for part in ("+", ball)), "-", CYLINDER)
    return Scene(
        scene.camera,
        scene.ambient,
        scene.lights,
        scene.pigments,
        scene.finishes,
        (*scene.objects, Object(1, 1, bite), Object(1, 1, drilled)),
    )


@pytest.fixture
def recorded(mi, monkeypatch):
    """Counts, for each kind of shape, how often rays are intersected with one while a scene is drawn."""
    from mitsuba_plugins.intersection.shapes.table import SHAPE_KINDS

    def count(scene, intersections, settings=SETTINGS):
        counts = Counter()
        with monkeypatch.context() as patch:
            for name, kind in SHAPE_KINDS.items():

                def passage(*arguments, name=name, passage=kind.passage):
                    counts[name] += 1
                    return passage(*arguments)

                patch.setattr(kind, "passage", passage)
            MitsubaRenderer(VARIANT, intersections).render(scene, settings)
        return counts

    return count


@pytest.mark.parametrize("samples", [1, 4])
def test_each_surface_once_for_each_search(recorded, small_scene, samples):
    counts = recorded(small_scene, "analytic", Settings(width=16, height=12, samples=samples))
    assert counts == {"sphere": 2 * SEARCHES, "planes": 2 * SEARCHES}


@pytest.mark.parametrize("samples", [1, 4])
def test_each_kind_once_for_each_search_of_the_tree(recorded, small_scene, samples):
    """And the floor, which is apart."""
    counts = recorded(small_scene, "bvh", Settings(width=16, height=12, samples=samples))
    assert counts == {"sphere": SEARCHES, "planes": 2 * SEARCHES}


def test_each_leaf_of_a_csg_once(recorded, small_scene):
    counts = recorded(with_many_kinds(small_scene), "bvh")
    assert counts == {"sphere": SEARCHES * (1 + 2 + MANY), "planes": 2 * SEARCHES, "quadric": SEARCHES}
