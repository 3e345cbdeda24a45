// Lanes<Real>: a few registers full of real numbers, computed with as if they were one.
//
// Rays are traced in small groups, one ray to a lane. Lane i of a result depends on lane i of the operands alone, and
// every operation is the one IEEE 754 defines, so that a picture's bytes do not depend on how many lanes there are.
// The registers are the vector types of GCC and Clang; a group has two of them, so that one can be worked on while a
// square root or a quotient of the other is awaited. long double, which no register holds twice, has a single lane.

#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>
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
#ifndef REGS
#define REGS 2
#endif

// ---- One register -------------------------------------------------------------------------------------------------

template <typename Real>
struct Register;

template <>
struct Register<float> {
    static constexpr int lanes = register_bytes / 4;
    using Integer = std::int32_t;
    typedef float Reals __attribute__((vector_size(register_bytes)));
    typedef Integer Integers __attribute__((vector_size(register_bytes)));
#if defined(__AVX512F__)
    using Truths = __mmask16;
#else
    using Truths = Integers;  // 0 or -1
#endif
};

template <>
struct Register<double> {
    static constexpr int lanes = register_bytes / 8;
    using Integer = std::int64_t;
    typedef double Reals __attribute__((vector_size(register_bytes)));
    typedef Integer Integers __attribute__((vector_size(register_bytes)));
#if defined(__AVX512F__)
    using Truths = __mmask8;
#else
    using Truths = Integers;  // 0 or -1
#endif
};

template <>
struct Register<long double> {
    static constexpr int lanes = 1;
    using Integer = std::int64_t;
    using Reals = long double;
    using Integers = Integer;
    using Truths = bool;
};

template <typename Real>
inline constexpr int registers = std::is_same_v<Real, long double> ? 1 : REGS;

template <typename Real>
inline constexpr int lane_count = registers<Real>* Register<Real>::lanes;

// The same of every register: {operation(0), operation(1), ...}.
template <typename Result, typename Operation>
[[gnu::always_inline]] inline Result each_register(Operation operation) {
    return [&]<std::size_t... i>(std::index_sequence<i...>) __attribute__((always_inline)) {
        Result result;
        ((result.value[i] = operation(i)), ...);
        return result;
    }(std::make_index_sequence<sizeof(Result::value) / sizeof(Result::value[0])>());
}
#define EACH(Result, expression) \
    each_register<Result>([&](std::size_t i) __attribute__((always_inline)) { return expression; })

// ---- Truth values, integers and real numbers ----------------------------------------------------------------------

template <typename Real>
struct Mask {
    using Truths = typename Register<Real>::Truths;
    Truths value[registers<Real>];

    static Mask none() { return EACH(Mask, Truths{}); }
    friend Mask operator&(Mask a, Mask b) { return EACH(Mask, static_cast<Truths>(a.value[i] & b.value[i])); }
    friend Mask operator|(Mask a, Mask b) { return EACH(Mask, static_cast<Truths>(a.value[i] | b.value[i])); }
    friend Mask operator^(Mask a, Mask b) { return EACH(Mask, static_cast<Truths>(a.value[i] ^ b.value[i])); }
    friend Mask operator~(Mask a) {
        if constexpr (lane_count<Real> == 1) {
            return {{!a.value[0]}};
        } else {
            return EACH(Mask, static_cast<Truths>(~a.value[i]));
        }
    }
    Mask& operator|=(Mask other) { return *this = *this | other; }
    Mask& operator&=(Mask other) { return *this = *this & other; }

    bool operator[](int lane) const { return (bits() >> lane & 1U) != 0; }

    // Bit i is lane i.
    unsigned bits() const {
        unsigned result = 0;
        for (int i = 0; i < registers<Real>; ++i) {
            result |= bits_of(value[i]) << (i * Register<Real>::lanes);
        }
        return result;
    }

    // The first `count` lanes.
    static Mask first(int count);

    static unsigned bits_of(Truths truths) {
        if constexpr (lane_count<Real> == 1) {
            return truths ? 1U : 0U;
        } else {
#if defined(__AVX512F__)
            return truths;
#elif defined(__AVX2__)
            if constexpr (sizeof(Real) == 8) {
                return static_cast<unsigned>(_mm256_movemask_pd((__m256d)truths));
            } else {
                return static_cast<unsigned>(_mm256_movemask_ps((__m256)truths));
            }
#elif defined(__SSE2__)
            if constexpr (sizeof(Real) == 8) {
                return static_cast<unsigned>(_mm_movemask_pd((__m128d)truths));
            } else {
                return static_cast<unsigned>(_mm_movemask_ps((__m128)truths));
            }
#else
            unsigned result = 0;
            for (int lane = 0; lane < Register<Real>::lanes; ++lane) {
                result |= (truths[lane] != 0 ? 1U : 0U) << lane;
            }
            return result;
#endif
        }
    }
};

