#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <variant>

#include "search/bounds.h"

namespace whitted {

// The box around the body at both ends of its way holds it in between too, for the way is straight.
std::optional<Bounds> bounds_of(const MovingDescription& moving) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    std::optional<Bounds> bounds = std::visit([](const auto& body) { return bounds_of(body); }, moving.body);
    if (!bounds) {
        return bounds;
    }
    double farthest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double way = moving.displacement[k];
        farthest = std::max(farthest, std::abs(way));
        double& low = bounds->box.low[k];
        double& high = bounds->box.high[k];
        low = way < 0 ? std::nextafter(low + way, -infinity) : low;
        high = way > 0 ? std::nextafter(high + way, infinity) : high;
        if (!std::isfinite(low) || !std::isfinite(high)) {
            return std::nullopt;
        }
    }
    bounds->reach += farthest;  // rays are brought back by so much
    return bounds;
}

double cost_of(const MovingDescription& moving) {
    return 1 + std::visit([](const auto& body) { return cost_of(body); }, moving.body);
}

}  // namespace whitted
