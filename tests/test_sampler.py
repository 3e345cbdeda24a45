"""The random numbers of distributed ray tracing: the same in both renderers, stratified, and independent."""

import numpy as np
import pytest
import sampler_specification as specification

from native_tracer import sampler

MILLION = 1_000_000
SIXTEEN_BITS = 1 << 16


def random_words(count):
    """Samples of all kinds: seeds apart, of what renderers ask for, and of numbers up to the last."""
    generator = np.random.default_rng(11)
    usual = [(0, 4096), (0, 2160), (0, 1024), (1, 64), (0, 12)]
    largest = 1 << 32
    given = [generator.integers(low, high, count, dtype=np.uint32) for low, high in usual]
    anything = generator.random(count) < 0.25
    return [np.where(anything, generator.integers(0, largest, count, dtype=np.uint32), words) for words in given]


@pytest.fixture(scope="module")
def plugin(mi):
    """The sampler of Mitsuba's side, on NumPy's arrays."""
    import drjit as dr

    from mitsuba_plugins import sampler as made

    class Plugin:
        double = type(mi.Float64(0))

        @staticmethod
        def points(seed, *words, independent=False):
            words = [mi.UInt32(word) for word in np.broadcast_arrays(*map(np.atleast_1d, words))]
            column, row, k, path, use = words
            pixel = made.pixel_key(mi.UInt32(seed), column, row)
            if independent:
                pixel, k = made.make_independent(pixel, k)
            point = made.sample_point(pixel, k, path, use)
            return np.stack([np.asarray(part) for part in point], axis=-1)

        @classmethod
        def square(cls, points):
            return [made.unit_interval(cls.double, mi.UInt32(np.ascontiguousarray(points[:, k]))) for k in (0, 1)]

        @classmethod
        def discs(cls, points):
            return np.stack([np.asarray(part) for part in made.disc_point(*cls.square(points))], axis=-1)

        @classmethod
        def cones(cls, axes, versines, points):
            axis = mi.Vector3d(*(cls.double(np.ascontiguousarray(axes[:, k])) for k in range(3)))
            found = made.cone_direction(axis, cls.double(versines), *cls.square(points))
            dr.eval(found)
            return np.stack([np.asarray(part) for part in found], axis=-1)

    return Plugin


# ---- The same numbers everywhere


