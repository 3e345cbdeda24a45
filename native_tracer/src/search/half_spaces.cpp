// For a direction e and planes with unit normals n_i, inside where n_i.x <= b_i, any weights w_i >= 0 with
// sum w_i n_i = e prove that e.x <= sum w_i b_i everywhere inside: three planes are enough for the least such bound.
// Planes that are moved outward by some distance each, at most delta, raise it by at most delta sum w_i.
//
// The dual simplex method looks for those three: it begins with planes far outside that bound all space, and as long
// as the three planes' common point lies beyond some plane, takes the one it lies farthest beyond in for one of them.
// At every step the weights prove a bound, so that it may stop at any.
//
// Chvatal, "Linear Programming", 1983, chapter 10.

#include "search/half_spaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "search/bounds.h"

namespace whitted {

namespace {

using Vec = std::array<double, 3>;

double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Three planes that prove a bound.
class Basis {
 public:
    // Planes at distance `far`, square to the axes of space, that bound the direction.
    Basis(const Vec& direction, double far) : direction_(direction) {
        for (std::size_t k = 0; k < 3; ++k) {
            planes_[k] = {{}, far};
            planes_[k].normal[k] = direction[k] < 0 ? -1 : 1;
        }
        solve();
    }

    const Vec& point() const { return point_; }  // where the three planes meet
    double growth() const {
        return weights_[0] * planes_[0].growth + weights_[1] * planes_[1].growth + weights_[2] * planes_[2].growth;
    }
    // Leaves out planes at distance `far`: they prove nothing.
    void leave_out(double far) {
        for (std::size_t i = 0; i < 3; ++i) {
            weights_[i] = planes_[i].height < far ? weights_[i] : 0;
        }
    }
    // The sum of the weights falls short of the direction by this.
    Vec residual() const {
        Vec rest = direction_;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                rest[k] -= weights_[i] * planes_[i].normal[k];
            }
        }
        return rest;
    }
    double bound() const {
        return weights_[0] * planes_[0].height + weights_[1] * planes_[1].height + weights_[2] * planes_[2].height;
    }
    double reach() const {
        return std::max({std::abs(planes_[0].height), std::abs(planes_[1].height), std::abs(planes_[2].height)});
    }

    // Takes a plane in, beyond which the point lies. False if that leaves no points.
    bool take(const HalfSpace& plane) {
        const Vec shares = shares_of(plane.normal);
        std::size_t leaving = 3;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < 3; ++i) {
            if (shares[i] > 0x1p-40 && weights_[i] < least * shares[i]) {
                least = weights_[i] / shares[i];
                leaving = i;
            }
        }
        if (leaving == 3) {
            return false;
        }
        planes_[leaving] = plane;
        return solve();
    }

 private:
    // The weights with which the normals sum up to v.
    Vec shares_of(const Vec& v) const {
        return {dot(v, across_[0]) / volume_, dot(v, across_[1]) / volume_, dot(v, across_[2]) / volume_};
    }

    bool solve() {
        for (std::size_t i = 0; i < 3; ++i) {
            across_[i] = cross(planes_[(i + 1) % 3].normal, planes_[(i + 2) % 3].normal);
        }
        volume_ = dot(planes_[0].normal, across_[0]);
        weights_ = shares_of(direction_);
        for (double& weight : weights_) {
            weight = std::max(weight, 0.0);
        }
        for (std::size_t k = 0; k < 3; ++k) {
            point_[k] = (planes_[0].height * across_[0][k] + planes_[1].height * across_[1][k] +
                         planes_[2].height * across_[2][k]) /
                        volume_;
        }
        return std::isfinite(growth()) && std::isfinite(bound()) && std::isfinite(dot(point_, point_));
    }

    Vec direction_{};
    std::array<HalfSpace, 3> planes_;
    std::array<Vec, 3> across_;
    double volume_;
    Vec weights_, point_;
};

// Farther than any of them; they count as unbounded if they go on so far.
double far_of(std::span<const HalfSpace> half_spaces) {
    double far = 0;
    for (const HalfSpace& plane : half_spaces) {
        far = std::max(far, std::abs(plane.height));
    }
    return far > 0 ? 0x1p24 * far : 1;
}

