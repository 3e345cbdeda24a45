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

bool lies_on(const QuadricDescription& quadric, const Triple& point) {
    const auto& q = quadric.coefficients;
    const Real x = point[0], y = point[1], z = point[2];
    Real value = 0;
    Real sum = 0;
    const auto add = [&](Real term, int factors) {
        value += term;
        sum += static_cast<Real>(factors) * std::abs(term);  // each of them is rounded
    };
    add(q[0] * x * x, 3);
    add(q[1] * y * y, 3);
    add(q[2] * z * z, 3);
    add(q[3] * x * y, 3);
    add(q[4] * x * z, 3);
    add(q[5] * y * z, 3);
    add(q[6] * x, 2);
    add(q[7] * y, 2);
    add(q[8] * z, 2);
    add(q[9], 1);
    return std::abs(value) <= rounding * sum;
}

bool lies_within(const std::vector<Quadruple>& planes, const Triple& point) {
    return std::all_of(planes.begin(), planes.end(), [&](const Quadruple& plane) {
        const Height height = height_above(plane, point);
        return height.value <= height.error;
    });
}

}  // namespace whitted
