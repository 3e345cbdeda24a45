// The random numbers of distributed ray tracing (Cook, Porter and Carpenter 1984), each a function of what it is for.
//
// Sample k of a pixel has a point of the unit square for every use, such as the lens, and every ray of its tree. The
// points are those of Owen-scrambled Sobol (0,2)-sequences, one for each pixel, use and ray: the first 2^m samples of
// a pixel lie one in each of 2^m equal boxes, whatever the boxes' shape, and sequences are independent of one another.
// Everything is 32-bit integer arithmetic, so mitsuba_plugins/sampler.py has the same points, and neither threads nor
// lanes change them.
//
// Sources: Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020, for shuffling and scrambling by hashes;
// Vegdahl, Building a Better LK Hash, 2021, for the permutation, which pbrt-v4 and Cycles have too; lowbias32 of
// Wellons, Hash Prospector, 2018, with the constants of its issue 19, for the keys.

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>

#include "tracing/isa.h"
#include "tracing/lanes.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// ---- Points, in integers ------------------------------------------------------------------------------------------
//
// A Word is a std::uint32_t, or a vector of them, of GCC and Clang.

// What a point is for; light i, from 0, is use first_light + i.
namespace use {
inline constexpr std::uint32_t lens = 0, time = 1, mirrored_cone = 2, refracted_cone = 3, first_light = 4;
}

// The ray of a tree that leaves the eye, and those that follow a ray. Beyond 31 bounces paths begin to repeat.
inline constexpr std::uint32_t primary_path = 1;
template <typename Word>
Word mirrored_path(Word path) {
    return path << 1;
}
template <typename Word>
Word transmitted_path(Word path) {
    return (path << 1) + 1;
}

// A permutation of all words, after which each bit of the result depends on every bit of x.
template <typename Word>
[[gnu::always_inline]] inline Word mix(Word x) {
    x += 0x9e3779b9;  // so that 0 does not stay 0
    x ^= x >> 16;
    x *= 0x21f0aaad;
    x ^= x >> 15;
    x *= 0xd35a2d97;
    x ^= x >> 15;
    return x;
}

// Another key for each word, and for each key. The word is mixed before it meets the key: else keys that differ in a
// few bits only would have the same followers, in another order.
template <typename Word>
[[gnu::always_inline]] inline Word combine(Word key, Word word) {
    return mix(static_cast<Word>(key ^ mix(word)));
}

// Of a pixel. In pictures up to 65536 pixels wide no two have the same.
template <typename Word>
[[gnu::always_inline]] inline Word pixel_key(Word seed, Word column, Word row) {
    return combine(seed, static_cast<Word>(column + (row << 16)));
}

template <typename Word>
[[gnu::always_inline]] inline Word reverse_bits(Word x) {
    x = (x >> 16) | (x << 16);
    x = ((x & 0xff00ff00) >> 8) | ((x & 0x00ff00ff) << 8);
    x = ((x & 0xf0f0f0f0) >> 4) | ((x & 0x0f0f0f0f) << 4);
    x = ((x & 0xcccccccc) >> 2) | ((x & 0x33333333) << 2);
    return ((x & 0xaaaaaaaa) >> 1) | ((x & 0x55555555) << 1);
}

// Owen scrambling of the number whose binary digits after the point are x's, the lowest bit first: whether a digit is
// flipped depends on the key and on the digits before it.
template <typename Word>
[[gnu::always_inline]] inline Word scramble_reversed(Word x, Word key) {
    x ^= x * 0x3d20adea;
    x += key;
    x *= (key >> 16) | 1;
    x ^= x * 0x05526c56;
    x ^= x * 0x53a22864;
    return x;
}

// The second dimension of Sobol's sequence, reversed like the index, which is the first: the product with Pascal's
// triangle modulo 2, bit k the parity of the bits j of which C(j, k) is odd.
template <typename Word>
[[gnu::always_inline]] inline Word sobol_reversed(Word index) {
    index ^= (index >> 1) & 0x55555555;
    index ^= (index >> 2) & 0x33333333;
    index ^= (index >> 4) & 0x0f0f0f0f;
    index ^= (index >> 8) & 0x00ff00ff;
    index ^= index >> 16;
    return index;
}

// In units of 2^-32.
template <typename Word>
struct SamplePoint {
    Word x, y;
};

// The point of sample k of a pixel for one use, and one ray of its tree.
template <typename Word>
[[gnu::always_inline]] inline SamplePoint<Word> sample_point(Word pixel, Word k, Word path, Word use) {
    const Word shuffling = combine(combine(pixel, path), use);
    const Word scrambling_x = mix(shuffling);
    const Word scrambling_y = mix(scrambling_x);
    const Word index = reverse_bits(scramble_reversed(reverse_bits(k), shuffling));
    return {reverse_bits(scramble_reversed(index, scrambling_x)),
            reverse_bits(scramble_reversed(sobol_reversed(index), scrambling_y))};
}

// What makes the points of one pixel independent of each other, too: each sample is named like a pixel of its own, and
// has the first point of its sequence. Only to measure what stratification is worth.
template <typename Word>
[[gnu::always_inline]] inline void make_independent(Word& pixel, Word& k) {
    pixel = combine(pixel, k);
    k = Word{};
}

// ---- In lanes -----------------------------------------------------------------------------------------------------

// Words for all lanes: more than there are lanes, where they fill a register.
template <typename Real>
struct WordRows {
    typedef std::uint32_t Words __attribute__((vector_size(sizeof(typename Register<Real>::Reals))));
    static constexpr int words = sizeof(typename Register<Real>::Reals) / sizeof(std::uint32_t);
    static constexpr int size = std::max(words, lane_count<Real>);
    using Row = std::array<std::uint32_t, size>;
};

