#include "tracing/incidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace whitted {

namespace {

using Real = long double;

constexpr Real rounding = std::numeric_limits<double>::epsilon() / 2;

Real length(const Triple& v) { return std::hypot(Real(v[0]), Real(v[1]), Real(v[2])); }

// Of a point above a plane, times the length of its normal, and how far that may be off.
struct Height {
    Real value, error;
};

Height height_above(const Quadruple& plane, const Triple& point) {
    Real value = plane[3];
    Real sum = std::abs(value);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Real product = Real(plane[axis]) * point[axis];
        value += product;
        sum += 2 * std::abs(product);  // both of its factors are rounded
    }
    return {value, rounding * sum};
}

}  // namespace

bool lies_on(const SphereDescription& sphere, const Triple& point) {
    const Triple& center = sphere.center;
    const Real distance =
        std::hypot(Real(point[0]) - center[0], Real(point[1]) - center[1], Real(point[2]) - center[2]);
    const Real error = rounding * (length(point) + length(center) + sphere.radius);
    // Of a sphere that is smaller than the roundings of where it is, nothing is known.
    return std::abs(distance - sphere.radius) <= error && error < sphere.radius / 2;
}

bool lies_on(const Quadruple& plane, const Triple& point) {
    const Height height = height_above(plane, point);
    return std::abs(height.value) <= height.error;
}

bool lies_within(const std::vector<Quadruple>& planes, const Triple& point) {
    return std::all_of(planes.begin(), planes.end(), [&](const Quadruple& plane) {
        const Height height = height_above(plane, point);
        return height.value <= height.error;
    });
}

}  // namespace whitted
