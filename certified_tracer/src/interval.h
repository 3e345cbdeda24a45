// Intervals that enclose what a computation without rounding would give (Moore 1966).
//
// An end is a number of a type whose operations never round downward: a double while the processor rounds upward, or a
// `Wide`. The lower end is kept as its negative, so that upward is outward for both (Lambov, Interval Arithmetic Using
// SSE-2, 2008).

#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "undecided.h"
#include "wide.h"

namespace certified {

template <typename End>
class Interval {
 public:
    Interval() = default;
    Interval(int x) : minus_low_(-x), high_(x) {}
    explicit Interval(double x) : minus_low_(-x), high_(x) {}

    static Interval between(const End& low, const End& high) { return from_ends(-low, high); }

    const End& high() const { return high_; }
    End low() const { return -minus_low_; }

    bool positive() const { return minus_low_ < End(0); }
    bool negative() const { return high_ < End(0); }
    bool is_zero() const { return high_ == End(0) && minus_low_ == End(0); }

    // Outward.
    double low_double() const { return -upper_double(minus_low_); }
    double high_double() const { return upper_double(high_); }
    double middle() const { return (low_double() + high_double()) / 2; }

    friend Interval operator-(const Interval& x) { return from_ends(x.high_, x.minus_low_); }

    friend Interval operator+(const Interval& x, const Interval& y) {
        return from_ends(x.minus_low_ + y.minus_low_, x.high_ + y.high_);
    }

    friend Interval operator-(const Interval& x, const Interval& y) {
        return from_ends(x.minus_low_ + y.high_, x.high_ + y.minus_low_);
    }

    friend Interval operator*(const Interval& x, const Interval& y) {
        const End &xn = x.minus_low_, &xh = x.high_, &yn = y.minus_low_, &yh = y.high_;
        if (!(xn > End(0))) {  // x >= 0
            if (!(yn > End(0))) {
                return from_ends((-xn) * yn, xh * yh);
            }
            return from_ends(xh * yn, !(yh < End(0)) ? xh * yh : (-xn) * yh);
        }
        if (!(xh > End(0))) {  // x <= 0
            return -(-x * y);
        }
        if (!(yn > End(0)) || !(yh > End(0))) {
            return y * x;
        }
        return from_ends(larger(xn * yh, xh * yn), larger(xn * yn, xh * yh));
    }

    // Throws Undecided where the divisor may be 0.
    friend Interval operator/(const Interval& x, const Interval& y) {
        if (!y.positive()) {
            if (y.negative()) {
                return -x / -y;
            }
            throw Undecided{Reason::division};
        }
        const End low = -y.minus_low_;
        return from_ends(x.minus_low_ / (x.minus_low_ > End(0) ? low : y.high_),
                         x.high_ / (x.high_ > End(0) ? low : y.high_));
    }

    // Of what is not negative, as far as it is not.
    friend Interval sqrt(const Interval& x) {
        using std::sqrt;
        const End high = sqrt(larger(x.high_, End(0)));
        if (!x.positive()) {
            return from_ends(End(0), high);
        }
        const End root = sqrt(-x.minus_low_);
        return from_ends(x.minus_low_ / root, high);  // x / root is below the true root, and no more than root is above
    }

    friend Interval square(const Interval& x) {
        if (x.positive()) {
            return from_ends(x.minus_low_ * -x.minus_low_, x.high_ * x.high_);
        }
        if (x.negative()) {
            return square(-x);
        }
        const End size = larger(x.minus_low_, x.high_);
        return from_ends(End(0), size * size);
    }

    friend Interval min(const Interval& x, const Interval& y) {
        return from_ends(larger(x.minus_low_, y.minus_low_), smaller(x.high_, y.high_));
    }

    friend Interval max(const Interval& x, const Interval& y) {
        return from_ends(smaller(x.minus_low_, y.minus_low_), larger(x.high_, y.high_));
    }

    friend Interval hull(const Interval& x, const Interval& y) {
        return from_ends(larger(x.minus_low_, y.minus_low_), larger(x.high_, y.high_));
    }

    Interval& operator+=(const Interval& x) { return *this = *this + x; }

 private:
    static Interval from_ends(const End& minus_low, const End& high) {
        Interval result;
        result.minus_low_ = minus_low;
        result.high_ = high;
        return result;
    }

    static const End& larger(const End& a, const End& b) { return a < b ? b : a; }
    static const End& smaller(const End& a, const End& b) { return b < a ? b : a; }

    End minus_low_ = 0, high_ = 0;
};

template <>
class Interval<double>;  // double_interval.h

}  // namespace certified