struct PixelKey {
    std::uint32_t value;
};

// Which sample of which pixel each lane is, and which ray of its tree.
template <typename Real>
struct SampleNames {
    typename WordRows<Real>::Row pixel_key, number, path;
};

template <typename Real>
struct PlanePoint {
    Lanes<Real> x, y;
};

// The middle of the 2^32 parts of 0..1 that the word names, or of as many as have a middle in this precision: never 0,
// 1/2 or 1.
template <typename Real>
Real unit_interval(std::uint32_t word) {
    constexpr int bits = std::min(32, std::numeric_limits<Real>::digits - 1);
    constexpr Real part = Real(1) / static_cast<Real>(std::uint64_t{1} << bits);
    return (static_cast<Real>(word >> (32 - bits)) + Real(0.5)) * part;
}

// The samples' points of the unit square for one use.
template <typename Real>
[[gnu::noinline]] PlanePoint<Real> square_point(const SampleNames<Real>& names, std::uint32_t use) {
    using Rows = WordRows<Real>;
    using Words = typename Rows::Words;
    static_assert(sizeof(Words) == Rows::words * sizeof(std::uint32_t) && Rows::size % Rows::words == 0);
    typename Rows::Row x, y;
    for (int first = 0; first < Rows::size; first += Rows::words) {
        Words pixel_key, number, path;
        std::memcpy(&pixel_key, names.pixel_key.data() + first, sizeof(Words));
        std::memcpy(&number, names.number.data() + first, sizeof(Words));
        std::memcpy(&path, names.path.data() + first, sizeof(Words));
        const SamplePoint<Words> point = sample_point(pixel_key, number, path, Words{} + use);
        std::memcpy(x.data() + first, &point.x, sizeof(Words));
        std::memcpy(y.data() + first, &point.y, sizeof(Words));
    }
    const auto lanes_of = [](const auto& row) {
        return Lanes<Real>::gather([&](int lane) { return unit_interval<Real>(row[static_cast<std::size_t>(lane)]); });
    };
    return {lanes_of(x), lanes_of(y)};
}

// ---- From the square to discs and cones ---------------------------------------------------------------------------

// Cosine and sine of angles between -pi/4 and pi/4, by Taylor's series: every renderer rounds it alike.
template <typename Real>
PlanePoint<Real> small_turn(Lanes<Real> angle) {
    using L = Lanes<Real>;
    constexpr int terms = 9;  // the tenth is less than 1e-20
    const L square = angle * angle;
    L cosine = Real(1), sine = Real(1);
    for (int n = terms; n > 0; --n) {
        cosine = L(1) - square * L(Real(1) / static_cast<Real>((2 * n - 1) * 2 * n)) * cosine;
        sine = L(1) - square * L(Real(1) / static_cast<Real>(2 * n * (2 * n + 1))) * sine;
    }
    return {cosine, angle * sine};
}

// A point of the unit disc, uniform over its area: squares about the centre become circles. Neither u nor v is 1/2.
// Shirley and Chiu, A Low Distortion Map Between Disk and Square, Journal of Graphics Tools 2(3), 1997.
template <typename Real>
PlanePoint<Real> disc_point(Lanes<Real> u, Lanes<Real> v) {
    using L = Lanes<Real>;
    const L a = L(2) * u - L(1), b = L(2) * v - L(1);
    const Mask<Real> across = abs(a) > abs(b);
    const L radius = select(across, a, b);
    const PlanePoint<Real> turn = small_turn(L(std::numbers::pi_v<Real> / 4) * (select(across, b, a) / radius));
    return {radius * select(across, turn.x, turn.y), radius * select(across, turn.y, turn.x)};
}

// A unit vector across the unit vector `axis`, and one across both; they are right-handed with it.
// Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017. There the two jump where z changes its sign,
// and z = 0 is common, so that roundings would choose; here they jump where no axis of a scene is expected.
template <typename Real>
struct Frame {
    Vector<Lanes<Real>> tangent, bitangent, axis;

    explicit Frame(const Vector<Lanes<Real>>& axis_) : axis(axis_) {
        using L = Lanes<Real>;
        const L sign = select(axis.z < L(Real(-0.4371)), L(-1), L(1));
        const L a = L(-1) / (sign + axis.z);
        const L b = axis.x * axis.y * a;
        tangent = {L(1) + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
        bitangent = {b, sign + axis.y * axis.y * a, -axis.y};
    }
};

// A unit vector in a cone, uniform in solid angle; `versine` is 1 - cos(half-angle).
template <typename Real>
Vector<Lanes<Real>> cone_direction(const Frame<Real>& frame, Lanes<Real> versine, Lanes<Real> u, Lanes<Real> v) {
    using L = Lanes<Real>;
    const L quarters = L(4) * v;
    const L quarter = floor(quarters + L(Real(0.5)));
    const PlanePoint<Real> turn = small_turn(L(std::numbers::pi_v<Real> / 2) * (quarters - quarter));
    const Mask<Real> left = (quarter >= L(1)) & (quarter <= L(2)), down = (quarter >= L(2)) & (quarter <= L(3));
    const L depth = u * versine;
    const L radius = sqrt(depth * (L(2) - depth));
    const L x = radius * select(left ^ down, turn.y, turn.x), y = radius * select(left ^ down, turn.x, turn.y);
    return select(left, -x, x) * frame.tangent + select(down, -y, y) * frame.bitangent + (L(1) - depth) * frame.axis;
}

}  // namespace whitted::WHITTED_ISA
