// Shapes as seen from a point, such as the eye or a light: tells most lines through the point that miss one, for less
// than half of what intersecting it costs. shapes.h says how that is used.

#pragma once

#include <cmath>
#include <limits>

#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// A shape that has no sight of its own: it is tested from anywhere.
template <typename Real>
struct AlwaysInSight {
    template <typename... Arguments>
    explicit AlwaysInSight(const Arguments&...) {}
    template <typename... Arguments>
    bool may_be_hit(const Arguments&...) const {
        return true;
    }
    template <typename... Arguments>
    bool may_block(const Arguments&...) const {
        return true;
    }
};

// A ball that holds all of a shape's surface. A line through the point, of direction d, passes the centre at a distance
// whose square is g.g - (g.d)^2, with g = center - point. That difference cancels for a small ball far away, so it only
// counts where it is larger than its error.
template <typename Real>
class BallInSight {
 public:
    using L = Lanes<Real>;

    // reach2 is the square of the radius, and more by all that is rounded; it may be infinite.
    // A line that meets the ball and passes the point no farther away than `extent` is parallel to one through the
    // point that meets a ball larger by so much.
    BallInSight(const Vector<Real>& center, Real reach2, const Vector<Real>& point, Real extent)
        : g_(center - point), outside2_((1 - slack) * dot(g_, g_) - (1 + slack) * larger(reach2, extent)) {}

    // The shape has the ball's centre, and what reach2 is of its radius.
    template <typename Shape>
    BallInSight(const Shape& shape, const Vector<Real>& point, Real extent)
        : BallInSight(shape.ball_center(), shape.ball_reach2(), point, extent) {}

    bool may_be_hit(const Vector<L>& direction) const { return any(may_meet(direction, L(Real(0)))); }

    bool may_block(const Rays<Real>& rays, L distance, Mask<Real> wanted) const {
        // The rays pass the point at some distance, for their directions are rounded.
        return any(wanted & may_meet(rays.direction, L(slack) * distance * distance));
    }

 protected:
    static constexpr Real slack = 128 * std::numeric_limits<Real>::epsilon();

    const Vector<Real>& to_center() const { return g_; }

    // The square of a length that is longer by `extent`.
    static Real larger(Real length2, Real extent) {
        const Real length = std::sqrt(length2) + extent;
        return extent == 0 ? length2 : length * length;
    }

 private:
    Mask<Real> may_meet(const Vector<L>& direction, L error2) const {
        const L closest = dot(Vector<L>(g_), direction);
        return ~(closest * closest + error2 < L(outside2_));  // also where a square is too large for a number
    }

    Vector<Real> g_;
    Real outside2_;  // g.g - r^2, and less by more than the error
};

}  // namespace whitted::WHITTED_ISA
