// Enclosures of what is no sum, product, quotient or root: series whose remainders are bounded.
//
// No function of the C library is called: nothing is proven of those.

#pragma once

#include <cmath>
#include <cstdlib>
#include <limits>

#include "double_interval.h"

namespace certified {

// Digits that an interval's ends have.
template <typename End>
struct Digits {
    static constexpr int value = std::numeric_limits<End>::digits;
};

template <std::size_t limbs>
struct Digits<Wide<limbs>> {
    static constexpr int value = Wide<limbs>::bits;
};

template <typename End>
Interval<End> up_to(const Interval<End>& size) {
    return hull(-size, size);
}

// Whether terms have become smaller than what the type can tell.
template <typename End>
bool is_tiny(const Interval<End>& size) {
    return size.high_double() < std::ldexp(1.0, -Digits<End>::value - 8);
}

// arctan(1/n) for n > 1, or artanh(1/n) where all terms have one sign: the rest of either is below the first term that
// is left out, times n^2 / (n^2 - 1) <= 2.
template <typename End>
Interval<End> inverse_tangent(int n, bool hyperbolic) {
    using I = Interval<End>;
    I power = I(1) / I(n), sum = power;
    for (int k = 1;; ++k) {
        power = power / I(n * n);
        const I term = power / I(2 * k + 1);
        if (is_tiny(term)) {
            return sum + up_to(I(2) * term);
        }
        sum = hyperbolic || k % 2 == 0 ? sum + term : sum - term;
    }
}

// Machin's formula.
template <typename End>
Interval<End> pi() {
    using I = Interval<End>;
    return I(16) * inverse_tangent<End>(5, false) - I(4) * inverse_tangent<End>(239, false);
}

// Of half an angle in degrees, between 0 and 180: the series of sine and cosine at 1/1024 of it, whose terms alternate
// and fall, so that the rest is below the first that is left out; then ten times the double angle.
template <typename End>
Interval<End> tangent_of_half(const Interval<End>& degrees) {
    using I = Interval<End>;
    const I x = degrees * pi<End>() / I(360 * 1024);
    I sine = x, cosine = 1, term = x;
    for (int k = 2;; ++k) {
        term = term * x / I(k);
        if (is_tiny(term)) {
            sine += up_to(term);
            cosine += up_to(term);
            break;
        }
        I& sum = k % 2 == 0 ? cosine : sine;
        sum = k / 2 % 2 == 0 ? sum + term : sum - term;
    }
    for (int doubled = 0; doubled < 10; ++doubled) {
        const I next = square(cosine) - square(sine);
        sine = I(2) * sine * cosine;
        cosine = next;
    }
    return sine / cosine;
}

// 2 artanh((x - 1) / (x + 1)), x brought near 1 by a power of two. Of what is positive.
template <typename End>
Interval<End> log(const Interval<End>& x) {
    using I = Interval<End>;
    int power = 0;
    const double fraction = std::frexp(x.high_double(), &power);
    if (fraction < 0.7) {
        --power;
    }
    const I near = x * I(std::ldexp(1.0, -power));
    const I z = (near - I(1)) / (near + I(1));
    const I z2 = square(z);
    I term = z, sum = z;
    for (int k = 1;; ++k) {
        term = term * z2;
        const I size = max(term, -term);
        if (is_tiny(size)) {
            // All further terms, which fall by z^2 < 1/2 at least.
            sum += up_to(I(2) * size);
            break;
        }
        sum += term / I(2 * k + 1);
        if (z2.high_double() > 0.5) {
            throw Undecided{Reason::byte};  // an interval that is so wide says nothing
        }
    }
    return I(2) * (sum + I(power) * inverse_tangent<End>(3, true));
}

// Of what is not above 0, as far as it is not: Taylor's series at 2^-8 of what is left beside powers of two, squared.
template <typename End>
Interval<End> exp(const Interval<End>& x) {
    using I = Interval<End>;
    constexpr double least = -600;
    if (x.low_double() < least) {
        const I low = I::between(End(0), End(std::ldexp(1.0, -800)));
        return x.high_double() < least ? low : hull(low, exp(I::between(x.high(), x.high())));
    }
    if (x.high_double() - x.low_double() > 0.25) {
        return hull(exp(I::between(x.low(), x.low())), exp(I::between(x.high(), x.high())));
    }
    const int power = static_cast<int>(x.middle() / 0.6931471805599453);
    const I rest = (x - I(2 * power) * inverse_tangent<End>(3, true)) * I(1.0 / 256);  // below 1/2
    I term = 1, sum = 1;
    for (int k = 1;; ++k) {
        term = term * rest / I(k);
        const I size = max(term, -term);
        if (is_tiny(size)) {
            sum += up_to(I(2) * size);
            break;
        }
        sum += term;
    }
    for (int squared = 0; squared < 8; ++squared) {
        sum = square(sum);
    }
    return sum * I(std::ldexp(1.0, power));
}

// A number's power, for numbers from 0 to 1 and exponents that are not negative.
template <typename End>
Interval<End> power(const Interval<End>& base, const Interval<End>& exponent) {
    using I = Interval<End>;
    const double size = exponent.high_double();
    if (exponent.low_double() == size && size < 1e6 && size == static_cast<int>(size)) {
        I result = 1, squared = base;
        for (unsigned left = static_cast<unsigned>(size); left != 0; left >>= 1) {
            if (left & 1) {
                result = result * squared;
            }
            squared = square(squared);
        }
        return result;
    }
    const auto of = [&](const End& x) { return exp(exponent * log(I::between(x, x))); };
    const I high = base.high() > End(0) ? of(base.high()) : I(0);
    return hull(base.low() > End(0) ? of(base.low()) : I(0), high);
}

}  // namespace certified
