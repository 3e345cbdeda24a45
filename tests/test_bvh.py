"""Trees over boxes: all items are in them, the threads lead through, and a search finds what brute force finds."""

import doctest
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import native_tracer.bvh
from native_tracer.bvh import NO_ITEM, threaded_bvh

coordinates = st.one_of(
    st.floats(-1, 1),
    st.integers(-3, 3).map(float),
    st.floats(allow_nan=False, allow_infinity=False),
)


@st.composite
def boxes(draw, most=40):
    corners = draw(arrays(np.float64, st.tuples(st.integers(1, most), st.just(2), st.just(3)), elements=coordinates))
    return corners.min(axis=1), corners.max(axis=1)


def random_boxes(count, seed=1):
    random = np.random.default_rng(seed)
    center = random.uniform(-1, 1, (count, 3))
    size = random.uniform(0, 0.1, (count, 3))
    return center - size, center + size


def check_tree(low, high):
    """Walk through all blocks as a search that misses nothing would, and check what a search relies on."""
    count = len(low)
    tree = threaded_bvh(low, high)
    size = tree.size
    assert size == max(0, 2 * count - 1)
    assert tree.boxes.shape == (8 * size, 6)
    assert tree.skip.shape == tree.item.shape == (8 * size,)
    assert (tree.boxes.dtype, tree.skip.dtype, tree.item.dtype) == (np.float64, np.uint32, np.uint32)
    for octant in range(8):
        block = slice(octant * size, (octant + 1) * size)
        nodes, skip, item = tree.boxes[block], tree.skip[block].astype(int), tree.item[block]
        leaf = item != NO_ITEM
        assert sorted(item[leaf]) == list(range(count))
        assert (skip[leaf] == np.flatnonzero(leaf) + 1).all()
        # From the last node back, so that children come before their parents.
        for i in range(size - 1, -1, -1):
            if leaf[i]:
                expected = np.concatenate([low[item[i]], high[item[i]]])
            else:
                a, b = i + 1, skip[i + 1]
                assert i < b < size and skip[b] == skip[i]
                expected = np.concatenate(
                    [np.minimum(nodes[a, :3], nodes[b, :3]), np.maximum(nodes[a, 3:], nodes[b, 3:])]
                )
                # The nearer child comes first, along the axis along which they lie the farthest apart. Halves, for
                # sums overflow.
                apart = (nodes[b, :3] / 2 - nodes[a, :3] / 2) + (nodes[b, 3:] / 2 - nodes[a, 3:] / 2)
                signs = np.array([-1 if octant >> k & 1 else 1 for k in range(3)])
                farthest = np.abs(apart) == np.abs(apart).max()
                assert (apart * signs)[farthest].max() >= 0
            assert (nodes[i] == expected).all()
    return tree


def depth_of(tree):
    depths, ends = [], []
    for i in range(tree.size):
        while ends and ends[-1] <= i:
            ends.pop()
        depths.append(len(ends))
        ends.append(tree.skip[i])
    return max(depths)


@given(boxes())
def test_any_boxes(corners):
    check_tree(*corners)


def test_thousands_of_boxes():
    tree = check_tree(*random_boxes(3000))
    assert depth_of(tree) < 30


def test_no_boxes():
    assert threaded_bvh(np.empty((0, 3)), np.empty((0, 3))).size == 0


def test_one_box():
    tree = threaded_bvh([[1, 2, 3]], [[4, 5, 6]])
    assert tree.size == 1
    assert (tree.boxes == [1, 2, 3, 4, 5, 6]).all() and (tree.skip == 1).all() and (tree.item == 0).all()


def test_depth_is_bounded_whatever_the_boxes():
    # Points that crowd at the origin, and points all in one place: no bins tell most of them apart.
    crowded = np.repeat(2.0 ** -np.arange(1000.0), 3).reshape(-1, 3)
    same = np.ones((2000, 3))
    for points in (crowded, same):
        assert depth_of(check_tree(points, points)) <= 96


def test_a_box_around_all_others_is_set_aside():
    # Its centre lies among theirs, and all its ancestors are as large as it is.
    low, high = random_boxes(2000)
    low[1234], high[1234] = -1000, 1000
    tree = threaded_bvh(low, high)
    large = (tree.boxes[: tree.size, 3:] - tree.boxes[: tree.size, :3]).max(axis=1) > 100
    assert large.sum() == 2


def test_the_same_boxes_give_the_same_tree():
    first, second = (threaded_bvh(*random_boxes(500)) for _ in range(2))
    for name in ("boxes", "skip", "item"):
        assert (getattr(first, name) == getattr(second, name)).all()


def nearest_sphere(center, radius, tree, origin, direction):
    """The sphere that a ray hits first and how far away, by a search of the tree; and the boxes it looked at."""
    octant = sum(1 << k for k in range(3) if direction[k] < 0)
    inverse = 1 / direction
    best, nearest, visited, node = None, np.inf, 0, 0
    while node < tree.size:
        at = octant * tree.size + node
        visited += 1
        sides = (tree.boxes[at].reshape(2, 3) - origin) * inverse
        if max(sides.min(axis=0).max(), 0) > min(sides.max(axis=0).min(), nearest):
            node = int(tree.skip[at])
            continue
        item = tree.item[at]
        if item != NO_ITEM:
            t = sphere_hit(center[item], radius[item], origin, direction)
            if t < nearest:
                best, nearest = item, t
        node += 1
    return best, nearest, visited


def sphere_hit(center, radius, origin, direction):
    g = center - origin
    closest = g @ direction
    across2 = radius**2 - (g - closest * direction) @ (g - closest * direction)
    if across2 < 0:
        return np.inf
    t = closest - np.sqrt(across2)
    return t if t > 0 else np.inf


def test_a_search_finds_the_nearest_sphere():
    random = np.random.default_rng(2)
    count = 2000
    center, radius = random.uniform(-1, 1, (count, 3)), random.uniform(0.001, 0.05, count)
    tree = threaded_bvh(center - radius[:, None], center + radius[:, None])
    hits, looks = 0, 0
    for _ in range(200):
        origin, direction = random.uniform(-1, 1, 3), random.normal(size=3)
        direction /= np.linalg.norm(direction)
        all_hits = [sphere_hit(c, r, origin, direction) for c, r in zip(center, radius, strict=True)]
        best, nearest, visited = nearest_sphere(center, radius, tree, origin, direction)
        assert nearest == min(all_hits)
        assert best is None or all_hits[best] == nearest
        hits += best is not None
        looks += visited
    assert hits > 50
    assert looks / 200 < count / 10


@pytest.mark.parametrize(
    ("low", "high", "message"),
    [
        ([[0, 0]], [[1, 1]], "shape"),
        ([0, 0, 0], [1, 1, 1], "shape"),
        ([[0, 0, 0]], [[1, 1, 1], [1, 1, 1]], "1 low corners, but 2 high"),
        ([[0, 0, 0], [0, np.nan, 0]], [[1, 1, 1], [1, 1, 1]], "box 1 is not finite"),
        ([[0, 0, 0]], [[1, np.inf, 1]], "box 0 is not finite"),
        ([[0, 2, 0]], [[1, 1, 1]], "box 0 has a low corner above"),
    ],
)
def test_bad_boxes_are_refused(low, high, message):
    with pytest.raises(ValueError, match=message):
        threaded_bvh(low, high)


def test_example_in_the_docstring():
    assert doctest.testmod(native_tracer.bvh).failed == 0


def test_the_tracer_does_without_it():
    code = "import native_tracer, sys; sys.exit('numpy' in sys.modules or 'native_tracer.bvh' in sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)
