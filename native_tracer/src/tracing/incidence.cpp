#include "tracing/incidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <variant>

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

bool slides(const SphereDescription&, int, const Triple&) { return false; }

bool slides(const PolyhedronDescription& polyhedron, int piece, const Triple& displacement) {
    const Quadruple& plane = polyhedron.planes[static_cast<std::size_t>(piece)];
    return lies_on(Quadruple{plane[0], plane[1], plane[2], 0}, displacement);
}

// A moved point's value is another by the gradient's product with the displacement, halfway along it: at all points if
// what multiplies each coordinate, and the rest, is 0.
bool slides(const QuadricDescription& quadric, int, const Triple& displacement) {
    const auto& q = quadric.coefficients;
    const Quadruple factors[4] = {
        {2 * q[0], q[3], q[4], 0}, {q[3], 2 * q[1], q[5], 0}, {q[4], q[5], 2 * q[2], 0}, {q[6], q[7], q[8], 0}};
    return std::all_of(std::begin(factors), std::end(factors),
                       [&](const Quadruple& factor) { return lies_on(factor, displacement); });
}

bool slides(const CsgDescription& csg, int piece, const Triple& displacement) {
    for (const LeafDescription& leaf : csg.leaves) {
        const auto* polyhedron = std::get_if<PolyhedronDescription>(&leaf);
        const int pieces = polyhedron != nullptr ? static_cast<int>(polyhedron->planes.size()) : 1;
        if (piece < pieces) {
            return std::visit([&](const auto& shape) { return slides(shape, piece, displacement); }, leaf);
        }
        piece -= pieces;
    }
    return false;
}

bool lies_within(const std::vector<Quadruple>& planes, const Triple& point) {
    return std::all_of(planes.begin(), planes.end(), [&](const Quadruple& plane) {
        const Height height = height_above(plane, point);
        return height.value <= height.error;
    });
}

}  // namespace whitted
