// Lanes<Real>: as many real numbers as one register of the processor holds, computed with as if they were one.
//
// Rays are traced in small groups, one ray to a lane. Lane i of a result depends on lane i of the operands alone, and
// every operation is the one IEEE 754 defines, so that a picture's bytes do not depend on how many lanes there are.
// The registers are the vector types of GCC and Clang; long double, which no register holds twice, has a single lane.

#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "isa.h"

namespace whitted::WHITTED_ISA {

#if defined(__AVX512F__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX2__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

// ---- What a register holds for each real type ---------------------------------------------------------------------

template <typename Real>
struct Register;

template <>
struct Register<float> {
    using Integer = std::int32_t;
    typedef float Reals __attribute__((vector_size(register_bytes)));
    typedef Integer Integers __attribute__((vector_size(register_bytes)));
    using Truths = Integers;  // 0 or -1
};

template <>
struct Register<double> {
    using Integer = std::int64_t;
    typedef double Reals __attribute__((vector_size(register_bytes)));
    typedef Integer Integers __attribute__((vector_size(register_bytes)));
    using Truths = Integers;  // 0 or -1
};

template <>
struct Register<long double> {
    using Integer = std::int64_t;
    using Reals = long double;
    using Integers = Integer;
    using Truths = bool;
};

template <typename Real>
inline constexpr int lane_count =
    std::is_same_v<Real, long double> ? 1 : register_bytes / static_cast<int>(sizeof(Real));

// ---- Truth values, integers and real numbers ----------------------------------------------------------------------

template <typename Real>
struct Mask {
    using Truths = typename Register<Real>::Truths;
    Truths value;

    static Mask none() { return {Truths{}}; }
    friend Mask operator&(Mask a, Mask b) { return {static_cast<Truths>(a.value & b.value)}; }
    friend Mask operator|(Mask a, Mask b) { return {static_cast<Truths>(a.value | b.value)}; }
    friend Mask operator^(Mask a, Mask b) { return {static_cast<Truths>(a.value ^ b.value)}; }
    friend Mask operator~(Mask a) {
        if constexpr (lane_count<Real> == 1) {
            return {!a.value};
        } else {
            return {~a.value};
        }
    }
    Mask& operator|=(Mask other) { return *this = *this | other; }
    Mask& operator&=(Mask other) { return *this = *this & other; }

    bool operator[](int lane) const {
        if constexpr (lane_count<Real> == 1) {
            return value;
        } else {
            return value[lane] != 0;
        }
    }

    // Bit i is lane i.
    unsigned bits() const {
        if constexpr (lane_count<Real> == 1) {
            return value ? 1U : 0U;
        } else {
#if defined(__AVX512F__)
            if constexpr (sizeof(Real) == 8) {
                return _mm512_movepi64_mask((__m512i)value);
            } else {
                return _mm512_movepi32_mask((__m512i)value);
            }
#elif defined(__AVX2__)
            if constexpr (sizeof(Real) == 8) {
                return static_cast<unsigned>(_mm256_movemask_pd((__m256d)value));
            } else {
                return static_cast<unsigned>(_mm256_movemask_ps((__m256)value));
            }
#elif defined(__SSE2__)
            if constexpr (sizeof(Real) == 8) {
                return static_cast<unsigned>(_mm_movemask_pd((__m128d)value));
            } else {
                return static_cast<unsigned>(_mm_movemask_ps((__m128)value));
            }
#else
            unsigned result = 0;
            for (int lane = 0; lane < lane_count<Real>; ++lane) {
                result |= (value[lane] != 0 ? 1U : 0U) << lane;
            }
            return result;
#endif
        }
    }

    // Lane i is value_of(i).
    template <typename ValueOf>
    static Mask gather(ValueOf value_of) {
        Mask result;
        if constexpr (lane_count<Real> == 1) {
            result.value = value_of(0);
        } else {
            for (int lane = 0; lane < lane_count<Real>; ++lane) {
                result.value[lane] = value_of(lane) ? -1 : 0;
            }
        }
        return result;
    }

