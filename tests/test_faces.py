"""Polyhedra of many planes are met at their faces, as they are where every plane is tested."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from converter.renderers.mitsuba import MitsubaRenderer
from converter.scene.model import Object, Polyhedron
from converter.scene.settings import Settings

GOLDEN = math.pi * (3 - math.sqrt(5))
CUBE = [(a, b, c, -1) for s in (-1, 1) for a, b, c in ((s, 0, 0), (0, s, 0), (0, 0, s))]
ROOF = [(1, 1, 0, -1), (-1, 1, 0, -1), (0, 0, 1, -1)]


def stone(center, radius, count):
    """Planes that touch a ball, spread evenly."""
    planes = []
    for k in range(count):
        y = 1 - (2 * k + 1) / count
        n = math.sqrt(1 - y * y) * math.cos(k * GOLDEN), y, math.sqrt(1 - y * y) * math.sin(k * GOLDEN)
        planes.append((*n, -radius - sum(a * b for a, b in zip(n, center, strict=True))))
    return Polyhedron(tuple(planes))


@pytest.mark.parametrize("many", [4, 31])
def test_faces_make_no_difference(mi, small_scene, many, monkeypatch):
    """A mirror, a piece of glass, and a block: all in faces, and only the glass."""
    from mitsuba_plugins.intersection import faces

    floor, *_, block = small_scene.objects
    mirror = Object(2, 2, stone((-1.6, 1.3, 0.6), 1.1, 30))
    glass = Object(2, 3, stone((0.9, 1.0, -0.9), 0.85, 40))
    scene = replace(small_scene, objects=(floor, mirror, glass, block))
    renderer, settings = MitsubaRenderer(intersections="bvh"), Settings(width=80, height=60)
    monkeypatch.setattr(faces, "MANY", 1000)
    whole = renderer.render(scene, settings)
    monkeypatch.setattr(faces, "MANY", many)
    parted = renderer.render(scene, settings)
    assert np.array_equal(np.asarray(whole.pixels), np.asarray(parted.pixels))


def test_faces_and_the_planes_around_them(mi, monkeypatch):
    """Of a cube; what has no bounds stays whole."""
    from mitsuba_plugins.intersection import faces
    from mitsuba_plugins.intersection.geometry import parse_geometry
    from mitsuba_plugins.intersection.primitives import Primitives
    from mitsuba_plugins.intersection.rays import real

    def entry(planes, box):
        return {"material": "", "planes": {str(k): plane for k, plane in enumerate(planes)}, "box": box}

    text = json.dumps({"roof": entry(ROOF, None), "cube": entry(CUBE, [[-1] * 3, [1] * 3])})
    surfaces = parse_geometry(text).surfaces
    monkeypatch.setattr(faces, "MANY", 3)
    for precision, objects in (("double", [0, *[1] * 6]), ("float", [0, 1])):
        types = real(precision)
        assert faces.Parts(types, surfaces, Primitives(types, surfaces)).objects == objects
    found = faces.faces_of(1, surfaces[1], 3)
    for k, part in enumerate(found):
        own, *around = part.planes
        assert own == 3 + k
        assert sorted(around) == sorted({*range(3, 9)} - {own, 3 + (k + 3) % 6})
        low, high = part.box
        flat = [axis for axis in range(3) if low[axis] == high[axis]]
        assert flat == [k % 3]