// The planes that prove a bound along a direction, if there are points. Such as are `far` may be among them.
std::optional<Basis> basis_of(std::span<const HalfSpace> half_spaces, const Vec& direction, double far) {
    Basis basis(direction, far);
    constexpr int most_steps = 64;
    for (int step = 0; step < most_steps; ++step) {
        const HalfSpace* beyond = nullptr;
        double most = 0x1p-44 * (std::abs(basis.point()[0]) + std::abs(basis.point()[1]) + std::abs(basis.point()[2]) +
                                 basis.reach());
        for (const HalfSpace& plane : half_spaces) {
            const double distance = dot(plane.normal, basis.point()) - plane.height;
            if (distance > most) {
                most = distance;
                beyond = &plane;
            }
        }
        if (beyond == nullptr) {
            break;
        }
        if (!basis.take(*beyond)) {
            return std::nullopt;
        }
    }
    return basis;
}

}  // namespace

HalfSpace half_space_of(const Quadruple& plane) {
    // A normal may have any length: its square must neither overflow nor vanish.
    const int exponent = std::ilogb(std::max({std::abs(plane[0]), std::abs(plane[1]), std::abs(plane[2])}));
    Vec normal{std::scalbn(plane[0], -exponent), std::scalbn(plane[1], -exponent), std::scalbn(plane[2], -exponent)};
    const double length = std::sqrt(dot(normal, normal));
    for (double& c : normal) {
        c /= length;
    }
    return {normal, -std::scalbn(plane[3], -exponent) / length};
}

std::optional<Support> support_of(std::span<const HalfSpace> half_spaces, const Vec& direction) {
    const double far = far_of(half_spaces);
    std::optional<Basis> basis = basis_of(half_spaces, direction, far);
    if (!basis) {
        return std::nullopt;
    }
    // But for roundings, they had no weight, unless the direction has no bound.
    basis->leave_out(far);
    const Vec rest = basis->residual();
    if (!(std::abs(rest[0]) + std::abs(rest[1]) + std::abs(rest[2]) <= 0x1p-44 * basis->growth())) {
        return std::nullopt;
    }
    return Support{basis->bound(), basis->growth()};
}

std::optional<Bounds> bounds_of(std::span<const HalfSpace> half_spaces) {
    const double far = far_of(half_spaces);
    Bounds result{{}, 1, 0};
    Vec residuals[6];
    double size = 0;  // of the farthest coordinate
    for (std::size_t side = 0; side < 6; ++side) {
        const std::size_t axis = side % 3;
        const double sign = side < 3 ? -1 : 1;
        Vec direction{};
        direction[axis] = sign;
        const std::optional<Basis> basis = basis_of(half_spaces, direction, far);
        // Also if a plane of the beginning is still there, whatever it weighs: the box is needed on all sides.
        if (!basis || !(basis->reach() < far)) {
            return std::nullopt;
        }
        (side < 3 ? result.box.low : result.box.high)[axis] = sign * basis->bound();
        result.growth = std::max(result.growth, basis->growth());
        result.reach = std::max(result.reach, basis->reach());
        residuals[side] = basis->residual();
        size = std::max(size, std::abs(basis->bound()));
    }
    // What the weights fall short by, and what was rounded, counts for the size of the coordinates at most.
    for (std::size_t side = 0; side < 6; ++side) {
        const Vec& r = residuals[side];
        const double slack = 2 * (std::abs(r[0]) + std::abs(r[1]) + std::abs(r[2])) * size +
                             0x1p-48 * result.growth * (size + result.reach);
        double& bound = (side < 3 ? result.box.low : result.box.high)[side % 3];
        bound += side < 3 ? -slack : slack;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        if (!std::isfinite(result.box.low[k]) || !std::isfinite(result.box.high[k]) ||
            result.box.low[k] > result.box.high[k]) {
            return std::nullopt;
        }
    }
    return result;
}

std::optional<Bounds> bounds_of(const PolyhedronDescription& polyhedron) {
    std::vector<HalfSpace> half_spaces;
    for (const Quadruple& plane : polyhedron.planes) {
        half_spaces.push_back(half_space_of(plane));
    }
    return bounds_of(half_spaces);
}

}  // namespace whitted
