"""Csgs of 9 to 32 leaves in Mitsuba's kernels, from one crossing to the next, against the definition."""

import json
from itertools import pairwise

import numpy as np
import pytest

UNION, DIFFERENCE, INTERSECTION = -1, -2, -3
APART = 1e-6
"""Rays with two crossings as near as that are left out: what is close to a tie is for other tests."""
RAYS = 400


def random_leaves(rng, count):
    """Balls and boxes in the cube from -1 to 1 that overlap one another."""
    leaves = []
    for k in range(count):
        center = rng.uniform(-0.7, 0.7, 3)
        if k % 3:
            leaves.append({"sphere": [*center, rng.uniform(0.2, 0.6)]})
            continue
        half = rng.uniform(0.15, 0.5, 3)
        planes = {str(2 * axis + side): [0.0] * 3 for axis in range(3) for side in (0, 1)}
        for axis in range(3):
            for side, sign in enumerate((-1.0, 1.0)):
                planes[str(2 * axis + side)][axis] = sign
                planes[str(2 * axis + side)].append(float(-half[axis] - sign * center[axis]))
        leaves.append({"planes": planes, "box": [(center - half).tolist(), (center + half).tolist()]})
    return leaves


def random_program(rng, first, end):
    """An expression over all leaves from `first` to `end`, in postfix notation."""
    if end - first == 1:
        return [first]
    middle = int(rng.integers(first + 1, end))
    sign = int(rng.choice([UNION, DIFFERENCE, INTERSECTION], p=[0.5, 0.3, 0.2]))
    return [*random_program(rng, first, middle), *random_program(rng, middle, end), sign]


def is_inside(program, inside):
    """The value of an expression, by the definition."""
    stack = []
    for code in program:
        if code >= 0:
            stack.append(inside[code])
        else:
            right, left = stack.pop(), stack.pop()
            stack.append({UNION: left or right, DIFFERENCE: left and not right, INTERSECTION: left and right}[code])
    return stack.pop()


def span(leaf, o, d):
    """The two distances between which a ray is inside a leaf, and the number of the plane at each."""
    if "sphere" in leaf:
        *center, radius = leaf["sphere"]
        f = np.array(center) - o
        b = f @ d
        root = radius**2 - ((f - b * d) ** 2).sum()
        return (b - np.sqrt(root), b + np.sqrt(root), 0, 0) if root > 0 else None
    normals = np.array([plane[:3] for plane in leaf["planes"].values()])
    offsets = np.array([plane[3] for plane in leaf["planes"].values()])
    slopes, t = normals @ d, -(normals @ o + offsets) / (normals @ d)
    near, far = np.where(slopes < 0, t, -np.inf), np.where(slopes > 0, t, np.inf)
    return (near.max(), far.min(), near.argmax(), far.argmin()) if near.max() < far.min() else None


def changes(leaves, program, o, d):
    """Where the value changes along a line: distance, whether it is entered there, leaf and plane, and whether that
    leaf is entered; None of a line of which two crossings are close to a tie.
    """
    spans = [span(leaf, o, d) for leaf in leaves]
    events = sorted((s[side], k, s[2 + side]) for k, s in enumerate(spans) if s is not None for side in (0, 1))
    if any(b[0] - a[0] < APART for a, b in pairwise(events)):
        return None
    inside, found = [False] * len(leaves), []
    for t, k, plane in events:
        before = is_inside(program, inside)
        inside[k] = not inside[k]
        if (after := is_inside(program, inside)) != before:
            found.append((t, after, (k, plane), inside[k]))
    return found


class Kernel:
    """A csg in Mitsuba, the only object of its scene."""

    def __init__(self, leaves, program) -> None:
        from mitsuba_plugins.intersection.geometry import parse_geometry
        from mitsuba_plugins.intersection.primitives import Primitives
        from mitsuba_plugins.intersection.rays import real

        body = {"material": "m", "csg": {"leaves": leaves, "program": program}, "box": [[-2] * 3, [2] * 3]}
        self.surfaces = parse_geometry(json.dumps({"body": body})).surfaces
        self.solid = self.surfaces[0].solid
        self.types = real("double")
        self.primitives = Primitives(self.types, self.surfaces)
        sizes = [len(leaf.get("planes", [0])) for leaf in leaves]
        self.row = [(k, plane) for k, size in enumerate(sizes) for plane in range(size)]

    def first_crossings(self, mi, o, d, starts, by_rules):
        """Distance (infinite if none), whether it enters, the row and whether that is turned, and whether it is close
        to a tie, of each ray (n, 3). Where a ray `starts` on the csg, that is the row and the side; else it is None.
        """
        import drjit as dr

        from mitsuba_plugins.intersection.rays import INVERTED, NOTHING, UPRIGHT, lanes, largest, start_ray

        count = len(o)
        columns = (np.ascontiguousarray(v.T) for v in (o, d))
        ray = start_ray(self.types, *(kind(v) for kind, v in zip((mi.Point3d, mi.Vector3d), columns, strict=True)))
        ray.object = mi.UInt32([NOTHING if start is None else 0 for start in starts])
        ray.primitive = mi.UInt32([NOTHING if start is None else start[0] for start in starts])
        ray.inside = mi.Bool([start is not None and start[1] for start in starts])
        ray.t_min = mi.Float64([0 if start is None else 1e-13 for start in starts])
        index = dr.opaque(mi.UInt32, 0, count)
        found = self.primitives.intersect(ray, index, lanes(count), largest(ray.o), by_rules=by_rules)
        dr.eval(found)
        t, enters, primitive = (np.array(column) for column in (found.t, found.enters, found.primitive))
        close = np.broadcast_to(np.array(found.close), count)
        return zip(t, enters, primitive & UPRIGHT, primitive >= INVERTED, close, strict=True)


@pytest.mark.parametrize(("count", "seed"), [(9, 23), (18, 23)])
def test_rays_meet_what_the_definition_says(mi, count, seed):
    """Those that come from anywhere, and from each place where their lines cross the csg, into it or out of it."""
    rng = np.random.default_rng([count, seed])
    leaves, program = random_leaves(rng, count), random_program(rng, 0, count)
    kernel = Kernel(leaves, program)
    number = {place: number for number, place in enumerate(kernel.row)}
    origins, directions, starts, expected = [], [], [], []
    for _ in range(RAYS):
        o = rng.normal(size=3)
        o *= rng.uniform(0.1, 4) / np.linalg.norm(o)
        d = rng.uniform(-0.7, 0.7, 3) - o
        d /= np.linalg.norm(d)
        crossed = changes(leaves, program, o, d)
        if crossed is None:
            continue
        for t, start in [(0.0, None), *((t, (number[place], inside)) for t, inside, place, _ in crossed)]:
            origins.append(o + t * d)
            directions.append(d)
            starts.append(start)
            expected.append(next(((far - t, *change) for far, *change in crossed if far > t), None))
    assert RAYS < sum(change is not None for change in expected) < len(expected) - RAYS / 2
    rays = np.array(origins), np.array(directions), starts
    for by_rules in (False, True):
        for found, change in zip(kernel.first_crossings(mi, *rays, by_rules), expected, strict=True):
            t, enters, row, turned, close = found
            assert not close
            if change is None:
                assert t == np.inf
                continue
            distance, entered, place, leaf_entered = change
            assert abs(t - distance) < 1e-11
            assert (enters, kernel.row[row], turned) == (entered, place, entered != leaf_entered)