template <typename Real>
bool any(Mask<Real> mask) {
    typename Mask<Real>::Truths some = mask.value[0];
    for (int i = 1; i < registers<Real>; ++i) {
        some = static_cast<typename Mask<Real>::Truths>(some | mask.value[i]);
    }
    return Mask<Real>::bits_of(some) != 0;
}

template <typename Real>
bool all(Mask<Real> mask) {
    return !any(~mask);
}

template <typename Real>
int count(Mask<Real> mask) {
    return std::popcount(mask.bits());
}

enum class Order { less, less_equal, equal, not_equal };

template <Order order, typename Real>
[[gnu::always_inline]] inline typename Register<Real>::Truths compare(typename Register<Real>::Reals a,
                                                                      typename Register<Real>::Reals b) {
#if defined(__AVX512F__)
    constexpr int predicate = order == Order::less         ? _CMP_LT_OS
                              : order == Order::less_equal ? _CMP_LE_OS
                              : order == Order::equal      ? _CMP_EQ_OQ
                                                           : _CMP_NEQ_UQ;
    if constexpr (sizeof(Real) == 8) {
        return _mm512_cmp_pd_mask(a, b, predicate);
    } else if constexpr (sizeof(Real) == 4) {
        return _mm512_cmp_ps_mask(a, b, predicate);
    } else
#endif
        if constexpr (order == Order::less) {
        return a < b;
    } else if constexpr (order == Order::less_equal) {
        return a <= b;
    } else if constexpr (order == Order::equal) {
        return a == b;
    } else {
        return a != b;
    }
}

template <Order order, typename Real>
[[gnu::always_inline]] inline typename Register<Real>::Truths compare_integers(typename Register<Real>::Integers a,
                                                                      typename Register<Real>::Integers b) {
#if defined(__AVX512F__)
    constexpr int predicate = order == Order::less         ? _MM_CMPINT_LT
                              : order == Order::less_equal ? _MM_CMPINT_LE
                              : order == Order::equal      ? _MM_CMPINT_EQ
                                                           : _MM_CMPINT_NE;
    if constexpr (sizeof(Real) == 8) {
        return _mm512_cmp_epi64_mask((__m512i)a, (__m512i)b, predicate);
    } else if constexpr (sizeof(Real) == 4) {
        return _mm512_cmp_epi32_mask((__m512i)a, (__m512i)b, predicate);
    } else
#endif
        if constexpr (order == Order::less) {
        return a < b;
    } else if constexpr (order == Order::less_equal) {
        return a <= b;
    } else if constexpr (order == Order::equal) {
        return a == b;
    } else {
        return a != b;
    }
}

template <typename Real>
struct Indices {
    using Integer = typename Register<Real>::Integer;
    using Integers = typename Register<Real>::Integers;
    Integers value[registers<Real>];

    Indices() = default;
    Indices(Integer same) { *this = EACH(Indices, Integers{} + same); }

    int operator[](int lane) const {
        if constexpr (lane_count<Real> == 1) {
            return static_cast<int>(value[0]);
        } else {
            return static_cast<int>(value[lane / Register<Real>::lanes][lane % Register<Real>::lanes]);
        }
    }
    friend Indices operator+(Indices a, Indices b) { return EACH(Indices, a.value[i] + b.value[i]); }
    friend Mask<Real> operator==(Indices a, Indices b) {
        return EACH(Mask<Real>, (compare_integers<Order::equal, Real>(a.value[i], b.value[i])));
    }
    friend Mask<Real> operator<(Indices a, Indices b) {
        return EACH(Mask<Real>, (compare_integers<Order::less, Real>(a.value[i], b.value[i])));
    }
    friend Mask<Real> operator>=(Indices a, Indices b) {
        return EACH(Mask<Real>, (compare_integers<Order::less_equal, Real>(b.value[i], a.value[i])));
    }

    // Lane i is value_of(i).
    template <typename ValueOf>
    static Indices gather(ValueOf value_of) {
        Integer values[lane_count<Real>];
        for (int lane = 0; lane < lane_count<Real>; ++lane) {
            values[lane] = value_of(lane);
        }
        Indices result;
        std::memcpy(&result, values, sizeof(result));
        return result;
    }
    // 0, 1, 2 and so on.
    static Indices numbers() {
        return gather([](int lane) { return lane; });
    }
};

