// Register<Real>: one register full of real numbers, or of integers, and what the processor does with all of them in
// one instruction that the operators of the language do not say. lanes.h computes with it.
//
// The registers are the vector types of GCC and Clang, which know + - * / and, without AVX-512, comparisons and ?: too.

#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "tracing/isa.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Register;

// ---- AVX-512: truth values have registers of their own --------------------------------------------------------------

#if defined(__AVX512F__)

template <>
struct Register<double> {
    static constexpr int lanes = 8;
    using Integer = std::int64_t;
    typedef double Reals __attribute__((vector_size(64)));
    typedef Integer Integers __attribute__((vector_size(64)));
    using Truths = __mmask8;  // bit i is lane i

    static Truths less(Reals a, Reals b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
    static Truths less_equal(Reals a, Reals b) { return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ); }
    static Truths not_equal(Reals a, Reals b) { return _mm512_cmp_pd_mask(a, b, _CMP_NEQ_UQ); }
    static Truths less(Integers a, Integers b) { return _mm512_cmplt_epi64_mask((__m512i)a, (__m512i)b); }
    static Truths equal(Integers a, Integers b) { return _mm512_cmpeq_epi64_mask((__m512i)a, (__m512i)b); }
    static Truths negation(Truths a) { return static_cast<Truths>(~a); }
    static unsigned bits(Truths a) { return a; }

    static Reals select(Truths mask, Reals a, Reals b) { return _mm512_mask_blend_pd(mask, b, a); }
    static Integers select(Truths mask, Integers a, Integers b) {
        return (Integers)_mm512_mask_blend_epi64(mask, (__m512i)b, (__m512i)a);
    }
    static Reals min(Reals a, Reals b) { return _mm512_maskz_min_pd(0xFF, a, b); }
    static Reals max(Reals a, Reals b) { return _mm512_maskz_max_pd(0xFF, a, b); }
    static Reals abs(Reals a) { return (Reals)((Integers)a & INT64_MAX); }
    static Reals sqrt(Reals a) { return _mm512_maskz_sqrt_pd(0xFF, a); }
    static Reals floor(Reals a) { return _mm512_maskz_roundscale_pd(0xFF, a, _MM_FROUND_FLOOR); }

    template <typename Values>
    static void pack(Truths mask, Values values, void* to) {
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi64(mask, (__m512i)values));
    }
};

template <>
struct Register<float> {
    static constexpr int lanes = 16;
    using Integer = std::int32_t;
    typedef float Reals __attribute__((vector_size(64)));
    typedef Integer Integers __attribute__((vector_size(64)));
    using Truths = __mmask16;  // bit i is lane i

    static Truths less(Reals a, Reals b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
    static Truths less_equal(Reals a, Reals b) { return _mm512_cmp_ps_mask(a, b, _CMP_LE_OQ); }
    static Truths not_equal(Reals a, Reals b) { return _mm512_cmp_ps_mask(a, b, _CMP_NEQ_UQ); }
    static Truths less(Integers a, Integers b) { return _mm512_cmplt_epi32_mask((__m512i)a, (__m512i)b); }
    static Truths equal(Integers a, Integers b) { return _mm512_cmpeq_epi32_mask((__m512i)a, (__m512i)b); }
    static Truths negation(Truths a) { return static_cast<Truths>(~a); }
    static unsigned bits(Truths a) { return a; }

    static Reals select(Truths mask, Reals a, Reals b) { return _mm512_mask_blend_ps(mask, b, a); }
    static Integers select(Truths mask, Integers a, Integers b) {
        return (Integers)_mm512_mask_blend_epi32(mask, (__m512i)b, (__m512i)a);
    }
    static Reals min(Reals a, Reals b) { return _mm512_maskz_min_ps(0xFFFF, a, b); }
    static Reals max(Reals a, Reals b) { return _mm512_maskz_max_ps(0xFFFF, a, b); }
    static Reals abs(Reals a) { return (Reals)((Integers)a & INT32_MAX); }
    static Reals multiply_subtract(Reals a, Reals b, Reals c) { return _mm512_fmsub_ps(a, b, c); }
    static Reals of_bytes(const unsigned char* from) {
        const __m512i bytes =
            _mm512_maskz_cvtepu8_epi32(0xFFFF, _mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
        return _mm512_maskz_cvtepi32_ps(0xFFFF, bytes);
    }
    static Reals sqrt(Reals a) { return _mm512_maskz_sqrt_ps(0xFFFF, a); }
    static Reals floor(Reals a) { return _mm512_maskz_roundscale_ps(0xFFFF, a, _MM_FROUND_FLOOR); }

    template <typename Values>
    static void pack(Truths mask, Values values, void* to) {
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(mask, (__m512i)values));
    }
};

#else

// ---- AVX2, SSE2 and other processors --------------------------------------------------------------------------------

#if defined(__AVX2__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif

template <typename Real>
struct Vectors;

template <>
struct Vectors<double> {
    using Integer = std::int64_t;
    typedef double Reals __attribute__((vector_size(register_bytes)));
    typedef Integer Integers __attribute__((vector_size(register_bytes)));
};

template <>
struct Vectors<float> {
    using Integer = std::int32_t;
    typedef float Reals __attribute__((vector_size(register_bytes)));
    typedef Integer Integers __attribute__((vector_size(register_bytes)));
};

template <typename Real>
struct Register : Vectors<Real> {
    using typename Vectors<Real>::Integer;
    using typename Vectors<Real>::Integers;
    using typename Vectors<Real>::Reals;
    using Truths = Integers;  // 0 or -1
    static constexpr int lanes = register_bytes / static_cast<int>(sizeof(Real));

