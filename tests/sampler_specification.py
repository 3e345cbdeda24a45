"""The points of samples, and their maps to discs and cones, written down once more as the sources have them.

NumPy's words of 32 bits wrap around as the renderers' do. Nothing here shares a shortcut with the renderers: Sobol's
second dimension is made of its direction numbers, scrambling reverses the digits before and after, and the maps compute
in extended precision with the library's functions.
"""

import numpy as np

WORD = np.uint32
REAL = np.longdouble


def words(*values):
    return np.broadcast_arrays(*(np.atleast_1d(np.asarray(value, WORD)) for value in values))


def low_bias(x):
    """`mix`."""
    x = x + WORD(0x9E3779B9)
    x = (x ^ (x >> WORD(16))) * WORD(0x21F0AAAD)
    x = (x ^ (x >> WORD(15))) * WORD(0xD35A2D97)
    return x ^ (x >> WORD(15))


def reversed_bits(x):
    octets = np.ascontiguousarray(x).view(np.uint8).reshape(*x.shape, 4)
    bits = np.unpackbits(octets[..., ::-1], axis=-1)[..., ::-1]
    return np.packbits(bits, axis=-1).copy().view(">u4")[..., 0].astype(WORD)


def nested_uniform_scramble(x, key):
    x = reversed_bits(x)
    x = x ^ (x * WORD(0x3D20ADEA))
    x = x + key
    x = x * ((key >> WORD(16)) | WORD(1))
    x = x ^ (x * WORD(0x05526C56))
    x = x ^ (x * WORD(0x53A22864))
    return reversed_bits(x)


def sobol(index):
    """The sequence's points in units of 2^-32."""
    x, y = np.zeros_like(index), np.zeros_like(index)
    first, second = 1 << 31, 1 << 31
    for bit in range(32):
        there = WORD(0) - ((index >> WORD(bit)) & WORD(1))
        x ^= there & WORD(first)
        y ^= there & WORD(second)
        first >>= 1
        second ^= second >> 1
    return x, y


def sample_points(seed, column, row, k, path, use, independent=False):
    column, row, k, path, use = words(column, row, k, path, use)
    pixel = low_bias(WORD(seed) ^ low_bias(column + (row << WORD(16))))
    if independent:
        pixel, k = low_bias(pixel ^ low_bias(k)), np.zeros_like(k)
    key = low_bias(low_bias(pixel ^ low_bias(path)) ^ low_bias(use))
    x, y = sobol(nested_uniform_scramble(k, key))
    x = nested_uniform_scramble(x, low_bias(key))
    y = nested_uniform_scramble(y, low_bias(low_bias(key)))
    return np.stack([x, y], axis=-1)


def unit_square(points):
    """In extended precision."""
    return ((points.astype(REAL) + REAL(0.5)) / REAL(2) ** 32).T


def disc_points(points):
    """Region by region, as Shirley and Chiu have it."""
    u, v = unit_square(points)
    a, b = 2 * u - 1, 2 * v - 1
    quarter = np.arctan(REAL(1))
    first, second = np.abs(a) > np.abs(b), np.abs(a) <= np.abs(b)
    radius = np.where(first, a, b)
    angle = np.empty_like(a)
    angle[first] = quarter * (b[first] / a[first])
    angle[second] = 2 * quarter - quarter * (a[second] / b[second])
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def cone_directions(axes, versines, points):
    u, v = unit_square(points)
    cosine = 1 - u * np.asarray(versines, REAL)
    sine = np.sqrt(u * versines * (2 - u * versines))
    angle = 8 * np.arctan(REAL(1)) * v
    x, y, z = np.asarray(axes, REAL).T
    sign = np.where(z < REAL(-0.4371), REAL(-1), REAL(1))
    a = -1 / (sign + z)
    tangent = np.stack([1 + sign * x * x * a, sign * x * y * a, -sign * x], axis=-1)
    bitangent = np.stack([x * y * a, sign + y * y * a, -y], axis=-1)
    across = np.cos(angle)[:, None] * tangent + np.sin(angle)[:, None] * bitangent
    return sine[:, None] * across + cosine[:, None] * np.asarray(axes, REAL)