    // The first `count` lanes.
    static Mask first(int count);
};

template <typename Real>
bool any(Mask<Real> mask) {
    return mask.bits() != 0;
}

template <typename Real>
bool all(Mask<Real> mask) {
    return mask.bits() == (1U << lane_count<Real>)-1U;
}

template <typename Real>
int count(Mask<Real> mask) {
    return std::popcount(mask.bits());
}

template <typename Real>
struct Indices {
    using Integer = typename Register<Real>::Integer;
    typename Register<Real>::Integers value;

    Indices() = default;
    Indices(Integer same) : value(typename Register<Real>::Integers{} + same) {}
    explicit Indices(std::in_place_t, typename Register<Real>::Integers v) : value(v) {}

    int operator[](int lane) const {
        if constexpr (lane_count<Real> == 1) {
            return static_cast<int>(value);
        } else {
            return static_cast<int>(value[lane]);
        }
    }
    friend Mask<Real> operator==(Indices a, Indices b) { return {a.value == b.value}; }
    friend Mask<Real> operator<(Indices a, Indices b) { return {a.value < b.value}; }
    friend Mask<Real> operator>=(Indices a, Indices b) { return {a.value >= b.value}; }

    // Lane i is value_of(i).
    template <typename ValueOf>
    static Indices gather(ValueOf value_of) {
        Indices result;
        if constexpr (lane_count<Real> == 1) {
            result.value = value_of(0);
        } else {
            for (int lane = 0; lane < lane_count<Real>; ++lane) {
                result.value[lane] = value_of(lane);
            }
        }
        return result;
    }
};

template <typename Real>
Mask<Real> Mask<Real>::first(int count) {
    return Indices<Real>::gather([](int lane) { return lane; }) < Indices<Real>(count);
}

template <typename Real>
struct Lanes {
    using Reals = typename Register<Real>::Reals;
    Reals value;

    Lanes() = default;
    Lanes(Real same) : value(same - Reals{}) {}  // x - 0 is x, whatever its sign
    explicit Lanes(std::in_place_t, Reals v) : value(v) {}

    Real operator[](int lane) const {
        if constexpr (lane_count<Real> == 1) {
            return value;
        } else {
            return value[lane];
        }
    }

    friend Lanes operator+(Lanes a, Lanes b) { return Lanes(std::in_place, a.value + b.value); }
    friend Lanes operator-(Lanes a, Lanes b) { return Lanes(std::in_place, a.value - b.value); }
    friend Lanes operator*(Lanes a, Lanes b) { return Lanes(std::in_place, a.value * b.value); }
    friend Lanes operator/(Lanes a, Lanes b) { return Lanes(std::in_place, a.value / b.value); }
    friend Lanes operator-(Lanes a) { return Lanes(std::in_place, -a.value); }
    friend Mask<Real> operator!=(Lanes a, Lanes b) { return {a.value != b.value}; }
    friend Mask<Real> operator<(Lanes a, Lanes b) { return {a.value < b.value}; }
    friend Mask<Real> operator>(Lanes a, Lanes b) { return {a.value > b.value}; }
    friend Mask<Real> operator<=(Lanes a, Lanes b) { return {a.value <= b.value}; }
    friend Mask<Real> operator>=(Lanes a, Lanes b) { return {a.value >= b.value}; }
    Lanes& operator+=(Lanes other) { return *this = *this + other; }

