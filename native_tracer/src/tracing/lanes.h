// Lanes<Real>: a few registers full of real numbers, computed with as if they were one.
//
// Rays are traced in small groups, one ray to a lane. Lane i of a result depends on lane i of the operands alone, and
// every operation is the one IEEE 754 defines, so that a picture's bytes do not depend on how many lanes there are.

#pragma once

#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "tracing/isa.h"
#include "tracing/register.h"

namespace whitted::WHITTED_ISA {

// Two registers, so that the processor has something to do while a square root or a quotient is not ready.
template <typename Real>
inline constexpr int register_count = std::is_same_v<Real, long double> ? 1 : 2;

template <typename Real>
inline constexpr int lane_count = register_count<Real> * Register<Real>::lanes;

// The operation on each register of the operands.
template <typename Result, typename Operation, typename... Operands>
[[gnu::always_inline]] inline Result each(Operation operation, const Operands&... operands) {
    Result result;
    result.value[0] = operation(operands.value[0]...);
    if constexpr (sizeof(result.value) > sizeof(result.value[0])) {
        result.value[1] = operation(operands.value[1]...);
    }
    return result;
}

// ---- Truth values, integers and real numbers ----------------------------------------------------------------------

template <typename Real>
struct Mask {
    using R = Register<Real>;
    using Truths = typename R::Truths;
    Truths value[register_count<Real>];

    static Mask none() {
        return each<Mask>([] { return Truths{}; });
    }
    friend Mask operator&(Mask a, Mask b) {
        return each<Mask>([](Truths x, Truths y) { return static_cast<Truths>(x & y); }, a, b);
    }
    friend Mask operator|(Mask a, Mask b) {
        return each<Mask>([](Truths x, Truths y) { return static_cast<Truths>(x | y); }, a, b);
    }
    friend Mask operator^(Mask a, Mask b) {
        return each<Mask>([](Truths x, Truths y) { return static_cast<Truths>(x ^ y); }, a, b);
    }
    friend Mask operator~(Mask a) {
        return each<Mask>([](Truths x) { return R::negation(x); }, a);
    }
    Mask& operator|=(Mask other) { return *this = *this | other; }
    Mask& operator&=(Mask other) { return *this = *this & other; }

    bool operator[](int lane) const { return (bits() >> lane & 1U) != 0; }

    // Bit i is lane i.
    unsigned bits() const {
        unsigned result = R::bits(value[0]);
        for (int i = 1; i < register_count<Real>; ++i) {
            result |= R::bits(value[i]) << (i * R::lanes);
        }
        return result;
    }

    // The first `count` lanes, or one of them.
    static Mask first(int count);
    static Mask only(int lane);

    // Lane i is value_of(i).
    template <typename ValueOf>
    static Mask gather(ValueOf value_of);
};

template <typename Real>
bool any(Mask<Real> mask) {
    auto some = mask.value[0];
    for (int i = 1; i < register_count<Real>; ++i) {
        some |= mask.value[i];
    }
    return Register<Real>::bits(some) != 0;
}

template <typename Real>
bool all(Mask<Real> mask) {
    return !any(~mask);
}

template <typename Real>
int count(Mask<Real> mask) {
    return std::popcount(mask.bits());
}

template <typename Real>
struct Indices {
    using R = Register<Real>;
    using Integer = typename R::Integer;
    using Integers = typename R::Integers;
    Integers value[register_count<Real>];

    Indices() = default;
    Indices(Integer same) : Indices(each<Indices>([same] { return Integers{} + same; })) {}

    int operator[](int lane) const {
        if constexpr (lane_count<Real> == 1) {
            return static_cast<int>(value[0]);
        } else {
            return static_cast<int>(value[lane / R::lanes][lane % R::lanes]);
        }
    }
    friend Indices operator+(Indices a, Indices b) {
        return each<Indices>([](Integers x, Integers y) { return x + y; }, a, b);
    }
    friend Mask<Real> operator==(Indices a, Indices b) {
        return each<Mask<Real>>([](Integers x, Integers y) { return R::equal(x, y); }, a, b);
    }
    friend Mask<Real> operator<(Indices a, Indices b) {
        return each<Mask<Real>>([](Integers x, Integers y) { return R::less(x, y); }, a, b);
    }
    friend Mask<Real> operator>=(Indices a, Indices b) { return ~(a < b); }

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
Mask<Real> Mask<Real>::only(int lane) {
    return Indices<Real>::numbers() == Indices<Real>(lane);
}

template <typename Real>
template <typename ValueOf>
Mask<Real> Mask<Real>::gather(ValueOf value_of) {
    return Indices<Real>::gather([&](int lane) { return value_of(lane) ? -1 : 0; }) < Indices<Real>(0);
}

template <typename Real>
struct Lanes {
    using R = Register<Real>;
    using Reals = typename R::Reals;
    Reals value[register_count<Real>];

    Lanes() = default;
    // x - 0 is x, whatever its sign.
    Lanes(Real same) : Lanes(each<Lanes>([same] { return same - Reals{}; })) {}

