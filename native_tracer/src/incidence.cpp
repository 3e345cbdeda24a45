#include "incidence.h"

#include <cmath>
#include <cstddef>
#include <limits>

namespace whitted {

namespace {

using Real = long double;

constexpr Real rounding = std::numeric_limits<double>::epsilon() / 2;

Real length(const Triple& v) { return std::hypot(Real(v[0]), Real(v[1]), Real(v[2])); }

}  // namespace

bool lies_on(const SphereDescription& sphere, const Triple& point) {
    const Triple& center = sphere.center;
    const Real distance =
        std::hypot(Real(point[0]) - center[0], Real(point[1]) - center[1], Real(point[2]) - center[2]);
    return std::abs(distance - sphere.radius) <= rounding * (length(point) + length(center) + sphere.radius);
}

bool lies_on(const Quadruple& plane, const Triple& point) {
    Real height = plane[3];
    Real error = std::abs(height);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Real product = Real(plane[axis]) * point[axis];
        height += product;
        error += 2 * std::abs(product);  // both of its factors are rounded
    }
    return std::abs(height) <= rounding * error;
}

}  // namespace whitted