template <typename Real>
Mask<Real> Mask<Real>::first(int count) {
    return Indices<Real>::numbers() < Indices<Real>(count);
}

template <typename Real>
struct Lanes {
    using Reals = typename Register<Real>::Reals;
    Reals value[registers<Real>];

    Lanes() = default;
    Lanes(Real same) { *this = EACH(Lanes, same - Reals{}); }  // x - 0 is x, whatever its sign

    Real operator[](int lane) const {
        if constexpr (lane_count<Real> == 1) {
            return value[0];
        } else {
            return value[lane / Register<Real>::lanes][lane % Register<Real>::lanes];
        }
    }

    friend Lanes operator+(Lanes a, Lanes b) { return EACH(Lanes, a.value[i] + b.value[i]); }
    friend Lanes operator-(Lanes a, Lanes b) { return EACH(Lanes, a.value[i] - b.value[i]); }
    friend Lanes operator*(Lanes a, Lanes b) { return EACH(Lanes, a.value[i] * b.value[i]); }
    friend Lanes operator/(Lanes a, Lanes b) { return EACH(Lanes, a.value[i] / b.value[i]); }
    friend Lanes operator-(Lanes a) { return EACH(Lanes, -a.value[i]); }
    friend Mask<Real> operator!=(Lanes a, Lanes b) {
        return EACH(Mask<Real>, (compare<Order::not_equal, Real>(a.value[i], b.value[i])));
    }
    friend Mask<Real> operator<(Lanes a, Lanes b) {
        return EACH(Mask<Real>, (compare<Order::less, Real>(a.value[i], b.value[i])));
    }
    friend Mask<Real> operator>(Lanes a, Lanes b) { return b < a; }
    friend Mask<Real> operator<=(Lanes a, Lanes b) {
        return EACH(Mask<Real>, (compare<Order::less_equal, Real>(a.value[i], b.value[i])));
    }
    friend Mask<Real> operator>=(Lanes a, Lanes b) { return b <= a; }
    Lanes& operator+=(Lanes other) { return *this = *this + other; }

    // Lane i is value_of(i).
    template <typename ValueOf>
    static Lanes gather(ValueOf value_of) {
        Real values[lane_count<Real>];
        for (int lane = 0; lane < lane_count<Real>; ++lane) {
            values[lane] = value_of(lane);
        }
        Lanes result;
        std::memcpy(&result, values, sizeof(result));
        return result;
    }
};

// ---- Choosing by a mask, and functions of lanes -------------------------------------------------------------------

// Lane by lane: `a` where the mask is true, else `b`.
template <typename Real>
Lanes<Real> select(Mask<Real> mask, Lanes<Real> a, Lanes<Real> b) {
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 8) {
        return EACH(Lanes<Real>, _mm512_mask_blend_pd(mask.value[i], b.value[i], a.value[i]));
    } else if constexpr (sizeof(Real) == 4) {
        return EACH(Lanes<Real>, _mm512_mask_blend_ps(mask.value[i], b.value[i], a.value[i]));
    } else
#endif
        return EACH(Lanes<Real>, mask.value[i] ? a.value[i] : b.value[i]);
}

template <typename Real>
Indices<Real> select(Mask<Real> mask, Indices<Real> a, Indices<Real> b) {
    using Integers [[maybe_unused]] = typename Register<Real>::Integers;
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 8) {
        return EACH(Indices<Real>,
                    (Integers)_mm512_mask_blend_epi64(mask.value[i], (__m512i)b.value[i], (__m512i)a.value[i]));
    } else if constexpr (sizeof(Real) == 4) {
        return EACH(Indices<Real>,
                    (Integers)_mm512_mask_blend_epi32(mask.value[i], (__m512i)b.value[i], (__m512i)a.value[i]));
    } else
#endif
        return EACH(Indices<Real>, mask.value[i] ? a.value[i] : b.value[i]);
}

template <typename Real>
Mask<Real> select(Mask<Real> mask, Mask<Real> a, Mask<Real> b) {
    return (mask & a) | (~mask & b);
}