    Real operator[](int lane) const {
        if constexpr (lane_count<Real> == 1) {
            return value[0];
        } else {
            return value[lane / R::lanes][lane % R::lanes];
        }
    }

    friend Lanes operator+(Lanes a, Lanes b) {
        return each<Lanes>([](Reals x, Reals y) { return x + y; }, a, b);
    }
    friend Lanes operator-(Lanes a, Lanes b) {
        return each<Lanes>([](Reals x, Reals y) { return x - y; }, a, b);
    }
    friend Lanes operator*(Lanes a, Lanes b) {
        return each<Lanes>([](Reals x, Reals y) { return x * y; }, a, b);
    }
    friend Lanes operator/(Lanes a, Lanes b) {
        return each<Lanes>([](Reals x, Reals y) { return x / y; }, a, b);
    }
    friend Lanes operator-(Lanes a) {
        return each<Lanes>([](Reals x) { return -x; }, a);
    }
    friend Mask<Real> operator!=(Lanes a, Lanes b) {
        return each<Mask<Real>>([](Reals x, Reals y) { return R::not_equal(x, y); }, a, b);
    }
    friend Mask<Real> operator<(Lanes a, Lanes b) {
        return each<Mask<Real>>([](Reals x, Reals y) { return R::less(x, y); }, a, b);
    }
    friend Mask<Real> operator<=(Lanes a, Lanes b) {
        return each<Mask<Real>>([](Reals x, Reals y) { return R::less_equal(x, y); }, a, b);
    }
    friend Mask<Real> operator>(Lanes a, Lanes b) { return b < a; }
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

    // 0, 1, 2 and so on.
    static Lanes numbers() {
        return gather([](int lane) { return static_cast<Real>(lane); });
    }
};

// ---- Choosing by a mask, and functions of lanes -------------------------------------------------------------------

// Lane by lane: `a` where the mask is true, else `b`.
template <typename Real>
Lanes<Real> select(Mask<Real> mask, Lanes<Real> a, Lanes<Real> b) {
    using R = Register<Real>;
    return each<Lanes<Real>>(
        [](typename R::Truths m, typename R::Reals x, typename R::Reals y) { return R::select(m, x, y); }, mask, a, b);
}

template <typename Real>
Indices<Real> select(Mask<Real> mask, Indices<Real> a, Indices<Real> b) {
    using R = Register<Real>;
    return each<Indices<Real>>(
        [](typename R::Truths m, typename R::Integers x, typename R::Integers y) { return R::select(m, x, y); }, mask,
        a, b);
}

template <typename Real>
Mask<Real> select(Mask<Real> mask, Mask<Real> a, Mask<Real> b) {
    return (mask & a) | (~mask & b);
}

template <typename Real>
Lanes<Real> sqrt(Lanes<Real> a) {
    return each<Lanes<Real>>([](auto x) { return Register<Real>::sqrt(x); }, a);
}

template <typename Real>
Lanes<Real> floor(Lanes<Real> a) {
    return each<Lanes<Real>>([](auto x) { return Register<Real>::floor(x); }, a);
}

// `b` where one is NaN.
template <typename Real>
Lanes<Real> min(Lanes<Real> a, Lanes<Real> b) {
    return each<Lanes<Real>>([](auto x, auto y) { return Register<Real>::min(x, y); }, a, b);
}

template <typename Real>
Lanes<Real> max(Lanes<Real> a, Lanes<Real> b) {
    return each<Lanes<Real>>([](auto x, auto y) { return Register<Real>::max(x, y); }, a, b);
}

template <typename Real>
Lanes<Real> abs(Lanes<Real> a) {
    return each<Lanes<Real>>([](auto x) { return Register<Real>::abs(x); }, a);
}

// The smallest of all lanes.
template <typename Real>
Real least(Lanes<Real> a) {
    Real result = a[0];
    for (int lane = 1; lane < lane_count<Real>; ++lane) {
        result = a[lane] < result ? a[lane] : result;
    }
    return result;
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

// Fills lanes of any kind with what lies in memory one after the other.
template <typename Lanes>
void load(const void* from, Lanes& lanes) {
    std::memcpy(&lanes, from, sizeof(lanes));
}

template <typename Real>
void load(const void* from, Mask<Real>& lanes) {
    Indices<Real> truths;
    load(from, truths);
    lanes = truths < Indices<Real>(0);
}

// Writes the lanes that the mask names, one after the other. What all of them would need may be overwritten.
template <typename Real, typename Lanes>
void pack(Mask<Real> named, const Lanes& lanes, void* to) {
    auto* next = static_cast<char*>(to);
    for (int i = 0; i < register_count<Real>; ++i) {
        Register<Real>::pack(named.value[i], lanes.value[i], next);
        const auto size = static_cast<int>(sizeof(lanes.value[i])) / static_cast<int>(Register<Real>::lanes);
        next += size * std::popcount(Register<Real>::bits(named.value[i]));
    }
}

template <typename Real>
void pack(Mask<Real> named, const Mask<Real>& lanes, void* to) {
    pack(named, select(lanes, Indices<Real>(-1), Indices<Real>(0)), to);
}

// ---- By value -----------------------------------------------------------------------------------------------------

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
