#include <cmath>
#include <cstddef>
#include <limits>

#include "search/bounds.h"

namespace whitted {

std::optional<Bounds> bounds_of(const SphereDescription& sphere) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Bounds bounds{{}, 1, 0};
    for (std::size_t k = 0; k < 3; ++k) {
        bounds.box.low[k] = std::nextafter(sphere.center[k] - sphere.radius, -infinity);
        bounds.box.high[k] = std::nextafter(sphere.center[k] + sphere.radius, infinity);
        if (!std::isfinite(bounds.box.low[k]) || !std::isfinite(bounds.box.high[k])) {
            return std::nullopt;
        }
    }
    return bounds;
}

}  // namespace whitted
