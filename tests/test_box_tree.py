"""The tree of boxes by which Mitsuba's kernels search many surfaces: which of them rays may meet."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from variant import VARIANT

CORNERS = [tuple(2 * k for k in place) for place in product(range(10), repeat=3)]
"""Of boxes of edge 1, with as much room between them."""


@pytest.fixture(scope="module")
def tree():
    import mitsuba_plugins

    mitsuba_plugins.set_variant(VARIANT)
    from mitsuba_plugins.intersection.box_tree import BoxTree
    from mitsuba_plugins.intersection.rays import real

    boxes = [((x, y, z), (x + 1, y + 1, z + 1)) for x, y, z in CORNERS]
    return BoxTree(real("double"), [None, *boxes])


def candidates(tree, origins, directions, distance=np.inf, skipped=0xFFFFFFFF):
    """For each ray of unit direction the objects that it may meet before a distance, in the order in which they are
    found.
    """
    import drjit as dr
    import mitsuba as mi

    from mitsuba_plugins.intersection.rays import NOTHING, lanes, real, start_ray

    o, d = (np.ascontiguousarray(np.asarray(v, float).T) for v in (origins, directions))
    ray = start_ray(real("double"), mi.Point3d(o), mi.Vector3d(d))
    width = dr.width(ray.d)
    walk = tree.walk(ray)
    node, searching = mi.UInt32(walk.start), lanes(width)
    limit = tree.limit(mi.Float64(np.broadcast_to(distance, width)))
    found = [[] for _ in range(width)]
    while dr.any(searching):
        index, node = tree.next(walk, node, limit, dr.full(mi.UInt32, skipped, width), searching)
        searching &= index != NOTHING
        for own, number, there in zip(found, np.array(index), np.array(searching), strict=True):
            own += [int(number)] if there else []
    return found


def crossed(origin, direction, far=np.inf):
    """Those of the boxes that a ray enters before it has come so far, 0 for what has no bounds."""
    low = np.array(CORNERS, float)
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = ((corner - origin) / direction for corner in (low, low + 1))
    near, beyond = np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)
    return {0, *(np.nonzero((near <= beyond) & (beyond >= 0) & (near <= far))[0] + 1).tolist()}


def test_all_boxes_that_rays_cross_and_no_others(tree):
    numbers = np.random.default_rng(1)
    origins = numbers.uniform(-3, 23, (200, 3))
    directions = numbers.normal(size=(200, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    for far in (np.inf, 7.0):
        for found, o, d in zip(candidates(tree, origins, directions, far), origins, directions, strict=True):
            assert len(found) == len(set(found))
            assert set(found) == crossed(o, d, far)


def test_one_is_passed_over(tree):
    origin, direction = (0.5, 0.5, -1), (0, 0, 1)
    (every,) = candidates(tree, [origin], [direction])
    (rest,) = candidates(tree, [origin], [direction], skipped=every[2])
    assert rest == [*every[:2], *every[3:]]
    assert len(every) == 11


@pytest.mark.parametrize("off", [0.0, 1e-12, -1e-12, 1e-10])
def test_what_ties_is_sought_in_boxes_that_are_missed_by_a_little(tree, off):
    """Rays along sides of ten boxes, or beside them by rounding errors; not those that pass by farther away."""
    origins = [(1 + off, 0.5, -1), (-off, 0.5, -1), (0.5, 21, 1 + off), (19 + off, -1, 0)]
    directions = [(0, 0, 1), (0, 0, 1), (0, -1, 0), (0, 1, 0)]
    for found in candidates(tree, origins, directions):
        assert len(found) == 11
    beside = candidates(tree, [(1.001, 0.5, -1)], [(0, 0, 1)])
    assert beside == [[0]]


# ---- In single precision, and exactly


def entered(low, high, o, d):
    """Where a ray enters a box, 0 if it starts inside, in exact arithmetic; None if it misses it."""
    first, last = Fraction(0), None
    for a, b, start, slope in zip(low, high, o, d, strict=True):
        if slope == 0:
            if not a <= start <= b:
                return None
            continue
        near, beyond = sorted((Fraction(a) - Fraction(start)) / Fraction(slope) for a in (a, b))
        first, last = max(first, near), beyond if last is None else min(last, beyond)
    return first if first <= last else None


def grazing_rays(rng, boxes, away):
    """To points of the boxes' corners, edges and faces; some along axes, or almost."""
    for low, high in boxes:
        for fixed in product((True, False), repeat=3):
            share = np.where(fixed, rng.integers(0, 2, 3), rng.uniform(size=3))
            target = np.array(low) * (1 - share) + np.array(high) * share
            d = rng.normal(size=3)
            d[rng.integers(0, 3)] *= rng.choice([0, 1e-300, 1e-20, 1e-9, 1, 1])
            d /= np.linalg.norm(d)
            yield target - rng.uniform(0.5, 2) * away * d, d


