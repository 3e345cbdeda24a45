// Rays against boxes.
//
// A box is tested so that no hit is lost which a test of its objects themselves would find, with all its rounding
// errors: it is widened by a bound of those, which is relative to the coordinates at hand. What remains to be rounded
// may be so in single precision, for that only makes it a little wider.
//
// Kay and Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986. Ize, "Robust BVH Ray Traversal", Journal of Computer
// Graphics Techniques 2(2), 2013, for the errors of the quotients.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "search/bvh.h"
#include "tracing/coarse.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct CoarseBox {
    typename Coarse<Real>::Number low[3], high[3];
};

// A box to a lane.
template <typename Real>
struct CoarseBoxes {
    Coarse<Real> low[3], high[3];
};

// What the boxes of a tree have in common. Their corners are kept relative to the middle of all, in a unit in which
// none is larger than 1.
template <typename Real>
struct BoxSpace {
    Vector<Real> center{0, 0, 0};
    Real unit = 1;
    Real growth, reach;  // see SearchPlan

    BoxSpace(const Bvh& tree, double growth_of_errors, double reach_of_tree)
        : growth(static_cast<Real>(growth_of_errors)), reach(static_cast<Real>(reach_of_tree)) {
        if (tree.nodes.empty()) {
            return;
        }
        const Box& all = tree.nodes[0].box;
        const Vector<Real> low{finite(all.low[0]), finite(all.low[1]), finite(all.low[2])};
        const Vector<Real> high{finite(all.high[0]), finite(all.high[1]), finite(all.high[2])};
        center = Real(0.5) * low + Real(0.5) * high;
        const Vector<Real> arm = high - center;
        const Real size = std::max({arm.x, arm.y, arm.z});
        constexpr int most = std::numeric_limits<Real>::max_exponent - 4;
        unit = size > 0 ? std::ldexp(Real(1), std::clamp(-std::ilogb(size) - 1, -most, most)) : Real(1);
    }

    CoarseBox<Real> box(const Box& exact) const {
        using Number = typename Coarse<Real>::Number;
        constexpr Number infinity = std::numeric_limits<Number>::infinity();
        const Real middle[3] = {center.x, center.y, center.z};
        CoarseBox<Real> result;
        for (std::size_t k = 0; k < 3; ++k) {
            const Real low = (finite(exact.low[k]) - middle[k]) * unit;
            const Real high = (finite(exact.high[k]) - middle[k]) * unit;
            result.low[k] = std::nextafter(static_cast<Number>(low), -infinity);
            result.high[k] = std::nextafter(static_cast<Number>(high), infinity);
        }
        return result;
    }

 private:
    // The nearest number that is finite: beyond, nothing is hit.
    static Real finite(double corner) {
        constexpr Real most = std::numeric_limits<Real>::max();
        return std::clamp(static_cast<Real>(corner), -most, most);
    }
};

// Where rays are in boxes: all that does not depend on the box.
template <typename Real>
class BoxTest {
 public:
    using L = Lanes<Real>;
    using C = Coarse<Real>;
    using Number = typename C::Number;

    // Objects are found with errors of some 20 epsilon times the coordinates, of the ray's origin or their own, that
    // take part; planes that meet at sharp angles multiply them by up to `growth`. An origin may itself lie outside the
    // object that it is on, by less than t_min.
    BoxTest(const Rays<Real>& rays, const BoxSpace<Real>& space) : unit_(space.unit) {
        // Boxes are wider still, for what ties with a hit has to be come to, from wherever the ray may lead; nothing in
        // the tree is as far away as twice the sum of both reaches.
        const L both = rays.reach + L(space.reach);
        const L error = L(std::max(32 * std::numeric_limits<Real>::epsilon(), 4096 * tie_epsilon<Real>)) * both;
        L off = error + rays.t_min;
        if constexpr (decides_ties<Real>) {
            off = off + L(Real(4)) * both * rays.spread;
        }
        Vector<L> origin = space.unit * (rays.origin - Vector<L>(space.center));
        const L away = max_norm(origin);
        const L rounding = static_cast<Real>(4 * std::numeric_limits<Number>::epsilon());
        L margin = L(space.unit) * (L(space.growth) * off) + rounding * away;
        // From so far away all boxes are entered.
        const Mask<Real> near = away + margin < L(farthest);
        origin = select(near, origin, {L(Real(0)), L(Real(0)), L(Real(0))});
        margin = select(near, margin, L(Real(0)));
        const auto prepare = [&](int k, L from, L slope) {
            inverse_[k] = rounded(select(near, L(Real(1)), L(Real(0)))) * inverse(rounded(slope));
            before_[k] = rounded(from + margin) * inverse_[k];
            behind_[k] = rounded(from - margin) * inverse_[k];
        };
        prepare(0, origin.x, rays.direction.x);
        prepare(1, origin.y, rays.direction.y);
        prepare(2, origin.z, rays.direction.z);
    }

    // The same of one of the rays in all lanes.
    BoxTest alone(int lane) const {
        BoxTest result(unit_);
        for (int k = 0; k < 3; ++k) {
            result.before_[k] = before_[k][lane];
            result.behind_[k] = behind_[k][lane];
            result.inverse_[k] = inverse_[k][lane];
        }
        return result;
    }

    // A finite bound of distances, for operator().
    C bound(L distance) const {
        return min(rounded(distance * L(unit_)) * C(slack), C(std::numeric_limits<Number>::max()));
    }

    // Whether rays are in the box somewhere between their origin and `bound`, and since when: infinite for those that
    // are not. Each ray in the same box, or in its own.
    template <typename Box>
    [[gnu::always_inline]] bool operator()(const Box& box, C bound, C& since) const {
        C enter = Number(0);
        C leave = std::numeric_limits<Number>::infinity();
        for (int k = 0; k < 3; ++k) {
            const C one = multiply_subtract(C(box.low[k]), inverse_[k], before_[k]);
            const C other = multiply_subtract(C(box.high[k]), inverse_[k], behind_[k]);
            enter = max(enter, min(one, other));
            leave = min(leave, max(one, other));
        }
        leave = min(leave * C(slack), bound);
        since = select_less_equal(enter, leave, enter, C(std::numeric_limits<Number>::infinity()));
        return any_less_equal(enter, leave);
    }

 private:
    explicit BoxTest(Real unit) : unit_(unit) {}

    // More than the roundings of the slope, its inverse, the difference and the product together, of both distances.
    static constexpr Number slack = 1 + 16 * std::numeric_limits<Number>::epsilon();
    // No product with an inverse is too large for a number.
    static constexpr Real farthest = Real(0x1p40);

    // As small a slope moves a ray by less than the margin wherever it may lead.
    static C inverse(C slope) {
        const C least = Number(0x1p-44);
        return C(Number(1)) / select_less_equal(least, abs(slope), slope, least);
    }

    // The origin, so moved that boxes need not be widened, divided by the direction.
    C before_[3], behind_[3], inverse_[3];
    Real unit_;
};

}  // namespace whitted::WHITTED_ISA