    static Truths less(auto a, auto b) { return a < b; }
    static Truths less_equal(Reals a, Reals b) { return a <= b; }
    static Truths not_equal(Reals a, Reals b) { return a != b; }
    static Truths equal(Integers a, Integers b) { return a == b; }
    static Truths negation(Truths a) { return ~a; }
    static unsigned bits(Truths a) {
#if defined(__AVX2__)
        if constexpr (sizeof(Real) == 8) {
            return static_cast<unsigned>(_mm256_movemask_pd((__m256d)a));
        } else {
            return static_cast<unsigned>(_mm256_movemask_ps((__m256)a));
        }
#elif defined(__SSE2__)
        if constexpr (sizeof(Real) == 8) {
            return static_cast<unsigned>(_mm_movemask_pd((__m128d)a));
        } else {
            return static_cast<unsigned>(_mm_movemask_ps((__m128)a));
        }
#else
        unsigned result = 0;
        for (int lane = 0; lane < lanes; ++lane) {
            result |= (a[lane] != 0 ? 1U : 0U) << lane;
        }
        return result;
#endif
    }

    template <typename Values>
    static Values select(Truths mask, Values a, Values b) {
        return mask ? a : b;
    }
    static Reals min(Reals a, Reals b) { return a < b ? a : b; }
    static Reals max(Reals a, Reals b) { return a > b ? a : b; }
    static Reals abs(Reals a) { return (Reals)((Integers)a & std::numeric_limits<Integer>::max()); }
    static Reals multiply_subtract(Reals a, Reals b, Reals c) {
#if defined(__FMA__)
        if constexpr (sizeof(Real) == 4) {
            return _mm256_fmsub_ps(a, b, c);
        }
#endif
        return a * b - c;
    }
    // Of single precision.
    static Reals of_bytes(const unsigned char* from) {
#if defined(__AVX2__)
        return _mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from))));
#else
        Reals result;
        for (int lane = 0; lane < lanes; ++lane) {
            result[lane] = static_cast<Real>(from[lane]);
        }
        return result;
#endif
    }
    static Reals sqrt(Reals a) {
#if defined(__AVX2__)
        if constexpr (sizeof(Real) == 8) {
            return _mm256_sqrt_pd(a);
        } else {
            return _mm256_sqrt_ps(a);
        }
#elif defined(__SSE2__)
        if constexpr (sizeof(Real) == 8) {
            return _mm_sqrt_pd(a);
        } else {
            return _mm_sqrt_ps(a);
        }
#else
        for (int lane = 0; lane < lanes; ++lane) {
            a[lane] = std::sqrt(a[lane]);
        }
        return a;
#endif
    }
    static Reals floor(Reals a) {
#if defined(__AVX2__)
        if constexpr (sizeof(Real) == 8) {
            return _mm256_floor_pd(a);
        } else {
            return _mm256_floor_ps(a);
        }
#else
        for (int lane = 0; lane < lanes; ++lane) {
            a[lane] = std::floor(a[lane]);
        }
        return a;
#endif
    }

    // Writes the values in the lanes that the mask names, one after the other, and may overwrite a whole register.
    template <typename Values>
    static void pack(Truths mask, Values values, void* to) {
        const unsigned named = bits(mask);
        if (named == (1U << lanes) - 1U) {
            std::memcpy(to, &values, sizeof(values));
            return;
        }
        auto* next = static_cast<char*>(to);
        for (unsigned left = named; left != 0; left &= left - 1) {
            const auto value = values[std::countr_zero(left)];
            std::memcpy(next, &value, sizeof(value));
            next += sizeof(value);
        }
    }
};

#endif

// ---- long double, which no register holds twice ---------------------------------------------------------------------

template <>
struct Register<long double> {
    static constexpr int lanes = 1;
    using Integer = std::int64_t;
    using Reals = long double;
    using Integers = Integer;
    using Truths = bool;

    static Truths less(auto a, auto b) { return a < b; }
    static Truths less_equal(Reals a, Reals b) { return a <= b; }
    static Truths not_equal(Reals a, Reals b) { return a != b; }
    static Truths equal(Integers a, Integers b) { return a == b; }
    static Truths negation(Truths a) { return !a; }
    static unsigned bits(Truths a) { return a ? 1U : 0U; }

    template <typename Value>
    static Value select(Truths mask, Value a, Value b) {
        return mask ? a : b;
    }
    static Reals min(Reals a, Reals b) { return a < b ? a : b; }
    static Reals max(Reals a, Reals b) { return a > b ? a : b; }
    static Reals abs(Reals a) { return std::abs(a); }
    static Reals multiply_subtract(Reals a, Reals b, Reals c) { return a * b - c; }
    static Reals of_bytes(const unsigned char* from) { return *from; }
    static Reals sqrt(Reals a) { return std::sqrt(a); }
    static Reals floor(Reals a) { return std::floor(a); }

    template <typename Value>
    static void pack(Truths, Value value, void* to) {
        std::memcpy(to, &value, sizeof(value));
    }
};

}  // namespace whitted::WHITTED_ISA
