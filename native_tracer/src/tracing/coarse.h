// Coarse<Real>: a number for each lane of Lanes<Real>, in single precision, for what need only be bounded. There are
// twice as many to a register as in double. Long double has one lane, and nothing to gain.

#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "tracing/isa.h"
#include "tracing/lanes.h"
#include "tracing/register.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Coarse {
    using Number = std::conditional_t<std::is_same_v<Real, long double>, long double, float>;
    using R = Register<Number>;
    using Reals = typename R::Reals;
    Reals value[lane_count<Real> / R::lanes];

    Coarse() = default;
    Coarse(Number same) : Coarse(each<Coarse>([same] { return same - Reals{}; })) {}

    // Small whole numbers, a byte each.
    static Coarse of_bytes(const unsigned char* from) {
        Coarse result;
        result.value[0] = R::of_bytes(from);
        if constexpr (sizeof(result.value) > sizeof(result.value[0])) {
            result.value[1] = R::of_bytes(from + R::lanes);
        }
        return result;
    }

    Number operator[](int lane) const {
        if constexpr (R::lanes == 1) {
            return value[0];
        } else {
            return value[lane / R::lanes][lane % R::lanes];
        }
    }

    friend Coarse operator*(Coarse a, Coarse b) {
        return each<Coarse>([](Reals x, Reals y) { return x * y; }, a, b);
    }
    friend Coarse operator/(Coarse a, Coarse b) {
        return each<Coarse>([](Reals x, Reals y) { return x / y; }, a, b);
    }
    friend Coarse min(Coarse a, Coarse b) {
        return each<Coarse>([](Reals x, Reals y) { return R::min(x, y); }, a, b);
    }
    friend Coarse max(Coarse a, Coarse b) {
        return each<Coarse>([](Reals x, Reals y) { return R::max(x, y); }, a, b);
    }
    friend Coarse abs(Coarse a) {
        return each<Coarse>([](Reals x) { return R::abs(x); }, a);
    }
    // a b - c, rounded once where the processor can, else twice.
    friend Coarse multiply_subtract(Coarse a, Coarse b, Coarse c) {
        return each<Coarse>([](Reals x, Reals y, Reals z) { return R::multiply_subtract(x, y, z); }, a, b, c);
    }
    // `then` where a <= b, else `otherwise`.
    friend Coarse select_less_equal(Coarse a, Coarse b, Coarse then, Coarse otherwise) {
        return each<Coarse>(
            [](Reals x, Reals y, Reals one, Reals other) { return R::select(R::less_equal(x, y), one, other); }, a, b,
            then, otherwise);
    }
    // Bit i is lane i.
    friend unsigned bits_less_equal(Coarse a, Coarse b) {
        unsigned bits = R::bits(R::less_equal(a.value[0], b.value[0]));
        if constexpr (sizeof(a.value) > sizeof(a.value[0])) {
            bits |= R::bits(R::less_equal(a.value[1], b.value[1])) << R::lanes;
        }
        return bits;
    }
    friend bool any_less_equal(Coarse a, Coarse b) {
        auto some = R::less_equal(a.value[0], b.value[0]);
        if constexpr (sizeof(a.value) > sizeof(a.value[0])) {
            some |= R::less_equal(a.value[1], b.value[1]);
        }
        return R::bits(some) != 0;
    }
};

// To the nearest numbers.
template <typename Real>
Coarse<Real> rounded(Lanes<Real> lanes) {
    Coarse<Real> result;
    if constexpr (std::is_same_v<typename Coarse<Real>::Number, Real>) {
        for (int i = 0; i < register_count<Real>; ++i) {
            result.value[i] = lanes.value[i];
        }
    } else {
        typedef float Half __attribute__((vector_size(sizeof(lanes.value[0]) / 2)));
        [&]<std::size_t... lane>(std::index_sequence<lane...>) {
            result.value[0] =
                __builtin_shufflevector(__builtin_convertvector(lanes.value[0], Half),
                                        __builtin_convertvector(lanes.value[1], Half), static_cast<int>(lane)...);
        }(std::make_index_sequence<lane_count<Real>>());
    }
    return result;
}

}  // namespace whitted::WHITTED_ISA