@pytest.mark.parametrize(("seed", "independent"), [(0, False), (4294967295, False), (7, True)])
def test_a_million_points_are_the_same_in_both_renderers_and_the_specification(plugin, seed, independent):
    words = random_words(MILLION // 2)
    native = sampler.sample_points(seed, *words, independent=independent)
    assert (native == plugin.points(seed, *words, independent=independent)).all()
    assert (native == specification.sample_points(seed, *words, independent=independent)).all()


def axes(count):
    """Unit vectors of all directions, those along axes and near the frame's jump among them."""
    found = np.random.default_rng(3).normal(size=(count, 3))
    found[::5] = [0, 0, 1]
    found[1::5] = [0, 0, -1]
    found[2::50, 2] = 0
    found /= np.linalg.norm(found, axis=1)[:, None]
    return found


HALF_ANGLES = np.radians([0.001, 1, 30, 60, 90])


def test_discs_and_cones_are_the_same_in_both_renderers_bit_for_bit(plugin):
    points = sampler.sample_points(1, np.arange(SIXTEEN_BITS), 7, 0, 1, sampler.LENS)
    assert (sampler.disc_points(points) == plugin.discs(points)).all()
    versines = 2 * np.sin(np.resize(HALF_ANGLES, len(points)) / 2) ** 2
    given = axes(len(points)), versines, points
    assert (sampler.cone_directions(*given) == plugin.cones(*given)).all()


def test_discs_and_cones_are_right_to_the_last_bits():
    points = sampler.sample_points(2, np.arange(SIXTEEN_BITS), 7, 0, 1, sampler.LENS)
    points[:4] = [[0, 0], [0, 0xFFFFFFFF], [0x7FFFFFFF, 0x80000000], [0xFFFFFFFF, 0x80000000]]
    bit = np.finfo(float).eps
    assert np.abs(sampler.disc_points(points) - specification.disc_points(points)).max() < 2 * bit
    versines = 2 * np.sin(np.resize(HALF_ANGLES, len(points)) / 2) ** 2
    # A frame's vectors are as wrong as the axis is not of length 1, amplified by 1 / (1 - 0.4371).
    exact = specification.cone_directions(axes(len(points)), versines, points)
    found = sampler.cone_directions(axes(len(points)), versines, points)
    assert np.abs(found - exact).max() < 6 * bit
    assert np.abs(np.linalg.norm(found, axis=1) - 1).max() < 6 * bit


def test_cones_have_their_angle_and_are_uniform_in_solid_angle():
    count = SIXTEEN_BITS
    points = sampler.sample_points(3, 0, 0, np.arange(count), 1, sampler.MIRRORED_CONE)
    axis = np.array([2 / 7, -3 / 7, 6 / 7])
    for half in HALF_ANGLES:
        versine = 2 * np.sin(half / 2) ** 2
        directions = sampler.cone_directions(np.tile(axis, (count, 1)), np.full(count, versine), points)
        assert np.linalg.norm(np.cross(directions, axis), axis=1).max() <= np.sin(half) * (1 + 1e-6)
        # The mean of a uniform cone lies on its axis, at (1 + cos(half-angle)) / 2.
        assert directions.mean(axis=0) == pytest.approx(axis * (1 - versine / 2), abs=1e-4 * np.sin(half))


def test_a_frame_jumps_only_where_it_is_said_to():
    """Axes that differ by rounding errors have cones that do, also where a coordinate is 0."""
    count = 1000
    points = sampler.sample_points(4, np.arange(count), 0, 0, 1, sampler.FIRST_LIGHT)
    across = np.random.default_rng(5).normal(size=(count, 3))
    across[:, np.arange(count) % 3] *= 1
    across[np.arange(count), np.arange(count) % 3] = 0
    across /= np.linalg.norm(across, axis=1)[:, None]
    across = across[np.abs(across[:, 2] + 0.4371) > 1e-9]
    moved = [across + sign * 1e-16 for sign in (-1, 1)]
    first, second = (sampler.cone_directions(axis, np.ones(len(axis)), points[: len(axis)]) for axis in moved)
    assert np.abs(first - second).max() < 1e-14


# ---- Stratified


@pytest.mark.parametrize("m", range(11))
def test_every_first_power_of_two_has_a_point_in_each_elementary_interval(m):
    count, pixels = 1 << m, 64
    points = sampler.sample_points(
        9, np.repeat(np.arange(pixels), count), 3, np.tile(np.arange(count), pixels), 6, sampler.TIME
    ).reshape(pixels, count, 2)
    for across in range(m + 1):
        # An axis of no digits has one interval, and NumPy does not shift by all 32.
        x = points[..., 0].astype(np.uint64) >> np.uint64(32 - across)
        y = points[..., 1].astype(np.uint64) >> np.uint64(32 - (m - across))
        boxes = np.sort(x << np.uint64(m - across) | y, axis=1)
        assert (boxes == np.arange(count)).all()


def star_discrepancy(points):
    """In the mean square, by Warnock's formula."""
    rest = 1 - points
    pairs = np.minimum(rest[:, None], rest[None]).prod(axis=2).mean()
    return np.sqrt(1 / 9 - 2 * ((1 - points**2) / 2).prod(axis=1).mean() + pairs)


@pytest.mark.parametrize("count, gain", [(9, 1.4), (16, 2.2), (64, 4), (100, 4), (256, 7)])
def test_the_discrepancy_is_far_below_that_of_independent_points(count, gain):
    generator = np.random.default_rng(1)
    made = [
        np.asarray(specification.unit_square(sampler.sample_points(0, pixel, 0, np.arange(count), 1, 0)).T, float)
        for pixel in range(40)
    ]
    ours = np.mean([star_discrepancy(points) for points in made])
    independent = np.mean([star_discrepancy(generator.random((count, 2))) for _ in range(40)])
    assert ours * gain < independent
    hashed = [
        specification.unit_square(sampler.sample_points(0, pixel, 0, np.arange(count), 1, 0, True)).T.astype(float)
        for pixel in range(40)
    ]
    assert np.mean([star_discrepancy(points) for points in hashed]) == pytest.approx(independent, rel=0.15)


def owen_scramble(x, key):
    """Every digit flipped, or not, by a number of its own for the digits before it."""
    flipped = x.copy()
    for digit in range(31, -1, -1):
        before = x.astype(np.uint64) >> np.uint64(digit + 1) | np.uint64(1) << np.uint64(31 - digit)
        flips = specification.low_bias(key ^ specification.low_bias(before.astype(np.uint32)))
        flipped ^= (flips & np.uint32(1)) << np.uint32(digit)
    return flipped


INTEGRANDS = {
    "edge": lambda u, v: 0.83 * u + 0.55 * v < 0.7,
    "disc": lambda u, v: (u - 0.45) ** 2 + (v - 0.52) ** 2 < 0.1,
    "smooth": lambda u, v: np.exp(u * v) * np.cos(3 * u),
}


@pytest.mark.parametrize("count", [4, 16])
def test_errors_are_those_of_digits_that_are_flipped_at_random(count):
    """As small, and no smaller: a hash that mixes too little has another variance than Owen's scrambling."""
    pixels = 20_000
    pixel, k = np.repeat(np.arange(pixels), count), np.tile(np.arange(count), pixels)
    made = sampler.sample_points(2, pixel, 0, k, 1, sampler.LENS)
    keys = [specification.low_bias(pixel.astype(np.uint32) + np.uint32(axis << 24)) for axis in range(2)]
    flipped = [owen_scramble(x, key) for x, key in zip(specification.sobol(k.astype(np.uint32)), keys, strict=True)]
    for integrand in INTEGRANDS.values():
        ours, owen = (
            integrand(*points.astype(float).T / 2**32).reshape(pixels, count).mean(axis=1)
            for points in (made, np.stack(flipped, axis=-1))
        )
        # Means and deviations of 20000 pixels are known to half a percent of the deviation.
        assert ours.mean() == pytest.approx(owen.mean(), abs=0.03 * owen.std())
        assert ours.std() == pytest.approx(owen.std(), rel=0.03)


# ---- Independent


def chi_squared(first, second, cells=16):
    """How far the joint distribution of two lists of words is from that of independent uniform ones, in deviations."""
    shift = np.uint32(32 - cells.bit_length() + 1)
    places = (first >> shift).astype(int) * cells + (second >> shift)
    found = np.bincount(places, minlength=cells * cells)
    expected = len(first) / (cells * cells)
    freedom = cells * cells - 1
    return (((found - expected) ** 2 / expected).sum() - freedom) / np.sqrt(2 * freedom)


COLUMNS, ROWS = (a.ravel() for a in np.meshgrid(np.arange(512), np.arange(512)))
FIRST = (7, COLUMNS, ROWS, 0, 1, sampler.LENS)
NEIGHBORS = {
    "seed": (8, COLUMNS, ROWS, 0, 1, sampler.LENS),
    "column": (7, COLUMNS + 1, ROWS, 0, 1, sampler.LENS),
    "row": (7, COLUMNS, ROWS + 1, 0, 1, sampler.LENS),
    "far column": (7, COLUMNS + 512, ROWS, 0, 1, sampler.LENS),
    "columns and rows exchanged": (7, ROWS, COLUMNS + 1000, 0, 1, sampler.LENS),
    "time": (7, COLUMNS, ROWS, 0, 1, sampler.TIME),
    "light": (7, COLUMNS, ROWS, 0, 1, sampler.FIRST_LIGHT + 12),
    "mirrored": (7, COLUMNS, ROWS, 0, 2, sampler.LENS),
    "transmitted": (7, COLUMNS, ROWS, 0, 3, sampler.LENS),
    "deep": (7, COLUMNS, ROWS, 0, 1 << 20, sampler.LENS),
    "use and path exchanged": (7, COLUMNS, ROWS, 0, 0, 1),
    "seed and path exchanged": (1, COLUMNS, ROWS, 0, 7, sampler.LENS),
}


@pytest.mark.parametrize("other", NEIGHBORS)
def test_points_of_different_seeds_pixels_uses_and_rays_are_independent(other):
    """In each pair of coordinates: the top digits, and those that a later digit of one could follow."""
    first, second = sampler.sample_points(*FIRST), sampler.sample_points(*NEIGHBORS[other])
    for a in first.T:
        for b in second.T:
            assert abs(chi_squared(a, b)) < 4.5
            assert abs(chi_squared(a << np.uint32(4), b)) < 4.5
            assert abs(chi_squared(a ^ b, a)) < 4.5


@pytest.mark.parametrize("independent", [False, True])
@pytest.mark.parametrize("k", [0, 1, 2, 3, 15, 255])
def test_each_sample_is_uniform_over_pixels(k, independent):
    points = sampler.sample_points(7, COLUMNS, ROWS, k, 1, sampler.LENS, independent)
    assert abs(chi_squared(points[:, 0], points[:, 1])) < 4.5
    assert abs(chi_squared(points[:, 0] << np.uint32(8), points[:, 1] << np.uint32(8))) < 4.5


@pytest.mark.parametrize("k", [1, 2, 3, 64])
def test_samples_of_a_pixel_are_independent_where_that_is_asked_for(k):
    first = sampler.sample_points(7, COLUMNS, ROWS, 0, 1, sampler.LENS, independent=True)
    second = sampler.sample_points(7, COLUMNS, ROWS, k, 1, sampler.LENS, independent=True)
    for a in first.T:
        for b in second.T:
            assert abs(chi_squared(a, b)) < 4.5
            assert abs(chi_squared(a ^ b, a)) < 4.5


@pytest.mark.parametrize("count", [4, 16])
def test_the_place_in_the_grid_tells_nothing_of_a_point(count):
    """Sample k has the same place in every pixel: over pixels it must have every stratum."""
    pixels = 1 << 14
    for k in range(count):
        points = sampler.sample_points(5, np.arange(pixels), 2, k, 1, sampler.FIRST_LIGHT)
        for axis in (0, 1):
            found = np.bincount(points[:, axis] >> np.uint32(28), minlength=16)
            expected = pixels / 16
            assert ((found - expected) ** 2 / expected).sum() < 50  # 15 degrees of freedom


def test_no_two_pixels_have_the_same_points():
    columns, rows = (a.ravel() for a in np.meshgrid(np.arange(2048), np.arange(512)))
    points = sampler.sample_points(3, columns, rows, 0, 1, sampler.LENS)
    distinct = len(np.unique(points.astype(np.uint64) @ np.array([1 << 32, 1], np.uint64)))
    assert distinct == len(points)


# ---- The face


def test_wrong_arguments_are_refused():
    with pytest.raises(ValueError, match="broadcast"):
        sampler.sample_points(0, [1, 2], [1, 2, 3], 0, 1, 0)
    with pytest.raises(OverflowError):
        sampler.sample_points(0, -1, 0, 0, 1, 0)
    with pytest.raises(ValueError, match="differ in length"):
        sampler.cone_directions([[0, 0, 1]], [0.5, 0.5], np.zeros((1, 2)))