template <typename Real>
Lanes<Real> sqrt(Lanes<Real> a) {
    using L = Lanes<Real>;
    if constexpr (lane_count<Real> == 1) {
        return L(std::sqrt(a.value[0]));
    } else {
#if defined(__AVX512F__)
        if constexpr (sizeof(Real) == 8) {
            return EACH(L, _mm512_maskz_sqrt_pd(0xFF, a.value[i]));
        } else {
            return EACH(L, _mm512_maskz_sqrt_ps(0xFFFF, a.value[i]));
        }
#elif defined(__AVX2__)
        if constexpr (sizeof(Real) == 8) {
            return EACH(L, _mm256_sqrt_pd(a.value[i]));
        } else {
            return EACH(L, _mm256_sqrt_ps(a.value[i]));
        }
#elif defined(__SSE2__)
        if constexpr (sizeof(Real) == 8) {
            return EACH(L, _mm_sqrt_pd(a.value[i]));
        } else {
            return EACH(L, _mm_sqrt_ps(a.value[i]));
        }
#else
        return L::gather([&](int lane) { return std::sqrt(a[lane]); });
#endif
    }
}

template <typename Real>
Lanes<Real> floor(Lanes<Real> a) {
    using L = Lanes<Real>;
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 8) {
        return EACH(L, _mm512_maskz_roundscale_pd(0xFF, a.value[i], _MM_FROUND_FLOOR));
    } else if constexpr (sizeof(Real) == 4) {
        return EACH(L, _mm512_maskz_roundscale_ps(0xFFFF, a.value[i], _MM_FROUND_FLOOR));
    } else
#elif defined(__AVX2__)
    if constexpr (sizeof(Real) == 8) {
        return EACH(L, _mm256_floor_pd(a.value[i]));
    } else if constexpr (sizeof(Real) == 4) {
        return EACH(L, _mm256_floor_ps(a.value[i]));
    } else
#endif
    return L::gather([&](int lane) { return std::floor(a[lane]); });
}

template <typename Real>
Lanes<Real> min(Lanes<Real> a, Lanes<Real> b) {
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 8) {
        return EACH(Lanes<Real>, _mm512_maskz_min_pd(0xFF, a.value[i], b.value[i]));
    } else if constexpr (sizeof(Real) == 4) {
        return EACH(Lanes<Real>, _mm512_maskz_min_ps(0xFFFF, a.value[i], b.value[i]));
    } else
#endif
    return select(a < b, a, b);
}

template <typename Real>
Lanes<Real> max(Lanes<Real> a, Lanes<Real> b) {
#if defined(__AVX512F__)
    if constexpr (sizeof(Real) == 8) {
        return EACH(Lanes<Real>, _mm512_maskz_max_pd(0xFF, a.value[i], b.value[i]));
    } else if constexpr (sizeof(Real) == 4) {
        return EACH(Lanes<Real>, _mm512_maskz_max_ps(0xFFFF, a.value[i], b.value[i]));
    } else
#endif
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

// ---- Between lanes and memory -------------------------------------------------------------------------------------

// Fills lanes of any kind from memory, where they lie one after the other.
template <typename Real, template <typename> typename Values>
void load(const void* from, Values<Real>& lanes) {
    std::memcpy(&lanes, from, sizeof(lanes));
}

template <typename Real>
void load(const void* from, Mask<Real>& lanes) {
    Indices<Real> truths;
    load(from, truths);
    lanes = truths < Indices<Real>(0);
}

// Writes the lanes that the mask names, one after the other, and overwrites as much memory as all of them would.
template <typename Real, template <typename> typename Values>
[[gnu::always_inline]] inline void pack(Mask<Real> named, const Values<Real>& lanes, void* to) {
    using Element = std::conditional_t<std::is_same_v<Values<Real>, Lanes<Real>>, Real, typename Register<Real>::Integer>;
    auto* next = static_cast<Element*>(to);
    for (int i = 0; i < registers<Real>; ++i) {
        const unsigned bits = Mask<Real>::bits_of(named.value[i]);
#if defined(__AVX512F__)
        if constexpr (sizeof(Real) == 8) {
            _mm512_storeu_si512(next, _mm512_maskz_compress_epi64(named.value[i], (__m512i)lanes.value[i]));
        } else if constexpr (sizeof(Real) == 4) {
            _mm512_storeu_si512(next, _mm512_maskz_compress_epi32(named.value[i], (__m512i)lanes.value[i]));
        } else
#endif
        if (lane_count<Real> == 1 || bits == (1U << Register<Real>::lanes) - 1U) {
            std::memcpy(next, &lanes.value[i], sizeof(lanes.value[i]));
        } else if constexpr (lane_count<Real> > 1) {
            auto* one = next;
            for (unsigned left = bits; left != 0; left &= left - 1) {
                *one++ = lanes.value[i][std::countr_zero(left)];
            }
        }
        next += std::popcount(bits);
    }
}

template <typename Real>
void pack(Mask<Real> named, Mask<Real> lanes, void* to) {
    pack(named, select(lanes, Indices<Real>(-1), Indices<Real>(0)), to);
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
