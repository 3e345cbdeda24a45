// Floating-point numbers of many digits, of whole-number arithmetic alone: the same on every machine.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace certified {

// sign * 0.m * 2^exponent, with m of 64 * limbs bits and the first of these set. Every operation's result is at least
// the true one, and above it by 2^-(64 * limbs - 9) of itself at most. The exponent has room for all that a picture
// comes to.
template <std::size_t limbs>
class Wide {
 public:
    static constexpr int bits = 64 * static_cast<int>(limbs);

    constexpr Wide() = default;

    Wide(double x) {  // exactly
        if (x == 0) {
            return;
        }
        int power = 0;
        const double fraction = std::frexp(std::fabs(x), &power);
        sign_ = x < 0 ? -1 : 1;
        exponent_ = power;
        mantissa_[limbs - 1] = static_cast<std::uint64_t>(static_cast<std::int64_t>(fraction * 0x1p53)) << 11;
    }

    Wide(int x) : Wide(static_cast<double>(x)) {}

    // Not below it.
    double to_double() const {
        if (sign_ == 0) {
            return 0;
        }
        std::uint64_t top = mantissa_[limbs - 1] >> 11;
        const bool exact =
            (mantissa_[limbs - 1] & 0x7ff) == 0 &&
            std::all_of(mantissa_.begin(), mantissa_.end() - 1, [](std::uint64_t limb) { return limb == 0; });
        if (!exact && sign_ > 0) {
            ++top;
        }
        const std::int64_t power = exponent_ - 53;
        if (power > 900) {
            return sign_ > 0 ? HUGE_VAL : -0x1p900;
        }
        if (power < -1000) {
            return sign_ > 0 ? 0x1p-900 : 0;
        }
        return sign_ * std::ldexp(static_cast<double>(top), static_cast<int>(power));
    }

    int sign() const { return sign_; }

    friend Wide operator-(Wide x) {
        x.sign_ = -x.sign_;
        return x;
    }

    friend bool operator<(const Wide& x, const Wide& y) { return compare(x, y) < 0; }
    friend bool operator>(const Wide& x, const Wide& y) { return compare(x, y) > 0; }
    friend bool operator<=(const Wide& x, const Wide& y) { return compare(x, y) <= 0; }
    friend bool operator>=(const Wide& x, const Wide& y) { return compare(x, y) >= 0; }
    friend bool operator==(const Wide& x, const Wide& y) { return compare(x, y) == 0; }

    friend Wide operator+(const Wide& x, const Wide& y) {
        if (x.sign_ == 0) {
            return y;
        }
        if (y.sign_ == 0) {
            return x;
        }
        return compare_sizes(x, y) >= 0 ? added(x, y) : added(y, x);
    }

    friend Wide operator-(const Wide& x, const Wide& y) { return x + (-y); }

    friend Wide operator*(const Wide& x, const Wide& y) {
        if (x.sign_ == 0 || y.sign_ == 0) {
            return {};
        }
        std::array<std::uint64_t, 2 * limbs> product{};
        for (std::size_t i = 0; i < limbs; ++i) {
            std::uint64_t carry = 0;
            for (std::size_t j = 0; j < limbs; ++j) {
                const Long sum = Long(x.mantissa_[i]) * y.mantissa_[j] + product[i + j] + carry;
                product[i + j] = static_cast<std::uint64_t>(sum);
                carry = static_cast<std::uint64_t>(sum >> 64);
            }
            product[i + limbs] = carry;
        }
        return rounded(x.sign_ * y.sign_, x.exponent_ + y.exponent_, product, false);
    }

    // Newton's iteration for 1/y, whose roundings do not matter: what comes out is shown to be large enough.
    friend Wide operator/(const Wide& x, const Wide& y) {
        const Wide divisor = y.size().with_exponent(0);
        Wide reciprocal = 1 / divisor.to_double();
        for (int known = 50; known < bits; known *= 2) {
            reciprocal = reciprocal * (Wide(2) - divisor * reciprocal);
        }
        Wide quotient = x.size() * reciprocal;
        quotient.exponent_ -= y.exponent_;
        const int sign = x.sign_ * y.sign_;
        const Wide wanted = x.size(), all = y.size();
        return settled(
            sign, quotient, [&](const Wide& q) { return -(-q * all) >= wanted; },
            [&](const Wide& q) { return q * all <= wanted; });
    }

    // Of what is not negative. Newton's iteration for 1/sqrt(x), and the same proof.
    friend Wide sqrt(const Wide& x) {
        if (x.sign_ == 0) {
            return x;
        }
        const std::int64_t odd = x.exponent_ & 1;
        const Wide fraction = x.with_exponent(-odd);
        Wide reciprocal = 1 / std::sqrt(fraction.to_double());
        for (int known = 50; known < bits; known *= 2) {
            const Wide miss = Wide(3) - fraction * reciprocal * reciprocal;
            reciprocal = (reciprocal * miss).scaled(-1);
        }
        Wide root = fraction * reciprocal;
        root.exponent_ += (x.exponent_ + odd) / 2;
        return settled(1, root, [&](const Wide& r) { return -(-r * r) >= x; }, [](const Wide&) { return true; });
    }

    // times 2^power
    Wide scaled(std::int64_t power) const { return with_exponent(exponent_ + power); }

