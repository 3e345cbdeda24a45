// Intervals of doubles: both ends at once in a pair, upward.

#pragma once

#include <cmath>

#include "interval.h"

#define INLINE [[gnu::always_inline]] inline

namespace certified {

template <>
class Interval<double> {
 public:
    INLINE Interval() : ends_{0, 0} {}
    INLINE Interval(int x) : ends_{static_cast<double>(-x), static_cast<double>(x)} {}
    INLINE explicit Interval(double x) : ends_{-x, x} {}

    INLINE static Interval between(double low, double high) { return Ends{-low, high}; }

    INLINE double high() const { return ends_[1]; }
    INLINE double low() const { return -ends_[0]; }

    INLINE bool positive() const { return ends_[0] < 0; }
    INLINE bool negative() const { return ends_[1] < 0; }
    INLINE bool is_zero() const { return ends_[0] == 0 && ends_[1] == 0; }

    INLINE double low_double() const { return low(); }
    INLINE double high_double() const { return high(); }
    INLINE double middle() const { return (low() + high()) / 2; }

    INLINE friend Interval operator-(const Interval& x) { return swapped(x.ends_); }
    INLINE friend Interval operator+(const Interval& x, const Interval& y) { return x.ends_ + y.ends_; }
    INLINE friend Interval operator-(const Interval& x, const Interval& y) { return x.ends_ + swapped(y.ends_); }

    // All ends' products and those of their negatives.
    INLINE friend Interval operator*(const Interval& x, const Interval& y) {
        const Ends low = {-x.ends_[0], x.ends_[0]}, high = {x.ends_[1], -x.ends_[1]};
        const Ends minus_low = {y.ends_[0], y.ends_[0]}, minus_high = {-y.ends_[1], -y.ends_[1]};
        return larger(larger(low * minus_low, low * minus_high), larger(high * minus_low, high * minus_high));
    }

    // Throws Undecided where the divisor may be 0.
    INLINE friend Interval operator/(const Interval& x, const Interval& y) {
        if (!y.positive()) {
            return by_other(x, y);
        }
        const double low = y.low(), high = y.high();
        return x.ends_ / (x.ends_ > Ends{} ? Ends{low, low} : Ends{high, high});
    }

    // Of what is not negative, as far as it is not.
    INLINE friend Interval sqrt(const Interval& x) {
        const double high = std::sqrt(x.high() > 0 ? x.high() : 0);
        if (!x.positive()) {
            return Ends{0, high};
        }
        // x / root is below the true root, and no more than root is above.
        return Ends{x.ends_[0] / std::sqrt(-x.ends_[0]), high};
    }

    INLINE friend Interval square(const Interval& x) {
        const Ends low = {-x.ends_[0], x.ends_[0]}, high = {-x.ends_[1], x.ends_[1]};
        const Ends lows = low * x.ends_[0], highs = high * x.ends_[1];  // minus a square, and a square
        if (x.positive()) {
            return Ends{lows[0], highs[1]};
        }
        if (x.negative()) {
            return Ends{highs[0], lows[1]};
        }
        return Ends{0, lows[1] > highs[1] ? lows[1] : highs[1]};
    }

    INLINE friend Interval min(const Interval& x, const Interval& y) {
        return Ends{larger(x.ends_, y.ends_)[0], smaller(x.ends_, y.ends_)[1]};
    }

    INLINE friend Interval max(const Interval& x, const Interval& y) {
        return Ends{smaller(x.ends_, y.ends_)[0], larger(x.ends_, y.ends_)[1]};
    }

    INLINE friend Interval hull(const Interval& x, const Interval& y) { return larger(x.ends_, y.ends_); }

    INLINE Interval& operator+=(const Interval& x) { return *this = *this + x; }

 private:
    using Ends = double __attribute__((vector_size(16)));

    INLINE Interval(const Ends& ends) : ends_(ends) {}

    [[gnu::noinline]] static Interval by_other(const Interval& x, const Interval& y) {
        if (y.negative()) {
            return -x / -y;
        }
        throw Undecided{Reason::division};
    }

    INLINE static Ends swapped(const Ends& ends) { return Ends{ends[1], ends[0]}; }
    INLINE static Ends larger(const Ends& a, const Ends& b) { return a < b ? b : a; }
    INLINE static Ends smaller(const Ends& a, const Ends& b) { return b < a ? b : a; }

    Ends ends_;  // minus the lower, and the upper
};

// Throws Undecided of what is not finite.
template <typename End>
Interval<End> widened(const Interval<double>& x) {
    if (!std::isfinite(x.low()) || !std::isfinite(x.high())) {
        throw Undecided{Reason::range};
    }
    return Interval<End>::between(End(x.low()), End(x.high()));
}

}  // namespace certified

#undef INLINE
