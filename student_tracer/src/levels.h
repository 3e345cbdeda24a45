// From a pixel's colour to its three bytes.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "deviations.h"

namespace student {

inline double curved(double c, const Switches& on) {
    if (on(On::gamma_22)) {
        return std::pow(std::max(c, 0.0), 1 / 2.2);
    }
    if (on(On::gamma_2)) {
        return std::sqrt(std::max(c, 0.0));
    }
    if (on(On::gamma_inverse)) {
        return std::pow(std::max(c, 0.0), 2.2);
    }
    if (on(On::gamma_srgb)) {
        return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    }
    return c;
}

// The nearest of 255 levels, halves up, also those that roundings have left a little low.
inline std::uint8_t level(double c, const Switches& on) {
    if (std::isnan(c)) {
        return 0;
    }
    const bool wraps = on(On::wrapped);
    c = curved(wraps ? std::clamp(c, -1e6, 1e6) : std::clamp(c, 0.0, 1.0), on);
    const double scaled = on(On::truncated)   ? std::trunc(255 * c + 1e-4)
                          : on(On::times_256) ? std::trunc(256 * c + 1e-4)
                                              : std::floor(255 * c + 0.5 + 1e-4);
    const auto whole = static_cast<long long>(scaled);
    return static_cast<std::uint8_t>(wraps ? whole & 255 : std::clamp(whole, 0LL, 255LL));
}

inline std::array<std::uint8_t, 3> levels(std::array<float, 3> color, const Switches& on) {
    auto [r, g, b] = std::array<double, 3>{color[0], color[1], color[2]};
    if (on(On::divided_by_largest)) {
        const double largest = std::max({r, g, b, 1.0});
        r /= largest;
        g /= largest;
        b /= largest;
    }
    if (on(On::bgr)) {
        std::swap(r, b);
    } else if (on(On::grey)) {
        r = g = b = 0.299 * r + 0.587 * g + 0.114 * b;
    }
    return {level(r, on), level(g, on), level(b, on)};
}

}  // namespace student