 private:
    __extension__ using Long = unsigned __int128;

    Wide size() const {
        Wide result = *this;
        result.sign_ = sign_ == 0 ? 0 : 1;
        return result;
    }

    Wide with_exponent(std::int64_t exponent) const {
        Wide result = *this;
        result.exponent_ = exponent;
        return result;
    }

    static int compare_sizes(const Wide& x, const Wide& y) {
        if (x.exponent_ != y.exponent_) {
            return x.exponent_ < y.exponent_ ? -1 : 1;
        }
        for (std::size_t i = limbs; i-- > 0;) {
            if (x.mantissa_[i] != y.mantissa_[i]) {
                return x.mantissa_[i] < y.mantissa_[i] ? -1 : 1;
            }
        }
        return 0;
    }

    static int compare(const Wide& x, const Wide& y) {
        if (x.sign_ != y.sign_) {
            return x.sign_ < y.sign_ ? -1 : 1;
        }
        return x.sign_ == 0 ? 0 : x.sign_ * compare_sizes(x, y);
    }

    // From twice as many limbs, or one more, of which the first may begin with zeros; `more`: the true size is above
    // it, by less than its last bit. Away from 0 if positive, and toward 0 if negative.
    template <std::size_t count>
    static Wide rounded(int sign, std::int64_t exponent, const std::array<std::uint64_t, count>& size, bool more) {
        std::size_t top = count;
        while (top > 0 && size[top - 1] == 0) {
            --top;
        }
        if (top == 0) {
            return {};  // `more` comes with sizes above 0 only
        }
        const int shift = __builtin_clzll(size[top - 1]);
        Wide result;
        result.sign_ = sign;
        result.exponent_ = exponent - 64 * static_cast<std::int64_t>(count - top) - shift;
        const auto limb = [&](std::size_t below) {  // from the top, as shifted
            const std::uint64_t high = below < top ? size[top - 1 - below] : 0;
            const std::uint64_t low = below + 1 < top ? size[top - 2 - below] : 0;
            return shift == 0 ? high : (high << shift) | (low >> (64 - shift));
        };
        for (std::size_t i = 0; i < limbs; ++i) {
            result.mantissa_[limbs - 1 - i] = limb(i);
        }
        for (std::size_t i = limbs; i < top && !more; ++i) {
            more = limb(i) != 0;
        }
        if (more && sign > 0) {
            result.step();
        }
        return result;
    }

    // The next larger size.
    void step() {
        for (std::uint64_t& limb : mantissa_) {
            if (++limb != 0) {
                return;
            }
        }
        mantissa_[limbs - 1] = std::uint64_t(1) << 63;
        ++exponent_;
    }

    // Of sizes x >= y. A limb more keeps what is shifted out, but for whether there is more of it.
    static Wide added(const Wide& x, const Wide& y) {
        constexpr std::size_t count = limbs + 2;
        std::array<std::uint64_t, count> sum{}, small{};
        std::copy(x.mantissa_.begin(), x.mantissa_.end(), sum.begin() + 1);
        const std::int64_t distance = x.exponent_ - y.exponent_;
        bool more = false;
        if (distance >= bits + 64) {
            more = true;
        } else {
            const auto whole = static_cast<std::size_t>(distance / 64);
            const int shift = static_cast<int>(distance % 64);
            for (std::size_t i = 0; i < limbs; ++i) {
                const std::uint64_t limb = y.mantissa_[i];
                const std::uint64_t high = limb >> shift, low = shift == 0 ? 0 : limb << (64 - shift);
                if (i + 1 >= whole) {
                    small[i + 1 - whole] |= high;
                } else {
                    more |= high != 0;
                }
                if (i >= whole) {
                    small[i - whole] |= low;
                } else {
                    more |= low != 0;
                }
            }
        }
        if (x.sign_ == y.sign_) {
            std::uint64_t carry = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const Long total = Long(sum[i]) + small[i] + carry;
                sum[i] = static_cast<std::uint64_t>(total);
                carry = static_cast<std::uint64_t>(total >> 64);
            }
        } else {
            std::uint64_t borrow = more ? 1 : 0;  // the true difference lies above one bit less
            for (std::size_t i = 0; i < count; ++i) {
                const Long taken = Long(small[i]) + borrow;
                borrow = sum[i] < taken ? 1 : 0;
                sum[i] = static_cast<std::uint64_t>(sum[i] - taken);
            }
        }
        return rounded(x.sign_, x.exponent_ + 64, sum, more);
    }

    // A size that is known but for roundings, widened until it is shown to be on the right side.
    template <typename Above, typename Below>
    static Wide settled(int sign, const Wide& size, const Above& above, const Below& below) {
        if (sign == 0) {
            return {};
        }
        for (int width = bits - 10;; width -= 8) {
            const Wide step = size.scaled(-width);
            if (sign > 0) {
                if (const Wide candidate = size + step; above(candidate)) {
                    return candidate;
                }
            } else if (const Wide candidate = size - step; below(candidate)) {
                return -candidate;
            }
        }
    }

    std::array<std::uint64_t, limbs> mantissa_{};
    std::int64_t exponent_ = 0;
    int sign_ = 0;
};

template <std::size_t limbs>
double upper_double(const Wide<limbs>& x) {
    return x.to_double();
}

inline double upper_double(double x) { return x; }

}  // namespace certified
