"""The random numbers of distributed ray tracing (Cook, Porter and Carpenter 1984), each a function of what it is for.

Sample k of a pixel has a point of the unit square for every use, such as the lens, and every ray of its tree. The
points are those of Owen-scrambled Sobol (0,2)-sequences, one for each pixel, use and ray: the first 2^m samples of a
pixel lie one in each of 2^m equal boxes, whatever the boxes' shape, and sequences are independent of one another.
Everything is 32-bit integer arithmetic, and so are the native tracer's points, in native_tracer/src/tracing/sampler.h.

Sources: Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020, for shuffling and scrambling by hashes;
Vegdahl, Building a Better LK Hash, 2021, for the permutation, which pbrt-v4 and Cycles have too; lowbias32 of Wellons,
Hash Prospector, 2018, with the constants of its issue 19, for the keys.
"""

from dataclasses import dataclass
from math import pi
from typing import Any

import drjit as dr

from mitsuba_plugins.arithmetic import quotient

# ------------------------------------------------------------------------------------------------ points, in integers
#
# Every number is a UInt32 of Dr.Jit.

LENS, TIME, MIRRORED_CONE, REFRACTED_CONE, FIRST_LIGHT = range(5)
"""What a point is for; light i, from 0, is use FIRST_LIGHT + i."""
PRIMARY_PATH = 1
"""The ray of a tree that leaves the eye; path p is followed by 2 p, mirrored, and 2 p + 1, transmitted."""


def mix(x: Any) -> Any:
    """A permutation of all words, after which each bit of the result depends on every bit of `x`."""
    x = x + 0x9E3779B9  # so that 0 does not stay 0
    x = (x ^ (x >> 16)) * 0x21F0AAAD
    x = (x ^ (x >> 15)) * 0xD35A2D97
    return x ^ (x >> 15)


def combine(key: Any, word: Any) -> Any:
    """Another key for each word, and for each key.

    The word is mixed before it meets the key: else keys that differ in a few bits only would have the same followers,
    in another order.
    """
    return mix(key ^ mix(word))


def pixel_key(seed: Any, column: Any, row: Any) -> Any:
    """The key of a pixel; in pictures up to 65536 pixels wide no two have the same."""
    return combine(seed, column + (row << 16))


def sample_point(pixel: Any, k: Any, path: Any, use: Any) -> tuple[Any, Any]:
    """The point, in units of 2^-32, of sample `k` of a pixel, for one use and one ray of its tree."""
    shuffling = combine(combine(pixel, path), use)
    scrambling_x = mix(shuffling)
    scrambling_y = mix(scrambling_x)
    index = dr.brev(_scramble_reversed(dr.brev(k), shuffling))
    x = dr.brev(_scramble_reversed(index, scrambling_x))
    y = dr.brev(_scramble_reversed(_sobol_reversed(index), scrambling_y))
    return x, y


def _scramble_reversed(x: Any, key: Any) -> Any:
    """Owen scrambling of the number whose binary digits after the point are those of `x`, the lowest bit first.

    Whether a digit is flipped depends on the key and on the digits before it.
    """
    x = x ^ (x * 0x3D20ADEA)
    x = (x + key) * ((key >> 16) | 1)
    x = x ^ (x * 0x05526C56)
    return x ^ (x * 0x53A22864)


def _sobol_reversed(index: Any) -> Any:
    """The second dimension of Sobol's sequence, reversed like the index, which is the first.

    It is the product with Pascal's triangle modulo 2, bit k the parity of the bits j of which C(j, k) is odd.
    """
    for shift, kept in ((1, 0x55555555), (2, 0x33333333), (4, 0x0F0F0F0F), (8, 0x00FF00FF), (16, 0x0000FFFF)):
        index = index ^ ((index >> shift) & kept)
    return index


@dataclass
class Sample:
    """One sample of each pixel (UInt32): the pixel's key, and the sample's number."""

    pixel: Any
    number: Any

    def square(self, number: type, path: Any, use: Any) -> tuple[Any, Any]:
        """Its point of the unit square, as the type `number`, for one use and one ray of its tree."""
        word = type(self.pixel)
        x, y = sample_point(self.pixel, self.number, word(path), word(use))
        return unit_interval(number, x), unit_interval(number, y)


# ------------------------------------------------------------------------------------ from the square to discs, cones


def unit_interval(number: type, word: Any) -> Any:
    """The middle of the 2^32 parts of 0..1 that `word` names, as the type `number`: never 0, 1/2 or 1.

    Of a Float32 there are only 2^23 parts that have a middle.
    """
    bits = 32 if dr.type_v(number) == dr.VarType.Float64 else 23
    return (number(word >> (32 - bits)) + 0.5) * 2.0**-bits


def disc_point(u: Any, v: Any) -> tuple[Any, Any]:
    """A point of the unit disc, uniform over its area: squares about the centre become circles.

    Neither number may be 1/2. Shirley and Chiu, A Low Distortion Map Between Disk and Square, Journal of Graphics
    Tools 2(3), 1997.
    """
    a, b = 2 * u - 1, 2 * v - 1
    across = dr.abs(a) > dr.abs(b)
    radius = dr.select(across, a, b)
    cosine, sine = _small_turn(pi / 4 * quotient(dr.select(across, b, a), radius))
    return radius * dr.select(across, cosine, sine), radius * dr.select(across, sine, cosine)


def frame(axis: Any) -> tuple[Any, Any]:
    """A unit vector across the unit vector `axis`, and one across both; they are right-handed with it.

    Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017. There the two jump where z changes its sign,
    and z = 0 is common, so that roundings would choose; here they jump where no axis of a scene is expected.
    """
    vector, number = type(axis), type(axis.z)
    sign = dr.select(axis.z < -0.4371, number(-1), number(1))
    a = quotient(number(-1), sign + axis.z)
    b = axis.x * axis.y * a
    tangent = vector(1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x)
    return tangent, vector(b, sign + axis.y * axis.y * a, -axis.y)


def cone_direction(axis: Any, versine: Any, u: Any, v: Any) -> Any:
    """A unit vector in the cone about `axis`, uniform in solid angle; `versine` is 1 - cos(half-angle)."""
    quarters = 4 * v
    quarter = dr.floor(quarters + 0.5)
    cosine, sine = _small_turn(pi / 2 * (quarters - quarter))
    left, down = (quarter >= 1) & (quarter <= 2), (quarter >= 2) & (quarter <= 3)
    depth = u * versine
    radius = dr.sqrt(depth * (2 - depth))
    x, y = radius * dr.select(left ^ down, sine, cosine), radius * dr.select(left ^ down, cosine, sine)
    tangent, bitangent = frame(axis)
    return dr.select(left, -x, x) * tangent + dr.select(down, -y, y) * bitangent + (1 - depth) * axis


def _small_turn(angle: Any) -> tuple[Any, Any]:
    """Cosine and sine of angles between -pi/4 and pi/4, by Taylor's series: every renderer rounds it alike."""
    terms = 9  # the tenth is less than 1e-20
    square = angle * angle
    cosine = sine = type(angle)(1)
    for n in range(terms, 0, -1):
        cosine = 1 - square * (1 / ((2 * n - 1) * 2 * n)) * cosine
        sine = 1 - square * (1 / (2 * n * (2 * n + 1))) * sine
    return cosine, angle * sine