@pytest.mark.parametrize(("scale", "away"), [(1, 1), (1, 1e3), (1, 1e9), (1e-300, 1), (1e290, 1e3)])
def test_roundings_make_no_ray_miss_a_box(mi, scale, away):
    """Boxes whose sides single precision does not have; also before a limit that is where a ray enters one."""
    from mitsuba_plugins.intersection.box_tree import BoxTree
    from mitsuba_plugins.intersection.rays import real

    rng = np.random.default_rng(7)
    boxes = [[tuple(corner) for corner in np.sort(rng.uniform(-1, 1, (2, 3)) * scale, axis=0)] for _ in range(16)]
    o, d = map(np.array, zip(*grazing_rays(rng, boxes, away * scale), strict=True))
    met = [[entered(*box, *ray) for box in boxes] for ray in zip(o, d, strict=True)]
    first = [min(((t, k) for k, t in enumerate(row) if t is not None), default=None) for row in met]
    tree = BoxTree(real("double"), boxes)
    crossed = [{k for k, t in enumerate(row) if t is not None} for row in met]
    assert sum(map(len, crossed)) > len(o)
    every = [set(found) for found in candidates(tree, o, d)]
    assert all(row <= found for row, found in zip(crossed, every, strict=True))
    if away < 1e9:
        assert sum(map(len, every)) < 1.1 * sum(map(len, crossed))
    limit = np.array([0.0 if near is None else np.nextafter(float(near[0]), np.inf) for near in first])
    for found, near in zip(candidates(tree, o, d, limit), first, strict=True):
        assert near is None or near[1] in found


def test_large_boxes_in_a_tree_are_left_out():
    """Two near one another beside a third keep the box around them, and two apart do not; the rest stays in order."""
    from mitsuba_plugins.intersection.box_tree import without_large_nodes
    from native_tracer.bvh import NO_ITEM, threaded_bvh

    random = np.random.default_rng(3)
    low = random.uniform(-1, 1, (300, 3))
    high = low + random.uniform(0, 0.5, (300, 3))
    tree = threaded_bvh(low, high)
    found = without_large_nodes(tree)
    assert 300 < found.size < 0.95 * tree.size
    for octant in range(8):
        block, whole = (slice(octant * size, (octant + 1) * size) for size in (found.size, tree.size))
        item, skip, boxes = found.item[block], found.skip[block].astype(int), found.boxes[block]
        every = tree.item[whole]
        assert (item[item != NO_ITEM] == every[every != NO_ITEM]).all()
        assert (boxes[0] == tree.boxes[whole][0]).all()
        ends = []
        for i in range(found.size):
            while ends and ends[-1] == i:
                ends.pop()
            assert i < skip[i] <= (ends[-1] if ends else found.size)
            held = item[i : skip[i]]
            held = held[held != NO_ITEM]
            assert (boxes[i] == [*low[held].min(axis=0), *high[held].max(axis=0)]).all()
            if item[i] == NO_ITEM:
                ends.append(skip[i])
    near, beside, apart = ((0, 0, 0), (1, 1, 1)), ((1, 0, 0), (2, 1, 1)), ((40, 0, 0), (41, 1, 1))
    assert without_large_nodes(threaded_bvh(*np.swapaxes([near, beside, apart], 0, 1))).size == 5
    high_up = ((0, 0, 0), (30, 30, 30)), ((29, 29, 29), (40, 40, 40)), ((1, 1, 1), (40, 40, 39))
    assert without_large_nodes(threaded_bvh(*np.swapaxes(high_up, 0, 1))).size == 4
    assert without_large_nodes(threaded_bvh(np.empty((0, 3)), np.empty((0, 3)))).size == 0