    // Lane i is value_of(i).
    template <typename ValueOf>
    static Lanes gather(ValueOf value_of) {
        Lanes result;
        if constexpr (lane_count<Real> == 1) {
            result.value = value_of(0);
        } else {
            for (int lane = 0; lane < lane_count<Real>; ++lane) {
                result.value[lane] = value_of(lane);
            }
        }
        return result;
    }
};

// ---- Choosing by a mask, and functions of lanes -------------------------------------------------------------------

// Lane by lane: `a` where the mask is true, else `b`.
template <typename Real>
Lanes<Real> select(Mask<Real> mask, Lanes<Real> a, Lanes<Real> b) {
    return Lanes<Real>(std::in_place, mask.value ? a.value : b.value);
}

template <typename Real>
Indices<Real> select(Mask<Real> mask, Indices<Real> a, Indices<Real> b) {
    return Indices<Real>(std::in_place, mask.value ? a.value : b.value);
}

template <typename Real>
Mask<Real> select(Mask<Real> mask, Mask<Real> a, Mask<Real> b) {
    return (mask & a) | (~mask & b);
}

template <typename Real>
Lanes<Real> sqrt(Lanes<Real> a) {
    if constexpr (lane_count<Real> == 1) {
        return Lanes<Real>(std::sqrt(a.value));
    } else {
#if defined(__AVX512F__)
        if constexpr (sizeof(Real) == 8) {
            return Lanes<Real>(std::in_place, _mm512_maskz_sqrt_pd(0xFF, a.value));
        } else {
            return Lanes<Real>(std::in_place, _mm512_maskz_sqrt_ps(0xFFFF, a.value));
        }
#elif defined(__AVX2__)
        if constexpr (sizeof(Real) == 8) {
            return Lanes<Real>(std::in_place, _mm256_sqrt_pd(a.value));
        } else {
            return Lanes<Real>(std::in_place, _mm256_sqrt_ps(a.value));
        }
#elif defined(__SSE2__)
        if constexpr (sizeof(Real) == 8) {
            return Lanes<Real>(std::in_place, _mm_sqrt_pd(a.value));
        } else {
            return Lanes<Real>(std::in_place, _mm_sqrt_ps(a.value));
        }
#else
        return Lanes<Real>::gather([&](int lane) { return std::sqrt(a[lane]); });
#endif
    }
}

template <typename Real>
Lanes<Real> floor(Lanes<Real> a) {
#if defined(__AVX2__) && !defined(__AVX512F__)
    if constexpr (sizeof(Real) == 8) {
        return Lanes<Real>(std::in_place, _mm256_floor_pd(a.value));
    } else if constexpr (sizeof(Real) == 4) {
        return Lanes<Real>(std::in_place, _mm256_floor_ps(a.value));
    }
#endif
    return Lanes<Real>::gather([&](int lane) { return std::floor(a[lane]); });
}

template <typename Real>
Lanes<Real> min(Lanes<Real> a, Lanes<Real> b) {
    return select(a < b, a, b);
}

template <typename Real>
Lanes<Real> max(Lanes<Real> a, Lanes<Real> b) {
    return select(a > b, a, b);
}

template <typename Real>
Lanes<Real> abs(Lanes<Real> a) {
    return max(a, -a);
}

// base^exponent, neither negative; 0^0 is 1. Whole exponents are multiplied out, in 2 log2(exponent) steps at most: a
// base that is itself rounded is worth no more, and the result is the same with any C library.
template <typename Real>
Lanes<Real> power(Lanes<Real> base, Real exponent) {
    if (exponent > 65536 || exponent != std::floor(exponent)) {
        return Lanes<Real>::gather([&](int lane) { return std::pow(base[lane], exponent); });
    }
    Lanes<Real> result = Real(1);
    for (auto bits = static_cast<unsigned>(exponent); bits != 0; bits >>= 1) {
        if (bits % 2 != 0) {
            result = result * base;
        }
        base = base * base;
    }
    return result;
}

// Calls visit(value, lane, same) once for each distinct value among the lanes in `wanted`; `same` are the lanes that
// have it, and `lane` is the first of them.
template <typename Real, typename Visit>
[[gnu::always_inline]] inline void for_each_distinct(Indices<Real> values, Mask<Real> wanted, Visit visit) {
    for (unsigned left = wanted.bits(); left != 0;) {
        const int lane = std::countr_zero(left);
        const Mask<Real> same = values == Indices<Real>(values[lane]);
        visit(values[lane], lane, same);
        left &= ~same.bits();
    }
}

}  // namespace whitted::WHITTED_ISA
