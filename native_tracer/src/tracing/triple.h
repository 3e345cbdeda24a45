// Points and directions that are given in double, as any precision takes them.

#pragma once

#include <algorithm>
#include <cmath>

#include "tracing/description.h"
#include "tracing/isa.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
Vector<Real> vector_of(const Triple& v) {
    return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}

// Along the difference of two points, in double, before any of the two is rounded: half of it where no number holds it.
inline Triple direction(const Triple& from, const Triple& to) {
    const auto scaled = [&](double factor) -> Triple {
        return {factor * to[0] - factor * from[0], factor * to[1] - factor * from[1],
                factor * to[2] - factor * from[2]};
    };
    const Triple whole = scaled(1);
    const bool holds = std::isfinite(whole[0]) && std::isfinite(whole[1]) && std::isfinite(whole[2]);
    return holds ? whole : scaled(0.5);
}

// The same direction at a length whose square neither overflows nor vanishes, in float too; a power of two times `v`,
// so that no digit is lost.
inline Triple in_range(const Triple& v) {
    const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
    const int exponent = std::ilogb(largest);
    return {std::scalbn(v[0], -exponent), std::scalbn(v[1], -exponent), std::scalbn(v[2], -exponent)};
}

}  // namespace whitted::WHITTED_ISA
